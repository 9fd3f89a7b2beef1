"""A measured record at equal intervals, at another rate, continued beyond its ends, and with its baseline corrected."""

from dataclasses import replace
from fractions import Fraction
from pathlib import Path

import numpy as np

from wirerope_mj.foundation.arrays import Array
from wirerope_mj.foundation.errors import RecordError
from wirerope_mj.motions.records.reading import Reading, is_pulse, offset_of

# order of the linear prediction, and samples next to an end that it is fitted to: sixteen lines, a thousandth of the rate apart
_LAGS, _WINDOW = 32, 1000
_EXACT = 1e-10  # error of the prediction, as a fraction of the signal's power, at which it is good enough
# fraction of an interval by which an instant may be off without further reason: far below what a clock's jitter does
_ROUNDED = 1e-3
# the same for instants that are printed with few digits: with fewer still the sampling cannot be told from uneven one
_COARSE = 1 / 3
_REGULAR = 0.9  # fraction of equal intervals from which on the others are gaps in an even sampling
_GAP = 1.5  # usual intervals from which on a longer one is a gap
_FEWEST = 16  # samples below which a record was written by hand and means the straight lines between its corners
# usual intervals from which on nothing but a straight line is drawn between two samples: a curve would run away
_LONG_INTERVAL = 3.0
_FINEST = 8  # instants per usual interval at which an uneven record is interpolated, at most, before the filter
# anti-alias filter: attenuation from the Nyquist frequency up, and fraction of it up to which all passes
_STOP_DB, _PASS = 80.0, 0.8
_BLOCK = 100_000  # samples that are looked at together
# samples at equal intervals that are made of a record whose own are not, at most: so many, or so many for each of its own.
# Beyond, nine tenths of it would be straight lines, from a time stamp that is wrong.
_MOST_MADE, _MOST_TIMES = 1_000_000, 10
_LARGEST_FACTOR = 10_000  # of a change of rate, as a fraction: the filter has some fifty taps for each
BASELINES = ("none", "rest", "mean", "velocity", "highpass")
# of the Butterworth filter; it is run forward and backward, so that its gain is that of the fourth order, without phase
_FILTER_ORDER = 2
# periods of the cutoff by which a record is lengthened at either end, at rest, for the filter's answer, which comes before a
# shock as well as after it. It has died away there to 1e-4.
_QUIET = 2.0
# samples that may be added: a cutoff far below anything in a record would fill the memory with rest
_MOST_ADDED = 20_000_000


def extend(a: Array, count: int) -> Array:
    """Extend a signal (n,) by `count` predicted samples at both ends, (n + 2 count,).

    A pulse is mirrored, so that a filter takes nothing from its area even where it begins with the first sample. A vibration
    was cut out of a longer one and is continued by linear prediction (Burg): sines go on with their phase, noise dies away.
    """
    rest = offset_of(a)
    if is_pulse(a, rest):
        return np.pad(a, count, mode="reflect")
    before = _predict(a[:_WINDOW][::-1] - rest, count)[::-1]
    after = _predict(a[-_WINDOW:] - rest, count)
    return np.concatenate([before + rest, a, after + rest])


def _predict(a: Array, count: int) -> Array:
    """Return `count` samples that continue a signal, by linear prediction: Burg's method, whose filter is always stable."""
    from scipy.signal import lfilter, lfiltic

    weights = np.ones(1)  # 1 and those of the past in the error of prediction
    forward, backward = a[1:], a[:-1]
    enough = _EXACT * 2.0 * float(a @ a)
    for _ in range(min(_LAGS, a.size // 3)):
        power = float(forward @ forward + backward @ backward)
        if power <= enough:
            break  # more weights would hold nothing but rounding, and what they predict would grow
        reflected = float(np.clip(-2.0 * (forward @ backward) / power, -1.0, 1.0))  # beyond by rounding
        weights = np.append(weights, 0.0)
        weights = weights + reflected * weights[::-1]
        forward, backward = (forward + reflected * backward)[1:], (backward + reflected * forward)[:-1]
    state = lfiltic([1.0], weights, a[::-1][: weights.size - 1])
    return np.asarray(lfilter([1.0], weights, np.zeros(count), zi=state)[0])


def evenly_sampled(path: Path, reading: Reading, *, gaps: str) -> Reading:
    """Return the record of a file at equal intervals, with a warning if its samples had to be changed for it.

    RecordError says where there is a gap, unless `gaps` is "fill" (with straight lines), or which time stamp is far
    from all others.
    """
    time = reading.time
    step = float(time[-1] - time[0]) / (time.size - 1)
    blocks = (np.arange(first, min(first + _BLOCK, time.size)) for first in range(0, time.size, _BLOCK))  # needs no memory
    if max(float(np.abs(time[i] - (time[0] + step * i)).max()) for i in blocks) <= max(_ROUNDED * step, _rounding(time, step)):
        even_time = step * np.arange(float(time.size))
        even_time += time[0]
        return replace(reading, time=even_time)
    intervals = np.diff(time)
    usual = float(np.quantile(intervals, 0.5, method="lower"))
    count = float(time[-1] - time[0]) / usual
    if count > max(_MOST_MADE, _MOST_TIMES * time.size):
        longest = int(intervals.argmax())
        raise RecordError(
            f"{path}: its time goes from {time[longest]:.9g} to {time[longest + 1]:.9g} s in one row, where most are "
            f"{usual:.6g} s apart: at equal intervals, {time.size} samples would be {count:.3g}. Is a time stamp wrong? "
            "Correct it, or use what lies before or behind."
        )
    regular = np.abs(intervals - usual) <= max(_ROUNDED * usual, 2.0 * _rounding(time, usual))
    if np.mean(regular) >= _REGULAR and np.all(intervals[~regular] >= _GAP * usual):
        holes = np.flatnonzero(~regular)
        listed = [f"{time[hole]:.6g} to {time[hole + 1]:.6g} s" for hole in holes[:3]] + ["..."] * (holes.size > 3)
        missing = sum(round(float(time[hole + 1] - time[hole]) / usual) - 1 for hole in holes)
        text = f"{holes.size} {'gap' if holes.size == 1 else 'gaps'} ({', '.join(listed)}) of {missing} samples in all"
        if gaps != "fill":
            raise RecordError(
                f"{path}: the record has {text}, where others are {usual:.6g} s apart. Nobody knows how the base moved there: "
                'use what lies before or behind, or have them filled with straight lines, gaps="fill" (--gaps fill).'
            )
        even_time = np.linspace(time[0], time[-1], round(float(time[-1] - time[0]) / usual) + 1)
        return _interpolated(reading, even_time).warned(f"{text} filled with straight lines.")
    # curves, finer where samples are dense, then the filter
    fine = int(np.clip(np.ceil(usual / float(intervals.min())), 1, _FINEST))
    count = max(int(np.floor(float(time[-1] - time[0]) / usual * (1.0 + 1e-9))) + 1, 2)
    made = _curved(reading, time[0] + usual / fine * np.arange((count - 1) * fine + 1), usual)
    if fine > 1:
        made = replace(reading, time=made.time[::fine], samples=filtered(made.samples, 1, fine))
    return made.warned(
        f"the sampling is not uniform, its intervals lie between {intervals.min():.4g} and {intervals.max():.4g} s; "
        f"resampled at the usual interval, {usual:.6g} s, on curves through the samples: what has 0.15 periods an interval "
        "loses some 2 % of its height, at a quarter of a period some 10 %."
    )


def resample_record(reading: Reading, rate: float) -> Reading:
    """Return an evenly sampled record at another rate [Hz], through a zero-phase anti-alias filter.

    The filter (a Kaiser window, applied in polyphase form) passes what lies below 0.8 of the lower of the two Nyquist
    frequencies to 1e-4 and attenuates what lies above it by 80 dB. ValueError: the two rates are no fraction of integers up
    to 10 000.
    """
    step = float(reading.time[1] - reading.time[0])
    ratio = Fraction(rate * step).limit_denominator(_LARGEST_FACTOR)
    if ratio.numerator == 0 or ratio.numerator > _LARGEST_FACTOR or abs(float(ratio) / (rate * step) - 1.0) > 1e-6:
        raise ValueError(
            f"`resample` must be a simple fraction of the record's {1.0 / step:.9g} Hz, such as {0.5 / step:.9g}, got {rate!r}."
        )
    if ratio == 1:
        return reading
    made = len(reading.samples) * float(ratio)
    if made > max(_MOST_MADE * _MOST_TIMES, _MOST_TIMES * len(reading.samples)):
        raise ValueError(f"`resample` would make {made:.3g} samples of {len(reading.samples)}, got {rate!r}.")
    samples = filtered(reading.samples, ratio.numerator, ratio.denominator)
    time = reading.time[0] + step / float(ratio) * np.arange(len(samples))
    inside = time <= reading.time[-1] + 1e-9 * step
    if np.count_nonzero(inside) < 2:
        raise ValueError(
            f"`resample` leaves one sample of a record of {step * (len(reading.samples) - 1):.6g} s, got {rate!r}."
        )
    return replace(reading, time=time[inside], samples=samples[inside])


def filtered(samples: Array, up: int, down: int) -> Array:
    """Resample samples (n, k) to up / down of their rate by the filter of `resample_record`; the first keeps its instant."""
    from scipy.signal import firwin, kaiserord, resample_poly

    factor = max(up, down)
    taps, beta = kaiserord(_STOP_DB, (1.0 - _PASS) / factor)
    window = firwin(taps | 1, (1.0 + _PASS) / 2.0 / factor, window=("kaiser", beta))
    # As far as the filter reaches beyond the ends, in whole samples of both rates; of those the results are left out.
    blocks = -(-(taps // 2 + 1) // (up * down))
    first, count = blocks * up, -(-len(samples) * up // down)
    made = np.zeros((count, samples.shape[1]))
    for column, result in zip(samples.T, made.T, strict=True):
        if column.any():
            result[:] = resample_poly(extend(column, blocks * down), up, down, window=window)[first : first + count]
    return made


def _rounding(time: Array, step: float) -> float:
    """Return one unit of the last decimal place of printed instants [s], by the first thousand; 0 if too small or too large."""
    first = time[:1000] - time[0]
    for digits in range(10):
        scaled = first * 10.0**digits
        if np.all(np.abs(scaled - np.round(scaled)) < 1e-3):
            return float(10.0**-digits) if 10.0**-digits <= _COARSE * step else 0.0
    return 0.0


def _interpolated(reading: Reading, time: Array) -> Reading:
    columns = [np.interp(time, reading.time, column) for column in reading.samples.T]
    return replace(reading, time=time, samples=np.column_stack(columns))


def _curved(reading: Reading, time: Array, usual: float) -> Reading:
    """Interpolate a record at instants [s] on Akima's curves, which overshoot less than splines; straight where sparse."""
    from scipy.interpolate import Akima1DInterpolator

    straight = _interpolated(reading, time)
    if reading.time.size < _FEWEST:
        return straight
    interval = np.clip(np.searchsorted(reading.time, time, side="right") - 1, 0, reading.time.size - 2)
    dense = np.diff(reading.time)[interval] < _LONG_INTERVAL * usual
    for column, result in zip(reading.samples.T, straight.samples.T, strict=True):
        if column.any():
            result[dense] = Akima1DInterpolator(reading.time, column, method="makima")(time[dense], extrapolate=True)
    return straight


def without_baseline(time: Array, samples: Array, baseline: str, highpass: float | None) -> tuple[Array, Array]:
    """Return instants [s], (n,), and accelerations, (n, 3), minus a constant by `baseline`, or high-pass filtered.

    `baseline` is one of `BASELINES`; the filter has the gain one half at its cutoff `highpass`. Samples are changed in place,
    unless they are filtered: a record is then longer, by rest at both ends. ValueError: the cutoff is half the sampling rate
    or more, or lower than can be meant.
    """
    if highpass is not None:
        from scipy.signal import butter, sosfiltfilt

        step = float(time[-1] - time[0]) / (time.size - 1)
        if highpass >= (0.5 - 1e-9) / step:
            raise ValueError(f"`highpass` must be below half the sampling rate, {0.5 / step:.6g}, got {highpass!r}.")
        quiet = int(np.ceil(_QUIET / (highpass * step)))
        if 2 * quiet > _MOST_ADDED:
            raise ValueError(
                f"`highpass` must be at least {2.0 * _QUIET / (_MOST_ADDED * step):.3g} Hz at {1.0 / step:.6g} samples a "
                f"second, got {highpass!r}: the filter needs {_QUIET:g} of its periods at rest before and behind the record."
            )
        sections = butter(_FILTER_ORDER, highpass, "highpass", fs=1.0 / step, output="sos")
        longer = np.zeros((time.size + 2 * quiet, samples.shape[1]))
        for column, filtered in zip(samples.T, longer.T, strict=True):
            if column.any():
                # An offset that goes on for ever is nothing after the filter; taken off first, it makes no jump at the ends.
                filtered[quiet:-quiet] = column - offset_of(column)
                filtered[:] = sosfiltfilt(sections, filtered, padtype="constant", padlen=quiet)
        return time[0] + step * np.arange(len(longer)), longer
    for column in samples.T:
        if baseline == "rest":
            column -= offset_of(column)
        elif baseline == "mean":
            column -= column.mean()
        elif baseline == "velocity":
            # The trapezoidal rule at equal intervals, without the copies that it would make of a long record.
            gained = column.sum() - (column[0] + column[-1]) / 2.0
            column -= gained / (time.size - 1)
    return time, samples
