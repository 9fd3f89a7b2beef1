"""Histories over time: of the parts of one run, or of one part in several runs, as panels that every output draws."""

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass

import numpy as np

from wirerope_mj.assessment.comparison import BASE as THE_BASE
from wirerope_mj.assessment.comparison import Comparison, Component, Subject, difference, subjects_of
from wirerope_mj.content.blocks import BASE, MOUNTS, Curve, Panel, short
from wirerope_mj.content.numbers import number
from wirerope_mj.content.selection import NAMED, Selection, kind_of, or_other, ranked_over_time, travel_limits
from wirerope_mj.engine.response import Peak, Response
from wirerope_mj.foundation.arrays import Array
from wirerope_mj.foundation.units import in_unit
from wirerope_mj.mounts.isolator import AXES

DIRECTIONS = ("x", "y", "z")
TOTAL = "total"
# Quantities that have histories, and the units in which they are drawn.
UNITS = {"acceleration": "g", "deflection": "mm", "force": "kN"}
USED, DIFFERENCE = "used", "difference"
MOST_PARTS = 6  # whose accelerations are drawn for several runs: the base and the largest peaks
_SHOWN_RATING = 0.5  # fraction of a rated travel above which the rating is drawn: else it flattens the curves
Histories = dict[tuple[str, ...], Panel]  # Panels by quantity, axis and, of several runs, kind and name of the part


@dataclass(frozen=True, kw_only=True)
class Line:
    """A history to draw: of a part of a response, called `name`, in the colour `kind`.

    `history` is its time [s] and acceleration (n_t, 3) where these are known better than by samples.
    """

    response: Response
    subject: Subject
    name: str
    kind: int | str
    history: tuple[Array, Array] | None = None


def subject_called(response: Response, name: str) -> Component:
    return Component(kind="body" if name in response.bodies else "point", name=name)


def history_panel(quantity: str, along: str, lines: Sequence[Line], window: tuple[float, float], *, part: str = "") -> Panel:
    """Draw a quantity of `UNITS` along an axis, or its magnitude ("total"), a curve for each line; the first is in front.

    Accelerations are along the world's axes, others along the mount's. `part` names the part that all lines share in a
    comparison of runs, `window` is the interval shown [s].
    """
    unit = UNITS[quantity]
    curves = [_curve(line, quantity, along, unit) for line in lines]
    if quantity == "acceleration":
        what, label = (
            ("Acceleration" if along == TOTAL else f"Acceleration along {along}"),
            f"along {along} [{unit}]" if along != TOTAL else f"magnitude [{unit}]",
        )
    else:
        what, label = f"{along.capitalize()} {quantity}", f"{along} [{unit}]"
    levels: dict[tuple[str, float], bool] = {}  # rated travels that deflections come near: of the first mount, or in all runs
    for line in (lines if part else lines[:1]) if quantity == "deflection" else ():
        mount = next(entry for entry in line.response.scene.mounts if entry.name == line.subject)
        peak = line.response.peaks.mounts[mount.name].deflection
        for limit, reached in zip(travel_limits(mount, along), (peak.minimum, peak.maximum), strict=True):
            used = reached[_axis_number(along)] / limit
            if used >= _SHOWN_RATING:  # NaN: unrated
                level = "rated travel" if part else f"rated travel of {short(mount.name)}", in_unit(float(limit), "mm")
                levels[level] = levels.get(level, False) or bool(used > 1.0)
    if quantity == "acceleration":
        levels |= _acceleration_levels(lines, along, alike=bool(part))
    title = f"{part}: {what[:1].lower()}{what[1:]} [{unit}]{_peak_changes(curves)}" if part else f"{what} [{unit}]"
    exceeded = {name for (name, _), passed in levels.items() if passed}
    return Panel(curves, label, title=title, limits=list(levels), exceeded=exceeded, xlim=window, unit=unit)


def _acceleration_levels(lines: Sequence[Line], along: str, *, alike: bool) -> Iterator[tuple[tuple[str, float], bool]]:
    """Yield name and value [g] of acceleration limits that peaks come near, on both sides of zero, and if they are exceeded."""
    for line in lines:
        if isinstance(subject := line.subject, Component) and subject != THE_BASE:
            reached = abs(_extreme(subject.peak(line.response), along)[1])
            for limit in line.response.scene.limits:
                whole = len(limit.values) == 1
                if (limit.kind, limit.name) == ("acceleration", subject.name) and (whole or along != TOTAL):
                    value = limit.values[0 if whole else _axis_number(along)]
                    if value and reached >= _SHOWN_RATING * value:
                        for side in (1.0,) if along == TOTAL else (1.0, -1.0):
                            called = "limit" if alike else f"limit of {short(line.name)}"
                            yield (called, in_unit(side * value, "g")), reached > value


def run_histories(response: Response, selection: Selection) -> Histories:
    """Draw utilisations, accelerations, deflections, forces and contacts of one run, a panel each."""
    window, panels = selection.window, Histories()
    if selection.used:
        panels[USED,] = used_panel(response, selection)
    parts = [Component(kind="body", name=name) for name in selection.bodies]
    parts += [Component(kind="point", name=name) for name in selection.points]
    base = Line(response=response, subject=THE_BASE, name="base", kind=BASE)
    for along in (*DIRECTIONS, TOTAL):
        order = sorted(parts, key=lambda part: -abs(_extreme(part.peak(response), along)[1]))
        names = {part.label: part for part in order}
        panels["acceleration", along] = history_panel(
            "acceleration", along, [*named_lines(response, selection, names), base], window
        )
    for axis in selection.axes:
        for quantity in ("deflection", "force"):
            mounts = {name: name for name in selection.leading[quantity, axis]}
            panels[quantity, axis] = history_panel(quantity, axis, named_lines(response, selection, mounts), window)
    for what, panel in zip(("force", "gap"), contact_panels(response, window), strict=False):
        panels["contact", what] = panel
    return panels


def named_lines(response: Response, selection: Selection, subjects: Mapping[str, Subject]) -> list[Line]:
    """Make lines of subjects by their labels, the most important first; from rank `NAMED` on they are grey "others"."""
    lines = []
    for rank, (label, subject) in enumerate(subjects.items()):
        name = subject if isinstance(subject, str) else subject.name
        called, kind = or_other(label, kind_of(selection, name), rank, len(subjects))
        lines.append(Line(response=response, subject=subject, name=called, kind=kind))
    return lines


def used_panel(response: Response, selection: Selection) -> Panel:
    """Draw the utilisation of limits by mounts, bodies and points over time."""
    curves = []
    for rank, used in enumerate(ranked_over_time(selection.used)):
        name, kind = or_other(short(used.subject), kind_of(selection, used.subject), rank, len(selection.used))
        time = used.governing.time
        peak = None if time is None else (time, in_unit(used.largest, "%"))
        curves.append(Curve(response.time, in_unit(used.course, "%"), name=name, kind=kind, peak=peak))
    worst = ranked_over_time(selection.used)[0]
    return Panel(
        curves, "used of the limit [%]",
        title=f"Used of the limits [%]: {worst.subject}, {worst.governing.criterion}", limits=[("limit", 100.0)],
        exceeded=("limit",) if worst.largest > 1.0 else (), xlim=selection.window,
        ylim=(0.0, 108.0 * max(1.0, *(used.largest for used in selection.used))), unit="%",
    )  # fmt: skip


def overlay_histories(comparison: Comparison, shared: Selection) -> Histories:
    """Draw each shared part with a curve for every run, and the differences of the runs from the first run."""
    window, panels = shared.window, Histories()
    for part in comparison.components[:MOST_PARTS]:
        for along in (*DIRECTIONS, TOTAL):
            panels["acceleration", along, part.kind, part.name] = history_panel(
                "acceleration", along, _lines_of(comparison, part), window, part=part.label
            )
    for axis in shared.axes:
        for mount in shared.shown(axis):
            for quantity in ("deflection", "force"):
                panels[quantity, axis, mount] = history_panel(quantity, axis, _lines_of(comparison, mount), window, part=mount)
    for subject in differing(comparison):
        first = comparison.runs[0]
        quantity = "deflection" if isinstance(subject, str) else "acceleration"
        unit, label = UNITS[quantity], subject if isinstance(subject, str) else subject.label
        curves = []
        for rank, run in enumerate(comparison.runs[1:], start=1):
            if all(subject in subjects_of(compared.response) for compared in (first, run)):
                time, distance = difference(subject, first, run)
                if time.size:
                    values, row = in_unit(distance, unit), int(distance.argmax())
                    peak = (float(time[row]), float(values[row]))
                    curves.append(Curve(time, values, name=f"{run.name} - {first.name}", kind=rank, peak=peak))
        title = f"{label}: |{quantity} - that of {first.name}| [{unit}]"
        panel = Panel(curves, f"difference [{unit}]", title=title, xlim=window, unit=unit)
        panels[difference_key(subject)] = panel
    return panels


def differing(comparison: Comparison) -> list[Subject]:
    """List the part and the mount whose histories differ most between the runs."""
    apart = [entry.subject for entry in comparison.differences if np.isfinite(entry.ratio)]
    parts = [subject for subject in apart if isinstance(subject, Component) and subject.kind != "base"]
    mounts = [subject for subject in apart if isinstance(subject, str)]
    return [*parts[:1], *mounts[:1]]


def difference_key(subject: Subject) -> tuple[str, ...]:
    return (DIFFERENCE, "mount", subject) if isinstance(subject, str) else (DIFFERENCE, subject.kind, subject.name)


def _lines_of(comparison: Comparison, subject: Subject) -> list[Line]:
    """Make a line of a part for each run that has it."""
    return [
        Line(response=run.response, subject=subject, name=run.name, kind=rank)
        for rank, run in enumerate(comparison.runs)
        if subject in subjects_of(run.response)
    ]


def _curve(line: Line, quantity: str, along: str, unit: str) -> Curve:
    """Make the curve of a line along an axis, or of its magnitude ("total"), in a unit, with its peak."""
    if isinstance(line.subject, str):
        history = getattr(line.response.mounts[line.subject], quantity)
        time, peak = line.response.time, getattr(line.response.peaks.mounts[line.subject], quantity)
    else:
        time, history = line.history or (line.response.time, line.subject.acceleration(line.response))
        known = line.subject != THE_BASE or line.response.scene.base in line.response.peaks.bodies
        peak = line.subject.peak(line.response) if known else None
    values = np.linalg.norm(history, axis=1) if along == TOTAL else history[:, _axis_number(along)]
    marked = None
    if peak is not None:
        instant, value = _extreme(peak, along)
        marked = instant, in_unit(value, unit)
    return Curve(time, in_unit(np.asarray(values), unit), name=short(line.name), kind=line.kind, peak=marked)


def _axis_number(along: str) -> int:
    return AXES.index(along) if along in AXES else DIRECTIONS.index(along)


def _extreme(peak: Peak, along: str) -> tuple[float, float]:
    """Find instant [s] and value of the largest extreme along an axis, or of the magnitude ("total")."""
    if along == TOTAL:
        return peak.time, peak.value
    axis = _axis_number(along)
    high = peak.maximum[axis] >= -peak.minimum[axis]
    value, time = (peak.maximum, peak.maximum_time) if high else (peak.minimum, peak.minimum_time)
    return float(time[axis]), float(value[axis])


def _peak_changes(curves: Sequence[Curve]) -> str:
    """Describe the changes of the peaks against the first curve's; "" without other peaks."""
    first, *others = [(curve.name, abs(curve.peak[1])) for curve in curves if curve.peak is not None] or [("", 0.0)]
    if not first[1] or not others:
        return ""
    changes = {name: f"{100.0 * (size / first[1] - 1.0):+.1f} %" if size != first[1] else "the same" for name, size in others}
    return f": {', '.join(f'{name} {change}' for name, change in changes.items())}"


def peak_text(curve: Curve, panel: Panel) -> str:
    """Write a curve's name with the value of its peak and where that is."""
    if curve.peak is None:
        return curve.name
    at, value = curve.peak
    where = f"{at:.3f}" if panel.xunit == "s" else number(at, digits=4)
    return f"{curve.name} {number(value)} {panel.unit} at {where} {panel.xunit}"


def contact_panels(response: Response, window: tuple[float, float]) -> list[Panel]:
    """Draw forces of stops and contacts that touched, the largest first, with their limits, and the gaps of contacts."""
    stops, known = {stop.name for stop in response.scene.stops}, response.contacts
    forces, gaps = [], []
    # Undeclared pairs, and stops that act beside other laws of their mount, have peaks alone.
    touched = {name: peak for name, peak in (response.peaks.contacts or {}).items() if peak.touches}
    struck = {name: peak for name, peak in touched.items() if name in known or peak.mount in stops}
    for rank, (key, peak) in enumerate(sorted(struck.items(), key=lambda item: item[1].force, reverse=True)):
        name, kind = or_other(short(key if key in known else peak.called(key)), MOUNTS[rank % NAMED], rank, len(struck))
        force = known[key].force if key in known else np.linalg.norm(response.mounts[peak.mount].force, axis=1)
        marked = None if peak.force_time is None else (peak.force_time, in_unit(peak.force, "kN"))
        forces.append(Curve(response.time, in_unit(force, "kN"), name=name, kind=kind, peak=marked))
        if key in known:
            gaps.append(Curve(response.time, in_unit(known[key].gap, "mm"), name=name, kind=kind))
    allowed = {limit.name: limit.values[0] for limit in response.scene.limits if limit.kind == "force"}
    levels = {
        (f"limit of {short(peak.mount)}", in_unit(allowed[peak.mount], "kN")): peak.force > allowed[peak.mount]
        for peak in struck.values()
        if peak.mount in allowed and peak.force >= _SHOWN_RATING * allowed[peak.mount]
    }
    exceeded = {name for (name, _), passed in levels.items() if passed}
    parts = (
        (forces, "force", "Force of stops and contacts [kN]", "kN", list(levels)),
        (gaps, "gap", "Gap of contacts [mm], below zero pressed", "mm", list[tuple[str, float]]()),
    )
    return [
        Panel(curves, f"{what} [{unit}]", title=title, limits=limits, exceeded=exceeded, xlim=window, unit=unit)
        for curves, what, title, unit, limits in parts
        if curves
    ]
