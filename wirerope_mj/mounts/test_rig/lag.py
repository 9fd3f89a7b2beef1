"""Lag between the channels of a record, from what holds at every reversal of a rate-independent device.

Just before a reversal of the deflection, and just behind it, the force of such a device is a smooth function of the distance u
to the reversal, another one on either side, and both are the same force at u = 0. Its rate dF/dx dx/dt vanishes there from both
sides, wherever it bends next. A channel that lags shifts the instant by the lag. How far the two functions stay short
polynomials is the device's own: sliders that slip one after the other bend them early. So windows and degrees are tried, and a
wider window counts as far as it agrees with narrower ones (Goldenshluger and Lepski 2011).
"""

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
import scipy

from wirerope_mj.foundation.arrays import Array
from wirerope_mj.mounts.test_rig.turning import Trace, find_turning_points

_DEGREES = ((1, 1), (2, 2), (2, 3))  # of the polynomials in u before and behind a reversal
_WIDTHS = (0.012, 0.017, 0.024, 0.034, 0.048, 0.068, 0.096, 0.136, 0.19)  # of the period, to either side of a reversal
_FEWEST = 5  # samples of a window on either side
_MOST_SAMPLES = 300  # samples of a cycle that are fitted: more are averaged
_SHAPE = 0.06  # of the period, to either side, where a deflection's reversal is a parabola and a corner
_STROKE_RATIO = 0.05  # ratio by which strokes of one run may differ
_TURNS = 3  # reversals of a run at least
_GRID = np.linspace(-0.7, 0.7, 29)  # of a window's width: lags that are tried
_RISE = 9.0  # variances above the least misfit within which a lag fits as well
_MOVES = 8  # times that a window is moved to where the force turns round


@dataclass(frozen=True, kw_only=True)
class Lag:
    """Delay of the force behind the deflection at reversals, its standard error, and the period of the cycles [s]."""

    delay: float
    error: float
    period: float


@dataclass(frozen=True, kw_only=True)
class _Reversals:
    """Reversals of like strokes: instants [s], senses (1 at a top, else -1), by sense the deflection's shape there."""

    instants: Array
    senses: Array
    period: float
    shapes: dict[float, Array]


def lag_in(time: Array, deflection: Array, force: Array) -> Lag | None:
    """Find the lag between deflection [m] and force [N] at instants [s], (n,) each; None where few reversals are alike."""
    if np.ptp(deflection) == 0.0 or time.size < 12:
        return None
    trace = find_turning_points(deflection, time)
    if trace.turns.size < _TURNS + 2:
        return None
    samples = float(np.median(np.diff(trace.turns))) * 2.0
    if samples > 2.0 * _MOST_SAMPLES:
        count = int(samples // _MOST_SAMPLES)
        whole = time.size - time.size % count
        time, deflection, force = (values[:whole].reshape(-1, count).mean(axis=1) for values in (time, deflection, force))
        trace = find_turning_points(deflection, time)
    runs: list[list[int]] = [[]]  # of reversals between like strokes, those left out whose force came another way
    for index in range(2, trace.turns.size - 1):
        strokes = trace.strokes[index - 2 : index + 1]
        if np.ptp(strokes) > _STROKE_RATIO * strokes.mean() + 4.0 * trace.smooth_noise:
            runs.append([])
        else:
            runs[-1].append(index)
    lags = []
    for reversals in (_locate(trace, run) for run in runs if len(run) >= _TURNS):
        samples = reversals.period / float(np.median(np.diff(time)))  # of a cycle: a rig may pause between amplitudes
        widths = [width for width in _WIDTHS if width * samples >= _FEWEST] or [_FEWEST / samples]
        fits: list[tuple[float, int, float, float]] = []
        begin = 0.0
        for width in reversed(widths):  # a narrow window has to begin near the turn that it looks for
            for degrees in reversed(_DEGREES):
                if (fit := _fit_lag(reversals, time, force, width * reversals.period, degrees, begin)) is not None:
                    fits.append((width, sum(degrees), *fit))
                    begin = fit[0]
        best: Lag | None = None  # by the window and the degrees that noise and bend together disturb least
        for width, degree, delay, error in fits:
            # What fits that bend more freely differ by, over a window no wider, may be this one's bias, beyond what noise
            # makes: the variance of such a fit less that of this one, which is efficient if it has no bias (Hausman 1978).
            freer = [(delay_of, error_of) for w, n, delay_of, error_of in fits if w <= width and n >= degree]
            bias = max(abs(delay - delay_of) - np.sqrt(max(error_of**2 - error**2, 0.0)) for delay_of, error_of in freer)
            total = float(np.hypot(error, bias))
            if best is None or total < best.error:
                best = Lag(delay=delay, error=total, period=reversals.period)
        lags += [best] if best is not None else []
    if not lags:
        return None
    weights, delays = np.array([lag.error**-2.0 for lag in lags]), np.array([lag.delay for lag in lags])
    mean = float(weights @ delays / weights.sum())
    apart = float(weights @ (delays - mean) ** 2) / max(len(lags) - 1, 1)  # runs that differ by more than their errors
    error = float(np.sqrt(max(apart, 1.0) / weights.sum()))
    return Lag(delay=mean, error=error, period=lags[int(np.argmax(weights))].period)


def _locate(trace: Trace, run: Sequence[int]) -> _Reversals:
    """Locate the reversals of a run: minima and maxima of deflection, and the shape that both sides share."""
    period = 2.0 * float(np.median(np.diff(trace.times[run[0] - 1 : run[-1] + 2])))
    width = _SHAPE * period
    instants, senses = [], []
    shapes: dict[float, list[Array]] = {}
    for index in run:
        about = float(trace.times[index])
        near = np.flatnonzero(np.abs(trace.time - about) <= width)
        if near.size < 2 * _FEWEST - 2:
            samples = period / float(np.median(np.diff(trace.time)))
            near = np.flatnonzero(np.abs(trace.time - about) <= _FEWEST * period / max(samples, 1.0))
        sense = 1.0 if trace.smooth[trace.turns[index]] > trace.smooth[trace.turns[index - 1]] else -1.0
        since, values = (trace.time[near] - about) / width, -sense * trace.deflection[near]

        def corner(at: float, since: Array = since, values: Array = values) -> tuple[float, Array]:
            """Fit the factors of s, s^2 and s^4; return the residual sum of squares and the factors."""
            s = np.abs(since - at)
            matrix = np.stack([np.ones(s.size), s, s**2, s**4], axis=1)
            shape = np.linalg.lstsq(matrix, values, rcond=None)[0]
            return float(np.sum((matrix @ shape - values) ** 2)), shape[1:]

        grid = np.linspace(-0.3, 0.3, 13)
        best = int(np.clip(np.argmin([corner(at)[0] for at in grid]), 1, grid.size - 2))
        late = scipy.optimize.minimize_scalar(
            lambda at, corner=corner: corner(at)[0], bounds=(grid[best - 1], grid[best + 1]), method="bounded",
            options={"xatol": 1e-7},
        ).x  # fmt: skip
        instants.append(about + float(late) * width)
        senses.append(sense)
        shapes.setdefault(sense, []).append(corner(late)[1])
    return _Reversals(
        instants=np.array(instants), senses=np.array(senses), period=period,
        shapes={sense: np.mean(each, axis=0) for sense, each in shapes.items()},
    )  # fmt: skip


def _fit_lag(
    reversals: _Reversals, time: Array, force: Array, width: float, degrees: tuple[int, int], begin: float
) -> tuple[float, float] | None:
    """Fit lag and standard error [s] in windows of a width about reversals, from `begin` on; None where no lag fits best."""
    delay = begin
    for _ in range(_MOVES):
        window = _Window(reversals, time, force, width, delay, degrees)
        grid = delay + _GRID * width
        costs = np.array([window.misfit(at) for at in grid])
        best = int(np.clip(costs.argmin(), 1, grid.size - 2))
        least = scipy.optimize.minimize_scalar(
            lambda at, window=window: window.misfit(at), bounds=(grid[best - 1], grid[best + 1]), method="bounded",
            options={"xatol": 1e-6 * reversals.period},
        )  # fmt: skip
        moved, delay = abs(least.x - delay), float(least.x)
        if moved < 0.05 * width:
            break
        if abs(delay) > 0.25 * reversals.period:
            return None
    freedom = window.freedom
    if freedom < 1:
        return None
    error = window.error(delay)
    as_well = grid[costs <= least.fun * (1.0 + _RISE / freedom)]
    if as_well.size and (as_well[0] == grid[0] or as_well[-1] == grid[-1]):
        return None
    reach = np.abs(as_well - delay).max(initial=0.0) / np.sqrt(_RISE)
    return delay, float(max(error, reach))


class _Window:
    """Forces in a window about every reversal, fitted by polynomials in the distance to it."""

    def __init__(
        self, reversals: _Reversals, time: Array, force: Array, width: float, centre: float, degrees: tuple[int, int]
    ) -> None:
        """Gather the samples within `width` of each reversal, shifted by `centre` [s], and the deflection's shape there."""
        first, last = (np.searchsorted(time, reversals.instants + centre + side * width) for side in (-1.0, 1.0))
        kept = last - first > 2
        windows = [np.arange(*ends) for ends in zip(first[kept], last[kept], strict=True)]
        rows = np.concatenate(windows or [np.zeros(0, int)])
        self._counts = (last - first)[kept]
        self._starts = np.concatenate([[0], np.cumsum(self._counts)[:-1]])
        self._since = time[rows] - np.repeat(reversals.instants[kept], self._counts)
        self._top = np.repeat(reversals.senses[kept], self._counts) > 0.0
        self._period, self._degrees = reversals.period, degrees
        self._scale = _SHAPE * reversals.period
        self._shape = np.where(self._top[:, np.newaxis], reversals.shapes[1.0], reversals.shapes[-1.0])
        farthest = width / self._scale  # u there is one, so that powers of it are alike
        self._shape /= np.maximum(self._shape @ np.array([farthest, farthest**2, farthest**4]), 1e-300)[:, np.newaxis]
        self._measured = self._centred(force[rows])
        self.freedom = self._measured.size - 2 * sum(degrees) - self._counts.size - 1  # samples left over for the noise

    def _centred(self, values: Array) -> Array:
        means = (np.add.reduceat(values, self._starts, axis=0).T / self._counts).T
        return np.asarray(values - np.repeat(means, self._counts, axis=0))

    def _matrix(self, delay: float) -> Array:
        """Stack powers of the distance u to a reversal, before and behind it, at tops and at bottoms, (n, n_factors)."""
        since = self._since - delay
        s = np.abs(since) / self._scale
        u = np.sum(np.stack([s, s**2, s**4], axis=1) * self._shape, axis=1)
        sides = [(since < 0.0, self._degrees[0]), (since >= 0.0, self._degrees[1])]
        powers = [
            np.where(side & end, u**power, 0.0)
            for end in (self._top, ~self._top)
            for side, degree in sides
            for power in range(1, degree + 1)
        ]
        return self._centred(np.stack(powers, axis=1))

    def misfit(self, delay: float) -> float:
        residual = self._fit(delay)[1]
        return float(residual @ residual)

    def _fit(self, delay: float) -> tuple[Array, Array, Array]:
        """Fit the factors of the polynomials; return their matrix, the residual, and the factors."""
        matrix = self._matrix(delay)
        factors = np.linalg.lstsq(matrix.T @ matrix, matrix.T @ self._measured, rcond=None)[0].astype(np.float64, copy=False)
        return matrix, matrix @ factors - self._measured, factors

    def error(self, delay: float) -> float:
        """Standard error of a lag [s]: from the residual, or from reversal to reversal where noise is not white."""
        matrix, residual, factors = self._fit(delay)
        step = 1e-4 * self._period
        slope = (self._matrix(delay + step) - self._matrix(delay - step)) @ factors / (2.0 * step)
        slope = slope - matrix @ np.linalg.lstsq(matrix, slope, rcond=None)[0]
        white = np.sqrt(float(residual @ residual) / self.freedom / float(slope @ slope))
        each, weights = (np.add.reduceat(slope * values, self._starts) for values in (residual, slope))
        return float(max(white, np.std(each / weights, ddof=1) / np.sqrt(each.size)))
