"""Random phases that are the same for a seed on every machine and with every version of NumPy."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray


def random_phases(seed: int, count: int) -> NDArray[np.float64]:
    """Returns phases from 0 to 2 pi [rad], shape (count,).

    They are made here from the raw bits of PCG64, whose stream is fixed; NumPy's distributions may change.
    """
    bits = np.random.PCG64(seed).random_raw(count)
    return 2 * np.pi * 2.0**-53 * (bits >> np.uint64(11)).astype(float)
