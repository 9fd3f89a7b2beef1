"""Distance of a system from tipping over."""

from collections.abc import Iterator
from dataclasses import dataclass
from typing import Any

import mujoco
import numpy as np
import scipy

from wirerope_mj.dynamics.modes.eigen import FREE, solve
from wirerope_mj.dynamics.modes.rest import AtRest
from wirerope_mj.engine.statics.payloads import movers_of
from wirerope_mj.engine.system import System
from wirerope_mj.foundation.arrays import Array
from wirerope_mj.foundation.json_values import json_values

_FAR = 20.0  # gravity factor, and rise [m], from which both say no more than: far
AMPLE = 3.0
"""Gravity factor from which a payload stands safely; less is called slender."""


@dataclass(frozen=True, kw_only=True)
class TippingStability:
    """Distance of the stiffness from being indefinite, with the tangents of the mounts as they are at rest.

    About the virgin position these are those of small cycles. About the relaxed one they are those of the elastic parts alone:
    under lasting vibration the hysteretic forces leak away, and what they hold up keeps sinking.

    Attributes:
        smallest_eigenvalue: of stiffness over mass [(rad/s)^2]; below zero the payload tips over, at zero nothing holds it.
        gravity_factor: times the weight, preload included, at which it tips over; infinite if it never does.
        rise: by which the centre of mass of a payload, or of a part of it that is jointed, could stand higher before it tips
            over [m], the smallest of all; infinite if none can, 0 if it does. What stands on a part counts with it.
        softest: the gravity factor with the mounts' tangents on further loading instead of small cycles.
    """

    smallest_eigenvalue: float
    gravity_factor: float
    rise: float
    softest: float

    @property
    def stable(self) -> bool:
        """True if every displacement is brought back."""
        return self.smallest_eigenvalue > 0.0

    @property
    def word(self) -> str:
        """Return "stable", "slender" (gravity factor below 3), "not held" (a motion without stiffness) or "tips over"."""
        if self.smallest_eigenvalue < 0.0:
            return "tips over"
        if self.smallest_eigenvalue == 0.0:
            return "not held"
        return "stable" if self.gravity_factor >= AMPLE else "slender"

    @property
    def description(self) -> str:
        """Return a sentence on how far the system is from tipping over."""
        if self.word == "tips over":
            return "it tips over: its mounts do not hold its weight upright."
        if self.word == "not held":
            return "something moves without any stiffness: no mount, joint or stop holds it."
        if self.gravity_factor > _FAR and self.rise > _FAR:
            return f"{self.word}, large margin."
        limits = []
        if np.isfinite(self.gravity_factor):
            limits.append(f"at {self.gravity_factor:.2g} times its weight")
        if np.isfinite(self.rise):
            limits.append(f"with its centre of mass, or that of a part on a joint, {self.rise:.2g} m higher")
        return f"{self.word}; it would tip over {', or '.join(limits)}."

    def to_dict(self) -> dict[str, Any]:
        """Return plain values; what is infinite is None."""
        values: dict[str, Any] = json_values(
            {
                "word": self.word,
                "smallest_eigenvalue_1_s2": self.smallest_eigenvalue,
                "gravity_factor": self.gravity_factor,
                "rise_m": self.rise,
                "gravity_factor_on_loading": self.softest,
            }
        )
        return values


def stability_of(system: System, rest: AtRest, tangent: Array, loading: Array) -> TippingStability:
    """Return the stability of a system.

    Args:
        system: the system.
        rest: where it rests.
        tangent: stiffness of the mounts that holds, (n, n): in small cycles, or what lasts.
        loading: their stiffness on further loading, (n, n).
    """
    stiffness = rest.other + rest.weight + tangent
    values, _ = solve(stiffness, rest.mass)
    return TippingStability(
        smallest_eigenvalue=float(values.min(initial=np.inf)),
        gravity_factor=_critical(rest.other + tangent, -rest.weight),
        rise=min((_critical(stiffness, load) for load in _overturning(system, rest)), default=np.inf),
        softest=_critical(rest.other + loading, -rest.weight),
    )


def _critical(stiffness: Array, load: Array) -> float:
    """Return the smallest factor > 0 at which stiffness - factor * load is no longer positive definite."""
    try:
        grows = scipy.linalg.eigvalsh(load, stiffness)  # load v = (1 / factor) stiffness v
    except np.linalg.LinAlgError:
        return 0.0  # not positive definite without any load
    largest = float(grows.max(initial=0.0))
    return 1.0 / largest if largest > FREE else np.inf


def _overturning(system: System, rest: AtRest) -> Iterator[Array]:
    """Yield what the weight of each moving body takes from the stiffness against tilting per metre of height [N], (n, n)."""
    model, data = system.model, rest.data
    up = -model.opt.gravity
    size = float(np.linalg.norm(up))
    if size == 0.0:
        return
    level = np.eye(3) - np.outer(up, up) / size**2
    for body in (body for mover in movers_of(system) for body in mover.bodies if model.body_dofnum[body]):
        turn, unused = np.zeros((3, model.nv)), np.zeros((3, model.nv))
        mujoco.mj_jacBody(model, data, unused, turn, body)
        tilt = level @ turn[:, rest.free]
        yield float(model.body_subtreemass[body]) * size * tilt.T @ tilt
