"""Curves between two axes, in charts: what pages, pictures, recordings and explore draw of a result."""

from collections.abc import Sequence
from dataclasses import KW_ONLY, dataclass, replace

import numpy as np

from wirerope_mj.foundation.arrays import Array

WIDTH, LEFT, RIGHT = 760.0, 58.0, 16.0  # of a chart, about pixels of a page; margins beside its panels
# Kinds of curves beside the numbered colours; the last: what must not be exceeded
BASE, OTHERS, LIMIT = "base", "others", "limit"


@dataclass(frozen=True)
class Curve:
    """A line, dots, or bars."""

    # x, y: positions, (n,)
    x: Array
    y: Array
    _: KW_ONLY
    name: str  # in the legend; "" for none
    kind: int | str  # number of a colour, `BASE`, `OTHERS` or `LIMIT`
    marks: bool = False  # whether dots are drawn at the positions instead of a line
    bars: float = 0.0  # height of the bars that go from zero to each x instead; 0 for none
    ends: Array | None = None  # of an interval across the end of each bar, (n, 2)
    dash: str = ""  # "dashed" or "dotted"
    weight: float = 1.0  # width of the line, size of the dots, times the usual
    opacity: float = 1.0  # from 0 to 1, by which curves of a family are told apart
    # largest value of every step and where it is; None if unmarked
    peak: tuple[float, float] | None = None


@dataclass(frozen=True, kw_only=True)
class Field:
    """Values over two axes as colours of cells."""

    # x, y: edges of the cells, (n_x + 1,) and (n_y + 1,), rising
    x: Array
    y: Array
    values: Array  # (n_y, n_x); NaN for none
    name: str  # of what they are, with the unit
    limit: float | None = None  # beyond which a value is set apart; None for none


Note = tuple[float, float, str, bool]  # A text beside a position, and whether it stands on its left
Ticks = Sequence[tuple[float, str]]  # Positions along an axis with their texts; empty for round numbers


@dataclass(frozen=True)
class Panel:
    """Curves between two axes."""

    curves: Sequence[Curve]  # the first in front
    # ylabel, xlabel, title: texts; "" for none
    ylabel: str
    _: KW_ONLY
    xlabel: str = ""
    title: str = ""
    limits: Sequence[tuple[str, float]] = ()  # levels that are dashed, with their names
    xlimits: Sequence[tuple[str, float]] = ()  # the same across
    dots: Sequence[tuple[float, float]] = ()  # positions of single points
    notes: Sequence[Note] = ()  # texts at positions
    field: Field | None = None  # behind the curves; None for none
    # yticks, xticks: where round numbers would not do: names of bars, angles
    yticks: Ticks = ()
    xticks: Ticks = ()
    bands: Sequence[tuple[str, float, float]] = ()  # ranges across that are shaded, with their names
    # xlim, ylim: ranges; None for what the curves take
    xlim: tuple[float, float] | None = None
    ylim: tuple[float, float] | None = None
    log: str = ""  # whether both axes are logarithmic, or only the one across ("x")
    # unit, xunit: of the values that are read
    unit: str = ""
    xunit: str = "s"


@dataclass(frozen=True, kw_only=True)
class Chart:
    """Panels in rows, whose curves are named once above all of them."""

    rows: Sequence[Sequence[Panel]]  # of panels beside each other
    height: float = 120.0  # of a panel without its texts; a page is `WIDTH` wide
    id: str = ""  # the same in every output
    caption: str = ""  # what it shows, below it
    alt: str = ""  # the same in few words, for who cannot see it


_NOTHING = 1e-6  # g or mm: an axis on which nothing is larger has no panel
_FITS = 28  # letters of a name in a legend
_CRESTS = 300  # intervals of an envelope: each should hold a period at least


def short(name: str, most: int = _FITS) -> str:
    return name if len(name) <= most else f"{name[: most // 2 - 1]}…{name[-most // 2 :]}"


def crest(x: Array, values: Array) -> tuple[Array, Array]:
    length = max(x.size // _CRESTS, 1)
    parts = values[: length * (x.size // length)].reshape(-1, length)
    rows = length * np.arange(parts.shape[0]) + parts.argmax(axis=1)
    return x[rows], values[rows]


def stacked(panels: Sequence[Panel]) -> Chart:
    kept = [panel for panel in panels if any(np.abs(curve.y).max() > _NOTHING for curve in panel.curves)] or panels[-1:]
    rows = [[replace(panel, title="", xlabel="time [s]" if panel is kept[-1] else "")] for panel in kept]
    return Chart(rows=rows, height=190.0 if len(kept) == 1 else 140.0)


def with_room(x: Array, part: float = 0.05) -> tuple[float, float]:
    room = part * float(np.ptp(x)) or 1.0
    return float(x.min()) - room, float(x.max()) + room
