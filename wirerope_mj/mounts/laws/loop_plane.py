"""Bouc-Wen's law in the plane of roll and axial deflection, in which a rope loop bends, and the energy that couples them."""

from dataclasses import dataclass, replace
from functools import cached_property, lru_cache
from typing import Annotated, ClassVar, Self

import numpy as np
from numpy.polynomial.polynomial import polyder, polyval2d

from wirerope_mj.foundation.arrays import Array, ArrayLike, Entries
from wirerope_mj.foundation.structure import bounds, check
from wirerope_mj.mounts.laws.law import Law
from wirerope_mj.mounts.laws.ni import ASYMMETRIC_BOUC_WEN
from wirerope_mj.mounts.laws.parallel import Parallel
from wirerope_mj.mounts.laws.plane import ODD, SAME, PlaneLaw, asymmetry_of, require_alike, require_couplable
from wirerope_mj.mounts.laws.plane_kernels import LOOP

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
    """

    #: ends of the box [m], all positive
    roll: Annotated[float, bounds("m", gt=0.0, le=LARGEST)]
    compression: Annotated[float, bounds("m", gt=0.0, le=LARGEST)]
    tension: Annotated[float, bounds("m", gt=0.0, le=LARGEST)]
    #: c_ij [J], I rows of J numbers
    coefficients: Annotated[tuple[tuple[float, ...], ...], bounds("J")]

    def __post_init__(self) -> None:
        check(self)
        rows = self.coefficients
        if not any(rows) or len({len(row) for row in rows}) != 1:
            raise ValueError(f"`coefficients` must be rows of equally many numbers, got lengths {[*map(len, rows)]}.")

    @property
    def scale(self) -> float:
        """W: unit in which the axial deflection is measured [m]."""
        return max(self.compression, self.tension)

    def energy(self, deflection: ArrayLike) -> Array:
        """Return U [J], (...), at deflections roll and axial [m], (..., 2)."""
        inside, out_u, out_w = self._nearest(deflection)
        straight = self._slope(inside) + self._slope(inside, 1, 0) * out_u + self._slope(inside, 0, 1) * out_w
        return straight + self._slope(inside, 1, 1) * out_u * out_w

    def force(self, deflection: ArrayLike) -> Array:
        """Return the gradient of U [N], (..., 2), at deflections roll and axial [m], (..., 2)."""
        inside, out_u, out_w = self._nearest(deflection)
        cross = self._slope(inside, 1, 1)
        return np.stack([self._slope(inside, 1, 0) + cross * out_w, self._slope(inside, 0, 1) + cross * out_u], axis=-1)

    def stiffness(self, deflection: ArrayLike) -> Array:
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

    def to_dict(self) -> Entries:
        """Return the coupling as it stands in an isolator file."""
        ends = {name: getattr(self, name) for name in ("roll", "compression", "tension")}
        return {**ends, "coefficients": [list(row) for row in self.coefficients]}

    def _nearest(self, deflection: ArrayLike) -> tuple[Array, Array, Array]:
        """Return the nearest point of the box (..., 2), and the distances of roll and axial beyond the box, (...) each."""
        d = np.asarray(deflection, dtype=np.float64)
        inside = np.clip(d, (-self.roll, -self.compression), (self.roll, self.tension))
        return inside, d[..., 0] - inside[..., 0], d[..., 1] - inside[..., 1]

    def _slope(self, d: Array, of_u: int = 0, of_w: int = 0) -> Array:
        """Return the derivative of the polynomial of order `of_u` in u and `of_w` in w, (...)."""
        table = _derivative(self.coefficients, of_u, of_w)
        units = self.roll**of_u * self.scale**of_w
        return np.asarray(polyval2d(d[..., 0] / self.roll, d[..., 1] / self.scale, table) / units, dtype=np.float64)


@lru_cache(maxsize=256)
def _derivative(coefficients: tuple[tuple[float, ...], ...], of_u: int, of_w: int) -> Array:
    """Return a derivative of sum c_ij u^(2 i) w^j as coefficients of the powers of u and w, (n_u, n_w)."""
    rows = np.array(coefficients)
    table = np.zeros((2 * rows.shape[0] + 1, rows.shape[1] + 1))
    table[2::2, 1:] = rows
    return np.asarray(polyder(polyder(table, of_u, axis=0), of_w, axis=1))


@dataclass(frozen=True, kw_only=True)
class LoopBoucWen(PlaneLaw):
    """The laws of roll u and axial deflection w, coupled by an elastic energy U and by one bound of their hysteretic forces.

        F_roll = z_u + F1(u) + dU/du,   F_axial = F2(w) [z_w + F1(w)] + dU/dw

    z_u and z_w follow the rates of `BiaxialBoucWen`: the components of one vector, bounded by one ellipse. Along either axis
    each is that axis' own law, the loop's pull across (dU/dw in a pure roll) aside. Both laws must have the same n and
    sigma = beta / (beta + gamma), and sigma >= 1/2.

    No closed path from the unloaded state draws work. The rates are zdot = alpha v - m z, v the deflection rate, for both axes
    with one m, which is >= 0 if sigma >= 1/2. With S(x, z) the work that unloading without loss gives back, from (x, z) to
    z = 0 along dz = alpha dx,

        S = int_0^z F2(x - (z - s) / alpha) s ds / alpha,   dS/dz at fixed x = int F2 over [x - z / alpha, x]

    so that z dS/dz >= 0 for every F2 > 0. Moving with zdot = alpha v takes exactly dS = F2 z v; the rest of zdot changes S by
    -m z dS/dz <= 0, so that F2 z v - Sdot = m z dS/dz >= 0. F1, F2 F1 and U are elastic and add nothing to a closed path.

    Where both axes have friction on several scales, as many laws in parallel, every scale has its own ellipse: the law is the
    sum of those of the pairs, and U is there once. Sums of such laws draw no work either.
    """

    kernel: ClassVar[int] = LOOP

    roll: Law  # BoucWen, Ozdemir, SymmetricBoucWen or EnhancedDryFriction, or several in parallel
    axial: Law  # the same, or AsymmetricBoucWen, or as many in parallel
    loop: LoopCoupling  # the elastic energy

    def __post_init__(self) -> None:
        if not isinstance(self.loop, LoopCoupling):
            raise ValueError(f"`loop` must be a LoopCoupling, got {self.loop!r}.")
        if any(isinstance(law, Parallel) for law in self.laws):
            _ = self.scales  # each checks itself
            return
        require_couplable("roll", self.roll, ODD, "a Bouc-Wen law that is odd in the deflection")
        require_couplable("axial", self.axial, (*ODD, ASYMMETRIC_BOUC_WEN), "a Bouc-Wen law")
        require_alike(("roll", "axial"), self.roll, self.axial)
        sigma = self.rate_parameters()[0]
        if sigma < 0.5 * (1.0 - SAME):
            raise ValueError(
                f"`roll` and `axial` must have sigma = beta / (beta + gamma) >= 0.5 to be coupled, got {sigma:.6g}: the law "
                "would not be passive."
            )

    @property
    def laws(self) -> tuple[Law, Law]:
        return self.roll, self.axial

    @cached_property
    def scales(self) -> tuple["LoopBoucWen", ...]:
        """Laws of the pairs of one law of roll and one of axial, in their order; the first has the elastic energy."""
        if not any(isinstance(law, Parallel) for law in self.laws):
            return (self,)
        numbers = [len(law.components) for law in self.laws]
        if numbers[0] != numbers[1]:
            raise ValueError(
                f"`roll` and `axial` must have equally many laws in parallel to be coupled, got {numbers[0]} and {numbers[1]}."
            )
        pairs = zip(self.roll.components, self.axial.components, strict=True)
        return tuple(
            LoopBoucWen(roll=roll, axial=axial, loop=self.loop.scaled(float(scale == 0)))
            for scale, (roll, axial) in enumerate(pairs)
        )

    def coupling_parameters(self) -> Array:
        return self.loop.kernel_parameters()

    def line_parameters(self, start: Array, stop: Array) -> tuple[Array, float]:
        """Return the kernel's parameters for a straight line in the plane, and its length [m]."""
        line, length = super().line_parameters(start, stop)
        if self.brackets is not None:
            return line, length
        return np.concatenate([line, [asymmetry_of(self.axial)], self.loop.kernel_parameters()]), length
