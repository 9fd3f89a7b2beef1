"""Vibration and shock as people feel them: weighted acceleration, vibration dose and motion sickness dose of ISO 2631-1."""

import math
from dataclasses import dataclass

import numpy as np

from wirerope_mj.foundation.arguments import not_negative
from wirerope_mj.foundation.arrays import Array, ArrayLike, ComplexArray
from wirerope_mj.motions.spectra.ramp import check_samples

_RUNNING = 1.0  # time over which the running rms is taken [s] (ISO 2631-1, 6.3.1)
# Periods of a weighting's lower band limit by which a history is lengthened: a filter of Q = 0.71 has rung out to 1e-5 then.
_RINGS = 3.0


@dataclass(frozen=True, kw_only=True)
class Weighting:
    """A frequency weighting of acceleration, as ISO 8041 defines it by analogue filters.

    H(p) = p^2 / (p^2 + r w1 p + w1^2)  w2^2 / (p^2 + r w2 p + w2^2)      r = sqrt(2), band limits
           (1 + p / w3) / (1 + p / (Q4 w4) + (p / w4)^2)                  from acceleration to velocity
           (w5 / w6)^2 (1 + p / (Q5 w5) + (p / w5)^2) / (1 + p / (Q6 w6) + (p / w6)^2)     upward step
    """

    # low, high: band limits f1, f2 [Hz]
    low: float
    high: float
    # f3, f4, q4: of the passage from acceleration to velocity [Hz]; f3 may be infinite
    f3: float
    f4: float
    q4: float
    step: tuple[float, ...] = ()  # f5 [Hz], Q5, f6 [Hz], Q6 of the upward step; empty without one

    def gain(self, frequency: ArrayLike) -> ComplexArray:
        """Evaluate H at frequencies [Hz], (...)."""
        p = 1j * np.asarray(frequency, dtype=np.complex128)
        root = math.sqrt(2.0)
        band = p**2 / (p**2 + root * self.low * p + self.low**2) * self.high**2
        found = band / (p**2 + root * self.high * p + self.high**2)
        found = found * (1.0 + p / self.f3) / (1.0 + p / (self.q4 * self.f4) + (p / self.f4) ** 2)
        if self.step:
            f5, q5, f6, q6 = self.step
            up, down = ((1.0 + p / (q * f) + (p / f) ** 2) for f, q in ((f5, q5), (f6, q6)))
            found = found * (f5 / f6) ** 2 * up / down
        return found


# Parameters of ISO 8041-1: Wk vertical, Wd horizontal, Wf motion sickness, Wm buildings and ships (ISO 2631-2, ISO 6954).
_KNEE = 1.0 / (2.0 * math.pi * 0.028)
WEIGHTINGS = {
    "Wk": Weighting(low=0.4, high=100.0, f3=12.5, f4=12.5, q4=0.63, step=(2.37, 0.91, 3.35, 0.91)),
    "Wd": Weighting(low=0.4, high=100.0, f3=2.0, f4=2.0, q4=0.63),
    "Wf": Weighting(low=0.08, high=0.63, f3=math.inf, f4=0.25, q4=0.86, step=(0.0625, 0.80, 0.10, 0.80)),
    "Wm": Weighting(low=10.0**-0.1, high=100.0, f3=_KNEE, f4=_KNEE, q4=0.5),
}


@dataclass(frozen=True, kw_only=True)
class Exposure:
    """Weighted vibration of a person at a point, along x, y and z of the world, z upwards."""

    rms: Array  # weighted rms acceleration [m/s^2], (3,): Wd horizontally, Wk vertically
    # NaN of less than that second
    running: Array  # largest running rms over 1 s, the maximum transient vibration value [m/s^2], (3,)
    peak: Array  # largest weighted acceleration [m/s^2], (3,)
    dose: Array  # fourth power vibration dose value [m/s^1.75], (3,)
    sickness: float  # motion sickness dose value MSDV of z, by Wf [m/s^1.5]
    duration: float  # time that counts [s]

    @property
    def total(self) -> float:
        """Vibration total value for comfort, the root of the sum of squares of rms [m/s^2]."""
        return float(np.linalg.norm(self.rms))

    @property
    def crest(self) -> Array:
        """Peak over rms, (3,); NaN where nothing moves. Above 9 the rms says too little, and running rms and dose are asked."""
        return np.divide(self.peak, self.rms, out=np.full(3, math.nan), where=self.rms > 1e-9 * self.total)


def exposure(time: ArrayLike, acceleration: ArrayLike, *, discard: float = 0.0) -> Exposure:
    """Evaluate what a person feels of an acceleration by ISO 2631-1.

    Args:
        time: uniform instants [s], (n,).
        acceleration: along x, y and z [m/s^2], (n, 3), from rest.
        discard: length at the beginning that does not count [s]; the filters see it.

    Raises:
        ValueError: the samples are not as they must be, or nothing is left of them.
    """
    instants, values = np.asarray(time, dtype=np.float64), np.asarray(acceleration, dtype=np.float64)
    rate = 1.0 / check_samples(instants, values)[1]
    kept = instants.size - round(min(not_negative("discard", discard) * rate, instants.size))
    if kept < 2:
        raise ValueError(f"`discard` must leave something of the {instants[-1] - instants[0]:.6g} s, got {discard:.6g} s.")
    horizontal, vertical = (weighted(values[:, axes], rate, name) for axes, name in ((slice(2), "Wd"), (slice(2, 3), "Wk")))
    felt = np.concatenate([horizontal, vertical], axis=1)[-kept:]
    sick = weighted(values[:, 2:], rate, "Wf")[-kept:]
    summed = np.cumsum(np.vstack([np.zeros(3), felt**2]), axis=0)
    window = round(_RUNNING * rate)
    long = window <= kept
    running = np.sqrt(np.max(summed[window:] - summed[:-window], axis=0) / window) if long else np.full(3, math.nan)
    return Exposure(
        rms=np.sqrt(summed[-1] / kept), running=running, peak=np.abs(felt).max(axis=0),
        dose=(np.sum(felt**4, axis=0) / rate) ** 0.25, sickness=math.sqrt(float(np.sum(sick**2)) / rate),
        duration=kept / rate,
    )  # fmt: skip


def weighted(acceleration: Array, rate: float, weighting: str) -> Array:
    """Return a history from rest [m/s^2], (n, k), at samples a second, through a filter of `WEIGHTINGS`."""
    filters = WEIGHTINGS[weighting]
    size = acceleration.shape[0] + round(_RINGS / filters.low * rate)
    lines = np.fft.rfft(acceleration, n=size, axis=0)
    lines *= filters.gain(np.fft.rfftfreq(size, 1.0 / rate))[:, None]
    return np.fft.irfft(lines, n=size, axis=0)[: acceleration.shape[0]]
