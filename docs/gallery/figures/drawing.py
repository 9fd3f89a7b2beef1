"""How all pictures of the gallery look: sizes, colours, axes, arrows of the motion."""

from collections.abc import Sequence
from typing import Any

import numpy as np
import numpy.typing as npt
from matplotlib.figure import Figure as Picture
from matplotlib.layout_engine import ConstrainedLayoutEngine

BLUES = ("#9ecae1", "#4292c6", "#2171b5", "#08306b")
"""Growing amplitudes."""
COLOURS = ("#0072b2", "#d55e00", "#009e73", "#7b3294", "#8c6d1f")
"""Different parameters: apart for most colour-blind readers."""
INK = "#222222"
GUIDE = "#777777"

_WIDTH = 8.0  # [in], 880 points wide at 110 dpi: sharp where a page shows pictures 700 wide
_DPI = 110


def canvas(columns: int, *, rows: int = 1, height: float = 3.7) -> tuple[Picture, list[Any]]:
    """Return a picture of `rows` x `columns` panels, each row `height` inches high, and its panels."""
    picture = Picture(figsize=(_WIDTH, rows * height), layout=ConstrainedLayoutEngine(w_pad=0.06, h_pad=0.06), dpi=_DPI)
    panels = [picture.add_subplot(rows, columns, place + 1) for place in range(rows * columns)]
    for panel in panels:
        panel.grid(color="0.92")
        panel.set_axisbelow(True)
        panel.axhline(0.0, color="0.6", lw=0.8, zorder=1)
        panel.axvline(0.0, color="0.6", lw=0.8, zorder=1)
        panel.tick_params(labelsize=9)
    return picture, panels


def inscribe(panel: Any, title: str, across: str, up: str) -> None:
    """Write the title and the names of the axes, with units."""
    panel.set_title(title, fontsize=10, color=INK)
    panel.set_xlabel(across, fontsize=10)
    panel.set_ylabel(up, fontsize=10)


def explain(panel: Any, *, place: str = "upper left", title: str | None = None, columns: int = 1) -> None:
    """Put the legend; "below" the panel, where it covers nothing."""
    look = {"fontsize": 8.5, "title_fontsize": 8.5, "framealpha": 0.92, "handlelength": 1.4, "alignment": "left"}
    if place == "below":
        look |= {"bbox_to_anchor": (0.5, -0.17), "frameon": False}
    panel.legend(loc="upper center" if place == "below" else place, title=title, ncols=columns, **look)


def show_direction(
    panel: Any,
    x: npt.NDArray[np.float64],
    y: npt.NDArray[np.float64],
    colour: str,
    *,
    at: Sequence[float] = (0.13, 0.63),
) -> None:
    """Put arrow heads on a curve, at these shares of its samples, pointing the way it is run through."""
    for share in at:
        index = min(int(share * x.size), x.size - 2)
        # Two samples apart: the head alone is seen, and it lies along the curve.
        tail, tip = (x[index - 1], y[index - 1]), (x[index + 1], y[index + 1])
        look = {"arrowstyle": "-|>", "color": colour, "lw": 0.1, "mutation_scale": 13, "shrinkA": 0, "shrinkB": 0}
        panel.annotate("", xy=tip, xytext=tail, arrowprops=look, zorder=4)


def note(panel: Any, text: str, at: tuple[float, float], *, colour: str = INK, **where: Any) -> None:
    """Write a remark at a point of the panel."""
    box = {"boxstyle": "square,pad=0.15", "fc": "white", "ec": "none", "alpha": 0.85}
    panel.annotate(text, xy=at, fontsize=8.5, color=colour, bbox=box, zorder=6, **where)
