"""The rig: steady loops of one law under a sine about an operating point, and their samples as an acquisition records them."""

from collections.abc import Sequence
from dataclasses import replace

import numpy as np

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
    memory, remedy = (
        OF_A_POINT * float(points_per_cycle) * (len(sizes) + 1),
        "Use fewer `points_per_cycle`, or fewer `amplitudes`.",
    )
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
            _acquired(loop.deflection, points_per_cycle, deflection_noise, deflection_resolution, rng),
            _acquired(loop.force, points_per_cycle, force_noise, force_resolution, rng),
            cycles=loop.cycles,
        )
        for loop in loops
    ]


def _acquired(signal: Array, points: int, noise: float, resolution: float, rng: np.random.Generator) -> Array:
    """Record one channel of a cycle, (points + 1,)."""
    intervals = signal.size - 1
    # Products of integers first: an instant that is the loop's own is then hit exactly.
    samples = np.interp(np.arange(points + 1) * intervals / points, np.arange(signal.size), signal)
    # Sampled even at zero noise, so that the noise of one channel does not depend on whether the other has any.
    samples = samples + noise * rng.standard_normal(samples.size)
    return np.round(samples / resolution) * resolution if resolution > 0.0 else samples
