"""Time histories of all runs in the same axes: one plot for every part and direction, and for every mount and axis."""

from typing import Any

import numpy as np

from wirerope_mj.assessment.comparison import Component, difference
from wirerope_mj.foundation.arrays import Array
from wirerope_mj.foundation.units import STANDARD_GRAVITY, in_unit
from wirerope_mj.views.recording.histories import (
    DIRECTIONS,
    FINE,
    SHOWN_LIMIT,
    TOTAL,
    UNITS,
    Marker,
    acceleration_path,
    extreme_marker,
    log_limit,
    log_lines,
    log_marker,
    mount_path,
    norm_marker,
    peak_marker,
)
from wirerope_mj.views.recording.overlay_runs import OverlaidRun, Overlay
from wirerope_mj.views.recording.paths import AXES, child, entity
from wirerope_mj.views.recording.selection import travel_limits

MOST_PARTS = 6
"""Parts whose accelerations are drawn: the base and those with the largest peaks."""


def log_overlaid_histories(rec: Any, overlay: Overlay) -> None:
    """Log the histories of all runs."""
    for part in shown_parts(overlay):
        for direction in (TOTAL, *DIRECTIONS):
            _log_acceleration(rec, overlay, part, direction)
    for axis in overlay.shared.axes:
        for mount in overlay.shared.shown(axis):
            for quantity in UNITS:
                _log_mount(rec, overlay, mount, quantity, axis)
            _log_limits(rec, overlay, mount, axis)
    for thing in differing(overlay):
        _log_difference(rec, overlay, thing)


def shown_parts(overlay: Overlay) -> tuple[Component, ...]:
    """Return the parts whose accelerations are drawn."""
    return overlay.components[:MOST_PARTS]


def differing(overlay: Overlay) -> list[Component | str]:
    """Return the part and the mount whose histories are farthest from those of the first run."""
    apart = [entry.subject for entry in overlay.differences if np.isfinite(entry.ratio)]
    parts = [thing for thing in apart if isinstance(thing, Component) and thing.kind != "base"]
    mounts = [thing for thing in apart if isinstance(thing, str)]
    return [*parts[:1], *mounts[:1]]


def part_path(part: Component, direction: str) -> str:
    """Return the entity of the accelerations of a part."""
    return child(acceleration_path(direction), part.kind, part.name)


def overlaid_mount_path(mount: str, quantity: str, axis: str) -> str:
    """Return the entity of the deflection or force of a mount in an axis."""
    return child(mount_path(quantity, axis), mount)


def difference_path(thing: Component | str) -> str:
    """Return the entity of the differences of a part or a mount."""
    kind, name = ("mount", thing) if isinstance(thing, str) else (thing.kind, thing.name)
    return entity("histories", "difference", kind, name)


def part_markers(overlay: Overlay, part: Component, direction: str) -> list[Marker]:
    """Return the peak of a part in every run that has it."""
    return [_part_marker(run, part, direction) for run in overlay.having(part)]


def mount_markers(overlay: Overlay, mount: str, quantity: str, axis: str) -> list[Marker]:
    """Return the peak of a mount in an axis in every run that has it."""
    return [_mount_marker(run, mount, quantity, axis) for run in overlay.having(mount)]


def _log_acceleration(rec: Any, overlay: Overlay, part: Component, direction: str) -> None:
    drawn, markers = {}, {}
    for run in overlay.having(part):
        values = in_unit(part.acceleration(run.response), "g")
        drawn[run.name] = (
            np.linalg.norm(values, axis=1) if direction == TOTAL else values[:, DIRECTIONS.index(direction)]
        )
        markers[run.name] = _part_marker(run, part, direction)
    _log_runs(rec, part_path(part, direction), overlay.having(part), drawn, markers)


def _part_marker(run: OverlaidRun, part: Component, direction: str) -> Marker:
    peak = part.peak(run.response)
    if direction == TOTAL:
        return norm_marker(run.name, peak, STANDARD_GRAVITY, "g")
    return extreme_marker(run.name, peak, DIRECTIONS.index(direction), STANDARD_GRAVITY, "g")


def _log_mount(rec: Any, overlay: Overlay, mount: str, quantity: str, axis: str) -> None:
    unit, _ = UNITS[quantity]
    runs = overlay.having(mount)
    drawn = {
        run.name: getattr(run.response.mounts[mount], quantity)[:, AXES.index(axis)] / unit for run in runs
    }  # fmt: skip
    markers = {run.name: _mount_marker(run, mount, quantity, axis) for run in runs}
    _log_runs(rec, overlaid_mount_path(mount, quantity, axis), runs, drawn, markers)


def _mount_marker(run: OverlaidRun, mount: str, quantity: str, axis: str) -> Marker:
    peak = getattr(run.response.peaks.mounts[mount], quantity)
    return extreme_marker(run.name, peak, AXES.index(axis), *UNITS[quantity])


def _log_runs(
    rec: Any, path: str, runs: list[OverlaidRun], drawn: dict[str, Array], markers: dict[str, Marker]
) -> None:
    """Log a line and a peak for every run; both have one name, and so one entry in the legend.

    The viewer draws them in the order of their paths: the largest swing comes first, each is thinner than the one before, so
    that what is smaller or coincides is not hidden.
    """
    swings = {name: max(float(np.ptp(values)), 1e-9) for name, values in drawn.items()}
    step = min(1.2, 2.4 / max(len(runs) - 1, 1))
    for rank, run in enumerate(sorted(runs, key=lambda run: swings[run.name], reverse=True)):
        marker, below = markers[run.name], child(path, str(rank), run.name)
        look: dict[str, Any] = {
            "tolerance": FINE * max(swings.values()),
            "width": 1.5 + step * (len(runs) - 1 - rank),
        }
        log_lines(rec, below, run.response.time, drawn[run.name][:, None], [marker.text], [run.color], **look)
        log_marker(rec, below, marker, color=run.color)


def _log_limits(rec: Any, overlay: Overlay, mount: str, axis: str) -> None:
    """Log the rated travel that any run comes near, once where it is the same for all."""
    number = AXES.index(axis)
    runs = overlay.having(mount)
    ends = np.array([min(run.response.time[0] for run in runs), max(run.response.time[-1] for run in runs)])
    near: set[float] = set()
    for run in runs:
        entry = next(entry for entry in run.response.scene.mounts if entry.name == mount)
        peak = run.response.peaks.mounts[mount].deflection
        for limit, reached in zip(travel_limits(entry, axis), (peak.minimum, peak.maximum), strict=True):
            if np.isfinite(limit) and reached[number] / limit >= SHOWN_LIMIT:
                near.add(limit)
    for limit in sorted(near):
        path = child(overlaid_mount_path(mount, "deflection", axis), "rated", f"{in_unit(limit, 'mm'):+.3f}")
        log_limit(rec, path, "rated travel", limit, ends=ends)


def _log_difference(rec: Any, overlay: Overlay, thing: Component | str) -> None:
    """Log how far the histories of a part or a mount are from those of the first run."""
    first, *others = overlay.having(thing)
    unit, unit_name = (1e-3, "mm") if isinstance(thing, str) else (STANDARD_GRAVITY, "g")
    for run in others:
        time, distance = difference(thing, first, run)
        if time.size:
            row, below = int(distance.argmax()), child(difference_path(thing), run.name)
            name = f"{run.name} - {first.name}:"
            marker = peak_marker(name, float(time[row]), float(distance[row]) / unit, unit_name)
            tolerance = FINE * max(float(np.ptp(distance)) / unit, 1e-9)
            log_lines(rec, below, time, distance[:, None] / unit, [marker.text], [run.color], tolerance=tolerance)
            log_marker(rec, below, marker, color=run.color)
