"""Slopes of closed Bouc-Wen loops: over the force, and where the force is zero."""

import numpy as np
import numpy.typing as npt

import wirerope_mj as wr


def slopes_over_force(loop: wr.Loop, *, rising: bool) -> tuple[npt.NDArray[np.float64], npt.NDArray[np.float64]]:
    """Return the force [N] and dF/dx [N/m] at the middles of all intervals of one branch."""
    x, force = loop.branch(rising=rising)
    return (force[1:] + force[:-1]) / 2.0, np.diff(force) / np.diff(x)


def slope_at_zero(law: wr.BoucWen, loop: wr.Loop, *, rising: bool) -> float:
    """Return dF/dx [N/m] where one branch of a closed loop passes through zero force."""
    x, force = loop.branch(rising=rising)
    sign = 1.0 if rising else -1.0
    zero = float(np.interp(0.0, sign * force, x))
    step = sign * 1e-6 * loop.amplitude  # short enough for the slope not to change, long enough for the force's digits
    probe = law.trace([x[0], zero - step, zero + step], initial_states=[force[0]]).force
    return float((probe[2] - probe[1]) / (2.0 * step))
