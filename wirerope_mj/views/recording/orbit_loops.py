"""What changes from motion to motion of a branch: its place on the curves, its loops and their cursor, its multipliers."""

from typing import Any

import numpy as np
import rerun as rr

from wirerope_mj.dynamics.frequency_response.curve import busiest_loops
from wirerope_mj.foundation.arrays import Array
from wirerope_mj.foundation.ticks import linear_ticks
from wirerope_mj.views.colours import DARK
from wirerope_mj.views.recording.animation import Animation, Strip, at_points, timelines
from wirerope_mj.views.recording.frame import LARGE, Color, Plot, log_frame
from wirerope_mj.views.recording.loops import loop_points
from wirerope_mj.views.recording.paths import AXES, at, child, entity

MOST_LOOPS = 4  # Loops that are shown: those that take most energy at the highest amplitude
SHAPE = "shape"  # Entity of the loop whose own ranges fill the frame
_SHAPE_TICKS = np.array([-1.0, 0.0, 1.0])
_CURSOR = (255, 255, 255)
MULTIPLIERS = "multipliers"
_LARGEST = 2.0  # Modulus beyond which a multiplier is drawn at the edge of the frame, in its direction
_CIRCLE, _INSIDE, _OUTSIDE = (150, 158, 168), (110, 200, 130), (240, 80, 80)


def _color(level: int) -> Color:
    return DARK.series[level % len(DARK.series)]


def log_here(rec: Any, path: str, animation: Animation, strips: list[Strip]) -> None:
    """Log the motion of every level on its curve, with its values when the mouse is over it."""
    for strip in strips:
        below, branch = child(path, f"level_{strip.number + 1}"), strip.branch
        size = rr.Radius.ui_points(7.0)
        look = rr.Points2D.from_fields(colors=_color(strip.number), radii=size, draw_order=60.0, show_labels=False)
        rec.log(below, look, static=True)
        labels = [
            f"{strip.level:.4g} m/s²: {branch.frequency[point]:.5g} Hz, {branch.amplitude[point]:.4g} m/s², "
            f"{'stable' if branch.stable[point] else 'unstable'}"
            for point in strip.points
        ]
        positions = np.column_stack([np.log10(strip.frequency), np.log10(strip.amplitude)])
        columns = rr.Points2D.columns(positions=positions, labels=labels)
        rec.send_columns(below, at_points(animation, strip), columns)


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
            rec, path, plot, across=linear_ticks(*plot.across, most=most), upward=linear_ticks(*plot.upward, most=most),
            lift=lift,
        )  # fmt: skip
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
    rec.log(path, plot.transform(), static=True)
    for strip, rows in zip(strips, loops, strict=True):
        below = child(path, f"level_{strip.number + 1}")
        stable = strip.branch.stable[strip.points]
        radii = [rr.Radius.ui_points(1.5 if good else 0.7) for good in stable]
        rec.log(below, rr.LineStrips2D.from_fields(colors=_color(strip.number)), static=True)
        columns = rr.LineStrips2D.columns(strips=[loop.astype(np.float32) for loop in rows], radii=radii)
        rec.send_columns(below, at_points(animation, strip), columns)


def _log_cursor(rec: Any, path: str, animation: Animation, points: Array) -> None:
    """Log deflection and force of the mount at every instant of the animation."""
    look = rr.Points2D.from_fields(colors=_CURSOR, radii=rr.Radius.ui_points(4.5), draw_order=50.0)
    rec.log(path, look, static=True)
    timelines(rec, animation).send_columns(path, at(animation.response.time), rr.Points2D.columns(positions=points))


def log_multipliers(rec: Any, animation: Animation, *, width: float) -> None:
    """Log the unit circle, and the multipliers of every motion of the animation."""
    side = _LARGEST * 1.06
    across = side * width / 100.0
    plot = Plot(across=(-across, across), upward=(-side, side), width=width)
    numbers = np.array([-1.0, 0.0, 1.0])
    log_frame(rec, entity(MULTIPLIERS), plot, across=numbers, upward=numbers, lift=LARGE)
    data = child(entity(MULTIPLIERS), "data")
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
