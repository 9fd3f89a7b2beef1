"""Cycles of an excitation stepped by MuJoCo."""

import mujoco
import numpy as np
import numpy.typing as npt

from wirerope_mj.engine.control import layout as at
from wirerope_mj.engine.simulation.grid import Grid
from wirerope_mj.engine.simulation.stages import StageTables
from wirerope_mj.engine.simulation.stepper import Stepper
from wirerope_mj.engine.system import System
from wirerope_mj.foundation.arrays import Array
from wirerope_mj.foundation.state import State
from wirerope_mj.motions import Sine, Sweep


class ByMujoco:
    """A copy of a system that MuJoCo steps through cycles, with its callbacks installed."""

    def __init__(self, system: System, motion: Sine | Sweep, start: State) -> None:
        self.stepper = Stepper(system, motion, start)
        self._tables = StageTables(motion, system.assembly.tables.drive)
        self._memory = system.assembly.tables.user.channel_rows(self.stepper.user)  # a view: the tracker writes it

    def remember(self, times: Array, before: Array, last: Array) -> None:
        """Go on behind an instant that was seen as the last of a cycle.

        `times` are those of the last two steps, the later one first [s], `before` and `last` the vectors of all channels in the
        earlier and in the later, (n_channels, 3).
        """
        user = self.stepper.user
        user[at.TIME_1], user[at.TIME_2] = times
        user[at.HISTORY], user[at.OBSERVING] = 2.0, 0.0
        self._memory[:, at.BEFORE : at.BEFORE + 3], self._memory[:, at.LAST : at.LAST + 3] = before, last
        self._forget()

    def go(self, grid: Grid, ends: npt.NDArray[np.int64], minimum: Array, maximum: Array) -> bool:
        """Step through cycles whose last intervals are `ends`, (n,); takes their extremes, (n, n_channels, 3) each."""
        stepper = self.stepper
        stepper.enter(grid)
        cycle, user = 0, stepper.user
        for base in self._tables.segments(grid):
            stepper.begin(base)
            steps = int(grid.steps[base.number])
            if not user[at.OBSERVING]:  # this instant was seen as the last of the cycle before
                mujoco.mj_step(stepper.model, stepper.data)
                user[at.OBSERVING], steps = 1.0, steps - 1
            mujoco.mj_step(stepper.model, stepper.data, nstep=steps)
            if base.number == ends[cycle]:
                mujoco.mj_forward(stepper.model, stepper.data)
                minimum[cycle] = self._memory[:, at.LOW : at.LOW + 3]
                maximum[cycle] = self._memory[:, at.HIGH : at.HIGH + 3]
                self._forget()
                user[at.OBSERVING] = 0.0
                cycle += 1
        return True

    @property
    def time(self) -> float:
        """Instant that is reached [s]."""
        return float(self.stepper.data.time)

    def check(self) -> None:
        """Raise SimulationError if MuJoCo reported that the state is not valid any more."""
        self.stepper.check()

    def finish(self) -> State:
        """Return the state at the end of the last cycle."""
        return self.stepper.finish()

    def _forget(self) -> None:
        self._memory[:, at.LOW : at.LOW + 3], self._memory[:, at.HIGH : at.HIGH + 3] = np.inf, -np.inf
