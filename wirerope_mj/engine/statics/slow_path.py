"""Hysteretic states of the mounts after slow, straight deflection from the last load step's equilibrium to a position."""

import math

import mujoco
import numpy as np

from wirerope_mj.engine.control import layout as at
from wirerope_mj.engine.control.mounts import separation
from wirerope_mj.engine.control.vectors import column, dot
from wirerope_mj.engine.kernel.carry import LINE
from wirerope_mj.engine.system import System
from wirerope_mj.foundation.arrays import Array, Booleans
from wirerope_mj.foundation.jit import njit
from wirerope_mj.mounts.laws.path import SCRATCH, advance, put
from wirerope_mj.mounts.laws.plane_kernels import BIAXIAL, ON_BRACKETS


def remembering_axes(system: System) -> Booleans:
    """Find the mount axes, (3 n_mounts,), whose states depend on a slow path of deflections.

    Laws that depend on the rate have no memory of it: their states stay zero.
    """
    isolators = [mount.isolator for mount in system.mounts.values()]
    laws = [(law, axis in isolator.coupled_axes) for isolator in isolators for axis, law in enumerate(isolator.axes.values())]
    follow = [law is not None and law.remembers_slow_paths and law.n_states > 0 and not coupled for law, coupled in laws]
    return np.array(follow, dtype=np.bool_)


@njit
def deflect(lay, site_xpos, site_xmat, qpos, deflection):  # type: ignore[no-untyped-def]
    """Write the mounts' deflections in their axes, (n_mounts, 3)."""
    m = int(lay[at.MOUNTS])
    for mount in range(deflection.shape[0]):
        _, apart = separation(lay, 0, m, site_xpos, site_xmat, qpos)
        for axis in range(3):
            deflection[mount, axis] = dot(column(site_xmat, 9 * int(lay[m + at.BASE_SITE]), axis), apart)
        m += at.MOUNT_COLUMNS


@njit
def follow(lay, par, single, coupled, partners, scales, planes, before, after, states):  # type: ignore[no-untyped-def]
    """Carry `states` in place on straight lines from deflections `before` to `after`, (n_mounts, 3).

    `single` (n_mounts, 3) says which axes follow a law of their own; `coupled` names the mounts whose roll and another axis,
    the partner, share a law of one or more scales, `scales` counts them, `planes` (n_coupled, n) holds their parameters. On
    brackets `scales` is -1, and all go together.
    """
    slopes, trial = np.empty(SCRATCH * (states.size + 1)), np.empty(states.size + 1)  # enough for any of the laws
    axes, z = int(lay[at.AXES]), np.empty(states.size + 2)
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
            alone, row = scales[number] >= 0, axes + 3 * at.AXIS_COLUMNS * mount + 2
            law, line, n, first = (BIAXIAL, LINE, 1, scales[number]) if alone else (ON_BRACKETS, 1, int(lay[row + 1]), 0)
            p[line], p[line + 1] = before[mount, 0], before[mount, other]
            p[line + 2], p[line + 3] = dx / length, dy / length
            j, k = int(lay[row]) + first, int(lay[row + at.AXIS_COLUMNS * other]) + first
            put(states, j, z, 0, n)
            put(states, k, z, n, n)
            advance(law, p, 0, 0.0, length, z, 0, 2 * n, slopes, trial)
            put(z, 0, states, j, n)
            put(z, n, states, k, n)


class SlowPath:
    """Internal states of the mounts in positions reached slowly and straight from where the last load step ended."""

    def __init__(self, system: System) -> None:
        self.tables, self.single = system.assembly.tables, remembering_axes(system).reshape(-1, 3)
        mounts = [mount.isolator for mount in system.mounts.values()]
        coupled = [(row, isolator.coupled) for row, isolator in enumerate(mounts)]
        pairs = [
            (row, scale, law)
            for row, coupling in coupled if coupling is not None
            for scale, law in ([(-1, coupling)] if coupling.brackets is not None else enumerate(coupling.scales))
        ]  # fmt: skip
        self.coupled = np.array([row for row, _, _ in pairs], dtype=np.int64)
        self.scales = np.array([scale for _, scale, _ in pairs], dtype=np.int64)
        self.partners = np.array([mounts[row].coupled_axes[1] for row, _, _ in pairs], dtype=np.int64)
        lines = [law.line_parameters(np.zeros(2), np.zeros(2))[0] for _, _, law in pairs]
        self.planes = np.zeros((len(pairs), max(map(len, lines), default=0)))
        for row, line in zip(self.planes, lines, strict=True):
            row[: line.size] = line
        self.rest_deflection = np.zeros((len(mounts), 3))
        self.rest_states = np.zeros(self.tables.user.n_states)

    def states_at(self, data: mujoco.MjData) -> Array:
        """Return the internal states in the position of `data`."""
        states, tables, deflection = self.rest_states.copy(), self.tables, self._deflections(data)
        laws = tables.layout, tables.parameters, self.single, self.coupled, self.partners, self.scales, self.planes
        follow(*laws, self.rest_deflection, deflection, states)
        return states

    def rest_at(self, data: mujoco.MjData) -> None:
        """Take the position of `data` as the start of the next paths."""
        self.rest_states, self.rest_deflection = self.states_at(data), self._deflections(data)

    def _deflections(self, data: mujoco.MjData) -> Array:
        deflections = np.empty_like(self.rest_deflection)
        site_xpos, site_xmat = data.site_xpos.reshape(-1), data.site_xmat.reshape(-1)
        deflect(self.tables.layout, site_xpos, site_xmat, data.qpos, deflections)
        return deflections
