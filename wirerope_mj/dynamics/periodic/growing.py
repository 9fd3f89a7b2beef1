"""Following a branch of periodic motions from point to point until it ends; kept on disk if a folder is given."""

import itertools
import math
import time
from collections.abc import Callable
from dataclasses import asdict, replace
from pathlib import Path

import numpy as np

from wirerope_mj.dynamics.periodic.branch import Bifurcation, Branch, SideBranch
from wirerope_mj.dynamics.periodic.continuation import Continuation, Point, turns
from wirerope_mj.dynamics.periodic.motion import travel_exceeded
from wirerope_mj.dynamics.periodic.orbit import SETTLING, OrbitSearch
from wirerope_mj.dynamics.periodic.shooting import shot
from wirerope_mj.dynamics.periodic.side_branches import back_on_itself, pass_by, unstable_stretches
from wirerope_mj.dynamics.periodic.storage import (
    COLUMNS,
    BranchOptions,
    Row,
    fingerprint,
    load_rows,
    require_motion,
    row_of,
    save_rows,
)
from wirerope_mj.foundation.arrays import Array, Entries
from wirerope_mj.foundation.state import State

FIRST = 0.2  # first step in units of the largest
AIM = 4  # corrector iterations that the step length is steered to
# Steps, in units of the largest, by which a branch that cannot be followed is taken up again.
LEAPS = (0.02, 0.25, 0.5, 1.0, 2.0, 4.0)
RIPPLE = 5.0  # distance of two folds in units of the accuracy within which the steps may have made them: 3 was observed
# Angle between the tangents of two points [rad] that the step length is steered to: a curve through the points is smooth.
BEND = 0.1
REACHED = 1e-3  # relative change of the parameter within which the rated travel is reached
SAVE_EVERY = 2.0  # time between two saves [s]: the points of the last ones are lost if the process is killed


class GrowingBranch:
    """A branch while it is followed: its points, events, gaps and side branches so far."""

    def __init__(self, search: OrbitSearch, options: BranchOptions, folder: Path | None) -> None:
        self.search, self.options, self.system, self.folder = search, options, search.system, folder
        self.path = Continuation(
            search, parameter=options.parameter, held=options.held, periods=options.periods, unit=options.largest_step,
            tolerance=options.tolerance,
        )  # fmt: skip
        self.rows: list[Row] = []
        self.events: list[Bifurcation] = []
        self.gaps: list[tuple[float, float]] = []
        self.side_branches: list[SideBranch] = []
        self.complete, self.message, self.beyond_travel, self._earlier_steps = False, "", "", 0
        self._saved, self._jump = time.monotonic(), -1

    def follow(self, guess: State | None, update: Callable[[float, float], None]) -> Branch:
        """Follow the branch from its start, or resume it from its last point."""
        options = self.options
        last = self._resumed()
        if last is None and not self.message:  # the periodic motion at the start, from a guess or the equilibrium
            drive, coordinates = self.path.drive(options.start), self.search.coordinates
            f, a = drive.frequency, drive.acceleration
            orbit = self.search.find(f, a, options.periods, guess=guess, tolerance=options.tolerance)
            last = self._at(coordinates.from_state(orbit.state.values, coordinates.carried(f, a)), options.start)
            self.rows.append(self._row(last))
            require_motion(self.rows[-1].amplitude, a, options.payload, options.response_direction)
        try:
            length = FIRST
            while not self.message and last is not None:
                update(options.fraction(last.parameter), last.parameter)
                last, length = self._advance(last, length)
            # Unstable stretches beside which the system settles nearby are side branches: their events are left out.
            if last is not None:
                for part, side in list(unstable_stretches(self.search, options, self.rows, self.events)):
                    self.events = [event for event in self.events if not part.start - 1 <= event.index <= part.stop]
                    if not self._add_side_branch(side):
                        self.rows[part] = [replace(row, stable=True) for row in self.rows[part]]
        finally:
            self._save()
        rows = self.rows
        multipliers = np.full((len(rows), max(row.multipliers.size for row in rows)), np.nan + 0.0j)
        for i, row in enumerate(rows):
            multipliers[i, : row.multipliers.size] = row.multipliers
        values: Entries = {name: np.array([getattr(row, name) for row in rows]) for name in (*COLUMNS, "unknowns")}
        values["tangents"] = values.pop("tangent")
        kept = ("parameter", "payload", "direction", "response_direction", "periods", "history")
        values |= {name: getattr(options, name) for name in kept}
        return Branch(
            system=self.system, **values, floquet_multipliers=multipliers, bifurcations=tuple(self.events),
            complete=self.complete, gaps=tuple(self.gaps),
            side_branches=tuple(sorted(self.side_branches, key=lambda side: min(side.start, side.stop))),
            model_steps=self.search.flow.steps + self._earlier_steps, message=self.message,
            beyond_travel=self.beyond_travel,
        )  # fmt: skip

    def _search_beyond(self, last: Point) -> Point | None:
        """Find a periodic motion a little further on in the parameter, from the last motion by Newton's method; else None.

        A stable motion settles first: along slow directions a branch accumulates the residuals of its points. If that fails, it
        settles at the new value, too; so does an unstable one whose branch leads on. A motion that is no less stable is
        preferred: where stops are grazed Newton's method finds motions of other branches, which lead back.
        """
        options, x, less_stable = self.options, last.shot.x, None
        towards = 1.0 if last.tangent[-1] > 0.0 else -1.0
        if not last.unstable:
            x = self.search.settled(x, last.shot.track.drive, SETTLING[0])
        settlings = (0,) if last.unstable and towards != options.sign else (0, SETTLING[1])
        for settling, leap in itertools.product(settlings, LEAPS):
            value = last.parameter * math.exp(towards * leap * options.largest_step)
            if (value - options.stop) * options.sign > 0.0:
                continue
            motion = self.path.closed(self.search.settled(x, self.path.drive(value), settling) if settling else x, value)
            if motion is None:
                continue
            point = self.path.point(motion, value, before=None, sign=towards)
            # The shortest leap is an ordinary step, but not where the branch has turned back, as at a narrow peak, and is left.
            passed = any((options.followed(row) - last.parameter) * options.sign > 0.0 for row in self.rows)
            gap = (last.parameter, value) if leap > LEAPS[0] or passed else None
            if leap == LEAPS[0] or point.unstable <= last.unstable:
                break
            less_stable = less_stable or (point, gap)
        else:
            if less_stable is None:
                return None
            point, gap = less_stable
        self.gaps += [gap] if gap else []
        return point

    def _advance(self, last: Point, length: float) -> tuple[Point, float]:
        """Take one step and keep its point and events; `message` is set where the branch ends."""
        options = self.options
        point, past, leapt = None, None, False
        while point is None and length * options.largest_step >= options.smallest_step:
            point = self.path.step(last, length)
            length /= 2.0 if point is None else 1.0
        if point is not None and last.tangent[-1] * options.sign > 0.0 and turns(last, point):
            past = self._pass_fold(last, point, length)
        elif point is not None and point.tangent[-1] * options.sign < 0.0:
            past = self._pass_turn(point)
        if past is not None:
            point, length, leapt = past, FIRST, True
        elif point is None or (turns(last, point) and last.unstable == point.unstable):
            # A step that fails, or a fold at which no multiplier passes 1: for slow motions, such as those of axes that hardly
            # move or of a narrow resonance, the tangent's direction is inaccurate.
            beyond = self._search_beyond(last)
            point, length, leapt = (beyond, FIRST, True) if beyond is not None else (point, length, False)
        if point is None:
            self.message = (
                f"stopped at {self._where(last)}: no periodic motion was found within {options.smallest_step:.1g} of it, nor "
                f"up to {LEAPS[-1] * options.largest_step:.2g} beyond it, also after {SETTLING[1]} periods of settling there"
            )
            return last, length
        over = travel_exceeded(self.system, point.shot.track)
        if over and length * options.largest_step > REACHED:
            return last, length / 2.0
        if over:
            self.beyond_travel = over
            self.message = f"ended at {self._where(point)}: {over}"
            return last, length
        if (point.parameter - options.stop) * options.sign >= 0.0:
            point = self.path.at_value(last, options.stop) or point
            gaps = "".join(f"; not followed from {a:.5g} to {b:.5g}" for a, b in self.gaps)
            if len(self.gaps) > 2:
                low, high = min(map(min, self.gaps)), max(map(max, self.gaps))
                gaps = f"; not followed in {len(self.gaps)} places from {low:.5g} to {high:.5g}"
            self.complete, self.message = True, f"reached {self._where(point)}{gaps}"
        elif (point.parameter - options.start) * options.sign < 0.0 and len(self.rows) > 2:
            self.message = f"ended at {self._where(point)}: it passed its start again"
        elif not leapt:
            self._add_event(last, point, length)
        self.rows.append(self._row(point))
        self.search.adapt(point.shot)
        if len(self.rows) >= options.most_points and not self.message:
            self.message = f"ended after {len(self.rows)} points at {self._where(point)}"
        if self.folder is not None and time.monotonic() - self._saved > SAVE_EVERY:
            self._save()
        tangent = point.tangent * np.append(point.shot.scale / last.shot.scale, 1.0)  # in the units of the last point
        angle = math.acos(min(max(float(last.tangent @ tangent / np.linalg.norm(tangent)), -1.0), 1.0))
        wanted = min(AIM / max(point.corrections, 1), BEND / max(angle, 1e-6))
        return point, min(1.0, length * float(np.clip(wanted, 0.5, 1.6)))

    def _pass_fold(self, a: Point, b: Point, length: float) -> Point | None:
        """Continue past the fold between two points if a motion beyond is nearly as large; None if a sweep would jump there."""
        event = self.path.event(a, b, length)
        assert event is not None
        row = self._row(event.point)
        passed = pass_by(self.path, self.options, row, 1.0 if a.tangent[-1] > 0.0 else -1.0)
        if passed is None:
            return None
        point, difference = passed
        self.rows.append(row)
        self._add_side_branch(SideBranch(start=event.point.parameter, stop=point.parameter, difference=difference))
        return point

    def _pass_turn(self, point: Point) -> Point | None:
        """Continue beyond the farthest point if the branch retraces itself from there to `point`; None if it does not."""
        farthest = back_on_itself(self.options, self.rows, self._row(point))
        if farthest is None or farthest == self._jump:
            return None
        row = self.rows[farthest]
        value = self.options.followed(row)
        passed = pass_by(self.path, self.options, row, self.options.sign)
        if passed is None:  # a narrow resonance, whose two sides are as near
            self._jump = farthest
            return None
        del self.rows[farthest + 1 :]
        self.events = [event for event in self.events if event.index < farthest]
        self.gaps = [gap for gap in self.gaps if (gap[1] - value) * self.options.sign < 0.0]
        beyond, difference = passed
        self._add_side_branch(SideBranch(start=point.parameter, stop=value, difference=difference))
        return beyond

    def _add_side_branch(self, side: SideBranch) -> bool:
        """Keep a side branch, unless its two motions agree within the accuracy; return whether it is kept."""
        apart = side.difference > self.options.accuracy
        self.side_branches += [side] if apart else []
        return apart

    def _at(self, x: Array, value: float, steps: int | None = None) -> Point:
        motion = self.search.closed(shot(self.search.flow, x, self.path.drive(value, steps)), self.options.tolerance)
        return self.path.point(motion, value, before=None, sign=self.options.sign)

    def _resumed(self) -> Point | None:
        """Restore the branch stored in the folder and return its last point; None without one, or if the branch had ended."""
        known = load_rows(self.folder, self._content()) if self.folder is not None else None
        if known is None:
            return None
        self.rows, self.events, stored = known
        self._earlier_steps = stored["model_steps"]
        self.gaps = [(float(a), float(b)) for a, b in stored["gaps"]]
        self.side_branches = [SideBranch(**side) for side in stored.get("side_branches", ())]
        if stored["message"]:
            self.complete, self.message = stored["complete"], stored["message"]
            self.beyond_travel = stored.get("beyond_travel", "")
            return None
        last = self.rows[-1]
        if last.smoothing_width:
            self.search.flow.smooth(last.smoothing_width)
        point = self._at(last.unknowns, self.options.followed(last), last.steps)
        self.search.adapt(point.shot)
        if len(self.rows) == 1:
            return point
        return self.path.turned(point, last.tangent, last.unknowns - self.rows[-2].unknowns)

    def _add_event(self, a: Point, b: Point, length: float) -> None:
        """Find the fold or change of stability between two points (`a` is the last one kept), and keep it and its point.

        Two folds hardly farther from each other than the accuracy are left out: the derivative of the stepped motion jumps
        where a mount's reversal passes a stage of a step; where a branch is steep that turns it back and forth by less than
        the steps' own error.
        """
        event = self.path.event(a, b, length)
        if event is None:
            return
        row = self._row(event.point)
        self.rows.append(row)
        self.events.append(
            Bifurcation(
                kind=event.kind, frequency=row.frequency, acceleration=row.acceleration, amplitude=row.amplitude,
                index=len(self.rows) - 1, multiplier=event.multiplier, before=a.unstable, after=b.unstable,
            )
        )  # fmt: skip
        if [event.kind for event in self.events[-2:]] == ["fold", "fold"]:
            first, second = (event.frequency * event.acceleration for event in self.events[-2:])  # one of the two is fixed
            if abs(math.log(second / first)) < RIPPLE * self.options.accuracy:
                del self.events[-2:]

    def _row(self, point: Point) -> Row:
        return row_of(self.system, point, self.options.payload, self.options.response_direction)

    def _where(self, point: Point) -> str:
        return f"{point.parameter:.5g} {'Hz' if self.options.parameter == 'frequency' else 'm/s^2'}"

    def _content(self) -> Entries:
        options = {name: list(v) if isinstance(v, tuple) else v for name, v in asdict(self.options).items()}
        options["acceleration" if self.options.parameter == "frequency" else "frequency"] = options.pop("held")
        return {
            "system": fingerprint(self.system), **options, "complete": self.complete, "message": self.message,
            "model_steps": self.search.flow.steps + self._earlier_steps, "gaps": self.gaps,
            "beyond_travel": self.beyond_travel, "side_branches": [asdict(side) for side in self.side_branches],
        }  # fmt: skip

    def _save(self) -> None:
        if self.folder is not None and self.rows:
            save_rows(self.folder, self.rows, self.events, self._content())
            self._saved = time.monotonic()
