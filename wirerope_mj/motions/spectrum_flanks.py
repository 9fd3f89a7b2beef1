"""Flanks of a response spectrum: the largest ratio between the responses of two oscillators."""

import numpy as np

from wirerope_mj.foundation.arrays import Array


def too_steep(frequencies: Array, target: Array, damping: float) -> str:
    """Return the message about the flank of a spectrum that is farthest beyond any motion; empty if there is none.

    Of all motions a steady sine at the frequency of one oscillator sets it the most apart from another: the amplifications
    |1 + 2 i zeta r| / |1 - r^2 + 2 i zeta r| of the two, r = sine's over oscillator's frequency, are the measure.

    Args:
        frequencies: of the oscillators [Hz], rising, (n,).
        target: asked for there [m/s^2], (n,).
        damping: damping ratio of the oscillators.
    """
    ratio = frequencies[:, np.newaxis] / frequencies  # of sine i over oscillator j
    responses = np.abs((1 + 2j * damping * ratio) / (1 - ratio**2 + 2j * damping * ratio))
    possible = np.diag(responses)[:, np.newaxis] / responses
    wanted = target[:, np.newaxis] / target
    excess = wanted / possible
    high, low = np.unravel_index(int(np.argmax(excess)), excess.shape)
    if excess[high, low] <= 1.0:
        return ""
    wanted_db, possible_db = (20 * float(np.log10(ratios[high, low])) for ratios in (wanted, possible))
    verb = "falls" if high < low else "rises"
    first, last = sorted((float(frequencies[high]), float(frequencies[low])))
    return (
        f"The target {verb} by {wanted_db:.3g} dB from {first:.4g} to {last:.4g} Hz; at a damping ratio of {damping:g} even a "
        f"steady sine of {frequencies[high]:.4g} Hz sets oscillators there no more than {possible_db:.3g} dB apart. Make that "
        "flank less steep."
    )
