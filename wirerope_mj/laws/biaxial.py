"""Bouc-Wen's law in the plane of roll and shear."""

import math
from dataclasses import dataclass

import numpy as np
import numpy.typing as npt

from wirerope_mj.laws import kernels
from wirerope_mj.laws.law import Law
from wirerope_mj.laws.path import follow_plane

Array = npt.NDArray[np.float64]

SAME = 1e-9
"""Relative difference of two axes' sharpness, share or energy that is rounding and not another law."""


@dataclass(frozen=True, kw_only=True)
class PlaneTrace:
    """What a law in the plane does along a path.

    Attributes:
        deflection: path [m], (n_t, 2), roll and shear.
        force: restoring force [N], (n_t, 2).
        hysteretic_state: z [N], (n_t, 2).
        work: work done on the isolator since the first sample [J], (n_t,).
    """

    deflection: Array
    force: Array
    hysteretic_state: Array
    work: Array


@dataclass(frozen=True, kw_only=True)
class BiaxialBoucWen:
    """Two Bouc-Wen laws whose hysteretic forces are the components of one vector.

    Scaled by each axis' bound z_m and yield deflection x_y, w = z / z_m and u = x / x_y (vectors, component by component):

        wdot = udot - w |w|^(n-2) [sigma |udot.w| + (1 - sigma) udot.w],   |w| <= 1

    Along either axis it is that axis' own law; for equal axes it does not know a direction in the plane, so that an isolator
    that is turned about its axis stays the same. The elastic parts k or F1 stay those of the axes. Both axes must have the same
    n and sigma = beta / (beta + gamma). It is passive if sigma >= 1/2 (no unloading is softer than elastic) or if both axes
    have the same energy z_m x_y; the rest is refused.

    Source: the invariant form of Casciati (1989), each axis scaled first; Park, Wen and Ang's products |xdot z_x| + |ydot z_y|
    are not invariant.

    Attributes:
        roll, shear: BoucWen, Ozdemir, SymmetricBoucWen or EnhancedDryFriction.
    """

    roll: Law
    shear: Law

    def __post_init__(self) -> None:
        for axis in ("roll", "shear"):
            law = getattr(self, axis)
            if not isinstance(law, Law) or law.kernel not in (kernels.BOUC_WEN, kernels.SYMMETRIC_BOUC_WEN):
                raise ValueError(
                    f"`{axis}` must be a Bouc-Wen law that is odd in the deflection to be coupled, got {law!r}."
                )
            if not math.isfinite(_form(law)[2]):
                raise ValueError(
                    f"`{axis}` must have `beta` + `gamma` > 0 to be coupled: without a bound it has no scale."
                )
        (s1, n1, z1, x1), (s2, n2, z2, x2) = _form(self.roll), _form(self.shear)
        for name, one, other in (("n", n1, n2), ("sigma = beta / (beta + gamma)", s1, s2)):
            if not math.isclose(one, other, rel_tol=SAME):
                raise ValueError(
                    f"`roll` and `shear` must have the same {name} to be coupled, got {one:.6g} and {other:.6g}."
                )
        if s1 < 0.5 * (1.0 - SAME) and not math.isclose(z1 * x1, z2 * x2, rel_tol=SAME):
            raise ValueError(
                "`roll` and `shear` with `gamma` > `beta` must have the same z_max^2 / alpha to be coupled, got "
                f"{z1 * x1:.6g} and {z2 * x2:.6g} J: the law would not be passive."
            )

    def rate_parameters(self) -> Array:
        """Return sigma, n, the bounds z_m and the yield deflections x_y of both axes, (6,)."""
        (sigma, n, z1, x1), (_, _, z2, x2) = _form(self.roll), _form(self.shear)
        return np.array([sigma, n, z1, z2, x1, x2])

    def line_parameters(self, start: Array, stop: Array) -> tuple[Array, float]:
        """Return the kernel's parameters for a straight line in the plane, and its length [m]."""
        length = float(np.hypot(*(stop - start)))
        direction = (stop - start) / length if length else np.zeros(2)
        return np.concatenate(
            [self.rate_parameters(), *map(_elastic, (self.roll, self.shear)), start, direction]
        ), length

    def trace(self, deflection: npt.ArrayLike) -> PlaneTrace:
        """Return forces, states and work along straight lines between the points of a path, entered unloaded.

        Args:
            deflection: path [m], (n_t, 2), roll and shear, at least two finite points.
        """
        path = np.asarray(deflection, dtype=np.float64)
        if path.ndim != 2 or path.shape[0] < 2 or path.shape[1] != 2 or not np.isfinite(path).all():
            raise ValueError(f"`deflection` must be at least 2 finite points of the plane, got shape {path.shape}.")
        parameters, _ = self.line_parameters(path[0], path[0])
        force, states, work = follow_plane(parameters, path)
        finite = np.isfinite(force).all(axis=1) & np.isfinite(work)
        if not finite.all():
            raise ValueError(f"the force of {self} leaves the finite numbers at {path[np.argmin(finite)]} m.")
        return PlaneTrace(deflection=path, force=force, hysteretic_state=states, work=work)


def _form(law: Law) -> tuple[float, float, float, float]:
    """Return sigma, n, z_m and x_y of a Bouc-Wen kernel's parameters; an unbounded law has z_m infinite."""
    alpha, beta, gamma, n = (float(value) for value in law.kernel_parameters()[:4])
    if beta + gamma <= 0.0:
        return math.nan, n, math.inf, math.inf
    bound = (alpha / (beta + gamma)) ** (1.0 / n)
    return beta / (beta + gamma), n, bound, bound / alpha


def _elastic(law: Law) -> Array:
    """Return k1, k2, k3 of the elastic part."""
    elastic = law.kernel_parameters()[4:]
    return np.concatenate([elastic, np.zeros(3 - elastic.size)])
