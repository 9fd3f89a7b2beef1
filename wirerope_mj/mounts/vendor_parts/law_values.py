"""Values that a data sheet states, computed from a law by its own path integration.

Nothing here knows the closed forms that the fits use, so that these functions can judge the fits.
"""

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np
import scipy

from wirerope_mj.foundation.errors import ConvergenceError
from wirerope_mj.mounts.laws import Law, LoopBoucWen
from wirerope_mj.mounts.test_rig import cyclic_test


@dataclass(frozen=True, kw_only=True)
class Secant:
    """A secant stiffness at a deflection, of a steady loop or of the virgin path."""

    deflection: float  # compression or amplitude [m]
    stiffness: float  # [N/m]
    steady: bool  # whether of the steady loop of this amplitude; else of the virgin path


def virgin_force(law: Law, deflection: float) -> float:
    """Return the force [N] at `deflection` [m] on the first loading from the unloaded state."""
    return float(law.trace([0.0, deflection]).force[-1])


def relaxed_force(law: Law, deflection: float) -> float:
    """Return the force [N] at `deflection` [m] with z = 0, where long vibration leaves a hysteretic law."""
    return float(law.trace([deflection, deflection]).force[0])


def secant(law: Law, stated: Secant, about: float = 0.0) -> float:
    """Return the secant stiffness [N/m] that a law has where a value is stated, a steady loop about a deflection [m].

    A virgin path leads into compression.
    """
    if not stated.steady:
        return -virgin_force(law, -stated.deflection) / stated.deflection
    return cyclic_test(law, stated.deflection, operating_point=about)[0].secant_stiffness


def damping_ratio(law: Law, amplitude: float) -> float:
    return cyclic_test(law, amplitude)[0].damping_ratio


def sag(force: Callable[[float], float], load: float, travel: float) -> float:
    """Return the deflection [m], > 0, up to `travel` at which `force` of a deflection carries `load` [N]."""
    if force(travel) < load:
        raise ConvergenceError(
            f"the load of {load:.6g} N is not carried within {travel:.6g} m, where the force is {force(travel):.6g} N: "
            "check load and travel of the data sheet."
        )
    return float(scipy.optimize.brentq(lambda x: force(x) - load, 0.0, travel, xtol=1e-14, rtol=1e-14))


def compression_sag(law: Law, load: float, travel: float, *, relaxed: bool = False) -> float:
    """Return the compression [m], > 0, under `load` [N] on the virgin path, or with z = 0 if `relaxed`."""
    follow = relaxed_force if relaxed else virgin_force
    return sag(lambda x: -follow(law, -x), load, travel)


def diagonal_secant(law: LoopBoucWen, deflection: float, *, steady: bool) -> float:
    """Return the secant stiffness [N/m] along 45 degrees between compression and roll, held on that straight line.

    It is that of the virgin path to a deflection along the line [m], or of the steady loop of that amplitude, the fourth
    cycle.
    """
    line = np.array([1.0, -1.0]) * np.sqrt(0.5)
    turns = [0.0, *[1.0, -1.0] * 4, 1.0] if steady else [0.0, 1.0]
    force = law.trace(deflection * np.outer(turns, line)).force @ line
    if steady:
        return float((force[-1] - force[-2]) / (2.0 * deflection))
    return float(force[-1] / deflection)
