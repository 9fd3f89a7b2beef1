"""The monodromy matrix from the variational equation along a motion, for systems of many mounts.

Integrating a copy of the system for every unknown costs as many periods as there are unknowns, and most of them are hysteretic
states, which touch the system only through the force of their own mount. Along a motion that has been integrated already the
linear equation

    d/dt delta x = A(t) delta x

needs forward passes only, at the start of every step. The kernel makes one for each unknown. MuJoCo makes two for each free
coordinate and a few for all states together: a state's effect on the accelerations follows from the force it adds and the
mount's deflection gradient, which is force and motion of the same virtual work. The equation is integrated by RK4 over pairs of
steps, so that its three instants are sampled ones. States that follow Bouc-Wen's equation are scaled by their slope, see
`wirerope_mj.dynamics.periodic.laws`: their rows are those of the rates of their deflections.
"""

import os
from abc import ABC, abstractmethod
from dataclasses import dataclass, replace
from typing import cast

import mujoco
import numpy as np
from mujoco.batch import Batch

from wirerope_mj.dynamics.periodic.flow import Flow, KernelFlow, MujocoFlow
from wirerope_mj.dynamics.periodic.laws import ScaledStates
from wirerope_mj.dynamics.periodic.shooting import DIFFERENCE, Shot
from wirerope_mj.dynamics.periodic.stepping import integrate_linear
from wirerope_mj.engine.control import layout as at
from wirerope_mj.engine.system import System
from wirerope_mj.foundation.arrays import Array, Integers
from wirerope_mj.foundation.lanes import WIDTH

# Forward passes that are run at once.
ROWS = 512
FASTEST = 2.0  # largest decay of a state over two steps; RK4 is stable up to 2.78


@dataclass(frozen=True, kw_only=True)
class _Group:
    """Axes of a mount whose forces and rates depend on the same internal states, and these states."""

    mount: int
    axes: list[int]
    states: list[int]


def _groups(system: System) -> list[_Group]:
    """List the groups of axes of all mounts: the coupled axes of a mount together, others each alone."""
    groups = []
    for number, mount in enumerate(system.mounts.values()):
        coupled = list(mount.isolator.coupled_axes)
        for axes in [coupled] * bool(coupled) + [[axis] for axis in range(3) if axis not in coupled]:
            states = [state for axis in axes for state in range(mount.states[axis].start, mount.states[axis].stop)]
            groups += [_Group(mount=number, axes=axes, states=states)] if states else []
    return groups


class Variational(ABC):
    """Growth of small changes of state along a motion: the matrix A(t) of their equation, and what a period makes of them."""

    def __init__(self, flow: Flow) -> None:
        self._flow, self._free, self._model = flow, flow.coordinates.free, flow.model
        self.scaled = ScaledStates(flow.system)

    def matrix(self, at_shot: Shot) -> Array | None:
        """Compute the scaled monodromy matrix, (n_x, n_x).

        None where a constraint is active along the motion, and where an actuator of the model itself has activations.
        """
        track, scale, nf = at_shot.track, at_shot.scale, self._free.size
        q, v = slice(0, nf), slice(nf, 2 * nf)
        a = np.zeros((track.drive.steps, scale.size, -(-scale.size // WIDTH) * WIDTH))
        if not self._fill(at_shot, a):
            return None
        # States that decay faster than RK4 is stable over two steps decay at its limit, to the same values.
        decay = -a[:, np.arange(2 * nf, scale.size), np.arange(2 * nf, scale.size)]
        fast = np.maximum(decay * (2.0 * track.drive.duration / track.drive.steps) / FASTEST, 1.0)
        a[:, 2 * nf : scale.size] /= fast[:, :, np.newaxis]
        a[:, q, v] = np.diag(scale[v] / scale[q])
        # Small rotations change in a body's own axes, too: d/dt theta = omega' - omega x theta.
        model, turning = self._model, np.zeros((track.drive.steps, self._model.nv, self._model.nv))
        for joint in range(model.njnt):
            first = int(model.jnt_dofadr[joint]) + 3 * (model.jnt_type[joint] == mujoco.mjtJoint.mjJNT_FREE)
            if model.jnt_type[joint] in (mujoco.mjtJoint.mjJNT_FREE, mujoco.mjtJoint.mjJNT_BALL):
                x, y, z = track.qvel[:, first : first + 3].T
                for i, j, rate in ((0, 1, z), (0, 2, -y), (1, 2, x)):
                    turning[:, first + i, first + j], turning[:, first + j, first + i] = rate, -rate
        a[:, q, q] = turning[:, self._free[:, np.newaxis], self._free] * (scale[q] / scale[q, np.newaxis])
        # The rate of a scaled state's deflection is d/dt(G dq) = G dv + (G' + G turning) dq, times the slope at zero.
        rows, step = 2 * nf + self.scaled.states, track.drive.duration / track.drive.steps
        gradient = a[:, rows, q] * self.scaled.alpha[:, np.newaxis]
        change = (np.roll(gradient, -1, axis=0) - np.roll(gradient, 1, axis=0)) / (2.0 * step)
        a[:, rows, q], a[:, rows, v] = change + gradient @ a[:, q, q], gradient * (scale[v] / scale[q])
        slopes = self.scaled.along(track, self._flow.width, 2 * nf)
        fast = np.maximum(slopes.decay * (-2.0 * step / FASTEST), 1.0)  # the same for scaled states near their bounds
        slopes = replace(slopes, gain=slopes.gain / fast, decay=slopes.decay / fast)
        # Integrate d/dt phi = A phi from the identity, a step over two samples. Columns of A beyond n are padding to whole
        # lanes; most of A is zero: a mount's states do not depend on other mounts'.
        _, n, width = a.shape
        filled_rows, columns = np.nonzero((a[:, :, :n] != 0.0).any(axis=0))
        begin = np.searchsorted(filled_rows, np.arange(n + 1))
        phi = np.zeros((n, width))
        phi[:, :n] = np.diag(1.0 / slopes.begin)
        phi = np.ascontiguousarray(phi.reshape(n, -1, WIDTH).swapaxes(0, 1))
        integrate_linear(
            begin, np.ascontiguousarray(columns), a, step, slopes.scale, slopes.gain, slopes.decay, slopes.turns,
            slopes.waits, phi, np.empty((5 * n, WIDTH)),
        )  # fmt: skip
        return phi.swapaxes(0, 1).reshape(n, -1)[:, :n] * slopes.end[:, np.newaxis]

    @abstractmethod
    def _fill(self, at_shot: Shot, out: Array) -> bool:
        """Write rows of velocities and states into the scaled A, (n_steps, n_x, n_x or more); False with active constraints.

        The rows of scaled states hold the derivative G of their deflection by the configuration alone.
        """


class KernelVariational(Variational):
    """A(t) by forward passes of the kernel around the instants of a motion, a lane for each unknown."""

    def __init__(self, flow: KernelFlow) -> None:
        super().__init__(flow)
        self.flow = flow

    def _fill(self, at_shot: Shot, out: Array) -> bool:
        nv, nf, scale = self._model.nv, self._free.size, at_shot.scale
        moved = np.concatenate([self._free, nv + self._free, 2 * nv + np.arange(self._model.na)])
        moves = np.zeros((scale.size, 2 * nv + self._model.na))
        moves[np.arange(scale.size), moved] = DIFFERENCE * scale
        factors = 1.0 / (DIFFERENCE * scale[nf:])
        wanted = self.flow.addresses(self._free, self.scaled.states)
        return self.flow.differences_about(at_shot.track, moves, wanted, factors, out)


class MujocoVariational(Variational):
    """A(t) by MuJoCo's forward passes around the instants of a motion, many at once."""

    def __init__(self, flow: MujocoFlow) -> None:
        super().__init__(flow)
        self.flow, self.system, self.model = flow, flow.system, flow.model
        self._groups = _groups(self.system)
        self._colours = max((len(group.states) for group in self._groups), default=0)
        self.passes = 1 + 2 * self._free.size + self._colours
        self._instants = max(ROWS // self.passes, 1)
        self._batch = Batch(self.model, nsim=self._instants * self.passes, nthread=os.cpu_count() or 1)
        self._data = mujoco.MjData(self.model)
        self._out = {name: self._batch.bind(name) for name in ("qacc", "act_dot", "nefc", "userdata")}

    def _fill(self, at_shot: Shot, out: Array) -> bool:
        if self.model.na != self.system.assembly.tables.user.n_states:
            return False
        if self.flow.width:
            self._batch.expand("numeric_data")[:, self.flow.width_indices] = self.flow.width
        drive = at_shot.track.drive
        instants = drive.duration * np.arange(drive.steps) / drive.steps
        base = drive.sine(self.flow.coordinates.direction).acceleration(instants)
        parts = (np.arange(k, min(k + self._instants, drive.steps)) for k in range(0, drive.steps, self._instants))
        return all(self._around(at_shot, part, base, out) for part in parts)

    def _around(self, at_shot: Shot, instants: Integers, base: Array, out: Array) -> bool:
        """Write the scaled A at some instants from differences of MuJoCo's forward passes; False if a constraint is active."""
        track, scale, coordinates, nf = at_shot.track, at_shot.scale, self.flow.coordinates, self._free.size
        count, shape, assembly = instants.size * self.passes, (instants.size, self.passes, -1), self.system.assembly
        step = DIFFERENCE * scale
        # The states around each instant: as it is, then every q, every v, and z of every colour moved.
        self._batch.state[:count] = coordinates.carried(track.drive.frequency, track.drive.acceleration)
        qpos, qvel = self._batch.qpos[:count].reshape(shape), self._batch.qvel[:count].reshape(shape)
        act, user = self._batch.act[:count].reshape(shape), assembly.user(self._batch.userdata[:count].reshape(shape))
        qpos[:] = track.qpos[instants, np.newaxis]
        qvel[:] = track.qvel[instants, np.newaxis]
        act[:] = track.act[instants, np.newaxis]
        for j, dof in enumerate(self._free):
            move = np.zeros(self.model.nv)
            move[dof] = step[j]
            for row in qpos[:, 1 + j]:
                mujoco.mj_integratePos(self.model, row, move, 1.0)
            qvel[:, 1 + nf + j, dof] += step[nf + j]
        for group in self._groups:
            for colour, state in enumerate(group.states):
                act[:, 1 + 2 * nf + colour, state] += step[2 * nf + state]
        user[:, :, at.STAGE_POINTS] = 1.0
        user[:, :, at.STAGES : at.STAGES + 3] = base[instants, np.newaxis]
        self._batch.forward(np.arange(count))
        self.flow.passes += count
        if self._out["nefc"][:count].any():
            return False
        # Columns of configuration and velocities: differences of the forward passes.
        rates = self._out["act_dot"][:count].reshape(shape)
        record = assembly.tables.user.mount_rows(assembly.user(self._out["userdata"][:count].reshape(shape)))
        q, v, z = slice(0, nf), slice(nf, 2 * nf), slice(2 * nf, scale.size)
        a = np.zeros((instants.size, scale.size, scale.size))
        moved = slice(1, 1 + 2 * nf)
        for rows, values in ((v, self._out["qacc"][:count, self._free].reshape(shape)), (z, rates)):
            a[:, rows, : 2 * nf] = (values[:, moved] - values[:, :1]).swapaxes(1, 2) / step[: 2 * nf]
        # Columns of states: the force that a state adds, times the gradient of its mount's deflection by the free coordinates.
        inverse = np.stack([self._inverse_mass(track.qpos[i]) for i in instants])
        gradient = (record[:, 1 : 1 + nf, :, 0] - record[:, :1, :, 0]).transpose(0, 2, 3, 1) / step[q]
        for group in self._groups:
            for colour, state in enumerate(group.states):
                row, unit = 1 + 2 * nf + colour, step[2 * nf + state]
                force = (record[:, row, group.mount, 1] - record[:, 0, group.mount, 1])[:, group.axes] / unit
                load = np.einsum("kaj,ka->kj", gradient[:, group.mount][:, group.axes], force)
                a[:, v, 2 * nf + state] = -np.einsum("kij,kj->ki", inverse, load)
                gains = (rates[:, row] - rates[:, 0])[:, group.states]
                a[:, 2 * nf + np.array(group.states), 2 * nf + state] = gains / unit
        a[:, 2 * nf + self.scaled.states] = 0.0
        a[:, 2 * nf + self.scaled.states, q] = gradient[:, self.scaled.mounts, self.scaled.axes]
        out[instants, :, : scale.size] = a * (scale / scale[:, np.newaxis])
        return True

    def _inverse_mass(self, qpos: Array) -> Array:
        data = self._data
        data.qpos[:] = qpos
        mujoco.mj_kinematics(self.model, data)
        mujoco.mj_comPos(self.model, data)
        mujoco.mj_makeM(self.model, data)
        mass = np.zeros((self.model.nv, self.model.nv))
        mujoco.mj_fullM(self.model, data, mass)
        return np.asarray(np.linalg.inv(mass[np.ix_(self._free, self._free)]))


def variational_of(flow: Flow) -> Variational:
    return KernelVariational(flow) if isinstance(flow, KernelFlow) else MujocoVariational(cast(MujocoFlow, flow))
