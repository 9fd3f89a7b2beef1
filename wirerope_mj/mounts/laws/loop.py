"""A force-deflection loop and its measures."""

from dataclasses import dataclass, field
from typing import NamedTuple

import numpy as np

from wirerope_mj.foundation.arrays import Array, ArrayLike
from wirerope_mj.foundation.summary import Summarised, span

_DEGREE = 3  # a parabola bends too little where a loop saturates in a tenth of its range, a quartic rings with noise
_FEWEST = _DEGREE + 4  # samples: three more than coefficients, else a lucky residual looks like a good fit
_GROWTH = 1.25  # from one span to the next
_WIDEST = 0.5  # share of the curve: beyond its middle it says nothing of its beginning
_ABOVE_NOISE = 15.0  # a span of 15 standard deviations of the deflection's noise flattens a straight line by 5 %
_SHORTER = 0.7  # of the best span: what a cubic misses falls with the third power of it, scatter rises by its inverse


def tangent_at_start(deflection: Array, force: Array) -> float:
    """Return dF/dx [N/m] at the first sample of a branch, deflections [m] and forces [N], (n,), its turning point first.

    It is NaN where the branch has fewer than 7 samples or leads nowhere. A cubic in the distance from the first sample is
    fitted by least squares to the first 7, 9, 12, ... samples, up to half of the branch. The span with the smallest standard
    error of the slope is where misfit and noise are about even; 0.7 of it is taken, for the misfit is all of one sign. Exact
    samples are thus judged on the shortest span, where a cubic bends as the curve does, noisy ones on a longer one. Spans
    within the deflection's own noise, estimated from its third differences, are left out: there the fit would see no
    deflection at all.

    With noise of 0.1 % of the amplitudes and 200 samples a cycle the error is about 1 % for an ordinary loop, 3 % for one
    that hardens or turns sharply, and 5 % for one that saturates within a tenth of its amplitude.
    """
    depth = np.abs(deflection - deflection[0])
    if deflection.size < _FEWEST or depth.max() == 0.0:
        return float("nan")
    # The mean square of third differences of white noise is 1 + 9 + 9 + 1 = 20 times its variance.
    noise = float(np.sqrt(np.mean(np.diff(deflection, 3) ** 2) / 20.0))
    fits: list[tuple[float, float, float]] = []  # standard error of the slope, the slope [N/m], the span
    count = _FEWEST
    while count <= deflection.size:
        span = float(depth[:count].max())
        if fits and span > _WIDEST * depth.max():
            break
        if span > _ABOVE_NOISE * noise:
            rise, powers = force[:count] - force[0], np.vander(depth[:count] / span, _DEGREE + 1, increasing=True)
            coefficients, _, rank, _ = np.linalg.lstsq(powers, rise, rcond=None)
            error, slope = np.inf, float("nan")  # of samples that stand still
            if rank > _DEGREE:
                residual = rise - powers @ coefficients
                variance = residual @ residual / (count - _DEGREE - 1)
                error = float(np.sqrt(variance * np.linalg.inv(powers.T @ powers)[1, 1]) / span)
                slope = float(coefficients[1] / span)
            fits.append((error, slope, span))
        count = int(np.ceil(_GROWTH * count))
    if not fits:
        return float("nan")
    longest = max(_SHORTER * min(fits)[2], fits[0][2])
    slope = [slope for _, slope, span in fits if span <= longest][-1]
    return slope if deflection[-1] > deflection[0] else -slope


class ReversalTangents(NamedTuple):
    """One slope for each turning point of a loop [N/m]."""

    after_largest: float
    after_smallest: float


@dataclass(frozen=True, kw_only=True, repr=False)
class Loop(Summarised):
    """Force over deflection along a path, or over one cycle of a cyclic test."""

    deflection: Array  #: path [m], (n_t,)
    force: Array  #: restoring force [N], (n_t,)
    hysteretic_state: Array  #: z [N], (n_t,); zero for a law without one, NaN for a measured loop, whose z nobody knows
    #: work done on the isolator since the first sample [J], (n_t,), integrated along the law's own segments where the loop
    #: comes from a law
    work: Array
    #: cycles run before this one was kept, itself included; 0 for a plain trace and where it is not known
    cycles: int = 0
    #: distance between the last force and the first over the force range; NaN for a plain trace
    closure: float = float("nan")
    #: the law's internal states, (n_t, n_states); no columns where they are not known
    internal_states: Array = field(default_factory=lambda: np.zeros((0, 0)), repr=False)

    def _summary(self) -> tuple[str, dict[str, str]]:
        return f"Loop of {self.deflection.size} samples", {
            "deflection": span((self.deflection.min(), self.deflection.max()), "m"),
            "force": span((self.force.min(), self.force.max()), "N"),
            "secant stiffness": f"{1e-3 * self.secant_stiffness:.4g} kN/m",
            "dissipated energy": f"{self.dissipated_energy:.4g} J",
            "damping ratio": f"{100.0 * self.damping_ratio:.3g} %",
        }

    @classmethod
    def from_samples(cls, deflection: ArrayLike, force: ArrayLike, *, cycles: int = 0) -> "Loop":
        """Return the loop of a measured cycle: its work is summed by the trapezoid rule, its z is not known (NaN).

        Chords cut corners off: the area of N samples uniform in time is low by about (2 pi / N)^2 / 6 of itself, 2e-4 at
        N = 200.

        Args:
            deflection: one cycle [m], (n_t,), its first sample repeated or measured again at its end.
            force: restoring force [N], (n_t,).
            cycles: cycles run before this one was kept, if that is known.
        """
        x, f = np.asarray(deflection, dtype=np.float64), np.asarray(force, dtype=np.float64)
        if x.ndim != 1 or x.shape != f.shape or x.size < 2 or not (np.isfinite(x).all() and np.isfinite(f).all()):
            raise ValueError(
                "`deflection` and `force` must be finite series of the same length, 2 samples at least, "
                f"got shapes {x.shape} and {f.shape}."
            )
        work = np.concatenate([[0.0], np.cumsum(np.diff(x) * (f[1:] + f[:-1]) / 2.0)])
        unknown = np.full(x.size, np.nan)
        return cls(deflection=x, force=f, hysteretic_state=unknown, work=work, cycles=cycles, closure=closure_of(f))

    @property
    def dissipated_energy(self) -> float:
        """Work done on the isolator over the whole path [J]: the loop's area if the path is a closed cycle."""
        return float(self.work[-1])

    @property
    def amplitude(self) -> float:
        """Half the range of the deflection [m]."""
        return float(np.ptp(self.deflection)) / 2.0

    @property
    def operating_point(self) -> float:
        """Mean of the largest and the smallest deflection [m]."""
        return float(self.deflection.max() + self.deflection.min()) / 2.0

    @property
    def secant_stiffness(self) -> float:
        """K = [F(x_max) - F(x_min)] / (x_max - x_min) [N/m]."""
        top, bottom = int(np.argmax(self.deflection)), int(np.argmin(self.deflection))
        return float((self.force[top] - self.force[bottom]) / (self.deflection[top] - self.deflection[bottom]))

    @property
    def damping_ratio(self) -> float:
        """Equivalent viscous damping ratio zeta = W / (2 pi K A^2) [-] of a closed cycle, W its area, K its secant stiffness.

        It is the ratio of the linear spring and damper that dissipate the same in a sine of amplitude A at the resonance
        sqrt(K/m). Infinite for a pure damper, K = 0; NaN without any force; without meaning where K < 0.
        """
        stored = np.float64(2.0 * np.pi * self.secant_stiffness * self.amplitude**2)
        with np.errstate(divide="ignore", invalid="ignore"):
            return float(np.float64(self.dissipated_energy) / stored)

    @property
    def tangents_at_reversal(self) -> ReversalTangents:
        """Slopes dF/dx just after the turning points [N/m]: on the way down from the largest, up from the smallest.

        t = lim dF/dx for x -> x_turn on the branch that leaves it, estimated by `tangent_at_start`. For the Bouc-Wen law
        t = k + alpha + (beta - gamma) |z|^n (thesis, table 3.2). NaN where the path ends at the turning point. A
        rate-dependent force turns round smoothly: its tangent there is vertical, and what comes back is no stiffness.
        """
        down, up = self.branch(rising=False), self.branch(rising=True)
        return ReversalTangents(tangent_at_start(*down), tangent_at_start(*up))

    @property
    def slope_jumps_at_reversal(self) -> ReversalTangents:
        """Slopes after the turning points minus those before them [N/m]: 2 beta |z|^n for Bouc-Wen (thesis, 3.2.1)."""
        (x_down, f_down), (x_up, f_up) = self.branch(rising=False), self.branch(rising=True)
        after = self.tangents_at_reversal
        before_largest = tangent_at_start(x_up[::-1], f_up[::-1])
        before_smallest = tangent_at_start(x_down[::-1], f_down[::-1])
        return ReversalTangents(after.after_largest - before_largest, after.after_smallest - before_smallest)

    def branch(self, *, rising: bool) -> tuple[Array, Array]:
        """Return deflection [m] and force [N], (n,) each, on the way from one extreme deflection to the other.

        A path that ends near where it began is a cycle and goes on from its last sample to its first; any other ends there.
        Rising is from the smallest to the largest deflection, loading in tension.
        """
        x, f = self.deflection, self.force
        start, stop = int(np.argmin(x)), int(np.argmax(x))
        if not rising:
            start, stop = stop, start
        if start <= stop:
            return x[start : stop + 1], f[start : stop + 1]
        # Steps of a cycle's deflection at its two ends are alike; a path that leads away leaves a wider gap.
        cyclic = abs(x[-1] - x[0]) <= 2.0 * np.abs(np.diff(x)).max()
        again = 1 if x[-1] == x[0] else 0  # the sample that ends the cycle is the one that begins it
        rest = slice(again, stop + 1) if cyclic else slice(0, 0)
        return np.concatenate([x[start:], x[rest]]), np.concatenate([f[start:], f[rest]])


def closure_of(force: Array) -> float:
    """Return the distance between the last force and the first over the force range; 0 if the force never changes."""
    extent = float(np.ptp(force))
    return float(abs(force[-1] - force[0])) / extent if extent > 0.0 else 0.0
