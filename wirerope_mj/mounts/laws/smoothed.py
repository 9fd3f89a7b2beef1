"""A smooth approximation of a rate-independent law, for what differentiates it at reversals."""

from collections.abc import Mapping
from dataclasses import dataclass, replace
from typing import Any, ClassVar, Self

import numpy as np

from wirerope_mj.foundation.arguments import positive
from wirerope_mj.foundation.arrays import Array
from wirerope_mj.mounts.laws.law import Law, of_law
from wirerope_mj.mounts.laws.parallel import Parallel

SMOOTHED = 10


@dataclass(frozen=True, kw_only=True)
class Smoothed(Law):
    """A rate-independent law whose slopes for the two directions blend over a velocity.

        zdot = xdot [s+ (1 + tanh(xdot / width)) + s- (1 - tanh(xdot / width))] / 2

    s+ and s- are the slopes dz/dx of `law` for xdot > 0 and < 0, its force is unchanged. For Bouc-Wen's law it replaces
    sgn(xdot) by tanh(xdot / width). All terms carry xdot: at rest nothing creeps. Far below the `width` [m/s] the law loses its
    hysteresis and z its bound. In a motion of frequency w and amplitude A the loop differs from the law's by
    O((width / (w A))^2): the blend covers a path of that order beside each reversal. A hundredth of the velocity amplitude
    changes a loop by 1e-4; what is chosen belongs beside every result, for the law now depends on the rate.

    Laws with one state whose rate is a slope times xdot can be smoothed: Bouc and Wen's, Ni's, Ozdemir's, the enhanced dry
    friction, Vaiana and Rosati's and the tabulated one. It lives in memory alone: an isolator file holds the law itself. A
    static equilibrium takes z = 0, as after long vibration.

    Source: thesis, summary (its form is not given there).
    """

    name: ClassVar[str] = "smoothed"
    kernel: ClassVar[int] = SMOOTHED
    rate_independent: ClassVar[bool] = False
    force_powers: ClassVar[Mapping[str, float]] = {}

    law: Law
    width: float

    initial_stiffness = of_law("initial_stiffness", "Tangent of the law at its unloaded state [N/m].")
    finite_travel = of_law("finite_travel", "Deflection up to which the law holds [m].")
    travel_ends = of_law("travel_ends", "Deflections below and above zero up to which the law holds [m].")
    largest_force = of_law("largest_force", "That of the law [N]: finite without an elastic part.")
    damping_parameters = of_law("damping_parameters", "Those of the law.")
    state_names = of_law("state_names", "The state of the law.")

    def __post_init__(self) -> None:
        if not isinstance(self.law, Law) or not smoothable(self.law):
            got = self.law.name if isinstance(self.law, Law) else repr(self.law)
            raise ValueError(f"`law` must have one state whose rate is a slope times the velocity, got {got}.")
        object.__setattr__(self, "width", positive("width", self.width))

    def _validate(self) -> None:
        """Do nothing: the law has checked itself."""

    def kernel_parameters(self) -> Array:
        """Return the width, the law's kernel and its parameters."""
        return np.concatenate([[self.width, float(self.law.kernel)], self.law.kernel_parameters()])

    def scaled(self, factor: float) -> Self:
        """Return the smoothed law whose force is `factor` times this one's."""
        return replace(self, law=self.law.scaled(factor))

    def with_damping(self, factor: float) -> Self:
        """Return the smoothed law with `factor` times the hysteretic part."""
        return replace(self, law=self.law.with_damping(factor))

    def to_dict(self) -> dict[str, Any]:
        """Raise ValueError: an isolator file holds the law itself."""
        raise ValueError(
            "a smoothed law is not written to a file: save the isolator with its `law`, and smooth it in memory."
        )


def smoothable(law: Law) -> bool:
    """Return whether a law has one state whose rate is a slope times the velocity."""
    return law.smoothable and law.rate_independent and law.n_states == 1


def with_width(law: Law, width: float) -> Law:
    """Return a law smoothed over a velocity [m/s], of several in parallel each that can be; the law itself if none can."""
    if isinstance(law, Parallel):
        laws = tuple(with_width(one, width) for one in law.laws)
        return replace(law, laws=laws) if laws != law.laws else law
    return Smoothed(law=law, width=width) if smoothable(law) else law
