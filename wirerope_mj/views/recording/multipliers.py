"""Floquet multipliers of the motion in view, beside the unit circle that they must not leave."""

from typing import Any

import numpy as np

from wirerope_mj.views.recording.along import at_points
from wirerope_mj.views.recording.animation import Animation
from wirerope_mj.views.recording.frame import LARGE, Color, Plot, log_frame
from wirerope_mj.views.recording.paths import child, entity

PATH = "multipliers"

_LARGEST = 2.0
"""Modulus beyond which a multiplier is drawn at the edge of the frame, in its direction."""

_CIRCLE, _INSIDE, _OUTSIDE = (150, 158, 168), (110, 200, 130), (240, 80, 80)


def log_multipliers(rec: Any, animation: Animation, *, width: float) -> None:
    """Log the unit circle, and the multipliers of every motion of the animation."""
    import rerun as rr

    side = _LARGEST * 1.06
    across = side * width / 100.0
    plot = Plot(across=(-across, across), upward=(-side, side), width=width)
    numbers = np.array([-1.0, 0.0, 1.0])
    log_frame(rec, entity(PATH), plot, across=numbers, upward=numbers, lift=LARGE)
    data = child(entity(PATH), "data")
    angle = np.linspace(0.0, 2.0 * np.pi, 181)
    circle = rr.LineStrips2D([np.column_stack([np.cos(angle), np.sin(angle)])], colors=_CIRCLE, radii=0.006)
    rec.log(data, plot.transform(), static=True)
    rec.log(child(data, "circle"), circle, static=True)
    rec.log(child(data, "here"), rr.Points2D.from_fields(radii=rr.Radius.ui_points(5.0), draw_order=50.0), static=True)
    rows = [orbit.floquet_multipliers for orbit in animation.strip.orbits]
    values = np.concatenate(rows)
    modulus = np.abs(values)
    drawn = values * np.minimum(1.0, _LARGEST / np.maximum(modulus, 1e-12))
    colors: list[Color] = [_OUTSIDE if size > 1.0 + 1e-4 else _INSIDE for size in modulus]
    columns = rr.Points2D.columns(positions=np.column_stack([drawn.real, drawn.imag]), colors=colors)
    rec.send_columns(
        child(data, "here"), at_points(animation, animation.strip), columns.partition([row.size for row in rows])
    )
