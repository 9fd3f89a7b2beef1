"""Bouc-Wen's law in the plane of roll and shear."""

import math
from dataclasses import dataclass
from typing import ClassVar

from wirerope_mj.foundation.arrays import Array
from wirerope_mj.mounts.laws.law import Law
from wirerope_mj.mounts.laws.plane import ODD, SAME, PlaneLaw, form_of, require_alike, require_couplable
from wirerope_mj.mounts.laws.plane_kernels import BIAXIAL


@dataclass(frozen=True, kw_only=True)
class BiaxialBoucWen(PlaneLaw):
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

    kernel: ClassVar[int] = BIAXIAL

    roll: Law
    shear: Law

    def __post_init__(self) -> None:
        for axis in ("roll", "shear"):
            require_couplable(axis, getattr(self, axis), ODD, "a Bouc-Wen law that is odd in the deflection")
        require_alike(("roll", "shear"), self.roll, self.shear)
        (s1, _, z1, x1), (_, _, z2, x2) = form_of(self.roll), form_of(self.shear)
        if s1 < 0.5 * (1.0 - SAME) and not math.isclose(z1 * x1, z2 * x2, rel_tol=SAME):
            raise ValueError(
                "`roll` and `shear` with `gamma` > `beta` must have the same z_max^2 / alpha to be coupled, got "
                f"{z1 * x1:.6g} and {z2 * x2:.6g} J: the law would not be passive."
            )

    @property
    def laws(self) -> tuple[Law, Law]:
        """The two laws."""
        return self.roll, self.shear

    def mount_parameters(self) -> Array:
        """Return what the kernel of a mount takes: those of the rates."""
        return self.rate_parameters()
