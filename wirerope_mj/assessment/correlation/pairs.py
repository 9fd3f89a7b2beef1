"""A measured channel and what the model says of it: the same quantity at the same instants, on one clock."""

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

_FINEST = 100  # largest denominator of a ratio of two rates; the instants in between are on a spline
_ONSET = 0.02  # of the base's largest acceleration, from which the event has begun
_FEWEST = 16  # instants that both must have

_WINDOWS, _SAME_COURSE = 12, 0.8  # parts of a channel whose lags are compared, and correlation from which they count
_LEAST_DRIFT = 0.05  # samples by which clocks must drift apart in all
_CLOCKS_APART, _SURE = 1e-3, 3.0  # most that two clocks' rates differ by; standard errors from which on they do at all

_FITS = 0.6  # correlation of a channel, or of its negative, from which it fits the model's
_TIED = 0.05  # correlations that are no farther apart do not tell two delays apart
_PERIODS = 2.0  # mean periods of the model's history that both must have at a delay
_NOTHING = 1e-12  # of the largest product of both energies, below which a rest holds nothing but rounding
_HELD = 0.4  # of the most energy that the run can have of a channel, which it must have at a delay
# ratio of the amplitudes of both within which a delay is likely, and beyond which no other one is beside it
_AS_LOUD, _ANOTHER = 1.5, 3.0
_STEADY = 0.05  # difference of the model's rms between delays from which on a vibration is not steady
_BESIDE = 0.25  # periods around a lag that is known in which a sign is sought: half a period later a vibration is its negative


@dataclass(frozen=True, kw_only=True, eq=False)
class Pair:
    """A channel as measured and as the model says, on the run's clock."""

    channel: MeasuredChannel  # as it was measured
    time: Array = field(repr=False)  # instants that both have [s], even, (n,)
    measured: Array = field(repr=False)  # values in SI there, (n,)
    model: Array = field(repr=False)  # values in SI there, (n,)

    @property
    def rate(self) -> float:
        return (self.time.size - 1) / float(self.time[-1] - self.time[0])


@dataclass(frozen=True, kw_only=True)
class Delay:
    """By how much a channel comes late."""

    value: float  # [s]; the measured history, or its negative, fits the model's best when it is moved earlier by so much
    correlation: float  # of what both have then, -1 to 1; below zero if upside down
    upside_down: bool  # whether it fits better with the other sign
    # another delay at which it or its negative fits alike [s]: of a vibration that dies away, whose beginning was not recorded,
    # neither sign nor delay can be known
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
    position = np.asarray(getattr(part, "position"))[:, axis]  # noqa: B009  of bodies and points alike
    return position if channel.absolute else position - base.displacement[:, axis]


def delay_of(response: Response, measured: Measured, channel: MeasuredChannel, *, around: float | None = None) -> Delay:
    """Find by how much a channel comes late: where what both have correlates most with the model's history, or its negative.

    The largest of the samples is refined by the parabola through the three values around it. `around` a delay [s] that other
    channels say, or that was stated, it is sought there first. Of a steady vibration the delay is the one at which both have
    most in common.
    """
    from scipy.signal import correlate, correlation_lags

    model, rate, (first, start) = _at_one_rate(response, measured, channel)
    values, history = first - first.mean(), model - model.mean()
    slope = float(np.linalg.norm(np.diff(history)))
    period = 2.0 * np.pi * float(np.linalg.norm(history)) / slope if slope else 0.0  # the mean one [samples]
    if not slope or not values.any():
        return Delay(value=0.0, correlation=0.0, upside_down=False)
    reach = max(_BESIDE * period, 1.0)
    lags = correlation_lags(values.size, history.size)
    begin, end = np.maximum(lags, 0), np.minimum(values.size, history.size + lags)
    common = end - begin
    held, mean = _moments(values, begin, end)
    of_model, mean_of_model = _moments(history, begin - lags, end - lags)
    products = correlate(values, history, mode="full", method="fft")
    least = min(max(_FEWEST, _PERIODS * period), values.size, history.size)
    counts = (common >= least) & (held >= _HELD * held.max())
    size = np.sqrt(np.maximum(held * of_model, _NOTHING * held.max() * of_model.max()))
    course = np.where(counts, (products - common * mean * mean_of_model) / size, 0.0)
    delays = lags / rate + (start - float(response.time[0]))

    def at(best: int, alike: int | None = None) -> Delay:
        sign = np.sign(course[best])
        inside = 0 < best < course.size - 1
        return Delay(
            value=float(delays[best]) + (_summit(sign * course[best - 1 : best + 2]) / rate if inside else 0.0),
            correlation=float(course[best]), upside_down=bool(course[best] < -_FITS),
            alike=None if alike is None else float(delays[alike]),
        )  # fmt: skip

    if around is not None:
        near = np.abs(delays - around) * rate <= reach
        known = int(np.where(near, np.abs(course), -1.0).argmax())
        if near.any() and abs(course[known]) > _FITS:
            return at(known)
    best = int(np.abs(course).argmax())
    if abs(course[best]) <= _FITS:
        return at(int(course.argmax()))
    size = np.abs(course)
    summit = np.r_[False, (size[1:-1] >= size[:-2]) & (size[1:-1] >= size[2:]), False]
    fits = np.flatnonzero(summit & (size >= size[best] - _TIED))
    louder = np.exp(0.5 * np.abs(np.log(held[[best, *fits]] / of_model[[best, *fits]])))  # larger over smaller amplitude
    if louder[0] < _AS_LOUD:
        fits = fits[louder[1:] < _ANOTHER]
    others = fits[np.abs(fits - best) > reach]
    if not others.size:
        return at(best)
    loudness = np.sqrt(of_model[fits] / common[fits])
    if loudness.min() > (1.0 - _STEADY) * loudness.max():
        return at(int(fits[products[fits].argmax()]))
    return at(best, int(others[size[others].argmax()]))


def _moments(values: Array, begin: Array, end: Array) -> tuple[Array, Array]:
    """Sum squares about their mean, and average, samples from `begin` to before `end`, (n,) each."""
    first, second = (np.concatenate([[0.0], np.cumsum(power)]) for power in (values, values**2))
    mean = (first[end] - first[begin]) / (end - begin)
    return second[end] - second[begin] - (end - begin) * mean**2, mean


def clock_of(response: Response, measured: Measured, channel: MeasuredChannel, *, delay: float) -> tuple[float, float]:
    """Find delay [s] and clock, the seconds of the run in a second of the measured clock, of a channel that is `delay` late.

    Of each part of the channel the cross-correlation with the model's is largest at a lag that grows with time if one clock
    gains on the other: a straight line through the lags, weighted with what the parts hold. Where its slope is not significant,
    or less than a twentieth of a sample in all, the clock stays 1.
    """
    start, clock = float(channel.time[0]) - delay, 1.0
    for _ in range(2):  # what is left of a drift after the first pass does not blur the second's lags
        pair = pair_of(response, measured, channel, delay=float(channel.time[0]) - start, clock=clock)
        slope, lag = _drift(pair)
        gained = 1.0 / (1.0 + slope)
        first = float(pair.time[0])
        start, clock = first + (start - first - lag / pair.rate) * gained, clock * gained
    return (float(channel.time[0]) - start, clock) if clock != 1.0 else (delay, 1.0)


def _drift(pair: Pair) -> tuple[float, float]:
    """Fit by how much lags grow with every sample, and the lag of the first [samples]; zeros where it is not significant."""
    from scipy.signal import correlate

    count, reach = pair.time.size, int(0.5 * _CLOCKS_APART * pair.time.size) + 2
    rows = []
    for part in np.array_split(np.arange(reach, count - reach), _WINDOWS):
        model, wide = pair.model[part], pair.measured[part[0] - reach : part[-1] + reach + 1]
        squares = np.cumsum(np.concatenate([[0.0], wide**2]))
        size = np.sqrt((squares[part.size :] - squares[: -part.size]) * (model @ model))
        course = correlate(wide, model, mode="valid", method="fft") / np.maximum(size, np.finfo(np.float64).tiny)
        best = int(course.argmax())
        if 0 < best < course.size - 1 and course[best] > _SAME_COURSE:
            lag = best - reach + _summit(course[best - 1 : best + 2])
            rows.append((float(part.mean()), lag, float(np.linalg.norm(model))))
    if len(rows) < _WINDOWS // 2:
        return 0.0, 0.0
    middles, lags, weights = np.array(rows).T
    (slope, lag), covariance = np.polyfit(middles, lags, 1, w=weights, cov=True)
    significant = abs(slope) > max(_SURE * float(np.sqrt(covariance[0, 0])), _LEAST_DRIFT / count)
    return (float(slope), float(lag)) if significant else (0.0, 0.0)


def _summit(three: Array) -> float:
    """Find the vertex of the parabola through a largest sample and its neighbours, from that sample [samples]."""
    before, largest, after = three
    bend = before - 2.0 * largest + after
    return 0.5 * float((before - after) / bend) if bend else 0.0


def pair_of(response: Response, measured: Measured, channel: MeasuredChannel, *, delay: float, clock: float = 1.0) -> Pair:
    """Bring a channel and the model's history to the instants that both have, at the coarser of their rates.

    What is finer is filtered (0.8 of the coarser's Nyquist frequency passes), then evaluated on a cubic spline. Displacements,
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

    model, rate, (values, start) = _at_one_rate(response, measured, channel)
    start -= delay
    step, began = 1.0 / rate, float(response.time[0])
    first = max(began, start)
    ended = start + (values.size - 1) * step * clock
    last = min(began + (model.size - 1) * step, ended)
    count = int((last - first) * rate * (1.0 + 1e-12)) + 1 if last > first else 0
    if count < _FEWEST:
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


def _at_one_rate(response: Response, measured: Measured, channel: MeasuredChannel) -> tuple[Array, float, tuple[Array, float]]:
    """Bring both to one rate: the model's samples, the rate [Hz], the channel's samples with the instant of the first [s]."""
    model = model_history(response, measured, channel)
    rate = (response.time.size - 1) / float(response.time[-1] - response.time[0])
    lower = min(rate, channel.rate)
    return coarser(model, rate, lower), lower, (coarser(channel.values, channel.rate, lower), float(channel.time[0]))


def coarser(values: Array, rate: float, lower: float) -> Array:
    """Filter samples at a rate down to one that is not above it [Hz]; the first stays where it is."""
    from scipy.interpolate import CubicSpline

    if rate <= lower * (1.0 + 1e-9):
        return values
    ratio = Fraction(lower / rate).limit_denominator(_FINEST)
    kept = filtered(values[:, np.newaxis], ratio.numerator, ratio.denominator)[:, 0]
    near = rate * float(ratio)
    if abs(near / lower - 1.0) < 1e-9:
        return kept
    count = int((kept.size - 1) / near * lower) + 1
    return np.asarray(CubicSpline(np.arange(kept.size) / near, kept)(np.arange(count) / lower))
