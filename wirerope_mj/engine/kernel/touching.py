"""Geoms that may touch, and the clearance within which they certainly do not."""

import mujoco
import numpy as np

from wirerope_mj.engine.kernel.bodies import HERE, Bodies, Pose, Writer

FARTHEST = 1e3  # clearance that is as good as any larger one [m]


def pair_rows(model: mujoco.MjModel, bodies: Bodies, fix: Writer) -> list[list[int]]:
    """Return the rows of the pairs of links with geoms that may touch, with the least clearance of any two of them."""
    data = mujoco.MjData(model)
    mujoco.mj_kinematics(model, data)
    least: dict[tuple[int, int], tuple[float, float]] = {}
    for one, other, margin in may_touch(model):
        plane = model.geom_type[other] == mujoco.mjtGeom.mjGEOM_PLANE
        first, second = (other, one) if plane else (one, other)
        links = (bodies.link[int(model.geom_bodyid[first])], bodies.link[int(model.geom_bodyid[second])])
        clearance = mujoco.mj_geomDistance(model, data, first, second, FARTHEST, np.zeros(6)) - margin
        body = int(model.geom_bodyid[second])
        centre = bodies.pose[body].then(model.geom_pos[second], model.geom_quat[second]).origin
        reach = float(np.linalg.norm(centre)) + float(model.geom_rbound[second])
        known = least.get(links, (np.inf, 0.0))
        least[links] = (min(known[0], clearance), max(known[1], reach))
    rows = []
    for (first, second), (clearance, reach) in least.items():
        here, there = _place(model, data, bodies, first), _place(model, data, bodies, second)
        place, turn = here.axes.T @ (there.origin - here.origin), here.axes.T @ there.axes
        rows.append([first, second, fix.put(place, turn, clearance, reach)])
    return rows


def _place(model: mujoco.MjModel, data: mujoco.MjData, bodies: Bodies, link: int) -> Pose:
    if link == len(bodies.links):
        return HERE
    body = bodies.links[link]
    return Pose(origin=data.xpos[body].copy(), quaternion=data.xquat[body].copy())


def may_touch(model: mujoco.MjModel) -> list[tuple[int, int, float]]:
    """Return the pairs of geoms that MuJoCo lets touch when they move, and the distance from which on they do [m]."""
    off = mujoco.mjtDisableBit
    if model.opt.disableflags & (off.mjDSBL_CONTACT | off.mjDSBL_CONSTRAINT):
        return []
    weld, parent = model.body_weldid, model.body_weldid[model.body_parentid[model.body_weldid]]
    bodies = weld[model.geom_bodyid]
    declared = list(zip(model.pair_geom1.tolist(), model.pair_geom2.tolist(), model.pair_margin.tolist(), strict=True))
    known = {frozenset(pair[:2]) for pair in declared}
    excluded = set(model.exclude_signature.tolist())
    types, affinities, found = model.geom_contype, model.geom_conaffinity, list(declared)
    active = np.flatnonzero(types | affinities)
    for i, one in enumerate(active.tolist()):
        for other in active[i + 1 :].tolist():
            a, b = int(bodies[one]), int(bodies[other])
            related = a and b and (parent[a] == b or parent[b] == a)
            if a == b or not (types[one] & affinities[other] or types[other] & affinities[one]):
                continue
            if related and not model.opt.disableflags & off.mjDSBL_FILTERPARENT:
                continue
            low, high = sorted((int(model.geom_bodyid[one]), int(model.geom_bodyid[other])))
            if (low << 16) + high in excluded or frozenset((one, other)) in known:
                continue
            found.append((one, other, float(model.geom_margin[one] + model.geom_margin[other])))
    return [pair for pair in found if bodies[pair[0]] != bodies[pair[1]]]
