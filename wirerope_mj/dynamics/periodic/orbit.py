"""A periodic motion under a sine of the base: the result of `periodic_orbit`, its harmonics, and the search for it."""

import math
from dataclasses import dataclass, field, replace
from fractions import Fraction
from functools import cached_property

import numpy as np
import scipy

from wirerope_mj.dynamics.periodic.flow import Flow, KernelFlow, flow_of
from wirerope_mj.dynamics.periodic.laws import ScaledStates, smoothed
from wirerope_mj.dynamics.periodic.motion import Coordinates, Drive, deflection_rates, ranges, travel_exceeded
from wirerope_mj.dynamics.periodic.shooting import ACCEPTED, Shot, close, monodromy, shot, stability, wide_monodromy
from wirerope_mj.dynamics.periodic.variational import variational_of
from wirerope_mj.engine.response import Response
from wirerope_mj.engine.simulation import simulate
from wirerope_mj.engine.simulation.stability import eigenvalues, stable_step, yield_rates
from wirerope_mj.engine.statics import History
from wirerope_mj.engine.system import System
from wirerope_mj.foundation.arguments import one_of, positive
from wirerope_mj.foundation.arrays import Array, ComplexArray
from wirerope_mj.foundation.budget import require_memory, require_time
from wirerope_mj.foundation.directions import Direction, checked_direction, direction_text, unit_vector
from wirerope_mj.foundation.errors import ConvergenceError, SimulationError
from wirerope_mj.foundation.state import State
from wirerope_mj.foundation.summary import Summarised, quantity
from wirerope_mj.motions import Sine


@dataclass(frozen=True, kw_only=True, repr=False)
class PeriodicOrbit(Summarised):
    """A motion that repeats itself after an integer number of the base's periods."""

    system: System = field(repr=False)
    frequency: float  #: of the base [Hz]
    acceleration: float  #: amplitude of the base's acceleration [m/s^2]
    direction: Direction  #: along which the base moves
    periods: int  #: number of the base's periods after which the motion repeats itself; above 1 for a subharmonic
    smoothing_width: float  #: velocity over which the laws were smoothed [m/s]; 0 for the laws as they are
    state: State = field(repr=False)  #: state at phase 0 of the base's sine
    steps: int  #: model steps in the whole motion
    floquet_multipliers: ComplexArray  #: multipliers by falling modulus, without the neutral ones
    #: number of neutral directions: those along which the motion can be shifted and still repeats itself (the offset of a law
    #: without an elastic part, the state of an axis that does not move)
    neutral: int
    stable: bool  #: whether no multiplier lies outside the unit circle
    residual: float  #: largest difference of end and start, relative to the ranges of deflections, rates and states
    iterations: int  #: iterations of Newton's method
    model_steps: int  #: model steps of all integrations of the search
    message: str  #: residual, iterations and transient

    def _summary(self) -> tuple[str, dict[str, str]]:
        largest = float(np.abs(self.floquet_multipliers).max(initial=0.0))
        return "PeriodicOrbit", {
            "base": f"{quantity(self.acceleration, 'm/s^2')} at {self.frequency:.4g} Hz along {direction_text(self.direction)}",
            "periods": str(self.periods),
            "stability": f"{'stable' if self.stable else 'unstable'}, largest multiplier {largest:.4g}",
            "residual": f"{self.residual:.1e} after {self.iterations} iterations",
            "message": self.message,
        }

    @property
    def duration(self) -> float:
        """Time after which the motion repeats itself [s]."""
        return self.periods / self.frequency

    @property
    def motion(self) -> Sine:
        """The base's motion."""
        return Sine(frequency=self.frequency, acceleration=self.acceleration, direction=self.direction)

    @cached_property
    def response(self) -> Response:
        """Response of the system over the motion's duration, sampled at every step."""
        system = smoothed(self.system, self.smoothing_width) if self.smoothing_width else self.system
        step, rate = self.duration / self.steps, self.steps / self.duration
        return simulate(system, self.motion, duration=self.duration, initial=self.state, timestep=step, sample_rate=rate)

    def deflection_rate(self, mount: str) -> Array:
        """Differentiate a mount's deflection, as the periodic cubic spline through its samples [m/s], (n_t, 3)."""
        deflection = self.response.mounts[mount].deflection
        closed = np.concatenate([deflection[:-1], deflection[:1]])  # exactly periodic, without the residual
        return np.asarray(scipy.interpolate.CubicSpline(self.response.time, closed, bc_type="periodic")(self.response.time, 1))


@dataclass(frozen=True, kw_only=True)
class HarmonicContent:
    """Harmonics of a payload's acceleration over a periodic motion."""

    order: tuple[Fraction, ...]  # multiples of the base's frequency, fractions for subharmonics, (n,)
    frequency: Array  # [Hz], (n,)
    amplitude: Array  # [m/s^2], (n,)
    phase: Array  # of a cosine at phase 0 of the base's sine [rad], (n,)

    @property
    def names(self) -> tuple[str, ...]:
        """Name of each harmonic."""
        names = []
        for order in self.order:
            if order in (0, 1):
                names.append("fundamental" if order else "mean")
            elif order.denominator == 1:
                names.append(f"superharmonic {order.numerator}")
            else:
                names.append(f"{'sub' if order < 1 else 'ultrasub'}harmonic {order.numerator}/{order.denominator}")
        return tuple(names)

    def of(self, order: int | Fraction) -> float:
        """Look up the amplitude of one order [m/s^2]; 0 if it is above the highest."""
        wanted = Fraction(order)
        return float(self.amplitude[self.order.index(wanted)]) if wanted in self.order else 0.0


def harmonic_content(
    orbit: PeriodicOrbit, *, payload: str, direction: str | tuple[float, float, float] | None = None, highest: int = 20
) -> HarmonicContent:
    """Compute the harmonics of a payload's acceleration along a direction, by default the base's, up to a highest order.

    Raises:
        ValueError: the payload is not known.
    """
    one_of("payload", payload, orbit.response.bodies)
    along = unit_vector(orbit.direction if direction is None else checked_direction(direction))
    acceleration = orbit.response.bodies[payload].acceleration[:-1] @ along
    spectrum = np.fft.rfft(acceleration) / acceleration.size
    kept = min(highest * orbit.periods + 1, spectrum.size)
    amplitude = np.abs(spectrum[:kept]) * np.where(np.arange(kept) == 0, 1.0, 2.0)
    order = tuple(Fraction(number, orbit.periods) for number in range(kept))
    frequency = np.array([float(o) * orbit.frequency for o in order])
    return HarmonicContent(order=order, frequency=frequency, amplitude=amplitude, phase=np.angle(spectrum[:kept]))


# Steps per period of the base for an error of 1e-4 of accelerations and deflections: measured on one mass from a seventh of
# its resonance to twice it, superharmonic resonances included, and on a floor. The kinks at reversals leave order 2.
STEPS = 128
NATURAL = 32  # steps per period of the system's fastest motion: between reversals RK4 has its order 4
REFERENCE = 1e-4  # accuracy for which STEPS and NATURAL hold
STABLE = 0.9  # largest step over the stability limit
# Largest decay of a hysteretic state near its bound over a step: beyond 2.785 RK4 makes it grow, two coupled ones sooner.
SETTLED = 2.0
SAME_RATE = 0.1  # relative change of the largest decay rate below which the steps are not changed
# Periods that are simulated before Newton's method starts, and more of them each time it fails.
SETTLING = (20, 60, 240)
# Factors on the number of steps if that fails: where a reversal falls on a step, the motion may alternate between two.
FINER = (1.5, 2.0)
ITERATIONS = 20  # Newton iterations of one attempt: four times what a smooth start takes
# Unknowns from which on the variational equation is cheaper than a copy of the system for each: one body free to move and
# turn has 12 without its mounts' states.
MANY = 13
WIDTHS = 4  # iterations of the width of smoothed laws, each set by the motion that was found with the last width
SAME_WIDTH = 0.01  # relative change of that width that is negligible: the motion depends on its square


class Steps:
    """Choice of the number of steps in a period of the base, for a system and an accuracy."""

    def __init__(self, system: System, accuracy: float) -> None:
        self.finer = 1.0  # factor on the number of steps for the accuracy
        self._wanted = math.sqrt(REFERENCE / accuracy)
        self._highest = float(np.abs(eigenvalues(system).imag).max(initial=0.0)) / (2.0 * math.pi)
        self._longest = STABLE * stable_step(system)
        self.decay = 0.0  # largest rate at which a hysteretic state of the motion goes back to its bound [1/s]

    def per_period(self, frequency: float) -> int:
        """Choose the number of steps in a period of a frequency [Hz]; BudgetError if so many take too long.

        It is even: with a law without an elastic part only the symmetry of the two half periods keeps the mass from drifting,
        and an odd number would break it.
        """
        wanted = self.finer * self._wanted * max(STEPS, NATURAL * self._highest / frequency)
        steps = max(wanted, max(1.0 / self._longest, self.decay / SETTLED) / frequency)
        require_time(f"a period of {frequency:.4g} Hz", steps, "Take a higher frequency or a larger `accuracy`.")
        return 2 * math.ceil(steps / 2.0)


class OrbitSearch:
    """Search for periodic motions of a system: its unknowns, steps, flow and variational equation."""

    def __init__(
        self, system: System, *, direction: Direction, history: History, accuracy: float, smoothing: float | None = None
    ) -> None:
        self.system, self._steps = system, Steps(system, accuracy)
        self.coordinates = Coordinates(system, direction=direction, history=history)
        self.smoothing = None if smoothing is None else positive("smoothing", smoothing)
        stepped = system if smoothing is None else smoothed(system, 1.0)  # the width follows the motion, see `adapt`
        self.flow = flow_of(self.coordinates, stepped)
        self.scaled = ScaledStates(stepped).serve  # whether derivatives and multipliers are from the variational equation
        self._yield_rates = yield_rates(system, steep=not isinstance(self.flow, KernelFlow) or smoothing is not None)
        self.variational = variational_of(self.flow) if self.scaled or self.coordinates.size >= MANY else None

    def adapt(self, motion: Shot) -> bool:
        """Adapt the step to the motion's hysteretic decay rate, and the width of smoothed laws to its velocity.

        Returns whether either changed much.
        """
        before, steps = self._steps.decay, motion.track.drive
        decay = float((self._yield_rates * deflection_rates(self.system, motion.track)).max(initial=0.0))
        changed = False
        if np.isfinite(decay) and abs(decay - before) > SAME_RATE * decay:
            self._steps.decay = decay
            adapted = self.drive(steps.frequency, steps.acceleration, steps.periods).steps
            changed = abs(adapted - steps.steps) > SAME_RATE * steps.steps
        if self.smoothing is None:
            return changed
        width, wanted = self.flow.width, self.smoothing * ranges(self.system, motion.track).rate
        self.flow.smooth(wanted)
        return changed or abs(wanted - width) > SAME_WIDTH * wanted

    def derivative(self, flow: Flow, at: Shot) -> Array:
        """Compute the monodromy matrix for Newton's method: derivatives of a motion's scaled end by its start, (n_x, n_x)."""
        phi = self.variational.matrix(at) if self.scaled and self.variational is not None else None
        return monodromy(flow, at) if phi is None else phi

    def require_budget(self, frequency: float, periods: int, points: float) -> None:
        """Raise BudgetError if `points` motions at a frequency [Hz] take too long, or a single motion too much memory."""
        steps = float(periods) * self._steps.per_period(frequency)
        remedy = "Take fewer `periods`, a larger `largest_step` or `accuracy`, or a narrower range."
        require_time(f"following {points:.4g} periodic motions of {steps:.4g} steps", points * steps, remedy)
        values = self.system.model.nsensordata + self.coordinates.size
        require_memory(f"one of these periodic motions, {steps:.4g} steps,", 8.0 * values * steps, remedy)

    def drive(self, frequency: float, acceleration: float, periods: int = 1) -> Drive:
        steps = periods * self._steps.per_period(frequency)
        return Drive(frequency=frequency, acceleration=acceleration, periods=periods, steps=steps)

    def find(
        self, frequency: float, acceleration: float, periods: int, *, guess: State | None, tolerance: float
    ) -> PeriodicOrbit:
        """Find the periodic motion, from a guess or from the equilibrium, after longer and longer transients."""
        carried = self.coordinates.carried(frequency, acceleration)
        x = self.coordinates.rest() if guess is None else self.coordinates.from_state(guess.values, carried)
        settled, best = 0, math.inf
        plain = [(self._steps.finer, more) for more in ((0, *SETTLING) if guess is not None else SETTLING)]
        for finer, more in plain + [(factor * self._steps.finer, more) for factor in FINER for more in SETTLING[:2]]:
            self._steps.finer = finer
            drive = self.drive(frequency, acceleration, periods)
            if more:
                x, settled = self.settled(x, drive, more), settled + more
            motion = shot(self.flow, x, drive)
            for _ in range(WIDTHS):  # laws are smoothed over the motion's own velocity
                changed = self.adapt(motion)
                drive = self.drive(frequency, acceleration, periods)
                motion = self.closed(shot(self.flow, motion.x, drive) if changed else motion, tolerance)
                if not changed:
                    break
            best = min(best, motion.residual)
            if motion.closes(max(tolerance, ACCEPTED)):
                return self.judged(motion, tolerance, f" after {settled} periods of settling" if settled else "")
        raise ConvergenceError(
            f"no motion of period {periods} / ({frequency:.6g} Hz) was found at {acceleration:.4g} m/s^2: the residual stays "
            f"at {best:.2g} (`tolerance` {tolerance:.2g}) after Newton's method from {'the guess and from ' if guess else ''}"
            f"{', '.join(str(n) for n in np.cumsum(SETTLING))} periods of settling, and with finer steps. The motion may not "
            "be periodic there."
        )

    def closed(self, start: Shot, tolerance: float) -> Shot:
        return close(self.flow, start, tolerance=tolerance, iterations=ITERATIONS, derivative=self.derivative)

    def settled(self, x: Array, drive: Drive, number: int) -> Array:
        """Integrate the unknowns x over a number of the base's periods; a diverging motion raises the error of a simulation."""
        long = replace(drive, periods=number, steps=number * (drive.steps // drive.periods))
        end = self.flow.ends(x[np.newaxis], long)[0]
        if np.isfinite(end).all():
            return end
        try:  # a simulation over the same steps names the reason
            simulate(
                self.system, long.sine(self.coordinates.direction), duration=long.duration, initial=self._state(x, long),
                timestep=long.duration / long.steps, sample_rate=long.steps / long.duration,
            )  # fmt: skip
        except SimulationError as error:
            raise SimulationError(f"{_level(long)} the motion is too large: {error} Lower the acceleration.") from None
        raise SimulationError(f"the motion at {long.frequency:.6g} Hz grew without bound.")

    def _state(self, x: Array, drive: Drive) -> State:
        carried = self.coordinates.carried(drive.frequency, drive.acceleration)
        return State(values=self.coordinates.to_state(x, carried), time=0.0)

    def judged(self, motion: Shot, tolerance: float, settling: str) -> PeriodicOrbit:
        """Make the result of a converged motion, its stability included; SimulationError beyond a rated travel."""
        drive = motion.track.drive
        over = travel_exceeded(self.system, motion.track)
        if over:
            raise SimulationError(f"{_level(drive)} {over}. Lower the acceleration.")
        phi = self.variational.matrix(motion) if self.scaled and self.variational is not None else None
        floquet = stability(self.flow, motion, wide_monodromy(self.flow, motion) if phi is None else phi)
        short = f", not the `tolerance` of {tolerance:.1g}: rounding stopped it there" * (motion.residual > tolerance)
        return PeriodicOrbit(
            system=self.system, frequency=drive.frequency, acceleration=drive.acceleration,
            direction=self.coordinates.direction, periods=drive.periods, smoothing_width=self.flow.width,
            state=self._state(motion.x, drive), steps=drive.steps,
            floquet_multipliers=floquet.multipliers, neutral=floquet.neutral, stable=floquet.stable, residual=motion.residual,
            iterations=motion.iterations, model_steps=self.flow.steps,
            message=f"residual {motion.residual:.1e} after {motion.iterations} Newton iterations{settling}{short}",
        )  # fmt: skip


def _level(drive: Drive) -> str:
    return f"at {drive.frequency:.5g} Hz and {abs(drive.acceleration):.4g} m/s^2"
