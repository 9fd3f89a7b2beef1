"""Acquisition of a loop by a test rig: samples, noise and the steps of its converter."""

from collections.abc import Sequence

import numpy as np

from wirerope_mj.foundation.arguments import integer, not_negative
from wirerope_mj.foundation.arrays import Array
from wirerope_mj.mounts.laws import Loop

_FEWEST_POINTS = 8


def measured(
    loops: Sequence[Loop],
    *,
    seed: int,
    points_per_cycle: int = 200,
    force_noise: float = 0.0,
    deflection_noise: float = 0.0,
    force_resolution: float = 0.0,
    deflection_resolution: float = 0.0,
) -> list[Loop]:
    """Return the loops as a test rig would have recorded them: fewer samples, Gaussian noise, steps of the converter.

    A loop's samples count as uniform in time, as those of `cyclic_test` are, and are interpolated linearly: samples that
    coincide with the loop's own are exact, others are off by at most (pi^2 / 2) / N^2 of the amplitude, 3e-5 of it if the
    loop has N = 400.
    The sample that ends the cycle is measured anew, with noise of its own. What a rig cannot know is left out: z is NaN,
    internal states have no columns, and work is summed from the samples by the trapezoid rule.

    Args:
        loops: closed cycles.
        seed: of the noise; the same seed gives the same samples.
        points_per_cycle: samples per cycle, >= 8.
        force_noise: standard deviation [N].
        deflection_noise: standard deviation [m].
        force_resolution: step to which forces are rounded [N]; 0: none. For a converter of n bits it is its span / 2^n.
        deflection_resolution: the same for deflections [m].

    Raises:
        ValueError: an argument is out of its range.
    """
    integer("points_per_cycle", points_per_cycle, least=_FEWEST_POINTS)
    values = {
        "force_noise": force_noise,
        "deflection_noise": deflection_noise,
        "force_resolution": force_resolution,
        "deflection_resolution": deflection_resolution,
    }
    for name, value in values.items():
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
    """Return one channel of a cycle as it is recorded, (points + 1,)."""
    intervals = signal.size - 1
    # Products of integers first: an instant that is the loop's own is then hit exactly.
    samples = np.interp(np.arange(points + 1) * intervals / points, np.arange(signal.size), signal)
    # Sampled even at zero noise, so that the noise of one channel does not depend on whether the other has any.
    samples = samples + noise * rng.standard_normal(samples.size)
    return np.round(samples / resolution) * resolution if resolution > 0.0 else samples
