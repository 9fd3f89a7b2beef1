"""Mounts that stand where or as none can, centres of mass and inertias that no body of a payload's size has."""

import re
from collections.abc import Iterator, Sequence
from itertools import combinations
from xml.etree import ElementTree

import mujoco
import numpy as np
import scipy

from wirerope_mj.engine.statics.lost_mount import lost_mounts
from wirerope_mj.engine.statics.payloads import Payload, payloads_of
from wirerope_mj.engine.system import Mount, System
from wirerope_mj.foundation.arrays import Array

_SAME = 1e-3  # closer than this no two mounts stand [m]
_LEVEL, _UPRIGHT = 0.1, 0.7  # rise of a mount's axis up to which it is horizontal (6 degrees), from which upright (45 degrees)
# fraction of the size of a payload by which its centre of mass may lie outside what is drawn of it
_OUTSIDE = 0.05
# of the largest mean square of distances that is possible, with all mass at both ends: a ring frame has 0.67, an empty box 0.56
_AT_ENDS = 0.75
_MAIN = 0.2  # of a payload's mass, from which a body is no point that stands for something small
# kg/m^3: a third above osmium, the densest of all materials
_DENSEST = 3e4
_NEAR = 2e-3  # [m] from which a ray starts beyond the face that it is to meet
_LEANING, _ONE_WAY = 0.17, 0.95  # rise and lean of inclined mounts (10 degrees); length of the mean of directions that agree
# of the distance of the mounts: depth of a plane that they stand in; height of a step that no floor has below a single mount;
# overhang beyond mounts of which some stand upright and others at a wall
_IN_PLANE, _STEP_UP, _ASIDE = 0.05, 0.25, 0.25
_RATED = 8.0  # ratio of the ratings of mounts side by side, beyond which one of them is another part than was meant
_STEP = np.pi / 12.0  # 15 degrees, of which angles in models are multiples as a rule


def misplaced_elements(system: System) -> list[str]:
    """Return a sentence on each mount, centre of mass, inertia and angle that is probably not meant, with the remedy."""
    model, data = system.model, mujoco.MjData(system.model)
    mujoco.mj_kinematics(model, data)
    mujoco.mj_comPos(model, data)
    said = [*_angles(system.mjcf)]
    for payload in payloads_of(system):
        mounts = [
            mount for mount in system.mounts.values()
            if not mount.isolator.is_stop and model.body(mount.payload_body).id in payload.bodies
        ]  # fmt: skip
        free = model.body_jntnum[payload.root] == 1 and model.jnt_type[model.body_jntadr[payload.root]] == 0
        said += _too_close(mounts)
        said += [text for mount in mounts for text in _at_an_end(system, data, mount, payload)]
        if free and not payload.joined and len(mounts) > 2:
            centre = payload.centre(data, model.body_subtreemass)
            said += _turned(mounts, centre) or [
                *_outside_mounts(payload, mounts, centre),
                *lost_mounts(payload.name, mounts, centre),
                *_unlike_others(mounts),
            ]
        said += _masses(system, data, payload, mounts, free=bool(free))
    return said


def _text(position: Array) -> str:
    return f"({', '.join(f'{x:.4g}' for x in np.round(position, 9).tolist())})"


def _height(mount: Mount) -> float:
    return (mount.written.geometry and mount.written.geometry.height) or 0.0


def _too_close(mounts: Sequence[Mount]) -> Iterator[str]:
    """Yield a warning of two equal isolators at one place, and of the nearest two that overlap."""
    overlapping: list[tuple[float, float, Mount, Mount]] = []
    for one, other in combinations(mounts, 2):
        apart = float(np.linalg.norm(one.position - other.position))
        width = min(filter(None, (_height(one), _height(other))), default=0.0)
        if apart < _SAME and one.written == other.written and one.base_body == other.base_body:
            yield (
                f"mounts {one.name!r} and {other.name!r} stand at one place, {_text(one.position)} m: "
                "check the signs of the positions of their sites, or remove one."
            )
        elif _SAME <= apart < 0.5 * width and one.axes[:, 2] @ other.axes[:, 2] > _UPRIGHT:
            overlapping.append((apart, width, one, other))
    if overlapping:
        apart, width, one, other = min(overlapping, key=lambda pair: pair[0])
        yield (
            f"mounts {one.name!r} and {other.name!r} stand {1e3 * apart:.3g} mm apart, and their isolators are "
            f"{1e3 * width:.3g} mm high, so that they overlap: are positions in the unit that is said, m in a model?"
        )


def _turned(mounts: Sequence[Mount], centre: Array) -> list[str]:
    """Return a warning of mounts whose axis points away from the payload, as if it were reversed."""
    names = []
    for mount in mounts:
        axial, towards = mount.axes[:, 2], centre - mount.position
        level = abs(axial[2]) <= _LEVEL
        if axial[:2] @ towards[:2] < -_SAME if level else axial[2] < -_UPRIGHT and towards[2] > 0.5 * _height(mount):
            names.append(mount.name)
    if not names:
        return []
    return [
        f"{'mounts' if names[1:] else 'mount'} {', '.join(names)}: z of the sites leads away from the payload's centre of "
        "mass, so that its weight pulls at them instead of pressing, or the mounts lie on their side. z points from the base's "
        "bar to the payload's: turn `xyaxes`, `euler` or `quat` of both sites."
    ]


def _outside_mounts(payload: Payload, mounts: Sequence[Mount], centre: Array) -> Iterator[str]:
    """Yield a warning of a centre of mass that mounts cannot hold: beside all of them, or below the lowest upright ones."""
    upright = [mount for mount in mounts if mount.axes[2, 2] >= _UPRIGHT]
    if len(upright) < 3:
        return
    places = np.array([mount.position for mount in upright])
    every = np.array([mount.position for mount in mounts])
    base = float((places[:, 2] - 0.5 * np.array([_height(mount) for mount in upright])).min())
    spread = np.linalg.svd(places[:, :2] - places[:, :2].mean(axis=0), compute_uv=False)
    size = float(np.hypot(*np.ptp(places[:, :2], axis=0)))
    if spread[-1] < 1e-3 * max(spread[0], 1e-6):
        if float(np.ptp(places[:, 2])) > 0.1 * size:
            yield (
                f"body {payload.name!r}: its upright mounts {upright[0].name} to {upright[-1].name} stand above each other. "
                "z is up: are y and z swapped, as in drawings where y is up?"
            )
        return
    if len(upright) == len(mounts):
        outside = float((scipy.spatial.ConvexHull(places[:, :2]).equations @ [*centre[:2], 1.0]).max()) > 0.02 * size
    else:  # others may hold it from a side
        outside = bool((np.maximum(every.min(axis=0) - centre, centre - every.max(axis=0))[:2] > _ASIDE * size).any())
    if outside:
        yield (
            f"body {payload.name!r}: its centre of mass at {_text(centre)} m lies outside the area between its mounts, from "
            f"{_text(every.min(axis=0)[:2])} to {_text(every.max(axis=0)[:2])} m in x and y: it tips over. Check the signs, "
            "axes, origin and units of masses and mounts."
        )
    if centre[2] <= min(base, float(every[:, 2].min())) + _SAME:
        yield (
            f"body {payload.name!r}: its centre of mass at {_text(centre)} m lies below the mounts that it stands on, whose "
            f"lower ends are at z = {base:.3g} m: is its height left out, or z measured downwards? z is up."
        )


def _unlike_others(mounts: Sequence[Mount]) -> Iterator[str]:
    """Yield warnings of a mount unlike all others in height, direction or rated load, and of mounts that all lean one way."""
    places, axes = (np.array([getattr(mount, name) for mount in mounts]) for name in ("position", "axes"))
    axes = axes[:, :, 2]
    size = float(np.linalg.norm(np.ptp(places, axis=0)))
    level = axes[:, :2]
    leans = np.linalg.norm(level, axis=1)
    if (
        leans.min() > _LEANING
        and axes[:, 2].min() > _LEANING
        and np.linalg.norm((level / leans[:, None]).mean(axis=0)) > _ONE_WAY
    ):
        axis = axes.mean(axis=0) / np.linalg.norm(axes.mean(axis=0))
        if np.ptp(places @ axis) > _IN_PLANE * size:  # else they stand on a slope
            yield (
                f"mounts {mounts[0].name} to {mounts[-1].name} all lean towards {_text(level.mean(axis=0))}, so that the "
                "weight pushes the payload that way: the directions (`azimuth`) of those on the other side should be "
                "turned round."
            )
    standing = [mount for mount in mounts if mount.axes[2, 2] > _LEVEL]
    for mount in standing if len(standing) > 3 else ():
        others = [other for other in standing if other is not mount]
        heights = np.array([other.position[2] for other in others])
        up = float(mount.position[2] - heights.mean())
        if np.ptp(heights) < _IN_PLANE * size and abs(up) > max(_STEP_UP * size, 2.0 * _height(mount)):
            yield (
                f"mount {mount.name!r} stands {abs(up):.3g} m {'above' if up > 0.0 else 'below'} all others, which stand "
                "at one height: is its own right?"
            )
    upright = [mount for mount in mounts if mount.axes[2, 2] >= _UPRIGHT]
    floor = np.array([mount.position[2] for mount in upright])
    if len(upright) < 3 or np.ptp(floor) > _IN_PLANE * size:
        return
    for mount in mounts:
        if abs(mount.position[2] - floor.mean()) > _IN_PLANE * size:
            continue
        if mount.axes[2, 2] < _UPRIGHT and _height(mount) == _height(upright[0]):
            yield (
                f"mount {mount.name!r} points along {_text(mount.axes[:, 2])}, and the upright ones stand at its height: is "
                "its direction right?"
            )
        rated = mount.isolator.limits.static_load or 0.0
        loads = [beside.isolator.limits.static_load or 0.0 for beside in upright if beside is not mount]
        alike = rated > 0.0 and min(loads) > 0.0 and max(loads) < 2.0 * min(loads)
        if alike and not max(loads) / _RATED < rated < min(loads) * _RATED:
            yield (
                f"mount {mount.name!r} is rated for {rated:.4g} N, and all others beside it for {min(loads):.4g} N or so: is "
                "it the right isolator?"
            )


def _masses(system: System, data: mujoco.MjData, payload: Payload, mounts: Sequence[Mount], *, free: bool) -> Iterator[str]:
    """Yield warnings of centres of mass and inertias that do not fit what is drawn of a payload."""
    model = system.model
    modal = {mode.body for mode in system.assembly.subjects.modes}
    bodies = [body for body in payload.bodies if model.body_mass[body] > 0.0 and model.body(body).name not in modal]
    signs = np.array(np.meshgrid([-1, 1], [-1, 1], [-1, 1])).reshape(3, -1).T
    boxes = [  # around all geoms, world frame [m]
        data.geom_xpos[geom]
        + (model.geom_aabb[geom, :3] + signs * model.geom_aabb[geom, 3:]) @ data.geom_xmat[geom].reshape(3, 3).T
        for geom in np.flatnonzero(np.isin(model.geom_bodyid, payload.bodies) & (model.geom_rbound > 0.0))
    ]
    corners = np.concatenate(boxes) if boxes else None
    total, inertia = 0.0, np.zeros((3, 3))
    centre = payload.centre(data, model.body_subtreemass)
    for body in bodies:
        name, mass, at = model.body(body).name, float(model.body_mass[body]), data.xipos[body]
        turned = data.ximat[body].reshape(3, 3)
        tensor = turned @ np.diag(model.body_inertia[body]) @ turned.T
        total, inertia = total + mass, inertia + tensor + mass * _moved(at - centre)
        if corners is None:
            continue
        low, high = corners.min(axis=0), corners.max(axis=0)
        sites = np.vstack([corners, *(mount.position[None] for mount in mounts)])
        lowest, highest = sites.min(axis=0), sites.max(axis=0)
        beyond = np.maximum(lowest - at, at - highest).max()
        origin = data.xpos[body]
        at_origin = not model.body_ipos[body].any()
        on_edge = np.minimum(origin - low, high - origin).min() <= 1e-3 * float(np.linalg.norm(high - low))
        if beyond > _OUTSIDE * float(np.linalg.norm(highest - lowest)) or (at_origin and on_edge):
            ends = f"{_text(lowest)} to {_text(highest)}"
            yield (
                f"body {name!r}: its centre of mass at {_text(at)} m lies "
                + ("at the origin of its body, which is not inside" if at_origin and on_edge else "outside")
                + f" what is drawn of it and its mounts, {ends} m: check sign, axes and unit of `pos` in its <inertial>."
            )
        elif len(bodies) == 1 and (about := _about_origin(tensor, mass, at, origin, low, high)):
            yield (
                f"body {name!r}: its moments of inertia are larger than those of any body between its geoms: they are about "
                f"{about}, and must be about its centre of mass. Move them: subtract mass times distance squared."
            )
    for body in bodies if len(bodies) > 1 else ():
        name, mass = model.body(body).name, float(model.body_mass[body])
        radius = float(np.sqrt(0.5 * model.body_inertia[body].sum() / mass))
        if mass > _MAIN * total and mass > _DENSEST * (12.0**0.5 * radius) ** 3:
            yield (
                f"body {name!r}: its moments of inertia are those of {mass:.4g} kg within {1e3 * radius:.3g} mm of its centre "
                "of mass, denser than any material: are those of its <inertial> a placeholder or in other units than kg m^2, "
                "or is a mass in g?"
            )
    radius = float(np.sqrt(0.5 * np.trace(inertia) / total)) if total else 0.0
    if free and total > _DENSEST * (12.0**0.5 * radius) ** 3:
        yield (
            f"body {payload.name!r}: its moments of inertia are those of {total:.4g} kg within {1e3 * radius:.3g} mm of its "
            "centre of mass, denser than any material: are they, or the sizes of its geoms, in other units than kg m^2 and m?"
        )


def _moved(arm: Array) -> Array:
    """Evaluate Steiner's term of an inertia tensor for a distance (3,) [m], per unit of mass, (3, 3) [m^2]."""
    return np.asarray(arm @ arm * np.eye(3) - np.outer(arm, arm))


def _squares(tensor: Array, mass: float) -> Array:
    """Return the mean squares of the distances of a body's matter from its centre of mass along x, y and z [m^2]."""
    return np.asarray((0.5 * np.trace(tensor) - np.diag(tensor)) / mass)


def _about_origin(tensor: Array, mass: float, at: Array, origin: Array, low: Array, high: Array) -> str:
    """Say about which point moments of inertia are that nothing between two corners can have about its centre of mass.

    What lies between a and b has about its mean m a mean square of at most (b - m)(m - a) (Bhatia and Davis, A better bound on
    the variance, American Mathematical Monthly 107, 2000). "" if they are possible, or about another point neither.
    """
    most = _AT_ENDS * (high - at) * (at - low)
    if (_squares(tensor, mass) <= most).all():
        return ""
    for point, name in ((origin, "the body's origin"), (np.zeros(3), "the origin of the model")):
        moved = tensor - mass * _moved(at - point)
        squares = _squares(moved, mass)
        if np.linalg.eigvalsh(moved)[0] > 0.0 and (squares > 0.0).all() and (squares <= most).all():
            return name
    return ""


def _at_an_end(system: System, data: mujoco.MjData, mount: Mount, payload: Payload) -> Iterator[str]:
    """Yield a warning of a mount whose sites lie at one end of its isolator, on the payload or on the base."""
    model, height, axial = system.model, _height(mount), mount.axes[:, 2]
    base = np.flatnonzero(model.body_weldid == model.body_weldid[model.body(mount.base_body).id])
    ends = []
    for bodies, way in ((payload.bodies, axial), (base, -axial)):
        hits = [
            mujoco.mju_rayGeom(
                data.geom_xpos[geom], data.geom_xmat[geom], model.geom_size[geom], mount.position - _NEAR * way, way,
                int(mujoco.mjtGeom.mjGEOM_BOX), None,
            )
            for geom in np.flatnonzero(np.isin(model.geom_bodyid, bodies) & (model.geom_type == mujoco.mjtGeom.mjGEOM_BOX))
        ]  # fmt: skip
        ends.append(min((hit for hit in hits if hit >= 0.0), default=np.inf) - _NEAR)
    up, down = ends
    if height and abs(up + down - height) < 0.05 * height and abs(up - down) > 0.8 * height:
        yield (
            f"mount {mount.name!r}: its sites lie on the {'payload' if up < down else 'base'}, {1e3 * max(up, down):.3g} mm "
            f"from the other side: they belong at the isolator's mid-height, {500.0 * height:.3g} mm from both."
        )


def _angles(mjcf: str) -> Iterator[str]:
    """Yield a warning of angles in a model's text that are in radians where it is in degrees, or the reverse."""
    try:
        root = ElementTree.fromstring(mjcf)
    except ElementTree.ParseError:  # of a model that includes what stands elsewhere
        return
    radians = any(element.get("angle") == "radian" for element in root.iter("compiler"))
    for element in root.iter():
        written = element.get("euler", "").split() or element.get("axisangle", "").split()[-1:]
        values = [abs(float(value)) for value in written if re.fullmatch(r"[-+.\deE]+", value)]
        turns = [value / _STEP for value in values if value]
        named = f"{element.tag} {element.get('name', '')!r}: its angle of {' '.join(written)}"
        if radians and any(value > 2.0 * np.pi + _SAME and not value % 5.0 for value in values):
            yield f'{named} is read in radians, as <compiler angle="radian"> has it, and looks like degrees.'
        elif not radians and turns and all(0.5 < turn < 24.5 and abs(turn - round(turn)) < 3e-4 for turn in turns):
            yield f'{named} is read in degrees and looks like radians: write degrees, or <compiler angle="radian"/>.'
