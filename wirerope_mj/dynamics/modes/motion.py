"""Motion of the payloads in mode shapes, participation, and a description of each by its kinetic energy."""

from dataclasses import dataclass

import mujoco
import numpy as np

from wirerope_mj.dynamics.modes.rest import AtRest
from wirerope_mj.dynamics.modes.result import PayloadShape
from wirerope_mj.engine.statics.payloads import Payload, movers_of, payloads_of
from wirerope_mj.engine.system import System
from wirerope_mj.foundation.arrays import Array

NAMED = 0.15
"""Fraction of the kinetic energy from which a component of the motion is named."""

_NOTHING = 1e-9
"""Fraction of the model's mass below which what can move along an axis is rounding."""

_TRANSLATIONS = ("sway x", "sway y", "bounce z")
_ROTATIONS = ("rocking about x", "rocking about y", "yaw about z")


@dataclass(frozen=True, kw_only=True)
class Jacobians:
    """Velocity of a body by free coordinates: of its centre of mass (3, n), and angular (3, n)."""

    centre: Array
    turn: Array


def payload_shapes(system: System, rest: AtRest, shapes: Array) -> dict[str, PayloadShape]:
    """Return the motion of every payload in the shapes (n, n_modes)."""
    result = {}
    for payload in payloads_of(system):
        tree = _tree(system.model, rest, payload)
        result[payload.name] = PayloadShape(
            centre=rest.data.subtree_com[payload.root].copy(),
            mass=payload.mass,
            translation=(tree.centre @ shapes).T,
            rotation=(tree.turn @ shapes).T,
        )
    return result


def participation_of(system: System, rest: AtRest, shapes: Array) -> tuple[Array, Array]:
    """Return fractions of the mass that takes part along x, y, z in each mode, (n_modes, 3), and that mass [kg], (3,).

    With f = M r the inertia forces of a unit acceleration of the base, (phi^T f)^2 / (phi^T M phi m), where m = f^T M^-1 f is
    what all motions that joints leave can bring along: of a free body its mass, of a guided one nothing across its guide.
    """
    model = system.model
    force = np.zeros((rest.free.size, 3))
    for mover in movers_of(system):
        for body in mover.bodies:
            force += model.body_mass[body] * _jacobians(model, rest, body).centre.T
    modal = np.einsum("nj,nk,kj->j", shapes, rest.mass, shapes)
    moving = np.einsum("na,na->a", force, np.linalg.solve(rest.mass, force))
    effective = (shapes.T @ force) ** 2 / modal[:, None]
    with_mass = moving > _NOTHING * model.body_mass.sum()
    return np.where(with_mass, effective / np.where(with_mass, moving, 1.0), 0.0), np.where(with_mass, moving, 0.0)


def descriptions_of(system: System, rest: AtRest, shapes: Array) -> tuple[str, ...]:
    """Return a description of each of the shapes (n, n_modes)."""
    return tuple(_description(system, rest, shape) for shape in shapes.T)


def _description(system: System, rest: AtRest, shape: Array) -> str:
    """Return the components that hold most of the kinetic energy of a shape, largest first."""
    model = system.model
    energy = float(shape @ rest.mass @ shape)
    movers = movers_of(system)
    ratios: list[tuple[float, str]] = []
    for payload in movers:
        tree = _tree(model, rest, payload)
        velocity, turn = tree.centre @ shape, tree.turn @ shape
        prefix = f"{payload.name}: " if len(movers) > 1 else ""
        ratios += [(payload.mass * v * v / energy, prefix + w) for v, w in zip(velocity, _TRANSLATIONS, strict=True)]
        spin = turn * (_inertia(model, rest, payload) @ turn) / energy
        ratios += [(float(part), prefix + w) for part, w in zip(spin, _ROTATIONS, strict=True)]
        ratios += _inner(model, rest, payload, shape, velocity, turn, energy)
    ratios.sort(reverse=True)
    named = [description for ratio, description in ratios if ratio >= NAMED] or [ratios[0][1]]
    return " + ".join(named)


def _inner(
    model: mujoco.MjModel, rest: AtRest, payload: Payload, shape: Array, velocity: Array, turn: Array, energy: float
) -> list[tuple[float, str]]:
    """Return the energy fraction of each body that moves against its payload's lowest body, as if that were rigid."""
    centre = rest.data.subtree_com[payload.root]
    ratios = []
    for body in payload.bodies:
        own = _jacobians(model, rest, body)
        arm = rest.data.xipos[body] - centre
        along = own.centre @ shape - velocity - np.cross(turn, arm)
        about = own.turn @ shape - turn
        energy_in = model.body_mass[body] * along @ along + about @ _body_inertia(rest.data, model, body) @ about
        if model.body_weldid[body] != payload.root and energy_in > 0.0:
            ratios.append((float(energy_in) / energy, f"{model.body(body).name} on {payload.name}"))
    return ratios


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
