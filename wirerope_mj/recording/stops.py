"""Stops among the mounts in the 3D scene: bumpers on the base that change colour while they are closed."""

from typing import Any

import numpy as np
import numpy.typing as npt

from wirerope_mj.recording.paths import Rows, at, child
from wirerope_mj.recording.poses import Frame, quaternion_of
from wirerope_mj.response import Response
from wirerope_mj.response.scene import SceneMount

OPEN, CLOSED = (150, 158, 168), (240, 96, 30)

_MOST_LABELS = 12


def closed_at(response: Response, stops: tuple[SceneMount, ...]) -> npt.NDArray[np.bool_]:
    """Return whether any of some stops presses at each sample, (n_t,)."""
    pressing = [response.mounts[stop.name].force.any(axis=1) for stop in stops]
    return np.asarray(np.any(pressing, axis=0))


def changes(state: npt.NDArray[Any]) -> Rows:
    """Return the rows at which a state is another than before, the first one in any case."""
    return np.flatnonzero(np.diff(state.astype(int), prepend=-1))


def log_stops(rec: Any, response: Response, frames: dict[str, Frame], *, extent: float) -> None:
    """Log every stop as a bumper about its place on the base; one whose device states no size suits a scene of `extent` [m]."""
    import rerun as rr

    stops = response.scene.stops
    for stop in stops:
        height = stop.height if np.isfinite(stop.height) else float(np.clip(0.03 * extent, 0.01, 0.1))
        width = stop.width if np.isfinite(stop.width) else 1.1 * height
        path = child(frames[stop.base_body].path, "stops", stop.name)
        bumper = rr.Cylinders3D(
            lengths=[height],
            radii=[0.5 * width],
            centers=[stop.base_point],
            quaternions=[rr.Quaternion(xyzw=np.roll(quaternion_of(stop.axes), -1))],
            labels=[stop.name],
            show_labels=len(stops) <= _MOST_LABELS,
            fill_mode="Solid",
        )
        rec.log(path, bumper, static=True)
        closed = closed_at(response, (stop,))
        rows = changes(closed)
        colors = [CLOSED if closed[row] else OPEN for row in rows]
        rec.send_columns(path, at(response.time[rows]), rr.Cylinders3D.columns(colors=colors))
