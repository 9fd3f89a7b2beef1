"""The grammar of quantities that people write: numbers with units, alone or in a phrase with words and a direction.

One for motions, decks, forces, durations of tests and limits: "15 g 11 ms z at 50 ms", "10 Hz 800 kg 4 %", "30 30 20 mm".
"""

import math
import re
from collections.abc import Iterable, Mapping
from dataclasses import dataclass

from wirerope_mj.foundation.directions import Direction, directions_in
from wirerope_mj.foundation.plain_text import short
from wirerope_mj.foundation.units import PHRASE_UNITS, in_si

_OF_UNIT = {unit: (quantity, factor) for quantity, units in PHRASE_UNITS.items() for unit, factor in units.items()}
NUMBER = re.compile(r"([-+]?(?:\d+\.?\d*|\.\d+)(?:[eE][-+]?\d+)?)(.*)", re.DOTALL)
_SIGNIFICANT = re.compile(r"[1-9]")


@dataclass(frozen=True, kw_only=True)
class Phrase:
    """A parsed phrase: quantities [SI], values behind words, directions."""

    # values in SI by quantity ("acceleration", "time", ...), in the order of the phrase
    quantities: dict[str, tuple[float, ...]]
    named: dict[str, float]  # value in SI of every word that stood before a number, such as "at"; an integer of "seed"
    directions: tuple[Direction, ...]  # directions of motion; several where axes were named together, as in "xyz"

    @property
    def start(self) -> float:
        """Instant at which the motion begins [s]: the value behind "at"."""
        return self.named.get("at", 0.0)

    def one(self, quantity: str) -> float:
        """Return the first value of a quantity in SI."""
        return self.quantities[quantity][0]


def parse_phrase(text: str, *, words: Mapping[str, str], takes: Iterable[str] = PHRASE_UNITS) -> Phrase:
    """Parse a phrase into quantities, words with values, and directions.

    They stand in any order, separated by spaces: "15 g 11 ms z at 50 ms"; a range is written "5 to 50 Hz". `words` has the
    quantity of the number that follows each known word; "" for one without a unit; `takes` are the quantities whose units
    are told where one is unknown. ValueError: a part of it is not understood, or said twice, or has been left open as `?`;
    says which.
    """
    quantities: dict[str, list[float]] = {}
    named: dict[str, float] = {}
    directions: tuple[Direction, ...] = ()
    parts, word, begun = text.split(), "", ""
    waiting: list[float] = []
    while parts:
        part = parts.pop(0)
        if part == "?":
            level = f"{part} {parts[0]}" if parts else part
            raise ValueError(f'"{level}" is still open: put the level of your specification in place of the question mark.')
        if begun and not NUMBER.match(part):
            break
        if part in words and not word:
            if part in named:
                raise ValueError(f'"{part}" stands there twice.')
            word = part
            continue
        axes = directions_in(part)
        if axes and not word:
            if directions:
                raise ValueError(f'"{part}" is a second direction; name axes together, as in "xz", or give a vector.')
            directions = axes
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
        quantity, factor = _quantity(unit, part, words.get(word, ""), takes)
        values = [in_si(number, factor) for number in (*waiting, value)]
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
    """Split a part of a phrase into its number and the unit that follows at once, if any; ValueError if it has no number."""
    match = NUMBER.fullmatch(part)
    if match is None:
        raise ValueError(f'"{short(part)}" is neither a number with a unit nor a direction such as z, -y or 1,1,0.')
    if match[2].startswith(","):
        raise ValueError(f'"{short(part)}": decimals are written with a point.')
    value = float(match[1])
    if not math.isfinite(value) or (value == 0.0 and _SIGNIFICANT.search(match[1].lower().partition("e")[0])):
        raise ValueError(f'"{short(part)}" is too {"small" if value == 0.0 else "large"} for a number.')
    return value, match[2]


def _quantity(unit: str, part: str, expected: str, takes: Iterable[str]) -> tuple[str, float]:
    """Return the quantity of a unit and its factor into SI; ValueError if unknown, or of an unexpected quantity."""
    known = PHRASE_UNITS[expected] if expected else _OF_UNIT
    if unit not in known:
        bare = not unit or NUMBER.match(unit) or directions_in(unit)
        fault = f'"{short(part)}" has no unit' if bare else f'"{short(unit)}" is no unit known here'
        told = [one for quantity in ([expected] if expected else takes) for one in PHRASE_UNITS[quantity]]
        raise ValueError(f"{fault}; known are {', '.join(told)}.")
    return _OF_UNIT[unit]


def values_with_unit(text: str, quantity: str, units: Mapping[str, float]) -> tuple[float, ...]:
    """Parse "30 30 20 mm", numbers and their unit, into values in SI; the unit must be one of the quantity.

    ValueError: there is no number, the unit is missing or another, or a number is none that a computer holds.
    """
    parts = text.split()
    match = NUMBER.fullmatch(parts[-1]) if parts else None
    numbers, unit = ([*parts[:-1], match[1]], match[2]) if match else (parts[:-1], parts[-1] if parts else "")
    if unit not in units:
        fault = f"{short(unit)!r} is no unit of {quantity}" if unit else f"{short(text)!r} has no unit"
        raise ValueError(f"{fault}; known are {', '.join(units) or 'none'}.")
    values = []
    for part in numbers:
        if (number := NUMBER.fullmatch(part)) is None or number[2]:
            raise ValueError(f"{short(part)!r} is no number.")
        value = _number(part)[0]
        values.append(in_si(value, units[unit]) or abs(value))  # 5e-324 mm is not 0
    if not values:
        raise ValueError(f"no number stands before {short(unit)!r}.")
    return tuple(values)
