"""Side branches: stretches of a branch beside which a second motion of nearly equal amplitude exists.

Friction that several axes share makes them: two stable motions of one period exist over a range of frequencies, micrometres and
some hundredths of a percent of their accelerations apart, and the branch turns back and forth between them. A branch is
continued past such a fold; a stretch of unstable motions is a side branch if the motion on which the system settles is as near.
Two motions within the accuracy of each other are one.
"""

from collections.abc import Iterator, Sequence
from dataclasses import replace

import numpy as np

from wirerope_mj.dynamics.periodic.branch import ALIKE, Bifurcation, SideBranch
from wirerope_mj.dynamics.periodic.continuation import Continuation, Point
from wirerope_mj.dynamics.periodic.motion import Drive
from wirerope_mj.dynamics.periodic.orbit import OrbitSearch
from wirerope_mj.dynamics.periodic.shooting import shot
from wirerope_mj.dynamics.periodic.storage import BranchOptions, Row, amplitude_of

# Steps beyond a fold, in units of the largest, at which a motion is searched for.
LEAPS = (0.1, 0.25, 0.5, 1.0)
SETTLE = 60  # periods after which Newton's method is tried again beyond a fold
# Periods over which the system leaves an unstable motion, and the periods after them in which its amplitude is read.
SETTLING, OBSERVED = 300, 8
# Disturbance of the motion before, over its ranges: a multiplier of 1.03 makes it as large as the motion in these periods.
DISTURBANCE = 1e-3


def pass_by(path: Continuation, options: BranchOptions, farthest: Row, towards: float) -> tuple[Point, float] | None:
    """Find the motion beyond a fold if its branch, at the fold, is within 1 % of the fold's amplitude; None if it is a jump.

    `farthest` is the motion at the fold; `towards` is 1 if the parameter rose up to there, else -1. Motions beyond it are
    searched for by Newton's method from there, then after letting the system settle. Returns also the relative difference of
    both amplitudes at the fold.
    """
    value, flow = options.followed(farthest), path.flow
    for settling, leap in [(0, leap) for leap in LEAPS] + [(SETTLE, leap) for leap in LEAPS[1:]]:
        further = value * float(np.exp(towards * leap * options.largest_step))
        if (further - options.stop) * options.sign >= 0.0 or (further - options.start) * options.sign <= 0.0:
            continue
        drive, x = path.drive(further), farthest.unknowns
        if settling:
            long = replace(drive, periods=settling * drive.periods, steps=settling * drive.steps)
            x = flow.ends(x[np.newaxis], long)[0]
        beyond = path.closed(x, further)
        back = path.closed(beyond.x, value) if beyond is not None else None
        if beyond is None or back is None:
            continue
        size = amplitude_of(path.search.system, back.track, options.payload, options.response_direction)
        difference = abs(size / farthest.amplitude - 1.0)
        if difference < ALIKE:
            return path.point(beyond, further, before=None, sign=towards), difference
    return None


def back_on_itself(options: BranchOptions, rows: Sequence[Row], point: Row) -> int | None:
    """Find the index of the farthest row if a point beyond it retraces the rows before within 1 % of amplitude; None if not.

    Behind most folds that are jumps the amplitude differs by more before the branch has gone back a step.
    """
    values = np.array([options.followed(row) for row in rows])
    farthest = int(np.argmax(options.sign * values))
    value = options.followed(point)
    if options.sign * np.log(values[farthest] / value) < options.largest_step:
        return None
    passed = np.flatnonzero((values[:farthest] - value) * (values[1 : farthest + 1] - value) <= 0.0)
    if not passed.size:
        return None
    i = int(passed[-1])
    fraction = (value - values[i]) / (values[i + 1] - values[i]) if values[i + 1] != values[i] else 0.0
    before = rows[i].amplitude + fraction * (rows[i + 1].amplitude - rows[i].amplitude)
    return farthest if abs(point.amplitude / before - 1.0) < ALIKE else None


def unstable_stretches(
    search: OrbitSearch, options: BranchOptions, rows: Sequence[Row], events: Sequence[Bifurcation]
) -> Iterator[tuple[slice, SideBranch]]:
    """Yield the rows and side branch of each unstable stretch beside which the system settles within 1 % of its amplitude.

    A stretch that begins or ends at a fold lies between two jumps and is left as it is.
    """
    unstable = np.array([False, *(not row.stable for row in rows), False])
    ends = np.flatnonzero(np.diff(unstable.astype(int)))
    folds = [event.index for event in events if event.kind == "fold"]
    for first, behind in zip(ends[::2].tolist(), ends[1::2].tolist(), strict=True):
        if any(first - 1 <= fold <= behind for fold in folds):
            continue
        worst = max(range(first, behind), key=lambda i: float(np.abs(rows[i].multipliers[0])))
        tried = [rows[i] for i in sorted({(3 * first + behind) // 4, worst, (first + 3 * behind) // 4})]
        differences = []
        for row in tried:  # the amplitude on which the system settles from the disturbed unstable motion; NaN if it diverges
            per_period = row.steps // options.periods
            drive = Drive(frequency=row.frequency, acceleration=row.acceleration, periods=SETTLING, steps=SETTLING * per_period)
            begin = shot(search.flow, row.unknowns, replace(drive, periods=options.periods, steps=row.steps))
            # A reproducible disturbance, along no special direction of the system.
            moved = begin.x + DISTURBANCE * begin.scale * np.cos(np.arange(begin.x.size))
            end = search.flow.ends(moved[np.newaxis], drive)[0]
            seen = search.flow.follow(end, replace(drive, periods=OBSERVED, steps=OBSERVED * per_period))
            settled = amplitude_of(search.system, seen, options.payload, options.response_direction)
            differences.append(abs(settled / row.amplitude - 1.0))
        difference = float(np.max(differences))
        if difference < ALIKE:
            start, stop = (options.followed(rows[i]) for i in (first, behind - 1))
            yield slice(first, behind), SideBranch(start=start, stop=stop, difference=difference)
