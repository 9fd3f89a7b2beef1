"""Cycles of an excitation stepped by the kernel, many in one call, or by MuJoCo."""

import mujoco
import numpy as np

from wirerope_mj.engine.control import layout as at
from wirerope_mj.engine.kernel import layout as kernel
from wirerope_mj.engine.kernel.observe import HISTORY, TIME_1, TIME_2, TURN
from wirerope_mj.engine.kernel.steps import NO_SAMPLES, advance_cycles
from wirerope_mj.engine.kernel.variants import group_of
from wirerope_mj.engine.simulation.engines import equations, failure
from wirerope_mj.engine.simulation.grid import Grid
from wirerope_mj.engine.simulation.in_lanes import final_state, moving
from wirerope_mj.engine.simulation.stages import StageTables
from wirerope_mj.engine.simulation.stepper import Stepper, base_before
from wirerope_mj.engine.system import System
from wirerope_mj.foundation.arrays import Array, Integers
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

    def go(self, grid: Grid, ends: Integers, minimum: Array, maximum: Array) -> bool:
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
        return float(self.stepper.data.time)

    def check(self) -> None:
        self.stepper.check()

    def finish(self) -> State:
        return self.stepper.finish()

    def _forget(self) -> None:
        self._memory[:, at.LOW : at.LOW + 3], self._memory[:, at.HIGH : at.HIGH + 3] = np.inf, -np.inf


class ByKernel:
    """A system that the kernel steps through cycles, until it fails.

    The kernel follows no channel that is fixed to the base: its acceleration is followed beside them.
    """

    def __init__(self, system: System, motion: Sine | Sweep, start: State) -> None:
        tables = system.assembly.tables
        self._system, self._motion, self._start = system, motion, start
        self.time = start.time  # end of the last cycles that went well [s]
        self._tables = StageTables(motion, tables.drive)
        self._group = group_of([equations(system)], start.values[moving(system)][np.newaxis], [0])
        self._base = np.zeros(at.CHANNEL_MEMORY)
        n = tables.tracked.size
        self._rows = np.full(tables.channels.size, n)  # of every channel among those that are followed, the base's last
        self._rows[tables.tracked] = np.arange(n)
        self._before = self._moment()

    def go(self, grid: Grid, ends: Integers, minimum: Array, maximum: Array) -> bool:
        """Step through cycles whose last intervals are `ends`, (n,); takes their extremes, (n, n_channels, 3) each.

        Returns whether that went well; if not, `handed_over` goes on before the first of these cycles.
        """
        group, e = self._group, self._group.equations
        self._before = self._moment()
        table = np.array([grid.start, grid.stop, grid.steps])
        closes = np.zeros(grid.start.size, dtype=np.bool_)
        closes[ends] = True
        low, high = np.empty((2, ends.size, e.lay[kernel.N_CHANNELS] + 1, 3))
        cycle = 0
        for stages in self._tables.blocks(grid):
            cut = slice(stages.first, stages.first + stages.ends.size)
            cycle = advance_cycles(
                e.lay, e.fix, group.numbers, group.states, group.memory, group.clock, group.which,
                np.ascontiguousarray(table[:, cut]), stages.positions[np.newaxis], stages.rates[np.newaxis],
                stages.accelerations[np.newaxis], stages.ends, closes[cut], self._base, low, high, cycle, NO_SAMPLES,
            )  # fmt: skip
            if group.failed[0]:
                return False
        self.time = float(grid.stop[-1])
        np.take(low, self._rows, axis=1, out=minimum)
        np.take(high, self._rows, axis=1, out=maximum)
        return True

    @property
    def failure(self) -> str:
        return failure(self._group, 0)

    def handed_over(self) -> ByMujoco:
        """Let MuJoCo go on from where the last cycles that went well ended."""
        states, clock, recent, base = self._before
        taken = ByMujoco(self._system, self._motion, final_state(self._system, self._start, states, self.time))
        if clock[HISTORY]:
            turn = int(clock[TURN])
            vectors = recent.reshape(-1, 3, 4)[..., :3].transpose(1, 0, 2)
            before, last = (
                np.concatenate([vectors[(turn + step) % 3], [base[first : first + 3]]])[self._rows]
                for step, first in ((1, at.BEFORE), (2, at.LAST))
            )
            taken.remember(clock[[TIME_1, TIME_2]], before, last)
        return taken

    def check(self) -> None:
        """Do nothing: what fails is handed over."""

    def finish(self) -> State:
        positions, rates = base_before(self._motion, self._system.assembly.tables.drive, self.time)
        at_end = (positions[np.newaxis, np.newaxis], rates[np.newaxis, np.newaxis])
        self._group.finish(self.time, *at_end, np.zeros((1, 1, 3)), NO_SAMPLES, -1)
        return final_state(self._system, self._start, self._group.states[:, 0], self.time)

    def _moment(self) -> tuple[Array, Array, Array, Array]:
        """Copy the state, the clock, the recent vectors of all channels and the base's memory."""
        group, lay = self._group, self._group.equations.lay
        recent = group.memory[lay[kernel.RECENT] : lay[kernel.RECENT] + kernel.RECENT_SIZE * lay[kernel.N_CHANNELS], 0]
        return group.states[:, 0].copy(), group.clock.copy(), recent.copy(), self._base.copy()
