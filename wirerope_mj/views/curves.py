"""Curves between two axes: what charts of a report and frames of a recording draw."""

from collections.abc import Sequence
from dataclasses import dataclass

from wirerope_mj.foundation.arrays import Array

BASE, OTHERS = "base", "others"
"""Kinds of curves beside the numbered ones of the table of colours."""


@dataclass(frozen=True, kw_only=True)
class Curve:
    """A line: positions (n,), a name, and its kind, the number of a colour, `BASE` or `OTHERS`; `marks`: dots instead."""

    x: Array
    y: Array
    name: str
    kind: int | str
    marks: bool = False


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
