"""Range in which a fitted law was compared with measurements, and the bound of its exponent that they can tell."""

import math
from collections.abc import Sequence

from wirerope_mj.mounts.identification.coordinates import SEEN
from wirerope_mj.mounts.identification.measured import MeasuredLoop
from wirerope_mj.mounts.laws import Law
from wirerope_mj.mounts.laws.hysteresis import Hysteresis


def validity_of(law: Law, loops: Sequence[MeasuredLoop]) -> str:
    """Return the range of validity of a fitted law: the deflections that were tested, and what of small cycles was not seen.

    Half of a Bouc-Wen law's slope at z = 0, alpha, is lost at the deflection x_y (1/2)^(1/n). Where that is within 2 % of the
    least amplitude no sample shows the slope, and alpha and n follow from the bend further on alone.

    Args:
        law: that was fitted.
        loops: what it was fitted to, smallest first.
    """
    least, largest = 1e3 * loops[0].amplitude, 1e3 * loops[-1].amplitude
    sizes = f"{least:.3g} mm" if f"{least:.3g}" == f"{largest:.3g}" else f"{least:.3g} to {largest:.3g} mm"
    low = 1e3 * min(float(loop.deflection.min()) for loop in loops)
    high = 1e3 * max(float(loop.deflection.max()) for loop in loops)
    words = f"valid for cycles of {sizes} amplitude between {low:.3g} and {high:.3g} mm, which were tested; extrapolated beyond"
    if not isinstance(law, Hysteresis) or not math.isfinite(law.z_max):
        return words
    half = 1e3 * law.normalised.x_y * 0.5 ** (1.0 / law.n)
    if half > SEEN * least:
        return words
    return (
        f"{words}. With n = {law.n:.3g} half of the slope alpha is lost within {half:.2g} mm, less than {100.0 * SEEN:g} % of "
        "the least amplitude, which its samples do not show: the stiffness of smaller cycles is a guess"
    )
