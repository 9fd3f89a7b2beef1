"""The elastic energy by which a rope loop couples roll and axial deflection."""

from collections.abc import Sequence
from dataclasses import dataclass, replace
from typing import Any, Self

import numpy as np
import numpy.typing as npt
from numpy.polynomial.polynomial import polyder, polyval2d

from wirerope_mj.foundation.arguments import finite, positive
from wirerope_mj.foundation.arrays import Array

LARGEST = 100.0  # Largest end of a box [m]: no loop of rope is larger, and powers of the ends stay numbers


@dataclass(frozen=True, kw_only=True)
class LoopCoupling:
    """Elastic energy of roll u and axial deflection w that is there only where both are, beside the axes' own laws.

        U(u, w) = sum c_ij (u / roll)^(2 i) (w / W)^j,   W = max(compression, tension),   i = 1 .. I, j = 1 .. J

    It is even in roll, and adds nothing to the axial force of an isolator that does not roll, nor to the roll force of one that
    has no axial deflection. It holds in the box |u| <= roll, -compression <= w <= tension. Outside it goes on straight from the
    nearest point c of the box, with the distances D = d - c from there,

        U(c) + U_u(c) Du + U_w(c) Dw + U_uw(c) Du Dw

    so that its force is the gradient of one potential, and continuous, everywhere: no closed path draws work from it.

    Attributes:
        roll, compression, tension: ends of the box [m], all positive.
        coefficients: c_ij [J], I rows of J numbers.
    """

    roll: float
    compression: float
    tension: float
    coefficients: Sequence[Sequence[float]]

    def __post_init__(self) -> None:
        for name in ("roll", "compression", "tension"):
            if positive(name, getattr(self, name), unit="m") > LARGEST:
                raise ValueError(
                    f"`{name}` must be at most {LARGEST:g} m, got {getattr(self, name)!r} m: check its unit."
                )
        rows = self.coefficients
        if not isinstance(rows, list | tuple) or not all(isinstance(row, list | tuple) for row in rows):
            raise ValueError(f"`coefficients` must be rows of numbers [J], got {rows!r}.")
        if not any(rows) or len({len(row) for row in rows}) != 1:
            raise ValueError(f"`coefficients` must be rows of equally many numbers, got lengths {[*map(len, rows)]}.")
        numbers = tuple(tuple(finite("coefficients", value, unit="J") for value in row) for row in rows)
        object.__setattr__(self, "coefficients", numbers)

    @property
    def scale(self) -> float:
        """W: deflection that the axial one is measured in [m]."""
        return max(self.compression, self.tension)

    def energy(self, deflection: npt.ArrayLike) -> Array:
        """Return U [J], (...), at deflections roll and axial [m], (..., 2)."""
        inside, out_u, out_w = self._nearest(deflection)
        return (
            self._slope(inside)
            + self._slope(inside, 1, 0) * out_u
            + self._slope(inside, 0, 1) * out_w
            + self._slope(inside, 1, 1) * out_u * out_w
        )

    def force(self, deflection: npt.ArrayLike) -> Array:
        """Return the gradient of U [N], (..., 2), at deflections roll and axial [m], (..., 2)."""
        inside, out_u, out_w = self._nearest(deflection)
        cross = self._slope(inside, 1, 1)
        return np.stack([self._slope(inside, 1, 0) + cross * out_w, self._slope(inside, 0, 1) + cross * out_u], axis=-1)

    def stiffness(self, deflection: npt.ArrayLike) -> Array:
        """Return the second derivatives of U [N/m], (..., 2, 2); at an end of the box those from inside."""
        inside, out_u, out_w = self._nearest(deflection)
        roll = np.where(out_u == 0.0, self._slope(inside, 2, 0) + self._slope(inside, 2, 1) * out_w, 0.0)
        axial = np.where(out_w == 0.0, self._slope(inside, 0, 2) + self._slope(inside, 1, 2) * out_u, 0.0)
        cross = self._slope(inside, 1, 1)
        return np.stack([np.stack([roll, cross], axis=-1), np.stack([cross, axial], axis=-1)], axis=-2)

    def kernel_parameters(self) -> Array:
        """Return roll, compression, tension, W, I, J and the coefficients row by row."""
        rows = np.array(self.coefficients)
        return np.concatenate([[self.roll, self.compression, self.tension, self.scale, *rows.shape], rows.ravel()])

    def scaled(self, factor: float) -> Self:
        """Return the coupling whose energy is `factor` times this one's everywhere."""
        return replace(self, coefficients=tuple(tuple(factor * value for value in row) for row in self.coefficients))

    def to_dict(self) -> dict[str, Any]:
        """Return the coupling as it stands in an isolator file."""
        ends = {name: getattr(self, name) for name in ("roll", "compression", "tension")}
        return {**ends, "coefficients": [list(row) for row in self.coefficients]}

    def _nearest(self, deflection: npt.ArrayLike) -> tuple[Array, Array, Array]:
        """Return the nearest point of the box (..., 2) and how far beyond it roll and axial are, (...) each."""
        d = np.asarray(deflection, dtype=np.float64)
        inside = np.clip(d, (-self.roll, -self.compression), (self.roll, self.tension))
        return inside, d[..., 0] - inside[..., 0], d[..., 1] - inside[..., 1]

    def _slope(self, d: Array, of_u: int = 0, of_w: int = 0) -> Array:
        """Return a derivative of the polynomial, of an order in u and one in w, (...)."""
        rows = np.array(self.coefficients)
        table = np.zeros((2 * rows.shape[0] + 1, rows.shape[1] + 1))
        table[2::2, 1:] = rows
        table = polyder(polyder(table, of_u, axis=0), of_w, axis=1)
        units = self.roll**of_u * self.scale**of_w
        return np.asarray(polyval2d(d[..., 0] / self.roll, d[..., 1] / self.scale, table) / units, dtype=np.float64)
