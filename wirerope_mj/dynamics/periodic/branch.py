"""A branch of periodic motions, the result of `follow_branch`, and the resonances of one or of several levels."""

from collections.abc import Sequence
from dataclasses import dataclass, field
from typing import Literal

import numpy as np

from wirerope_mj.dynamics.periodic.motion import Coordinates
from wirerope_mj.dynamics.periodic.orbit import PeriodicOrbit
from wirerope_mj.engine.statics import History
from wirerope_mj.engine.system import System
from wirerope_mj.foundation.arrays import Array, Booleans, ComplexArray, Integers
from wirerope_mj.foundation.directions import Direction, direction_text
from wirerope_mj.foundation.state import State
from wirerope_mj.foundation.summary import Summarised, quantity, span

# Relative difference of two amplitudes above which a sweep jumps from one to the other.
ALIKE = 0.01
Parameter = Literal["frequency", "acceleration"]
Kind = Literal["fold", "period doubling", "Neimark-Sacker", "symmetry breaking"]
PROMINENT = 1.02  # least ratio of a resonance peak to the higher of its two adjacent valleys


@dataclass(frozen=True, kw_only=True)
class Bifurcation:
    """A point at which a branch turns back or its stability changes."""

    # "fold" (the branch turns back; a multiplier passes 1), "period doubling" (one passes -1), "Neimark-Sacker" (a pair leaves
    # the unit circle), "symmetry breaking" (one passes 1 without a fold: another branch crosses this one)
    kind: Kind
    frequency: float  # of the base [Hz]
    acceleration: float  # of the base [m/s^2]
    amplitude: float  # of the payload [m/s^2]
    index: int  # of its point in the branch
    multiplier: complex  # Floquet multiplier that passes the unit circle
    # before, after: number of multipliers outside the unit circle on either side
    before: int
    after: int

    @property
    def transmissibility(self) -> float:
        """Amplitude over the base's acceleration [-]."""
        return self.amplitude / abs(self.acceleration)

    @property
    def description(self) -> str:
        """Description in a line: kind, frequency, acceleration, and whether stability is lost, regained or kept."""
        if self.after == self.before:
            course = "stays lost" if self.after else "is kept"
        else:
            course = "is lost" if self.after > self.before else "is regained"
        return f"{self.kind} at {self.frequency:.5g} Hz, {self.acceleration:.4g} m/s^2: stability {course}"


@dataclass(frozen=True, kw_only=True)
class SideBranch:
    """A segment of a branch over which two motions of nearly equal amplitude exist."""

    # start, stop: frequencies [Hz] or accelerations [m/s^2] at its ends, whichever was followed
    start: float
    stop: float
    difference: float  # relative difference of the payload's amplitudes


@dataclass(frozen=True, kw_only=True)
class Jump:
    """A fold at which a slow sweep leaves a branch, and the motion on which it lands."""

    parameter: float  # frequency [Hz] or acceleration [m/s^2] of the fold, whichever was followed
    rising: bool  # whether a sweep with rising parameter jumps there; one with falling parameter jumps at the other folds
    amplitude: float  # at the fold [m/s^2]
    # amplitude of the stable motion of the branch at the same parameter [m/s^2]; NaN without such a motion
    landing: float


@dataclass(frozen=True, kw_only=True, repr=False)
class Branch(Summarised):
    """Periodic motions of a system along the frequency or the level of its base's sine, in the order of continuation."""

    system: System = field(repr=False)
    parameter: Parameter  #: followed parameter, "frequency" or "acceleration"
    frequency: Array  #: of the base [Hz], (n,)
    acceleration: Array  #: amplitude of the base's acceleration [m/s^2], (n,)
    #: largest absolute acceleration of the payload along `response_direction` over a period [m/s^2], (n,)
    amplitude: Array
    #: whether no multiplier lies outside the unit circle, or the system settles on the motion within the accuracy, (n,)
    stable: Booleans
    #: multipliers by falling modulus without the neutral ones, padded with NaN, (n, m)
    floquet_multipliers: ComplexArray = field(repr=False)
    neutral: Integers = field(repr=False)  #: number of neutral directions, (n,)
    #: folds and changes of stability in the order of the branch, without those of side branches
    bifurcations: tuple[Bifurcation, ...]
    payload: str  #: body whose acceleration is the amplitude
    direction: Direction  #: along which the base moves
    response_direction: Direction  #: along which the amplitude is taken
    periods: int  #: of the base after which the motions repeat themselves
    #: velocity over which the laws were smoothed [m/s], 0 for the laws as they are, (n,)
    smoothing_width: Array = field(repr=False)
    unknowns: Array = field(repr=False)  #: state at phase 0 relative to the equilibrium carried along, (n, n_x)
    steps: Integers = field(repr=False)  #: model steps of each motion, (n,)
    #: component of the parameter in the branch's unit tangent, positive where it rises, (n,)
    tangents: Array = field(repr=False)
    residual: Array = field(repr=False)  #: largest difference of end and start of each motion, relative to its ranges, (n,)
    history: History  #: equilibrium about which the motions are
    complete: bool  #: whether `stop` was reached
    #: intervals of the parameter over which the branch could not be followed, and behind which it was taken up again
    gaps: tuple[tuple[float, float], ...]
    model_steps: int  #: model steps of all integrations
    message: str  #: why it ended
    #: stretches with two motions within 1 % of each other, past which the branch goes on
    side_branches: tuple[SideBranch, ...] = ()
    beyond_travel: str = ""  #: mount and travel where it ended at a rated travel, else empty

    def _summary(self) -> tuple[str, dict[str, str]]:
        unit = "Hz" if self.parameter == "frequency" else "m/s^2"
        return "Branch", {
            self.parameter: f"{span((self.followed[0], self.followed[-1]), unit)}, {self.frequency.size} motions",
            f"largest {direction_text(self.response_direction)} of {self.payload}": (
                f"{quantity(self.amplitude[self.peak], 'm/s^2')} at {self.frequency[self.peak]:.4g} Hz"
            ),
            "stable": f"{int(self.stable.sum())} of {self.stable.size}",
            "folds": ", ".join(f"{fold.frequency:.4g} Hz" for fold in self.folds) or "none",
            "message": self.message,
        }

    @property
    def followed(self) -> Array:
        """Values of the parameter that was followed, (n,)."""
        return self.frequency if self.parameter == "frequency" else self.acceleration

    @property
    def transmissibility(self) -> Array:
        """Amplitude over the base's acceleration, (n,)."""
        return np.asarray(self.amplitude / np.abs(self.acceleration))

    @property
    def folds(self) -> tuple[Bifurcation, ...]:
        """Points where the branch turns back."""
        return tuple(b for b in self.bifurcations if b.kind == "fold")

    @property
    def jumps(self) -> tuple[Jump, ...]:
        """Jumps of slow sweeps: folds whose amplitude differs by more than 1 % from the motion's where they land."""
        jumps = (self._jump(fold) for fold in self.folds)
        return tuple(jump for jump in jumps if not abs(jump.landing / jump.amplitude - 1.0) < ALIKE)

    @property
    def peak(self) -> int:
        """Index of the largest amplitude."""
        return int(np.argmax(self.amplitude))

    def orbit(self, index: int) -> PeriodicOrbit:
        """Compute the periodic motion at a point of the branch anew, with its time history."""
        index = range(self.frequency.size)[index]
        coordinates = Coordinates(self.system, direction=self.direction, history=self.history)
        carried = coordinates.carried(float(self.frequency[index]), float(self.acceleration[index]))
        multipliers = self.floquet_multipliers[index]
        return PeriodicOrbit(
            system=self.system, frequency=float(self.frequency[index]), acceleration=float(self.acceleration[index]),
            direction=self.direction, periods=self.periods, smoothing_width=float(self.smoothing_width[index]),
            state=State(values=coordinates.to_state(self.unknowns[index], carried), time=0.0), steps=int(self.steps[index]),
            floquet_multipliers=multipliers[~np.isnan(multipliers)], neutral=int(self.neutral[index]),
            stable=bool(self.stable[index]), residual=float(self.residual[index]), iterations=0, model_steps=0,
            message=f"point {index} of a branch",
        )  # fmt: skip

    def _jump(self, fold: Bifurcation) -> Jump:
        """Describe the jump at a fold: its direction, and the amplitude of the stable motion where a sweep lands."""
        p, a = self.followed, self.amplitude
        value = float(p[fold.index])
        rising = bool(self.tangents[max(fold.index - 1, 0)] > 0.0)
        folds = [0, *(fold.index for fold in self.folds), p.size - 1]
        number = folds.index(fold.index, 1)
        landings = []
        for i in range(p.size - 1):
            sheet = folds[number - 1] <= i < folds[number + 1]  # either stretch that ends at this fold
            crosses = (p[i] - value) * (p[i + 1] - value) <= 0.0
            if sheet or not (crosses and self.stable[i] and self.stable[i + 1]):
                continue
            fraction = (value - p[i]) / (p[i + 1] - p[i])
            landings.append(float(a[i] + fraction * (a[i + 1] - a[i])))
        landing = min(landings, key=lambda x: abs(x - fold.amplitude)) if landings else float("nan")
        return Jump(parameter=value, rising=rising, amplitude=fold.amplitude, landing=landing)


@dataclass(frozen=True, kw_only=True)
class Resonance:
    """A peak of a branch over the frequency."""

    index: int  # of the point with the largest amplitude
    frequency: float  # of the peak [Hz], by the parabola through three points
    amplitude: float  # of the payload [m/s^2]
    ratio: float  # frequency of the highest peak over this one's: near n for the superharmonic resonance of order n


@dataclass(frozen=True, kw_only=True)
class Backbone:
    """Highest peaks of branches at several levels: acceleration of the base, frequency [Hz] and amplitude, (n,) each."""

    acceleration: Array
    frequency: Array
    amplitude: Array


def resonances(branch: Branch) -> tuple[Resonance, ...]:
    """Find the peaks of a branch that was followed in frequency, in its order; superharmonic peaks included.

    Raises:
        ValueError: the branch was followed in acceleration.
    """
    if branch.parameter != "frequency":
        raise ValueError("`branch` must be followed in frequency to have resonances.")
    a, peaks = branch.amplitude, []
    for i in range(1, a.size - 1):
        if not a[i - 1] < a[i] >= a[i + 1]:
            continue
        valleys = []  # on both sides, before the curve rises above this point again
        for side in (a[i::-1], a[i:]):
            higher = np.flatnonzero(side > a[i])
            valleys.append(float(side[: higher[0] if higher.size else side.size].min()))
        if a[i] > PROMINENT * max(valleys):
            peaks.append((i, *_parabola_vertex(branch, i)))
    _, main, _ = max(peaks, key=lambda peak: peak[-1], default=(0, np.nan, np.nan))  # by amplitude
    return tuple(
        Resonance(index=i, frequency=frequency, amplitude=amplitude, ratio=main / frequency)
        for i, frequency, amplitude in peaks
    )


def backbone(branches: Sequence[Branch]) -> Backbone:
    """Collect the highest peaks of branches that were followed in frequency at several levels, by rising level.

    Raises:
        ValueError: a branch has no peak between its ends, or was followed in acceleration.
    """
    if not branches:
        raise ValueError("`branches` must hold at least one branch, got none.")
    rows = []
    for branch in branches:
        peaks = resonances(branch)
        if not peaks:
            raise ValueError(
                f"the branch at {branch.acceleration[0]:.4g} m/s^2 has no peak between {branch.frequency[0]:.4g} and "
                f"{branch.frequency[-1]:.4g} Hz; follow it further."
            )
        peak = max(peaks, key=lambda p: p.amplitude)
        rows.append((float(branch.acceleration[0]), peak.frequency, peak.amplitude))
    acceleration, frequency, amplitude = np.array(sorted(rows)).T
    return Backbone(acceleration=acceleration, frequency=frequency, amplitude=amplitude)


def _parabola_vertex(branch: Branch, i: int) -> tuple[float, float]:
    """Fit frequency and amplitude of the parabola's vertex through three points; the point itself at a fold."""
    f, a = np.log(branch.frequency[i - 1 : i + 2]), branch.amplitude[i - 1 : i + 2]
    if not f[0] < f[1] < f[2] and not f[0] > f[1] > f[2]:
        return float(branch.frequency[i]), float(a[1])
    left, right = (a[1] - a[0]) / (f[1] - f[0]), (a[2] - a[1]) / (f[2] - f[1])
    curvature = (right - left) / (f[2] - f[0])
    if curvature == 0.0:
        return float(branch.frequency[i]), float(a[1])
    top = float(np.clip(0.5 * (f[0] + f[1] - left / curvature), min(f[0], f[2]), max(f[0], f[2])))
    return float(np.exp(top)), float(a[0] + (top - f[0]) * (left + curvature * (top - f[1])))
