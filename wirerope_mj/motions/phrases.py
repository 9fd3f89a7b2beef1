"""Phrases that say a base motion, as `15 g 11 ms z at 50 ms`: numbers with units, a direction, and words before a number."""

from collections.abc import Callable, Mapping
from dataclasses import dataclass, field
from os.path import isfile  # as `Path.is_file`, but a name that is too long is none
from pathlib import Path
from typing import Any, TypeVar

from wirerope_mj.foundation.arrays import Entries
from wirerope_mj.foundation.directions import Direction
from wirerope_mj.foundation.plain_text import short
from wirerope_mj.foundation.quantities import NUMBER, Phrase

START = {"at": "time"}
LASTING = START | {"seed": "", "rise": "time", "fall": "time"}  # of a random vibration
LARGEST_SEED = 2**53 - 1  # of a phrase: numbers are read as floats, and of larger ones neighbours would be one

Read = TypeVar("Read")


@dataclass(frozen=True, kw_only=True)
class SpokenMotion:
    """A phrase that says a motion: what stands in it, and what makes the motion of it."""

    name: str  # of the key in files, and of the option of commands
    example: str  # a phrase of this kind
    summary: str  # what it says, for a list of options
    needs: Mapping[str, int]  # how many values of each quantity there must be
    # makes the motion from its class, the phrase, one direction, its number among several, and what `begins` returned
    make: Callable[..., Any]
    words: Mapping[str, str] = field(default_factory=lambda: START)  # quantity of what may follow each word
    needed_words: tuple[str, ...] = ()  # words that must be there
    # takes what stands before the phrase, a file or a name, off it: returns what it means and the rest of the text
    begins: Callable[[str, Path], tuple[object, str]] | None = None
    may: Mapping[str, int] = field(default_factory=dict)  # quantities that may be there, and how many values at most
    directed: bool = True  # whether it has a direction
    says_more: bool = False  # than the motion's description does
    option: str = ""  # name of the option of commands where it is another
    written: str = ""  # pattern of the name as people write it, where it is another


def made_of(*, started: bool = True, **arguments: str) -> Callable[..., Any]:
    """Return what makes a motion whose arguments are quantities or words of its phrase; of a force its site, too."""

    def make(shape: Callable[..., Any], phrase: Phrase, direction: Direction, _: int, site: str | None) -> Any:
        begins = ({"start": phrase.start} if started else {}) | ({} if site is None else {"site": site})
        values = {name: phrase.named[said] if said in phrase.named else phrase.one(said) for name, said in arguments.items()}
        return shape(direction=direction, **values, **begins)

    return make


def lasting(phrase: Phrase, direction: Direction, number: int) -> Entries:
    """Read length, seed and ramps of a vibration; along several directions each has a seed of its own."""
    seed = phrase.named.get("seed", 1.0)
    if seed != int(seed) or not 0 <= seed <= LARGEST_SEED:
        raise ValueError(f"a seed is an integer from 0 to {LARGEST_SEED}, got {seed:.17g}.")
    ramps = {"rise": phrase.named.get("rise"), "fall": phrase.named.get("fall"), "start": phrase.start}
    return {"duration": phrase.one("time"), "seed": int(seed) + number, "direction": direction, **ramps}


def file_first(read: Callable[[Path], Read]) -> Callable[[str, Path], tuple[Read, str]]:
    """Make the reader of the file that a phrase begins with, whose name may hold spaces."""

    def begins(text: str, folder: Path) -> tuple[Read, str]:
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
    if NUMBER.match(site):
        raise ValueError(f"the name of a site for forces must stand first, got {short(site)!r}.")
    return site, rest
