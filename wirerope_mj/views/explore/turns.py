"""One at a time, and the newest goes first: a slider that is dragged asks for more runs than can be computed."""

from collections.abc import Iterator
from contextlib import contextmanager
from threading import Lock


class OvertakenError(Exception):
    """Somebody came later and goes first; what was asked for is not wanted any more."""


class Turns:
    """Lets one thread through at a time, and of those that wait the one that came last."""

    def __init__(self) -> None:
        self._counting, self._busy = Lock(), Lock()
        self._newest = 0

    @contextmanager
    def turn(self) -> Iterator[None]:
        """Wait until nobody else is inside; OvertakenError if another one came while this one waited."""
        with self._counting:
            self._newest += 1
            mine = self._newest
        with self._busy:
            if mine != self._newest:
                raise OvertakenError
            yield
