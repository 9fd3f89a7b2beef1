"""Payloads, the bodies that mounts carry: each is a body with everything that stands on it."""

from dataclasses import dataclass

import mujoco

from wirerope_mj.engine.system import System


@dataclass(frozen=True, kw_only=True)
class Payload:
    """A payload.

    Attributes:
        name: of its lowest body, the first that moves on its own.
        root: id of that body.
        bodies: ids of all that stand on it, itself included.
        mass: of all of them [kg].
    """

    name: str
    root: int
    bodies: tuple[int, ...]
    mass: float


def movers_of(system: System) -> tuple[Payload, ...]:
    """Return the payloads, and after them what else moves on its own, such as a frame below the mounts."""
    model = system.model
    payloads = payloads_of(system)
    known = {body for payload in payloads for body in payload.bodies}
    roots = [
        body
        for body in range(1, model.nbody)
        if body not in known
        and int(model.body_weldid[body]) not in _fixed(system)
        and int(model.body_weldid[model.body_parentid[body]]) in _fixed(system)
    ]
    return payloads + tuple(_payload(model, root) for root in roots)


def payloads_of(system: System) -> tuple[Payload, ...]:
    """Return the payloads of a system, in the order in which its mounts name them."""
    model = system.model
    fixed = _fixed(system)
    roots: dict[int, None] = {}
    for mount in system.mounts.values():
        body = model.body(mount.payload_body).id
        while int(model.body_weldid[model.body_parentid[body]]) not in fixed:
            body = int(model.body_parentid[body])
        roots[body] = None
    return tuple(_payload(model, root) for root in roots)


def _fixed(system: System) -> set[int]:
    """Return the ids of what moves as the base does, or not at all."""
    return {0, system.model.body(system.base).id} if system.base else {0}


def _payload(model: mujoco.MjModel, root: int) -> Payload:
    return Payload(
        name=model.body(root).name,
        root=root,
        bodies=tuple(body for body in range(root, model.nbody) if _stands_on(model, body, root)),
        mass=float(model.body_subtreemass[root]),
    )


def _stands_on(model: mujoco.MjModel, body: int, root: int) -> bool:
    while body > root:
        body = int(model.body_parentid[body])
    return body == root
