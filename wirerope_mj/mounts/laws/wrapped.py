"""A law that wraps another law: smoothed, to be differentiated at reversals, or in series with an elastic bracket."""

from dataclasses import dataclass, replace
from operator import attrgetter
from typing import Any, ClassVar, Self

import numpy as np

from wirerope_mj.foundation.arguments import positive
from wirerope_mj.foundation.arrays import Array, Entries
from wirerope_mj.mounts.laws.law import Law
from wirerope_mj.mounts.laws.parallel import Parallel
from wirerope_mj.mounts.laws.viscous import KelvinVoigt, Zener

SMOOTHED = 10
ON_BRACKET = 16
HEAD = 2  # parameters of a bracketed law before those of the laws, which stand as in `Parallel`


def _of_law(name: str, doc: str) -> Any:
    return property(lambda self: getattr(self.law, name), doc=doc)


@dataclass(frozen=True, kw_only=True)
class _Wrapped(Law):
    """A law that wraps another law and has its states. It lives in memory alone: an isolator file holds the inner law."""

    law: Law

    travel_ends = _of_law("travel_ends", "Deflections below and above zero up to which the law holds [m].")
    finite_travel = _of_law("finite_travel", "The shorter of both [m].")
    largest_force = _of_law("largest_force", "That of the law [N]: finite without an elastic part.")
    state_names = _of_law("state_names", "Those of the law.")
    damping_parameters = _of_law("damping_parameters", "Those of the law.")

    def certainly_valid(self, columns: Entries) -> bool:
        return not columns

    def same_structure(self, other: Law | None) -> bool:
        return self == other

    def with_friction(self, factor: float) -> Self:
        return replace(self, law=self.law.with_friction(factor))

    def multiplied(self, name: str, factor: float) -> Self:
        return replace(self, law=self.law.multiplied(name, factor))


@dataclass(frozen=True, kw_only=True)
class Smoothed(_Wrapped):
    """A rate-independent law whose slopes for the two directions blend over a velocity.

        zdot = xdot [s+ (1 + tanh(xdot / width)) + s- (1 - tanh(xdot / width))] / 2

    s+ and s- are the slopes dz/dx of `law` for xdot > 0 and < 0, its force is unchanged. For Bouc-Wen's law it replaces
    sgn(xdot) by tanh(xdot / width). All terms carry xdot: at rest nothing creeps. Far below the `width` [m/s] the law loses its
    hysteresis and z its bound. In a motion of frequency w and amplitude A the loop differs from the law's by
    O((width / (w A))^2): the blend covers a path of that order beside each reversal. A hundredth of the velocity amplitude
    changes a loop by 1e-4; what is chosen belongs beside every result, for the law now depends on the rate.

    Laws with one state whose rate is a slope times xdot can be smoothed: Bouc and Wen's, Ni's, Ozdemir's, the enhanced dry
    friction, Vaiana and Rosati's and the tabulated one. A static equilibrium takes z = 0, as after long vibration.

    Source: thesis, summary (its form is not given there).
    """

    name: ClassVar[str] = "smoothed"
    kernel: ClassVar[int] = SMOOTHED
    rate_independent: ClassVar[bool] = False

    width: float

    initial_stiffness = _of_law("initial_stiffness", "Tangent of the law at its unloaded state [N/m].")
    bouc_wen_parameters = _of_law("bouc_wen_parameters", "Those of the law.")
    unsmoothed: ClassVar[Any] = property(attrgetter("law"))

    def __post_init__(self) -> None:
        if not isinstance(self.law, Law) or not smoothable(self.law):
            got = self.law.name if isinstance(self.law, Law) else repr(self.law)
            raise ValueError(f"`law` must have one state whose rate is a slope times the velocity, got {got}.")
        object.__setattr__(self, "width", positive("width", self.width))

    def kernel_parameters(self) -> Array:
        return np.concatenate([[self.width, float(self.law.kernel)], self.law.kernel_parameters()])

    def to_dict(self) -> Entries:
        raise ValueError("a smoothed law is not written to a file: save the isolator with its `law`, and smooth it in memory.")


def smoothable(law: Law) -> bool:
    """True if a law has one state, whose rate is a slope times the deflection rate."""
    return law.smoothable and law.rate_independent and law.n_states == 1


def with_width(law: Law, width: float) -> Law:
    """Return a law smoothed over a velocity [m/s], in each parallel part that can be; the law itself if none can."""
    if isinstance(law, Parallel):
        laws = tuple(with_width(component, width) for component in law.laws)
        return replace(law, laws=laws) if laws != law.laws else law
    return Smoothed(law=law, width=width) if smoothable(law) else law


@dataclass(frozen=True, kw_only=True)
class OnBracket(_Wrapped):
    """A rate-independent law in series with a spring K: F = f(d, z), d + F / K = x, with the law's own states z.

    The states follow the law's own deflection d, for whose rate the same is differentiated,

        ddot = xdot K / (K + T),   T = df/dd + df/dz dz/dd   in the direction of xdot,

    so that it has no states but the law's, and K adds nothing fast. d is found to rounding, T by a forward difference over
    10 nm to 1e-6 of itself. An isolator file holds the law and, in [bracket], K. `law` is Bouc-Wen's, Ni's, Ozdemir's, the
    enhanced dry friction, the tabulated one, Vaiana and Rosati's, or some in parallel.
    """

    name: ClassVar[str] = "on-bracket"
    kernel: ClassVar[int] = ON_BRACKET

    stiffness: float  # K [N/m]

    behind_bracket: ClassVar[Any] = property(attrgetter("law"))
    bracket_stiffness: ClassVar[Any] = property(attrgetter("stiffness"))

    def __post_init__(self) -> None:
        refused = [part.name for part in self.law.components if not part.smoothable or part.stops]
        if refused:
            raise ValueError(
                f"a bracket can hold a linear law, Bouc-Wen's, Ni's, a tabulated one, not {refused[0]}: make that a mount of "
                "its own, without a bracket."
            )
        object.__setattr__(self, "stiffness", positive("stiffness", self.stiffness, unit="N/m"))

    def faint(self) -> Law:
        return self.law.faint()

    def kernel_parameters(self) -> Array:
        behind = Parallel(laws=self.law.components)
        return np.concatenate([[self.stiffness, float(self.n_states)], behind.kernel_parameters()])

    @property
    def initial_stiffness(self) -> float:
        tangent = self.law.initial_stiffness
        return tangent * self.stiffness / (tangent + self.stiffness)

    def multiplied(self, name: str, factor: float) -> Self:
        stiffness = factor * self.stiffness if name == "stiffness" else self.stiffness
        return replace(super().multiplied(name, factor), stiffness=stiffness)

    def to_dict(self) -> Entries:
        raise ValueError("a law on a bracket is not written to a file: save the isolator with its `bracket`.")


def on_bracket(law: Law, stiffness: float) -> Law:
    """Build the law of a mount with `law` in series with a spring [N/m].

    Exact: of a linear law the linear law that both make together, of friction and hysteresis `OnBracket`. ValueError: the law
    is neither.
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
