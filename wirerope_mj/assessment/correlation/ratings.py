"""Ratings of a computed history against a measured one: of ISO/TS 18571, and of amplitude and timing separately."""

import math
from dataclasses import dataclass

import numpy as np

from wirerope_mj.foundation.arrays import Array

# Parameters of ISO/TS 18571:2014, table of clause 5: inner and outer corridor as fractions of the measured peak, and the
# exponent between them
INNER, _OUTER, _CORRIDOR_POWER = 0.05, 0.5, 2
_LARGEST_SHIFT = 0.2  # of the interval, from which the phase rating is zero
_LARGEST_MAGNITUDE, _LARGEST_SLOPE = 0.5, 2.0  # errors from which their ratings are zero
_WARP = 0.1  # half width of the band of the time warping, of the interval
_SMOOTHED = 9  # samples over which slopes are averaged
_WEIGHTS = (0.4, 0.2, 0.2, 0.2)

# Overall ratings above which a grade begins (clause 6 of ISO/TS 18571:2014)
GRADES = ((0.94, "excellent"), (0.8, "good"), (0.58, "fair"), (-1.0, "poor"))


@dataclass(frozen=True, kw_only=True)
class Rating:
    """Ratings from 0 to 1, where 1 is agreement."""

    corridor: float  # how far the computed history stays within 5 % of the measured peak
    phase: float  # how little it must be shifted to fit best
    magnitude: float  # how alike sizes are once it is shifted and warped
    slope: float  # how alike slopes are once it is shifted
    overall: float  # 0.4 of the corridor and 0.2 of each other rating

    @property
    def grade(self) -> str:
        return next(grade for above, grade in GRADES if self.overall > above)


def iso_rating(measured: Array, computed: Array) -> Rating:
    """Rate a computed history against a measured one, (n,), sampled at the same even instants.

    ISO/TS 18571:2014, Road vehicles - Objective rating metric for non-ambiguous signals. The standard asks for 10 000 samples
    a second, and for an interval that holds the event and nothing else.
    """
    peak = float(np.abs(measured).max())
    inner, outer = INNER * peak, _OUTER * peak
    inside = np.clip((outer - np.abs(measured - computed)) / (outer - inner), 0.0, 1.0)
    corridor = float((inside**_CORRIDOR_POWER).mean())
    # By how many samples the computed history comes late; of equal correlations the smaller shift.
    largest = int(_LARGEST_SHIFT * measured.size)
    best, shift = -np.inf, 0
    for size in range(largest + 1):
        n = measured.size - size
        for sign in (1, -1) if size else (1,):
            m, c = (measured[:n], computed[size:]) if sign > 0 else (measured[size:], computed[:n])
            m, c = m - m.mean(), c - c.mean()
            norm = float(np.sqrt((m @ m) * (c @ c)))
            correlation = float(m @ c) / norm if norm else 0.0
            if correlation > best:
                best, shift = correlation, sign * size
    phase = max(0.0, (largest - abs(shift)) / largest) if largest else 1.0
    n = measured.size - abs(shift)
    m, c = (measured[:n], computed[shift:]) if shift >= 0 else (measured[-shift:], computed[:n])
    measured_rows, computed_rows = _warping_path(m, c)
    magnitude = _error_rating(m[measured_rows], c[computed_rows], _LARGEST_MAGNITUDE)
    slope = _error_rating(_moving_average(np.gradient(m)), _moving_average(np.gradient(c)), _LARGEST_SLOPE)
    overall = float(np.dot(_WEIGHTS, (corridor, phase, magnitude, slope)))
    return Rating(corridor=corridor, phase=phase, magnitude=magnitude, slope=slope, overall=overall)


def _error_rating(measured: Array, computed: Array, largest: float) -> float:
    """Rate the error sum |c - m| / sum |m| as 1 less its ratio to the largest error, at least 0."""
    size, error = float(np.abs(measured).sum()), float(np.abs(computed - measured).sum())
    return max(0.0, 1.0 - error / size / largest) if size else float(error == 0.0)


def _moving_average(curve: Array) -> Array:
    """Average each sample with its neighbours over nine samples, fewer near the ends."""
    half = np.minimum(_SMOOTHED // 2, np.minimum(np.arange(curve.size), np.arange(curve.size)[::-1]))
    sums = np.concatenate([[0.0], np.cumsum(curve)])
    rows = np.arange(curve.size)
    return np.asarray((sums[rows + half + 1] - sums[rows - half]) / (2 * half + 1))


def _warping_path(measured: Array, computed: Array) -> tuple[Array, Array]:
    """Pair the rows of two histories by dynamic time warping with least squares, within a band; returns the rows of each.

    The least cost up to a pair, D(i, j) = (c_j - m_i)^2 + min(D(i-1, j), D(i, j-1), D(i-1, j-1)), is computed along the
    diagonals i + j, whose elements do not depend on each other.
    """
    n = measured.size
    width = max(int(_WARP * n), 1)
    steps = np.zeros((2 * n - 1, 2 * width + 1), dtype=np.int8)  # by diagonal and by i - j + width: 0 both, 1 i, 2 j
    # costs on three successive diagonals, by i - j + width + 1
    before_last, last, current = (np.full(2 * width + 3, np.inf) for _ in range(3))
    backwards = computed[::-1]
    for diagonal in range(2 * n - 1):
        low = max(diagonal - n + 1, (diagonal - width + 1) // 2, 0)
        high = min(diagonal, (diagonal + width) // 2, n - 1)
        first, end = 2 * low - diagonal + width + 1, 2 * high - diagonal + width + 2
        both, by_row, by_column = before_last[first:end:2], last[first - 1 : end - 1 : 2], last[first + 1 : end + 1 : 2]
        best = np.minimum(by_row, by_column)
        chosen = np.where(by_row <= by_column, 1, 2)
        chosen[both <= best] = 0
        total = (backwards[n - 1 - diagonal + low : n - diagonal + high] - measured[low : high + 1]) ** 2
        if diagonal:
            total += np.minimum(both, best)
        current.fill(np.inf)
        current[first:end:2] = total
        steps[diagonal, first - 1 : end - 1 : 2] = chosen
        before_last, last, current = last, current, before_last
    row = column = n - 1
    path = [(row, column)]
    while row or column:
        step = int(steps[row + column, row - column + width])
        row, column = row - (step != 2), column - (step != 1)
        path.append((row, column))
    pairs = np.array(path[::-1])
    return pairs[:, 0], pairs[:, 1]


@dataclass(frozen=True, kw_only=True)
class MagnitudePhase:
    """Magnitude and phase errors of a computed history; all are zero if it equals the measured history."""

    magnitude: float  # > 0 where the computed history is larger
    phase: float  # 0 to 1; 0.5 for two sines a quarter of a period apart
    comprehensive: float  # of both together


def sprague_geers(measured: Array, computed: Array) -> MagnitudePhase:
    """Compare two histories, (n,), sampled at the same even instants, by energy and by the angle between them.

    Magnitude error M = sqrt(Icc / Imm) - 1, phase error P = arccos(Imc / sqrt(Imm Icc)) / pi, both C = sqrt(M^2 + P^2), with
    Imm, Icc, Imc the integrals of the products of measured m and computed c:
    Sprague and Geers, A spectral-element method for modelling cavitation in transient fluid-structure interaction, Int. J.
    Numerical Methods in Engineering 60 (2004) 2467. A factor on the computed history changes M alone.
    """
    angle, of_measured, of_computed = _angle_and_energies(measured, computed)
    magnitude = math.sqrt(of_computed / of_measured) - 1.0
    return MagnitudePhase(magnitude=magnitude, phase=angle, comprehensive=math.hypot(magnitude, angle))


def russell(measured: Array, computed: Array) -> MagnitudePhase:
    """Compare two histories, (n,), by a magnitude error with one size for factors of 2 and 1/2, and by the angle between them.

    Magnitude error M = sign(m) log10(1 + |m|), m = (Icc - Imm) / sqrt(Icc Imm), phase P = arccos(Imc / sqrt(Imm Icc)) / pi,
    both RC = sqrt(pi / 4 (M^2 + P^2)): Russell, Error measures for comparing transient data, 68th Shock and Vibration Symposium
    (1997) part I; RC up to 0.15 is called excellent there, up to 0.28 acceptable.
    """
    angle, of_measured, of_computed = _angle_and_energies(measured, computed)
    relative = (of_computed - of_measured) / math.sqrt(of_computed * of_measured) if of_computed else -math.inf
    magnitude = math.copysign(math.log10(1.0 + abs(relative)), relative)
    return MagnitudePhase(
        magnitude=magnitude, phase=angle, comprehensive=math.sqrt(0.25 * math.pi) * math.hypot(magnitude, angle)
    )


def _angle_and_energies(measured: Array, computed: Array) -> tuple[float, float, float]:
    """Compute the angle between two histories over pi, and the sums of their squares."""
    of_measured, of_computed = float(measured @ measured), float(computed @ computed)
    if of_measured == 0.0:
        raise ValueError("`measured` must not be zero throughout: nothing can be compared with a dead channel.")
    size = math.sqrt(of_measured) * math.sqrt(of_computed)
    cosine = float(measured @ computed) / size if size else 0.0
    return math.acos(float(np.clip(cosine, -1.0, 1.0))) / math.pi, of_measured, of_computed
