"""Bodies of a model as links: poses, masses of welded bodies, and the clearance of geoms that may touch."""

from dataclasses import dataclass

import mujoco
import numpy as np

from wirerope_mj.foundation.arrays import AnyArray, Array

FARTHEST = 1e3  # clearance that is as good as any larger one [m]


@dataclass
class Writer:
    """Array of numbers that grows at its end."""

    numbers: list[float]

    def put(self, *values: object) -> int:
        """Append arrays of numbers and return where the first begins."""
        first = len(self.numbers)
        for value in values:
            self.numbers.extend(np.ravel(np.asarray(value, dtype=np.float64)).tolist())
        return first


@dataclass(frozen=True, kw_only=True)
class Pose:
    """A frame in another one: origin (3,) and unit quaternion (4,)."""

    origin: Array
    quaternion: Array

    def then(self, origin: Array, quaternion: Array) -> "Pose":
        """Compose this pose with a pose that is stated in its frame."""
        turned, product = np.empty(3), np.empty(4)
        mujoco.mju_rotVecQuat(turned, np.asarray(origin, dtype=np.float64), self.quaternion)
        mujoco.mju_mulQuat(product, self.quaternion, np.asarray(quaternion, dtype=np.float64))
        return Pose(origin=self.origin + turned, quaternion=product / np.linalg.norm(product))

    @property
    def axes(self) -> Array:
        """Axes as columns, (3, 3)."""
        matrix = np.empty(9)
        mujoco.mju_quat2Mat(matrix, self.quaternion)
        return matrix.reshape(3, 3)


HERE = Pose(origin=np.zeros(3), quaternion=np.array([1.0, 0.0, 0.0, 0.0]))


class Bodies:
    """Bodies of a model grouped into links (moving bodies with all that is welded to them), and each body's pose in a link."""

    def __init__(self, model: mujoco.MjModel) -> None:
        self.model = model
        moving = (model.body_weldid == np.arange(model.nbody)) & (model.body_dofnum > 0)
        self.links = np.flatnonzero(moving).tolist()
        numbers = {body: number for number, body in enumerate(self.links)}
        self.link = [numbers.get(int(body), len(self.links)) for body in model.body_weldid]
        self.pose: list[Pose] = []
        for body in range(model.nbody):
            pose = HERE
            if body and not moving[body]:
                pose = self.pose[int(model.body_parentid[body])].then(model.body_pos[body], model.body_quat[body])
            self.pose.append(pose)

    def on_parent(self, body: int) -> tuple[int, Pose]:
        """Return the link that a link's body hangs on, and its pose there."""
        parent = int(self.model.body_parentid[body])
        return self.link[parent], self.pose[parent].then(self.model.body_pos[body], self.model.body_quat[body])

    def site(self, site: int) -> tuple[int, Pose]:
        """Return the link of a site, and its pose there."""
        body = int(self.model.site_bodyid[site])
        return self.link[body], self.pose[body].then(self.model.site_pos[site], self.model.site_quat[site])


def modelled_pose(bodies: Bodies, number: int) -> Pose:
    """Return the modelled pose, in the world, of a link that never turns."""
    parent, pose = bodies.on_parent(bodies.links[number])
    if parent == len(bodies.links):
        return pose
    return modelled_pose(bodies, parent).then(pose.origin, pose.quaternion)


def inertia_of(bodies: Bodies, number: int) -> Array:
    """Return mass, centre, inertia and its inverse of a link with everything welded to it, (INERTIA_SIZE,)."""
    model = bodies.model
    members = [body for body in range(1, model.nbody) if bodies.link[body] == number]
    masses = model.body_mass[members]
    poses = [bodies.pose[body].then(model.body_ipos[body], model.body_iquat[body]) for body in members]
    total = float(masses.sum())
    centre = sum(m * pose.origin for m, pose in zip(masses, poses, strict=True)) / total if total else np.zeros(3)
    about = np.zeros((3, 3))
    for body, mass, pose in zip(members, masses, poses, strict=True):
        arm = pose.origin - centre
        about += pose.axes @ np.diag(model.body_inertia[body]) @ pose.axes.T
        about += mass * (arm @ arm * np.eye(3) - np.outer(arm, arm))
    inverse = np.linalg.inv(about) if np.linalg.det(about) > 0.0 else np.zeros((3, 3))
    return np.concatenate([[total], centre, _six(about), _six(inverse)])


def _six(matrix: AnyArray) -> Array:
    return np.asarray(matrix[[0, 1, 2, 0, 0, 1], [0, 1, 2, 1, 2, 2]], dtype=np.float64)


def pair_rows(model: mujoco.MjModel, bodies: Bodies, fix: Writer) -> list[list[int]]:
    """Return a row for each pair of links whose geoms may touch, with the least clearance between their geoms."""
    data = mujoco.MjData(model)
    mujoco.mj_kinematics(model, data)
    least: dict[tuple[int, int], tuple[float, float]] = {}
    for geom, other_geom, margin in may_touch(model):
        plane = model.geom_type[other_geom] == mujoco.mjtGeom.mjGEOM_PLANE
        first, second = (other_geom, geom) if plane else (geom, other_geom)
        links = (bodies.link[int(model.geom_bodyid[first])], bodies.link[int(model.geom_bodyid[second])])
        clearance = mujoco.mj_geomDistance(model, data, first, second, FARTHEST, np.zeros(6)) - margin
        body = int(model.geom_bodyid[second])
        centre = bodies.pose[body].then(model.geom_pos[second], model.geom_quat[second]).origin
        reach = float(np.linalg.norm(centre)) + float(model.geom_rbound[second])
        known = least.get(links, (np.inf, 0.0))
        least[links] = (min(known[0], clearance), max(known[1], reach))
    rows = []
    for (first, second), (clearance, reach) in least.items():
        first_place, second_place = _place(data, bodies, first), _place(data, bodies, second)
        place, turn = first_place.axes.T @ (second_place.origin - first_place.origin), first_place.axes.T @ second_place.axes
        rows.append([first, second, fix.put(place, turn, clearance, reach)])
    return rows


def _place(data: mujoco.MjData, bodies: Bodies, link: int) -> Pose:
    if link == len(bodies.links):
        return HERE
    body = bodies.links[link]
    return Pose(origin=data.xpos[body].copy(), quaternion=data.xquat[body].copy())


def may_touch(model: mujoco.MjModel) -> list[tuple[int, int, float]]:
    """Return the pairs of moving geoms for which MuJoCo computes contact, and the distance at which it begins [m]."""
    off = mujoco.mjtDisableBit
    if model.opt.disableflags & (off.mjDSBL_CONTACT | off.mjDSBL_CONSTRAINT):
        return []
    weld, parent = model.body_weldid, model.body_weldid[model.body_parentid[model.body_weldid]]
    bodies = weld[model.geom_bodyid]
    declared = list(zip(model.pair_geom1.tolist(), model.pair_geom2.tolist(), model.pair_margin.tolist(), strict=True))
    known = {frozenset(pair[:2]) for pair in declared}
    excluded = set(model.exclude_signature.tolist())
    types, affinities, pairs = model.geom_contype, model.geom_conaffinity, list(declared)
    active = np.flatnonzero(types | affinities)
    for i, geom in enumerate(active.tolist()):
        for other_geom in active[i + 1 :].tolist():
            a, b = int(bodies[geom]), int(bodies[other_geom])
            related = a and b and (parent[a] == b or parent[b] == a)
            if a == b or not (types[geom] & affinities[other_geom] or types[other_geom] & affinities[geom]):
                continue
            if related and not model.opt.disableflags & off.mjDSBL_FILTERPARENT:
                continue
            low, high = sorted((int(model.geom_bodyid[geom]), int(model.geom_bodyid[other_geom])))
            if (low << 16) + high in excluded or frozenset((geom, other_geom)) in known:
                continue
            pairs.append((geom, other_geom, float(model.geom_margin[geom] + model.geom_margin[other_geom])))
    return [pair for pair in pairs if bodies[pair[0]] != bodies[pair[1]]]
