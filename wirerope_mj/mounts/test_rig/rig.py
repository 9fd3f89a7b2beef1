"""The rig: steady loops of a law under a sine about an operating point, their samples as recorded, and measures of several."""

import math
from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np
import scipy

from wirerope_mj.foundation.arguments import finite, integer, not_negative, positive
from wirerope_mj.foundation.arrays import Array, ArrayLike
from wirerope_mj.foundation.budget import require_memory, require_time
from wirerope_mj.foundation.errors import ConvergenceError
from wirerope_mj.mounts.laws import Law, Loop
from wirerope_mj.mounts.laws.loop import closure_of
from wirerope_mj.mounts.laws.steady import settle

CLOSURE = 1e-10  # A loop is closed when its last force equals its first within this fraction of its force range
# Bytes of a point of a loop: instant, deflection, rate, force, hysteretic force and states, and the path they are made of.
OF_A_POINT = 100.0
# 1.6 million points at the default 400 per cycle: a few seconds, and 16 times what catalogue fits take.
_MOST_CYCLES = 4096
# Cycles after which states of slow memory are led on: a cycle of A forgets about (A / x_y)^n of the start, x_y the deflection
# at which the law yields, so that a scale that yields at 6 mm takes a million cycles of 0.02 mm.
_FOLLOWED = 512


def cyclic_test(
    law: Law, amplitudes: ArrayLike, *, operating_point: float = 0.0, frequency: float = 1.0,
    cycles: int | None = None, points_per_cycle: int = 400,
) -> list[Loop]:  # fmt: skip
    """Test a law in one loop for each amplitude: the last cycle of a sine about the operating point.

    Each test starts unloaded, ramps to the operating point within one period and goes on from there as
    operating_point + amplitude sin(2 pi f t).

    Args:
        law: the restoring-force law under test.
        amplitudes: deflection amplitudes [m], one or (n,), > 0.
        operating_point: mean deflection [m]: the preload.
        frequency: of the sine [Hz]; without effect on a rate-independent law.
        cycles: cycles to run; None: until the loop closes to 1e-10 of its force range; a law with one state, or several such
            in parallel, is led there after 512. The loop's `cycles` and `closure` say how it ended.
        points_per_cycle: samples per cycle, a multiple of 4 so that the turning points are samples.

    Raises:
        ValueError: an argument is out of its range.
        ConvergenceError: the loop has not closed after 4096 cycles.
    """
    sizes = np.atleast_1d(np.asarray(amplitudes, dtype=np.float64))
    if sizes.ndim != 1 or sizes.size == 0 or not np.isfinite(sizes).all() or (sizes <= 0.0).any():
        raise ValueError(f"`amplitudes` must be finite and > 0, got {amplitudes!r}.")
    finite("operating_point", operating_point)
    positive("frequency", frequency, unit="Hz")
    if cycles is not None:
        integer("cycles", cycles, least=1)
    if integer("points_per_cycle", points_per_cycle, least=4) % 4:
        raise ValueError(f"`points_per_cycle` must be a multiple of 4 and >= 4, got {points_per_cycle}.")
    memory = OF_A_POINT * float(points_per_cycle) * (len(sizes) + 1)
    remedy = "Use fewer `points_per_cycle`, or fewer `amplitudes`."
    require_memory(f"{len(sizes)} loops of {points_per_cycle} points", memory, remedy)
    steps = len(sizes) * float(cycles or 1) * points_per_cycle
    require_time(f"{len(sizes)} loops of {cycles or 1} cycles", steps, "Run fewer `cycles`.")
    return [_loop(law, float(size), operating_point, frequency, cycles, points_per_cycle) for size in sizes]


def _loop(law: Law, amplitude: float, operating_point: float, frequency: float, cycles: int | None, points: int) -> Loop:
    """Run the sine of one amplitude until its loop closes, or for `cycles`; return the last cycle."""
    quarter = points // 4  # each a mirror of the first, so that closure is the law's
    first = np.sin(2.0 * np.pi * np.arange(quarter + 1) / points)
    half = np.concatenate([first, first[-2::-1]])
    sine = np.concatenate([half, -half[1:]])
    path = operating_point + amplitude * sine
    rate = 2.0 * np.pi * frequency * amplitude * np.concatenate([sine[quarter:], sine[1 : quarter + 1]])
    time = np.arange(points + 1) / (frequency * points)
    states = np.zeros(law.n_states)
    if operating_point != 0.0:  # a ramp from rest to rest
        ramp = law.trace([0.0, operating_point], time=[0.0, 1.0 / frequency], rate=[0.0, 0.0])
        states = ramp.internal_states[-1]
    for count in range(1, (cycles or _MOST_CYCLES) + 1):
        loop = law.trace(path, time=time, rate=rate, initial_states=states)
        closure, states = closure_of(loop.force), loop.internal_states[-1]
        if count == cycles or (cycles is None and closure <= CLOSURE):
            return replace(loop, cycles=count, closure=closure)
        if count == _FOLLOWED and cycles is None:
            # States of rate-independent laws that have one each are led to where their cycle closes.
            turning, settled, index = path[[0, quarter, 3 * quarter, -1]], states.copy(), 0
            for part in law.components:
                if part.n_states == 1 and part.rate_independent:
                    tolerance = CLOSURE * 0.01 * float(np.ptp(loop.force))
                    settled[index] = settle(part.kernel, part.kernel_parameters(), turning, 1, tolerance)[0]
                index += part.n_states
            states = settled if np.isfinite(settled).all() else states
    raise ConvergenceError(
        f"the loop of {law.name} at an amplitude of {amplitude:.6g} m about {operating_point:.6g} m has not "
        f"closed after {_MOST_CYCLES} cycles: its ends still differ by {closure:.2g} of its force range, "
        f"where {CLOSURE:.0e} counts as closed. The memory of the start fades slowly at small amplitudes: try a larger one. "
        "A law that wears never closes: say how many `cycles` to run."
    )


_FEWEST_POINTS = 8


def measured(
    loops: Sequence[Loop], *, seed: int, points_per_cycle: int = 200, force_noise: float = 0.0,
    deflection_noise: float = 0.0, force_resolution: float = 0.0, deflection_resolution: float = 0.0,
) -> list[Loop]:  # fmt: skip
    """Record the loops as a test rig would: fewer samples, Gaussian noise, steps of the converter.

    A loop's samples count as uniform in time, as those of `cyclic_test` are, and are interpolated linearly: samples that
    coincide with the loop's own are exact, others are off by at most (pi^2 / 2) / N^2 of the amplitude, 3e-5 of it if the
    loop has N = 400. The sample that ends the cycle is measured anew, with noise of its own. What a rig cannot know is left
    out: z is NaN, internal states have no columns, and work is summed from the samples by the trapezoid rule.

    The same seed gives the same samples. Noises are standard deviations [N], [m], >= 0; resolutions are the steps to which
    values are rounded [N], [m], 0: none: of a converter of n bits its span / 2^n. ValueError: an argument is out of its
    range.
    """
    integer("points_per_cycle", points_per_cycle, least=_FEWEST_POINTS)
    noises = {"force_noise": force_noise, "deflection_noise": deflection_noise}
    steps = {"force_resolution": force_resolution, "deflection_resolution": deflection_resolution}
    for name, value in (noises | steps).items():
        not_negative(name, value)
    rng = np.random.default_rng(seed)
    return [
        Loop.from_samples(
            _record_channel(loop.deflection, points_per_cycle, deflection_noise, deflection_resolution, rng),
            _record_channel(loop.force, points_per_cycle, force_noise, force_resolution, rng),
            cycles=loop.cycles,
        )
        for loop in loops
    ]


def _record_channel(signal: Array, points: int, noise: float, resolution: float, rng: np.random.Generator) -> Array:
    """Record one channel of a cycle, (points + 1,)."""
    intervals = signal.size - 1
    # Products of integers first: an instant that is the loop's own is then hit exactly.
    samples = np.interp(np.arange(points + 1) * intervals / points, np.arange(signal.size), signal)
    # Sampled even at zero noise, so that the noise of one channel does not depend on whether the other has any.
    samples = samples + noise * rng.standard_normal(samples.size)
    return np.round(samples / resolution) * resolution if resolution > 0.0 else samples


_BINS = 20  # intervals of the common span in which a gap is averaged before its size counts, so that noise is no gap
_POINTS = 20  # in each of them
_ROUNDING = 1e-12  # of force range times amplitude: below it an area is rounding


def hardening_overlap(loops: Sequence[Loop]) -> float:
    """Measure how far the loading paths of smaller loops lie from that of the largest [-]: 0 if all share one path.

        gap       = sum over i of  integral |F_i,up - F_L,up| dx
        thickness = sum over i of  integral (F_L,up - F_L,down) dx        overlap = gap / thickness

    i runs over the smaller loops, L is the largest; up and down are the branches of rising and falling deflection; the
    integrals run over the tension side that both loops reach, from their operating point to the largest deflection of loop i. 0
    says that in tension a loop of any amplitude loads along one path, and 0.5 that the smaller loops run in the middle of the
    largest, as thin loops about a common elastic line do.

    Ni, Ko, Wong and Zhan (1999) named it after isolators that harden in tension (thesis, section 3.2.1 and figure 3.9). A loop
    that saturates without hardening loads along one path too: look at `softening_to_hardening` or at the loops for the
    hardening itself. Loops far smaller than the yield deflection never saturate and count towards 0.5. Loops of nearly one
    amplitude overlap whatever their law: compare values of the same ratios of amplitude only. Each gap is averaged over
    twentieths of the span before its size counts, so that the noise of a measurement adds little. ValueError: fewer than two
    amplitudes, loops that do not share a side in tension, or a largest loop without an area.
    """
    amplitudes = {loop.amplitude for loop in loops}
    if len(amplitudes) < 2:
        raise ValueError(f"`loops` must hold at least 2 different amplitudes, got {len(amplitudes)}.")
    *smaller, largest = sorted(loops, key=lambda loop: loop.amplitude)
    gap = thickness = 0.0
    for loop in smaller:
        start = max(loop.operating_point, largest.operating_point)
        stop = float(min(loop.deflection.max(), largest.deflection.max()))
        if stop <= start:
            raise ValueError(
                f"`loops` must have one operating point, got {loop.operating_point:.6g} m and "
                f"{largest.operating_point:.6g} m, which share no deflection in tension."
            )
        x = np.linspace(start, stop, _BINS * _POINTS)
        up = _force_on(largest, x, rising=True)
        bins = (_force_on(loop, x, rising=True) - up).reshape(_BINS, _POINTS).mean(axis=1)
        gap += float(np.abs(bins).mean()) * (stop - start)
        thickness += float((up - _force_on(largest, x, rising=False)).mean()) * (stop - start)
    if thickness <= _ROUNDING * float(np.ptp(largest.force)) * largest.amplitude:
        raise ValueError("`loops`: the largest has no area in tension, so that there is nothing to measure a gap against.")
    return gap / thickness


def _force_on(loop: Loop, deflection: np.ndarray, *, rising: bool) -> np.ndarray:
    """Interpolate the force of a branch at given deflections [N]; samples that noise has put out of order are sorted."""
    x, force = loop.branch(rising=rising)
    order = np.argsort(x)
    return np.interp(deflection, x[order], force[order])


@dataclass(frozen=True, kw_only=True)
class Transition:
    """Amplitude of the least secant stiffness: an isolator softens up to there and hardens beyond."""

    exists: bool  # whether such an amplitude lies between those that were tested
    amplitude: float  # of the least secant stiffness [m]; NaN if there is none
    stiffness: float  # the least secant stiffness [N/m]; NaN if there is none
    message: str  # the transition, or what the tested amplitudes show instead


def softening_to_hardening(loops: Sequence[Loop], *, rise: float = 1e-6) -> Transition:
    """Find the amplitude at which the secant stiffness K(A) has its minimum: softening ends, hardening begins.

    K(A) = [F(x_max) - F(x_min)] / 2A of each loop is joined by a cubic spline over log A, and its least value looked for on
    both sides of the smallest tested K, which K must exceed by the fraction `rise` at some smaller and some larger amplitude:
    for measured loops the scatter of their stiffnesses. Source: the soft-hardening of thesis section 3.2.1 and figure 3.8.
    ValueError: fewer than three different amplitudes, or `rise` is negative.
    """
    not_negative("rise", rise)
    stiffness_at = {loop.amplitude: loop.secant_stiffness for loop in loops}
    amplitude = np.array(sorted(stiffness_at))
    if amplitude.size < 3:
        raise ValueError(f"`loops` must hold at least 3 different amplitudes, got {amplitude.size}.")
    stiffness = np.array([stiffness_at[size] for size in amplitude])
    least = int(np.argmin(stiffness))
    enough = stiffness[least] + rise * abs(stiffness[least])
    falls, rises = bool((stiffness[:least] > enough).any()), bool((stiffness[least + 1 :] > enough).any())
    first, last = f"{1e3 * amplitude[0]:.4g} mm", f"{1e3 * amplitude[-1]:.4g} mm"
    if falls and rises:
        spline = scipy.interpolate.CubicSpline(np.log(amplitude), stiffness)
        low, high = math.log(amplitude[least - 1]), math.log(amplitude[least + 1])
        turns = spline.derivative().roots(extrapolate=False)
        candidates = np.array([low, high, *turns[(turns > low) & (turns < high)]])
        log_amplitude = float(candidates[np.argmin(spline(candidates))])
        size, value = math.exp(log_amplitude), float(spline(log_amplitude))
        message = f"softens up to an amplitude of {1e3 * size:.4g} mm (secant stiffness {value / 1e3:.4g} kN/m), hardens beyond"
        return Transition(exists=True, amplitude=size, stiffness=value, message=message)
    if falls:
        message = f"softens over all amplitudes tested, {first} to {last}: a transition, if there is one, lies above"
    elif rises:
        message = f"hardens over all amplitudes tested, {first} to {last}: a transition, if there is one, lies below"
    else:
        message = f"neither softens nor hardens between {first} and {last}"
    return Transition(exists=False, amplitude=math.nan, stiffness=math.nan, message=message)
