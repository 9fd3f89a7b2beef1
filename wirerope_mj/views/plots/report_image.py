"""Figures as images for a report: vector graphics where they are small, pixels where they are not."""

import re
from collections.abc import Iterator
from contextlib import contextmanager
from dataclasses import dataclass
from io import BytesIO
from typing import Any

import matplotlib
from matplotlib.figure import Figure
from matplotlib.ticker import FixedFormatter, FixedLocator, NullLocator

from wirerope_mj.foundation.ticks import log_ticks
from wirerope_mj.views.colours import LIGHT

WIDTH = 7.0
"""Width of a figure [in]: that of the text on A4."""

COLOURS = tuple(f"#{bytes(color).hex()}" for color in LIGHT.series)
BASE, RATED = (f"#{bytes(color).hex()}" for color in (LIGHT.others, LIGHT.limit))

_LARGEST_SVG = 200_000
"""Bytes above which a figure is stored as pixels: those of a full-width figure take about as much."""

_PIXELS = 150
"""Of a figure stored as pixels, per inch: its letters stay sharp in print."""

_MM = 25.4  # of an inch

_STYLE = {
    "font.size": 8.0,
    "axes.titlesize": 8.5,
    "axes.titleweight": "bold",
    "legend.fontsize": 7.0,
    "legend.framealpha": 0.85,
    "lines.linewidth": 0.9,
    "path.simplify_threshold": 0.3,
    "svg.hashsalt": "wirerope",  # the same picture gives the same bytes
}


@dataclass(frozen=True, kw_only=True)
class Image:
    """A drawn picture.

    Attributes:
        data: bytes of the file.
        kind: "svg" or "png".
        width, height: size on paper [mm].
    """

    data: bytes
    kind: str
    width: float
    height: float


@contextmanager
def report_style() -> Iterator[None]:
    """Draw what the block draws with the letters and lines of a report."""
    with matplotlib.rc_context(_STYLE):
        yield


def image_of(figure: Figure, *, detailed: bool = False) -> Image:
    """Return a finished figure as SVG, or as PNG if the SVG is large.

    Args:
        figure: what was drawn.
        detailed: whether it is known to hold too much for an SVG, which then is not even tried.
    """
    with report_style():
        vector = BytesIO()
        if not detailed:
            figure.savefig(vector, format="svg", metadata={"Date": None})
        data, kind = _rounded(vector.getvalue()), "svg"
        if detailed or len(data) > _LARGEST_SVG:
            pixels = BytesIO()
            figure.savefig(pixels, format="png", dpi=_PIXELS)
            data, kind = pixels.getvalue(), "png"
    width, height = (float(round(_MM * size, 1)) for size in figure.get_size_inches())
    return Image(data=data, kind=kind, width=width, height=height)


def round_ticks(axis: Any, low: float, high: float, *, most: int = 12) -> None:
    """Give a logarithmic axis from `low` to `high` at most about `most` ticks at round numbers, written as such."""
    ticks = log_ticks(low, high, most=most)
    axis.set_major_locator(FixedLocator(ticks.tolist()))
    axis.set_major_formatter(FixedFormatter([f"{tick:.6g}" for tick in ticks]))
    axis.set_minor_locator(NullLocator())


def _rounded(svg: bytes) -> bytes:
    """Return the file with the points of its paths to a hundredth of a printer's point: nobody sees more."""
    return re.sub(rb' d="[^"]*"', lambda match: re.sub(rb"(\.\d\d)\d+", rb"\1", match[0]), svg)
