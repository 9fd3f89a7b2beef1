"""Laws made of dry friction: TNO's enhanced dry friction and the Masing model of Jenkin elements."""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace
from typing import Annotated, ClassVar, Self

import numpy as np

from wirerope_mj.foundation.arrays import Array, Entries
from wirerope_mj.foundation.jit import njit
from wirerope_mj.foundation.lanes import count
from wirerope_mj.foundation.structure import bounds
from wirerope_mj.mounts.laws.bouc_wen import BOUC_WEN, Normalised
from wirerope_mj.mounts.laws.law import FAINT, Cubic, Law, Quadratic, Spring, anywhere
from wirerope_mj.mounts.laws.ni import polynomial

MASING = 6
ELEMENTS = 3  # Place of the number of Jenkin elements among Masing's parameters, behind those of the spring


@dataclass(frozen=True, kw_only=True)
class EnhancedDryFriction(Law):
    """TNO's law, thesis (2.1): a spring k [N/m] beside dry friction d [N] that builds up over the deflection u_c [m].

        F = k x + z,   zdot = (d xdot - |xdot| z) / u_c

    From a reversal at (x_r, z_r) in direction s: z = s d + (z_r - s d) exp(-|x - x_r| / u_c). It is the Bouc-Wen law with
    alpha = d / u_c, beta = 1 / u_c, gamma = 0, n = 1, and Dahl's with exponent 1. A steady loop of amplitude A has the area
    4 d [A - u_c tanh(A / u_c)]. u_c = 0 would be dry friction itself, whose force is not defined at rest.
    """

    name: ClassVar[str] = "enhanced-dry-friction"
    kernel: ClassVar[int] = BOUC_WEN
    example: ClassVar[Entries] = {"k": 5e4, "d": 300.0, "u_c": 3e-3}
    smoothable: ClassVar[bool] = True
    faint_parameters: ClassVar[Mapping[str, float]] = {"k": 0.0, "d": 1.0, "u_c": 1.0 / FAINT}  # as `Hysteresis`
    yield_powers: ClassVar[Mapping[str, float]] = {"u_c": 1.0}
    state_names: ClassVar[tuple[str, ...]] = ("z",)
    damping_parameters: ClassVar[tuple[str, ...]] = ("d",)
    elastic: ClassVar[tuple[str, ...]] = ("k",)

    k: Spring
    d: Annotated[float, bounds("N", gt=0.0)]
    u_c: Annotated[float, bounds("m", gt=0.0)]

    def kernel_parameters(self) -> Array:
        return np.array([self.d / self.u_c, 1.0 / self.u_c, 0.0, 1.0, self.k])

    @property
    def z_max(self) -> float:
        """Bound d of the friction force [N]."""
        return self.d

    @property
    def normalised(self) -> Normalised:
        """Normalised form of the equivalent Bouc-Wen law."""
        return Normalised(z_max=self.d, x_y=self.u_c, sigma=1.0, n=1.0)

    normal_form = normalised

    @property
    def bouc_wen_parameters(self) -> Array:  # type: ignore[override]
        """Parameters of the equivalent Bouc-Wen law."""
        return self.kernel_parameters()[:4]

    @property
    def coordinates(self) -> dict[str, float]:
        return {"d": self.d, "u_c": self.u_c, "k": self.k}

    @property
    def initial_stiffness(self) -> float:
        return self.d / self.u_c + self.k


@dataclass(frozen=True, kw_only=True)
class Masing(Law):
    """Masing's model: Jenkin elements, each a spring c_e [N/m] in series with a slider h_e [N], beside Ni's polynomial spring.

        F = F1(x) + sum f_e,   fdot_e = c_e xdot while |f_e| < h_e or f_e xdot < 0, else 0
        F1 = k x + k2 sgn(x) x^2 + k3 x^3

    The virgin curve is F1 + sum min(c_e x, h_e); the sliders' part of every later branch is theirs doubled (Masing's rule), and
    a closed inner loop is forgotten (return-point memory), which Bouc-Wen laws lack: the mean of this law does not drift under
    vibration. A steady loop of amplitude A has the area sum of 4 h_e (A - h_e / c_e) over the elements that slip. k [N/m],
    k2 [N/m^2] and k3 [N/m^3] are those of `SymmetricBoucWen`; they harden a loop at large deflections, and make no area.
    Sources: Sauter and Hagedorn (2002), thesis 2.5.2; F1 thesis (3.16).

    In MuJoCo an element's force grows elastically within a step; each stage clips it to +-h_e and the overshoot is taken out of
    the state at the end of the step, which is exact while the mount does not turn back within it. The order is therefore 2.
    """

    name: ClassVar[str] = "masing"
    kernel: ClassVar[int] = MASING
    example: ClassVar[Entries] = {
        "stiffness": [6e4, 4e4, 3e4], "slip_force": [60.0, 100.0, 200.0], "k": 2e4, "k2": 1e5, "k3": 2e7,
    }  # fmt: skip
    damping_parameters: ClassVar[tuple[str, ...]] = ("stiffness", "slip_force")
    elastic: ClassVar[tuple[str, ...]] = ("k", "k2", "k3")
    yield_powers: ClassVar[Mapping[str, float]] = {"stiffness": -1.0}

    stiffness: Annotated[Sequence[float], bounds("N/m")]
    slip_force: Annotated[Sequence[float], bounds("N")]
    k: Spring = 0.0
    k2: Quadratic = 0.0
    k3: Cubic = 0.0

    def _validate(self) -> None:
        if not self.stiffness or len(self.stiffness) != len(self.slip_force):
            raise ValueError(
                "`stiffness` and `slip_force` must have one entry for each Jenkin element, at least one, "
                f"got {len(self.stiffness)} and {len(self.slip_force)}."
            )
        for key in ("stiffness", "slip_force"):
            for value in getattr(self, key):
                if anywhere(value <= 0.0):
                    raise ValueError(f"every entry of `{key}` must be > 0, got {value}.")

    def kernel_parameters(self) -> Array:
        elements = [len(self.stiffness), *self.stiffness, *self.slip_force]
        return np.array([self.k, self.k2, self.k3, *elements], dtype=np.float64)

    @property
    def state_names(self) -> tuple[str, ...]:  # type: ignore[override]
        """The force z1, z2, ... of every Jenkin element."""
        return tuple(f"z{e + 1}" for e in range(len(self.stiffness)))

    @property
    def z_max(self) -> float:
        """Bound of the sliders' force, the sum of the slip forces [N]."""
        return float(sum(self.slip_force))

    @property
    def initial_stiffness(self) -> float:
        return float(sum(self.stiffness) + self.k)

    @property
    def coordinates(self) -> dict[str, float]:
        pairs = sorted(zip(self.stiffness, self.slip_force, strict=True), key=lambda pair: pair[1] / pair[0])
        slip = [h / c for c, h in pairs]
        values = {"k": self.k, "k2": self.k2, "k3": self.k3, "x1": slip[0]}
        values |= {f"c{e}": c for e, (c, _) in enumerate(pairs, start=1)}
        return values | {f"x{e + 1}/x{e}": slip[e] / slip[e - 1] for e in range(1, len(slip))}

    def faint(self) -> Self:
        faint = (FAINT,) * len(self.stiffness)
        return replace(self, stiffness=faint, slip_force=faint, k=0.0, k2=0.0, k3=0.0)

    def same_structure(self, other: Law | None) -> bool:
        return type(self) is type(other) and self.n_states == other.n_states


@njit
def masing(p, i, x, v, z, j, zdot, k):
    """Return F = F1(x) + sum of z_e clipped to +-h_e [N]; p = k, k2, k3, number of elements, stiffnesses c_e, slip forces h_e.

    The states grow elastically, beyond h_e too; after every step the overshoot is to be removed by `hold_slip`.
    """
    n = count(p, i + ELEMENTS)
    force = polynomial(p[i], p[i + 1], p[i + 2], x)
    for e in range(n):
        slip = p[i + ELEMENTS + 1 + n + e]
        zdot[k + e] = p[i + ELEMENTS + 1 + e] * v
        force += min(max(z[j + e], -slip), slip)
    return force


@njit
def hold_slip(p, i, z, j):
    """Clip the states of Masing's law to the slip forces, in place."""
    n = count(p, i + ELEMENTS)
    for e in range(n):
        slip = p[i + ELEMENTS + 1 + n + e]
        z[j + e] = min(max(z[j + e], -slip), slip)


@njit
def masing_increment(p, i, x0, x1, z, j):
    """Carry the states of Jenkin elements from x0 to x1 and return the work done on the law [J]."""
    n, dx = int(p[i + ELEMENTS]), x1 - x0
    work = energy(p[i], p[i + 1], p[i + 2], x1) - energy(p[i], p[i + 1], p[i + 2], x0)
    for e in range(n):
        stiffness, slip = p[i + ELEMENTS + 1 + e], p[i + ELEMENTS + 1 + n + e]
        start = min(max(z[j + e], -slip), slip)
        end = min(max(start + stiffness * dx, -slip), slip)
        elastic = (end - start) / stiffness
        work += 0.5 * (start + end) * elastic + end * (dx - elastic)
        z[j + e] = end
    return work


@njit
def energy(k, k2, k3, x):
    """Return the energy in Ni's polynomial spring [J], the integral of F1 from 0."""
    return x * x * (k / 2.0 + k2 / 3.0 * abs(x) + k3 / 4.0 * x * x)
