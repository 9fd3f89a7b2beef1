"""Cycles of a history by rainflow counting, their damage spectrum, and the random vibration of equal damage."""

import math
from dataclasses import dataclass
from operator import itemgetter
from pathlib import Path

import numpy as np
import scipy

from wirerope_mj.engine.response import Response
from wirerope_mj.foundation.arguments import positive
from wirerope_mj.foundation.arrays import Array, ArrayLike
from wirerope_mj.foundation.directions import direction_text, unit_vector
from wirerope_mj.foundation.quantities import parse_phrase
from wirerope_mj.foundation.summary import Brief
from wirerope_mj.motions.envelope import Envelope
from wirerope_mj.motions.phrases import site_first
from wirerope_mj.motions.psd_lines import Points, psd_rms
from wirerope_mj.motions.random_vibration import RandomVibration
from wirerope_mj.motions.spectra.psd import equivalent_psd
from wirerope_mj.motions.spectra.ramp import check_samples, octave_grid
from wirerope_mj.motions.spectra.srs import SAMPLES_PER_PERIOD, ramp_steps

# Exponents of fatigue curves: with larger ones the damage of amplitudes of micrometres underflows.
FLATTEST, STEEPEST = 1.0, 50.0


@dataclass(frozen=True, kw_only=True, eq=False, repr=False)
class Cycles(Brief):
    """Cycles of a history by rainflow counting."""

    ranges: Array  # highest less lowest value of each cycle, (n,)
    means: Array  # mean of both values, (n,)
    counts: Array  # 1 for a closed cycle, 0.5 for an open half, (n,)

    @property
    def total(self) -> float:
        """Number of cycles, open ones as halves."""
        return float(self.counts.sum())

    def damage(self, exponent: float, constant: float = 1.0) -> float:
        """Sum n/N after Miner with N = C / A^b, A being half the range.

        Args:
            exponent: b.
            constant: C, in the unit of the history to the power b; 1: a damage to be compared with others of that unit only.

        Raises:
            ValueError: one of them is not positive, or the exponent is that of no fatigue curve.
        """
        b, c = positive("exponent", exponent), positive("constant", constant)
        if not FLATTEST <= b <= STEEPEST:
            expected = f"from {FLATTEST:g} to {STEEPEST:g}"
            raise ValueError(f"`exponent` of a fatigue curve must be {expected}, got {b:g}: those of metals are 3 to 15.")
        return float(np.sum(self.counts * (0.5 * self.ranges) ** b) / c)


def rainflow_cycles(history: ArrayLike) -> Cycles:
    """Count the cycles of a history after ASTM E1049-85, by the package rainflow.

    Args:
        history: values, (n,), n >= 2.

    Raises:
        ValueError: the history is not such numbers.
    """
    import rainflow  # here, because few ask for it

    values = np.asarray(history, dtype=np.float64)
    if values.ndim != 1 or values.size < 2 or not np.isfinite(values).all():
        raise ValueError(f"`history` must be finite numbers, (n,) with n >= 2, got the shape {values.shape}.")
    moved = values[np.concatenate([[True], np.diff(values) != 0.0])]
    turns = np.flatnonzero(np.diff(np.sign(np.diff(moved))) != 0.0) + 1
    # Ends and turning points alone, for speed. The package counts the last value only if another follows; a repeated value is
    # no turning point.
    points = moved[np.unique([0, *turns, moved.size - 1])].tolist()
    rows = [row[:3] for row in rainflow.extract_cycles([*points, points[-1]])]
    ranges, means, counts = np.array(rows, dtype=np.float64).reshape(-1, 3).T
    return Cycles(ranges=ranges, means=means, counts=counts)


@dataclass(frozen=True, kw_only=True, eq=False, repr=False)
class DamageSpectrum(Brief):
    """Damage to oscillators of quality `q` on a base that moves with an acceleration."""

    frequencies: Array  # of the oscillators [Hz], (n,)
    damage: Array  # Miner's sum with N = C / A^b and C = 1, A being amplitudes of the pseudo-velocity [m/s], (n,)
    exponent: float  # b
    q: float  # amplification at resonance, 1 / (2 damping ratio)


def fatigue_damage_spectrum(
    time: ArrayLike, acceleration: ArrayLike, *, exponent: float, frequencies: ArrayLike | None = None, q: float = 10.0
) -> DamageSpectrum:
    """Compute the fatigue damage spectrum of a sampled acceleration.

    The oscillators start at rest and are solved exactly for an acceleration that is straight between the samples, as for shock
    response spectra; cycles of the samples are counted by the rainflow method. Free vibration after the last
    sample is not counted.

    Args:
        time: uniform instants [s], (n,).
        acceleration: of the base [m/s^2], (n,).
        exponent: b of the fatigue curve N S^b = constant, S the amplitude of a cycle.
        frequencies: of the oscillators [Hz], (n_f,); without them six to an octave, from one over the record's length to a
            fortieth of the sampling rate. Missed peaks between the samples lower amplitudes by some 5 % at a tenth of the
            sampling rate, 1 % at a twentieth, and the damage by b times as much.
        q: amplification at resonance, > 0.5.

    Raises:
        ValueError: an argument is out of its range, or a frequency above a tenth of the sampling rate, from where on turning
            points between the samples are missed.
    """
    values, step = check_samples(time, acceleration)
    b, quality = positive("exponent", exponent), positive("q", q)
    if values.ndim != 1 or quality <= 0.5:
        raise ValueError("`acceleration` must be one history, (n,), and `q` above 0.5.")
    highest = 1.0 / (SAMPLES_PER_PERIOD * step)
    if frequencies is None:
        top = 0.25 * highest
        at = octave_grid(min(1.0 / (step * (values.size - 1)), top), top, per_octave=6)
    else:
        at = np.atleast_1d(np.asarray(frequencies, dtype=np.float64))
        if at.ndim != 1 or not (np.isfinite(at).all() and (at > 0.0).all() and at.max() <= highest * (1.0 + 1e-9)):
            raise ValueError(f"`frequencies` must be numbers > 0 up to {highest:.6g} Hz, a tenth of the sampling rate.")
    damage = []
    for frequency, matrices in zip(at, ramp_steps(2.0 * math.pi * at * step, 0.5 / quality), strict=True):
        # The two states of a step u, v -> A (u, v) + b0 x + b1 x' as one recursion of second order in u over the step squared.
        (a11, a12, b01, b11), (a21, a22, b02, b12) = matrices
        above = np.array([b11, b01 - a22 * b11 + a12 * b12, a12 * b02 - a22 * b01])
        below = np.array([1.0, -(a11 + a22), a11 * a22 - a12 * a21])
        at_rest = values[0] * np.array([-b11, b01 - above[1]])  # the first sample moves nothing yet
        deflection = np.asarray(scipy.signal.lfilter(above, below, values, zi=at_rest)[0])
        damage.append(rainflow_cycles(2.0 * math.pi * frequency * step**2 * deflection).damage(b))
    return DamageSpectrum(frequencies=at, damage=np.array(damage), exponent=b, q=quality)


EXAMPLE = "rack 3600 s 5 to 80 Hz z"
# Least points of a density to an octave, lines of damage between two points, and ratios of narrowest and widest band
_PER_OCTAVE, _LINES, _NARROWEST, _WIDEST = 6, 4, 2.0 ** (1 / 3), 2.0**12
# Playings (seeds) by which a density is tried, most periods of its highest frequency in a playing, and samples to a period
_PLAYINGS, _LONGEST, _SAMPLES = 8, 4000.0, 40.0


@dataclass(frozen=True, kw_only=True)
class EquivalentVibration:
    """A density of random vibration with the damage spectrum of a history."""

    # subject, along: body, point or base of the history, and its direction
    subject: str
    along: str
    duration: float  # of the vibration [s]
    points: Points  # frequency [Hz] and level [(m/s^2)^2/Hz]; zero outside
    # frequency [Hz] and damage of the density over that of the history, on finer lines: the least of all playings, or without
    # playings the expected one
    damage: Points
    ramps: tuple[float, float]  # rise and fall within the duration [s]
    playings: int  # number of playings from rise to fall by which it was tried; 0: too long to play
    # exponent, q: of the damage spectrum
    exponent: float
    q: float

    @property
    def rms(self) -> float:
        """Rms acceleration [m/s^2]."""
        return psd_rms(self.points)

    @property
    def extremes(self) -> tuple[tuple[float, float], tuple[float, float]]:
        """Smallest and largest ratio of this damage spectrum to that of the history, each with its frequency [Hz]."""
        return min(self.damage, key=itemgetter(1)), max(self.damage, key=itemgetter(1))


def equivalent_vibration(response: Response, text: str, *, exponent: float) -> EquivalentVibration:
    """Find the random vibration that does the damage of a run, by N = C / A^b, at a body, a point or the base; text: `EXAMPLE`.

    ValueError if the text is not understood, there is no such body or point, or the samples are too few.
    """
    subject, rest = site_first(text, Path())
    known = {name: subject.acceleration for name, subject in (*response.bodies.items(), *response.points.items())}
    known["base"] = response.base.acceleration
    try:
        if subject not in known:
            raise ValueError(f"the run has no body or point {subject!r}; it has {', '.join(known)}.")
        phrase = parse_phrase(rest, words={"q": ""})
        counts = {name: len(values) for name, values in phrase.quantities.items()}
        if counts != {"time": 1, "frequency": 2} or len(phrase.directions) != 1:
            raise ValueError("one time, two frequencies and one direction must stand there.")
        low, high = phrase.quantities["frequency"]
        q, duration = phrase.named.get("q", 10.0), phrase.one("time")
        history = known[subject] @ unit_vector(phrase.directions[0])
        if not _NARROWEST * low <= high <= _WIDEST * low:
            raise ValueError("the frequencies must be a third of an octave to twelve octaves apart, the lower first.")
        intervals = math.ceil(_PER_OCTAVE * math.log2(high / low) - 1e-9)
        at = np.geomspace(low, high, _LINES * intervals + 1)
        damage = fatigue_damage_spectrum(response.time, history, exponent=exponent, q=q, frequencies=at).damage
        motion = RandomVibration(psd=[(low, 1.0), (high, 1.0)], duration=duration, seed=0, direction="z")
        rising = Envelope(start=0.0, stop=math.inf, rise=1.0, fall=0.0).derivatives(np.linspace(0.0, 1.0, 1001))[0]
        ramps = motion.rise + motion.fall
        at_level = duration - ramps * (1.0 - float(np.mean(rising**exponent)))  # time at full level with as much damage
        points, relative = equivalent_psd(at, damage, exponent=exponent, duration=at_level, q=q, every=_LINES)
        if playings := _PLAYINGS if duration * high <= _LONGEST else 0:
            step = max(float(np.median(np.diff(response.time))), 1.0 / (_SAMPLES * high))
            points, relative = _raise_levels(points, duration, step, (at, damage), exponent, q)
    except ValueError as error_of:
        raise ValueError(f'equivalent vibration "{text}": {error_of} It is written like "{EXAMPLE}".') from None
    return EquivalentVibration(
        subject=subject, along=direction_text(phrase.directions[0]), duration=duration, points=points,
        damage=tuple(zip(at.tolist(), relative.tolist(), strict=True)), ramps=(motion.rise, motion.fall), playings=playings,
        exponent=exponent, q=q,
    )  # fmt: skip


def _raise_levels(
    points: Points, duration: float, step: float, wanted: tuple[Array, Array], exponent: float, q: float
) -> tuple[Points, Array]:
    """Raise a density's levels until each simulated history (playing) does the wanted damage; returns also damage over it.

    A density determines the mean damage of many playings. A playing of seconds has few lines in the width of an oscillator,
    begins at rest, and its largest cycles are rare, the more so the larger the exponent is.
    """
    at, damage = wanted
    time = step * np.arange(math.floor(duration / step) + 1)
    corners, levels = np.transpose(points)

    def least_played() -> Array:
        psd = np.column_stack([corners, levels]).tolist()
        histories = (
            RandomVibration(psd=psd, duration=duration, seed=seed, direction="z").acceleration(time)[:, 2]
            for seed in range(_PLAYINGS)
        )
        done = [fatigue_damage_spectrum(time, x, exponent=exponent, q=q, frequencies=at).damage for x in histories]
        return np.asarray(np.min(done, axis=0) / damage)

    least = scipy.ndimage.minimum_filter1d(least_played(), _LINES + 1, mode="nearest")[::_LINES]
    levels = levels * np.minimum(least, 1.0) ** (-2.0 / exponent)
    relative = least_played()
    lack = min(1.0, float(relative.min()))  # damage goes with the level to the power b / 2
    levels = levels * lack ** (-2.0 / exponent)
    return tuple(zip(corners.tolist(), levels.tolist(), strict=True)), relative / lack
