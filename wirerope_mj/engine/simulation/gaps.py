"""Gaps of the pairs of geoms that the model declares, from the sampled poses of their bodies."""

import mujoco
import numpy as np

from wirerope_mj.engine.control import layout as at
from wirerope_mj.engine.system import System
from wirerope_mj.engine.system.contact_pairs import declared_pairs
from wirerope_mj.foundation.arrays import Array
from wirerope_mj.foundation.directions import rotation_matrices

FARTHEST = 1e3
"""Gap that is as good as any larger one [m]."""


class Gaps:
    """Geoms of the declared pairs of a system, to be placed as samples say."""

    def __init__(self, system: System) -> None:
        self._model, subjects = system.model, system.assembly.subjects
        self._data = mujoco.MjData(self._model)
        mujoco.mj_kinematics(self._model, self._data)  # what is fixed to the world stays there
        self._pairs = declared_pairs(self._model)
        column = {body: at.KINEMATICS * number for number, body in enumerate(subjects.bodies)}
        body_of = self._model.geom_bodyid
        moving = sorted({geom for pair in self._pairs for geom in pair if int(body_of[geom]) in column})
        self._moving = {geom: column[int(body_of[geom])] for geom in moving}
        self._turns = dict(zip(moving, rotation_matrices(self._model.geom_quat[moving]), strict=True))

    def of(self, values: Array) -> Array:
        """Return the gaps [m], < 0 where pressed, (n_t, n_pairs), at samples with these sensor values, (n_t, n_values)."""
        model, data = self._model, self._data
        turns = {first: rotation_matrices(values[:, first + 3 : first + 7]) for first in set(self._moving.values())}
        places = {
            geom: self._places(geom, values[:, first : first + 3], turns[first]) for geom, first in self._moving.items()
        }
        gaps, line = np.empty((len(values), len(self._pairs))), np.empty(6)
        for row in range(len(values)):
            for geom, (positions, axes) in places.items():
                data.geom_xpos[geom], data.geom_xmat[geom] = positions[row], axes[row]
            for number, (one, other) in enumerate(self._pairs):
                gaps[row, number] = mujoco.mj_geomDistance(model, data, one, other, FARTHEST, line)
        return gaps

    def _places(self, geom: int, centres: Array, turns: Array) -> tuple[Array, Array]:
        """Return positions (n_t, 3) and axes (n_t, 9) of a geom; of its body: centres of mass (n_t, 3), axes (n_t, 3, 3)."""
        from_centre = self._model.geom_pos[geom] - self._model.body_ipos[self._model.geom_bodyid[geom]]
        return centres + turns @ from_centre, (turns @ self._turns[geom]).reshape(-1, 9)
