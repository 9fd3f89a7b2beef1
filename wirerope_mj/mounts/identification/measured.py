"""Measured loops prepared for a fit: the deflection is monotone between the two turning points."""

from collections.abc import Sequence
from dataclasses import dataclass, field, fields, replace
from pathlib import Path
from typing import Self

import numpy as np
import scipy

from wirerope_mj.foundation.arguments import one_of
from wirerope_mj.foundation.arrays import Array
from wirerope_mj.mounts.identification.families import Scales
from wirerope_mj.mounts.laws import BoucWen, Law, Loop
from wirerope_mj.mounts.laws.plane import asymmetry_of, elastic_of
from wirerope_mj.mounts.laws.steady import follow_force, settle
from wirerope_mj.mounts.test_rig.passive import require_falling, require_unclipped
from wirerope_mj.mounts.test_rig.reading import require_likely
from wirerope_mj.mounts.test_rig.turning import RecordedLoop, mean_of_cycles, rms_noise

STEADY = 1e-12  # Change of the hysteretic force over a cycle, relative to the force range, at which it is steady
# Standard deviations of the noise by which the two ends of a cycle within a stop's gap may differ: four of a difference.
ENDS_NOISE = 6.0
# Fraction of the force range by which the ends of a measured cycle may differ: creep of the first cycles, and noise.
OPEN_ENDED = 0.2
_AT_END = 0.05  # of the stroke, within which a cycle begins at an end of it


@dataclass(frozen=True, kw_only=True)
class MeasuredLoop:
    """One closed measured cycle, prepared for a fit."""

    deflection: Array  # path [m], (n_t,), monotone between its turning points
    force: Array  # measured force [N], (n_t,)
    weight: float  # divisor of this loop's residual [N]
    # turning points from the unloaded device to the first of the measured cycles [m], (n,)
    history: Array = field(default_factory=lambda: np.zeros(0))
    elapsed: Array = field(default_factory=lambda: np.zeros(0))  # time since the cycle began over its period, (n_t,)
    averaged: int = 0  # cycles whose mean was measured; 0: the loop counts as steady
    period: float | None = None  # of the cycle [s]; None where the record has no time

    @property
    def amplitude(self) -> float:
        return 0.5 * float(np.ptp(self.deflection))

    def area(self, force: Array) -> float:
        """Return the area that a force encloses on the loop's path [J]."""
        return float(np.trapezoid(force, self.deflection))

    def mid_line(self, force: Array, points: int) -> Array:
        """Average a force on the way up and on the way down, at evenly spaced deflections, (points,)."""
        x = np.linspace(self.deflection.min(), self.deflection.max(), points)
        start = int(np.argmin(self.deflection))
        path, values = np.roll(self.deflection[:-1], -start), np.roll(force[:-1], -start)
        top = int(np.argmax(path))
        up = np.interp(x, path[: top + 1], values[: top + 1])
        down = np.interp(x, np.append(path[top:], path[0])[::-1], np.append(values[top:], values[0])[::-1])
        return 0.5 * (up + down)

    def thinned(self, samples: int) -> "MeasuredLoop":
        """Keep about `samples` of the loop's samples, its turning points among them."""
        x = self.deflection
        even = np.linspace(0, x.size - 1, samples).astype(int)
        kept = np.unique(np.concatenate([even, [np.argmax(x), np.argmin(x)]]))
        elapsed = self.elapsed[kept] if self.elapsed.size else self.elapsed
        return replace(self, deflection=x[kept], force=self.force[kept], elapsed=elapsed)

    def model_force(self, law: Law) -> Array:
        """Evaluate the force of a law on the loop's path [N], (n_t,); NaN where it is not finite.

        The law is led there as the device was, through the turning points before, and its cycles are averaged as the measured
        ones were. Where they are not known it is in its steady state; elements that never slip there stand as a ramp from the
        unloaded device to the operating point leaves them.
        """
        if len(law.components) > 1:  # each has states of its own
            return np.asarray(sum(self.model_force(part) for part in law.components))
        if self.averaged:
            return mean_of_cycles(self._led_forces(law), self.elapsed)
        x, parameters = self.deflection, law.kernel_parameters()
        first, second = sorted((int(np.argmax(x)), int(np.argmin(x))))
        turning = np.array([x[0], x[first], x[second], x[-1]])
        if law.n_states == 1:
            states = settle(law.kernel, parameters, turning, 1, STEADY * float(np.ptp(self.force)))
        else:  # Jenkin elements: steady after one cycle, and no start fades
            states = np.zeros(law.n_states)
            middle = 0.5 * (x[first] + x[second])
            follow_force(law.kernel, parameters, np.array([0.0, middle, *turning, *turning]), states, law.n_states)
        return follow_force(law.kernel, parameters, x, states, law.n_states)

    def law_closure(self, law: Law) -> float:
        """Compute how far a law's force ends from where it began in its last cycle after the recorded history [-].

        Over the measured force range, without the drift of the cycles' means; 0 for a loop that counts as steady.
        """
        if self.averaged < 2:
            return 0.0
        forces = self._led_forces(law)
        means = np.asarray(np.trapezoid(forces[[0, -1]], self.elapsed, axis=1))
        drift = (means[1] - means[0]) / (self.averaged - 1)
        return float(abs(forces[-1, -1] - forces[-1, 0] - drift) / np.ptp(self.force))

    def _led_forces(self, law: Law) -> Array:
        """Evaluate the force of a law in every averaged cycle, after the recorded history [N], (n_cycles, n_t)."""
        x, parameters, states = self.deflection, law.kernel_parameters(), np.zeros(law.n_states)
        follow_force(law.kernel, parameters, np.append(self.history, x[0]), states, law.n_states)
        forces = np.empty((self.averaged, x.size))
        for cycle in range(self.averaged):
            before = states.copy()
            forces[cycle:] = follow_force(law.kernel, parameters, x, states, law.n_states)
            if np.abs(states - before).max(initial=0.0) <= STEADY * float(np.ptp(self.force)):
                break
        return forces


def require_loops(loops: object, name: str = "loops") -> None:
    """Raise ValueError unless `loops` is a sequence of loops, at least one."""
    if isinstance(loops, str | Path):
        raise ValueError(f"`{name}` must be loops, got the path {str(loops)!r}; load_cycles({str(loops)!r}) reads them.")
    if isinstance(loops, Loop):
        raise ValueError(f"`{name}` must be a sequence of loops, got a single one; put it into brackets.")
    if not isinstance(loops, Sequence):
        raise ValueError(f"`{name}` must be a sequence of loops, got {loops!r}.")
    if not loops:
        raise ValueError(f"`{name}` must hold at least one closed loop.")
    for index, loop in enumerate(loops):
        if not isinstance(loop, Loop):
            raise ValueError(f"`{name}` must hold loops, got a {type(loop).__name__} at index {index}.")


def prepare(loops: Sequence[Loop], *, weights: str = "range", stop: bool = False) -> list[MeasuredLoop]:
    """Prepare closed cycles for a fit, smallest amplitude first.

    Noise of the deflection would turn every sample into a reversal; the monotone path nearest to the samples of each branch
    (isotonic regression) has none. Weights "range" divide residuals by each loop's half force range, so that small loops
    count as much as large ones, "equal" by that of the largest loop. A bare bump stop's force stands still within its gap.
    ValueError: a loop is not a full cycle, its deflection does not move, or its force is clipped.
    """
    one_of("weights", weights, ("range", "equal"))
    largest = max((0.5 * float(np.ptp(loop.force)) for loop in loops), default=0.0)
    ready = []
    for number, loop in enumerate(loops, start=1):
        x, f, name = loop.deflection, loop.force, f"loop {number}"
        if x.size < 12:
            raise ValueError(f"{name} has {x.size} samples; a loop needs 12 at least.")
        if not (np.isfinite(x).all() and np.isfinite(f).all()):
            raise ValueError(f"{name} holds numbers that are not finite.")
        if np.ptp(x) == 0.0:
            raise ValueError(f"{name}: the deflection is constant at {x[0]:.6g} m.")
        require_likely(loop.amplitude, 0.5 * float(np.ptp(f)), name, stop=stop)
        # A cycle ends where it began; its steps there are as large as anywhere.
        gap, step = abs(x[-1] - x[0]), float(np.abs(np.diff(x)).max())
        if gap > 3.0 * step:
            raise ValueError(
                f"{name} is not a full cycle: it begins at {x[0]:.6g} m and ends at {x[-1]:.6g} m, of a range of "
                f"{np.ptp(x):.6g} m."
            )
        if loop.closure > OPEN_ENDED and not (stop and loop.closure * np.ptp(f) <= ENDS_NOISE * rms_noise(f)):
            raise ValueError(
                f"{name} is not a full cycle: its force ends {loop.closure * np.ptp(f):.4g} N from where it began, "
                f"{100 * loop.closure:.0f} % of its range{half_text(loop)}. Record whole cycles, three or more of an amplitude."
            )
        require_unclipped(x, f, name, stop=stop)
        require_falling(loop, name, stop=stop)
        # Every branch between its turning points is made monotone.
        start = int(np.argmin(x))
        cyclic = np.roll(x[:-1], -start)
        top = int(np.argmax(cyclic))
        up = scipy.optimize.isotonic_regression(cyclic[: top + 1]).x
        down = scipy.optimize.isotonic_regression(np.append(cyclic[top:], cyclic[0]), increasing=False).x
        path = np.roll(np.concatenate([up, down[1:-1]]), start)
        size = 0.5 * float(np.ptp(f)) if weights == "range" else largest
        measured = MeasuredLoop(deflection=np.append(path, path[0]), force=f, weight=size or 1.0)
        if isinstance(loop, RecordedLoop):
            recorded = {name: getattr(loop, name) for name in ("history", "elapsed", "averaged", "period")}
            measured = replace(measured, **recorded)
        ready.append(measured)
    return sorted(ready, key=lambda loop: float(np.ptp(loop.deflection)))


def half_text(loop: Loop) -> str:
    """Return the clause that the deflection turns round only once, as in half a cycle, if it does so; else ""."""
    x = loop.deflection
    at_end = min(x[0] - x.min(), x.max() - x[0]) < _AT_END * np.ptp(x)
    return ", its deflection turning round only once, as in half a cycle" if loop.cycles == 1 and at_end else ""


def scales_of(loops: Sequence[MeasuredLoop]) -> Scales:
    """Return largest and least amplitude [m] of loops, and half of the largest force range [N]."""
    amplitudes = [loop.amplitude for loop in loops]
    force = max(float(np.ptp(loop.force)) / 2.0 for loop in loops)
    return Scales(deflection=max(amplitudes), least=min(amplitudes), force=force)


_KEPT = 48  # Shapes that a loop keeps: those of one Jacobian and of the steps about it


@dataclass(frozen=True, kw_only=True)
class ScaleLoop(MeasuredLoop):
    """Measured loop that stores the hysteretic force over its bound, z / z_max, of scales: x_y, sigma, n alone shape it.

    Most coordinates of a law of several scales leave these of most scales as they are, and following them is what takes time.
    """

    _shapes: dict[tuple[str, ...], Array] = field(default_factory=dict, init=False, repr=False, compare=False)

    @classmethod
    def of(cls, loop: MeasuredLoop) -> Self:
        return cls(**{item.name: getattr(loop, item.name) for item in fields(MeasuredLoop)})

    def model_force(self, law: Law) -> Array:
        """Evaluate the force of a law of one scale or several on the loop's path [N], (n_t,), by stored shapes."""
        if len(law.components) == 1:
            return super().model_force(law)
        x, z, elastic, asymmetry = self.deflection, np.zeros(1), np.zeros(1), 0.0
        for scale in law.components:
            form = scale.normal_form
            assert form is not None
            k1, k2, k3 = elastic_of(scale)
            z = z + form.z_max * self.shape(form.x_y, form.sigma, form.n)
            elastic = elastic + x * (k1 + x * (np.sign(x) * k2 + k3 * x))
            asymmetry = asymmetry_of(scale)
        return self.as_measured(np.exp(asymmetry * x) * (z + elastic))

    def as_measured(self, forces: Array) -> Array:
        """Average the forces of cycles, (n_cycles, n_t), as the measured ones were, (n_t,); a steady loop has only one."""
        return mean_of_cycles(forces, self.elapsed) if self.averaged else forces[0]

    def shape(self, x_y: float, sigma: float, n: float) -> Array:
        """Evaluate z / z_max of a scale of friction in every averaged cycle, or in the steady one, (n_cycles, n_t)."""
        key = tuple(f"{value:.12e}" for value in (x_y, sigma, n))  # a millionth of the step of a difference
        if key not in self._shapes:
            size = 0.5 * float(np.ptp(self.force))  # what counts as steady is a fraction of it
            scale = BoucWen.from_normalised(z_max=size, x_y=x_y, sigma=sigma, n=n)
            forces = self._led_forces(scale) if self.averaged else super().model_force(scale)[None]
            while len(self._shapes) >= _KEPT:
                del self._shapes[next(iter(self._shapes))]
            self._shapes[key] = forces / size
        return self._shapes[key]
