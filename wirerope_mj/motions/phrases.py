"""Phrases that say a base motion, as `15 g 11 ms z at 50 ms`: numbers with units, a direction, and words before a number."""

import math
import re
from collections.abc import Callable, Mapping
from dataclasses import dataclass, field
from os.path import isfile  # as `Path.is_file`, but a name that is too long is none
from pathlib import Path
from typing import Any, TypeVar

from wirerope_mj.foundation.arrays import Entries
from wirerope_mj.foundation.directions import Direction, directions_in
from wirerope_mj.foundation.plain_text import short
from wirerope_mj.foundation.units import ACCELERATION_UNITS, FORCE_UNITS, LENGTH_UNITS, TIME_UNITS, in_si

# quantities that a unit tells apart, and what one of each unit is in SI; of a sweep rate in octaves/min
UNITS: dict[str, Mapping[str, float]] = {
    "acceleration": ACCELERATION_UNITS,
    "velocity": {"m/s": 1.0, "mm/s": 1e-3, "cm/s": 1e-2, "in/s": 0.0254, "ft/s": 0.3048},
    "displacement": LENGTH_UNITS,
    "time": TIME_UNITS,
    "frequency": {"Hz": 1.0, "kHz": 1e3},
    "sweep rate": {"oct/min": 1.0, "octaves/min": 1.0, "oct/s": 60.0},
    "ratio": {"%": 0.01},
    "force": FORCE_UNITS,
    "moment": {"N.m": 1.0, "Nm": 1.0, "kN.m": 1e3, "kNm": 1e3},
    "impulse": {"N.s": 1.0, "Ns": 1.0, "kN.s": 1e3, "kNs": 1e3},
    "pressure": {"Pa": 1.0, "kPa": 1e3, "MPa": 1e6, "bar": 1e5, "psi": 6894.757293168},
    "areal mass": {"kg/m2": 1.0, "kg/m^2": 1.0},
    "mass": {"kg": 1.0, "t": 1e3},
    "unbalance": {"kg.m": 1.0, "kg.mm": 1e-3, "g.m": 1e-3, "g.mm": 1e-6},
}
_OF_UNIT = {unit: (quantity, factor) for quantity, units in UNITS.items() for unit, factor in units.items()}
_NUMBER = re.compile(r"([-+]?(?:\d+\.?\d*|\.\d+)(?:[eE][-+]?\d+)?)(.*)", re.DOTALL)
_SIGNIFICANT = re.compile(r"[1-9]")
START = {"at": "time"}
LASTING = START | {"seed": "", "rise": "time", "fall": "time"}  # of a random vibration
LARGEST_SEED = 2**53 - 1  # of a phrase: numbers are read as floats, and of larger ones neighbours would be one

Read = TypeVar("Read")


@dataclass(frozen=True, kw_only=True)
class Phrase:
    """What a phrase says."""

    # values in SI by quantity ("acceleration", "time", ...), in the order of the phrase
    quantities: dict[str, tuple[float, ...]]
    named: dict[str, float]  # value in SI of every word that stood before a number, such as "at"; an integer of "seed"
    directions: tuple[Direction, ...]  # directions of motion; several where axes were named together, as in "xyz"

    @property
    def start(self) -> float:
        """Instant at which the motion begins [s]: what stands behind "at"."""
        return self.named.get("at", 0.0)

    def one(self, quantity: str) -> float:
        """Return the first value of a quantity in SI."""
        return self.quantities[quantity][0]


def parse_phrase(text: str, *, words: Mapping[str, str]) -> Phrase:
    """Parse a phrase into quantities, words with values, and directions.

    They stand in any order, separated by spaces: "15 g 11 ms z at 50 ms"; a range is written "5 to 50 Hz". `words` has the
    quantity of the number that follows each known word; "" for one without a unit. ValueError: a part of it is not
    understood, or said twice, or has been left open as `?`; says which.
    """
    quantities: dict[str, list[float]] = {}
    named: dict[str, float] = {}
    directions: tuple[Direction, ...] = ()
    parts, word, begun = text.split(), "", ""
    waiting: list[float] = []
    while parts:
        part = parts.pop(0)
        if part == "?":
            left = f"{part} {parts[0]}" if parts else part
            raise ValueError(f'"{left}" is still open: put the level of your specification in place of the question mark.')
        if begun and not _NUMBER.match(part):
            break
        if part in words and not word:
            if part in named:
                raise ValueError(f'"{part}" stands there twice.')
            word = part
            continue
        found = directions_in(part)
        if found and not word:
            if directions:
                raise ValueError(f'"{part}" is a second direction; name axes together, as in "xz", or give a vector.')
            directions = found
            continue
        value, unit = _number(part)
        if word and words[word] == "":
            if unit:
                raise ValueError(f'"{word}" takes a number without a unit, and "{short(part)}" stands there.')
            named[word], word = value, ""
            continue
        unit = unit or (parts.pop(0) if parts else "")
        if unit == "to":
            waiting, begun = [*waiting, value], f"{begun}{part} to "
            continue
        if word and waiting:
            raise ValueError(f'"{word}" takes one value, and "{short(f"{begun}{part}")}" is a range.')
        quantity, factor = _quantity(unit, part, words.get(word, ""))
        values = [in_si(one, factor) for one in (*waiting, value)]
        if not all(map(math.isfinite, values)):
            raise ValueError(f'"{short(part)} {short(unit)}" is too large for a number.')
        waiting, begun = [], ""
        if word:
            named[word], word = values[-1], ""
        else:
            quantities.setdefault(quantity, []).extend(values)
    if begun:
        raise ValueError(f'no number follows "{short(begun.strip())}".')
    if word:
        raise ValueError(f'nothing follows "{word}".')
    said = {name: tuple(some) for name, some in quantities.items()}
    return Phrase(quantities=said, named=named, directions=directions)


def _number(part: str) -> tuple[float, str]:
    match = _NUMBER.fullmatch(part)
    if match is None:
        raise ValueError(f'"{short(part)}" is neither a number with a unit nor a direction such as z, -y or 1,1,0.')
    if match[2].startswith(","):
        raise ValueError(f'"{short(part)}": decimals are written with a point.')
    value = float(match[1])
    if not math.isfinite(value) or (value == 0.0 and _SIGNIFICANT.search(match[1].lower().partition("e")[0])):
        raise ValueError(f'"{short(part)}" is too {"small" if value == 0.0 else "large"} for a number.')
    return value, match[2]


def _quantity(unit: str, part: str, expected: str) -> tuple[str, float]:
    """Return quantity and factor into SI of a unit; ValueError if it is unknown, or of another quantity than expected."""
    known = UNITS[expected] if expected else _OF_UNIT
    if unit not in known:
        bare = not unit or _NUMBER.match(unit) or directions_in(unit)
        fault = f'"{short(part)}" has no unit' if bare else f'"{short(unit)}" is no unit known here'
        raise ValueError(f"{fault}; known are {', '.join(known)}.")
    return _OF_UNIT[unit]


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
    if _NUMBER.match(site):
        raise ValueError(f"the name of a site for forces must stand first, got {short(site)!r}.")
    return site, rest
