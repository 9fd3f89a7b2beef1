"""Pairs of a measured channel and the computed history: the same quantity at the same instants, on one clock."""

from collections.abc import Mapping
from dataclasses import dataclass, field
from fractions import Fraction

import numpy as np

from wirerope_mj.engine.response import Response
from wirerope_mj.foundation.arrays import Array
from wirerope_mj.foundation.errors import RecordError
from wirerope_mj.foundation.plain_text import short
from wirerope_mj.motions import Measured, MeasuredChannel
from wirerope_mj.motions.records.sampling import filtered

_LARGEST_DENOMINATOR = 100  # of a ratio of two sampling rates; the instants in between are on a spline
_ONSET = 0.02  # fraction of the base's largest acceleration from which the event has begun
_LEAST_COMMON = 16  # samples that both histories must have in common

_WINDOWS, _LAG_CORRELATION = 12, 0.8  # parts of a channel whose lags are compared, and correlation from which they count
_LEAST_DRIFT = 0.05  # samples by which clocks must drift apart in all
_LARGEST_DRIFT, _SIGNIFICANT = 1e-3, 3.0  # largest relative difference of two clocks; standard errors for a significant one

_FIT = 0.6  # correlation of a channel, or of its negative, from which it fits the model's
_TIE = 0.05  # difference of correlations below which they do not tell two delays apart
_PERIODS = 2.0  # mean periods of the model's history that both must have in common at a delay
_ROUNDING = 1e-12  # fraction of the largest product of both energies below which a common part is but rounding
_LEAST_ENERGY = 0.4  # fraction of a channel's largest energy within the run, which it must have at a delay
# ratio of the amplitudes of both within which a delay is likely, and beyond which no other delay competes with it
_LIKELY_RATIO, _UNLIKELY_RATIO = 1.5, 3.0
_STEADY = 0.05  # relative difference of the model's rms between delays from which on a vibration is not steady
_SIGN_SEARCH = 0.25  # periods around a known lag in which a sign is sought: half a period later a vibration is its negative


@dataclass(frozen=True, kw_only=True, eq=False)
class Pair:
    """Measured and computed history of a channel at common instants of the run's clock."""

    channel: MeasuredChannel  # as it was measured
    time: Array = field(repr=False)  # common instants [s], evenly spaced, (n,)
    measured: Array = field(repr=False)  # measured values, SI, (n,)
    model: Array = field(repr=False)  # computed values, SI, (n,)

    @property
    def rate(self) -> float:
        return (self.time.size - 1) / float(self.time[-1] - self.time[0])


@dataclass(frozen=True, kw_only=True)
class Delay:
    """Delay of a channel against the model's history, and the correlation of both."""

    value: float  # [s]; moved earlier by this, the measured history, or its negative, fits the model's best
    correlation: float  # of the common parts at this delay, -1 to 1; below zero if upside down
    upside_down: bool  # whether the channel fits better with the other sign
    # another delay at which the channel or its negative fits alike [s]: of a decaying vibration whose beginning was not
    # recorded neither sign nor delay can be known
    alike: float | None = None


def model_history(response: Response, measured: Measured, channel: MeasuredChannel) -> Array:
    """Read the calculated history of a channel off the response [SI], at the samples of the response, (n_t,).

    Raises:
        RecordError: the run does not have what the channel was measured at.
    """
    kind, _, name = channel.subject.partition("/")
    axis = "xyz".index(channel.axis)
    base, quantity = response.base, channel.quantity
    if kind == "base":
        return np.asarray(getattr(base, quantity))[:, axis]
    groups: Mapping[str, Mapping[str, object]] = {"body": response.bodies, "point": response.points, "mount": response.mounts}
    part = groups[kind].get(name)
    if part is None:
        known = ", ".join(groups[kind]) or "none"
        raise RecordError(
            f'{measured.path}: column "{channel.column}" is mapped to the {kind} {short(name)!r}, which this run does not '
            f"have; its {'bodies' if kind == 'body' else kind + 's'}: {short(known)}. Is it the run of another model?"
        )
    if quantity != "displacement":
        return np.asarray(getattr(part, quantity))[:, axis]
    position = np.asarray(getattr(part, "position"))  # noqa: B009  of bodies and points alike
    if channel.absolute or response.base_rotation is None:
        return position[:, axis] if channel.absolute else position[:, axis] - base.displacement[:, axis]
    return response.displacement_from_base(position, np.zeros(3))[:, axis]


def delay_of(response: Response, measured: Measured, channel: MeasuredChannel, *, around: float | None = None) -> Delay:
    """Find the delay at which a channel, or its negative, correlates most with the model's history over their common part.

    The largest sample of the correlation is refined by the parabola through it and its neighbours. With `around`, a delay [s]
    that was stated or found of other channels, it is sought there first. Of a steady vibration the delay with the largest
    product of both histories is taken.
    """
    from scipy.signal import correlate, correlation_lags

    model, rate, (first, start) = _resampled(response, measured, channel)
    values, history = first - first.mean(), model - model.mean()
    slope = float(np.linalg.norm(np.diff(history)))
    period = 2.0 * np.pi * float(np.linalg.norm(history)) / slope if slope else 0.0  # the mean one [samples]
    if not slope or not values.any():
        return Delay(value=0.0, correlation=0.0, upside_down=False)
    reach = max(_SIGN_SEARCH * period, 1.0)
    lags = correlation_lags(values.size, history.size)
    begin, end = np.maximum(lags, 0), np.minimum(values.size, history.size + lags)
    common = end - begin
    energy, mean = _moments(values, begin, end)
    model_energy, model_mean = _moments(history, begin - lags, end - lags)
    products = correlate(values, history, mode="full", method="fft")
    least = min(max(_LEAST_COMMON, _PERIODS * period), values.size, history.size)
    counts = (common >= least) & (energy >= _LEAST_ENERGY * energy.max())
    norm = np.sqrt(np.maximum(energy * model_energy, _ROUNDING * energy.max() * model_energy.max()))
    correlation = np.where(counts, (products - common * mean * model_mean) / norm, 0.0)
    delays = lags / rate + (start - float(response.time[0]))

    def delay_at(best: int, alike: int | None = None) -> Delay:
        """Refine the delay at a peak of the correlation by a parabola; `alike` is another peak that fits about as well."""
        sign = np.sign(correlation[best])
        inside = 0 < best < correlation.size - 1
        return Delay(
            value=float(delays[best]) + (_vertex(sign * correlation[best - 1 : best + 2]) / rate if inside else 0.0),
            correlation=float(correlation[best]), upside_down=bool(correlation[best] < -_FIT),
            alike=None if alike is None else float(delays[alike]),
        )  # fmt: skip

    if around is not None:
        near = np.abs(delays - around) * rate <= reach
        nearest = int(np.where(near, np.abs(correlation), -1.0).argmax())
        if near.any() and abs(correlation[nearest]) > _FIT:
            return delay_at(nearest)
    best = int(np.abs(correlation).argmax())
    if abs(correlation[best]) <= _FIT:
        return delay_at(int(correlation.argmax()))
    size = np.abs(correlation)
    is_peak = np.r_[False, (size[1:-1] >= size[:-2]) & (size[1:-1] >= size[2:]), False]
    peaks = np.flatnonzero(is_peak & (size >= size[best] - _TIE))
    ratios = np.exp(
        0.5 * np.abs(np.log(energy[[best, *peaks]] / model_energy[[best, *peaks]]))
    )  # larger over smaller amplitude
    if ratios[0] < _LIKELY_RATIO:
        peaks = peaks[ratios[1:] < _UNLIKELY_RATIO]
    others = peaks[np.abs(peaks - best) > reach]
    if not others.size:
        return delay_at(best)
    model_rms = np.sqrt(model_energy[peaks] / common[peaks])
    if model_rms.min() > (1.0 - _STEADY) * model_rms.max():
        return delay_at(int(peaks[products[peaks].argmax()]))
    return delay_at(best, int(others[size[others].argmax()]))


def _moments(values: Array, begin: Array, end: Array) -> tuple[Array, Array]:
    """Compute sums of squares about the mean, and means, of the samples from `begin` to before `end`, (n,) each."""
    first, second = (np.concatenate([[0.0], np.cumsum(power)]) for power in (values, values**2))
    mean = (first[end] - first[begin]) / (end - begin)
    return second[end] - second[begin] - (end - begin) * mean**2, mean


def clock_of(response: Response, measured: Measured, channel: MeasuredChannel, *, delay: float) -> tuple[float, float]:
    """Find delay [s] and clock, the seconds of the run in a second of the measured clock, from a first estimate `delay` [s].

    Of each part of the channel the cross-correlation with the model's is largest at a lag that grows with time if one clock
    gains on the other: a straight line is fitted to the lags, weighted with the norms of the parts. Where its slope is not
    significant, or less than a twentieth of a sample in all, the clock stays 1.
    """
    start, clock = float(channel.time[0]) - delay, 1.0
    for _ in range(2):  # the remaining drift after the first pass does not blur the lags of the second
        pair = pair_of(response, measured, channel, delay=float(channel.time[0]) - start, clock=clock)
        slope, lag = _drift(pair)
        gained = 1.0 / (1.0 + slope)
        first = float(pair.time[0])
        start, clock = first + (start - first - lag / pair.rate) * gained, clock * gained
    return (float(channel.time[0]) - start, clock) if clock != 1.0 else (delay, 1.0)


def _drift(pair: Pair) -> tuple[float, float]:
    """Fit a line to the lags of a pair: growth per sample, and lag at the first sample [samples]; zeros if not significant."""
    from scipy.signal import correlate

    count, reach = pair.time.size, int(0.5 * _LARGEST_DRIFT * pair.time.size) + 2
    rows = []
    for part in np.array_split(np.arange(reach, count - reach), _WINDOWS):
        model, wide = pair.model[part], pair.measured[part[0] - reach : part[-1] + reach + 1]
        squares = np.cumsum(np.concatenate([[0.0], wide**2]))
        size = np.sqrt((squares[part.size :] - squares[: -part.size]) * (model @ model))
        correlation = correlate(wide, model, mode="valid", method="fft") / np.maximum(size, np.finfo(np.float64).tiny)
        best = int(correlation.argmax())
        if 0 < best < correlation.size - 1 and correlation[best] > _LAG_CORRELATION:
            lag = best - reach + _vertex(correlation[best - 1 : best + 2])
            rows.append((float(part.mean()), lag, float(np.linalg.norm(model))))
    if len(rows) < _WINDOWS // 2:
        return 0.0, 0.0
    middles, lags, weights = np.array(rows).T
    (slope, lag), covariance = np.polyfit(middles, lags, 1, w=weights, cov=True)
    significant = abs(slope) > max(_SIGNIFICANT * float(np.sqrt(covariance[0, 0])), _LEAST_DRIFT / count)
    return (float(slope), float(lag)) if significant else (0.0, 0.0)


def _vertex(neighbours: Array) -> float:
    """Find the vertex of the parabola through a largest sample and its two neighbours, from that sample [samples]."""
    before, largest, after = neighbours
    bend = before - 2.0 * largest + after
    return 0.5 * float((before - after) / bend) if bend else 0.0


def pair_of(response: Response, measured: Measured, channel: MeasuredChannel, *, delay: float, clock: float = 1.0) -> Pair:
    """Resample a channel and the model's history at their common instants, at the lower of their sampling rates.

    The finer history is filtered (0.8 of the lower Nyquist frequency passes), then evaluated on a cubic spline. Displacements,
    deflections and forces are counted from the start: the model's from its first sample, the measured one's from its mean
    before the base begins to move, unless the map says "absolute".

    Args:
        response: of the run.
        measured: the test.
        channel: one of its channels.
        delay: by which the measured channel comes late [s].
        clock: seconds of the run in a second of the measured clock.

    Raises:
        RecordError: there are fewer than 16 instants that both have.
    """
    from scipy.interpolate import CubicSpline

    model, rate, (values, start) = _resampled(response, measured, channel)
    start -= delay
    step, began = 1.0 / rate, float(response.time[0])
    first = max(began, start)
    ended = start + (values.size - 1) * step * clock
    last = min(began + (model.size - 1) * step, ended)
    count = int((last - first) * rate * (1.0 + 1e-12)) + 1 if last > first else 0
    if count < _LEAST_COMMON:
        raise RecordError(
            f'{measured.path}: column "{channel.column}" lasts from {start:.6g} to {ended:.6g} s of '
            f"the run's clock, the run from {began:.6g} to {response.time[-1]:.6g} s: too short to compare. Say when its first "
            "sample was taken, start (--start)."
        )
    time = np.asarray(first + step * np.arange(count), dtype=np.float64)
    measurement = CubicSpline(start + step * clock * np.arange(values.size), values)(time)
    computed = CubicSpline(began + step * np.arange(model.size), model)(time)
    if channel.counts_from_start:
        computed = computed - model[0]
        size = np.linalg.norm(response.base.acceleration, axis=1)
        onset = float(response.time[int(np.argmax(size > _ONSET * size.max()))]) if size.any() else began
        before = time < onset
        measurement = measurement - measurement[before].mean() if before.any() else measurement
    return Pair(channel=channel, time=time, measured=measurement, model=computed)


def _resampled(response: Response, measured: Measured, channel: MeasuredChannel) -> tuple[Array, float, tuple[Array, float]]:
    """Resample model and channel to the lower rate: model's samples, rate [Hz], channel's samples and first instant [s]."""
    model = model_history(response, measured, channel)
    rate = (response.time.size - 1) / float(response.time[-1] - response.time[0])
    lower = min(rate, channel.rate)
    return coarser(model, rate, lower), lower, (coarser(channel.values, channel.rate, lower), float(channel.time[0]))


def coarser(values: Array, rate: float, lower: float) -> Array:
    """Filter samples down from `rate` to a lower or equal rate [Hz]; the first instant is kept."""
    from scipy.interpolate import CubicSpline

    if rate <= lower * (1.0 + 1e-9):
        return values
    ratio = Fraction(lower / rate).limit_denominator(_LARGEST_DENOMINATOR)
    kept = filtered(values[:, np.newaxis], ratio.numerator, ratio.denominator)[:, 0]
    kept_rate = rate * float(ratio)
    if abs(kept_rate / lower - 1.0) < 1e-9:
        return kept
    count = int((kept.size - 1) / kept_rate * lower) + 1
    return np.asarray(CubicSpline(np.arange(kept.size) / kept_rate, kept)(np.arange(count) / lower))
