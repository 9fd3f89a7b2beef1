"""Equality constraints, which are rigid everywhere: welds, connections, coupled joints and tendons, edges of flexes.

MuJoCo makes a constraint soft: by its default impedance, 0.9 to 0.95, it leaves 5 to 10 % of the acceleration that would part
what it joins, and two bodies of 0.5 and 3 kg swing at 49 Hz for 39. What says no impedance of its own gets the largest that
MuJoCo has.
"""

import mujoco
import numpy as np
import scipy

from wirerope_mj.foundation.arrays import Array, Integers
from wirerope_mj.foundation.errors import ModelError

_STIFFEST = (0.9999, 0.9999, 0.001, 0.5, 2.0)  # the largest impedance that MuJoCo takes
_RANK = 1e-9  # singular value over the largest below which constraints are one and the same


def stiffen(spec: mujoco.MjSpec) -> None:
    """Make rigid, in place, the equality constraints that leave `solimp` to MuJoCo.

    One whose `solref` is negative says a stiffness, and stays as soft as that.
    """
    default = mujoco.MjSpec().add_equality()
    for element in spec.equalities:
        if np.array_equal(element.solimp, default.solimp) and element.solref[0] > 0.0:
            element.solimp = _STIFFEST


def jacobian(model: mujoco.MjModel, data: mujoco.MjData) -> Array:
    """Compute the rates of all constraints in `data` by velocity coordinates, (n_constraints, n_v)."""
    rates = np.zeros((model.nv, data.nefc))
    for rate, unit in zip(rates, np.eye(model.nv), strict=True):
        if data.nefc:
            mujoco.mj_mulJacVec(model, data, rate, unit)
    return rates.T


def equality_rows(data: mujoco.MjData) -> Integers:
    """Find the rows of equality constraints among all that act in `data`."""
    return np.flatnonzero(data.efc_type[: data.nefc] == int(mujoco.mjtConstraint.mjCNSTR_EQUALITY))


def free_motions(constraints: Array) -> Array:
    """Return a basis of the motions that constraints, (n_rows, n), leave free, (n, n_left); the unit matrix without any."""
    return scipy.linalg.null_space(constraints, rcond=_RANK) if len(constraints) else np.eye(constraints.shape[1])


def equality_name(model: mujoco.MjModel, number: int) -> str:
    """Name an equality constraint and what it joins."""
    kind = mujoco.mjtEq(model.eq_type[number]).name.removeprefix("mjEQ_").lower()
    of = mujoco.mjtObj(model.eq_objtype[number])
    of = {"joint": mujoco.mjtObj.mjOBJ_JOINT, "tendon": mujoco.mjtObj.mjOBJ_TENDON}.get(kind, of)
    if kind.startswith("flex"):
        of = mujoco.mjtObj.mjOBJ_FLEX
    ends = (mujoco.mj_id2name(model, of, int(end[number])) for end in (model.eq_obj1id, model.eq_obj2id) if end[number] >= 0)
    name = mujoco.mj_id2name(model, mujoco.mjtObj.mjOBJ_EQUALITY, number)
    return f"equality{f' {name!r}' if name else ''} ({kind} of {' and '.join(repr(end) for end in ends)})"


def check_base_is_free(model: mujoco.MjModel, base: str, driven: list[int]) -> None:
    """Raise ModelError if an equality constraint fixes the driven base, with nothing that can give way."""
    data = mujoco.MjData(model)
    mujoco.mj_fwdPosition(model, data)
    rows = equality_rows(data)
    moves = np.abs(jacobian(model, data)[rows]) > _RANK
    constrained = moves[:, driven].any(axis=1) & ~np.delete(moves, driven, axis=1).any(axis=1)
    for number in data.efc_id[rows][constrained].tolist()[:1]:
        raise ModelError(
            f"{equality_name(model, number)} holds the driven base {base!r}, which moves as the motion says. Remove it, or "
            "join what the base carries."
        )
