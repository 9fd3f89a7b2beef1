"""Files that keep the error of a write: their writer continues, and the opener raises the error afterwards."""

from collections.abc import Iterator
from contextlib import contextmanager
from io import FileIO
from typing import Any


class UnfailingFile(FileIO):
    """A file whose writes do not fail: after the first failure nothing more is written."""

    failure: OSError | None = None

    def write(self, content: Any) -> int:
        """Write all of `content`, or nothing more after a write has failed."""
        rest = memoryview(content).cast("B")
        while len(rest) and self.failure is None:
            try:
                rest = rest[super().write(rest) or 0 :]
            except OSError as error:
                self.failure = error
        return len(memoryview(content).cast("B"))

    @contextmanager
    def failures_raised(self) -> Iterator[None]:
        """Raise the error of a write that failed in the block, even if it was caught there."""
        try:
            yield
        finally:
            if self.failure is not None:
                raise self.failure
