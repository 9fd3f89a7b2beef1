"""Time histories: utilisation of limits [%], accelerations [g], deflections [mm] and forces [kN], with peaks and limits.

One run has a graph for every direction and axis, with all its parts in it; several runs have one for every part, with a line
for each run, and the differences to the first run besides.
"""

from collections.abc import Sequence
from typing import Any

import numpy as np

from wirerope_mj.assessment.comparison import BASE, Component, difference
from wirerope_mj.content.contacts import touching
from wirerope_mj.content.selection import travel_limits
from wirerope_mj.engine.response import Peak, Response
from wirerope_mj.foundation.arrays import Array
from wirerope_mj.foundation.units import STANDARD_GRAVITY, in_unit
from wirerope_mj.views.colours import DARK, colour_of
from wirerope_mj.views.recording.drawn_runs import DrawnRun, Overlay
from wirerope_mj.views.recording.graphs import (
    Graph,
    Graphs,
    Limit,
    Lines,
    Marker,
    drawn,
    named_lines,
    thinned,
)
from wirerope_mj.views.recording.paths import AXES, entity

DIRECTIONS = ("x", "y", "z")
TOTAL = "total"
UNITS = {"deflection": (1e-3, "mm"), "force": (1e3, "kN")}

MOST_PARTS = 6
"""Parts whose accelerations are drawn for several runs: the base and those with the largest peaks."""

_FINE = 1 / 400
"""Fraction of the largest value that a drawn line may be off; below a pixel of a plot of 200."""

_SHOWN_LIMIT = 0.5
"""Rated travel is drawn if the deflection reaches this fraction of it; otherwise it would only flatten the curves."""

_LATE = 10.0
"""From this instant on, times are written in seconds [s]."""

USED = "used"
"""Graph of the utilisation of limits."""

CONTACT = "contact"
"""Graphs of what stops and pairs of geoms do."""

_ENTIRE = 1.0
"""Utilisation at which a limit is reached."""


def graphs_of_run(run: DrawnRun) -> Graphs:
    """Return the graphs of a run that is alone: in each all parts, the largest with colours and names."""
    selection = run.selection
    graphs: Graphs = {}
    if selection.used:
        _add_used(graphs, run)
    for direction in (TOTAL, *DIRECTIONS):
        _add_accelerations(graphs, run, direction)
    for axis in selection.axes:
        for quantity in UNITS:
            _add_mounts(graphs, run, quantity, axis)
    _add_contacts(graphs, run)
    return graphs


def _add_used(graphs: Graphs, run: DrawnRun) -> None:
    """Add the utilisation of every subject's limits, the largest over its criteria."""
    used, response = run.selection.used, run.response
    values = np.stack([in_unit(one.course, "%") for one in used], axis=1)
    first = used[0].governing
    marker = None
    if first.time is not None:
        text = f"{first.subject} {in_unit(used[0].largest, '%'):.0f} %"
        marker = Marker(time=first.time, value=in_unit(used[0].largest, "%"), text=text)
    labels = [f"{one.subject} {in_unit(one.largest, '%'):.0f} %" for one in used]
    lines = named_lines(
        response.time, values, labels, [colour_of(run.selection, one.subject) for one in used], _FINE * 100.0, marker
    )
    title = f"Utilisation of limits [%]: {first.subject} {in_unit(used[0].largest, '%'):.0f} % of its limit of "
    limits = [Limit(below=("limit",), name="limit", value=in_unit(_ENTIRE, "%"), unit="%")]
    _add(graphs, (USED,), title + first.criterion, lines, limits)


def _add_accelerations(graphs: Graphs, run: DrawnRun, direction: str) -> None:
    """Add the accelerations of bodies and points along a direction, and that of the base."""
    response, selection = run.response, run.selection
    parts = [Component(kind="body", name=name) for name in selection.bodies]
    parts += [Component(kind="point", name=name) for name in selection.points]
    markers = {part: _acceleration_marker(part.name, part.peak(response), direction) for part in parts}
    parts.sort(key=lambda part: abs(markers[part].value), reverse=True)
    base = _along(in_unit(BASE.acceleration(response), "g"), direction)
    values = [_along(in_unit(part.acceleration(response), "g"), direction) for part in parts]
    tolerance = _FINE * max(float(np.abs([base, *values]).max()), 1e-9)
    marker = markers[parts[0]] if parts else None
    labels = [f"{part.label} {markers[part].value:.2f} g" for part in parts]
    colors = [colour_of(selection, part.name) for part in parts]
    lines = [*drawn(response.time, base, tolerance, below=("0",), names=["base"], colors=[DARK.base], width=1.0)]
    if parts:
        lines += named_lines(response.time, np.stack(values, axis=1), labels, colors, tolerance, marker)
    title = f"Acceleration {_label(direction)} [g]" + (f": {marker.text}" if marker else "")
    _add(graphs, ("acceleration", direction), title, lines)


def _add_mounts(graphs: Graphs, run: DrawnRun, quantity: str, axis: str) -> None:
    """Add a quantity of all mounts that act in an axis."""
    selection, response = run.selection, run.response
    names, unit = selection.leading[quantity, axis], UNITS[quantity][1]
    values = np.column_stack([_mount_values(response, name, quantity, axis) for name in names])
    markers = [_mount_marker(name, response, name, quantity, axis) for name in names]
    labels = [f"{name} {marker.value:.4g} {unit}" for name, marker in zip(names, markers, strict=True)]
    tolerance = _FINE * max(float(np.ptp(values)), 1e-9)
    colors = [colour_of(selection, name) for name in names]
    lines = named_lines(response.time, values, labels, colors, tolerance, markers[0])
    limits = []
    if quantity == "deflection":  # the rated travel of the mount that uses most of it
        worst = selection.ranked[axis][0]
        near = _near_limits(response, worst, axis)
        limits = [_travel_limit((f"{side}_rated",), f"rated travel of {worst}", limit) for side, limit in near.items()]
    _add(graphs, (quantity, axis), f"{axis.capitalize()} {quantity} [{unit}]: {markers[0].text}", lines, limits)


def _add_contacts(graphs: Graphs, run: DrawnRun) -> None:
    """Add forces of stops and pairs of geoms that touched, and the gaps of these pairs."""
    found, time = touching(run.response), run.response.time
    gaps = [(one, one.gap) for one in found if one.gap is not None]
    if found:
        first = found[0].contact
        marker = _peak_marker(found[0].name, first.force_time or 0.0, in_unit(first.force, "kN"), "kN")
        labels = [f"{one.name} {in_unit(one.contact.force, 'kN'):.4g} kN" for one in found]
        values = in_unit(np.stack([one.force for one in found], axis=1), "kN")
        _add(
            graphs,
            (CONTACT, "force"),
            f"Force of stops and contacts [kN]: {marker.text}",
            _series(time, values, labels, marker),
        )
    if gaps:
        values = in_unit(np.stack([gap for _, gap in gaps], axis=1), "mm")
        lines = _series(time, values, [one.name for one, _ in gaps], None)
        _add(graphs, (CONTACT, "gap"), "Gap of contacts [mm], below zero pressed", lines)


def _series(time: Array, values: Array, labels: Sequence[str], marker: Marker | None) -> list[Lines]:
    """Return histories of contacts, (n_t, n), the first with the colours of the table in its order."""
    colors = [DARK.series[number % len(DARK.series)] for number in range(len(labels))]
    return named_lines(time, values, labels, colors, _FINE * max(float(np.ptp(values)), 1e-9), marker)


def _travel_limit(below: tuple[str, ...], name: str, limit: float) -> Limit:
    return Limit(below=below, name=name, value=in_unit(limit, "mm"), unit="mm")


def graphs_of_overlay(overlay: Overlay) -> Graphs:
    """Return the graphs of several runs over each other."""
    graphs: Graphs = {}
    for part in shown_parts(overlay):
        runs = overlay.having(part)
        for direction in (TOTAL, *DIRECTIONS):
            values = [_along(in_unit(part.acceleration(run.response), "g"), direction) for run in runs]
            markers = [_acceleration_marker(run.name, part.peak(run.response), direction) for run in runs]
            title = f"{part.label}: acceleration {_label(direction)} [g]{_change(runs, markers)}"
            _add(graphs, ("acceleration", direction, part.kind, part.name), title, _runs(runs, values, markers))
    for axis in overlay.shared.axes:
        for mount in overlay.shared.shown(axis):
            runs = overlay.having(mount)
            near = {limit for run in runs for limit in _near_limits(run.response, mount, axis).values()}
            limits = [
                _travel_limit(("rated", f"{in_unit(limit, 'mm'):+.3f}"), "rated travel", limit)
                for limit in sorted(near)
            ]
            for quantity, (_, unit) in UNITS.items():
                values = [_mount_values(run.response, mount, quantity, axis) for run in runs]
                markers = [_mount_marker(run.name, run.response, mount, quantity, axis) for run in runs]
                title = f"{mount}: {axis} {quantity} [{unit}]{_change(runs, markers)}"
                lines = _runs(runs, values, markers)
                _add(graphs, (quantity, axis, mount), title, lines, limits if quantity == "deflection" else ())
    for subject in differing(overlay):
        _add_difference(graphs, overlay, subject)
    return graphs


def shown_parts(overlay: Overlay) -> tuple[Component, ...]:
    """Return the parts whose accelerations are drawn for several runs."""
    return overlay.components[:MOST_PARTS]


def differing(overlay: Overlay) -> list[Component | str]:
    """Return the part and the mount whose histories are farthest from those of the first run."""
    apart = [entry.subject for entry in overlay.differences if np.isfinite(entry.ratio)]
    parts = [subject for subject in apart if isinstance(subject, Component) and subject.kind != "base"]
    mounts = [subject for subject in apart if isinstance(subject, str)]
    return [*parts[:1], *mounts[:1]]


def difference_key(subject: Component | str) -> tuple[str, ...]:
    """Return the key of the graph of the differences of a part or a mount."""
    return ("difference", "mount", subject) if isinstance(subject, str) else ("difference", subject.kind, subject.name)


def _add_difference(graphs: Graphs, overlay: Overlay, subject: Component | str) -> None:
    first, *others = overlay.having(subject)
    unit, unit_name = (1e-3, "mm") if isinstance(subject, str) else (STANDARD_GRAVITY, "g")
    lines = []
    for run in others:
        time, distance = difference(subject, first, run)
        if time.size:
            row = int(distance.argmax())
            name = f"{run.name} - {first.name}:"
            marker = _peak_marker(name, float(time[row]), float(distance[row]) / unit, unit_name)
            tolerance = _FINE * max(float(np.ptp(distance)) / unit, 1e-9)
            look = {"names": [marker.text], "colors": [run.color], "marker": marker, "marker_color": run.color}
            lines.append(thinned(time, distance / unit, tolerance, below=(run.name,), **look))
    if isinstance(subject, str):
        title = f"{subject}: |deflection - that of {first.name}| [mm]"
    else:
        title = f"{subject.label}: |acceleration - that of {first.name}| [g]"
    _add(graphs, difference_key(subject), title, lines)


def _add(graphs: Graphs, key: tuple[str, ...], title: str, lines: Sequence[Lines], limits: Sequence[Any] = ()) -> None:
    graphs[key] = Graph(path=entity("histories", *key), title=title, lines=lines, limits=limits)


def _runs(runs: Sequence[DrawnRun], values: Sequence[Array], markers: Sequence[Marker]) -> list[Lines]:
    """Return a line and a peak for every run; both have one name, and so one entry in the legend.

    The viewer draws them in the order of their paths: the largest swing comes first, each is thinner than the one before, so
    that what is smaller or coincides is not hidden.
    """
    swings = [max(float(np.ptp(history)), 1e-9) for history in values]
    step = min(1.2, 2.4 / max(len(runs) - 1, 1))
    order = sorted(range(len(runs)), key=lambda index: swings[index], reverse=True)
    return [
        thinned(
            runs[index].response.time,
            values[index],
            _FINE * max(swings),
            below=(str(rank), runs[index].name),
            names=[markers[index].text],
            colors=[runs[index].color],
            width=1.5 + step * (len(runs) - 1 - rank),
            marker=markers[index],
            marker_color=runs[index].color,
        )
        for rank, index in enumerate(order)
    ]


def _along(acceleration: Array, direction: str) -> Array:
    """Return components (..., 3) along a direction, or the norms, (...)."""
    if direction == TOTAL:
        return np.asarray(np.linalg.norm(acceleration, axis=-1))
    return acceleration[..., DIRECTIONS.index(direction)]


def _mount_values(response: Response, mount: str, quantity: str, axis: str) -> Array:
    """Return deflection [mm] or force [kN] of a mount along an axis, (n_t,)."""
    values: Array = getattr(response.mounts[mount], quantity)[:, AXES.index(axis)]
    return values / UNITS[quantity][0]


def _label(direction: str) -> str:
    return "norm" if direction == TOTAL else direction


def _change(runs: Sequence[DrawnRun], markers: Sequence[Marker]) -> str:
    """Return how the peaks change from the first run that has them to each other."""
    first = abs(markers[0].value)
    if not first:
        return ""
    changes = [abs(marker.value) / first - 1.0 for marker in markers[1:]]
    texts = [f"{100.0 * change:+.1f} %" if change else "the same" for change in changes]
    return ": " + ", ".join(f"{run.name} {text}" for run, text in zip(runs[1:], texts, strict=True))


def _acceleration_marker(name: str, peak: Peak, direction: str) -> Marker:
    if direction == TOTAL:
        return _peak_marker(name, peak.time, peak.value / STANDARD_GRAVITY, "g")
    return _extreme_marker(name, peak, DIRECTIONS.index(direction), STANDARD_GRAVITY, "g")


def _mount_marker(name: str, response: Response, mount: str, quantity: str, axis: str) -> Marker:
    return _extreme_marker(name, getattr(response.peaks.mounts[mount], quantity), AXES.index(axis), *UNITS[quantity])


def _extreme_marker(name: str, peak: Peak, axis: int, unit: float, unit_name: str) -> Marker:
    """Return the marker of the extreme of a component that is farther from zero."""
    high = peak.maximum[axis] >= -peak.minimum[axis]
    value = float((peak.maximum if high else peak.minimum)[axis]) / unit
    time = float((peak.maximum_time if high else peak.minimum_time)[axis])
    return _peak_marker(name, time, value, unit_name)


def _peak_marker(name: str, time: float, value: float, unit: str) -> Marker:
    instant = f"{in_unit(time, 'ms'):.0f} ms" if time < _LATE else f"{time:.2f} s"
    return Marker(time=time, value=value, text=f"{name} peak {value:.2f} {unit} @ {instant}")


def _near_limits(response: Response, mount: str, axis: str) -> dict[str, float]:
    """Return the rated travels [m] that the deflection of a mount comes near, by their side."""
    peak, number = response.peaks.mounts[mount].deflection, AXES.index(axis)
    entry = next(entry for entry in response.scene.mounts if entry.name == mount)
    sides = zip(("lowest", "highest"), travel_limits(entry, axis), (peak.minimum, peak.maximum), strict=True)
    return {side: limit for side, limit, reached in sides if reached[number] / limit >= _SHOWN_LIMIT}  # NaN: unrated
