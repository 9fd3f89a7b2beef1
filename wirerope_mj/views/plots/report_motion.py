"""The motion of the base as a chart of a report."""

from dataclasses import replace

import numpy as np

from wirerope_mj.assessment.criteria.foundation import foundation_force
from wirerope_mj.engine.response import Response
from wirerope_mj.foundation.arrays import Array
from wirerope_mj.foundation.units import in_unit
from wirerope_mj.motions import BaseMotion
from wirerope_mj.views.curves import Curve, Panel
from wirerope_mj.views.plots.svg_chart import Chart

_FAINT = 1e-6  # of the largest component of a force, what is not drawn
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


def loads_chart(response: Response, motion: BaseMotion, window: tuple[float, float]) -> Chart:
    """Return forces and moments on the payload, and what the mounts pass on of them: their sum less that of the beginning."""
    panels = []
    for site in motion.loaded_sites:
        load = motion.load(site, response.time)
        panels += [
            _components(response.time, values, f"{what} at {site} [{unit}]", unit, window)
            for values, what, unit in ((load[:, :3], "force", "N"), (load[:, 3:], "moment", "N m"))
            if np.abs(values).max(initial=0.0) > 0.0
        ]
    passed = foundation_force(response)
    panels.append(_components(response.time, passed - passed[0], "on the foundation [N]", "N", window))
    panels[-1] = replace(panels[-1], xlabel="time [s]")
    return Chart(rows=[[panel] for panel in panels], height=95.0)


def _components(time: Array, values: Array, label: str, unit: str, window: tuple[float, float]) -> Panel:
    """Return a panel with the components that are not zero."""
    size = np.abs(values).max(initial=0.0)
    axes = [axis for axis in range(3) if np.abs(values[:, axis]).max(initial=0.0) > _FAINT * size] or [2]
    curves = [Curve(x=time, y=values[:, axis], name="xyz"[axis], kind=axis) for axis in axes]
    return Panel(curves=curves, ylabel=label, xlim=window, unit=unit)


def motion_chart(response: Response, motion: BaseMotion, window: tuple[float, float]) -> Chart:
    """Return acceleration, velocity and displacement of the base over a time window, a line for each axis that moves."""
    axes = moving_axes(response) or [2]
    time, acceleration = base_acceleration(response, motion)
    parts = (
        ("acceleration [g]", "g", time, in_unit(acceleration, "g")),
        ("velocity [m/s]", "m/s", response.time, response.base.velocity),
        ("displ. [mm]", "mm", response.time, in_unit(response.base.displacement, "mm")),
    )
    rows = [
        [
            Panel(
                curves=[Curve(x=x, y=values[:, axis], name="xyz"[axis], kind=axis) for axis in axes],
                ylabel=label,
                xlabel="time [s]" if unit == "mm" else "",
                xlim=window,
                unit=unit,
            )
        ]
        for label, unit, x, values in parts
    ]
    return Chart(rows=rows, height=95.0)
