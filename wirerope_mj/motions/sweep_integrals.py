"""The two integrals of a logarithmic sweep that do not drift."""

import math

import numpy as np
from numpy.typing import NDArray

from wirerope_mj.foundation.arrays import Array

# From here on thirty terms of the series are exact to 1e-15 of the leading one: 30! / 50^30 is 3e-19.
_SERIES_FROM = 50.0
_FACTORIALS = np.array([math.factorial(n) for n in range(30)], dtype=float)
_HARMONIC_FACTORIALS = _FACTORIALS * np.concatenate([[0.0], np.cumsum(1 / np.arange(1.0, 30.0))])

# From here on the others leave every bit of the sum as it is: 16! / 1000^16 is 2e-35.
_FEW_FROM, _FEW = 1000.0, 16

# Step of the double-exponential rule: measured error 4e-10 at 1/10, 5e-12 at 1/12, roundoff (2e-15) from 1/16 on.
# Its nodes run from where exp(-exp(4)) to where exp(-exp(3.8)) is below 1e-19.
_STEP = 1 / 16
_S = _STEP * np.arange(-64, 61)
_NODES = np.exp(_S - np.exp(-_S))
_WEIGHTS = _STEP * _NODES * (1 + np.exp(-_S)) * np.exp(-_NODES)


def oscillating_tail(u: Array, order: int) -> NDArray[np.complex128]:
    """Return h1 (order 1) or h2 (order 2) of the integrals from u to infinity, without their fast factor e^(iu).

        int e^(is) / s ds          = e^(iu) h1(u)    (so e^(iu) h1 = E1(-iu) = -Ci(u) + i (pi/2 - Si(u)))
        int e^(is) ln(s/u) / s ds  = e^(iu) h2(u)    (the integral of the first one over ln u)

    On the path s = u + iy the oscillation becomes a decay,

        h1 = i int e^(-y) / (u + iy) dy,    h2 = i int e^(-y) ln(1 + iy/u) / (u + iy) dy,    y from 0 to infinity,

    which is expanded in -i/u where u is large and integrated by the double-exponential rule where it is not. Both
    tend to zero as u grows, which is what makes velocity and displacement of a sweep free of drift.

    Args:
        u: positive arguments, (n,).
        order: which of the two.
    """
    large = u >= _SERIES_FROM
    if large.all():  # as in every sweep but the slowest; the rule's sum costs as much for no argument as for many
        return _by_series(u, order)
    h = np.empty(u.shape, dtype=complex)
    h[large], h[~large] = _by_series(u[large], order), _by_quadrature(u[~large], order)
    return h


def _by_series(u: Array, order: int) -> NDArray[np.complex128]:
    """With q = -i/u: h1 = (i/u) sum n! q^n and h2 = -(i/u) sum n! (1 + 1/2 + ... + 1/n) q^n."""
    factors = _FACTORIALS if order == 1 else _HARMONIC_FACTORIALS
    factors = factors[:_FEW] if u.min(initial=np.inf) >= _FEW_FROM else factors
    q = -1j / u
    total = np.full(u.shape, factors[-1], dtype=complex)
    for factor in factors[-2::-1]:  # in place: as `polyval` has it, which takes new memory for every term
        total *= q
        total += factor
    return (1j if order == 1 else -1j) / u * total


def _by_quadrature(u: Array, order: int) -> NDArray[np.complex128]:
    h = np.zeros(u.shape, dtype=complex)
    for y, weight in zip(_NODES, _WEIGHTS, strict=True):
        term = 1j * weight / (u + 1j * y)
        if order == 1:
            h += term
        else:
            ratio = y / u
            h += term * (0.5 * np.log1p(ratio**2) + 1j * np.arctan(ratio))  # ln(1 + i ratio), exact for small ratios
    return h
