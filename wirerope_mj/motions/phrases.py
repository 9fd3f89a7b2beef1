"""Phrases of base motions, such as `15 g 11 ms z at 50 ms`: numbers with units, a direction, and words before a number."""

from collections.abc import Callable, Mapping
from dataclasses import dataclass, field
from os.path import isfile  # as `Path.is_file`, but a name that is too long is none
from pathlib import Path
from typing import Any, TypeVar

from wirerope_mj.foundation.arrays import Entries
from wirerope_mj.foundation.directions import Direction
from wirerope_mj.foundation.plain_text import short
from wirerope_mj.foundation.quantities import NUMBER, Phrase

START = {"at": "time"}  # quantity of the value behind a word of a phrase
LASTING = START | {"seed": "", "rise": "time", "fall": "time"}  # of a random vibration
LARGEST_SEED = 2**53 - 1  # of a phrase: numbers are read as floats, and of larger ones neighbours would be one

Read = TypeVar("Read")


@dataclass(frozen=True, kw_only=True)
class SpokenMotion:
    """Grammar of the phrases of one kind of motion, and the function that makes the motion from a phrase."""

    name: str  # name of the key in files, and of the option of commands
    example: str  # a phrase of this kind
    summary: str  # meaning of the phrase, for a list of options
    needs: Mapping[str, int]  # number of values of each quantity that the phrase must have
    # makes the motion from its class, the phrase, one direction, its number among several, and what `begins` returned
    make: Callable[..., Any]
    words: Mapping[str, str] = field(default_factory=lambda: START)  # quantity of the value that may follow each word
    needed_words: tuple[str, ...] = ()  # words that the phrase must have
    # splits a file or a name from the beginning of the phrase: returns its meaning and the rest of the text
    begins: Callable[[str, Path], tuple[object, str]] | None = None
    may: Mapping[str, int] = field(default_factory=dict)  # largest number of values of each optional quantity
    directed: bool = True  # whether the phrase has a direction
    says_more: bool = False  # whether the phrase holds more than the motion's description
    option: str = ""  # name of the option of commands where it differs from `name`
    written: str = ""  # pattern of the name as people write it, where it differs from `name`


def made_of(*, started: bool = True, **arguments: str) -> Callable[..., Any]:
    """Return the function that makes a motion from its phrase; `arguments`: the quantity or word for each parameter."""

    def make(shape: Callable[..., Any], phrase: Phrase, direction: Direction, _: int, site: str | None) -> Any:
        begins = ({"start": phrase.start} if started else {}) | ({} if site is None else {"site": site})
        values = {name: phrase.named[key] if key in phrase.named else phrase.one(key) for name, key in arguments.items()}
        return shape(direction=direction, **values, **begins)

    return make


def vibration_arguments(phrase: Phrase, direction: Direction, number: int) -> Entries:
    """Return the arguments of a random vibration from its phrase; the direction's `number` among several adds to the seed."""
    seed = phrase.named.get("seed", 1.0)
    if seed != int(seed) or not 0 <= seed <= LARGEST_SEED:
        raise ValueError(f"a seed is an integer from 0 to {LARGEST_SEED}, got {seed:.17g}.")
    ramps = {"rise": phrase.named.get("rise"), "fall": phrase.named.get("fall"), "start": phrase.start}
    return {"duration": phrase.one("time"), "seed": int(seed) + number, "direction": direction, **ramps}


def file_first(read: Callable[[Path], Read]) -> Callable[[str, Path], tuple[Read, str]]:
    """Return a function that reads the file named first in a phrase, spaces allowed, and returns content and remaining text."""

    def begins(text: str, folder: Path) -> tuple[Read, str]:
        words = text.split(" ")
        for count in range(len(words), 0, -1):
            path = folder / " ".join(words[:count])
            if isfile(path):
                return read(path), " ".join(words[count:])
        raise ValueError(f'there is no file "{short(words[0])}".')

    return begins


def site_first(text: str, _: Path) -> tuple[str, str]:
    """Split the site from the beginning of a phrase; return it and the rest."""
    site, _space, rest = text.strip().partition(" ")
    if NUMBER.match(site):
        raise ValueError(f"the name of a site for forces must stand first, got {short(site)!r}.")
    return site, rest
