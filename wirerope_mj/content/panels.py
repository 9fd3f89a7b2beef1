"""Curves between two axes, in charts: what pages, pictures, recordings and explore draw of a result."""

from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np

from wirerope_mj.foundation.arrays import Array

BASE, OTHERS = "base", "others"
"""Kinds of curves beside the numbered ones of the table of colours."""


@dataclass(frozen=True, kw_only=True)
class Curve:
    """A line: positions (n,), a name, and its kind, the number of a colour, `BASE` or `OTHERS`; `marks`: dots instead.

    `peak` is its largest value and where it is, of every step and not of the positions alone; None where nobody asks.
    """

    x: Array
    y: Array
    name: str
    kind: int | str
    marks: bool = False
    peak: tuple[float, float] | None = None


@dataclass(frozen=True, kw_only=True)
class Panel:
    """Curves between two axes.

    Attributes:
        curves: the first in front.
        ylabel, xlabel, title: texts; "" for none.
        limits: levels that are dashed, with their names.
        dots: positions of single points.
        xlim, ylim: ranges; None for what the curves take.
        log: whether both axes are logarithmic, or only the one across ("x").
        unit, xunit: of the values that are read.
    """

    curves: Sequence[Curve]
    ylabel: str
    xlabel: str = ""
    title: str = ""
    limits: Sequence[tuple[str, float]] = ()
    dots: Sequence[tuple[float, float]] = ()
    xlim: tuple[float, float] | None = None
    ylim: tuple[float, float] | None = None
    log: str = ""
    unit: str = ""
    xunit: str = "s"


@dataclass(frozen=True, kw_only=True)
class Chart:
    """Panels in rows, whose curves are named once above all of them.

    Attributes:
        rows: of panels beside each other.
        height: of a panel without its texts; a page is 760 wide.
        id: the same in every output.
        caption: what it shows, below it.
        alt: the same in few words, for who cannot see it.
    """

    rows: Sequence[Sequence[Panel]]
    height: float = 120.0
    id: str = ""
    caption: str = ""
    alt: str = ""


_NOTHING = 1e-6  # g or mm: an axis on which nothing is larger has no panel
_FITS = 28  # letters of a name in a legend
_CRESTS = 300  # intervals of an envelope: each should hold a period at least


def short(name: str) -> str:
    """Return a name as it fits a legend, its end kept, where numbers stand; never one that a legend leaves out."""
    fits = name if len(name) <= _FITS else f"{name[: _FITS // 2 - 1]}…{name[-_FITS // 2 :]}"
    return f" {fits}" if fits.startswith("_") else fits  # matplotlib hides labels that begin with an underscore


def crest(x: Array, values: Array) -> tuple[Array, Array]:
    """Return positions and sizes of the largest value of each of many intervals: the envelope of what oscillates."""
    length = max(x.size // _CRESTS, 1)
    parts = values[: length * (x.size // length)].reshape(-1, length)
    rows = length * np.arange(parts.shape[0]) + parts.argmax(axis=1)
    return x[rows], values[rows]


def stacked(panels: Sequence[Panel]) -> Chart:
    """Stack panels over time that are not all zero, at least the last; what their titles say stands in the caption."""
    kept = [one for one in panels if any(np.abs(curve.y).max() > _NOTHING for curve in one.curves)] or panels[-1:]
    rows = [[replace(one, title="", xlabel="time [s]" if one is kept[-1] else "")] for one in kept]
    return Chart(rows=rows, height=190.0 if len(kept) == 1 else 140.0)
