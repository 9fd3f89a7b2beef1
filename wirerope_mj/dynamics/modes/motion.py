"""What mode shapes are: motion of the payloads, shares of the energy, participation, and a word for each."""

from dataclasses import dataclass

import mujoco
import numpy as np

from wirerope_mj.dynamics.modes.rest import AtRest
from wirerope_mj.dynamics.modes.result import PayloadShape
from wirerope_mj.engine.statics.payloads import Payload, movers_of, payloads_of
from wirerope_mj.engine.system import System
from wirerope_mj.foundation.arrays import Array

NAMED = 0.15
"""Share of the kinetic energy from which a part of the motion is named."""

_TRANSLATIONS = ("sway x", "sway y", "bounce z")
_ROTATIONS = ("rocking about x", "rocking about y", "yaw about z")


@dataclass(frozen=True, kw_only=True)
class Jacobians:
    """Velocity of a body by free coordinates: of its centre of mass (3, n), and angular (3, n)."""

    centre: Array
    turn: Array


def payload_shapes(system: System, rest: AtRest, shapes: Array) -> dict[str, PayloadShape]:
    """Return the motion of every payload in the shapes (n, n_modes)."""
    found = {}
    for payload in payloads_of(system):
        tree = _tree(system.model, rest, payload)
        found[payload.name] = PayloadShape(
            centre=rest.data.subtree_com[payload.root].copy(),
            mass=payload.mass,
            translation=(tree.centre @ shapes).T,
            rotation=(tree.turn @ shapes).T,
        )
    return found


def participation_of(system: System, rest: AtRest, shapes: Array) -> Array:
    """Return the share of the moving mass that takes part along x, y and z in each mode, (n_modes, 3).

    (phi^T M r)^2 / (phi^T M phi m), with M r the inertia forces of a unit acceleration of the base and m the moving mass.
    """
    model = system.model
    force, whole = np.zeros((rest.free.size, 3)), 0.0
    for mover in movers_of(system):
        for body in mover.bodies:
            force += model.body_mass[body] * _jacobians(model, rest, body).centre.T
            whole += float(model.body_mass[body])
    modal = np.einsum("nj,nk,kj->j", shapes, rest.mass, shapes)
    return np.asarray((shapes.T @ force) ** 2 / (modal[:, None] * whole))


def words_of(system: System, rest: AtRest, shapes: Array) -> tuple[str, ...]:
    """Return a word for each of the shapes (n, n_modes)."""
    return tuple(_word(system, rest, shape) for shape in shapes.T)


def _word(system: System, rest: AtRest, shape: Array) -> str:
    """Return what holds most of the kinetic energy of a shape, largest first."""
    model = system.model
    energy = float(shape @ rest.mass @ shape)
    movers = movers_of(system)
    shares: list[tuple[float, str]] = []
    for payload in movers:
        tree = _tree(model, rest, payload)
        velocity, turn = tree.centre @ shape, tree.turn @ shape
        prefix = f"{payload.name}: " if len(movers) > 1 else ""
        shares += [(payload.mass * v * v / energy, prefix + w) for v, w in zip(velocity, _TRANSLATIONS, strict=True)]
        spin = turn * (_inertia(model, rest, payload) @ turn) / energy
        shares += [(float(part), prefix + w) for part, w in zip(spin, _ROTATIONS, strict=True)]
        shares += _inner(model, rest, payload, shape, velocity, turn, energy)
    shares.sort(reverse=True)
    named = [word for share, word in shares if share >= NAMED] or [shares[0][1]]
    return " + ".join(named)


def _inner(
    model: mujoco.MjModel, rest: AtRest, payload: Payload, shape: Array, velocity: Array, turn: Array, energy: float
) -> list[tuple[float, str]]:
    """Return the share of each body that moves against its payload's lowest body, as if that were rigid."""
    centre = rest.data.subtree_com[payload.root]
    found = []
    for body in payload.bodies:
        own = _jacobians(model, rest, body)
        arm = rest.data.xipos[body] - centre
        along = own.centre @ shape - velocity - np.cross(turn, arm)
        about = own.turn @ shape - turn
        share = model.body_mass[body] * along @ along + about @ _body_inertia(rest.data, model, body) @ about
        if model.body_weldid[body] != payload.root and share > 0.0:
            found.append((float(share) / energy, f"{model.body(body).name} on {payload.name}"))
    return found


def _tree(model: mujoco.MjModel, rest: AtRest, payload: Payload) -> Jacobians:
    centre = np.zeros((3, model.nv))
    mujoco.mj_jacSubtreeCom(model, rest.data, centre, payload.root)
    return Jacobians(centre=centre[:, rest.free], turn=_jacobians(model, rest, payload.root).turn)


def _jacobians(model: mujoco.MjModel, rest: AtRest, body: int) -> Jacobians:
    centre, turn = np.zeros((3, model.nv)), np.zeros((3, model.nv))
    mujoco.mj_jacBodyCom(model, rest.data, centre, turn, body)
    return Jacobians(centre=centre[:, rest.free], turn=turn[:, rest.free])


def _body_inertia(data: mujoco.MjData, model: mujoco.MjModel, body: int) -> Array:
    """Return a body's inertia about its centre of mass, world axes [kg m^2], (3, 3)."""
    axes = data.ximat[body].reshape(3, 3)
    return np.asarray(axes @ np.diag(model.body_inertia[body]) @ axes.T)


def _inertia(model: mujoco.MjModel, rest: AtRest, payload: Payload) -> Array:
    """Return a payload's inertia about its centre of mass, world axes [kg m^2], (3, 3)."""
    data, total = rest.data, np.zeros((3, 3))
    for body in payload.bodies:
        arm = data.xipos[body] - data.subtree_com[payload.root]
        steiner = model.body_mass[body] * (arm @ arm * np.eye(3) - np.outer(arm, arm))
        total += _body_inertia(data, model, body) + steiner
    return total
