"""Loops of the motions of a branch: they change from point to point, and a cursor runs around them in time."""

from typing import Any

import numpy as np

from wirerope_mj.dynamics.frequency_response.curve import busiest_loops
from wirerope_mj.foundation.arrays import Array
from wirerope_mj.foundation.ticks import linear_ticks
from wirerope_mj.views.recording.along import along_branch, at_points
from wirerope_mj.views.recording.animation import Animation, Strip
from wirerope_mj.views.recording.frame import LARGE, Plot, log_frame
from wirerope_mj.views.recording.loops import loop_points
from wirerope_mj.views.recording.paths import AXES, at, child, entity
from wirerope_mj.views.recording.response_curve import level_color

MOST_LOOPS = 4
"""Loops that are shown: those that take most energy at the highest amplitude."""

SHAPE = "shape"
"""Entity of the loop whose own ranges fill the frame."""

_SHAPE_TICKS = np.array([-1.0, 0.0, 1.0])
_CURSOR = (255, 255, 255)


def shown_loops(animation: Animation) -> list[tuple[str, int]]:
    """Return mount and axis of the loops that are shown."""
    highest = animation.strip.orbits[int(np.argmax(animation.strip.amplitude))]
    return busiest_loops(highest.response)[:MOST_LOOPS]


def loop_path(mount: str, axis: int) -> str:
    """Return the entity of the loops of a mount along an axis."""
    return entity("loops", AXES[axis], mount)


def log_orbit_loops(rec: Any, animation: Animation, strips: list[Strip], *, width: float, shape_width: float) -> None:
    """Log the loops that take most energy, all levels in one frame each, and the shape of the first."""
    shown = shown_loops(animation)
    few = len(shown) <= 2
    lift, most = (LARGE, 6) if few else (2.0 * LARGE, 4)  # of small frames numbers would touch
    for mount, axis in shown:
        loops = [_loops(strip, mount, axis) for strip in strips]
        plot = _plot([loop for part in loops for loop in part], width)
        path = loop_path(mount, axis)
        log_frame(
            rec,
            path,
            plot,
            across=linear_ticks(*plot.across, most=most),
            upward=linear_ticks(*plot.upward, most=most),
            lift=lift,
        )
        _log(rec, child(path, "data"), plot, animation, strips, loops)
        _log_cursor(rec, child(path, "data", "cursor"), animation, loop_points(animation.response.mounts[mount], axis))
    loops = [[_filled(loop) for loop in _loops(strip, *shown[0])] for strip in strips]
    plot = Plot(across=(-1.12, 1.12), upward=(-1.12, 1.12), width=shape_width)
    log_frame(rec, entity(SHAPE), plot, across=_SHAPE_TICKS, upward=_SHAPE_TICKS, lift=LARGE)
    _log(rec, child(entity(SHAPE), "data"), plot, animation, strips, loops)


def _loops(strip: Strip, mount: str, axis: int) -> list[Array]:
    """Return the loops of a mount at every motion of a level [mm, kN], (m, 2) each."""
    return [loop_points(orbit.response.mounts[mount], axis) for orbit in strip.orbits]


def _filled(loop: Array) -> Array:
    """Return a loop over its own half ranges."""
    low, high = loop.min(axis=0), loop.max(axis=0)
    return np.asarray((2.0 * loop - low - high) / np.maximum(high - low, 1e-12))


def _plot(loops: list[Array], width: float) -> Plot:
    low = np.min([loop.min(axis=0) for loop in loops], axis=0)
    high = np.max([loop.max(axis=0) for loop in loops], axis=0)
    return Plot.around(low, high, width)


def _log(rec: Any, path: str, plot: Plot, animation: Animation, strips: list[Strip], loops: list[list[Array]]) -> None:
    """Log the loops of all levels, one row for every motion; that of an unstable motion is thin."""
    import rerun as rr

    rec.log(path, plot.transform(), static=True)
    for strip, rows in zip(strips, loops, strict=True):
        below = child(path, f"level_{strip.number + 1}")
        stable = strip.branch.stable[strip.points]
        radii = [rr.Radius.ui_points(1.5 if good else 0.7) for good in stable]
        rec.log(below, rr.LineStrips2D.from_fields(colors=level_color(strip.number)), static=True)
        columns = rr.LineStrips2D.columns(strips=[loop.astype(np.float32) for loop in rows], radii=radii)
        rec.send_columns(below, at_points(animation, strip), columns)


def _log_cursor(rec: Any, path: str, animation: Animation, points: Array) -> None:
    """Log deflection and force of the mount at every instant of the animation."""
    import rerun as rr

    look = rr.Points2D.from_fields(colors=_CURSOR, radii=rr.Radius.ui_points(4.5), draw_order=50.0)
    rec.log(path, look, static=True)
    along_branch(rec, animation).send_columns(path, at(animation.response.time), rr.Points2D.columns(positions=points))
