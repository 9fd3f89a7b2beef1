"""Peak of a vector over time, taken block after block."""

import numpy as np

from wirerope_mj.engine.control.observer import parabola_extreme
from wirerope_mj.engine.response.peaks import Peak
from wirerope_mj.foundation.arrays import Array


class RunningPeak:
    """Extremes of the norm and of the components of a vector, which are zero before the first block."""

    def __init__(self) -> None:
        self._norm = (0.0, 0.0)  # value and instant, as in the next two
        self._lows, self._highs = [(0.0, 0.0)] * 3, [(0.0, 0.0)] * 3
        self._vector = np.zeros(3)

    def add(self, times: Array, vectors: Array) -> None:
        """Take the vectors (n, 3) at instants in order (n,) [s], of which neighbours may be the same."""
        components = np.ascontiguousarray(vectors.T)
        x, y, z = components
        norms = np.sqrt(x * x + y * y + z * z)
        largest = int(norms.argmax())
        norm = _extreme(times, norms, largest)
        if norm[0] > self._norm[0]:
            self._norm = norm
            self._vector = norm[0] * (components[:, largest] / max(float(norms[largest]), 1e-300))
        for axis, component in enumerate(components):
            low = _extreme(times, component, int(component.argmin()))
            high = _extreme(times, component, int(component.argmax()))
            if low[0] < self._lows[axis][0]:
                self._lows[axis] = low
            if high[0] > self._highs[axis][0]:
                self._highs[axis] = high

    @property
    def peak(self) -> Peak:
        """Peak over all blocks so far."""
        (minimum, minimum_time), (maximum, maximum_time) = (np.transpose(ends) for ends in (self._lows, self._highs))
        value, time = self._norm
        return Peak(
            value=value, time=time, vector=self._vector,
            minimum=minimum, minimum_time=minimum_time, maximum=maximum, maximum_time=maximum_time,
        )  # fmt: skip


def _extreme(times: Array, values: Array, i: int) -> tuple[float, float]:
    """Return value and instant of the extreme at index i, refined by a parabola unless a corner stands beside it."""
    value, time = values.item(i), times.item(i)
    before, after = i - 1, i + 1
    while after < times.size and times.item(after) == time:  # segments share their ends
        after += 1
    while before >= 0 and times.item(before) == time:
        before -= 1
    if before < 0 or after == times.size:
        return value, time
    earlier, later = times.item(before), times.item(after)
    if 0.1 < (later - time) / (time - earlier) < 10.0:  # the two limits of a corner stand 2e-10 s apart
        time, value = parabola_extreme(earlier, values.item(before), time, value, later, values.item(after))
    return value, time
