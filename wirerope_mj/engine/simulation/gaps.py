"""Gaps between the geoms of declared pairs where samples place them: spheres beside planes and boxes by closed forms."""

import mujoco
import numpy as np

from wirerope_mj.engine.control import layout as at
from wirerope_mj.engine.kernel.bodies import FARTHEST
from wirerope_mj.engine.system import System, once_per_system
from wirerope_mj.engine.system.tables import declared_pairs
from wirerope_mj.foundation.arrays import Array
from wirerope_mj.foundation.directions import rotation_matrices

_TOUCHING = 1e-15  # distance of a sphere's centre from a box within which it counts as inside [m], as MuJoCo has it
_PLANE, _SPHERE, _BOX = (
    int(kind) for kind in (mujoco.mjtGeom.mjGEOM_PLANE, mujoco.mjtGeom.mjGEOM_SPHERE, mujoco.mjtGeom.mjGEOM_BOX)
)


@once_per_system
def gaps_of(system: System) -> "Gaps":
    """Return the gaps of a system, made once."""
    return Gaps(system)


class Gaps:
    """Geoms of the declared pairs of a system, to be placed as samples say."""

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
        """Return MuJoCo's data with what is fixed to the world in its place."""
        data = mujoco.MjData(self._model)
        mujoco.mj_kinematics(self._model, data)
        return data

    def of(self, values: Array) -> Array:
        """Return the gaps [m], < 0 where pressed, (n_t, n_pairs), at samples with these sensor values, (n_t, n_values)."""
        model = self._model
        turns = {first: rotation_matrices(values[:, first + 3 : first + 7]) for first in set(self._moving.values())}
        places = self._fixed.copy()  # positions (n_t, 3) and axes (n_t, 3, 3) of every geom, (1, ..) of what does not move
        for geom, first in self._moving.items():
            from_centre = model.geom_pos[geom] - model.body_ipos[model.geom_bodyid[geom]]
            places[geom] = values[:, first : first + 3] + turns[first] @ from_centre, turns[first] @ self._turns[geom]
        gaps = np.empty((len(values), len(self._pairs)))
        for number, pair in enumerate(self._pairs):
            one, other = sorted(pair, key=lambda geom: int(model.geom_type[geom] == _SPHERE))
            kind, size = int(model.geom_type[one]), model.geom_size[one]
            if model.geom_type[other] == _SPHERE and kind in (_PLANE, _BOX):
                apart = places[other][0] - places[one][0]
                nearest = _beside_plane(places[one][1], apart) if kind == _PLANE else _beside_box(places[one][1], size, apart)
                gaps[:, number] = np.minimum(nearest - model.geom_size[other, 0], FARTHEST)
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


def _beside_plane(axes: Array, apart: Array) -> Array:
    """Return the heights (n_t,) of points `apart` (n_t, 3) from a plane's origin above it, in MuJoCo's order of sums."""
    normal = axes[:, :, 2]
    return apart[:, 0] * normal[:, 0] + apart[:, 1] * normal[:, 1] + apart[:, 2] * normal[:, 2]


def _beside_box(axes: Array, half: Array, apart: Array) -> Array:
    """Return the distances (n_t,) of points `apart` (n_t, 3) from a box's centre to its faces; inside it is negative."""
    parts = (axes[:, 0] * apart[:, :1], axes[:, 1] * apart[:, 1:2], axes[:, 2] * apart[:, 2:])
    local = parts[0] + parts[1] + parts[2]
    beyond = local - np.clip(local, -half, half)
    outside = np.sqrt(beyond[:, 0] ** 2 + beyond[:, 1] ** 2 + beyond[:, 2] ** 2)
    inside = np.minimum(np.abs(half + local), np.abs(half - local)).min(axis=1)
    return np.where(outside <= _TOUCHING, -inside, outside)
