"""The table of colours by meaning, on a light and on a dark ground, that every output takes its colours from.

Texts and lines have a contrast of 4.5 at least; those that are drawn together are 8 dE (CIEDE2000) apart, in normal colour
vision and without one kind of cones. Red is what is exceeded, and nothing else.
"""

import math
from dataclasses import asdict, dataclass

import numpy as np

from wirerope_mj.content.blocks import BASE, EXCEEDED, LIMIT, MEASURED, MODEL, MOUNTS, OTHERS, PAYLOADS, Field
from wirerope_mj.content.selection import Selection

Color = tuple[int, int, int]


@dataclass(frozen=True, kw_only=True)
class Colours:
    """Colours of what is drawn, and of a page around it."""

    # of curves
    base: Color
    payload: tuple[Color, ...]  # bodies and points, the most critical first
    mount: tuple[Color, ...]  # the most critical first
    measured: Color
    compared: tuple[Color, ...]  # runs, cases, levels or choices in their order
    limit: Color  # of what must not be exceeded, dashed; it is that of texts
    exceeded: Color  # red: limits, values and parts beyond them
    others: Color  # of lines without a name that are texts, too
    faint: Color  # of lines without a name
    # of a page: ground, boxes, texts, lines; of verdicts their text, edge and box
    ground: Color
    box: Color
    text: Color
    heading: Color
    quiet: Color
    accent: Color
    rule: Color
    line: Color
    frame: Color
    within: Color
    within_edge: Color
    within_box: Color
    unjudged: Color
    unjudged_edge: Color
    unjudged_box: Color
    exceeded_box: Color

    def of(self, kind: int | str) -> Color:
        """Find the colour of a kind of curves."""
        if isinstance(kind, int):
            return self.compared[kind % len(self.compared)]
        kinds = {BASE: self.base, OTHERS: self.faint, LIMIT: self.limit, EXCEEDED: self.exceeded, MEASURED: self.measured}
        kinds |= zip((MODEL, *PAYLOADS, *MOUNTS), (self.payload[0], *self.payload, *self.mount), strict=True)
        return kinds[kind]

    @property
    def named(self) -> dict[str, str]:
        """Single colours by name, with dashes, as hexadecimal texts."""
        return {name.replace("_", "-"): hexadecimal(part) for name, part in asdict(self).items() if isinstance(part[0], int)}


LIGHT = Colours(
    base=(64, 68, 74), payload=((20, 70, 140), (13, 129, 117), (101, 110, 67)),
    mount=((119, 21, 241), (169, 77, 166), (63, 52, 41)), measured=(176, 90, 0),
    compared=((18, 100, 200), (176, 90, 0), (92, 24, 160), (10, 125, 110), (176, 48, 144), (77, 92, 0)),
    limit=(28, 36, 48), exceeded=(179, 0, 0), others=(112, 117, 124), faint=(196, 201, 207),
    ground=(255, 255, 255), box=(241, 243, 245), text=(28, 36, 48), heading=(58, 69, 83), quiet=(86, 97, 111),
    accent=(8, 81, 156), rule=(207, 214, 222), line=(230, 234, 238), frame=(138, 144, 153),
    within=(23, 107, 47), within_edge=(26, 127, 55), within_box=(233, 246, 236),
    unjudged=(122, 86, 0), unjudged_edge=(138, 97, 0), unjudged_box=(253, 245, 225), exceeded_box=(252, 235, 234),
)  # fmt: skip
DARK = Colours(
    base=(150, 156, 164), payload=((63, 150, 255), (4, 219, 174), (78, 147, 78)),
    mount=((175, 148, 217), (214, 90, 170), (243, 226, 158)), measured=(253, 170, 80),
    compared=((63, 167, 245), (254, 182, 74), (165, 128, 186), (122, 236, 228), (214, 155, 206), (124, 188, 141)),
    limit=(228, 232, 236), exceeded=(255, 123, 123), others=(138, 144, 153), faint=(86, 92, 100),
    ground=(24, 27, 31), box=(34, 39, 45), text=(228, 232, 236), heading=(205, 213, 221), quiet=(164, 173, 184),
    accent=(109, 184, 248), rule=(58, 65, 74), line=(42, 48, 55), frame=(109, 118, 129),
    within=(111, 208, 141), within_edge=(63, 174, 98), within_box=(23, 48, 31),
    unjudged=(227, 185, 90), unjudged_edge=(200, 154, 44), unjudged_box=(51, 42, 20), exceeded_box=(58, 29, 31),
)  # fmt: skip
# Of the recording, on the dark ground: bars, ropes and nets of the scene, the base's acceleration, what touches, the cursor
STEEL, RUBBER, NET, ARROW, TOUCHING, CURSOR = (
    (176, 184, 194), (64, 66, 72), (120, 220, 200), (255, 196, 60), (250, 160, 60), (255, 255, 255),
)  # fmt: skip
TRIAD = (DARK.compared[4], DARK.compared[5], DARK.compared[0])  # x, y and z
QUIET_LANE, MOVING_LANE, NEAR_LANE, WITHIN_LANE = (58, 66, 76), (48, 84, 110), (150, 100, 10), (34, 84, 50)
# Runs over each other in a recording, as many as can be told apart: the most of one recording
RUNS: tuple[Color, ...] = (*DARK.compared, (236, 218, 152), (160, 120, 100))
KINDS: tuple[int | str, ...] = (*range(len(LIGHT.compared)), BASE, OTHERS, LIMIT, EXCEEDED, MEASURED, MODEL, *PAYLOADS, *MOUNTS)


def class_of(kind: int | str) -> str:
    """Name the class of a kind of curves in a style sheet."""
    return f"c{kind}" if isinstance(kind, int) else kind


def style_sheet() -> str:
    """Write a page's colours as CSS: variables of both schemes, and curves on a dark ground, drawn for a light one."""
    light, dark = (" ".join(f"--{name}: {colour};" for name, colour in scheme.named.items()) for scheme in (LIGHT, DARK))
    curves = " ".join(f".chart .{class_of(kind)} {{ stroke: {hexadecimal(DARK.of(kind))}; }}" for kind in KINDS)
    return f":root {{ {light} }}\n@media screen and (prefers-color-scheme: dark) {{ :root {{ {dark} }} {curves} }}"


def hexadecimal(colour: Color) -> str:
    return f"#{bytes(colour).hex()}"


def colour_of(selection: Selection, name: str) -> Color:
    if selection.run_color is not None:
        return selection.run_color
    return DARK.of(selection.kinds[name]) if name in selection.kinds else DARK.others


_WHITENING = 0.86  # fraction of white in the colour of a field's least value
_LEVELS = 6  # colours in the key of a field


def field_colours(field: Field) -> list[list[str]]:
    """Colour a field's cells, "" without a value: blue, the deeper the larger; red beyond the limit."""
    finite = field.values[np.isfinite(field.values)]
    low, high = (float(finite.min()), float(finite.max())) if finite.size else (0.0, 1.0)
    return [[_shade(value, low, high, field.limit) for value in row] for row in field.values.tolist()]


def field_key(field: Field) -> list[tuple[str, str]]:
    """List the colours and texts of a field's key, from the least value to the largest."""
    finite = field.values[np.isfinite(field.values)]
    if not finite.size:
        return []
    low, high = float(finite.min()), float(finite.max())
    levels = np.linspace(low, high, _LEVELS).tolist()
    texts = [*(f"{level:.3g}" for level in levels[:-1]), f"{high:.3g}: {field.name}"]
    return [(_shade(level, low, high, field.limit), text) for level, text in zip(levels, texts, strict=True)]


def used_colour(utilisation: float) -> str:
    """Colour a utilisation: blue, the deeper the larger; red beyond 1."""
    return hexadecimal(LIGHT.exceeded) if utilisation > 1.0 else _shade(utilisation, 0.0, 1.0, None)


def _shade(value: float, low: float, high: float, limit: float | None) -> str:
    """Mix the colour of a value between `low` and `high`; "" for NaN, red beyond the limit."""
    if not math.isfinite(value):
        return ""
    white = _WHITENING * (1.0 - (value - low) / ((high - low) or 1.0))
    colour = LIGHT.exceeded if limit is not None and value > limit else LIGHT.compared[0]
    red, green, blue = (round(part + white * (255 - part)) for part in colour)
    return hexadecimal((red, green, blue))
