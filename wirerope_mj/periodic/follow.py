"""Following a branch of periodic motions in the frequency or the level of the base's sine."""

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
import numpy.typing as npt

from wirerope_mj.excitation import Sine
from wirerope_mj.excitation.checks import Direction, checked_direction, positive, unit_vector
from wirerope_mj.periodic.branch import Bifurcation, Branch, Parameter
from wirerope_mj.periodic.continuation import Continuation, Point
from wirerope_mj.periodic.events import locate, unstable
from wirerope_mj.periodic.observe import amplitude, body_acceleration, observed_bodies, travel_exceeded
from wirerope_mj.periodic.orbit import ITERATIONS, Search
from wirerope_mj.periodic.shooting import close, shot
from wirerope_mj.simulation.simulate import check_direction
from wirerope_mj.state import State
from wirerope_mj.statics import History
from wirerope_mj.system import System

Array = npt.NDArray[np.float64]

FIRST = 0.2
"""First step in units of the largest."""

AIM = 4
"""Corrector iterations that the step length is steered to."""


@dataclass(frozen=True, kw_only=True)
class Question:
    """What is followed, from where to where, and what is read off it; all arguments checked."""

    parameter: Parameter
    start: float
    stop: float
    other: float
    direction: Direction
    payload: str
    response_direction: Direction
    periods: int
    largest_step: float
    smallest_step: float
    most_points: int
    tolerance: float

    @property
    def sign(self) -> float:
        """1 for a rising parameter, -1 for a falling one."""
        return 1.0 if self.stop > self.start else -1.0


def follow_branch(
    system: System,
    *,
    start: float,
    stop: float,
    acceleration: float | None = None,
    frequency: float | None = None,
    direction: str | Sequence[float],
    payload: str,
    response_direction: str | Sequence[float] | None = None,
    periods: int = 1,
    guess: State | None = None,
    history: History = "relaxed",
    accuracy: float = 1e-4,
    tolerance: float = 1e-6,
    largest_step: float = 0.02,
    smallest_step: float = 1e-5,
    most_points: int = 3000,
) -> Branch:
    """Return the branch of periodic motions of `system` from `start` to `stop`, around folds if there are any.

    With `acceleration` given, `start` and `stop` are frequencies [Hz]; with `frequency` given they are accelerations [m/s^2].
    The branch is followed by pseudo-arclength continuation; folds and changes of stability are located on the way.

    Args:
        system: the system.
        start: value of what is followed at the beginning.
        stop: value at the end; from the higher to the lower one is allowed.
        acceleration: amplitude of the base's acceleration [m/s^2], to follow the frequency.
        frequency: of the base [Hz], to follow the acceleration.
        direction: of the base, "x", "y", "z" or a vector.
        payload: body whose acceleration is the branch's amplitude.
        response_direction: along which it is taken; that of the base unless given.
        periods: of the base after which the motions repeat themselves; above 1 for subharmonics.
        guess: state at phase 0 at `start` to begin from, for instance `PeriodicOrbit.state`.
        history: equilibrium about which the motions are looked for.
        accuracy: error of the integration allowed, relative to the motions' ranges.
        tolerance: largest residual of a point, in shares of its ranges.
        largest_step: largest relative change of the parameter between two points.
        smallest_step: smallest one before the branch is given up.
        most_points: points after which it ends.

    Returns:
        The branch; `complete` says whether it reached `stop`, `message` why it ended.

    Raises:
        ValueError: an argument is out of range.
        ConvergenceError: there is no periodic motion at the start; says what is left and what was tried.
        SimulationError: the motion at the start leaves a mount's rated travel or the validity of its law.
    """
    question = _question(
        system, start=start, stop=stop, acceleration=acceleration, frequency=frequency, direction=direction,
        payload=payload, response_direction=response_direction, periods=periods, largest_step=largest_step,
        smallest_step=smallest_step, most_points=most_points, tolerance=tolerance,
    )  # fmt: skip
    search = Search(system, direction=question.direction, history=history, accuracy=positive("accuracy", accuracy))
    with search.flow.ready():
        return _Walk(search, question).go(guess, history)


def _question(
    system: System,
    *,
    acceleration: float | None,
    frequency: float | None,
    direction: str | Sequence[float],
    payload: str,
    response_direction: str | Sequence[float] | None,
    **numbers: float,
) -> Question:
    if (acceleration is None) == (frequency is None):
        raise ValueError(
            "give either `acceleration` (to follow the frequency) or `frequency` (to follow the acceleration)."
        )
    values = {name: positive(name, value) for name, value in numbers.items()}
    if values["start"] == values["stop"]:
        raise ValueError(
            f"`stop` must differ from `start`, got {values['start']!r} for both; use periodic_orbit instead."
        )
    if not values["smallest_step"] < values["largest_step"] < 1.0:
        raise ValueError(
            f"`smallest_step` must be below `largest_step`, and that below 1, got {values['smallest_step']!r} and "
            f"{values['largest_step']!r}."
        )
    known = observed_bodies(system)
    if payload not in known:
        raise ValueError(f"`payload` must be one of {', '.join(known)}; got {payload!r}.")
    moved = checked_direction(direction)
    parameter: Parameter = "frequency" if frequency is None else "acceleration"
    other = (
        positive("acceleration", acceleration) if acceleration is not None else positive("frequency", frequency or 0.0)
    )
    check_direction(system, Sine(frequency=1.0, acceleration=1.0, direction=moved))
    return Question(
        parameter=parameter,
        other=other,
        direction=moved,
        payload=payload,
        response_direction=moved if response_direction is None else checked_direction(response_direction),
        start=values["start"],
        stop=values["stop"],
        periods=int(values["periods"]),
        largest_step=values["largest_step"],
        smallest_step=values["smallest_step"],
        most_points=int(values["most_points"]),
        tolerance=values["tolerance"],
    )


class _Walk:
    """A branch on its way: the points so far and what happened between them."""

    def __init__(self, search: Search, question: Question) -> None:
        self.search, self.question, self.system = search, question, search.system
        self.path = Continuation(
            search,
            parameter=question.parameter,
            other=question.other,
            periods=question.periods,
            unit=question.largest_step,
            tolerance=question.tolerance,
        )
        self.rows: list[_Row] = []
        self.events: list[Bifurcation] = []

    def go(self, guess: State | None, history: History) -> Branch:
        """Return the branch from its start to where it ends."""
        last = self._first(guess)
        self._add(last)
        length, complete, message = FIRST, False, ""
        while not message:
            point, length = self._next(last, length)
            if point is None:
                message = (
                    f"stopped at {self._where(last)}: no point within {self.question.smallest_step:.1g} of it was found"
                )
                break
            over = travel_exceeded(self.system, point.shot.track)
            if over:
                message = f"ended at {self._where(point)}: {over}"
                break
            if (point.parameter - self.question.stop) * self.question.sign >= 0.0:
                final = self.path.at_value(last, self.question.stop)
                point, complete, message = final or point, True, f"reached {self._where(final or point)}"
            elif (point.parameter - self.question.start) * self.question.sign < 0.0 and len(self.rows) > 2:
                message = f"came back to its start at {self._where(point)}"
            else:
                self._between(last, point, length)
            self._add(point)
            length = min(1.0, length * float(np.clip(AIM / max(point.corrections, 1), 0.5, 1.6)))
            last = point
            if len(self.rows) >= self.question.most_points and not message:
                message = f"ended after {len(self.rows)} points at {self._where(last)}"
        return self._branch(complete, message, history)

    def _first(self, guess: State | None) -> Point:
        question = self.question
        drive = self.path.drive(question.start)
        orbit = self.search.find(
            drive.frequency, drive.acceleration, question.periods, guess=guess, tolerance=question.tolerance
        )
        carried = self.search.coordinates.carried(drive.frequency, drive.acceleration)
        x = self.search.coordinates.from_state(orbit.state.values, carried)
        found, _ = close(
            self.search.flow, shot(self.search.flow, x, drive), tolerance=question.tolerance, iterations=ITERATIONS
        )
        return self.path.point(found, question.start, before=None, sign=question.sign)

    def _next(self, last: Point, length: float) -> tuple[Point | None, float]:
        """Return the next point and the arclength to it, shorter where the corrector fails."""
        while length * self.question.largest_step >= self.question.smallest_step:
            point = self.path.step(last, length)
            if point is not None:
                return point, length
            length /= 2.0
        return None, length

    def _between(self, a: Point, b: Point, length: float) -> None:
        """Note what happens between two points, and the point where it does."""
        found = locate(self.path, a, b, length)
        if found is None:
            return
        kind, multiplier, point = found
        self._add(point)
        row = self.rows[-1]
        self.events.append(
            Bifurcation(
                kind=kind,
                frequency=row.frequency,
                acceleration=row.acceleration,
                amplitude=row.amplitude,
                index=len(self.rows) - 1,
                multiplier=multiplier,
                before=unstable(a),
                after=unstable(b),
            )  # fmt: skip
        )

    def _add(self, point: Point) -> None:
        drive = point.shot.track.drive
        acceleration = body_acceleration(self.system, point.shot.track, self.question.payload)
        self.rows.append(
            _Row(
                frequency=drive.frequency,
                acceleration=drive.acceleration,
                amplitude=amplitude(acceleration @ unit_vector(self.question.response_direction)),
                stable=point.stability.stable,
                multipliers=point.stability.multipliers,
                neutral=point.stability.neutral,
                unknowns=point.shot.x,
                steps=drive.steps,
                tangent=float(point.tangent[-1]),
                residual=point.shot.residual,
            )
        )

    def _where(self, point: Point) -> str:
        return f"{point.parameter:.5g} {'Hz' if self.question.parameter == 'frequency' else 'm/s^2'}"

    def _branch(self, complete: bool, message: str, history: History) -> Branch:
        rows, question = self.rows, self.question
        width = max(row.multipliers.size for row in rows)
        multipliers = np.full((len(rows), width), np.nan + 0.0j)
        for i, row in enumerate(rows):
            multipliers[i, : row.multipliers.size] = row.multipliers
        return Branch(
            system=self.system,
            parameter=question.parameter,
            frequency=np.array([row.frequency for row in rows]),
            acceleration=np.array([row.acceleration for row in rows]),
            amplitude=np.array([row.amplitude for row in rows]),
            stable=np.array([row.stable for row in rows]),
            floquet_multipliers=multipliers,
            neutral=np.array([row.neutral for row in rows]),
            bifurcations=tuple(self.events),
            payload=question.payload,
            direction=question.direction,
            response_direction=question.response_direction,
            periods=question.periods,
            unknowns=np.array([row.unknowns for row in rows]),
            steps=np.array([row.steps for row in rows]),
            tangents=np.array([row.tangent for row in rows]),
            residual=np.array([row.residual for row in rows]),
            history=history,
            complete=complete,
            model_steps=self.search.flow.steps,
            message=message,
        )


@dataclass(frozen=True, kw_only=True)
class _Row:
    """What a branch keeps of a point."""

    frequency: float
    acceleration: float
    amplitude: float
    stable: bool
    multipliers: npt.NDArray[np.complex128]
    neutral: int
    unknowns: Array
    steps: int
    tangent: float
    residual: float
