"""Displacement as a uniform cubic spline: an acceleration that is linear between knots and cannot drift."""

import numpy as np

from wirerope_mj.foundation.arrays import Array


class UniformSpline:
    """Displacement sum of c_k B((t - t_k)/h) with the cubic B-spline B, t_k = start + k h, and c_k = 0 beyond its ends.

    At the knots

        x = (c_(k-1) + 4 c_k + c_(k+1))/6,   v = (c_(k+1) - c_(k-1))/(2 h),   a = (c_(k-1) - 2 c_k + c_(k+1))/h^2

    and a is linear between them, so the three are exact integrals of each other. With the first two and the last two
    coefficients zero, all three start and end at zero: unlike integrals of sampled accelerations they have nothing to
    accumulate. One number per knot is all that is kept.

    Args:
        start: instant of the first knot [s].
        spacing: distance h of the knots [s].
        coefficients: c_0 ... c_n [m], (n + 1,); the first two and the last two must be zero.
    """

    def __init__(self, start: float, spacing: float, coefficients: Array) -> None:
        self._start, self._h = start, spacing
        self._c = np.concatenate([[0.0], coefficients, [0.0]])
        self._intervals = coefficients.size - 1

    def derivative(self, t: Array, order: int) -> Array:
        """Return displacement (order 0), velocity (1) or acceleration (2) at the times (n_t,) [s]."""
        return (self.displacement, self.velocity, self.acceleration)[order](t)

    def displacement(self, t: Array) -> Array:
        """Return the displacement [m] at the times (n_t,) [s]."""
        u, (c0, c1, c2, c3) = self._locate(t)
        w = 1 - u
        return (w**3 * c0 + (1 + 3 * w * (1 + u * w)) * c1 + (1 + 3 * u * (1 + u * w)) * c2 + u**3 * c3) / 6

    def velocity(self, t: Array) -> Array:
        """Return the velocity [m/s] at the times (n_t,) [s]."""
        u, (c0, c1, c2, c3) = self._locate(t)
        w = 1 - u
        return (w**2 * (c1 - c0) + (1 + 2 * u * w) * (c2 - c1) + u**2 * (c3 - c2)) / (2 * self._h)

    def acceleration(self, t: Array) -> Array:
        """Return the acceleration [m/s^2] at the times (n_t,) [s]."""
        u, (c0, c1, c2, c3) = self._locate(t)
        return ((1 - u) * ((c2 - c1) - (c1 - c0)) + u * ((c3 - c2) - (c2 - c1))) / self._h**2

    def _locate(self, t: Array) -> tuple[Array, tuple[Array, Array, Array, Array]]:
        """Return the fraction 0..1 of each time between its knots and the four coefficients that reach there."""
        knots = np.clip((t - self._start) / self._h, 0.0, float(self._intervals))
        i = np.minimum(knots.astype(np.intp), self._intervals - 1)
        return knots - i, (self._c[i], self._c[i + 1], self._c[i + 2], self._c[i + 3])
