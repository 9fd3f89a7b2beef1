"""A system on its way from weightlessness to its full weight."""

import mujoco
import numpy as np

from wirerope_mj.control import installed
from wirerope_mj.control import layout as at
from wirerope_mj.errors import ConvergenceError
from wirerope_mj.laws.kernels import BIAXIAL
from wirerope_mj.laws.path import SCRATCH, advance
from wirerope_mj.state import State
from wirerope_mj.statics.result import Array, Equilibrium, History, MountLoad
from wirerope_mj.system import System

AXIAL = 2
"""Place of the axial axis; a coupling is between the other two."""

LOAD_STEPS = 20
"""Steps in which gravity grows from 0 to g: each is short enough for Newton's method to start from the last."""

SMALLEST_LOAD_STEP = 1e-4
"""Share of gravity below which a load step that fails is a load that cannot be carried."""

TOLERANCE = 1e-11
"""Largest acceleration left, relative to gravity: two orders above the rounding of forces of tonnes."""

ACCEPTED = 1e-8
"""What is accepted where rounding or a contact's own iteration stops Newton's method earlier; relative to gravity."""

ITERATIONS = 30
"""Newton iterations of one load step: ten times what a smooth step takes."""


class Loading:
    """A system on its way from weightlessness to its full weight."""

    def __init__(self, system: System, history: History) -> None:
        self.system, self.history, self.model = system, history, system.model.__copy__()
        self.data = mujoco.MjData(self.model)
        self.gravity = self.model.opt.gravity.copy()
        self.free = np.setdiff1d(np.arange(self.model.nv), system.assembly.driven_dofs)
        n_states = system.assembly.tables.user.n_states
        self.rest_deflection = np.zeros((len(system.mounts), 3))
        self.rest_states = np.zeros(n_states)
        # What depends on the rate has no memory of a slow path: its states stay zero.
        self.laws = [
            (row, axis, law.kernel, law.kernel_parameters(), states.start, law.n_states)
            for row, mount in enumerate(system.mounts.values())
            for axis, (law, states) in enumerate(zip(mount.isolator.axes.values(), mount.states, strict=True))
            if law is not None and law.rate_independent and (axis == AXIAL or mount.isolator.coupling is None)
        ]
        self.planes = [
            (row, mount.isolator.coupled, mount.states[0].start)
            for row, mount in enumerate(system.mounts.values())
            if mount.isolator.coupled is not None
        ]

    def solve(self) -> Equilibrium:
        """Return the equilibrium under the full weight."""
        scale = max(float(np.linalg.norm(self.gravity)), 1.0)  # without gravity rounding is still that of the forces
        with installed(self.model, self.data):
            qpos, load, step = self.model.qpos0.copy(), 0.0, 1.0 / LOAD_STEPS
            residual = 0.0
            while load < 1.0:
                trial_load = min(load + step, 1.0)
                self.model.opt.gravity[:] = trial_load * self.gravity
                trial, residual = self._newton(qpos, TOLERANCE * scale)
                if residual > ACCEPTED * scale:
                    step /= 2.0
                    if step < SMALLEST_LOAD_STEP:
                        self._accelerations(qpos)  # back to the last load that was carried
                        raise ConvergenceError(self._diagnosis(trial_load, residual))
                    continue
                qpos, load = trial, trial_load
                self._accelerations(qpos)
                deflections = self._deflections()
                self.rest_states = self._states_at(deflections)
                self.rest_deflection = deflections
            return self._result(qpos, residual)

    def _newton(self, qpos: Array, tolerance: float) -> tuple[Array, float]:
        """Return the position where accelerations vanish, and what is left of them."""
        value = self._accelerations(qpos)
        norm = float(np.abs(value).max(initial=0.0))
        for _ in range(ITERATIONS):
            if norm <= tolerance:
                break
            step = np.asarray(np.linalg.lstsq(self._jacobian(qpos), -value, rcond=None)[0], dtype=np.float64)
            scale = min(1.0, 0.1 / max(float(np.abs(step).max()), 1e-12))  # 0.1 m or rad is more than any mount travels
            for _halving in range(12):
                trial = self._moved(qpos, np.asarray(scale * step))
                trial_value = self._accelerations(trial)
                trial_norm = float(np.abs(trial_value).max(initial=0.0))
                if trial_norm < norm:
                    break
                scale /= 2.0
            else:
                break
            qpos, value, norm = trial, trial_value, trial_norm
        return qpos, norm

    def _jacobian(self, qpos: Array) -> Array:
        # 1e-7 m is small against any travel and gives differences eight digits above the rounding of the forces. To both sides:
        # where a load step begins a law is stiffer one way than the other, and one-sided columns of two bodies that deflect the
        # same mount against each other would take a slope each.
        epsilon = 1e-7
        columns = []
        for dof in range(self.free.size):
            step = np.zeros(self.free.size)
            step[dof] = epsilon
            above, below = (self._accelerations(self._moved(qpos, side)) for side in (step, -step))
            columns.append((above - below) / (2.0 * epsilon))
        return np.stack(columns, axis=1)

    def _moved(self, qpos: Array, step: Array) -> Array:
        velocity, moved = np.zeros(self.model.nv), qpos.copy()
        velocity[self.free] = step
        mujoco.mj_integratePos(self.model, moved, velocity, 1.0)
        return moved

    def _accelerations(self, qpos: Array) -> Array:
        """Return MuJoCo's accelerations of the free coordinates at rest in `qpos`."""
        model, data = self.model, self.data
        data.qpos[:], data.qvel[:] = qpos, 0.0
        mujoco.mj_fwdPosition(model, data)
        first = self.system.assembly.activation
        data.act[first : first + self.rest_states.size] = self._states_at(self._deflections())
        mujoco.mj_forward(model, data)
        return data.qacc[self.free].copy()

    def _deflections(self) -> Array:
        """Return the mounts' deflections in their axes, (n_mounts, 3)."""
        data = self.data
        return np.array(
            [
                data.site(mount.base_site).xmat.reshape(3, 3).T
                @ (data.site(mount.payload_site).xpos - data.site(mount.base_site).xpos)
                for mount in self.system.mounts.values()
            ]
        )

    def _states_at(self, deflection: Array) -> Array:
        """Return the internal states after moving straight from the last load step's deflections."""
        states = self.rest_states.copy()
        if self.history == "relaxed":
            return states
        for row, axis, kernel, parameters, first, n_states in self.laws:
            slopes, trial = np.empty(SCRATCH * (n_states + 1)), np.empty(n_states + 1)
            x0, x1 = self.rest_deflection[row, axis], deflection[row, axis]
            advance(kernel, parameters, 0, x0, x1, states, first, n_states, slopes, trial)
        for row, coupled, first in self.planes:
            line, length = coupled.line_parameters(self.rest_deflection[row, :2], deflection[row, :2])
            advance(BIAXIAL, line, 0, 0.0, length, states, first, 2, np.empty(21), np.empty(3))
        return states

    def _result(self, qpos: Array, residual: float) -> Equilibrium:
        model, data, assembly = self.model, self.data, self.system.assembly
        self._accelerations(qpos)
        first = assembly.userdata + assembly.tables.user.mounts
        n_mounts = len(self.system.mounts)
        record = data.userdata[first : first + at.MOUNT_VALUES * n_mounts].reshape(n_mounts, 2, 3).copy()
        mounts = {
            name: MountLoad(deflection=d, force=f) for name, (d, f) in zip(self.system.mounts, record, strict=True)
        }
        size = mujoco.mj_stateSize(model, mujoco.mjtState.mjSTATE_INTEGRATION)
        values = np.empty(size)
        mujoco.mj_getState(model, data, values, mujoco.mjtState.mjSTATE_INTEGRATION)
        return Equilibrium(state=State(values=values, time=0.0), mounts=mounts, history=self.history, residual=residual)

    def _diagnosis(self, load: float, residual: float) -> str:
        """Return words for why the weight cannot be carried; `load` is the share of it that failed."""
        carried = self._axial_forces() / max(load, SMALLEST_LOAD_STEP)  # what would rest on each under the whole weight
        for (name, mount), axial in zip(self.system.mounts.items(), carried, strict=True):
            law = mount.isolator.axes["axial"]
            if law is None or law.largest_force == np.inf:
                continue
            if self.history == "relaxed":
                return (
                    f"there is no relaxed equilibrium: the axial law of mount {name!r} has no elastic part, so that with "
                    "z = 0 it carries nothing. Use a law with an elastic part."
                )
            if abs(axial) > law.largest_force:
                return (
                    f"there is no equilibrium: mount {name!r} carries at most {law.largest_force:.4g} N along its axis (its "
                    f"law has no elastic part), but about {abs(axial):.4g} N would rest on it. Use a stiffer isolator, more "
                    "mounts, or a law with an elastic part."
                )
        return (
            f"no equilibrium was found beyond {100 * load:.3g} % of the weight (accelerations of {residual:.3g} m/s^2 are "
            "left). Check that every direction has a mount with stiffness, and that the payload cannot tip over."
        )

    def _axial_forces(self) -> Array:
        first = self.system.assembly.userdata + self.system.assembly.tables.user.mounts
        n_mounts = len(self.system.mounts)
        return self.data.userdata[first : first + at.MOUNT_VALUES * n_mounts].reshape(n_mounts, 2, 3)[:, 1, 2]
