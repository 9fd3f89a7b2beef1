"""The slope of a sampled curve at its first point, where a loop has just turned round."""

import numpy as np

from wirerope_mj.foundation.arrays import Array

_DEGREE = 3  # a parabola bends too little where a loop saturates in a tenth of its range, a quartic rings with noise
_FEWEST = _DEGREE + 4  # samples: three more than coefficients, else a lucky residual looks like a good fit
_GROWTH = 1.25  # from one span to the next
_WIDEST = 0.5  # share of the curve: beyond its middle it says nothing of its beginning
_ABOVE_NOISE = 15.0  # a span of 15 standard deviations of the deflection's noise flattens a straight line by 5 %
_SHORTER = 0.7  # of the best span: what a cubic misses falls with the third power of it, scatter rises by its inverse


def tangent_at_start(deflection: Array, force: Array) -> float:
    """Return dF/dx at the first sample of a branch [N/m]; NaN if it has fewer than 7 samples or leads nowhere.

    A cubic in the distance from the first sample is fitted by least squares to the first 7, 9, 12, ... samples, up to half
    of the branch. The span with the smallest standard error of the slope is where misfit and noise are about even; 0.7 of it
    is taken, for the misfit is all of one sign. Exact samples are thus judged on the shortest span, where a cubic bends as
    the curve does, noisy ones on a longer one. Spans within the deflection's own noise, estimated from its third
    differences, are left out: there the fit would see no deflection at all.

    With noise of 0.1 % of the amplitudes and 200 samples a cycle the error is about 1 % for an ordinary loop, 3 % for
    one that hardens or turns sharply, and 5 % for one that saturates within a tenth of its amplitude.

    Args:
        deflection: of the branch, its turning point first [m], (n,).
        force: at the same samples [N], (n,).
    """
    depth = np.abs(deflection - deflection[0])
    if deflection.size < _FEWEST or depth.max() == 0.0:
        return float("nan")
    # The mean square of third differences of white noise is 1 + 9 + 9 + 1 = 20 times its variance.
    noise = float(np.sqrt(np.mean(np.diff(deflection, 3) ** 2) / 20.0))
    fits: list[tuple[float, float, float]] = []
    count = _FEWEST
    while count <= deflection.size:
        span = float(depth[:count].max())
        if fits and span > _WIDEST * depth.max():
            break
        if span > _ABOVE_NOISE * noise:
            fits.append((*_slope(depth[:count] / span, force[:count] - force[0], span), span))
        count = int(np.ceil(_GROWTH * count))
    if not fits:
        return float("nan")
    longest = max(_SHORTER * min(fits)[2], fits[0][2])
    slope = [slope for _, slope, span in fits if span <= longest][-1]
    return slope if deflection[-1] > deflection[0] else -slope


def _slope(distance: Array, force: Array, span: float) -> tuple[float, float]:
    """Return the standard error of the slope at distance 0 and the slope itself [N/m]; `distance` runs from 0 to 1."""
    powers = np.vander(distance, _DEGREE + 1, increasing=True)
    coefficients, _, rank, _ = np.linalg.lstsq(powers, force, rcond=None)
    if rank <= _DEGREE:  # samples that stand still: no slope
        return np.inf, float("nan")
    residual = force - powers @ coefficients
    variance = residual @ residual / (distance.size - _DEGREE - 1)
    error = np.sqrt(variance * np.linalg.inv(powers.T @ powers)[1, 1])
    return float(error / span), float(coefficients[1] / span)
