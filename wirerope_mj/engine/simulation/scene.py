"""The drawable scene of a system."""

import mujoco
import numpy as np

from wirerope_mj.engine.response.scene import Geom, Scene, SceneBody, SceneMount
from wirerope_mj.engine.system import Mount, System, once_per_system
from wirerope_mj.foundation.arrays import Array

_SHAPES = {
    mujoco.mjtGeom.mjGEOM_PLANE: "plane",
    mujoco.mjtGeom.mjGEOM_SPHERE: "sphere",
    mujoco.mjtGeom.mjGEOM_CAPSULE: "capsule",
    mujoco.mjtGeom.mjGEOM_ELLIPSOID: "ellipsoid",
    mujoco.mjtGeom.mjGEOM_CYLINDER: "cylinder",
    mujoco.mjtGeom.mjGEOM_BOX: "box",
    mujoco.mjtGeom.mjGEOM_MESH: "mesh",
}
_NAN = float("nan")


@once_per_system
def scene_of(system: System) -> Scene:
    """Return bodies, geoms and mounts of a system in its modelled geometry; geoms of other kinds are left out."""
    model = system.model
    with system.assembly.scratch.data(model) as data:
        mujoco.mj_kinematics(model, data)
        bodies = _bodies(system, data)
        mounts = tuple(_mount(model, data, mount) for mount in system.mounts.values())
    return Scene(
        name=system.name,
        base=system.base,
        bodies=bodies,
        mounts=mounts,
        limits=system.limits,
        combined_travel=system.combined_travel,
        areas=system.areas,
    )


def _bodies(system: System, data: mujoco.MjData) -> tuple[SceneBody, ...]:
    model = system.model
    base = model.body(system.base).id if system.base else -1
    bodies = []
    for body in range(model.nbody):
        moves = bool(model.body_weldid[body] != 0)
        fixed = not moves and body != 0
        bodies.append(
            SceneBody(
                name=model.body(body).name or f"world_{body}" if fixed else model.body(body).name,
                moves=moves,
                on_base=bool(moves and model.body_weldid[body] == base),
                position=data.xipos[body].copy(),
                orientation=data.xquat[body].copy(),
                geoms=_geoms(model, body),
            )
        )
    return tuple(bodies)


def _geoms(model: mujoco.MjModel, body: int) -> tuple[Geom, ...]:
    first = int(model.body_geomadr[body])
    geoms = []
    for g in range(first, first + int(model.body_geomnum[body])):
        shape = _SHAPES.get(mujoco.mjtGeom(model.geom_type[g]))
        if shape is None:
            continue
        vertices, faces = _mesh(model, int(model.geom_dataid[g])) if shape == "mesh" else (np.zeros((0, 3)),) * 2
        material = int(model.geom_matid[g])
        rgba = model.geom_rgba[g] if material < 0 else model.mat_rgba[material]
        geoms.append(
            Geom(
                name=model.geom(g).name,
                shape=shape,
                size=model.geom_size[g].copy(),
                position=model.geom_pos[g] - model.body_ipos[body],
                orientation=model.geom_quat[g].copy(),
                rgba=rgba.astype(np.float64),
                vertices=vertices,
                faces=faces,
            )
        )
    return tuple(geoms)


def _mesh(model: mujoco.MjModel, mesh: int) -> tuple[Array, Array]:
    vertex, n_vertices = int(model.mesh_vertadr[mesh]), int(model.mesh_vertnum[mesh])
    face, n_faces = int(model.mesh_faceadr[mesh]), int(model.mesh_facenum[mesh])
    return (
        model.mesh_vert[vertex : vertex + n_vertices].astype(np.float64),
        model.mesh_face[face : face + n_faces].astype(np.float64),
    )


def _mount(model: mujoco.MjModel, data: mujoco.MjData, mount: Mount) -> SceneMount:
    sites = [model.site(name).id for name in (mount.payload_site, mount.base_site)]
    on = [int(model.site_bodyid[site]) for site in sites]
    rotation = data.xmat[on[1]].reshape(3, 3)
    isolator = mount.isolator
    limits, geometry = isolator.limits, isolator.geometry
    return SceneMount(
        name=mount.name,
        isolator=isolator.name,
        payload_body=model.body(on[0]).name,
        base_body=model.body(on[1]).name,
        payload_point=model.site_pos[sites[0]] - model.body_ipos[on[0]],
        base_point=model.site_pos[sites[1]] - model.body_ipos[on[1]],
        axes=rotation.T @ mount.axes,
        height=_NAN if geometry is None else _number(geometry.height),
        width=_NAN if geometry is None else _number(geometry.width),
        bar=_NAN if geometry is None else _number(geometry.bar),
        static_load=_number(limits.static_load),
        travel=limits.travel.stated,
        stop=isolator.is_stop,
        bolts=np.full(3, _NAN)
        if geometry is None
        else np.array(
            [_number(one) for one in (geometry.bolts, geometry.bolts_along_roll, geometry.bolts_along_shear)]
        ),
    )


def _number(value: float | None) -> float:
    return _NAN if value is None else value
