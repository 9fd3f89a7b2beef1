"""Equal intervals for a measured record: small jitter, gaps, uneven sampling, and another rate on request."""

from dataclasses import replace
from fractions import Fraction
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from wirerope_mj.foundation.arrays import Array
from wirerope_mj.foundation.errors import RecordError
from wirerope_mj.motions.records.ends import continued
from wirerope_mj.motions.records.reading import Reading

# fraction of an interval by which an instant may be off without further reason: far below what a clock's jitter does
_ROUNDED = 1e-3

# the same for instants that are printed with few digits: with fewer still the sampling cannot be told from uneven one
_COARSE = 1 / 3
_REGULAR = 0.9  # fraction of equal intervals from which on the others are gaps in an even sampling
_GAP = 1.5  # usual intervals from which on a longer one is a gap
_FEWEST = 16  # samples below which a record was written by hand and means the straight lines between its corners

# usual intervals from which on nothing but a straight line is drawn between two samples: a curve would run away
_FAR = 3.0
_FINEST = 8  # instants per usual interval at which an uneven record is interpolated, at most, before the filter

# anti-alias filter: attenuation from the Nyquist frequency up, and fraction of it up to which all passes
_STOP_DB, _PASS = 80.0, 0.8
_BLOCK = 100_000  # samples that are looked at together

# samples at equal intervals that are made of a record whose own are not, at most: so many, or so many for each of its own.
# Beyond, nine tenths of it would be straight lines, from a time stamp that is wrong.
_MOST_MADE, _MOST_TIMES = 1_000_000, 10
_LARGEST_FACTOR = 10_000  # of a change of rate, as a fraction: the filter has some fifty taps for each


def even(path: Path, reading: Reading, *, gaps: str) -> Reading:
    """Return the record at equal intervals, with a warning of what had to be done for it.

    Args:
        path: of the file, for messages.
        reading: as measured.
        gaps: "refuse": a gap is an error; "fill": it is filled with a straight line.

    Raises:
        RecordError: there is a gap, or a time stamp far from all others.
    """
    time = reading.time
    step = float(time[-1] - time[0]) / (time.size - 1)
    if _largest_miss(time, step) <= max(_ROUNDED * step, _printed(time, step)):
        return replace(reading, time=_even_time(float(time[0]), step, time.size))
    intervals = np.diff(time)
    usual = float(np.quantile(intervals, 0.5, method="lower"))
    _require_few(path, time, intervals, usual)
    regular = np.abs(intervals - usual) <= max(_ROUNDED * usual, 2.0 * _printed(time, usual))
    if np.mean(regular) >= _REGULAR and np.all(intervals[~regular] >= _GAP * usual):
        return _without_gaps(path, reading, np.flatnonzero(~regular), usual, fill=gaps == "fill")
    return _evened(reading, usual, float(intervals.min())).warned(
        f"the sampling is not uniform, its intervals lie between {intervals.min():.4g} and {intervals.max():.4g} s; "
        f"resampled at the usual interval, {usual:.6g} s, on curves through the samples: what has 0.15 periods an interval "
        "loses some 2 % of its height, at a quarter of a period some 10 %."
    )


def _require_few(path: Path, time: Array, intervals: Array, usual: float) -> None:
    """Raise RecordError if a record at its usual interval would be far longer than what was measured."""
    count = float(time[-1] - time[0]) / usual
    if count <= max(_MOST_MADE, _MOST_TIMES * time.size):
        return
    longest = int(intervals.argmax())
    raise RecordError(
        f"{path}: its time goes from {time[longest]:.9g} to {time[longest + 1]:.9g} s in one row, where most are {usual:.6g} s "
        f"apart: at equal intervals, {time.size} samples would be {count:.3g}. Is a time stamp wrong? Correct it, or use what "
        "lies before or behind."
    )


def _largest_miss(time: Array, step: float) -> float:
    """Return how far the instants are from equal intervals [s], at most; block by block, to need no memory."""
    largest = 0.0
    for first in range(0, time.size, _BLOCK):
        block = time[first : first + _BLOCK]
        even_block = time[0] + step * np.arange(first, first + block.size)
        largest = max(largest, float(np.abs(block - even_block).max()))
    return largest


def _even_time(first: float, step: float, count: int) -> Array:
    time = np.arange(count, dtype=float)
    time *= step
    time += first
    return time


def resampled(reading: Reading, rate: float) -> Reading:
    """Return an evenly sampled record at another rate [Hz], through a zero-phase anti-alias filter.

    The filter (a Kaiser window, applied in polyphase form) passes what lies below 0.8 of the lower of the two Nyquist
    frequencies to 1e-4 and attenuates what lies above it by 80 dB.

    Raises:
        ValueError: the two rates are no fraction of integers up to 10 000.
    """
    step = float(reading.time[1] - reading.time[0])
    ratio = Fraction(rate * step).limit_denominator(_LARGEST_FACTOR)
    if ratio.numerator == 0 or ratio.numerator > _LARGEST_FACTOR or abs(float(ratio) / (rate * step) - 1.0) > 1e-6:
        raise ValueError(
            f"`resample` must be a simple fraction of the record's {1.0 / step:.9g} Hz, such as "
            f"{0.5 / step:.9g}, got {rate!r}."
        )
    if ratio == 1:
        return reading
    made = len(reading.samples) * float(ratio)
    if made > max(_MOST_MADE * _MOST_TIMES, _MOST_TIMES * len(reading.samples)):
        raise ValueError(f"`resample` would make {made:.3g} samples of {len(reading.samples)}, got {rate!r}.")
    samples = _filtered(reading.samples, ratio.numerator, ratio.denominator)
    time = reading.time[0] + step / float(ratio) * np.arange(len(samples))
    inside = time <= reading.time[-1] + 1e-9 * step
    if np.count_nonzero(inside) < 2:
        raise ValueError(
            f"`resample` leaves one sample of a record of {step * (len(reading.samples) - 1):.6g} s, got {rate!r}."
        )
    return replace(reading, time=time[inside], samples=samples[inside])


def _filtered(samples: Array, up: int, down: int) -> Array:
    from scipy.signal import firwin, kaiserord, resample_poly

    most = max(up, down)
    taps, beta = kaiserord(_STOP_DB, (1.0 - _PASS) / most)
    window = firwin(taps | 1, (1.0 + _PASS) / 2.0 / most, window=("kaiser", beta))
    # As far as the filter reaches beyond the ends, in whole samples of both rates; of those the results are left out.
    blocks = -(-(taps // 2 + 1) // (up * down))
    first, count = blocks * up, -(-len(samples) * up // down)
    made = np.zeros((count, samples.shape[1]))
    for column, result in zip(samples.T, made.T, strict=True):
        if column.any():
            result[:] = resample_poly(continued(column, blocks * down), up, down, window=window)[first : first + count]
    return made


def _printed(time: Array, step: float) -> float:
    """Return the last decimal place of the instants [s], as far as the first thousand show it; 0 if it explains nothing."""
    first = time[:1000] - time[0]
    for digits in range(10):
        scaled = first * 10.0**digits
        if np.all(np.abs(scaled - np.round(scaled)) < 1e-3):
            return float(10.0**-digits) if 10.0**-digits <= _COARSE * step else 0.0
    return 0.0


def _without_gaps(path: Path, reading: Reading, gaps: NDArray[np.intp], usual: float, *, fill: bool) -> Reading:
    """Return the record with straight lines in its gaps, or raise RecordError."""
    time = reading.time
    listed = [f"{time[gap]:.6g} to {time[gap + 1]:.6g} s" for gap in gaps[:3]] + ["..."] * (gaps.size > 3)
    missing = sum(round(float(time[gap + 1] - time[gap]) / usual) - 1 for gap in gaps)
    text = f"{gaps.size} {'gap' if gaps.size == 1 else 'gaps'} ({', '.join(listed)}) of {missing} samples in all"
    if not fill:
        raise RecordError(
            f"{path}: the record has {text}, where others are {usual:.6g} s apart. Nobody knows how the base moved there: "
            'use what lies before or behind, or have them filled with straight lines, gaps="fill" (--gaps fill).'
        )
    count = round(float(time[-1] - time[0]) / usual) + 1
    even_time = np.linspace(time[0], time[-1], count)
    return _at(reading, even_time).warned(f"{text} filled with straight lines.")


def _evened(reading: Reading, usual: float, shortest: float) -> Reading:
    """Return an uneven record at its usual interval: curves, finer where samples are dense, then the filter."""
    time = reading.time
    fine = int(np.clip(np.ceil(usual / shortest), 1, _FINEST))
    count = max(int(np.floor(float(time[-1] - time[0]) / usual * (1.0 + 1e-9))) + 1, 2)
    finely = _curved(reading, time[0] + usual / fine * np.arange((count - 1) * fine + 1), usual)
    if fine == 1:
        return finely
    return replace(reading, time=finely.time[::fine], samples=_filtered(finely.samples, 1, fine))


def _at(reading: Reading, time: Array) -> Reading:
    columns = [np.interp(time, reading.time, column) for column in reading.samples.T]
    return replace(reading, time=time, samples=np.column_stack(columns))


def _curved(reading: Reading, time: Array, usual: float) -> Reading:
    """Return the record on Akima's curves, which swing less beside a step than splines; lines where it is sparse."""
    from scipy.interpolate import Akima1DInterpolator

    straight = _at(reading, time)
    if reading.time.size < _FEWEST:
        return straight
    interval = np.clip(np.searchsorted(reading.time, time, side="right") - 1, 0, reading.time.size - 2)
    near = np.diff(reading.time)[interval] < _FAR * usual
    for column, result in zip(reading.samples.T, straight.samples.T, strict=True):
        if column.any():
            result[near] = Akima1DInterpolator(reading.time, column, method="makima")(time[near], extrapolate=True)
    return straight
