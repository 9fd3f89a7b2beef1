"""Events as a log, and lanes that show the phase of the motion and the use of the rated travel."""

from dataclasses import dataclass
from typing import Any

import numpy as np

from wirerope_mj.assessment.criteria import closing_text
from wirerope_mj.engine.response import Response
from wirerope_mj.engine.response.scene import SceneMount
from wirerope_mj.foundation.arrays import Array
from wirerope_mj.foundation.units import in_unit
from wirerope_mj.views.recording.drawn_runs import DrawnRun
from wirerope_mj.views.recording.paths import AXES, AXIAL, at, entity
from wirerope_mj.views.recording.selection import Selection, travel_limits
from wirerope_mj.views.recording.stops import CLOSED, changes, closed_at

NEAR = 0.8
"""Fraction of the rated travel from which a mount is reported."""

_TRAVEL = ("ok", "over 80 %", "exceeded")
_TRAVEL_COLORS = ((34, 102, 48), (190, 130, 20), (200, 45, 50))
_PHASES = ("at rest", "base moves", "free")
_PHASE_COLORS = ((58, 66, 76), (190, 130, 20), (48, 84, 110))


@dataclass(frozen=True, kw_only=True, order=True)
class Event:
    """An event: instant [s], level "INFO", "WARN" or "ERROR", and text."""

    time: float
    level: str
    text: str


def log_events(rec: Any, run: DrawnRun) -> None:
    """Log the events of a run, and its lanes if it is alone."""
    import rerun as rr

    response, selection = run.response, run.selection
    events = events_of(response, selection)
    if events:
        prefix, color = (f"{run.name}: ", {"color": [run.color] * len(events)}) if run.name else ("", {})
        columns = rr.TextLog.columns(
            text=[prefix + event.text for event in events], level=[event.level for event in events], **color
        )
        rec.send_columns(entity("events", *run.names), at([event.time for event in events]), columns)
    if not run.name:
        _log_lanes(rec, response, selection)


def _log_lanes(rec: Any, response: Response, selection: Selection) -> None:
    _log_lane(rec, "base", _phases(response), _PHASES, _PHASE_COLORS)
    if response.scene.stops:
        closed = closed_at(response, response.scene.stops)
        states = [(float(response.time[row]), int(closed[row])) for row in changes(closed)]
        _log_lane(rec, "stops", states, ("open", "closed"), (_PHASE_COLORS[0], CLOSED))
    for axis in AXES:
        used = _travel_changes(response, selection, axis)
        if used:
            _log_lane(rec, f"travel_{axis}", used, _TRAVEL, _TRAVEL_COLORS)


def lane_paths(response: Response, selection: Selection) -> list[str]:
    """Return the entities of the lanes that say something: stops, axes near their rated travel, or else the nearest one."""
    rated = [axis for axis in selection.axes if not np.isnan(selection.utilisation(selection.ranked[axis][0], axis))]
    near = [axis for axis in rated if selection.utilisation(selection.ranked[axis][0], axis) >= NEAR]
    stops = [entity("lanes", "stops")] if response.scene.stops else []
    return [entity("lanes", "base"), *stops, *(entity("lanes", f"travel_{axis}") for axis in near or rated[:1])]


def events_of(response: Response, selection: Selection) -> list[Event]:
    """Return the events of a run in order of time."""
    # A sum of pulses says the same at the same instant for each of them.
    events = [Event(time=time, level="INFO", text=text) for time, text in dict.fromkeys(response.events)]
    for name in selection.bodies:
        peak = response.peaks.bodies[name].acceleration
        text = f"{name}: peak acceleration {in_unit(peak.value, 'g'):.2f} g"
        events.append(Event(time=_short(peak.time), level="INFO", text=text))
    for mount in response.scene.mounts:
        events += [event for axis in AXES for event in _travel_events(response, mount, axis)]
    events += _contact_events(response)
    return sorted(event for event in events if event.time <= response.time[-1])


def _contact_events(response: Response) -> list[Event]:
    """Return when stops are struck first, and how hard at most."""
    contacts = response.peaks.contacts or {}
    events = []
    for name in response.peaks.struck:
        contact = contacts[name]
        text = f"{name}: struck, at most {in_unit(contact.force, 'kN'):.3g} kN"
        text = closing_text(name, contact) if contact.mount else text
        events.append(Event(time=_short(contact.first_touch or 0.0), level="WARN", text=text))
    return events


def _travel_events(response: Response, mount: SceneMount, axis: str) -> list[Event]:
    """Return when a mount comes near or beyond its rated travel."""
    number = AXES.index(axis)
    peak = response.peaks.mounts[mount.name].deflection
    deflection = response.mounts[mount.name].deflection[:, number]
    events = []
    for side, limit in enumerate(travel_limits(mount, axis)):
        value = float((peak.minimum, peak.maximum)[side][number])
        instant = float((peak.minimum_time, peak.maximum_time)[side][number])
        ratio = value / limit
        if not ratio >= NEAR:  # also where nothing is rated
            continue
        level = 1.0 if ratio > 1.0 else NEAR
        beyond = np.flatnonzero(deflection / limit >= level)
        how = (("compression", "tension")[side] if number == AXIAL else axis) + f" {in_unit(abs(value), 'mm'):.1f} mm"
        events.append(
            Event(
                time=_short(float(response.time[beyond[0]]) if beyond.size else instant),
                level="ERROR" if ratio > 1.0 else "WARN",
                text=f"{mount.name}: {how} is {in_unit(ratio, '%'):.0f} % of the rated {in_unit(abs(limit), 'mm'):.1f} mm",
            )
        )
    return events


def _short(time: float) -> float:
    """Return an instant as the log has room for it: to a millisecond, late ones to a tenth of a second."""
    return round(time, 3 if time < 10.0 else 1)


def _phases(response: Response) -> list[tuple[float, int]]:
    start = float(response.time[0])
    if not response.events:
        return [(start, 1 if response.base.acceleration.any() else 0)]
    first, last = response.events[0][0], response.events[-1][0]
    after = response.base.acceleration[response.time > last + 1e-9]
    phases = [(start, 0)] if first > start else []
    phases.append((max(first, start), 1))
    if not after.any():
        phases.append((last, 2))
    return [phase for phase in phases if phase[0] <= response.time[-1]]


def _travel_changes(response: Response, selection: Selection, axis: str) -> list[tuple[float, int]]:
    """Return when the mount that uses most of its rated travel passes 80 and 100 %."""
    used = _used_travel(response, axis)
    if used is None:
        return []
    state = (used >= NEAR).astype(int) + (used > 1.0)
    return [(float(response.time[row]), int(state[row])) for row in changes(state)]


def _used_travel(response: Response, axis: str) -> Array | None:
    """Return the largest fraction of the rated travel of all mounts, (n_t,); None if nothing is rated."""
    used = None
    for mount in response.scene.mounts:
        deflection = response.mounts[mount.name].deflection[:, AXES.index(axis)]
        for limit in travel_limits(mount, axis):
            if np.isfinite(limit):
                ratio = deflection / limit
                used = ratio if used is None else np.maximum(used, ratio)
    return used


def _log_lane(
    rec: Any, name: str, changes: list[tuple[float, int]], states: tuple[str, ...], colors: tuple[Any, ...]
) -> None:
    import rerun as rr

    rec.log(entity("lanes", name), rr.StateConfiguration(values=states, colors=colors), static=True)
    times, numbers = zip(*changes, strict=True)
    rec.send_columns(entity("lanes", name), at(times), rr.StateChange.columns(state=[states[n] for n in numbers]))
