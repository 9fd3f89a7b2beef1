"""The table of colours of series, limits and other lines, on a dark and on a light ground.

Texts in these colours have a contrast of 4.5 at least. Neighbours in the order of the table are 8 dE (CIEDE2000) apart, in
normal colour vision and without one kind of cones. Red is for limits alone.
"""

import math
from dataclasses import dataclass

import numpy as np

from wirerope_mj.content.blocks import Field
from wirerope_mj.content.selection import Selection

Color = tuple[int, int, int]


@dataclass(frozen=True, kw_only=True)
class Colours:
    """Colours of lines on a dark or a light ground."""

    ground: Color  # on which they are read
    # of lines that are distinguished, the most important first: blue, orange, violet, teal, pink, green
    series: tuple[Color, ...]
    limit: Color  # of limits, and of values beyond them
    base: Color  # of the base
    others: Color  # of lines without a name


DARK = Colours(
    ground=(24, 27, 31),
    series=((63, 167, 245), (254, 182, 74), (165, 128, 186), (122, 236, 228), (214, 155, 206), (124, 188, 141)),
    limit=(255, 90, 90), base=(150, 156, 164), others=(138, 144, 153),
)  # fmt: skip
LIGHT = Colours(
    ground=(255, 255, 255), series=((18, 100, 200), (176, 90, 0), (74, 20, 134), (10, 125, 110), (176, 48, 144), (77, 92, 0)),
    limit=(210, 0, 80), base=(64, 68, 74), others=(112, 117, 124),
)  # fmt: skip


def hexadecimal(colour: Color) -> str:
    return f"#{bytes(colour).hex()}"


def colour_of(selection: Selection, name: str) -> Color:
    if selection.run_color is not None:
        return selection.run_color
    return DARK.series[selection.numbers[name]] if name in selection.numbers else DARK.others


_WHITENING = 0.86  # fraction of white in the colour of a field's least value
_LEVELS = 6  # colours in the key of a field


def field_colours(field: Field) -> list[list[str]]:
    """Colour a field's cells, "" without a value: blue, the deeper the larger; red beyond the limit."""
    finite = field.values[np.isfinite(field.values)]
    low, high = (float(finite.min()), float(finite.max())) if finite.size else (0.0, 1.0)
    return [[_shade(value, low, high, field.limit) for value in row] for row in field.values.tolist()]


def field_key(field: Field) -> list[tuple[str, str]]:
    finite = field.values[np.isfinite(field.values)]
    if not finite.size:
        return []
    low, high = float(finite.min()), float(finite.max())
    levels = np.linspace(low, high, _LEVELS).tolist()
    texts = [*(f"{level:.3g}" for level in levels[:-1]), f"{high:.3g}: {field.name}"]
    return [(_shade(level, low, high, field.limit), text) for level, text in zip(levels, texts, strict=True)]


def used_colour(utilisation: float) -> str:
    """Colour a utilisation: blue, the deeper the larger; red beyond 1."""
    return hexadecimal(LIGHT.limit) if utilisation > 1.0 else _shade(utilisation, 0.0, 1.0, None)


def _shade(value: float, low: float, high: float, limit: float | None) -> str:
    """Mix the colour of a value between `low` and `high`; "" for NaN, red beyond the limit."""
    if not math.isfinite(value):
        return ""
    white = _WHITENING * (1.0 - (value - low) / ((high - low) or 1.0))
    colour = LIGHT.limit if limit is not None and value > limit else LIGHT.series[0]
    red, green, blue = (round(part + white * (255 - part)) for part in colour)
    return hexadecimal((red, green, blue))
