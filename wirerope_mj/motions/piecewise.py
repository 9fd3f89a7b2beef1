"""Exact integrals of an acceleration that is linear between given knots; splines of the displacement."""

import itertools

import numpy as np
from numpy.typing import NDArray

from wirerope_mj.foundation.arrays import Array

_BLOCK = 4096  # knots from one stored velocity and displacement to the next: a record may have millions of knots


class PiecewiseLinear:
    """Acceleration that is linear between knots and zero outside, with its velocity and displacement.

    Between the knots i and i+1, with t_i <= t < t_(i+1) and tau = t - t_i,

        a = a_i + s_i tau
        v = v_i + a_i tau + s_i tau^2 / 2
        x = x_i + v_i tau + a_i tau^2 / 2 + s_i tau^3 / 6

    where s_i is the slope. v and x are zero up to the first knot; after the last one v stays as it is. v_i and x_i are summed
    from knot to knot; only every 4096th is kept, and those between are summed again when they are asked for. Knots [s], (n,),
    are in order, two equal ones a jump; neither they nor the values [m/s^2], (n,) or (n, 3), are copied.
    """

    def __init__(self, knots: Array, values: Array) -> None:
        self._knots, self._values = knots, values
        count = -(-knots.size // _BLOCK)
        self._velocity = np.zeros((count, *values.shape[1:]))
        self._displacement = np.zeros_like(self._velocity)
        for block in range(count - 1):
            velocity, displacement = self._integrals(block)
            self._velocity[block + 1], self._displacement[block + 1] = velocity[-1], displacement[-1]

    def derivative(self, t: Array, order: int) -> Array:
        """Return displacement (order 0), velocity (1) or acceleration (2) at the times (n_t,) [s]."""
        after = np.searchsorted(self._knots, t, side="right")
        if order == 2:
            value, slope, tau = self._segments(t, after)
            return value + slope * tau
        result = np.zeros((t.size, *self._values.shape[1:]))
        blocks = (after - 1) // _BLOCK  # -1 before the first knot
        for block in np.unique(blocks[after > 0]):
            rows = np.flatnonzero(blocks == block)
            knot, (velocity, displacement) = after[rows] - 1 - block * _BLOCK, self._integrals(int(block))
            value, slope, tau = self._segments(t[rows], after[rows])
            if order == 1:
                result[rows] = velocity[knot] + tau * (value + tau * slope / 2)
            else:
                result[rows] = displacement[knot] + tau * (velocity[knot] + tau * (value / 2 + tau * slope / 6))
        return result

    def _segments(self, t: Array, after: NDArray[np.intp]) -> tuple[Array, Array, Array]:
        """Return value and slope at the knot before each time, and the time since that knot; `after` is the next knot's index.

        At a knot the segment that follows it counts.
        """
        last = self._knots.size - 1
        left, right = np.clip(after - 1, 0, last), np.clip(after, 0, last)
        shape = (-1,) + (1,) * (self._values.ndim - 1)
        inside = ((after > 0) & (after <= last)).reshape(shape)
        value = np.where(inside, self._values[left], 0.0)
        step = (self._knots[right] - self._knots[left]).reshape(shape)
        rise = self._values[right] - self._values[left]
        slope = np.divide(rise, step, out=np.zeros_like(rise), where=inside & (step > 0))
        return value, slope, (t - self._knots[left]).reshape(shape)

    def _integrals(self, block: int) -> tuple[Array, Array]:
        """Return velocity and displacement at the knots of a block of 4096 and at the first knot of the next block."""
        rows = slice(block * _BLOCK, (block + 1) * _BLOCK + 1)
        knots, values = self._knots[rows], self._values[rows]
        step = np.diff(knots).reshape((-1,) + (1,) * (values.ndim - 1))
        left, right = values[:-1], values[1:]
        velocity = np.cumsum(np.concatenate([self._velocity[block][None], step * (left + right) / 2]), axis=0)
        gains = velocity[:-1] * step + (2 * left + right) * step**2 / 6
        return velocity, np.cumsum(np.concatenate([self._displacement[block][None], gains]), axis=0)


class UniformSpline:
    """Displacement sum of c_k B((t - t_k)/h) with the B-spline B of degree 5 or 3, t_k = start + k h, c_k = 0 beyond its ends.

    Its derivatives are those of degree 4 and 3, or 2 and 1, with the differences of the coefficients over h, so the three are
    exact integrals of each other. With the first (p + 1)/2 and the last coefficients zero, p being the degree, all three start
    and end at zero: unlike integrals of sampled accelerations they have nothing to accumulate. One number per knot is all that
    is kept: c_0 ... c_n [m], (n + 1,); start and spacing h are [s].
    """

    def __init__(self, start: float, spacing: float, coefficients: Array, *, degree: int) -> None:
        self._start, self._h, self._degree = start, spacing, degree
        outside = np.zeros(degree // 2)
        self._c = np.concatenate([outside, coefficients, outside])
        self._intervals = coefficients.size - 1

    def derivative(self, t: Array, order: int) -> Array:
        """Return displacement (order 0), velocity (1) or acceleration (2) at the times (n_t,) [s]."""
        knots = np.clip((t - self._start) / self._h, 0.0, float(self._intervals))
        i = np.minimum(knots.astype(np.intp), self._intervals - 1)
        u, c = knots - i, [self._c[i + k] for k in range(self._degree + 1)]
        if self._degree == 3:  # in the order of operations of the versions that stored motions of it, to the last bit
            w, (c0, c1, c2, c3) = 1 - u, c
            if order == 2:
                return (w * ((c2 - c1) - (c1 - c0)) + u * ((c3 - c2) - (c2 - c1))) / self._h**2
            if order == 1:
                return (w**2 * (c1 - c0) + (1 + 2 * u * w) * (c2 - c1) + u**2 * (c3 - c2)) / (2 * self._h)
            return (w**3 * c0 + (1 + 3 * w * (1 + u * w)) * c1 + (1 + 3 * u * (1 + u * w)) * c2 + u**3 * c3) / 6
        for _ in range(order):
            c = [after - before for before, after in itertools.pairwise(c)]
        weights = [np.ones_like(u)]
        for degree in range(1, len(c)):  # de Boor's recurrence at equal distances
            inner = [np.zeros_like(u), *weights, np.zeros_like(u)]
            weights = [((u + degree - k) * inner[k] + (1 - u + k) * inner[k + 1]) / degree for k in range(degree + 1)]
        return np.asarray(sum(weight * value for weight, value in zip(weights, c, strict=True))) / self._h**order
