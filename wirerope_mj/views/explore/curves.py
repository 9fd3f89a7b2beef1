"""Curves of a run and the one before it, of the same component: the two are laid over each other."""

from typing import Any

import numpy as np

from wirerope_mj.assessment.criteria import MountPeak
from wirerope_mj.engine.response import Response
from wirerope_mj.foundation.arrays import Array
from wirerope_mj.foundation.units import in_unit
from wirerope_mj.mounts.isolator import AXES
from wirerope_mj.mounts.isolator.travel import RATINGS, SIDES
from wirerope_mj.views.explore.shown import ShownRun
from wirerope_mj.views.thin import rows_of_extremes

_POINTS = 1500
"""Points of a curve on the page: two for every pixel of its width, so that no peak is lost."""


def deflection_curve(mount: MountPeak, now: ShownRun, before: ShownRun | None) -> dict[str, Any]:
    """Return the deflection of a mount along the axis that governs it, with its rated travel [ms, mm]."""
    axis = governing_axis(mount)
    below, above = (mount.travel[side].limit for side in SIDES[AXES[axis]])

    def deflection(response: Response) -> Array | None:
        history = response.mounts.get(mount.name)
        return None if history is None else in_unit(history.deflection[:, axis], "mm")

    rated = [-below] if below is not None else []
    rated += [above] if above is not None else []
    return {
        "title": f"Deflection of {mount.name}, {AXES[axis]}",
        "unit": "mm",
        "limits": [in_unit(limit, "mm") for limit in rated],
        "limit": "rated travel",
        "lines": _lines(now, before, deflection),
    }


def acceleration_curve(part: str, now: ShownRun, before: ShownRun | None) -> dict[str, Any]:
    """Return the size of the acceleration of a body or a point [ms, g]."""

    def acceleration(response: Response) -> Array | None:
        history = response.bodies.get(part) or response.points.get(part)
        if history is None:
            return None
        return in_unit(np.asarray(np.linalg.norm(history.acceleration, axis=1)), "g")

    limits = [row.limit for row in now.verdicts if (row.criterion, row.subject) == ("acceleration", part)]
    return {
        "title": f"Acceleration of {part}, all axes together",
        "unit": "g",
        "limits": [in_unit(limit, "g") for limit in limits if limit is not None],
        "limit": "limit",
        "lines": _lines(now, before, acceleration),
    }


def governing_axis(mount: MountPeak) -> int:
    """Return the index of the axis of the governing rating; where nothing is rated, that of the largest deflection."""
    if mount.governing:
        return RATINGS[mount.governing][0]
    return int(np.abs([mount.minimum, mount.maximum]).max(axis=0).argmax())


def _lines(now: ShownRun, before: ShownRun | None, of: Any) -> list[dict[str, Any]]:
    """Return the curves, the earlier one first: the later one is drawn over it."""
    lines = []
    for run, role in ((before, "before"), (now, "now")):
        values = None if run is None else of(run.response)
        if run is None or values is None:
            continue
        rows = rows_of_extremes(values[:, np.newaxis], _POINTS)
        time = in_unit(run.response.time[rows], "ms")
        lines.append({"role": role, "name": run.name, "x": _short(time), "y": _short(values[rows])})
    return lines


def _short(values: Array) -> list[float]:
    """Return values with five digits, as many as a picture shows."""
    return [float(f"{value:.5g}") for value in values]
