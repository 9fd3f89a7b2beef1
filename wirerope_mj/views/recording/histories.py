"""Time histories: accelerations [g], deflections [mm] and forces [kN], with peak markers and rated travel."""

from dataclasses import dataclass
from typing import Any

import numpy as np

from wirerope_mj.engine.response import Peak, Response
from wirerope_mj.foundation.arrays import Array
from wirerope_mj.foundation.units import STANDARD_GRAVITY, in_unit
from wirerope_mj.views.recording.paths import AXES, at, child, entity
from wirerope_mj.views.recording.selection import Selection, travel_limits
from wirerope_mj.views.recording.thin import rows_of_line

DIRECTIONS = ("x", "y", "z")
TOTAL = "total"
UNITS = {"deflection": (1e-3, "mm"), "force": (1e3, "kN")}

FINE = 1 / 400
"""Share of the largest value that a drawn line may be off; below a pixel of a plot of 200."""

SHOWN_LIMIT = 0.5
"""Rated travel is drawn if the deflection reaches this share of it; otherwise it would only flatten the curves."""

LATE = 10.0
"""From this instant on, times are written in seconds [s]."""

_BASE = (150, 156, 164)
_LINES = ((255, 190, 60), (90, 200, 250), (255, 105, 130), (130, 220, 130), (200, 150, 255), (240, 160, 90))
_PEAK = (255, 92, 92)
_LIMIT = (230, 70, 70)


@dataclass(frozen=True, kw_only=True)
class Marker:
    """A peak that is marked in a plot: instant [s], value in the plot's unit, and text."""

    time: float
    value: float
    text: str


def log_histories(rec: Any, response: Response, selection: Selection) -> None:
    """Log all time histories."""
    _log_accelerations(rec, response, selection)
    for axis in selection.axes:
        _log_mounts(rec, response, selection, axis)


def acceleration_path(direction: str) -> str:
    """Return the entity of the accelerations in "x", "y", "z", or of their norms, "total"."""
    return entity("histories", "acceleration", direction)


def mount_path(quantity: str, axis: str) -> str:
    """Return the entity of the "deflection" or "force" of the mounts in an axis."""
    return entity("histories", quantity, axis)


def acceleration_peak(response: Response, selection: Selection, direction: str) -> Marker | None:
    """Return the largest peak of the bodies and points that are shown, of "total" or of a component."""
    peaks = {name: response.peaks.bodies[name].acceleration for name in selection.bodies}
    peaks |= {name: response.peaks.points[name].acceleration for name in selection.points}
    markers = [_acceleration_marker(name, peak, direction) for name, peak in peaks.items()]
    return max(markers, key=lambda marker: abs(marker.value), default=None)


def mount_peak(response: Response, selection: Selection, quantity: str, axis: str) -> Marker:
    """Return the largest peak of the deflection or force of the mounts that are shown in an axis."""
    unit, unit_name = UNITS[quantity]
    peaks = {name: getattr(response.peaks.mounts[name], quantity) for name in selection.shown(axis)}
    markers = [extreme_marker(name, peak, AXES.index(axis), unit, unit_name) for name, peak in peaks.items()]
    return max(markers, key=lambda marker: abs(marker.value))


def _log_accelerations(rec: Any, response: Response, selection: Selection) -> None:
    parts = {"base": response.base.acceleration}
    parts |= {name: response.bodies[name].acceleration for name in selection.bodies}
    parts |= {f"point {name}": response.points[name].acceleration for name in selection.points}
    values = np.stack([in_unit(part, "g") for part in parts.values()], axis=1)  # (n_t, n_parts, 3)
    colors = [_BASE, *(_LINES[n % len(_LINES)] for n in range(len(parts) - 1))]
    top = max(float(np.abs(values).max()), 1e-9)
    for number, direction in enumerate((*DIRECTIONS, TOTAL)):
        drawn = np.linalg.norm(values, axis=2) if direction == TOTAL else values[:, :, number]
        path = acceleration_path(direction)
        log_lines(rec, path, response.time, drawn, [f"{name} [g]" for name in parts], colors, tolerance=FINE * top)
        log_marker(rec, path, acceleration_peak(response, selection, direction))


def _acceleration_marker(name: str, peak: Peak, direction: str) -> Marker:
    if direction != TOTAL:
        return extreme_marker(name, peak, DIRECTIONS.index(direction), STANDARD_GRAVITY, "g")
    return norm_marker(name, peak, STANDARD_GRAVITY, "g")


def norm_marker(name: str, peak: Peak, unit: float, unit_name: str) -> Marker:
    """Return the marker of the largest norm."""
    return peak_marker(name, peak.time, peak.value / unit, unit_name)


def extreme_marker(name: str, peak: Peak, axis: int, unit: float, unit_name: str) -> Marker:
    """Return the marker of the extreme of a component that is farther from zero."""
    high = peak.maximum[axis] >= -peak.minimum[axis]
    value = float((peak.maximum if high else peak.minimum)[axis]) / unit
    time = float((peak.maximum_time if high else peak.minimum_time)[axis])
    return peak_marker(name, time, value, unit_name)


def peak_marker(name: str, time: float, value: float, unit: str) -> Marker:
    """Return the marker of a peak of something called `name`."""
    instant = f"{in_unit(time, 'ms'):.0f} ms" if time < LATE else f"{time:.2f} s"
    return Marker(time=time, value=value, text=f"{name} peak {value:.2f} {unit} @ {instant}")


def _log_mounts(rec: Any, response: Response, selection: Selection, axis: str) -> None:
    number, shown = AXES.index(axis), selection.shown(axis)
    colors = [selection.colors[name] for name in shown]
    for quantity, (unit, unit_name) in UNITS.items():
        values = np.column_stack([getattr(response.mounts[name], quantity)[:, number] / unit for name in shown])
        top = max(float(np.ptp(values)), 1e-9)
        path = mount_path(quantity, axis)
        names = [f"{name} [{unit_name}]" for name in shown]
        log_lines(rec, path, response.time, values, names, colors, tolerance=FINE * top)
        log_marker(rec, path, mount_peak(response, selection, quantity, axis))
    _log_limits(rec, response, selection, axis)


def _log_limits(rec: Any, response: Response, selection: Selection, axis: str) -> None:
    """Log the rated travel of the mount that uses most of it."""
    name = selection.shown(axis)[0]
    mount = next(mount for mount in response.scene.mounts if mount.name == name)
    number = AXES.index(axis)
    peak = response.peaks.mounts[name].deflection
    reached = (float(peak.minimum[number]), float(peak.maximum[number]))
    limits = travel_limits(mount, axis)
    for side, limit, value in zip(("lowest", "highest"), limits, reached, strict=True):
        if np.isfinite(limit) and value / limit >= SHOWN_LIMIT:
            path = child(mount_path("deflection", axis), f"{side}_rated")
            log_limit(rec, path, f"rated travel of {name}", limit, ends=response.time[[0, -1]])


def log_limit(rec: Any, path: str, name: str, limit: float, *, ends: Array) -> None:
    """Log a rated travel [m] as a line between two instants [s]."""
    import rerun as rr

    look = rr.SeriesLines(names=f"{name} {in_unit(limit, 'mm'):.1f} mm", colors=_LIMIT, widths=1.0)
    rec.log(path, look, static=True)
    rec.send_columns(path, at(ends), rr.Scalars.columns(scalars=np.full(2, in_unit(limit, "mm"))))


def log_lines(
    rec: Any,
    path: str,
    time: Array,
    values: Array,
    names: list[str],
    colors: list[Any],
    *,
    tolerance: float,
    width: float = 1.6,
) -> None:
    """Log series (n_t, k) as lines that stay within `tolerance` of every value."""
    import rerun as rr

    rows = rows_of_line(time, values, tolerance)
    # The viewer averages what falls into one pixel unless it is told to keep the extremes: a sweep would vanish.
    keep = ["MinMax"] * len(names)
    look = rr.SeriesLines(names=names, colors=colors, widths=[width] * len(names), aggregation_policy=keep)
    rec.log(path, look, static=True)
    rec.send_columns(path, at(time[rows]), rr.Scalars.columns(scalars=np.ascontiguousarray(values[rows])))


def log_marker(rec: Any, path: str, marker: Marker | None, *, color: tuple[int, int, int] = _PEAK) -> None:
    """Log a peak below the series at `path`, if there is one."""
    import rerun as rr

    if marker is None:
        return
    look = rr.SeriesPoints(names=marker.text, markers="Diamond", marker_sizes=7.0, colors=color)
    rec.log(child(path, "peak"), look, static=True)
    rec.send_columns(child(path, "peak"), at(marker.time), rr.Scalars.columns(scalars=[marker.value]))
