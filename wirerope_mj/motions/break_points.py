"""Few break points that envelop the spectrum of a measured record, as specifications print them.

Frequencies are those of the series R20 of ISO 3, a sixth of an octave apart, slopes whole decibels to an octave.
"""

import math
import warnings
from dataclasses import dataclass

import numpy as np

from wirerope_mj.foundation.arguments import integer
from wirerope_mj.foundation.arrays import Array
from wirerope_mj.foundation.directions import AXES
from wirerope_mj.foundation.errors import RecordWarning
from wirerope_mj.foundation.summary import Brief
from wirerope_mj.foundation.units import STANDARD_GRAVITY
from wirerope_mj.motions.psd_lines import Points, psd_level, psd_rms
from wirerope_mj.motions.records.reading import is_pulse, offset_of
from wirerope_mj.motions.records.record import Record
from wirerope_mj.motions.spectra import power_spectral_density, shock_response_spectrum
from wirerope_mj.motions.spectra.ramp import octave_grid
from wirerope_mj.motions.spectra.srs import LOWEST_FREQUENCY, SAMPLES_PER_PERIOD

R20 = (1.0, 1.12, 1.25, 1.4, 1.6, 1.8, 2.0, 2.24, 2.5, 2.8, 3.15, 3.55, 4.0, 4.5, 5.0, 5.6, 6.3, 7.1, 8.0, 9.0)
STEEPEST = 24.0  # slope [dB/octave]
STEP = 0.5  # of the levels that are tried [dB]; the curve is then lowered until it touches the spectrum
HEADROOM, DEEPEST = 6.0, 60.0  # levels that are tried above and below the largest line [dB]
GAIN = 0.25  # mean level by which more points must lower the envelope to be worth it [dB]
LINES_PER_OCTAVE = 24  # of a shock response spectrum
PASSED = 0.4  # fraction of the sampling rate up to which a density is used: usual anti-alias filters pass what lies below
FIRST_LINE = 2.0  # lowest frequency of a density that is used, in distances of lines: below it the mean was removed
QUIET = 1e-4  # fraction of the largest density below which the ends of a band hold nothing of the vibration
BESIDE = 1.12  # factor on the frequencies of the last lines that count: a step of R20


@dataclass(frozen=True, kw_only=True, repr=False)
class SpectrumEnvelope(Brief):
    """Break points whose curve, straight on logarithmic axes, lies on or above a measured spectrum within its band."""

    axis: str  #: "x", "y" or "z"
    points: Points  #: frequency [Hz] and density [(m/s^2)^2/Hz], or spectral acceleration [m/s^2]
    frequencies: Array  #: measured lines within the band [Hz], (n,)
    levels: Array  #: of the lines, in the unit of the points, (n,)
    q: float | None  #: of the oscillators of a shock response spectrum; None: a power spectral density
    resolution: float  #: of the density [Hz]; of a shock response spectrum lines to an octave
    degrees_of_freedom: float  #: of each density; NaN of a shock response spectrum

    @property
    def exceedances(self) -> int:
        """Number of measured lines above the curve."""
        return int(np.count_nonzero(self.levels > psd_level(self.points, self.frequencies)))

    @property
    def slopes(self) -> tuple[float, ...]:
        """Slopes between the points [dB/octave], (n - 1,)."""
        f, levels = np.array(self.points).T
        decibels = 10.0 if self.q is None else 20.0
        return tuple((decibels * np.diff(np.log10(levels)) / np.diff(np.log2(f))).tolist())

    @property
    def rms(self) -> tuple[float, float]:
        """Rms accelerations within the band, of the curve and of the measured lines [m/s^2]; only for a density."""
        return psd_rms(self.points), math.sqrt(float(np.trapezoid(self.levels, self.frequencies)))

    @property
    def mean_excess(self) -> float:
        """Mean distance of the curve above the measured lines [dB], over octaves."""
        ratios = np.log10(psd_level(self.points, self.frequencies) / self.levels)
        x = np.log2(self.frequencies)
        return (10.0 if self.q is None else 20.0) * float(np.trapezoid(ratios, x) / (x[-1] - x[0]))

    @property
    def text(self) -> str:
        """Table of the points in g, as `--psd` or `--spectrum` of `wirerope shock` read it."""
        unit, heading = (STANDARD_GRAVITY**2, "psd [g^2/Hz]") if self.q is None else (STANDARD_GRAVITY, "acceleration [g]")
        return "".join([f"frequency [Hz],{heading}\n", *(f"{f:.6g},{level / unit:.3g}\n" for f, level in self.points)])


def record_envelopes(
    record: Record, *, band: tuple[float, float] | None = None, most: int = 8, q: float | None = None,
    resolution: float | None = None,
) -> tuple[SpectrumEnvelope, ...]:  # fmt: skip
    """Envelop the spectrum of a record along each axis on which it moves by at most `most` break points.

    Args:
        record: of an acceleration.
        band: lowest and highest frequency [Hz]. None: of a density between the outermost lines within 40 dB of the largest one,
            from the second line to 0.4 of the rate; of a shock response spectrum from 1 Hz, or a tenth of one over the record's
            length, to a tenth of the rate.
        most: largest number of points; fewer where more would lower the envelope by less than 0.25 dB.
        q: of the oscillators, for the shock response spectrum (largest absolute acceleration); None: power spectral density
            by Welch's method.
        resolution: of the density [Hz]; None: that of 15 segments.

    Raises:
        ValueError: the record is too short, or the band is beyond what it holds.

    Warns:
        RecordWarning: a density was asked for of a pulse.
    """
    integer("most", most, least=2)
    time, axes = record.time, [axis for axis, column in enumerate(record.samples.T) if column.any()]
    rate = (time.size - 1) / float(time[-1] - time[0])
    envelopes = []
    for axis in axes:
        a, given = record.samples[:, axis], band
        if q is None:
            if is_pulse(a, offset_of(a)):
                warnings.warn(
                    f"{record.path}: along {AXES[axis]} it is a pulse and no vibration: a density spreads it over the length "
                    "of the record. Envelop its shock response spectrum (--srs).",
                    RecordWarning, stacklevel=2,
                )  # fmt: skip
            density = power_spectral_density(time, a, resolution=resolution)
            distance, degrees = density.resolution, density.degrees_of_freedom
            frequencies, levels = density.frequency[1:], density.density[1:]
            least, largest = FIRST_LINE * distance, 0.5 * rate
            loud = frequencies[(levels >= QUIET * levels.max()) & (frequencies >= least)]
            usual = max(loud[0] / BESIDE, least), min(loud[-1] * BESIDE, PASSED * rate)
        else:
            distance, degrees = LINES_PER_OCTAVE, math.nan
            least, largest = 0.1 * rate / (time.size - 1), rate / SAMPLES_PER_PERIOD
            usual = max(LOWEST_FREQUENCY, least), largest
        if given is None:
            inside = _nominal(*usual)
            if len(inside) < 2:
                raise ValueError(f"along {AXES[axis]} it holds {usual[0]:.4g} to {usual[1]:.4g} Hz alone; give a `band`.")
            given = inside[0], inside[-1]
        low, high = given
        if not least * (1.0 - 1e-9) <= low < high <= largest * (1.0 + 1e-9):
            held = f"{least:.4g} to {largest:.4g} Hz"
            raise ValueError(f"`band` must lie within {held}, which the record holds, got {low:g} to {high:g} Hz.")
        if q is not None:
            inner = octave_grid(low, high, per_octave=LINES_PER_OCTAVE)
            frequencies = np.unique([low, *inner[(inner > low) & (inner < high)], high])
            levels = shock_response_spectrum(time, a, frequencies, q=q).maximax
        rows = (frequencies >= low) & (frequencies <= high)
        if np.count_nonzero(rows) < 2:
            raise ValueError(f"`band` must hold two lines, {distance:.4g} Hz apart, got {low:g} to {high:g} Hz.")
        frequencies, levels = frequencies[rows], levels[rows]
        unit = STANDARD_GRAVITY ** (2 if q is None else 1)
        envelopes.append(SpectrumEnvelope(
            axis=AXES[axis], frequencies=frequencies, levels=levels, q=q, resolution=distance, degrees_of_freedom=degrees,
            points=break_points(frequencies, levels, given, most=most, amplitude=q is not None, unit=unit),
        ))  # fmt: skip
    return tuple(envelopes)


def break_points(
    frequencies: Array, levels: Array, band: tuple[float, float], *, most: int, amplitude: bool = False, unit: float = 1.0
) -> Points:
    """Find the lowest curve of at most `most` points on or above a spectrum, straight on logarithmic axes.

    All curves are tried whose points lie at the ends of the band and at frequencies of R20, at levels 0.5 dB apart, with slopes
    that are whole decibels to an octave within 0.25 dB at their end (dynamic programming). The lowest is that of the least
    mean level in decibels over octaves, so that an octave at which mounts are soft counts as much as one far above; it is
    lowered until it touches the spectrum. Levels are rounded up to three digits in `unit`.

    Args:
        frequencies: of the lines within the band [Hz], rising, (n,).
        levels: of the lines, at least one of them > 0, (n,).
        band: lowest and highest frequency [Hz].
        most: largest number of points.
        amplitude: whether a level is an amplitude, of which 20 dB are a factor of ten, and no density.
        unit: in which the points are printed, in that of the levels.
    """
    decibels = 20.0 if amplitude else 10.0
    low, high = band
    nodes = np.array([low, *(f for f in _nominal(low, high) if low * 1.06 < f < high / 1.06), high])
    places = np.log2(nodes)
    x, y = np.log2(frequencies), decibels * np.log10(np.maximum(levels, levels.max() * 1e-12))
    heights = float(y.max()) + np.arange(max(-DEEPEST, float(np.floor(y.min() - y.max()))), HEADROOM + STEP, STEP)
    last = np.searchsorted(x, places[1:], side="right")  # a line at a node belongs to both sides
    hulls = [_upper_hull(x[begin:end], y[begin:end]) for begin, end in zip(np.searchsorted(x, places[:-1]), last, strict=True)]

    # Costs of the best curves to every node and level by number of segments, and where their last segments begin.
    costs = np.full((most, nodes.size, heights.size), np.inf)
    costs[0, 0] = 0.0
    origins = np.zeros((2, *costs.shape), dtype=np.intp)
    for end in range(1, nodes.size):
        for begin in range(end):
            segments = _segments(np.concatenate(hulls[begin:end]), places[begin], places[end], heights)
            through = costs[:-1, begin, :, np.newaxis] + segments
            origin = through.argmin(axis=1)
            cost = np.take_along_axis(through, origin[:, np.newaxis], axis=1)[:, 0]
            better = cost < costs[1:, end]
            costs[1:, end][better] = cost[better]
            origins[0, 1:, end][better] = begin
            origins[1, 1:, end][better] = origin[better]
    lowest = costs[:, -1].min(axis=1)
    count = int(np.argmax(lowest <= lowest.min() + GAIN * (places[-1] - places[0])))
    node, level = nodes.size - 1, int(costs[count, -1].argmin())
    corners = [(node, level)]
    for number in range(count, 0, -1):
        node, level = origins[:, number, node, level]
        corners.append((node, level))
    chosen, rows = np.array(corners[::-1]).T
    spare = float((np.interp(x, places[chosen], heights[rows]) - y).min()) - 1e-9  # so that rounding leaves none above
    final = 10.0 ** ((heights[rows] - spare) / decibels) / unit
    return tuple((float(nodes[i]), _rounded_up(level) * unit) for i, level in zip(chosen, final, strict=True))


def _segments(lines: Array, begin: float, end: float, heights: Array) -> Array:
    """Return the areas [dB octave] under straight lines between all pairs of levels `heights` [dB], (k, k).

    They go from `begin` to `end` [octave], on or above all `lines` of the spectrum [octave, dB], (n, 2), with
    slopes of whole dB/octave; what is not allowed has an infinite area.
    """
    octaves, rise = end - begin, heights - heights[:, np.newaxis]
    off_whole = np.abs(rise - octaves * np.round(rise / octaves))
    allowed = (off_whole <= 0.5 * STEP) & (np.abs(rise) <= STEEPEST * octaves + 0.5 * STEP)
    part, y = (lines[:, 0] - begin) / octaves, lines[:, 1]
    at_start = part <= 0.0
    needed = ((y - heights[:, np.newaxis] * (1.0 - part)) / np.where(at_start, 1.0, part))[:, ~at_start]
    allowed &= heights >= needed.max(axis=1, initial=-np.inf)[:, np.newaxis] - 1e-9
    allowed &= (heights >= y[at_start].max(initial=-np.inf))[:, np.newaxis]
    return np.where(allowed, octaves * (heights[:, np.newaxis] - heights[0] + 0.5 * rise), np.inf)


def _upper_hull(x: Array, y: Array) -> Array:
    """Return the corners of the upper convex hull of points with rising x, (n, 2): a line above them is above all points."""
    kept: list[tuple[float, float]] = []
    for point in zip(x.tolist(), y.tolist(), strict=True):
        while len(kept) > 1:
            (x0, y0), (x1, y1) = kept[-2:]
            if (y1 - y0) * (point[0] - x0) > (point[1] - y0) * (x1 - x0):
                break
            kept.pop()
        kept.append(point)
    return np.array(kept).reshape(-1, 2)


def _nominal(low: float, high: float) -> list[float]:
    """Return the frequencies of R20 from `low` to `high` [Hz]."""
    decades = range(math.floor(math.log10(low)) - 1, math.ceil(math.log10(high)) + 1)
    series = (float(f"{first * 10.0**decade:.6g}") for decade in decades for first in R20)
    return [frequency for frequency in series if low * (1.0 - 1e-9) <= frequency <= high * (1.0 + 1e-9)]


def _rounded_up(level: float) -> float:
    step = 10.0 ** (math.floor(math.log10(level)) - 2)
    return float(f"{math.ceil(level / step) * step:.3g}")
