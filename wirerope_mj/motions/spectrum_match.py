"""A base motion with a given response spectrum: for earthquakes, which are prescribed by their spectrum alone."""

import math
from collections.abc import Sequence
from dataclasses import dataclass
from functools import cached_property

import numpy as np
import scipy

from wirerope_mj.foundation.arguments import finite, integer, positive
from wirerope_mj.foundation.arrays import Array, Entries
from wirerope_mj.foundation.budget import require_memory
from wirerope_mj.foundation.directions import Direction, checked_direction, unit_vector
from wirerope_mj.foundation.errors import ConvergenceError
from wirerope_mj.foundation.quantities import Phrase
from wirerope_mj.foundation.summary import Brief
from wirerope_mj.motions import ranges
from wirerope_mj.motions.envelope import Envelope, check_room, random_phases, uniform_numbers, usual_ramp
from wirerope_mj.motions.motion import BaseMotion
from wirerope_mj.motions.phrases import LASTING, SpokenMotion, file_first, vibration_arguments
from wirerope_mj.motions.psd_lines import Points, checked_points, spectrum_points
from wirerope_mj.motions.scaled import Scaled
from wirerope_mj.motions.spectra import shock_response_spectrum
from wirerope_mj.motions.vibration_lines import VibrationLines

FINE_PER_OCTAVE = 192  # frequencies to an octave at which an envelope is checked: dips between the lines may be 2 % wide
LINES_PER_OCTAVE = 12  # least number of lines, which are also the frequencies at which the spectrum is matched
# largest relative distance of the lines over the damping ratio; an oscillator's half-power band is 2 damping ratios wide, so
# at least one line lies within it. Twelve to an octave for 5 %.
SPACING_PER_DAMPING = 1.2
LEAST_DAMPING = 0.01  # smallest damping ratio of a spectrum that is matched; those of earthquakes are for 2 % to 10 %
SAMPLES_PER_PERIOD = 20  # samples in a period of the highest frequency: twice what the spectrum asks for
OF_A_SAMPLE = 16  # bytes of a line at an instant: its sine and cosine
ITERATIONS = 60  # corrections after which the search ends; most targets take 2 to 22
# added to the squared relative sensitivities, which are of order 1: a correction that gains little must not be large. With
# ten times as much or a tenth the search was seen to take two or three times as many corrections.
REGULARISATION = 1e-3
# largest distance of the lines in units of 1 over the length of the motion, ramps counted half. Lines that are much farther
# apart than a coherence resolves keep their relative phases from segment to segment: axes look coherent which are not.
APART = 6.0
# lines of different seeds lie at random in different thirds of the distance between two, so that motions along different axes
# have no line in common: lines of one frequency would be coherent whatever their phases. Seed 1 has the first, 2 the second.
SHIFTS = (0.0, 1 / 3, -1 / 3)
SCALINGS = 6  # corrections at the beginning by which every line is scaled as the oscillators beside it need
LARGEST_CORRECTION = 0.3  # relative excess that is removed at once: beyond, the response is not linear enough
FORGOTTEN = 1e-3  # fraction of an impulse response below which it does not matter for a correction
RIGID = 1e6  # natural frequency that stands for a rigid oscillator, over the highest of the comparison
AMPLIFIED = 1.25  # least highest level over the last one of a spectrum that states its zero-period acceleration


def too_steep(frequencies: Array, target: Array, damping: float) -> str:
    """Return a message about the flank of a target that is too steep for any motion, the worst one; "" if no flank is.

    Of all motions a steady sine at the frequency of one oscillator sets it the most apart from another: the amplifications
    |1 + 2 i zeta r| / |1 - r^2 + 2 i zeta r| of the two, r = sine's over oscillator's frequency, are the measure. The target is
    [m/s^2], (n,), at rising frequencies [Hz], (n,).
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


def zero_period_level(points: Points) -> float:
    """Find the zero-period acceleration [m/s^2] of a spectrum that ends level, below its highest; 0 if it states none."""
    (_, before), (_, last) = points[-2:]
    return last if math.isclose(before, last, rel_tol=1e-3) and AMPLIFIED * last <= max(level for _, level in points) else 0.0


_PHRASE: Entries = {
    "needs": {"time": 1}, "says_more": True, "words": LASTING | {"damping": "ratio"}, "needed_words": ("damping",),
    "begins": file_first(spectrum_points),
}  # fmt: skip


@dataclass(frozen=True, kw_only=True, repr=False)
class SpectrumMatch(Brief):
    """A motion and how well its response spectrum meets the target."""

    phrases = (
        SpokenMotion(
            name="spectrum", example="floor.csv 20 s x damping 5 % seed 1",
            summary='a motion with the response spectrum of a file with "frequency [Hz], acceleration [g]".', **_PHRASE,
            make=lambda _, *arguments: _matched(*arguments).motion,
        ),
        SpokenMotion(
            name="required-spectrum", example="rrs.csv 30 s x damping 5 % seed 1",
            summary="the same, its spectrum nowhere below that of the file, as IEEE 344 and GR-63 ask.", **_PHRASE,
            make=lambda _, *arguments: _matched(*arguments).enveloping,
        ),
    )  # fmt: skip

    motion: VibrationLines  #: the motion: lines between a rise from rest and a fall back to it
    points: Points  #: of the target, frequency [Hz] and absolute acceleration [m/s^2]
    frequencies: Array  #: frequencies of the comparison [Hz], (n,), at least twelve to an octave
    target: Array  #: absolute acceleration asked for [m/s^2], (n,)
    achieved: Array  #: absolute acceleration of the motion's response spectrum [m/s^2], (n,)
    damping: float  #: damping ratio of the oscillators
    iterations: int  #: corrections that were made

    @property
    def mismatch(self) -> Array:
        """Achieved over target acceleration, less one, (n,)."""
        return self.achieved / self.target - 1

    @cached_property
    def enveloping(self) -> BaseMotion:
        """Motion scaled to the lowest level whose spectrum lies nowhere below the target, at 192 frequencies an octave.

        That a test spectrum envelops the required one is the rule of IEEE 344 and of GR-63.
        """
        fine, wanted = interpolated(self.points, FINE_PER_OCTAVE)
        time = np.arange(self.motion.start, self.motion.end, 1.0 / (SAMPLES_PER_PERIOD * fine[-1]))
        history = self.motion.acceleration(time) @ unit_vector(self.motion.direction)
        found = shock_response_spectrum(time, history, fine, q=0.5 / self.damping).maximax
        return Scaled(motion=self.motion, factor=float((wanted / found).max()))

    @property
    def largest_mismatch(self) -> float:
        """Largest magnitude of the mismatch."""
        return float(np.abs(self.mismatch).max())


def match_spectrum(
    target: Sequence[Sequence[float]], *, duration: float, seed: int, direction: str | Sequence[float],
    damping: float = 0.05, tolerance: float = 0.02, rise: float | None = None, fall: float | None = None,
    start: float = 0.0,
) -> SpectrumMatch:  # fmt: skip
    """Return a base motion whose response spectrum is the target within the tolerance.

    The motion is a sum of sines with random phases between a smooth rise and fall, so that base velocity and displacement start
    and end at zero: at least twelve to an octave (more for damping below 5 %), and so many more that they lie closer than six
    over the motion's length, each at random within its part of the band. Of three consecutive seeds no two have a line in
    common, so that motions along x, y and z are independent. Sines and cosines are corrected together
    by the smallest change that, to first order, moves the largest response of every oscillator to its target at the
    instant where it occurs, until all spectral values are within the tolerance (the idea of Lilhanand and Tseng, with the
    motion's own lines for wavelets). A target that ends level, below its highest level, states its zero-period acceleration:
    the motion's peak is then corrected as well, to no less than that; where both cannot be met, the spectrum alone.
    The tolerance holds at the frequencies of the comparison and on both sides of the target; between them the spectrum of the
    motions seen left it by up to 10 %, a few by 15 %. So this is no envelope: where a standard asks for one, scale the motion
    by 1/(1 - largest_mismatch), or by more where it judges between those frequencies too.
    Above the last frequency the spectrum falls to the motion's largest acceleration. Let the target go on to the highest
    frequency that matters.

    Args:
        target: points (frequency [Hz], absolute acceleration [m/s^2]), straight on logarithmic axes between them.
        duration: length of the motion with rise and fall [s].
        seed: integer >= 0 that chooses the phases to begin with, and where the lines lie among the frequencies.
        direction: `"x"`, `"y"`, `"z"` or a 3-vector.
        damping: damping ratio of the spectrum's oscillators, 0.01 or more.
        tolerance: largest relative mismatch at the frequencies of the comparison.
        rise: length of the rise [s], at least a period of the lowest frequency; None: ten such periods, or a tenth of
            the duration if that is shorter.
        fall: the same for the fall.
        start: instant at which the motion begins [s].

    Raises:
        ValueError: an argument is out of its range.
        ConvergenceError: the tolerance was not reached.
    """
    points = checked_points("target", target, quantity="acceleration [m/s^2]")
    if not LEAST_DAMPING <= finite("damping", damping) < 1:
        raise ValueError(
            f"`damping` must be at least {LEAST_DAMPING} (less takes more lines than an earthquake is long enough to tell "
            f"apart) and below 1, got {damping!r}."
        )
    positive("tolerance", tolerance)
    checked_direction(direction)
    integer("seed", seed, least=0)
    length = ranges.length("duration", duration)
    frequencies, wanted = interpolated(points, max(LINES_PER_OCTAVE, math.log(2) / (SPACING_PER_DAMPING * float(damping))))
    ramps = ("rise", rise), ("fall", fall)
    first, last = (usual_ramp(name, value, lowest=float(frequencies[0]), duration=length) for name, value in ramps)
    check_room(length, first, last)
    # number of a line, ln(f) / ratio + f / spacing, which Wright's omega function inverts
    ratio, spacing = math.log(frequencies[1] / frequencies[0]), APART / (length - 0.5 * (first + last))
    begin, end = (math.log(f) / ratio + f / spacing for f in (float(frequencies[0]), float(frequencies[-1])))
    size = math.ceil(end - begin) + 1
    count = (length + 1 / frequencies[0]) * SAMPLES_PER_PERIOD * frequencies[-1]
    require_memory(
        f"matching a spectrum by {size} lines over {length:.4g} s up to {frequencies[-1]:.4g} Hz",
        OF_A_SAMPLE * count * size,
        "Use a shorter `duration`: an earthquake lasts some 20 s; or end the target at a lower frequency.",
    )
    number = np.linspace(begin, end, size) + SHIFTS[(seed - 1) % len(SHIFTS)]
    number += (uniform_numbers(seed, 2 * size)[size:] - 0.5) / len(SHIFTS)
    lines = spacing / ratio * scipy.special.wrightomega(ratio * number + math.log(ratio / spacing))
    first, last = (usual_ramp(name, value, lowest=float(lines[0]), duration=length) for name, value in ramps)
    envelope = Envelope(start=0.0, stop=length, rise=first, fall=last)
    try:
        peak = zero_period_level(points)
        found = _Matching(frequencies, wanted, float(damping), envelope, lines, peak).run(seed, tolerance)
    except ConvergenceError:
        if not peak:
            raise
        found = _Matching(frequencies, wanted, float(damping), envelope, lines, 0.0).run(seed, tolerance)
    amplitudes, achieved, iterations = found
    phases = np.arctan2(amplitudes[1], amplitudes[0]) - 2 * np.pi * lines * ranges.start("start", start)
    motion = VibrationLines(
        acceleration=list(zip(lines.tolist(), np.hypot(*amplitudes).tolist(), strict=True)),
        phases=phases.tolist(), direction=direction, duration=length, rise=first, fall=last, start=start, target=points,
        damping=damping,
    )  # fmt: skip
    return SpectrumMatch(
        motion=motion, points=points, frequencies=frequencies, target=wanted, achieved=achieved, damping=float(damping),
        iterations=iterations,
    )  # fmt: skip


def _matched(phrase: Phrase, direction: Direction, number: int, points: Points) -> SpectrumMatch:
    return match_spectrum(points, damping=phrase.named["damping"], **vibration_arguments(phrase, direction, number))


def interpolated(points: Points, per_octave: float) -> tuple[Array, Array]:
    """Return `per_octave` frequencies to an octave [Hz], and the levels interpolated between the points there, (n,)."""
    f, levels = np.array(points).T
    count = math.ceil(per_octave * math.log2(f[-1] / f[0]) - 1e-9) + 1
    frequencies = np.geomspace(f[0], f[-1], count)
    return frequencies, np.exp(np.interp(np.log(frequencies), np.log(f), np.log(levels)))


class _Matching:
    """Search for the amplitudes of lines, sines of fixed frequencies, whose response spectrum is the target.

    Sums go through einsum: on a machine that is busy, threads of a linear algebra library wait for each other for longer
    than these sums take.
    """

    def __init__(
        self, frequencies: Array, target: Array, damping: float, envelope: Envelope, lines: Array, peak: float
    ) -> None:
        """`peak` is the least acceleration that the base must reach [m/s^2]; 0: it need reach none."""
        self.frequencies, self.damping, self.lines, self.rigid = frequencies, damping, lines, peak > 0.0
        # the base itself is an oscillator of a frequency so high that its filter is 1
        self.target = np.append(target, peak) if self.rigid else target
        naturals = np.append(frequencies, RIGID * frequencies[-1]) if self.rigid else frequencies
        step = 1 / (SAMPLES_PER_PERIOD * frequencies[-1])
        # Oscillators may answer most after the end: they are watched for a period of the lowest.
        self.time = step * np.arange(math.ceil((envelope.stop + 1 / frequencies[0]) / step) + 1.0)
        # of unit sines and of unit cosines, as `VibrationLines` makes them, (2 n, n_t)
        factor, first, second = envelope.derivatives(self.time)
        self.units = np.empty((2, lines.size, self.time.size))
        for of_sine, of_cosine, omega in zip(*self.units, 2 * np.pi * lines, strict=True):
            sine, cosine = np.sin(omega * self.time), np.cos(omega * self.time)
            of_sine[:] = factor * sine - 2 * first * cosine / omega - second * sine / omega**2
            of_cosine[:] = factor * cosine + 2 * first * sine / omega - second * cosine / omega**2
        self.units = self.units.reshape(2 * lines.size, -1)
        self.filters = []  # ramp-invariant, of the oscillators' absolute acceleration (Smallwood 1981, ISO 18431-4)
        for natural in (2 * math.pi * naturals).tolist():
            decay, angle = math.exp(-damping * natural * step), natural * step * math.sqrt(1 - damping**2)
            c, s = decay * math.cos(angle), decay * math.sin(angle) / angle
            self.filters.append(([1 - s, 2 * (s - c), decay**2 - s], [1.0, -2 * c, decay**2]))
        impulse = np.zeros(self.time.size)
        impulse[0] = 1.0
        reach = -math.log(FORGOTTEN) / (2 * np.pi * naturals * damping * step)
        lengths = [math.ceil(length) + 1 for length in reach]
        pairs = zip(self.filters, lengths, strict=True)
        self.impulses = [scipy.signal.lfilter(*coefficients, impulse[:length]) for coefficients, length in pairs]

    def run(self, seed: int, tolerance: float) -> tuple[Array, Array, int]:
        """Correct amplitudes to match the target; return those of sines and cosines (2, n_lines), spectrum (n,) and count."""
        phases = random_phases(seed, self.lines.size)
        amplitudes = self.at_lines(self.target[: self.frequencies.size]) * np.sqrt(np.gradient(np.log(self.lines)))
        q = np.concatenate([amplitudes * np.cos(phases), amplitudes * np.sin(phases)])
        q *= np.median(self.target / np.abs(self.peaks(q)[1]))
        best = math.inf
        for iteration in range(ITERATIONS + 1):
            instants, values = self.peaks(q)
            excess = self.excess(values)
            worst = int(np.argmax(np.abs(excess)))
            if abs(excess[worst]) <= tolerance:
                achieved = self.spectrum(q)
                if np.abs(self.excess(achieved)).max() <= tolerance:
                    return q.reshape(2, -1), achieved[: self.frequencies.size], iteration
            if abs(excess[worst]) < best:
                best, farthest, reached = float(abs(excess[worst])), worst, float(abs(values[worst]))
            if iteration < SCALINGS:
                q *= np.tile(self.at_lines(1 / (1 + excess[: self.frequencies.size])), 2)
            else:
                limited = np.clip(excess, -LARGEST_CORRECTION, LARGEST_CORRECTION)
                q -= self.correction(q, instants, np.sign(values), limited)
        steep = too_steep(self.frequencies, self.target[: self.frequencies.size], self.damping)
        where = f"at {self.frequencies[farthest]:.4g} Hz" if farthest < self.frequencies.size else "in its peak"
        raise ConvergenceError(
            f"no motion of these lines meets the target within {100 * tolerance:.3g} %; the best of {ITERATIONS} corrections "
            f"was {100 * best:.3g} % away, farthest {where}: {reached:.4g} m/s^2 instead of "
            f"{self.target[farthest]:.4g}. " + (steep or "Try another `seed`, a longer `duration` or a larger `tolerance`.")
        )

    def at_lines(self, values: Array) -> Array:
        """Interpolate values at the frequencies of the comparison (n,) to the lines, (n_lines,)."""
        return np.interp(np.log(self.lines), np.log(self.frequencies), values)

    def excess(self, values: Array) -> Array:
        """Compute the relative excess of responses over the target, (n,); the base's peak counts only if it is too low."""
        excess = np.abs(values) / self.target - 1
        if self.rigid:
            excess[-1] = min(excess[-1], 0.0)
        return excess

    def acceleration(self, q: Array) -> Array:
        """Return the base's acceleration, (n_t,), for amplitudes `q` of all sines and then all cosines, (2 n_lines,)."""
        return np.einsum("j,jt->t", q, self.units)

    def spectrum(self, q: Array) -> Array:
        """Return the response spectrum of the amplitudes (2 n,), and the base's peak behind it where that counts, (n,)."""
        history = self.acceleration(q)
        spectrum = shock_response_spectrum(self.time, history, self.frequencies, q=1 / (2 * self.damping)).maximax
        return np.append(spectrum, np.abs(history).max()) if self.rigid else spectrum

    def peaks(self, q: Array) -> tuple[list[int], Array]:
        """Return the sample of the largest response of every oscillator, and that response, refined by a parabola, (n,)."""
        acceleration = self.acceleration(q)
        instants, values = [], []
        for coefficients in self.filters:
            response = scipy.signal.lfilter(*coefficients, acceleration)
            instant = int(np.argmax(np.abs(response)))
            value = response[instant]
            if 0 < instant < response.size - 1:
                before, after = response[instant - 1], response[instant + 1]
                value += (after - before) ** 2 / (8 * (2 * value - before - after))
            instants.append(instant)
            values.append(value)
        return instants, np.array(values)

    def correction(self, q: Array, instants: list[int], signs: Array, excess: Array) -> Array:
        """Return the smallest change of the amplitudes (2 n,) that removes the relative excess (n,), to first order."""
        gains = np.empty((self.target.size, q.size))
        for row, impulse, instant, sign in zip(gains, self.impulses, instants, signs, strict=True):
            first = max(instant + 1 - impulse.size, 0)
            kernel = impulse[: instant + 1 - first][::-1].copy()
            row[:] = sign * np.einsum("jt,t->j", self.units[:, first : instant + 1], kernel)
        size = np.tile(np.hypot(*q.reshape(2, -1)), 2)
        gains *= size / self.target[:, np.newaxis]
        normal = np.einsum("ij,kj->ik", gains, gains) + REGULARISATION * np.eye(self.target.size)
        return size * np.einsum("ij,i->j", gains, np.linalg.solve(normal, excess))
