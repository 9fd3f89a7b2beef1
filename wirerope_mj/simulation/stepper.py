"""A system on its way through a time grid: what is prepared for every piece, and what MuJoCo's warnings mean."""

import copy

import mujoco
import numpy as np
import numpy.typing as npt

from wirerope_mj.control import layout as at
from wirerope_mj.errors import SimulationError
from wirerope_mj.excitation import BaseMotion
from wirerope_mj.simulation.grid import SAME_TIME, Grid
from wirerope_mj.state import State
from wirerope_mj.system import System

Array = npt.NDArray[np.float64]

STATE = mujoco.mjtState.mjSTATE_INTEGRATION


class Stepper:
    """A copy of a system's model with its data, taken from piece to piece of a grid."""

    def __init__(self, system: System, motion: BaseMotion, grid: Grid, initial: State) -> None:
        self.system, self.motion, self.grid = system, motion, grid
        self.model, self.data = copy.copy(system.model), mujoco.MjData(system.model)
        mujoco.mj_setState(self.model, self.data, initial.values, STATE)
        assembly = system.assembly
        self.user = self.data.userdata[assembly.userdata : assembly.userdata + assembly.tables.user.size]
        self.user[at.OBSERVING], self.user[at.HISTORY], self.user[at.EVENT] = 1.0, 0.0, at.SMOOTH
        self._jumps = [(time, assembly.tables.drive @ jump) for time, jump in motion.velocity_jumps]
        self._since_check: list[tuple[int, Array]] = []
        self._checked = _integration_state(self.model, self.data)

    def begin(self, piece: int, accelerations: Array) -> None:
        """Prepare the steps of a piece, whose base accelerations at the half steps are given."""
        self._since_check.append((piece, accelerations))
        grid, user, data = self.grid, self.user, self.data
        start, length = grid.start[piece], grid.stop[piece] - grid.start[piece]
        if grid.event[piece] == at.JUMP:
            for time, jump in self._jumps:
                if abs(time - start) <= SAME_TIME:
                    data.qvel[self.system.assembly.driven_dofs] += jump
        user[at.EVENT] = grid.event[piece]
        user[at.STAGE_POINTS], user[at.STAGE_START] = accelerations.shape[0], start
        user[at.STAGE_RATE] = 2.0 * grid.steps[piece] / length
        user[at.STAGES : at.STAGES + accelerations.size] = accelerations.ravel()
        data.time = start  # so that rounding does not add up over the steps
        self.model.opt.timestep = length / grid.steps[piece]

    def finish(self) -> State:
        """Return the final state, and observe the last instant with the acceleration just before it."""
        self.check()
        model, data, user = self.model, self.data, self.user
        if self.grid.stop.size:
            data.time = self.grid.stop[-1]
        # A state does not carry what belongs to this run alone: stage table and tracker.
        kept = user[: at.STAGES + 3 * (2 * at.MAX_STEPS + 1)].copy()
        user[: kept.size] = 0.0
        final = State(values=_integration_state(model, data), time=float(data.time))
        user[: kept.size] = kept
        user[at.STAGE_POINTS], user[at.STAGE_START], user[at.STAGE_RATE] = 1.0, data.time, 0.0
        user[at.STAGES : at.STAGES + 3] = self.motion.acceleration(np.array([max(data.time - SAME_TIME, 0.0)]))[0]
        mujoco.mj_forward(model, data)
        return final

    def check(self) -> None:
        """Raise SimulationError if one of MuJoCo's warning counters rose since the last check."""
        if not any(warning.number for warning in self.data.warning):
            self._since_check.clear()
            self._checked = _integration_state(self.model, self.data)
            return
        pieces = self._since_check.copy()
        # Once a number is not finite all are: only a second look, step by step, shows where it began.
        mujoco.mj_resetData(self.model, self.data)
        mujoco.mj_setState(self.model, self.data, self._checked, STATE)
        for piece, accelerations in pieces:
            self.begin(piece, accelerations)
            for _ in range(int(self.grid.steps[piece])):
                mujoco.mj_step(self.model, self.data)
                for kind, warning in enumerate(self.data.warning):
                    if warning.number:
                        raise SimulationError(self._words(mujoco.mjtWarning(kind).name))
        raise SimulationError("MuJoCo reported a warning in the last forward pass; use a smaller `timestep`.")

    def _words(self, warning: str) -> str:
        remedy = _REMEDIES.get(warning, "see MuJoCo's documentation of this warning")
        acceleration = np.nan_to_num(np.abs(self.data.qacc), nan=np.inf, posinf=np.inf)
        body = self.model.body(self.model.dof_bodyid[int(np.argmax(acceleration))]).name
        return f"at t = {self.data.time:.6g} s MuJoCo reported {warning.removeprefix('mjWARN_')} for body {body!r}: {remedy}."


def _integration_state(model: mujoco.MjModel, data: mujoco.MjData) -> Array:
    values = np.empty(mujoco.mj_stateSize(model, STATE))
    mujoco.mj_getState(model, data, values, STATE)
    return values


_GREW = "the motion grew without bound; use a smaller `timestep`, and check masses, stops and mount loads"
_REMEDIES = {
    "mjWARN_BADQACC": _GREW,
    "mjWARN_BADQPOS": _GREW,
    "mjWARN_BADQVEL": _GREW,
    "mjWARN_BADCTRL": "a control is not finite or above 1e10; check what writes `ctrl`",
    "mjWARN_CNSTRFULL": "there are more contacts than memory; raise <size memory=...> in the model",
    "mjWARN_CONTACTFULL": "there are more contacts than memory; raise <size memory=...> in the model",
    "mjWARN_INERTIA": "a mass or inertia is close to zero; check the model's masses",
}
