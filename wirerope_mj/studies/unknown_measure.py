"""What is answered to a measure that a study does not have: those that begin alike, and all kinds that there are."""

from collections.abc import Sequence
from difflib import SequenceMatcher

_ALIKE = 12
"""Measures that are named because they begin alike: those of all mounts of a floor would fill the screen."""


def unknown_measure(name: str, known: Sequence[str]) -> str:
    """Return what is wrong with the name of a measure, and what there is, as a sentence without a capital.

    Args:
        name: no measure; it may be a pattern that matches none.
        known: all measures.
    """
    first = name.partition("/")[0].rstrip("*?")
    alike = [one for one in known if first and one.startswith(first)]
    alike.sort(key=lambda one: -SequenceMatcher(None, one, name).ratio())
    rest = ", ..." if len(alike) > _ALIKE else ""
    begin = f"; alike are {', '.join(alike[:_ALIKE])}{rest}" if alike else ""
    return f"there is no measure {name!r}{begin}; there are {kinds_of(known)}."


def kinds_of(known: Sequence[str]) -> str:
    """Return measures as a list with NAME in place of mounts, bodies and points."""
    return ", ".join(dict.fromkeys(map(_kind, known)))


def _kind(name: str) -> str:
    """Return a measure with NAME in place of a mount, a body or a point: "deflection/NAME/roll"."""
    first, *rest = name.split("/")
    if not rest:
        return name
    return "/".join([first, "NAME", *(rest[-1:] if first == "deflection" else [])])
