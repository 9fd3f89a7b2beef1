"""Response spectra that earthquake standards ask for, as targets of `match_spectrum`; every level is an argument."""

import math

import numpy as np
from numpy.typing import ArrayLike

from wirerope_mj.foundation.arguments import between, positive
from wirerope_mj.foundation.arrays import Array

# soil factor and corner periods TB, TC, TD [s] that EN 1998-1 recommends for its ground types, from memory; a national annex
# may have others
EN1998_TYPE_1 = {
    "A": {"soil_factor": 1.0, "corner_periods": (0.15, 0.4, 2.0)},
    "B": {"soil_factor": 1.2, "corner_periods": (0.15, 0.5, 2.0)},
    "C": {"soil_factor": 1.15, "corner_periods": (0.2, 0.6, 2.0)},
    "D": {"soil_factor": 1.35, "corner_periods": (0.2, 0.8, 2.0)},
    "E": {"soil_factor": 1.4, "corner_periods": (0.15, 0.5, 2.0)},
}
LONGEST_PERIOD = 4.0  # longest period of the shape of EN 1998-1 [s]
AC156_FREQUENCIES = (1.3, 8.3, 33.3)  # ends of the plateau and of the slope of ICC-ES AC156 [Hz]


def en1998_spectrum(
    frequencies: ArrayLike,
    *,
    ground_acceleration: float,
    soil_factor: float,
    corner_periods: tuple[float, float, float],
    damping: float = 0.05,
) -> Array:
    """Return the horizontal elastic response spectrum of EN 1998-1, 3.2.2.2 [m/s^2].

    With T = 1/f and eta = sqrt(10/(5 + 100 damping)), at least 0.55,

        Se = ag S (1 + T/TB (2.5 eta - 1))   up to TB
             2.5 ag S eta                    up to TC
             2.5 ag S eta TC/T               up to TD
             2.5 ag S eta TC TD/T^2          up to 4 s

    `EN1998_TYPE_1["B"]` and the like hold soil factor and corner periods of the ground types.

    Args:
        frequencies: frequencies [Hz], any shape, 0.25 Hz or more.
        ground_acceleration: design ground acceleration on rock, ag [m/s^2].
        soil_factor: factor S of the ground [-].
        corner_periods: TB, TC and TD [s].
        damping: damping ratio of the oscillators.
    """
    level = positive("ground_acceleration", ground_acceleration) * positive("soil_factor", soil_factor)
    tb, tc, td = (positive("corner_periods", period) for period in corner_periods)
    if not tb <= tc <= td:
        raise ValueError(f"`corner_periods` must increase, got {corner_periods!r}.")
    period = 1 / _above(frequencies, 1 / LONGEST_PERIOD, "the spectrum of EN 1998-1 ends at 4 s")
    eta = max(math.sqrt(10 / (5 + 100 * positive("damping", damping))), 0.55)
    plateau = 2.5 * eta
    # Beyond each corner the factor of the branch before it goes on.
    falling = plateau * np.minimum(tc / period, 1.0) * np.minimum(td / period, 1.0)
    return level * np.where(period < tb, 1 + period / tb * (plateau - 1), falling)


def ac156_spectrum(frequencies: ArrayLike, *, s_ds: float, height_ratio: float, vertical: bool = False) -> Array:
    """Return the required response spectrum of ICC-ES AC156 for 5 % damping [in the unit of `s_ds`].

    Horizontal: A_flx = S_DS (1 + 2 z/h), at most 1.6 S_DS, from 1.3 to 8.3 Hz, and A_rig = 0.4 S_DS (1 + 2 z/h), at most
    1.2 S_DS, from 33.3 Hz on; straight on logarithmic axes between them. Vertical: 0.67 and 0.27 S_DS at any height.
    A motion that `match_spectrum` makes holds the rigid plateau up to the last frequency of its target only: give it points
    beyond 33.3 Hz.

    Args:
        frequencies: frequencies [Hz], any shape, 1.3 Hz or more.
        s_ds: design spectral acceleration at short periods S_DS, for instance in [m/s^2].
        height_ratio: height of the attachment over that of the building z/h, from 0 to 1.
        vertical: whether the vertical spectrum is asked for.
    """
    s_ds = positive("s_ds", s_ds)
    between("height_ratio", height_ratio, 0.0, 1.0)
    checked = _above(frequencies, AC156_FREQUENCIES[0], "the plateau of AC156 begins at 1.3 Hz")
    raised = 1 + 2 * height_ratio
    flexible, rigid = (0.67, 0.27) if vertical else (min(raised, 1.6), min(0.4 * raised, 1.2))
    corners = np.log(AC156_FREQUENCIES)
    return s_ds * np.exp(np.interp(np.log(checked), corners, np.log([flexible, flexible, rigid])))


def _above(frequencies: ArrayLike, least: float, reason: str) -> Array:
    checked = np.asarray(frequencies, dtype=float)
    if not np.all(np.isfinite(checked)) or np.any(checked < least * (1 - 1e-9)):
        raise ValueError(f"`frequencies` must be at least {least:g} Hz: {reason}; got {np.min(checked):g} Hz.")
    return checked
