"""Content of the file of a measured record, its level at rest, and whether it is of a pulse or of a vibration."""

from collections.abc import Iterable
from dataclasses import dataclass, replace

import numpy as np

from wirerope_mj.foundation.arrays import Array
from wirerope_mj.foundation.directions import ROTATIONS, Direction, unit_vector
from wirerope_mj.foundation.units import ACCELERATION_UNITS

# a record rests at its median if so many of its samples lie near it, within a fraction of its range or of the median
_REST_SHARE, _BAND, _NEAR_LEVEL = 0.3, 0.02, 0.1
# median deviations, three standard deviations of noise, within which samples are quiet; samples that give the median
_NOISE, _ENOUGH = 4.5, 100_000
_ERRORS = 7.4  # four standard errors of a median of noise, in median deviations over the root of the number of samples
# least samples at either end that say whether a record begins or ends quietly; fraction of samples one step off a level
_END_SAMPLES, _DITHERED = 16, 0.05
# half waves above a tenth of the peak up to which a record is of a pulse, which begins and ends near zero
_PULSE_WAVES = 10


@dataclass(frozen=True)
class Reading:
    """Content of a record's file: accelerations as they were measured, and warnings."""

    time: Array  # instants of the file's own clock [s], increasing, (n,)
    # acceleration along x, y, z [m/s^2], (n, 3); with what turns the base behind it, about x, y, z, (n, 6)
    samples: Array
    units: tuple[str, ...]  # in which the file gives them, each once
    warnings: tuple[str, ...] = ()  # what had to be done to the samples, and what looks wrong about them
    turned_by: str = ""  # "rate" [rad/s] or "acceleration" [rad/s^2], what turns the base; "" where nothing does

    @property
    def unit(self) -> tuple[str, float]:
        """Unit in which messages give accelerations, and its factor to m/s^2: the file's, or m/s^2 where it has several."""
        unit = self.units[0] if len(self.units) == 1 and self.units[0] in ACCELERATION_UNITS else "m/s^2"
        return unit, ACCELERATION_UNITS[unit]

    def text(self, value: float, digits: int = 4) -> str:
        """Write an acceleration [m/s^2] as messages do."""
        unit, factor = self.unit
        return f"{value / factor:.{digits}g} {unit}"

    def warned(self, *messages: str) -> "Reading":
        return replace(self, warnings=(*self.warnings, *messages))


def axes_of(directions: Iterable[Direction]) -> Array:
    """Return unit vectors of the channels' directions, (n_channels, 3); with rotations (n_channels, 6), translations first."""
    vectors = np.zeros((0, 6))
    for direction in directions:
        name = str(direction).lstrip("+-")
        turns = name in ROTATIONS
        unit = np.eye(3)[ROTATIONS.index(name)] * (-1.0 if direction[0] == "-" else 1.0) if turns else unit_vector(direction)
        vectors = np.vstack([vectors, np.concatenate([np.zeros(3), unit] if turns else [unit, np.zeros(3)])])
    return vectors if vectors[:, 3:].any() else vectors[:, :3].copy()


def quiet_level(a: Array) -> float | None:
    """Return the mean of the quiet part of a signal (n,), which it begins or ends with; None if there is no such part.

    A level that is neither at the beginning nor at the end is the top of a pulse.
    """
    middle = float(np.median(a))
    band = max(_BAND * float(np.ptp(a)), _NEAR_LEVEL * abs(middle))
    if np.count_nonzero((a >= middle - band) & (a <= middle + band)) / a.size < _REST_SHARE:
        return None
    deviation = np.abs(a - middle)
    spread = float(np.median(deviation[:: max(1, deviation.size // _ENOUGH)]))
    few = max(_END_SAMPLES, a.size // 50)
    for part in (a[:few], a[-few:]):  # does this end stand at the level, within its noise or the band?
        level = float(np.median(part))
        noise = _ERRORS * float(np.median(np.abs(part - level))) / np.sqrt(part.size)
        if abs(level - middle) <= max(_BAND * float(np.ptp(a)), noise):
            break
    else:
        return None
    quiet = _NOISE * spread
    if spread == 0.0:  # most samples equal the level; those a digit beside it are quiet, too, if they are many
        step = 1.5 * float(deviation[deviation > 0.0].min(initial=np.inf))
        quiet = step if np.count_nonzero((deviation > 0.0) & (deviation <= step)) > _DITHERED * deviation.size else 0.0
    return float(a[deviation <= quiet].mean())


def offset_of(a: Array) -> float:
    """Return the offset of a signal (n,): its level at rest, else a vibration's mean, or zero for a pulse."""
    rest = quiet_level(a)
    if rest is not None:
        return rest
    mean = float(a.mean())
    return 0.0 if is_pulse(a, mean) else mean


def level_at_rest(a: Array) -> float | None:
    """Return the level of a response (n,) at rest: of its quiet part, else before its onset; None if it has neither.

    A response may ring on until its record ends, so that it is near its level nowhere but before the event.
    """
    few, level = max(_END_SAMPLES, a.size // 50), quiet_level(a)
    if level is not None:
        return level
    middle = float(np.median(a[:few]))
    quiet = _NOISE * float(np.median(np.abs(a[:few] - middle)))
    onset = int(np.argmax(np.abs(a - middle) > max(2.0 * quiet, _BAND * float(np.ptp(a)))))
    if onset < few or quiet > _NEAR_LEVEL * float(np.ptp(a)):
        return None
    before = a[:onset]
    return float(before[np.abs(before - middle) <= quiet].mean())


def is_pulse(a: Array, rest: float) -> bool:
    """True if a signal (n,) is a pulse and not a vibration: it has few half waves about its level at rest."""
    peak = peak_from(a, rest)
    signs = np.sign(a[np.abs(a - rest) > 0.1 * peak] - rest)
    return bool(np.count_nonzero(np.diff(signs)) < _PULSE_WAVES)


def peak_from(a: Array, rest: float) -> float:
    """Return the largest distance of a signal (n,) from its level at rest."""
    return max(float(a.max()) - rest, rest - float(a.min()))
