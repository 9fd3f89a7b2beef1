"""Range of validity of a law fitted to loops: what was measured, and whether small cycles show in it."""

import math
from collections.abc import Sequence

import numpy as np

from wirerope_mj.mounts.identification.coordinates import SEEN
from wirerope_mj.mounts.identification.measured import MeasuredLoop
from wirerope_mj.mounts.isolator import MeasuredRange
from wirerope_mj.mounts.laws import Law
from wirerope_mj.mounts.laws.hysteresis import Hysteresis

_WINDOW = 0.1  # of a cycle, over which a rate is taken: a sine's is 1.6 % less than at an instant, noise hardly shows


def measured_range(loops: Sequence[MeasuredLoop]) -> MeasuredRange:
    """Return the amplitudes, deflections, frequencies and largest rates of loops."""
    periods = [loop.period for loop in loops if loop.period is not None]
    rates = [rate for loop in loops if (rate := largest_rate(loop)) is not None]
    return MeasuredRange(
        amplitude=(min(loop.amplitude for loop in loops), max(loop.amplitude for loop in loops)),
        deflection=(
            min(float(loop.deflection.min()) for loop in loops),
            max(float(loop.deflection.max()) for loop in loops),
        ),
        frequency=(1.0 / max(periods), 1.0 / min(periods)) if periods else None,
        rate=(min(rates), max(rates)) if rates else None,
    )


def largest_rate(loop: MeasuredLoop) -> float | None:
    """Return the largest deflection rate of a loop over a tenth of its cycle [m/s]; None where its time is not known."""
    if loop.period is None or not loop.elapsed.size:
        return None
    phase = np.linspace(0.0, 1.0, 201)[:-1]
    x = np.interp(phase, loop.elapsed, loop.deflection)
    step = round(_WINDOW * phase.size)
    return float(np.abs(np.roll(x, -step) - x).max()) / (_WINDOW * loop.period)


def validity_of(law: Law, loops: Sequence[MeasuredLoop]) -> str:
    """Return the range of validity of a law fitted to loops, smallest first: tested cycles, and whether small ones show.

    Half of a Bouc-Wen law's slope at z = 0, alpha, is lost at the deflection x_y (1/2)^(1/n). Where that is within 2 % of the
    least amplitude no sample shows the slope, and alpha and n follow from the bend further on alone.
    """
    measured, least = measured_range(loops), 1e3 * loops[0].amplitude
    pace = f" ({measured.pace})" if measured.pace else ""
    text = (
        f"valid for cycles of {measured.text}, which were tested{pace}, not below {least:.3g} mm; extrapolated beyond, where "
        "the error of the fit says nothing"
    )
    sets = [one for one in law.components if isinstance(one, Hysteresis) and math.isfinite(one.z_max)]
    if len(sets) < len(law.components):
        return text
    one = min(sets, key=_half_slope)  # of several scales the one that shows least
    half = 1e3 * _half_slope(one)
    if half > SEEN * least:
        return text
    return (
        f"{text}. With n = {one.n:.3g} half of the slope alpha is lost within {half:.2g} mm, less than {100.0 * SEEN:g} % of "
        "the least amplitude, which its samples do not show: the stiffness of smaller cycles is a guess"
    )


def _half_slope(law: Hysteresis) -> float:
    """Return the deflection over which half of the slope at z = 0 is lost [m]."""
    return law.normalised.x_y * 0.5 ** (1.0 / law.n)
