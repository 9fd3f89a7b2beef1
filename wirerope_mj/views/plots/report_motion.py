"""The motion of the base as a picture of a report."""

import numpy as np
from matplotlib.figure import Figure

from wirerope_mj.engine.response import Response
from wirerope_mj.foundation.arrays import Array
from wirerope_mj.foundation.units import in_unit
from wirerope_mj.motions import BaseMotion
from wirerope_mj.views.plots.plain_figure import PlainFigure
from wirerope_mj.views.plots.report_image import COLOURS, WIDTH, dress, legend_above, line, report_style

_STILL = 1e-12  # m: an axis that moves less does not move
_MOST_CORNERS = 100  # a record has a corner at every sample: its samples are enough
_BETWEEN = 64  # instants between two corners: the peak of a half-sine is then met to 0.03 %
_MOST_SAMPLES = 200_000  # of a response whose corners are joined to its samples


def moving_axes(response: Response) -> list[int]:
    """Return the axes along which the base moves, 0 = x; none if it rests."""
    return [axis for axis in range(3) if np.abs(response.base.displacement[:, axis]).max(initial=0.0) > _STILL]


def base_acceleration(response: Response, motion: BaseMotion) -> tuple[Array, Array]:
    """Return instants [s] and acceleration [m/s^2] (n_t, 3) of the base, corners and what lies between them included."""
    corners = motion.corners
    if corners.size > _MOST_CORNERS or response.time.size > _MOST_SAMPLES:
        return response.time, response.base.acceleration
    inside = corners[(corners > response.time[0]) & (corners <= response.time[-1])]
    between = np.linspace(inside[:-1], inside[1:], _BETWEEN + 1).ravel() if inside.size > 1 else inside
    time = np.unique(np.concatenate([response.time, between, np.nextafter(inside, -np.inf)]))  # both sides of a jump
    return time, motion.acceleration(time)


def motion_figure(response: Response, motion: BaseMotion) -> Figure:
    """Return acceleration, velocity and displacement of the base over time, a line for each axis that moves."""
    axes = moving_axes(response) or [2]
    time, acceleration = base_acceleration(response, motion)
    with report_style():
        figure = PlainFigure(figsize=(WIDTH, 3.7), layout="constrained")
        panels = figure.subplots(3, 1, sharex=True)
        for axis in axes:
            # Alike in all axes, the lines lie on each other: each is narrower than the one before.
            label, colour, width = "xyz"[axis], COLOURS[axis], 1.0 + 0.9 * (len(axes) - 1 - axes.index(axis))
            line(panels[0], time, in_unit(acceleration[:, axis], "g"), label, colour, lw=width)
            line(panels[1], response.time, response.base.velocity[:, axis], label, colour, lw=width)
            line(panels[2], response.time, in_unit(response.base.displacement[:, axis], "mm"), label, colour, lw=width)
        for panel, name in zip(panels, ("acceleration\n[g]", "velocity\n[m/s]", "displacement\n[mm]"), strict=True):
            dress(panel, ylabel=name)
        panels[-1].set_xlabel("time [s]")
        legend_above(figure, panels[0])
    return figure
