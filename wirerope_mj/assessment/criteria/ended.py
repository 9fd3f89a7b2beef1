"""Utilisation of limits over time, and verdicts on runs that end before their peaks are over.

A shock, or a record, is over when its motion is, the slowest mode has had the time for its largest swings to both sides
after it, and the later half of that time brings nothing new and begins nothing that goes on. A sweep, and random vibration,
are whole when they have been run through: they go on after it or fade by themselves. A sine without end is steady when that
holds for the last third of the run: mounts that carry a weight sag farther under vibration, for hundreds of cycles.
"""

import math
from collections.abc import Iterable, Sequence
from dataclasses import dataclass, replace

import numpy as np

from wirerope_mj.assessment.criteria.loads import stops_beside
from wirerope_mj.assessment.criteria.payload import between_points, body_corners, corner_displacements
from wirerope_mj.assessment.criteria.sampled import STEADY, elements, read_columns, steady_interval
from wirerope_mj.assessment.criteria.travel import combined_travel
from wirerope_mj.assessment.criteria.verdict import (
    ACCELERATION,
    BOTTOMING,
    CLEAR,
    COMBINED,
    LOAD,
    NOT_JUDGED,
    RATTLE_SPACE,
    STOP_GAP,
    TRAVEL,
    WITHIN,
    Criterion,
    Verdict,
    by_use,
)
from wirerope_mj.engine.response import Response
from wirerope_mj.foundation.arrays import Array, Entries
from wirerope_mj.foundation.payload_limits import BETWEEN
from wirerope_mj.foundation.units import duration_text
from wirerope_mj.mounts.isolator.travel import travel_in


@dataclass(frozen=True, kw_only=True)
class Used:
    """Utilisation over time of the limits of a mount, a body or a point."""

    subject: str
    verdicts: tuple[Verdict, ...]  # verdicts on the subject that change over time, the largest utilisation first
    course: Array  # largest utilisation at each sample, (n_t,); peaks of every step may lie a little above

    @property
    def governing(self) -> Verdict:
        return self.verdicts[0]

    @property
    def largest(self) -> float:
        return self.governing.utilisation or 0.0


def used_limits(response: Response, verdicts: Sequence[Verdict]) -> list[Used]:
    """Compute the utilisation over time of every mount, body and point with limits, in the order of `by_use`."""
    by_subject: dict[str, list[tuple[Verdict, Array]]] = {}
    for verdict in verdicts:
        course = utilisation_over_time(response, verdict)
        if course is not None:
            by_subject.setdefault(verdict.subject, []).append((verdict, course))
    used = []
    for subject, pairs in by_subject.items():
        pairs.sort(key=lambda pair: pair[0].utilisation or 0.0, reverse=True)
        rows, courses = zip(*pairs, strict=True)
        used.append(Used(subject=subject, verdicts=rows, course=np.max(courses, axis=0)))
    order = list(by_use(verdicts))
    return sorted(used, key=lambda row: order.index(row.subject))


def utilisation_over_time(response: Response, verdict: Verdict) -> Array | None:
    """Compute value over limit at each sample, (n_t,); None for a verdict without a limit or without a history."""
    if verdict.limit is None or verdict.utilisation is None:
        return None
    criterion, subject = verdict.criterion, verdict.subject
    mount = next((mount for mount in response.scene.isolating if mount.name == subject), None)
    if criterion.kind == ACCELERATION:
        kind = "bodies" if subject in response.bodies else "points"
        value = _component(read_columns(response, f"{kind}/{subject}/acceleration/x", 3), criterion)
    elif criterion.kind == RATTLE_SPACE and subject in response.points:
        value = _component(response.points[subject].relative_displacement, criterion)
    elif criterion.kind == RATTLE_SPACE and BETWEEN in subject:
        value = _component(between_points(response, subject), criterion)
    elif criterion.kind == RATTLE_SPACE:
        body = next(body for body in response.scene.bodies if body.name == subject)
        corners = corner_displacements(response, body, body_corners(body))
        value = np.max([_component(corner, criterion) for corner in corners], axis=0)
    elif mount is not None and criterion.kind == LOAD:
        foot = [mount.name, *stops_beside(response.scene, [mount.name])]
        forces = [read_columns(response, f"mounts/{name}/force/roll", 3) for name in foot]
        value = _component(np.sum(forces, axis=0), criterion)
    elif mount is not None and criterion.kind in (TRAVEL, COMBINED, BOTTOMING):
        deflection = read_columns(response, f"mounts/{mount.name}/deflection/roll", 3)
        rating = "compression" if criterion == BOTTOMING else criterion.sense
        value = combined_travel(mount, deflection) if criterion == COMBINED else travel_in(rating, deflection)
    elif criterion.kind == STOP_GAP:
        stop = (response.peaks.contacts or {})[subject]
        deflection = read_columns(response, f"mounts/{stop.mount}/deflection/{stop.axis}", 1)[:, 0]
        travel, side = deflection - (stop.rest or 0.0), criterion.sense or next(iter(stop.gaps))
        value = np.maximum(-travel if side == "below" else travel, 0.0)
    else:
        return None
    return np.asarray(value / verdict.limit)


def _component(values: Array, criterion: Criterion) -> Array:
    """Compute the size of vectors (n_t, 3) along a criterion's axis, in its sense or both ways; the norm without an axis."""
    if not criterion.axis:
        return np.asarray(np.linalg.norm(values, axis=1))
    along = values[:, "xyz".index(criterion.axis)]
    return np.maximum(along if criterion.sense == "+" else -along, 0.0) if criterion.sense else np.abs(along)


TOO_EARLY = "the run ends at"  # Beginning of the notes on values that are not judged because the run ends too early
GROWS = "the motion still grows when the run ends"  # Beginning of the notes on values that are not judged for that
# Slowest periods, of small amplitudes, that a run must last after its motion: that of large ones is up to twice as long.
PERIODS = 2.0
SWINGS = 3.0  # Least swings of a run under an endless sine, of twice the slowest period or of the motion
GROWTH = 0.01  # Growth of a utilisation near the end of a run up to which its peak counts as over
# Largest further growth that is extrapolated, over that of the last part, where growth does not slow down.
_LARGEST_CREEP = 10.0
_TIME_TOLERANCE = 1e-9  # [s]


def too_short(response: Response) -> str:
    """Explain why a run ends before its peaks are over; "" if it does not, or if an older response lacks the data."""
    numerics = response.numerics
    return ends_early(
        response.motion, (response.initial_state.time, response.final_state.time), numerics.motion_end, numerics.slowest_period
    )


def ends_early(motion: Entries, run: tuple[float, float], over: float, slowest: float) -> str:
    """Explain why a run, start and end [s], ends before its peaks are over; "" if it does not.

    The stored motion is over at `over` [s], NaN if it has no end; `slowest` is the slowest period for small amplitudes
    [s], NaN if it is not known: then the result is "".
    """
    start, end = run
    parts = list(elements(motion))
    kinds = {str(part.get("kind")) for part in parts}
    period = PERIODS * slowest
    if math.isnan(period) or not kinds:
        return ""
    random, _, falls = steady_interval(motion)
    if math.isnan(over):
        longest = max([period, *(1.0 / float(part["frequency"]) for part in parts if "frequency" in part)])
        needed = start + SWINGS * longest
        why = f"under a motion without end it takes {SWINGS:g} swings of {duration_text(longest, 4)} at the least"
    elif random or "sweep" in kinds:
        needed, why = falls if random else over, f"the motion goes on until {duration_text(falls if random else over, 4)}"
    else:
        needed = over + period
        why = f"the motion ends at {duration_text(over, 4)}, and twice the slowest period is {duration_text(period, 4)}"
    if end >= needed - _TIME_TOLERANCE:
        return ""
    least = math.ceil(1e3 * needed - 1e-6) / 1e3
    return f"{TOO_EARLY} {duration_text(end, 4)}, before its peaks are over ({why}): run at least {duration_text(least, 4)}"


def require_over(response: Response, verdicts: Iterable[Verdict]) -> tuple[Verdict, ...]:
    """Withdraw the judgement of values within their limits whose peaks are not over when the run ends.

    Stops and pairs of geoms that have not been touched until then are not judged either. Where a value still grows, no
    other value that peaked late is judged: a slow mode takes up the motion, and what it drives peaks with it.
    """
    early, rows, numerics = too_short(response), tuple(verdicts), response.numerics
    run = response.initial_state.time, response.final_state.time
    # Older responses lack the slowest period.
    begin = math.inf if math.isnan(numerics.slowest_period) else quiet_from(response.motion, run, numerics.motion_end)
    growing = set() if early else {row for row in rows if _rises_late(response, row, begin)}
    if growing and math.isfinite(over := numerics.motion_end):
        growing |= {row for row in rows if _rises_late(response, row, 0.5 * (over + begin), continues=False)}
    reason = early or growth_note(run[1])

    def judged(row: Verdict) -> Verdict:
        if early and row.contact == CLEAR:
            return replace(row, contact=NOT_JUDGED, note=early)
        if row in growing or (early and row.verdict == WITHIN):
            return replace(row, limit=None, note=f"{reason}; {row.note}" if row.note else reason)
        return row

    return tuple(judged(row) for row in rows)


def _rises_late(response: Response, row: Verdict, begin: float, *, continues: bool = True) -> bool:
    """Tell whether a value within its limit rose after `begin` [s], or, if the motion `continues`, would rise after the run."""
    if row.verdict != WITHIN or row.time is None or row.time <= begin:
        return False
    course = utilisation_over_time(response, row)
    if course is None:
        return (row.utilisation or 0.0) > GROWTH
    end = response.final_state.time
    first, before, last = (float(np.max(course[response.time <= at], initial=0.0)) for at in (2.0 * begin - end, begin, end))
    if (row.utilisation or 0.0) - before > GROWTH:
        return True
    # Parts of equal length end at `begin` and at the end: the growth in each continues as a geometric series, which is summed.
    late, fall = last - before, 1.0 - (last - before) / max(before - first, last - before, 1e-300)
    return continues and late / max(fall, 1.0 / _LARGEST_CREEP) > GROWTH


def growth_note(end: float) -> str:
    return f"{GROWS} at {duration_text(end, 4)}: run longer"


def quiet_from(motion: Entries, run: tuple[float, float], over: float) -> float:
    """Find the instant [s] after which no value may grow; infinite where growth is allowed until the end.

    After a shock that is half of the free vibration: motions that a strong shock excites slowly, such as rocking, peak late.
    The arguments are those of `ends_early`.
    """
    start, end = run
    kinds = {str(part.get("kind")) for part in elements(motion)}
    if not kinds:
        return math.inf
    if math.isnan(over):
        return end - (end - start) / 3.0 if kinds <= STEADY else math.inf
    if steady_interval(motion)[0] or "sweep" in kinds:
        return math.inf
    return 0.5 * (over + end)
