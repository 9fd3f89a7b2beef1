"""Searching for a periodic motion of a system whose base follows a sine: settling, shooting, judging."""

import math
from collections.abc import Sequence

import mujoco
import numpy as np

from wirerope_mj.dynamics.periodic.coordinates import Coordinates
from wirerope_mj.dynamics.periodic.flow import Flow
from wirerope_mj.dynamics.periodic.kernel_flow import flow_of
from wirerope_mj.dynamics.periodic.multipliers import FloquetStability, stability, wide_monodromy
from wirerope_mj.dynamics.periodic.observe import ranges, travel_exceeded
from wirerope_mj.dynamics.periodic.orbit import PeriodicOrbit
from wirerope_mj.dynamics.periodic.scaled_states import ScaledStates
from wirerope_mj.dynamics.periodic.shooting import ACCEPTED, Shot, close, monodromy, shot
from wirerope_mj.dynamics.periodic.smoothing import smoothed
from wirerope_mj.dynamics.periodic.track import Drive, Steps
from wirerope_mj.dynamics.periodic.variational import variational_of
from wirerope_mj.engine.control.install import STATE
from wirerope_mj.engine.simulation import simulate
from wirerope_mj.engine.simulation.simulate import check_direction
from wirerope_mj.engine.statics import History
from wirerope_mj.engine.system import System
from wirerope_mj.foundation.arguments import integer, nonzero, positive
from wirerope_mj.foundation.arrays import Array
from wirerope_mj.foundation.directions import Direction, checked_direction
from wirerope_mj.foundation.errors import ConvergenceError, SimulationError
from wirerope_mj.foundation.state import State
from wirerope_mj.motions import Sine

SETTLING = (20, 60, 240)
"""Periods that are simulated before Newton's method starts, and more of them each time it fails."""

ITERATIONS = 20
"""Newton iterations of one attempt: four times what a smooth start takes."""

MANY = 13
"""Unknowns from which on the variational equation is cheaper than a copy of the system for each: one body free to move and turn
has 12 without its mounts' states."""

WIDTHS = 4
"""Times that the width of smoothed laws is set by the motion that was found with the last one."""

SAME_WIDTH = 0.01
"""Relative change of that width that no longer matters: the motion depends on its square."""


def periodic_orbit(
    system: System,
    *,
    frequency: float,
    acceleration: float,
    direction: str | Sequence[float],
    periods: int = 1,
    guess: State | None = None,
    history: History = "relaxed",
    accuracy: float = 1e-4,
    tolerance: float = 1e-8,
    smoothing: float | None = None,
) -> PeriodicOrbit:
    """Return the periodic motion of `system` under a sine of its base, by shooting on the engine's state.

    Newton's method closes the gap between the state at phase 0 and that some periods later; the columns of its matrix are
    integrated in parallel. The base is prescribed: it is neither among the unknowns nor among the multipliers. Without a guess
    the system is simulated for a while from its equilibrium, longer if Newton's method fails from there.

    Args:
        system: the system.
        frequency: of the base [Hz].
        acceleration: amplitude of the base's acceleration [m/s^2].
        direction: of the base, "x", "y", "z" or a vector.
        periods: number of the base's periods after which the motion is to repeat itself; above 1 for subharmonics.
        guess: state at phase 0 to start from, for instance that of a neighbouring motion.
        history: equilibrium about which the motion is looked for; vibration lets the hysteretic part of the load leak away,
            so that only the relaxed one belongs to a periodic motion of most laws.
        accuracy: error of the integration allowed, relative to the motion's ranges.
        tolerance: largest residual.
        smoothing: fraction of the mounts' largest velocity over which the laws are smoothed, for instance 0.01; None
            leaves them as they are.

    Raises:
        ValueError: an argument is out of range.
        ModelError: the base has no driven slide in this direction.
        ConvergenceError: no periodic motion was found; states the residual and what was tried.
        SimulationError: the motion leaves a mount's rated travel or the validity of its law.
    """
    sine = Sine(
        frequency=positive("frequency", frequency), acceleration=nonzero("acceleration", acceleration),
        direction=checked_direction(direction),
    )  # fmt: skip
    integer("periods", periods, least=1)
    check_direction(system, sine)
    if guess is not None:
        _require_state(system, guess)
    search = OrbitSearch(
        system, direction=sine.direction, history=history, accuracy=positive("accuracy", accuracy), smoothing=smoothing
    )
    with search.flow.ready():
        return search.find(
            sine.frequency, sine.amplitude, periods, guess=guess, tolerance=positive("tolerance", tolerance)
        )


def _require_state(system: System, guess: State) -> None:
    """Raise ValueError unless the guess is a state of this system."""
    if not isinstance(guess, State):
        raise ValueError(f"`guess` must be a State, as `PeriodicOrbit.state` is one; got {type(guess).__name__}.")
    size = mujoco.mj_stateSize(system.model, STATE)
    if guess.values.shape != (size,):
        raise ValueError(f"`guess` has {guess.values.size} values; a state of this system has {size}.")


class OrbitSearch:
    """Search for periodic motions of one system: its unknowns, and copies of it that are stepped.

    Attributes:
        scaled: whether derivatives and multipliers are those of the variational equation, see `ScaledStates.serve`.
        variational: the variational equation along a motion; None where a system of few unknowns does without.
    """

    def __init__(
        self, system: System, *, direction: Direction, history: History, accuracy: float, smoothing: float | None = None
    ) -> None:
        self.system, self._steps = system, Steps(system, accuracy)
        self.coordinates = Coordinates(system, direction=direction, history=history)
        self.smoothing = None if smoothing is None else positive("smoothing", smoothing)
        stepped = system if smoothing is None else smoothed(system, 1.0)  # the width follows the motion, see `adapt`
        self.flow = flow_of(self.coordinates, stepped)
        self.scaled = ScaledStates(stepped).serve
        self.variational = variational_of(self.flow) if self.scaled or self.coordinates.size >= MANY else None

    def adapt(self, motion: Shot) -> bool:
        """Smooth the laws over their fraction of this motion's velocity; return whether the width changed much."""
        if self.smoothing is None:
            return False
        before, wanted = self.flow.width, self.smoothing * ranges(self.system, motion.track).rate
        self.flow.smooth(wanted)
        return abs(wanted - before) > SAME_WIDTH * wanted

    def derivative(self, flow: Flow, at: Shot) -> Array:
        """Return the scaled monodromy matrix that Newton's method takes, (n_x, n_x)."""
        phi = self.variational.matrix(at) if self.scaled and self.variational is not None else None
        return monodromy(flow, at) if phi is None else phi

    def drive(self, frequency: float, acceleration: float, periods: int = 1) -> Drive:
        """Return a sine with the steps that the accuracy asks for."""
        steps = periods * self._steps.per_period(frequency)
        return Drive(frequency=frequency, acceleration=acceleration, periods=periods, steps=steps)

    def find(
        self, frequency: float, acceleration: float, periods: int, *, guess: State | None, tolerance: float
    ) -> PeriodicOrbit:
        """Return the periodic motion, from a guess or from the equilibrium after longer and longer transients."""
        drive = self.drive(frequency, acceleration, periods)
        carried = self.coordinates.carried(frequency, acceleration)
        x = self.coordinates.rest() if guess is None else self.coordinates.from_state(guess.values, carried)
        settled, best = 0, math.inf
        for more in (0, *SETTLING) if guess is not None else SETTLING:
            if more:
                x, settled = self._settled(x, drive, more), settled + more
            motion = self._closed(x, drive, tolerance)
            best = min(best, motion.residual)
            if motion.residual <= max(tolerance, ACCEPTED):
                return self.judged(motion, tolerance, f" after {settled} periods of settling" if settled else "")
        raise ConvergenceError(
            f"no motion of period {periods} / ({frequency:.6g} Hz) was found at {acceleration:.4g} m/s^2: the residual stays "
            f"at {best:.2g} (`tolerance` {tolerance:.2g}) after Newton's method from {'the guess and from ' if guess else ''}"
            f"{', '.join(str(n) for n in np.cumsum(SETTLING))} periods of settling. The motion may not be periodic there: try "
            "another frequency and follow the branch from it, a lower acceleration, a finer `accuracy`, or `periods=2` or 3."
        )

    def _closed(self, x: Array, drive: Drive, tolerance: float) -> Shot:
        """Return the nearest motion that Newton's method closes, with laws smoothed over its own velocity."""
        motion = shot(self.flow, x, drive)
        for _ in range(WIDTHS):
            changed = self.adapt(motion)
            start = shot(self.flow, motion.x, drive) if changed else motion
            motion = self.closed(start, tolerance)
            if not changed:
                break
        return motion

    def closed(self, start: Shot, tolerance: float) -> Shot:
        """Return the motion that Newton's method closes from `start`, or the best that was found."""
        return close(self.flow, start, tolerance=tolerance, iterations=ITERATIONS, derivative=self.derivative)

    def _settled(self, x: Array, drive: Drive, number: int) -> Array:
        """Return the unknowns after a number of the base's periods."""
        per_period = drive.steps // drive.periods
        long = Drive(
            frequency=drive.frequency, acceleration=drive.acceleration, periods=number, steps=number * per_period
        )
        end = self.flow.ends(x[np.newaxis], long)[0]
        if not np.isfinite(end).all():
            self._explain(x, long)
        return end

    def _explain(self, x: Array, drive: Drive) -> None:
        """Raise the error of a simulation over the same steps, which names the reason."""
        carried = self.coordinates.carried(drive.frequency, drive.acceleration)
        sine = drive.sine(self.coordinates.direction)
        state, step = State(values=self.coordinates.to_state(x, carried), time=0.0), drive.duration / drive.steps
        try:
            simulate(
                self.system, sine, duration=drive.duration, initial=state, timestep=step,
                sample_rate=drive.steps / drive.duration,
            )  # fmt: skip
        except SimulationError as error:
            level = f"at {drive.frequency:.5g} Hz and {abs(drive.acceleration):.4g} m/s^2"
            raise SimulationError(f"{level} the motion is too large: {error} Lower the acceleration.") from None
        raise SimulationError(f"the motion at {drive.frequency:.6g} Hz grew without bound.")

    def judged(self, motion: Shot, tolerance: float, settling: str) -> PeriodicOrbit:
        """Return a periodic motion with its stability; one that leaves a rated travel is a SimulationError."""
        drive = motion.track.drive
        over = travel_exceeded(self.system, motion.track)
        if over:
            raise SimulationError(
                f"at {drive.frequency:.5g} Hz and {abs(drive.acceleration):.4g} m/s^2 {over}. Lower the acceleration."
            )
        phi = self.variational.matrix(motion) if self.scaled and self.variational is not None else None
        judged = stability(self.flow, motion, wide_monodromy(self.flow, motion) if phi is None else phi)
        return self.orbit(motion, judged, tolerance, settling)

    def orbit(self, motion: Shot, judged: FloquetStability, tolerance: float, settling: str) -> PeriodicOrbit:
        """Return the result for a motion that was found."""
        drive = motion.track.drive
        carried = self.coordinates.carried(drive.frequency, drive.acceleration)
        reached = (
            ""
            if motion.residual <= tolerance
            else f", not the `tolerance` of {tolerance:.1g}: rounding stopped it there"
        )
        return PeriodicOrbit(
            system=self.system,
            frequency=drive.frequency,
            acceleration=drive.acceleration,
            direction=self.coordinates.direction,
            periods=drive.periods,
            smoothing_width=self.flow.width,
            state=State(values=self.coordinates.to_state(motion.x, carried), time=0.0),
            steps=drive.steps,
            floquet_multipliers=judged.multipliers,
            neutral=judged.neutral,
            stable=judged.stable,
            residual=motion.residual,
            iterations=motion.iterations,
            model_steps=self.flow.steps,
            message=f"residual {motion.residual:.1e} after {motion.iterations} Newton iterations{settling}{reached}",
        )
