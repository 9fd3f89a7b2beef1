"""A law in series with an elastic bracket, bolt or foot that has stiffness and no mass."""

from collections.abc import Mapping
from dataclasses import dataclass, replace
from typing import Any, ClassVar, Self

import numpy as np

from wirerope_mj.foundation.arguments import positive
from wirerope_mj.foundation.arrays import Array
from wirerope_mj.mounts.laws.bouc_wen import BOUC_WEN
from wirerope_mj.mounts.laws.law import Law, of_law
from wirerope_mj.mounts.laws.ni import ASYMMETRIC_BOUC_WEN, SYMMETRIC_BOUC_WEN
from wirerope_mj.mounts.laws.parallel import Parallel
from wirerope_mj.mounts.laws.tabulated import TABULATED
from wirerope_mj.mounts.laws.vaiana_rosati import VAIANA_ROSATI
from wirerope_mj.mounts.laws.viscoelastic import KelvinVoigt, Zener

ON_BRACKET = 16
HEAD = 2  # parameters before those of the laws, which stand as in `Parallel`

# One state whose rate is a slope for each direction times that of the deflection, and a force that depends on no rate.
_BEHIND = (BOUC_WEN, SYMMETRIC_BOUC_WEN, ASYMMETRIC_BOUC_WEN, TABULATED, VAIANA_ROSATI)


def on_bracket(law: Law, stiffness: float) -> Law:
    """Build the law of a mount with `law` in series with a spring [N/m].

    Exact: of a linear law the linear law that both make together, of friction and hysteresis `OnBracket`.

    Raises:
        ValueError: the law is neither.
    """
    positive("stiffness", stiffness, unit="N/m")
    if isinstance(law, KelvinVoigt | Zener):
        k0, k1 = (law.k, 0.0) if isinstance(law, KelvinVoigt) else (law.k0, law.k1)
        slow = k0 * stiffness / (k0 + stiffness)
        if law.c == 0.0:
            return KelvinVoigt(k=slow, c=0.0)
        # the damper sees k1 in series with what holds its ends; stiff against a sudden deflection is all but the damper
        sudden = stiffness if not k1 else (k0 + k1) * stiffness / (k0 + k1 + stiffness)
        decay = law.c * ((1.0 / k1 if k1 else 0.0) + 1.0 / (k0 + stiffness))
        return Zener(k0=slow, k1=sudden - slow, c=decay * (sudden - slow))
    return OnBracket(law=law, stiffness=stiffness)


@dataclass(frozen=True, kw_only=True)
class OnBracket(Law):
    """A rate-independent law in series with a spring K: F = f(d, z), d + F / K = x, with the law's own states z.

    The states follow the law's own deflection d, for whose rate the same is differentiated,

        ddot = xdot K / (K + T),   T = df/dd + df/dz dz/dd   in the direction of xdot,

    so that it has no states but the law's, and K adds nothing fast. d is found to rounding, T by a forward difference over
    10 nm to 1e-6 of itself. It lives in memory alone: an isolator file holds the law and, in [bracket], K.
    """

    name: ClassVar[str] = "on-bracket"
    kernel: ClassVar[int] = ON_BRACKET
    force_powers: ClassVar[Mapping[str, float]] = {}

    # Bouc-Wen's, Ni's, Ozdemir's, the enhanced dry friction, the tabulated one, Vaiana and Rosati's, or some in parallel
    law: Law
    stiffness: float  # K [N/m]

    travel_ends = of_law("travel_ends", "Deflections up to which the law holds, short by the bracket's share [m].")
    finite_travel = of_law("finite_travel", "The shorter of both [m].")
    largest_force = of_law("largest_force", "That of the law [N].")
    state_names = of_law("state_names", "Those of the law.")
    damping_parameters = of_law("damping_parameters", "Those of the law.")

    def __post_init__(self) -> None:
        refused = [one.name for one in self.law.components if one.kernel not in _BEHIND]
        if refused:
            raise ValueError(f"a bracket can hold a linear law, Bouc-Wen's, Ni's, a tabulated one, not {refused[0]}.")
        object.__setattr__(self, "stiffness", positive("stiffness", self.stiffness, unit="N/m"))

    def _validate(self) -> None:
        """Do nothing: the law has checked itself."""

    def kernel_parameters(self) -> Array:
        """Return K, the number of states, and the laws as several in parallel have them."""
        behind = Parallel(laws=self.law.components)
        return np.concatenate([[self.stiffness, float(self.n_states)], behind.kernel_parameters()])

    @property
    def initial_stiffness(self) -> float:
        """Tangent at the unloaded state [N/m]."""
        own = self.law.initial_stiffness
        return own * self.stiffness / (own + self.stiffness)

    def certainly_valid(self, columns: Mapping[str, Any]) -> bool:
        """Return whether there are no columns: each entry has to be tried."""
        return not columns

    def scaled(self, factor: float) -> Self:
        """Return law and bracket with `factor` times their forces."""
        return replace(self, law=self.law.scaled(factor), stiffness=factor * self.stiffness)

    def with_damping(self, factor: float) -> Self:
        """Return the law with `factor` times the hysteretic part, on the same bracket."""
        return replace(self, law=self.law.with_damping(factor))

    def with_yield(self, factor: float) -> Self:
        """Return the law whose friction builds up over `factor` times its own deflection, on the same bracket."""
        return replace(self, law=self.law.with_yield(factor))

    def to_dict(self) -> dict[str, Any]:
        """Raise ValueError: an isolator file holds the law itself."""
        raise ValueError("a law on a bracket is not written to a file: save the isolator with its `bracket`.")
