"""Events of a run on the timeline, and its worst mounts and accelerations at an instant or over an interval."""

from collections.abc import Iterator
from dataclasses import dataclass

import numpy as np

from wirerope_mj.assessment.criteria import EXCEEDED, Verdict, closing_text
from wirerope_mj.assessment.criteria.ended import utilisation_over_time
from wirerope_mj.assessment.criteria.verdict import against_limit
from wirerope_mj.content.blocks import Block, Statement
from wirerope_mj.content.judged_run import RunResult
from wirerope_mj.content.numbers import with_unit
from wirerope_mj.content.selection import NAMED, Selection
from wirerope_mj.engine.response import Peak, Response
from wirerope_mj.foundation.arrays import Array
from wirerope_mj.foundation.tables import Cell, Column, Row, Table
from wirerope_mj.foundation.units import force_text, in_unit
from wirerope_mj.mounts.isolator import AXES

NEAR = 0.8  # Utilisation from which a limit is reported
_NEGLIGIBLE = 1e-9  # fraction of the largest peak of all axes, below which a peak is rounding


@dataclass(frozen=True, kw_only=True, order=True)
class Event:
    """An event: instant [s], level "INFO", "WARN" or "ERROR", text, and whether it is a main event of the run."""

    time: float
    level: str
    text: str
    main: bool = False


def events_of(response: Response, selection: Selection) -> list[Event]:
    """List the events of a run in order of time."""

    def info(time: float, text: str, *, main: bool = False) -> None:
        events.append(Event(time=time, level="INFO", text=text, main=main))

    events: list[Event] = []
    for time, text in dict.fromkeys(response.events):  # a sum of pulses says the same at the same instant for each of them
        info(time, text, main=True)
    bodies, points = response.peaks.bodies, response.peaks.points
    peaks: list[tuple[str, Peak]] = [(name, bodies[name].acceleration) for name in selection.bodies[:NAMED]]
    peaks += [(f"point {name}", points[name].acceleration) for name in selection.points[:NAMED]]
    largest = max((peak.value for _, peak in peaks), default=0.0)
    for name, peak in peaks:
        info(peak.time, f"{name}: peak acceleration {in_unit(peak.value, 'g'):.2f} g", main=peak.value == largest)
    if response.scene.base in bodies:
        peak = bodies[response.scene.base].acceleration
        info(peak.time, f"base: peak acceleration {in_unit(peak.value, 'g'):.2f} g")
    events += _mount_peaks(response, selection)
    for used in selection.used:
        if used.largest >= NEAR:
            events += _limit_events(response, used.governing, main=used is selection.used[0])
            for verdict in used.verdicts[1:]:
                events += _limit_events(response, verdict, main=False) if verdict.verdict == EXCEEDED else ()
    contacts = response.peaks.contacts or {}
    for rank, name in enumerate(response.peaks.struck):
        contact = contacts[name]
        force = force_text(contact.force)
        text = closing_text(name, contact) if contact.mount else f"{name}: struck, at most {force}"
        events.append(Event(time=contact.first_touch or 0.0, level="WARN", text=text, main=rank == 0))
        if contact.force_time is not None:
            text = f"{contact.called(name)}: largest force, {force}"
            events.append(Event(time=contact.force_time, level="WARN", text=text))
    if selection.window[1] < response.time[-1]:
        info(selection.window[1], "swings of the mounts stay below a tenth of the largest", main=True)
    return sorted(event for event in events if response.reaches(event.time))


def main_instants(response: Response, selection: Selection) -> Array:
    """List the instants of the few main events [s], (n,)."""
    return np.unique([event.time for event in events_of(response, selection) if event.main])


def _mount_peaks(response: Response, selection: Selection) -> Iterator[Event]:
    """Yield the largest deflection and force along every axis, and the rebound along the most utilised one."""
    for quantity, unit in (("deflection", "mm"), ("force", "kN")):
        extremes = {}
        for axis in selection.axes:
            name, number = selection.leading[quantity, axis][0], AXES.index(axis)
            peak: Peak = getattr(response.peaks.mounts[name], quantity)
            ends = [(peak.minimum[number], peak.minimum_time[number]), (peak.maximum[number], peak.maximum_time[number])]
            extremes[axis] = name, sorted(((float(value), float(time)) for value, time in ends), key=lambda end: -abs(end[0]))
        most = max((abs(ends[0][0]) for _, ends in extremes.values()), default=0.0)
        for axis, (name, ((value, time), (rebound, rebound_time))) in extremes.items():
            if abs(value) <= _NEGLIGIBLE * most:
                continue
            text = f"{name}: largest {axis} {quantity}, {in_unit(value, unit):.4g} {unit}"
            yield Event(time=time, level="INFO", text=text)
            if quantity == "deflection" and axis == selection.axes[0] and rebound_time > time and value * rebound < 0.0:
                text = f"{name}: rebounds to {in_unit(rebound, unit):.4g} {unit} {axis}"
                yield Event(time=rebound_time, level="INFO", text=text, main=True)


def _limit_events(response: Response, verdict: Verdict, *, main: bool) -> Iterator[Event]:
    """Yield the instants at which a utilisation passes 80 % and, if exceeded, 100 %, and the instant of its maximum."""
    if verdict.time is None:
        return
    course, over = utilisation_over_time(response, verdict), verdict.verdict == EXCEEDED
    for level, text in ((NEAR, "80 % of its limit"), (1.0, "its limit"))[: 1 + over]:
        time = None if course is None else first_above(response.time, course, level)
        yield Event(
            time=verdict.time if time is None else time,  # a peak between two samples
            level="WARN" if level == NEAR else "ERROR",
            text=f"{verdict.subject}: {verdict.criterion} passes {text}",
            main=main,
        )
    tone = "ERROR" if over else "WARN"
    yield Event(time=verdict.time, level=tone, text=f"maximum: {against_limit(verdict)}", main=main)


def first_above(time: Array, values: Array, level: float) -> float | None:
    """Interpolate the instant [s] at which `values` (n_t,) first reach a level; None if they never do."""
    above = np.flatnonzero(values >= level)
    if not above.size:
        return None
    row = int(above[0])
    if row == 0:
        return float(time[0])
    before, after = values[row - 1], values[row]
    return float(time[row - 1] + (time[row] - time[row - 1]) * (level - before) / (after - before))


def at_cursor(run: RunResult, row: int, stop: int) -> Iterator[Block]:
    """Yield accelerations, and deflections and forces of mounts nearest to their limits, from sample `row` up to `stop`.

    Of several samples they are the largest sizes: in a fast oscillation, as of a sweep, a single sample has an arbitrary phase.
    """
    response, selection = run.response, run.selection
    rows, single = slice(row, stop), stop - row <= 1
    start, end = response.time[row], response.time[max(stop - 1, row)]
    when = f"{start:.4f} s" if single else f"{start:.3f} to {end:.3f} s, largest sizes"
    if run.sweep is not None:
        frequency = run.sweep.frequency([0.5 * (start + end)])
        when += f", {float(frequency[0]):.4g} Hz"
    parts: list[tuple[str, Array]] = [("base", response.base.acceleration)]
    parts += [(name, response.bodies[name].acceleration) for name in selection.bodies[:1]]
    parts += [(name, response.points[name].acceleration) for name in selection.points[:1]]
    largest = {name: float(np.linalg.norm(values[rows], axis=1).max()) for name, values in parts}
    sizes = [f"{name} {with_unit(value, 'm/s^2')}" for name, value in largest.items()]
    yield Statement("now", f"{when}: {'; '.join(sizes)}", tone="strong")
    courses = {used.subject: used.course for used in selection.used}
    table: list[Row] = []
    # Mounts that use most of their limits, then those that are deflected most.
    names = [used.subject for used in selection.used if used.subject in selection.mounts]
    names += [name for axis in selection.axes[:1] for name in selection.leading["deflection", axis]]
    for name in list(dict.fromkeys(names))[:NAMED]:
        mount = response.mounts[name]
        cells: list[Cell] = [name]
        for values in (mount.deflection[rows], mount.force[rows]):
            extremes = values[0] if single else np.abs(values).max(axis=0)
            cells += extremes[::-1].tolist()
        cells.append(float(courses[name][rows].max()) if name in courses else None)
        table.append(cells)
    heads = ("axial, tension +" if single else "axial", "shear", "roll")
    columns = [Column(head, unit, form) for unit, form in (("mm", "z.1f"), ("kN", "z.2f")) for head in heads]
    yield Table(title="", columns=(Column(align="left"), *columns, Column("used", "%", "z.0f")), rows=table)
