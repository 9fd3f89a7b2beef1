"""The mounts' internal states on a slow path: straight from where one load step ended to the next."""

import math

import mujoco
import numpy as np

from wirerope_mj.engine.control import layout as at
from wirerope_mj.engine.system import System
from wirerope_mj.foundation.arrays import Array
from wirerope_mj.foundation.jit import njit
from wirerope_mj.mounts.laws.path import SCRATCH, advance
from wirerope_mj.mounts.laws.plane_kernels import BIAXIAL

# index of a line's start and direction among the parameters of the biaxial kernel, whose rates all couplings have
LINE = 12


@njit
def deflect(lay, site_xpos, site_xmat, deflection):  # type: ignore[no-untyped-def]
    """Write the mounts' deflections in their axes, (n_mounts, 3)."""
    row = int(lay[at.MOUNTS])
    for mount in range(deflection.shape[0]):
        payload, base = int(lay[row]), int(lay[row + 1])
        for axis in range(3):
            total = 0.0
            for c in range(3):
                total += site_xmat[base, 3 * c + axis] * (site_xpos[payload, c] - site_xpos[base, c])
            deflection[mount, axis] = total
        row += at.MOUNT_COLUMNS


@njit
def follow(lay, par, single, coupled, partners, scales, planes, before, after, states):  # type: ignore[no-untyped-def]
    """Carry `states` in place on straight lines from deflections `before` to `after`, (n_mounts, 3).

    `single` (n_mounts, 3) says which axes follow a law of their own; `coupled` names the mounts whose roll and another axis,
    the partner, share a law of one or more scales, `scales` counts them, `planes` (n_coupled, 16) holds their parameters.
    """
    slopes, trial = np.empty(SCRATCH * (states.size + 1)), np.empty(states.size + 1)  # enough for any of the laws
    axes, z = int(lay[at.AXES]), np.empty(2)
    for mount in range(before.shape[0]):
        for axis in range(3):
            row = axes + at.AXIS_COLUMNS * (3 * mount + axis)
            if single[mount, axis]:
                law, p, first, n_states = int(lay[row]), int(lay[row + 1]), int(lay[row + 2]), int(lay[row + 3])
                x0, x1 = before[mount, axis], after[mount, axis]
                advance(law, par, p, x0, x1, states, first, n_states, slopes, trial)
    for number in range(coupled.size):
        mount, other, p = coupled[number], partners[number], planes[number]
        dx, dy = after[mount, 0] - before[mount, 0], after[mount, other] - before[mount, other]
        length = math.sqrt(dx * dx + dy * dy)
        if length > 0.0:
            p[LINE], p[LINE + 1] = before[mount, 0], before[mount, other]
            p[LINE + 2], p[LINE + 3] = dx / length, dy / length
            row = axes + 3 * at.AXIS_COLUMNS * mount + 2
            j, k = int(lay[row]) + scales[number], int(lay[row + at.AXIS_COLUMNS * other]) + scales[number]
            z[0], z[1] = states[j], states[k]
            advance(BIAXIAL, p, 0, 0.0, length, z, 0, 2, slopes, trial)
            states[j], states[k] = z[0], z[1]


class SlowPath:
    """The mounts' internal states in positions that are reached straight from where the last load step ended."""

    def __init__(self, system: System) -> None:
        self.tables = system.assembly.tables
        mounts = [mount.isolator for mount in system.mounts.values()]
        # What depends on the rate has no memory of a slow path: its states stay zero.
        self.single = np.array(
            [
                [
                    law is not None and law.remembers_slow_paths and axis not in isolator.coupled_axes
                    for axis, law in enumerate(isolator.axes.values())
                ]
                for isolator in mounts
            ],
            dtype=bool,
        ).reshape(len(mounts), 3)
        pairs = [
            (row, scale, law)
            for row, isolator in enumerate(mounts)
            if isolator.coupled is not None
            for scale, law in enumerate(isolator.coupled.scales)
        ]
        self.coupled = np.array([row for row, _, _ in pairs], dtype=np.int64)
        self.scales = np.array([scale for _, scale, _ in pairs], dtype=np.int64)
        self.partners = np.array([mounts[row].coupled_axes[1] for row, _, _ in pairs], dtype=np.int64)
        lines = [law.line_parameters(np.zeros(2), np.zeros(2))[0][: LINE + 4] for _, _, law in pairs]
        self.planes = np.array(lines).reshape(len(pairs), LINE + 4)
        self.rest_deflection = np.zeros((len(mounts), 3))
        self.rest_states = np.zeros(self.tables.user.n_states)

    def states_at(self, data: mujoco.MjData) -> Array:
        """Return the internal states in the position of `data`."""
        states, tables, deflection = self.rest_states.copy(), self.tables, self._deflections(data)
        laws = tables.layout, tables.parameters, self.single, self.coupled, self.partners, self.scales, self.planes
        follow(*laws, self.rest_deflection, deflection, states)
        return states

    def rest_at(self, data: mujoco.MjData) -> None:
        """Make the position of `data` the one that the next are reached from."""
        self.rest_states, self.rest_deflection = self.states_at(data), self._deflections(data)

    def _deflections(self, data: mujoco.MjData) -> Array:
        deflections = np.empty_like(self.rest_deflection)
        deflect(self.tables.layout, data.site_xpos, data.site_xmat, deflections)
        return deflections
