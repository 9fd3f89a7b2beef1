"""Earlier names: they work for one minor version more, and say what the name is now."""

import warnings
from typing import Any


class Renamed:
    """Stands in a class body for what has another name now: `share = Renamed("utilisation")`."""

    def __init__(self, now: str) -> None:
        self._now = now
        self._was = ""

    def __set_name__(self, owner: type, name: str) -> None:
        self._was = f"{owner.__name__}.{name}"

    def __get__(self, instance: Any, owner: type) -> Any:
        if instance is None:
            return self
        warn_renamed(self._was, f"{owner.__name__}.{self._now}", stacklevel=3)
        return getattr(instance, self._now)


def warn_renamed(was: str, now: str, *, stacklevel: int = 2) -> None:
    """Warn that a name is another one now; `stacklevel` leads to where it is used."""
    warnings.warn(f"{was} is called {now} since version 0.2, and leaves with 0.3.", DeprecationWarning, stacklevel)
