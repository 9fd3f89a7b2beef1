"""Plots in 2D views: a frame with ticks and numbers, and the map from the numbers to the view."""

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
import rerun as rr

from wirerope_mj.foundation.arrays import Array, ArrayLike
from wirerope_mj.views.colours import DARK
from wirerope_mj.views.recording.paths import Stream

HEIGHT = 100.0  # Height of a plot's frame, in units of its view
LARGE = 4.5  # `lift` for a view that fills half the screen's height
GROUND = DARK.ground  # Behind every plot, whatever the viewer's theme: the colours of the lines are made for it
_FRAME = (120, 126, 134)
_GRID = (52, 57, 64)
_ZERO = (104, 110, 118)
_TICK = (128, 134, 142)
Color = tuple[int, int, int]


@dataclass(frozen=True, kw_only=True)
class Plot:
    """Ranges of a plot across and upward, and the width of its frame in units of the view."""

    across: tuple[float, float]
    upward: tuple[float, float]
    width: float

    @classmethod
    def around(cls, low: Array, high: Array, width: float) -> "Plot":
        """Return a plot of the ranges between two corners (2,), and a little room."""
        room = 0.06 * np.maximum(high - low, 1e-6)
        low, high = low - room, high + room
        return cls(across=(low[0], high[0]), upward=(low[1], high[1]), width=width)

    @property
    def scale(self) -> tuple[float, float]:
        """Units of the view per unit across and upward; the view's y points down."""
        return self.width / (self.across[1] - self.across[0]), -HEIGHT / (self.upward[1] - self.upward[0])

    def points(self, across: ArrayLike, upward: ArrayLike) -> Array:
        """Return positions in the view, (n, 2)."""
        x, y = np.broadcast_arrays(np.asarray(across, dtype=np.float64), np.asarray(upward, dtype=np.float64))
        sx, sy = self.scale
        return np.column_stack([(x.ravel() - self.across[0]) * sx, HEIGHT + (y.ravel() - self.upward[0]) * sy])

    def transform(self) -> rr.Transform3D:
        """Return the map from numbers to the view."""
        sx, sy = self.scale
        return rr.Transform3D(translation=[*self.points(0.0, 0.0)[0], 0.0], scale=[sx, sy, 1.0])


def fitting_width(pane: tuple[float, float], columns: int, rows: int, *, least: float = 0.8) -> float:
    """Return the width of a plot's frame that fills its cell of a pane [points] as far as a width over height of 3."""
    wide, high = pane[0] / columns - 60.0, pane[1] / rows - 62.0  # each view has a title, and ticks need room
    return HEIGHT * min(max(wide / high, least), 3.0)


def log_frame(
    rec: Stream, path: str, plot: Plot, *, across: Array, upward: Array,
    names: tuple[Sequence[str], Sequence[str]] | None = None, marked: Sequence[tuple[float, Color]] = (),
    lift: float = 8.0,
) -> None:  # fmt: skip
    """Log a frame with lines at round numbers, `across` upright and `upward` level, and the numbers, or `names`, beside it.

    `marked` are lines across in a colour of their own. `lift` raises the numbers to stand at their lines, in units of the view:
    the viewer hangs them below their positions, by as much on the screen however large the view is.
    """
    (x0, x1), (y0, y1) = plot.across, plot.upward
    lines = [plot.points([x, x], [y0, y1]) for x in across] + [plot.points([x0, x1], [y, y]) for y in upward]
    colors = [_ZERO if value == 0.0 and names is None else _GRID for value in (*across, *upward)]
    for value, color in marked:
        lines.append(plot.points([value] * 2, [y0, y1]))
        colors.append(color)
    lines.append(plot.points([x0, x1, x1, x0, x0], [y0, y0, y1, y1, y0]))
    colors.append(_FRAME)
    frame = rr.LineStrips2D(lines, colors=colors, radii=rr.Radius.ui_points(0.6), draw_order=-10.0)
    below = plot.points(across, y0) + [0.0, 1.0]
    beside = plot.points(x0, upward) + [-7.5, -lift]
    labels = [f"{value:g}" for value in np.round((*across, *upward), 9) + 0.0] if names is None else [*names[0], *names[1]]
    numbers = rr.Points2D(
        np.concatenate([below, beside]), labels=labels, colors=_TICK, radii=rr.Radius.ui_points(0.0), show_labels=True
    )
    rec.log(path, frame, numbers, static=True)
