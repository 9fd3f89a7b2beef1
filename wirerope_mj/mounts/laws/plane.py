"""Two Bouc-Wen laws in a plane of two deflections with one bound of their hysteretic forces; the law of roll and shear."""

import math
from abc import ABC, abstractmethod
from collections.abc import Sequence
from dataclasses import dataclass
from typing import ClassVar, Self

import numpy as np

from wirerope_mj.foundation.arrays import Array, ArrayLike
from wirerope_mj.mounts.laws.bouc_wen import BOUC_WEN
from wirerope_mj.mounts.laws.law import Law
from wirerope_mj.mounts.laws.ni import ASYMMETRIC_BOUC_WEN, SYMMETRIC_BOUC_WEN
from wirerope_mj.mounts.laws.path import follow_plane
from wirerope_mj.mounts.laws.plane_kernels import BIAXIAL, ON_BRACKETS, own_deflections
from wirerope_mj.mounts.laws.stop import STOP

SAME = 1e-9  # Relative difference of two axes' n, sigma or energy that is rounding and not another law
ODD = (BOUC_WEN, SYMMETRIC_BOUC_WEN)  # Kernels of the Bouc-Wen laws that are odd in the deflection


@dataclass(frozen=True, kw_only=True)
class PlaneTrace:
    """Forces, states and work of a law in the plane along a path."""

    deflection: Array  # path [m], (n_t, 2), roll and shear, or roll and axial
    force: Array  # restoring force [N], (n_t, 2)
    hysteretic_state: Array  # z [N], (n_t, 2), summed over the scales
    work: Array  # work done on the isolator since the first sample [J], (n_t,)


@dataclass(frozen=True, kw_only=True)
class PlaneLaw(ABC):
    """Two laws, of roll and of another axis, whose hysteretic forces are the components of one vector.

    `brackets` are springs in series with both laws [N/m], infinite on an axis that stands on none; then deflections are those
    of both together, see `wirerope_mj.mounts.laws.plane_kernels`.
    """

    brackets: tuple[float, float] | None = None

    kernel: ClassVar[int]  # number of the kernel along a line in the plane, in `wirerope_mj.mounts.laws.plane_kernels`

    @property
    @abstractmethod
    def laws(self) -> tuple[Law, Law]:
        """The two laws."""

    def coupling_parameters(self) -> Array:
        """Return the parameters of the elastic coupling energy; here there is none."""
        return np.array([1.0, 1.0, 1.0, 1.0, 0.0, 0.0])

    def mount_parameters(self) -> Array:
        """Return the parameters of the mount's kernel: rates, elastic energy, and laws on brackets."""
        parameters = [self.rate_parameters(), self.coupling_parameters()]
        if self.brackets is not None:
            pairs = zip(*(law.components for law in self.laws), strict=True)
            parameters += [1.0 / np.array(self.brackets)]
            parameters += [np.array([*elastic_of(first), *elastic_of(second), asymmetry_of(second)]) for first, second in pairs]
        return np.concatenate(parameters)

    def own_deflection(self, deflection: Array, states: Array) -> Array:
        """Find the deflections of the laws without brackets [m], (2,), at hysteretic forces [N], those of roll first."""
        if self.brackets is None:
            return deflection
        n = len(self.scales)
        return np.array(own_deflections(self.mount_parameters(), 0, n, *deflection.tolist(), states, 0, n)[:2])

    @property
    def scales(self) -> Sequence[Self]:
        """Laws with one hysteretic force per axis of which the law is the sum; a single law: itself."""
        return (self,)

    def rate_parameters(self) -> Array:
        """Return sigma, n, the bounds z_m and the yield deflections x_y of both laws, six for each scale, (6 n_scales,)."""
        return np.array([value for scale in self.scales for value in rates_in_plane(*map(form_of, scale.laws))])

    def line_parameters(self, start: Array, stop: Array) -> tuple[Array, float]:
        """Return the kernel's parameters for a straight line in the plane, and its length [m]; of a law of one scale.

        On brackets it is a law of any number of scales, and the kernel `ON_BRACKETS`.
        """
        length = float(np.hypot(*(stop - start)))
        direction = (stop - start) / length if length else np.zeros(2)
        if self.brackets is not None:
            return np.concatenate([[len(self.scales)], start, direction, self.mount_parameters()]), length
        return np.concatenate([self.rate_parameters(), *map(elastic_of, self.laws), start, direction]), length

    def trace(self, deflection: ArrayLike) -> PlaneTrace:
        """Return forces, states and work along straight lines between the points of a path, entered unloaded.

        The path [m], (n_t, 2), of roll and the other axis has at least two finite points.
        """
        path = np.asarray(deflection, dtype=np.float64)
        if path.ndim != 2 or path.shape[0] < 2 or path.shape[1] != 2 or not np.isfinite(path).all():
            raise ValueError(f"`deflection` must be at least 2 finite points of the plane, got shape {path.shape}.")
        if self.brackets is not None:
            parameters, _ = self.line_parameters(path[0], path[0])
            force, states, work = follow_plane(ON_BRACKETS, parameters, 1, path, 2 * len(self.scales))
            states = states.reshape(len(path), 2, -1).sum(axis=2)
        else:
            of_scales = [(scale.kernel, scale.line_parameters(path[0], path[0])[0]) for scale in self.scales]
            followed = [follow_plane(kernel, parameters, 12, path, 2) for kernel, parameters in of_scales]
            force, states, work = (sum(parts[1:], start=parts[0]) for parts in zip(*followed, strict=True))
        finite = np.isfinite(force).all(axis=1) & np.isfinite(work)
        if not finite.all():
            raise ValueError(f"the force of {self} leaves the finite numbers at {path[np.argmin(finite)]} m.")
        return PlaneTrace(deflection=path, force=force, hysteretic_state=states, work=work)


def require_couplable(axis: str, law: Law, allowed: tuple[int, ...], kind: str) -> None:
    """Raise ValueError unless a law is a bounded Bouc-Wen law of one of the allowed kernels; `kind` says which these are."""
    if not isinstance(law, Law) or law.kernel not in allowed:
        got, hint = (law.name, "") if isinstance(law, Law) else (repr(law), "")
        if isinstance(law, Law) and any(part.kernel == STOP for part in law.components):
            hint = " Beside a coupled isolator a stop is a mount of its own."
        raise ValueError(f"`{axis}` must be {kind} to be coupled, got {got}.{hint}")
    if not math.isfinite(form_of(law)[2]):
        raise ValueError(f"`{axis}` must have `beta` + `gamma` > 0 to be coupled: without a bound it has no scale.")


def require_alike(names: tuple[str, str], first_law: Law, second_law: Law) -> None:
    """Raise ValueError unless two laws have the same n and sigma."""
    (s1, n1, _, _), (s2, n2, _, _) = form_of(first_law), form_of(second_law)
    for name, first, second in (("n", n1, n2), ("sigma = beta / (beta + gamma)", s1, s2)):
        if not math.isclose(first, second, rel_tol=SAME):
            raise ValueError(
                f"`{names[0]}` and `{names[1]}` must have the same {name} to be coupled, got {first:.6g} and {second:.6g}."
            )


Form = tuple[float, float, float, float]  # sigma, n, z_m and x_y


def form_of(law: Law) -> Form:
    """Return sigma, n, the bound z_m [N] and yield deflection x_y [m] of a Bouc-Wen law; z_m is infinite if z is unbounded."""
    alpha, beta, gamma, n = (float(value) for value in law.kernel_parameters()[:4])
    if beta + gamma <= 0.0:
        return math.nan, n, math.inf, math.inf
    bound = (alpha / (beta + gamma)) ** (1.0 / n)
    return beta / (beta + gamma), n, bound, bound / alpha


def rates_in_plane(first: Form, second: Form) -> tuple[float, ...]:
    """Return sigma, n, the bounds and the yield deflections of two laws' forms in the order of the kernel."""
    return first[0], first[1], first[2], second[2], first[3], second[3]


def elastic_of(law: Law) -> Array:
    """Return k1, k2, k3 of a law's elastic force k1 x + k2 sgn(x) x^2 + k3 x^3, (3,)."""
    elastic = law.kernel_parameters()[4:7]
    return np.concatenate([elastic, np.zeros(3 - elastic.size)])


def asymmetry_of(law: Law) -> float:
    """Return the exponent lambda of F2 = exp(lambda x) [1/m], 0 for a law without F2."""
    return float(law.kernel_parameters()[7]) if law.kernel == ASYMMETRIC_BOUC_WEN else 0.0


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
    """

    kernel: ClassVar[int] = BIAXIAL

    # BoucWen, Ozdemir, SymmetricBoucWen or EnhancedDryFriction
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
        return self.roll, self.shear
