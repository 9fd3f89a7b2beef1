"""Extremes of sampled histories."""

import numpy as np
import numpy.typing as npt

Array = npt.NDArray[np.float64]


def sampled_peak(time: Array, values: Array) -> tuple[float, float]:
    """Return the largest of `values` (n,) and its instant [s], refined by the parabola through the samples beside it."""
    k = int(values.argmax())
    if 0 < k < values.size - 1:
        before, here, after = values[k - 1 : k + 2].tolist()
        bend = before - 2.0 * here + after
        if bend < 0.0:
            shift = 0.5 * (before - after) / bend
            return here - 0.25 * (before - after) * shift, float(time[k] + shift * (time[k + 1] - time[k]))
    return float(values[k]), float(time[k])
