"""Variants of a system: the same layout, other isolators, masses, centres of mass, positions and inclinations of mounts.

Centres of mass are those of the compiled model.
"""

from collections.abc import Callable, Mapping, Sequence
from dataclasses import replace

import mujoco
import numpy as np
import scipy

from wirerope_mj.engine.control import layout as at
from wirerope_mj.engine.system.declared import DeclaredMount
from wirerope_mj.engine.system.modal import declared_modes
from wirerope_mj.engine.system.system import Changes, Mount, System, Vector, load_system
from wirerope_mj.engine.system.tables import make_tables, with_laws
from wirerope_mj.foundation.arrays import Array
from wirerope_mj.foundation.errors import ModelError
from wirerope_mj.foundation.summary import ByName
from wirerope_mj.mounts.isolator import Isolator

Shift = Sequence[float] | Array
_NONE = (0.0, 0.0, 0.0)


def varied(
    system: System, *, isolators: Mapping[str, Isolator] | None = None, masses: Mapping[str, float] | None = None,
    centres: Mapping[str, Shift] | None = None, positions: Mapping[str, Shift] | None = None,
    turns: Mapping[str, Shift] | None = None, tunings: Mapping[str, float] | None = None,
) -> System:  # fmt: skip
    """Return a variant of `system`: a copy of the compiled model with other numbers, not compiled anew.

    The variant has the same bits as a model written with these values. What it differs by stands in its `changes`, one after
    another if a variant is varied again; `mjcf`, `path` and `isolators` remain those of the model as written, so that

        with_changes(load_system(variant.path or variant.mjcf, isolators=variant.isolators), variant.changes)

    makes it again; pickling carries it whole and needs no file. Geoms are not moved: pictures show the payload as written.

    Args:
        system: the system, or a variant of one.
        isolators: isolators by mount; mounts that share an isolator in the model may have different ones.
        masses: factors on the mass and the moments of inertia of bodies (not of bodies fixed to them).
        centres: shifts of bodies' centres of mass [m], (3,), world axes of the modelled geometry; the moments of inertia are
            kept about the centre.
        positions: shifts of mounts [m], (3,), world axes of the modelled geometry; both sites move.
        turns: rotation vectors of mounts [rad], (3,), world axes of the modelled geometry; the axes of both sites turn, each
            about itself.
        tunings: factors on the natural frequency that a joint's spring gives what stands on it, its damping ratio kept, also
            with other masses: of a deck panel, a subassembly, a mode of a flexible part.

    Raises:
        ValueError: a factor is not positive, or a shift is not three numbers.
        ModelError: a mount or a body does not exist, or the compiled model has no room for the change; says what to do.
    """
    changes = Changes(
        isolators=isolators or {}, masses=masses or {}, centres=centres or {},  # type: ignore[arg-type]
        positions=positions or {}, turns=turns or {}, tunings=tunings or {},  # type: ignore[arg-type]
    )  # fmt: skip
    return changed(system, changes)


def changed(system: System, changes: Changes) -> System:
    """Apply one set of changes to a system, and return the variant."""
    for name in (*changes.isolators, *changes.positions, *changes.turns):
        if name not in system.mounts:
            raise ModelError(f"there is no mount {name!r}. Mounts of this system: {list(system.mounts)}.")
    for name, isolator in changes.isolators.items():
        mount = system.mounts[name]
        compiled = mount.states[2].stop - mount.states[0].start
        if isolator.n_states != compiled:
            raise ModelError(
                f"mount {name!r}: the laws of isolator {isolator.name!r} have {isolator.n_states} internal states, those that "
                f"the model was compiled with {compiled}. {_written(mount)}"
            )
    model = system.model.__copy__()
    isolators = {name: changes.isolators.get(name, mount.written) for name, mount in system.mounts.items()}
    positions = {name: mount.position for name, mount in system.mounts.items()}
    if changes.masses or changes.centres or changes.positions or changes.turns:
        with system.assembly.scratch.data(model) as data:
            mujoco.mj_kinematics(model, data)
            change_masses(model, changes.masses)
            for name, shift in changes.centres.items():
                body = _body(model, name)
                if model.body_simple[body] and any(shift):
                    raise ModelError(
                        f"body {name!r}: its centre of mass cannot be moved, because MuJoCo has compiled its inertia as "
                        f'diagonal about its joints. Write <body name="{name}" simple="false"> in the model.'
                    )
                model.body_ipos[body] += _in_body(data, body, shift)
            _move_sites(model, data, system, changes)
            mujoco.mj_setConst(model, data)
            tune(model, changes.tunings, system.model)
            mujoco.mj_resetData(model, data)
            old = system.assembly
            declared = [
                DeclaredMount(
                    name=name, payload_site=payload, base_site=base, isolator_name=mount.isolator_name, isolator=isolators[name]
                )
                for (name, mount), (payload, base) in zip(system.mounts.items(), old.tables.sites.tolist(), strict=True)
            ]
            subjects = replace(old.subjects, modes=declared_modes(model))  # whose shapes are in the axes of sites that may turn
            tables = make_tables(model, data, declared, subjects, sensor=old.sensor, nominal=old.tables)
            positions = {name: data.site(mount.base_site).xpos.copy() for name, mount in system.mounts.items()}
    else:
        tune(model, changes.tunings, system.model)
        tables = with_laws(system.assembly.tables, isolators)
    n_stops, room = int(tables.layout[at.N_STOPS]), model.numeric(at.PARAMETERS).data
    if n_stops > tables.user.n_stops:
        raise ModelError(
            f"the laws of all mounts have {n_stops} stops, those that the model was compiled with {tables.user.n_stops}: load "
            "the model with such isolators from the start, load_system(..., isolators={...}), and vary that."
        )
    if tables.parameters.size > room.size:
        raise ModelError(_no_room(system, isolators, tables.parameters.size, room.size))
    model.numeric(at.LAYOUT).data[:] = tables.layout  # where those of the original model stand
    room[:] = 0.0
    room[: tables.parameters.size] = tables.parameters
    mounts = {
        name: replace(
            mount, isolator=isolators[name].conditioned, written=isolators[name], position=positions[name],
            states=tables.states[name],
        )
        for name, mount in system.mounts.items()
    }  # fmt: skip
    return replace(
        system, model=model, mounts=ByName(mounts), assembly=replace(system.assembly, model=model, tables=tables),
        changes=(*system.changes, changes),
    )  # fmt: skip


def with_changes(system: System, changes: Sequence[Changes]) -> System:
    """Apply changes to a system, one after the other, and return the variant."""
    for change in changes:
        system = changed(system, change)
    return system


def with_other_laws(system: System, change: Callable[[Isolator], Isolator]) -> System:
    """Apply `change` to every isolator of a system, compiled anew so that all fit."""
    isolators = {name: change(isolator) for name, isolator in system.isolators.items()}
    changes = [
        replace(earlier, isolators={mount: change(isolator) for mount, isolator in earlier.isolators.items()})
        for earlier in system.changes
    ]
    return with_changes(load_system(system.path or system.mjcf, isolators=isolators), changes)


def _written(mount: Mount) -> str:
    return (
        "A variant has the layout of its model: load the model with such an isolator from the start, "
        f"load_system(..., isolators={{{mount.isolator_name!r}: ...}}), and vary that."
    )


def change_masses(model: mujoco.MjModel, masses: Mapping[str, float]) -> None:
    """Scale masses and moments of inertia of bodies in place; call `mj_setConst` to update the rest of the model."""
    for name, factor in masses.items():
        body = _body(model, name)
        model.body_mass[body] *= factor
        model.body_inertia[body] *= factor


def sprung_joints(model: mujoco.MjModel) -> dict[str, float]:
    """Return the slides and hinges with springs, each with the natural frequency [Hz] of its load alone."""
    joints = {}
    for joint in np.flatnonzero(model.jnt_stiffness > 0.0).tolist():
        if model.jnt_type[joint] < int(mujoco.mjtJoint.mjJNT_SLIDE) or not model.joint(joint).name:
            continue
        inertia = float(model.body_subtreemass[model.jnt_bodyid[joint]])
        if model.jnt_type[joint] == mujoco.mjtJoint.mjJNT_HINGE:
            inertia = 1.0 / float(model.dof_invweight0[model.jnt_dofadr[joint]])
        joints[model.joint(joint).name] = float(np.sqrt(model.jnt_stiffness[joint] / inertia)) / (2.0 * np.pi)
    return joints


def tune(model: mujoco.MjModel, tunings: Mapping[str, float], nominal: mujoco.MjModel) -> None:
    """Tune joint springs in place, to factors on the natural frequencies that the same joints have in the model `nominal`.

    These hold whatever the masses have become; damping ratios and the force in each spring as drawn are kept.
    """
    known, now = sprung_joints(nominal), sprung_joints(model)
    for name, factor in tunings.items():
        if name not in known:
            raise ModelError(f"there is no joint {name!r} with a spring. Joints with one: {list(known) or 'none'}.")
        joint, heavier = int(model.joint(name).id), known[name] / now[name]  # the square root of what it carries more
        q, dof = int(model.jnt_qposadr[joint]), int(model.jnt_dofadr[joint])
        model.jnt_stiffness[joint] *= (factor * heavier) ** 2
        model.dof_damping[dof] *= factor * heavier**2
        model.qpos_spring[q] = model.qpos0[q] + (model.qpos_spring[q] - model.qpos0[q]) / (factor * heavier) ** 2


def moving_bodies(model: mujoco.MjModel) -> list[str]:
    """Return the names of the bodies whose mass can vary: moving bodies with a mass, without bodies of modes."""
    modal = {mode.body for mode in declared_modes(model)}
    moving = [b for b in range(1, model.nbody) if model.body_weldid[b] != 0 and model.body_mass[b] > 0.0]
    return [model.body(b).name for b in moving if b not in modal]


def _body(model: mujoco.MjModel, name: str) -> int:
    bodies = moving_bodies(model)
    if name not in bodies:
        raise ModelError(f"there is no moving body {name!r} with a mass. Bodies that move and have one: {bodies}.")
    return int(model.body(name).id)


def _move_sites(model: mujoco.MjModel, data: mujoco.MjData, system: System, changes: Changes) -> None:
    """Shift and turn the sites of mounts in place, by the changes of a variant."""
    moves: dict[int, tuple[str, tuple[Vector, Vector]]] = {}
    for name, mount in system.mounts.items():
        move = changes.positions.get(name, _NONE), changes.turns.get(name, _NONE)
        for site in (model.site(mount.payload_site).id, model.site(mount.base_site).id):
            earlier, already = moves.setdefault(site, (name, move))
            if already != move:
                raise ModelError(
                    f"mounts {earlier!r} and {name!r} share the site {model.site(site).name!r} and can only be moved together; "
                    "give both the same shift and turn, or sites of their own."
                )
    on_tendons = set(model.wrap_objid[model.wrap_type == mujoco.mjtWrap.mjWRAP_SITE].tolist())
    for site, (name, (shift, turn)) in moves.items():
        body = int(model.site_bodyid[site])
        if any(turn):
            rotation = scipy.spatial.transform.Rotation  # here, because it takes as long to import as all of this wing
            about = rotation.from_rotvec(_in_body(data, body, turn))
            turned = about * rotation.from_quat(model.site_quat[site], scalar_first=True)
            model.site_quat[site] = turned.as_quat(scalar_first=True)
        if not any(shift):
            continue
        if site in on_tendons:
            raise ModelError(
                f"mount {name!r}: a tendon ends at its site {model.site(site).name!r} and would keep its length; give the "
                "tendon a site of its own."
            )
        model.site_pos[site] += _in_body(data, body, shift)


def _in_body(data: mujoco.MjData, body: int, shift: Vector) -> Array:
    """Transform a shift from the world's axes to a body's."""
    return np.asarray(np.array(shift) @ data.xmat[body].reshape(3, 3), dtype=np.float64)


def _no_room(system: System, isolators: Mapping[str, Isolator], wanted: int, room: int) -> str:
    """Word the message for laws with more parameters than the compiled model has room for."""

    def size(isolator: Isolator) -> int:
        acting = isolator.conditioned
        parameters = sum(law.kernel_parameters().size for law in acting.axes.values() if law is not None)
        return parameters + (0 if acting.coupled is None else acting.coupled.mount_parameters().size)

    old = max(system.mounts.values(), key=lambda mount: size(isolators[mount.name]) - size(mount.isolator))
    new = isolators[old.name]
    return (
        f"mount {old.name!r}: the laws of isolator {new.name!r} have {size(new)} parameters, those of {old.isolator.name!r} "
        f"{size(old.isolator)}; all mounts would need {wanted}, and the model has room for {room}. {_written(old)}"
    )


def centre_of_mass(system: System, body: str) -> Array:
    """Return the centre of mass of a body in its own axes, from its own origin [m], (3,).

    It is what `<inertial pos="...">` says in the model; without one, what MuJoCo makes of the body's geoms. Bodies that are
    fixed to this one are bodies of their own and do not count.
    """
    return np.array(system.model.body(body).ipos, dtype=np.float64)


def body_axes(system: System, body: str) -> Array:
    """Return the axes of a body in the modelled geometry as the columns of a rotation, (3, 3): world = axes @ own."""
    with system.assembly.scratch.data(system.model) as data:
        mujoco.mj_kinematics(system.model, data)
        return np.array(data.body(body).xmat, dtype=np.float64).reshape(3, 3)


def is_aligned(system: System, body: str) -> bool:
    """Return whether MuJoCo has moved the body's origin into its centre of mass (`align` of its free joint, `alignfree`).

    Then its centre of mass is at 0 in the compiled model, wherever the model as written has it.
    """
    spec = mujoco.MjSpec.from_file(str(system.path)) if system.path else mujoco.MjSpec.from_string(system.mjcf)
    written = spec.body(body)
    if written is None:  # it has its name from us
        return False
    auto, yes = mujoco.mjtAlignFree.mjALIGNFREE_AUTO, mujoco.mjtAlignFree.mjALIGNFREE_TRUE
    free = [joint for joint in written.joints if joint.type == mujoco.mjtJoint.mjJNT_FREE]
    return any(joint.align == yes or (joint.align == auto and spec.compiler.alignfree) for joint in free)
