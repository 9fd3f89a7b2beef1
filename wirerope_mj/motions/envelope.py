"""Smooth rise and fall of a vibration, so that the base starts and ends at rest, and its random phases.

Phases and amplitudes are the same for a seed on every machine and with every version of NumPy.
"""

from dataclasses import dataclass

import numpy as np

from wirerope_mj.foundation.arguments import finite, positive
from wirerope_mj.foundation.arrays import Array
from wirerope_mj.motions.motion import unique_times

# periods of the lowest frequency in a rise that is not given: it disturbs that frequency by 1/(2 * 10) at most
USUAL_PERIODS = 10.0
# fraction of the duration that a rise that is not given may take, if that leaves one period of the lowest frequency
USUAL_FRACTION = 0.1


@dataclass(frozen=True, kw_only=True)
class Envelope:
    """Factor that rises from 0 to 1 as s^3 (10 - 15 s + 6 s^2), s from 0 to 1, and falls likewise: no jump of curvature."""

    start: float  # instant at which the rise begins [s]
    stop: float  # instant at which the fall ends [s]; infinite: it never falls
    rise: float  # length of the rise [s]; 0: the factor was always 1
    fall: float  # length of the fall [s]

    def derivatives(self, t: Array) -> tuple[Array, Array, Array]:
        """Return the factor and its first two derivatives at the times (n_t,)."""
        constant = np.ones_like(t), np.zeros_like(t), np.zeros_like(t)
        up, up1, up2 = _step((t - self.start) / self.rise) if self.rise else constant
        if not np.isfinite(self.stop):
            return up, up1 / (self.rise or 1.0), up2 / (self.rise or 1.0) ** 2
        down, down1, down2 = _step((self.stop - t) / self.fall)
        # Rise and fall do not overlap: where one of them changes the other is constant.
        first = up1 / (self.rise or 1.0) * down - up * down1 / self.fall
        second = up2 / (self.rise or 1.0) ** 2 * down + up * down2 / self.fall**2
        return up * down, first, second

    @property
    def corners(self) -> Array:
        """Instants at which the third derivative jumps [s], (n,)."""
        rises = [self.start, self.start + self.rise] if self.rise else []
        falls = [self.stop - self.fall, self.stop] if np.isfinite(self.stop) else []
        return unique_times([*rises, *falls])


def usual_ramp(name: str, given: float | None, *, lowest: float, duration: float) -> float:
    """Return the length of a rise or fall called `name` [s]: the given one, checked, or the usual one.

    The usual one is ten periods of the lowest frequency [Hz] or a tenth of the duration [s], the shorter one, but at least one
    period.
    """
    period = 1 / lowest
    if given is None:
        return max(min(USUAL_PERIODS * period, USUAL_FRACTION * duration), period)
    if positive(name, given) < period * (1 - 1e-9):
        raise ValueError(
            f"`{name}` must be at least one period of the lowest frequency, {period:.6g} s, for the base to start and end "
            f"softly, got {finite(name, given)!r}."
        )
    return float(given)


def check_room(duration: float, rise: float, fall: float) -> None:
    """Raise ValueError if rise and fall do not fit into the duration [s]."""
    if rise + fall > duration:
        raise ValueError(
            f"`duration` must leave room for rise and fall, {rise:.6g} s and {fall:.6g} s, got {duration!r}: "
            f"ask for {rise + fall:.6g} s or more, or for a shorter rise and fall."
        )


def _step(s: Array) -> tuple[Array, Array, Array]:
    """Return the smooth step from 0 to 1 over s and its first two derivatives by s; s is clipped to 0..1."""
    s = np.clip(s, 0.0, 1.0)
    return s**3 * (10 - s * (15 - 6 * s)), 30 * (s * (1 - s)) ** 2, 60 * s * (1 - s) * (1 - 2 * s)


def random_phases(seed: int, count: int) -> Array:
    """Return phases from 0 to 2 pi [rad], (count,).

    They are made here from the raw bits of PCG64, whose stream is fixed; NumPy's distributions may change.
    """
    return 2 * np.pi * uniform_numbers(seed, count)


def random_amplitudes(seed: int, count: int) -> Array:
    """Return amplitudes of Rayleigh's distribution whose mean square is 1, (count,); independent of the phases.

    With phases of `random_phases` they make sines and cosines of normal distribution: A = sqrt(-ln(1 - U)), U from 0 to 1
    being the numbers of the stream that follow those of the phases.
    """
    return np.sqrt(-np.log1p(-uniform_numbers(seed, 2 * count)[count:]))


def uniform_numbers(seed: int, count: int) -> Array:
    """Draw uniformly distributed numbers from 0 to 1, (count,)."""
    bits = np.random.PCG64(seed).random_raw(count)
    return 2.0**-53 * (bits >> np.uint64(11)).astype(float)
