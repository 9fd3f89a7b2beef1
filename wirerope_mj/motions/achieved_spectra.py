"""Required and achieved response spectra of a base motion, its strong motion, and how independent its axes are."""

import math
from collections.abc import Sequence
from dataclasses import dataclass
from itertools import combinations

import numpy as np
import scipy

from wirerope_mj.foundation.arrays import Array
from wirerope_mj.foundation.budget import require_memory
from wirerope_mj.foundation.directions import AXES, direction_text
from wirerope_mj.foundation.summary import Brief
from wirerope_mj.motions.motion import BaseMotion, TargetSpectrum
from wirerope_mj.motions.spectra import shock_response_spectrum
from wirerope_mj.motions.spectrum_match import FINE_PER_OCTAVE, interpolated

SAMPLES_PER_PERIOD = 20.0  # samples in a period of the highest frequency: twice what ISO 18431-4 asks for
STRONG = 0.25  # of the peak: strong motion lasts from the first to the last instant above, as IEEE 344 has it
ENERGY = 0.05, 0.95  # of the integral of the squared acceleration (Arias), between which the motion is significant
# segments (Welch's method) in the time while two motions are significant: the largest coherence of independent noise is then
# about 0.3. Fewer averages read a chance coherence: of one segment it is 1, whatever the motions.
SEGMENTS = 12


@dataclass(frozen=True, kw_only=True, repr=False)
class AchievedSpectrum(Brief):
    """Required and achieved response spectrum of a motion along one direction."""

    direction: str  #: such as "x" or "(1, 1, 0)"
    damping: float  #: damping ratio of the oscillators
    frequencies: Array  #: of the comparison [Hz], (n,), 192 to an octave over the required spectrum
    required: Array  #: absolute acceleration that is required [m/s^2], (n,)
    achieved: Array  #: absolute acceleration that the motion gives the oscillators [m/s^2], (n,)
    peak: float  #: largest acceleration of the motion, its zero-period acceleration [m/s^2]
    strong: tuple[float, float]  #: instants between which the acceleration exceeds a quarter of its peak [s]
    significant: tuple[float, float]  #: instants between which the Arias intensity rises from 5 to 95 % [s]

    @property
    def ratio(self) -> Array:
        """Achieved over required acceleration [-], (n,)."""
        return self.achieved / self.required

    @property
    def lowest(self) -> tuple[float, float]:
        """Lowest ratio of achieved to required acceleration [-], and its frequency [Hz]."""
        row = int(np.argmin(self.ratio))
        return float(self.ratio[row]), float(self.frequencies[row])


@dataclass(frozen=True, kw_only=True, repr=False)
class AxisPair(Brief):
    """How far the accelerations along two directions depend on each other while both are significant."""

    directions: tuple[str, str]
    correlation: float  #: coefficient without a delay, from -1 to 1
    largest_correlation: float  #: largest magnitude of the coefficient at any delay
    coherence: float  #: largest magnitude-squared coherence within both required spectra, from 0 to 1
    frequency: float  #: at which it is largest [Hz]
    resolution: float  #: of the coherence [Hz]


def achieved_spectra(motion: BaseMotion, *, until: float = math.inf) -> tuple[AchievedSpectrum, ...]:
    """Compute the achieved spectrum for each required spectrum of a motion's parts; () if none is required.

    The whole motion counts, up to the instant `until` [s]: what other parts add along a direction is achieved, too.
    """
    found = []
    for target, time, along in _histories(motion, until):
        axis = int(np.argmax(np.abs(target.direction)))
        on_axis = abs(target.direction[axis]) > 1.0 - 1e-9
        frequencies, required = interpolated(target.points, FINE_PER_OCTAVE)
        size, energy = np.abs(along), np.cumsum(along**2)
        strong = np.flatnonzero(size >= STRONG * size.max())[[0, -1]]
        significant = np.searchsorted(energy, np.array(ENERGY) * energy[-1])
        found.append(AchievedSpectrum(
            direction=AXES[axis] if on_axis else direction_text(tuple(map(float, target.direction))),  # type: ignore[arg-type]
            damping=target.damping, frequencies=frequencies, required=required,
            achieved=shock_response_spectrum(time, along, frequencies, q=0.5 / target.damping).maximax,
            peak=float(size.max()), strong=(float(time[strong[0]]), float(time[strong[1]])),
            significant=(float(time[significant[0]]), float(time[significant[1]])),
        ))  # fmt: skip
    return tuple(found)


def axis_pairs(motion: BaseMotion, spectra: Sequence[AchievedSpectrum], *, until: float = math.inf) -> tuple[AxisPair, ...]:
    """Compute how far the accelerations along the directions of required spectra depend on each other, for each pair.

    `spectra` is the result of `achieved_spectra`.

    Coherence by Welch's method: Hann windows over a twelfth of the time while both are significant, half overlapping.
    A motion that is too short for twelve periods of its lowest frequency tells nothing, and has no pair.
    """
    pairs = []
    histories = list(zip(_histories(motion, until), spectra, strict=True))
    for ((_, time, x), first), ((_, _, y), second) in combinations(histories, 2):
        begin = max(first.significant[0], second.significant[0])
        end = min(first.significant[1], second.significant[1])
        rows = (time >= begin) & (time <= end)
        step = float(time[1] - time[0])
        length = int(np.count_nonzero(rows) / SEGMENTS)
        low = max(first.frequencies[0], second.frequencies[0])
        high = min(first.frequencies[-1], second.frequencies[-1])
        if low >= high or length * step < 1.0 / low:
            continue
        a, b = x[rows] - x[rows].mean(), y[rows] - y[rows].mean()
        function = scipy.signal.correlate(a, b, method="fft") / math.sqrt(float(a @ a) * float(b @ b))
        frequency, coherence = scipy.signal.coherence(a, b, fs=1.0 / step, nperseg=length)
        band = np.flatnonzero((frequency >= low) & (frequency <= high))
        row = band[int(np.argmax(coherence[band]))]
        pairs.append(AxisPair(
            directions=(first.direction, second.direction), correlation=float(function[a.size - 1]),
            largest_correlation=float(np.abs(function).max()), coherence=float(coherence[row]),
            frequency=float(frequency[row]), resolution=1.0 / (length * step),
        ))  # fmt: skip
    return tuple(pairs)


def _histories(motion: BaseMotion, until: float) -> list[tuple[TargetSpectrum, Array, Array]]:
    """Return each required spectrum with instants [s], equal for all, and the accelerations along its direction [m/s^2]."""
    if not motion.targets:
        return []
    highest = max(target.points[-1][0] for target in motion.targets)
    lowest = min(target.points[0][0] for target in motion.targets)
    over = max((part.end for part in motion.parts if math.isfinite(part.end)), default=0.0) + 1.0 / lowest
    step = 1.0 / (SAMPLES_PER_PERIOD * highest)
    count = int(min(over, until) / step) + 1
    require_memory(f"the achieved spectrum over {min(over, until):.4g} s up to {highest:.4g} Hz", 80.0 * count, "Shorten it.")
    time = np.linspace(0.0, step * (count - 1), count)
    acceleration = motion.acceleration(time)
    return [(target, time, acceleration @ target.direction) for target in motion.targets]
