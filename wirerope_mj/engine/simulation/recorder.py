"""The samples of a run on their way into a response, with the drawable scene."""

import math
from pathlib import Path

import mujoco
import numpy as np

from wirerope_mj.engine.control import layout as at
from wirerope_mj.engine.kernel.bodies import FARTHEST
from wirerope_mj.engine.response.histories import ColumnPlan, MemorySamples, Numerics
from wirerope_mj.engine.response.peaks import Peaks
from wirerope_mj.engine.response.response import FILE, Response, load_response, response_metadata, response_of
from wirerope_mj.engine.response.scene import Geom, GeomShape, Scene, SceneBody, SceneMount
from wirerope_mj.engine.simulation.grid import TimeGrid
from wirerope_mj.engine.system import Mount, System, once_per_system
from wirerope_mj.engine.system.tables import declared_pairs
from wirerope_mj.foundation.arrays import Array, Entries
from wirerope_mj.foundation.directions import rotation_matrices
from wirerope_mj.foundation.parquet_files import TableWriter
from wirerope_mj.foundation.state import State
from wirerope_mj.motions import BaseMotion

_SHAPES: dict[mujoco.mjtGeom, GeomShape] = {
    mujoco.mjtGeom.mjGEOM_PLANE: "plane", mujoco.mjtGeom.mjGEOM_SPHERE: "sphere",
    mujoco.mjtGeom.mjGEOM_CAPSULE: "capsule", mujoco.mjtGeom.mjGEOM_ELLIPSOID: "ellipsoid",
    mujoco.mjtGeom.mjGEOM_CYLINDER: "cylinder", mujoco.mjtGeom.mjGEOM_BOX: "box", mujoco.mjtGeom.mjGEOM_MESH: "mesh",
}  # fmt: skip

_TOUCHING = 1e-15  # distance of a sphere's centre from a box within which it counts as inside [m], as MuJoCo has it
_PLANE, _SPHERE, _BOX = (
    int(kind) for kind in (mujoco.mjtGeom.mjGEOM_PLANE, mujoco.mjtGeom.mjGEOM_SPHERE, mujoco.mjtGeom.mjGEOM_BOX)
)

STREAM_ROWS = 4096  # samples that are kept in memory before a block is written to disk


@once_per_system
def scene_of(system: System) -> Scene:
    """Return bodies, geoms and mounts of a system in its modelled geometry; geoms of other kinds are left out."""
    model = system.model
    base = model.body(system.base).id if system.base else -1
    modal, bends = ({getattr(mode, which) for mode in system.assembly.subjects.modes} for which in ("body", "owner"))
    bodies = []
    with system.assembly.scratch.data(model) as data:
        mujoco.mj_kinematics(model, data)
        for body in sorted(set(range(model.nbody)) - modal):
            moves, name = bool(model.body_weldid[body] != 0), model.body(body).name
            bodies.append(
                SceneBody(
                    name=name or f"world_{body}" if not moves and body != 0 else name, moves=moves,
                    on_base=bool(moves and model.body_weldid[body] == base), position=data.xipos[body].copy(),
                    orientation=data.xquat[body].copy(), geoms=_geoms(model, body), bends=body in bends,
                )
            )  # fmt: skip
        mounts = tuple(_mount(model, data, mount) for mount in system.mounts.values())
    return Scene(
        name=system.name, base=system.base, bodies=tuple(bodies), mounts=mounts, limits=system.limits,
        combined_travel=system.combined_travel, areas=system.areas,
    )  # fmt: skip


def _geoms(model: mujoco.MjModel, body: int) -> tuple[Geom, ...]:
    first = int(model.body_geomadr[body])
    geoms = []
    for g in range(first, first + int(model.body_geomnum[body])):
        shape = _SHAPES.get(mujoco.mjtGeom(model.geom_type[g]))
        if shape is None:
            continue
        material, mesh, more = int(model.geom_matid[g]), int(model.geom_dataid[g]), {}
        if shape == "mesh":
            vertices = model.mesh_vert[int(model.mesh_vertadr[mesh]) :][: model.mesh_vertnum[mesh]]
            faces = model.mesh_face[int(model.mesh_faceadr[mesh]) :][: model.mesh_facenum[mesh]]
            more = {"vertices": vertices.astype(np.float64), "faces": faces.astype(np.float64)}
        rgba = model.geom_rgba[g] if material < 0 else model.mat_rgba[material]
        geoms.append(
            Geom(
                name=model.geom(g).name, shape=shape, size=model.geom_size[g].copy(), rgba=rgba.astype(np.float64),
                position=model.geom_pos[g] - model.body_ipos[body], orientation=model.geom_quat[g].copy(), **more,
            )
        )  # fmt: skip
    return tuple(geoms)


def _mount(model: mujoco.MjModel, data: mujoco.MjData, mount: Mount) -> SceneMount:
    """Describe a mount for drawing: its sites in the frames of their bodies, and its device's sizes and ratings."""
    sites = [model.site(name).id for name in (mount.payload_site, mount.base_site)]
    on = [int(model.site_bodyid[site]) for site in sites]
    rotation = data.xmat[on[1]].reshape(3, 3)
    isolator = mount.isolator
    sizes = ("height", "width", "bar", "bolts", "bolts_along_roll", "bolts_along_shear")
    height, width, bar, *bolts = (_number(getattr(isolator.geometry, size, None)) for size in sizes)
    return SceneMount(
        name=mount.name, isolator=isolator.name, payload_body=model.body(on[0]).name, base_body=model.body(on[1]).name,
        payload_point=model.site_pos[sites[0]] - model.body_ipos[on[0]],
        base_point=model.site_pos[sites[1]] - model.body_ipos[on[1]], axes=rotation.T @ mount.axes, height=height,
        width=width, bar=bar, static_load=_number(isolator.limits.static_load), travel=isolator.limits.travel.stated,
        stop=isolator.is_stop, bolts=np.array(bolts),
    )  # fmt: skip


def _number(value: float | None) -> float:
    return math.nan if value is None else value


class Recorder:
    """Takes the samples of a run, in memory or to a file, and makes the response of them."""

    def __init__(self, system: System, motion: BaseMotion, grid: TimeGrid, out: Path | None) -> None:
        """Prepare the samples of `grid`; they are streamed to the folder `out`, or kept in memory if it is None."""
        self._system, self._motion, self._times = system, motion, grid.sample_times
        self.plan = column_plan(system)
        self._names = self.plan.names.copy()
        self._first_gap = len(self._names) - len(self.plan.contacts)
        self._gaps = Gaps(system) if self.plan.contacts else None
        self._writer = TableWriter(out / FILE, self._names) if out is not None else None
        rows = min(STREAM_ROWS, self._times.size) if out is not None else self._times.size
        self._block = np.empty((rows, len(self._names)))
        self._written = 0

    def add(self, first: int, values: Array) -> None:
        """Add the sensor values of samples from number `first` on, (n_samples, n_values); 0 starts from the beginning."""
        if first == 0 and self._written and self._writer is not None:
            self._writer.discard()
            self._writer, self._written = TableWriter(self._writer.path, self._names), 0
        while len(values):
            row = first - self._written
            some = values[: self._block.shape[0] - row]
            self._block[row : row + len(some), self.plan.first_sensor : self._first_gap] = some
            first, values = first + len(some), values[len(some) :]
            if self._writer is not None and first - self._written == self._block.shape[0]:
                self._writer.write(self._complete_rows(self._block.shape[0]))
                self._written = first

    def _complete_rows(self, rows: int) -> Array:
        """Write instants, base motion and gaps of contacts into the first rows of the block of samples; returns these rows."""
        times = self._times[self._written : self._written + rows]
        self._block[:rows, 0] = times
        for column, part in enumerate((self._motion.displacement, self._motion.velocity, self._motion.acceleration)):
            self._block[:rows, 1 + 3 * column : 4 + 3 * column] = part(times)
        if self._gaps is not None:
            sensors = self._block[:rows, self.plan.first_sensor : self._first_gap]
            self._block[:rows, self._first_gap :] = self._gaps.of(sensors)
        return self._block[:rows]

    def finish(self, start: State, final: State, peaks: Peaks, numerics: Numerics) -> Response:
        """Return the response of a completed run."""
        parts: Entries = {
            "peaks": peaks,
            "scene": scene_of(self._system),
            "motion": self._motion.to_dict(),
            "events": self._motion.events,
            "numerics": numerics,
            "initial_state": State(values=start.values.copy(), time=start.time),  # others may start from it, too
            "final_state": final,
        }
        rest = self._complete_rows(self._times.size - self._written)
        if self._writer is None:
            return response_of(self.plan, MemorySamples(self._names, rest), **parts)
        if rest.size:
            self._writer.write(rest)
        self._writer.close(response_metadata(self.plan, parts))
        return load_response(self._writer.path.parent)

    def discard(self) -> None:
        if self._writer is not None:
            self._writer.discard()


@once_per_system
def column_plan(system: System) -> ColumnPlan:
    """Return the layout of the sampled columns of a system."""
    subjects, mounts = system.assembly.subjects, []
    for name, mount in system.mounts.items():
        laws = ((axis, law) for axis, law in mount.isolator.axes.items() if law is not None)
        mounts.append((name, tuple(f"{axis}.{state}" for axis, law in laws for state in law.state_names)))
    return ColumnPlan(
        bodies=subjects.body_names, points=subjects.point_names, mounts=mounts, contacts=list(system.assembly.contacts)
    )


class Gaps:
    """Gaps of the model's declared geom pairs at the samples: of spheres to planes and boxes by closed forms, else MuJoCo's."""

    def __init__(self, system: System) -> None:
        self._model, subjects = system.model, system.assembly.subjects
        self._pairs = declared_pairs(self._model)
        column = {body: at.KINEMATICS * number for number, body in enumerate(subjects.bodies)}
        geoms = {geom: int(self._model.geom_bodyid[geom]) for pair in self._pairs for geom in pair}
        moving = sorted(geom for geom, body in geoms.items() if body in column)
        self._moving = {geom: column[geoms[geom]] for geom in moving}
        self._turns = dict(zip(moving, rotation_matrices(self._model.geom_quat[moving]), strict=True))
        data = self._data()
        fixed = geoms.keys() - self._moving.keys()
        self._fixed = {geom: (data.geom_xpos[[geom]], data.geom_xmat[[geom]].reshape(1, 3, 3)) for geom in fixed}

    def _data(self) -> mujoco.MjData:
        """Return MuJoCo data in which the geoms fixed to the world are in position."""
        data = mujoco.MjData(self._model)
        mujoco.mj_kinematics(self._model, data)
        return data

    def of(self, values: Array) -> Array:
        """Compute the gaps of all pairs [m], < 0 where pressed, (n_t, n_pairs), from sampled sensor values (n_t, n_values)."""
        model = self._model
        turns = {first: rotation_matrices(values[:, first + 3 : first + 7]) for first in set(self._moving.values())}
        places = self._fixed.copy()  # positions (n_t, 3) and axes (n_t, 3, 3) of every geom, (1, ..) of what does not move
        for geom, first in self._moving.items():
            from_centre = model.geom_pos[geom] - model.body_ipos[model.geom_bodyid[geom]]
            places[geom] = values[:, first : first + 3] + turns[first] @ from_centre, turns[first] @ self._turns[geom]
        gaps = np.empty((len(values), len(self._pairs)))
        for number, pair in enumerate(self._pairs):
            other_geom, sphere = sorted(pair, key=lambda geom: int(model.geom_type[geom] == _SPHERE))
            kind, size = int(model.geom_type[other_geom]), model.geom_size[other_geom]
            if model.geom_type[sphere] == _SPHERE and kind in (_PLANE, _BOX):
                apart = places[sphere][0] - places[other_geom][0]
                if kind == _PLANE:  # the height above it, in MuJoCo's order of sums
                    x, y, z = (apart * places[other_geom][1][:, :, 2]).T
                    nearest = x + y + z
                else:
                    nearest = _distance_from_box(places[other_geom][1], size, apart)
                gaps[:, number] = np.minimum(nearest - model.geom_size[sphere, 0], FARTHEST)
            else:
                gaps[:, number] = self._by_mujoco(places, pair, len(values))
        return gaps

    def _by_mujoco(self, places: dict[int, tuple[Array, Array]], pair: tuple[int, int], n_t: int) -> Array:
        """Return the gaps of a pair by MuJoCo, sample by sample."""
        model, data, gaps, line = self._model, self._data(), np.empty(n_t), np.empty(6)
        xpos, xmat = data.geom_xpos, data.geom_xmat  # each access makes an array
        moving = [(geom, places[geom][0], places[geom][1].reshape(-1, 9)) for geom in pair if geom in self._moving]
        for row in range(n_t):
            for geom, positions, axes in moving:
                xpos[geom], xmat[geom] = positions[row], axes[row]
            gaps[row] = mujoco.mj_geomDistance(model, data, *pair, FARTHEST, line)
        return gaps


def _distance_from_box(axes: Array, half: Array, apart: Array) -> Array:
    """Return the distances of points from a box's surface, (n_t,), < 0 inside; `apart`: points from its centre, (n_t, 3)."""
    parts = (axes[:, 0] * apart[:, :1], axes[:, 1] * apart[:, 1:2], axes[:, 2] * apart[:, 2:])
    local = parts[0] + parts[1] + parts[2]
    beyond = local - np.clip(local, -half, half)
    outside = np.sqrt(beyond[:, 0] ** 2 + beyond[:, 1] ** 2 + beyond[:, 2] ** 2)
    inside = np.minimum(np.abs(half + local), np.abs(half - local)).min(axis=1)
    return np.where(outside <= _TOUCHING, -inside, outside)
