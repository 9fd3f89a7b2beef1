"""Exact integrals of an acceleration that is linear between knots: the base of trapezoids, sawteeth and records."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray


class PiecewiseLinear:
    """Acceleration that is linear between knots and zero outside, with its velocity and displacement.

    Between the knots i and i+1, with t_i <= t < t_(i+1) and tau = t - t_i,

        a = a_i + s_i tau
        v = v_i + a_i tau + s_i tau^2 / 2
        x = x_i + v_i tau + a_i tau^2 / 2 + s_i tau^3 / 6

    where s_i is the slope. v and x are zero up to the first knot; after the last one v stays as it is.

    Args:
        knots: Instants [s], in order, shape (n,). Two equal ones are a jump.
        values: Acceleration at the knots [m/s^2], shape (n,) or (n, 3).
    """

    def __init__(self, knots: NDArray[np.float64], values: NDArray[np.float64]) -> None:
        step = np.diff(knots).reshape((-1,) + (1,) * (values.ndim - 1))
        slope = np.divide(np.diff(values, axis=0), step, out=np.zeros_like(values[1:]), where=step > 0)
        left = values[:-1]
        velocity = np.cumsum(step * (left + values[1:]) / 2, axis=0)
        entry = np.concatenate([np.zeros_like(values[:1]), velocity[:-1]])
        displacement = np.cumsum(entry * step + (2 * left + values[1:]) * step**2 / 6, axis=0)

        # Row 0 holds before the first knot, row i from knot i-1 to knot i, the last row after the last knot.
        rest = np.zeros_like(values[:1])
        self._knots = knots
        self._origin = np.concatenate([knots[:1], knots])
        self._value = np.concatenate([rest, left, rest])
        self._slope = np.concatenate([rest, slope, rest])
        self._velocity = np.concatenate([rest, rest, velocity])
        self._displacement = np.concatenate([rest, rest, displacement])

    def acceleration(self, t: NDArray[np.float64]) -> NDArray[np.float64]:
        """Returns the acceleration [m/s^2] at the times (n_t,) [s]."""
        i, tau = self._locate(t)
        return self._value[i] + self._slope[i] * tau

    def velocity(self, t: NDArray[np.float64]) -> NDArray[np.float64]:
        """Returns the velocity [m/s] at the times (n_t,) [s]."""
        i, tau = self._locate(t)
        return self._velocity[i] + tau * (self._value[i] + tau * self._slope[i] / 2)

    def displacement(self, t: NDArray[np.float64]) -> NDArray[np.float64]:
        """Returns the displacement [m] at the times (n_t,) [s]."""
        i, tau = self._locate(t)
        return self._displacement[i] + tau * (self._velocity[i] + tau * (self._value[i] / 2 + tau * self._slope[i] / 6))

    def _locate(self, t: NDArray[np.float64]) -> tuple[NDArray[np.intp], NDArray[np.float64]]:
        """Returns the row of each time and the time since that row's origin; a knot belongs to what follows it."""
        i = np.searchsorted(self._knots, t, side="right")
        return i, (t - self._origin[i]).reshape((-1,) + (1,) * (self._value.ndim - 1))
