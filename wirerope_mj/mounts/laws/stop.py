"""A bump stop behind a gap."""

from collections.abc import Mapping
from dataclasses import dataclass
from itertools import pairwise
from typing import Annotated, ClassVar, Self

import numpy as np
import scipy

from wirerope_mj.foundation.arrays import Array, Entries
from wirerope_mj.foundation.structure import NotNegative, bounds
from wirerope_mj.mounts.laws.law import Law, anywhere
from wirerope_mj.mounts.laws.stop_kernels import elastic, rounded_depth
from wirerope_mj.mounts.laws.table_kernels import level_cubics, monotone, packed

STOP = 13
NEVER = 1e300  # Gap of a side without a stop [m]


@dataclass(frozen=True, kw_only=True)
class Stop(Law):
    """A bump stop: no force within the gap, a pushing force beyond it.

        depth = rest - x - gap_below  or  x - rest - gap_above  (whichever is > 0)
        d = r (t^3 - t^4 / 2) for t = depth / r < 1,  depth - r / 2 beyond             r = rounding
        F = -+ max(0, f(d) (1 + loss u) + c d' depthdot),   f(d) = k d^exponent, or through the points `depths`, `forces`

    gap_below, gap_above [m], >= 0, None = no stop on that side; the lower one acts in compression. They count from the
    deflection `rest` [m]: None = 0, the unloaded geometry; gaps as installed count from the sag. k [N/m^exponent]. Rubber
    that is round, or soft to begin with, closes over the depth `rounding` [m]: with it the force has two continuous
    derivatives, without it a corner at the gap. Points (n,) [m] and [N] begin behind the origin and are joined by monotone
    cubics that leave the origin without a slope; beyond the last they go on straight.

    u = -+w is 1 while the stop is pressed and -1 while it is let go, w' = (xdot - |xdot| w) / reversal with the length
    `reversal` [m] over which the force passes from one branch to the other. A push to a depth much larger than that and
    back returns the fraction (1 - loss) / (1 + loss) of its energy, at any rate; with loss <= 1 it never pulls. c [N s/m] is
    viscous: d' is the slope of d over the depth, so that the force is continuous at the touch, for which it needs
    `rounding` > 0; a stop that is left faster than it springs back lets go before it has its shape again.

    Passive: f is a potential, viscous force opposes the rate, and what is left of it where it would pull dissipates too; of
    the hysteretic force see `Tabulated`, whose proof holds for any f >= 0. Source: a gap with a spring and a
    damper as every multibody code has it; loss and rounding are ours.
    """

    name: ClassVar[str] = "stop"
    kernel: ClassVar[int] = STOP
    example: ClassVar[Entries] = {
        "gap_below": 2e-3, "gap_above": 4e-3, "k": 4e6, "exponent": 1.5, "rounding": 2e-3, "loss": 0.4,
        "reversal": 5e-4, "c": 200.0,
    }  # fmt: skip
    smoothable: ClassVar[bool] = True

    gap_below: Annotated[float, bounds("m", ge=0.0)] | None = None
    gap_above: Annotated[float, bounds("m", ge=0.0)] | None = None
    rest: Annotated[float, bounds("m")] | None = None
    k: Annotated[float, bounds("N/m^exponent", gt=0.0)] | None = None
    exponent: float = 1.0
    depths: Annotated[tuple[float, ...], bounds("m")] = ()
    forces: Annotated[tuple[float, ...], bounds("N")] = ()
    rounding: Annotated[float, bounds("m", ge=0.0)] = 0.0
    loss: NotNegative = 0.0
    reversal: Annotated[float, bounds("m", gt=0.0)] | None = None
    c: Annotated[float, bounds("N s/m", ge=0.0)] = 0.0

    def _validate(self) -> None:
        if self.gap_below is None and self.gap_above is None:
            raise ValueError("`gap_below` or `gap_above` must be given: a stop acts on at least one side.")
        if (self.k is None) == (not self.depths and not self.forces):
            raise ValueError("`k`, or `depths` and `forces`, must be given, and not both.")
        if self.k is not None:
            if anywhere(self.exponent < 1.0):
                raise ValueError(
                    f"`exponent` must be >= 1, got {self.exponent}: the stop would be infinitely stiff at the touch."
                )
        else:
            if len(self.depths) != len(self.forces):
                raise ValueError(f"`depths` and `forces` must be as many, got {len(self.depths)} and {len(self.forces)}.")
            if self.exponent != 1.0:
                raise ValueError(f"`exponent` must be left out with `depths` and `forces`, got {self.exponent}.")
            for name in ("depths", "forces"):
                for before, value in pairwise((0.0, *getattr(self, name))):
                    if anywhere(value <= before):
                        raise ValueError(
                            f"`{name}` must grow from above 0 on, got {value} after {before}: the origin is the first point."
                        )
        if anywhere(self.loss > 1.0):
            raise ValueError(f"`loss` must be <= 1, got {self.loss}: the stop would pull.")
        if self.reversal is None and anywhere(self.loss > 0.0):
            raise ValueError(
                "`reversal` must be given with `loss`: the length over which the force turns from pressing to letting go."
            )
        if anywhere((self.c > 0.0) & (self.rounding == 0.0)):
            raise ValueError("`rounding` must be > 0 with `c`: the force would jump at the touch.")

    @property
    def stops(self) -> tuple[Self]:  # type: ignore[override]
        return (self,)

    @property
    def unloaded_gaps(self) -> dict[str, float]:
        """Gaps from the unloaded geometry [m], < 0 where the stop presses there, by side with a stop, "below" or "above"."""
        rest, sides = self.rest or 0.0, {"below": self.gap_below, "above": self.gap_above}
        return {side: gap - rest if side == "below" else gap + rest for side, gap in sides.items() if gap is not None}

    @property
    def coordinates(self) -> dict[str, float]:
        names = ("gap_below", "gap_above", "k", "exponent", "rounding", "loss", "reversal")
        return {name: value for name in names if (value := getattr(self, name)) is not None}

    def kernel_parameters(self) -> Array:
        """Return the parameters of `wirerope_mj.mounts.laws.stop_kernels.stop`."""
        inverse = 1.0 if self.reversal is None else 1.0 / self.reversal
        gaps = self.unloaded_gaps
        ends = [gaps.get(side, NEVER) for side in ("below", "above")]
        head = [inverse, inverse, 0.0, 1.0, self.loss, self.c, *ends, self.rounding]
        if self.k is not None:
            return np.array([*head, self.k, self.exponent, 0.0])
        table = packed(self._curve, level_cubics((), (), 0.0), 1.0, 1.0)[4:]
        depths = []  # of all knots, the constant's too; what lies before the touch stays there
        for counted in table[1 : 1 + int(table[0])].tolist():
            depth = counted + 0.5 * self.rounding
            if 0.0 <= counted < 0.5 * self.rounding:
                depth = float(scipy.optimize.brentq(
                    lambda d, counted=counted: rounded_depth(d, self.rounding)[0] - counted, 0.0, self.rounding, xtol=1e-300
                ))  # fmt: skip
            depths.append(depth)
        return np.array([*head, 0.0, 1.0, *table, *depths])

    @property
    def _curve(self) -> "scipy.interpolate.PPoly":
        """Force over the rounded depth; a point before the origin makes the curve begin flat."""
        return monotone(np.array([-1.0, 0.0, *self.depths]), np.array([0.0, 0.0, *self.forces]))

    def pressed(self, depth: float) -> float:
        """Return the elastic force at a depth behind the gap [N]."""
        return float(elastic(self.kernel_parameters(), 0, rounded_depth(depth, self.rounding)[0])) if depth > 0.0 else 0.0

    @property
    def rate_independent(self) -> bool:  # type: ignore[override]
        """True if the force does not depend on the rate: without viscous loss."""
        return self.c == 0.0

    @property
    def remembers_slow_paths(self) -> bool:
        """True: viscous loss does not touch the state."""
        return True

    @property
    def state_names(self) -> tuple[str, ...]:  # type: ignore[override]
        """The state w of the loss, between -1 and 1; none without loss."""
        return ("w",) if self.loss > 0.0 else ()

    @property
    def force_powers(self) -> Mapping[str, float]:
        """Power of force in the unit of each parameter that is stated."""
        return {name: power for name, power in super().force_powers.items() if getattr(self, name) is not None}

    @property
    def initial_stiffness(self) -> float:
        """Tangent at the unloaded state [N/m]: zero but for a linear stop without gap and rounding."""
        touching = 0.0 in self.unloaded_gaps.values() and self.rounding == 0.0 and self.exponent == 1.0
        return self.k if touching and self.k is not None else 0.0

    @property
    def closed_stiffness(self) -> float:
        """Tangent behind gap and rounding [N/m]: k, the steepest of the points' cubics, of a hardening stop 1 mm deep."""
        if self.k is None:
            return float(self._curve.derivative()(np.array(self.depths)).max())
        return self.k * self.exponent * 1e-3 ** (self.exponent - 1.0)

    @property
    def closed_damping(self) -> float:
        return self.c


def largest_gap(law: Law) -> float:
    """Return the largest gap of the stops among a law [m], 0 without one."""
    stops = [part for part in law.components if isinstance(part, Stop)]
    return max((gap for stop in stops for gap in stop.unloaded_gaps.values()), default=0.0)
