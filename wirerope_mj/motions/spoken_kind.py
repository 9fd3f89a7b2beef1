"""A kind of motion that a phrase says: what it needs, what makes it, and what may stand before the phrase."""

from collections.abc import Callable, Mapping
from dataclasses import dataclass, field
from os.path import isfile  # as `Path.is_file`, but a name that is too long is none
from pathlib import Path
from typing import Any

from wirerope_mj.foundation.directions import Direction
from wirerope_mj.foundation.plain_text import short
from wirerope_mj.motions.motion import BaseMotion
from wirerope_mj.motions.phrases import Phrase

START = {"at": "time"}


@dataclass(frozen=True, kw_only=True)
class SpokenMotion:
    """A kind of motion as a phrase says it.

    Attributes:
        example: a phrase of this kind.
        summary: what it is, for a list of options.
        needs: how many values of each quantity there must be.
        make: makes the motion along one direction from the phrase, its number among several, and what `begins` returned.
        words: quantity of what may follow each word.
        needed_words: words that must be there.
        begins: takes what stands before the phrase, a file or a name, off it: returns what it means and the rest of the text.
        may: quantities that may be there, and how many values at most.
        directed: whether it has a direction.
    """

    example: str
    summary: str
    needs: Mapping[str, int]
    make: Callable[[Phrase, Direction, int, Any], BaseMotion]
    words: Mapping[str, str] = field(default_factory=lambda: START)
    needed_words: tuple[str, ...] = ()
    begins: Callable[[str, Path], tuple[Any, str]] | None = None
    may: Mapping[str, int] = field(default_factory=dict)
    directed: bool = True


def file_first(read: Callable[[Path], Any]) -> Callable[[str, Path], tuple[Any, str]]:
    """Return what reads the file that a phrase begins with, whose name may hold spaces."""

    def begins(text: str, folder: Path) -> tuple[Any, str]:
        words = text.split(" ")
        for count in range(len(words), 0, -1):
            path = folder / " ".join(words[:count])
            if isfile(path):
                return read(path), " ".join(words[count:])
        raise ValueError(f'there is no file "{short(words[0])}".')

    return begins


def site_first(text: str, _: Path) -> tuple[str, str]:
    """Return the site that a phrase begins with, and what follows."""
    site, _space, rest = text.strip().partition(" ")
    return site, rest


def one(phrase: Phrase, quantity: str) -> float:
    """Return the first value of a quantity in SI."""
    return phrase.quantities[quantity][0]
