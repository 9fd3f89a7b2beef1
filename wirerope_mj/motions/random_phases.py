"""Random phases and amplitudes that are the same for a seed on every machine and with every version of NumPy."""

import numpy as np

from wirerope_mj.foundation.arrays import Array


def random_phases(seed: int, count: int) -> Array:
    """Return phases from 0 to 2 pi [rad], (count,).

    They are made here from the raw bits of PCG64, whose stream is fixed; NumPy's distributions may change.
    """
    return 2 * np.pi * _uniform(seed, count)


def random_amplitudes(seed: int, count: int) -> Array:
    """Return amplitudes of Rayleigh's distribution whose mean square is 1, (count,); independent of the phases.

    With phases of `random_phases` they make sines and cosines of normal distribution: A = sqrt(-ln(1 - U)), U from 0 to 1
    being the numbers of the stream that follow those of the phases.
    """
    return np.sqrt(-np.log1p(-_uniform(seed, 2 * count)[count:]))


def _uniform(seed: int, count: int) -> Array:
    bits = np.random.PCG64(seed).random_raw(count)
    return 2.0**-53 * (bits >> np.uint64(11)).astype(float)
