"""Samples beyond the ends of a measured record, so that a filter does not err there."""

import numpy as np

from wirerope_mj.foundation.arrays import Array
from wirerope_mj.motions.records.rest import is_pulse, offset_of

# of the prediction, and the samples next to an end that it is made from: sixteen lines, a thousandth of the rate apart
_ORDER, _WINDOW = 32, 1000
_EXACT = 1e-10  # error of the prediction, as a fraction of the signal's power, at which it is good enough


def continued(a: Array, count: int) -> Array:
    """Return a signal (n,) with samples added at both ends, (n + 2 count,).

    A pulse is mirrored, so that a filter takes nothing from its area even where it begins with the first sample. A vibration
    was cut out of a longer one and is continued by linear prediction (Burg): sines go on with their phase, noise dies away.
    """
    rest = offset_of(a)
    if is_pulse(a, rest):
        return np.pad(a, count, mode="reflect")
    before = _predicted(a[:_WINDOW][::-1] - rest, count)[::-1]
    after = _predicted(a[-_WINDOW:] - rest, count)
    return np.concatenate([before + rest, a, after + rest])


def _predicted(a: Array, count: int) -> Array:
    """Return the samples that come after a signal as far as its past tells."""
    from scipy.signal import lfilter, lfiltic

    weights = _burg(a, min(_ORDER, a.size // 3))
    state = lfiltic([1.0], weights, a[::-1][: weights.size - 1])
    return np.asarray(lfilter([1.0], weights, np.zeros(count), zi=state)[0])


def _burg(a: Array, order: int) -> Array:
    """Return 1 and the weights of the past in the error of prediction, which are always those of a stable filter."""
    weights = np.ones(1)
    forward, backward = a[1:], a[:-1]
    enough = _EXACT * 2.0 * float(a @ a)
    for _ in range(order):
        power = float(forward @ forward + backward @ backward)
        if power <= enough:
            break  # more weights would hold nothing but rounding, and what they predict would grow
        reflected = float(np.clip(-2.0 * (forward @ backward) / power, -1.0, 1.0))  # beyond by rounding
        weights = np.append(weights, 0.0)
        weights = weights + reflected * weights[::-1]
        forward, backward = (forward + reflected * backward)[1:], (backward + reflected * forward)[:-1]
    return weights
