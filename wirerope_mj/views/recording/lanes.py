"""Lanes below the plots: the phase of the base's motion, stops, and what uses most of its limits."""

from collections.abc import Sequence

import numpy as np
import rerun as rr

from wirerope_mj.content.events import NEAR
from wirerope_mj.content.selection import Selection
from wirerope_mj.engine.response import Response
from wirerope_mj.foundation.arrays import Booleans
from wirerope_mj.views.colours import DARK
from wirerope_mj.views.recording.mounts import CLOSED, changes, closed_at
from wirerope_mj.views.recording.paths import Stream, at, entity

_MOST = 2  # Lanes of what uses most of its limits: each is 40 points high
_LEGIBLE = 0.04  # Fraction of what is shown below which a state's name does not fit its lane
_QUIET, _MOVING, _NEAR = (58, 66, 76), (48, 84, 110), (150, 100, 10)
_USED = (("within", (34, 84, 50)), ("80", _NEAR), ("100", tuple(round(0.75 * part) for part in DARK.limit)))
_STOPS = (("open", _QUIET), ("stop", CLOSED))
_PHASES = (("at rest", _QUIET), ("moves", _NEAR), ("free", _MOVING))
# Entities at the root of a recording: a mount of such a name has its lane elsewhere.
_TAKEN = (
    "world", "histories", "loops", "events", "peaks", "scenario", "verdict", "verdicts", "cursor", "state", "plan", "ghosts",
    "frequencies",
)  # fmt: skip


def lane_paths(response: Response, selection: Selection) -> list[str]:
    """Return the entities of the lanes in their order; the viewer writes them beside the lanes."""
    stops = [_path("stops")] if _pressing(response) is not None else []
    return [_path("base"), *stops, *(_path(name) for name in _subjects(selection))]


def log_lanes(rec: Stream, response: Response, selection: Selection) -> None:
    """Log the lanes of a run that is alone."""
    end = selection.window[1]
    _log_lane(rec, "base", _phases(response), _PHASES, end)
    closed = _pressing(response)
    if closed is not None:
        _log_lane(rec, "stops", [(float(response.time[row]), int(closed[row])) for row in changes(closed)], _STOPS, end)
    names = _subjects(selection)
    for used in selection.used:
        if used.subject in names:
            state = (used.course >= NEAR).astype(int) + (used.course > 1.0)
            _log_lane(rec, used.subject, [(float(response.time[row]), int(state[row])) for row in changes(state)], _USED, end)


def _subjects(selection: Selection) -> list[str]:
    """Return what comes near its limits, or else what comes nearest."""
    near = [used.subject for used in selection.used if used.largest >= NEAR]
    return (near or [used.subject for used in selection.used[:1]])[:_MOST]


def _pressing(response: Response) -> Booleans | None:
    """Return whether any stop or declared pair of geoms presses at each sample, (n_t,); None where there are none."""
    pairs = [pair.force > 0.0 for pair in response.contacts.values()]
    stops = [closed_at(response, response.scene.stops)] if response.scene.stops else []
    return np.any([*pairs, *stops], axis=0) if pairs or stops else None


def _path(name: str) -> str:
    return entity("lanes", name) if name in _TAKEN else entity(name)


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
    return [phase for phase in phases if response.reaches(phase[0])]


def _log_lane(
    rec: Stream, name: str, changes: list[tuple[float, int]], states: Sequence[tuple[str, Sequence[int]]], end: float
) -> None:
    """Log a lane, seen until an instant `end` [s]; what is too short for its name is drawn in its colour alone."""
    labels, colors = zip(*states, strict=True)
    blanks = [" " * (number + 1) for number in range(len(labels))]
    rec.log(_path(name), rr.StateConfiguration(values=[*labels, *blanks], colors=[*colors, *colors]), static=True)
    times, numbers = zip(*changes, strict=True)
    lasting = np.diff(np.append(times, max(end, times[-1])))
    said = [labels[n] if long else blanks[n] for n, long in zip(numbers, lasting >= _LEGIBLE * end, strict=True)]
    rec.send_columns(_path(name), at(times), rr.StateChange.columns(state=said))
