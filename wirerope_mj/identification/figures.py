"""The figures that a data sheet states, found back from a law by its own path integration.

Nothing here knows the closed forms that the fits use, so that these functions can judge the fits.
"""

from collections.abc import Callable

import numpy as np
from scipy.optimize import brentq

from wirerope_mj.bench import cyclic_test
from wirerope_mj.errors import ConvergenceError
from wirerope_mj.laws import Law

_DIAGONAL = float(np.sqrt(0.5))  # share of a deflection at 45 degrees that each of the two axes takes


def virgin_force(law: Law, deflection: float) -> float:
    """Return the force [N] at `deflection` [m] on the first loading from the unloaded state."""
    return float(law.trace([0.0, deflection]).force[-1])


def relaxed_force(law: Law, deflection: float) -> float:
    """Return the force [N] at `deflection` [m] with z = 0, where long vibration leaves a hysteretic law."""
    return float(law.trace([deflection, deflection]).force[0])


def relaxed_stiffness(law: Law, deflection: float, step: float = 1e-6) -> float:
    """Return the tangent [N/m] of a small vibration about `deflection` [m] with z = 0.

    Two difference quotients are extrapolated: z(-h) = -z(h) leaves an error of first order in the step, h / x_y.
    """

    def quotient(h: float) -> float:
        forces = [float(law.trace([deflection, deflection + sign * h]).force[-1]) for sign in (1.0, -1.0)]
        return (forces[0] - forces[1]) / (2.0 * h)

    return 2.0 * quotient(step / 2.0) - quotient(step)


def damping_ratio(law: Law, amplitude: float) -> float:
    """Return the equivalent damping ratio [-] of the steady loop of `amplitude` [m] about zero."""
    return cyclic_test(law, amplitude)[0].damping_ratio


def tension_ratio(law: Law, deflection: float) -> float:
    """Return F(+D) / |F(-D)| [-] on the virgin paths."""
    return virgin_force(law, deflection) / abs(virgin_force(law, -deflection))


def sag(force: Callable[[float], float], load: float, travel: float) -> float:
    """Return the deflection [m], > 0, up to `travel` at which `force` of a deflection carries `load` [N]."""
    if force(travel) < load:
        raise ConvergenceError(
            f"the load of {load:.6g} N is not carried within {travel:.6g} m, where the force is {force(travel):.6g} N: "
            "check load and travel of the data sheet."
        )
    return float(brentq(lambda x: force(x) - load, 0.0, travel, xtol=1e-14, rtol=1e-14))


def compression_sag(law: Law, load: float, travel: float, *, relaxed: bool = False) -> float:
    """Return the compression [m], > 0, under `load` [N] on the virgin path, or with z = 0 if `relaxed`."""
    follow = relaxed_force if relaxed else virgin_force
    return sag(lambda x: -follow(law, -x), load, travel)


def diagonal_force(axial: Law, roll: Law, deflection: float, *, relaxed: bool = False) -> float:
    """Return the force [N] along a deflection [m] held straight at 45 degrees between compression and roll."""
    follow = relaxed_force if relaxed else virgin_force
    share = _DIAGONAL * deflection
    return _DIAGONAL * (follow(roll, share) - follow(axial, -share))


def diagonal_stiffness(axial: Law, roll: Law, deflection: float) -> float:
    """Return the tangent [N/m] along 45 degrees of a small vibration about `deflection` [m] with z = 0."""
    share = _DIAGONAL * deflection
    return (relaxed_stiffness(axial, -share) + relaxed_stiffness(roll, share)) / 2.0


def resonance(stiffness: float, mass: float) -> float:
    """Return the natural frequency sqrt(k / m) / 2 pi [Hz]."""
    return float(np.sqrt(stiffness / mass) / (2.0 * np.pi))
