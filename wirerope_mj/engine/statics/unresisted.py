"""Motions that no mount resists: a body on one mount, or on mounts in line, turns about them."""

from collections.abc import Callable

import mujoco
import numpy as np
import numpy.typing as npt
import scipy

from wirerope_mj.engine.system import System
from wirerope_mj.foundation.arrays import Array

# turn of the differences [rad]: rounding of accelerations, 1e-14 m/s^2, and their curvature both leave less than `SLOW`
TURN = 1e-5
SLOW = 1e-4  # rate of return below which a motion is free [1/s^2]: a pendulum of 100 km


def unresisted(
    system: System, data: mujoco.MjData, free: npt.NDArray[np.int64], accelerations: Callable[[Array], Array]
) -> tuple[str, ...]:
    """Return a message for each motion of a body on mounts that no mount, joint, stop or weight brings back.

    Mounts count as resisting in all three directions here: an axis without a law is the isolator's own property.
    `free` are the velocity coordinates that can move, (n,); `accelerations` returns theirs after a small step of them.
    """
    model = data.model
    jacobians = [_deflections(model, data, sites)[:, free] for sites in system.assembly.tables.sites]
    motions = scipy.linalg.null_space(np.concatenate(jacobians), rcond=1e-9)  # columns
    if not motions.size:
        return ()
    mass = np.zeros((model.nv, model.nv))
    mujoco.mj_fullM(model, data, mass)
    mass = mass[np.ix_(free, free)]
    returns = np.stack([(accelerations(-TURN * m) - accelerations(TURN * m)) / (2.0 * TURN) for m in motions.T], axis=1)
    stiffness = motions.T @ mass @ returns
    if not np.isfinite(stiffness).all():
        return ()
    rates, shapes = scipy.linalg.eigh(0.5 * (stiffness + stiffness.T), motions.T @ mass @ motions)
    motions_of: dict[tuple[int, bool], list[str]] = {}
    for rate, shape in zip(rates, shapes.T, strict=True):
        if rate < SLOW:
            body, motion_text = _rotation(model, data, free, motions @ shape)
            if _mounts_below(system, body):  # what swings on a joint of its own alone was meant to
                motions_of.setdefault((body, rate < -SLOW), []).append(motion_text)
    return tuple(_message(system, body, texts, tips=tips) for (body, tips), texts in motions_of.items())


def _mounts_below(system: System, body: int) -> list[str]:
    """Return the mounts that carry a body, or one that is attached to it."""
    model, mounts = system.model, []
    for name, mount in system.mounts.items():
        carried = model.body(mount.payload_body).id
        while carried not in (0, body):
            carried = int(model.body_parentid[carried])
        if carried == body:
            mounts.append(name)
    return mounts


def _deflections(model: mujoco.MjModel, data: mujoco.MjData, sites: npt.NDArray[np.int64]) -> Array:
    """Return the rate of a mount's deflection by velocity coordinates, world axes, (3, n_v)."""
    payload, base, unused = (np.zeros((3, model.nv)) for _ in range(3))
    point = data.site_xpos[sites[0]]
    mujoco.mj_jac(model, data, payload, unused, point, int(model.site_bodyid[sites[0]]))
    mujoco.mj_jac(model, data, base, unused, point, int(model.site_bodyid[sites[1]]))
    return payload - base


def _rotation(
    model: mujoco.MjModel, data: mujoco.MjData, free: npt.NDArray[np.int64], motion: Array
) -> tuple[int, str]:
    """Return the body that moves most in a motion of the free coordinates, (n,), and a name of the motion with its axis."""
    body = int(model.dof_bodyid[free[int(np.argmax(np.abs(motion)))]])
    turn, unused = np.zeros((3, model.nv)), np.zeros((3, model.nv))
    mujoco.mj_jacBody(model, data, unused, turn, body)
    about = turn[:, free] @ motion
    size = float(np.linalg.norm(about))
    if size < 1e-9:  # of a motion of unit mass
        return body, "a displacement"
    axis = about / size
    main = int(np.argmax(np.abs(axis)))
    if abs(axis[main]) > 0.999:  # within 2.6 degrees
        return body, f"a rotation about {'xyz'[main]}"
    return body, f"a rotation about ({', '.join(f'{value:.2f}' for value in axis * np.sign(axis[main]))})"


def _message(system: System, body: int, motions: list[str], *, tips: bool) -> str:
    model = system.model
    which = "any rotation" if len(motions) == 3 else " or ".join(sorted(motions))
    on = ", ".join(map(repr, _mounts_below(system, body)))
    return (
        f"body {model.body(body).name!r} on {on}: no mount, joint or stop resists {which}; "
        f"{'its weight tips it over' if tips else 'it is free'}. Three mounts out of line hold a body, or a joint guides it."
    )
