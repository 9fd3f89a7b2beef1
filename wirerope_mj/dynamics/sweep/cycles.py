"""Stepping a system through cycles of its excitation: the extremes of each cycle, and settling under a steady sine."""

from collections.abc import Iterator
from contextlib import ExitStack, contextmanager
from dataclasses import dataclass

import mujoco
import numpy as np

from wirerope_mj.dynamics.sweep.envelope import Channels, require_lawful
from wirerope_mj.engine.control import installed
from wirerope_mj.engine.control import layout as at
from wirerope_mj.engine.kernel import layout as kernel
from wirerope_mj.engine.kernel.observe import HISTORY, TIME_1, TIME_2, TURN
from wirerope_mj.engine.kernel.steps import NO_SAMPLES, advance_cycles
from wirerope_mj.engine.kernel.variants import group_of
from wirerope_mj.engine.simulation.engines import equations, failure, unsupported_run
from wirerope_mj.engine.simulation.grid import Grid, divide_intervals
from wirerope_mj.engine.simulation.in_lanes import final_state, moving_indices
from wirerope_mj.engine.simulation.stages import StageTables, drive_of
from wirerope_mj.engine.simulation.stepper import Stepper, base_before, moving_with_base
from wirerope_mj.engine.system import System
from wirerope_mj.foundation.arrays import Array, Integers
from wirerope_mj.foundation.errors import SimulationError
from wirerope_mj.foundation.state import State
from wirerope_mj.motions import Sine, Sweep


class ByMujoco:
    """A copy of a system that MuJoCo steps through cycles, with its callbacks installed."""

    def __init__(self, system: System, motion: Sine | Sweep, start: State) -> None:
        self.stepper = Stepper(system, motion, start)
        self._tables = StageTables(motion, drive_of(system))
        self._memory = system.assembly.tables.user.channel_rows(self.stepper.user)  # a view: the tracker writes it

    def remember(self, times: Array, before: Array, last: Array) -> None:
        """Continue after an instant that was observed as the last of a cycle.

        `times` are those of the last two steps, the later one first [s], `before` and `last` the vectors of all channels then,
        (n_channels, 3).
        """
        user = self.stepper.user
        user[at.TIME_1], user[at.TIME_2] = times
        user[at.HISTORY], user[at.OBSERVING] = 2.0, 0.0
        self._memory[:, at.BEFORE : at.BEFORE + 3], self._memory[:, at.LAST : at.LAST + 3] = before, last
        self._clear_extremes()

    def step_cycles(self, grid: Grid, ends: Integers, minimum: Array, maximum: Array) -> bool:
        """Step through cycles whose last intervals are `ends`, (n,), and write their extremes, (n, n_channels, 3) each."""
        stepper = self.stepper
        stepper.enter(grid)
        cycle, user = 0, stepper.user
        for base in self._tables.segments(grid):
            stepper.begin(base)
            steps = int(grid.steps[base.number])
            if not user[at.OBSERVING]:  # this instant was observed as the last of the cycle before
                mujoco.mj_step(stepper.model, stepper.data)
                user[at.OBSERVING], steps = 1.0, steps - 1
            mujoco.mj_step(stepper.model, stepper.data, nstep=steps)
            if base.number == ends[cycle]:
                mujoco.mj_forward(stepper.model, stepper.data)
                minimum[cycle] = self._memory[:, at.LOW : at.LOW + 3]
                maximum[cycle] = self._memory[:, at.HIGH : at.HIGH + 3]
                self._clear_extremes()
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

    def _clear_extremes(self) -> None:
        self._memory[:, at.LOW : at.LOW + 3], self._memory[:, at.HIGH : at.HIGH + 3] = np.inf, -np.inf


class ByKernel:
    """A system that the kernel steps through cycles, as far as it can.

    The kernel tracks no channel that is fixed to the base: for these the base's acceleration is tracked, as the last row.
    """

    def __init__(self, system: System, motion: Sine | Sweep, start: State) -> None:
        tables = system.assembly.tables
        self._system, self._motion, self._start = system, motion, start
        self.time = start.time  # end of the last cycles without failure [s]
        self._tables = StageTables(motion, drive_of(system))
        self._group = group_of([equations(system)], start.values[moving_indices(system)][np.newaxis], [0])
        self._base = np.zeros(at.CHANNEL_MEMORY)
        n = tables.tracked.size
        self._rows = np.full(tables.channels.size, n)  # row of every channel in the extremes; n: the base's
        self._rows[tables.tracked] = np.arange(n)
        self._before = self._snapshot()

    def step_cycles(self, grid: Grid, ends: Integers, minimum: Array, maximum: Array) -> bool:
        """Step through cycles whose last intervals are `ends`, (n,), and write their extremes, (n, n_channels, 3) each.

        Returns whether the kernel did not fail; if it did, `handed_over` continues before the first of these cycles.
        """
        group, e = self._group, self._group.equations
        self._before = self._snapshot()
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
        """Make the copy by MuJoCo that continues from the end of the last cycles without failure."""
        states, clock, recent, base = self._before
        successor = ByMujoco(self._system, self._motion, final_state(self._system, self._start, states, self.time))
        if clock[HISTORY]:
            turn = int(clock[TURN])
            vectors = recent.reshape(-1, 3, 4)[..., :3].transpose(1, 0, 2)
            before, last = (
                np.concatenate([vectors[(turn + step) % 3], [base[first : first + 3]]])[self._rows]
                for step, first in ((1, at.BEFORE), (2, at.LAST))
            )
            successor.remember(clock[[TIME_1, TIME_2]], before, last)
        return successor

    def check(self) -> None:
        """Do nothing: cycles that fail are handed over to MuJoCo."""

    def finish(self) -> State:
        positions, rates = base_before(self._motion, drive_of(self._system), self.time)
        at_end = (positions[np.newaxis, np.newaxis], rates[np.newaxis, np.newaxis])
        self._group.finish(self.time, *at_end, np.zeros((1, 1, 3)), NO_SAMPLES)
        return final_state(self._system, self._start, self._group.states[:, 0], self.time)

    def _snapshot(self) -> tuple[Array, Array, Array, Array]:
        """Copy the state, the clock, the recent vectors of all channels and the extremes of the base's acceleration."""
        group, lay = self._group, self._group.equations.lay
        recent = group.memory[lay[kernel.RECENT] : lay[kernel.RECENT] + kernel.RECENT_SIZE * lay[kernel.N_CHANNELS], 0]
        return group.states[:, 0].copy(), group.clock.copy(), recent.copy(), self._base.copy()


# Fewest steps in a cycle: the parabola through three of them finds the crest of a sine within 1e-5, of its third harmonic
# within 1e-3.
STEPS_PER_CYCLE = 40
FEWEST = 16  # least cycles for a check of settling: four in each quarter
LOOK_EVERY = 4  # settling is checked whenever the number of cycles has grown by 1 / LOOK_EVERY
# Successive checks that must agree: a slow beat may be stationary at one of them. Of 1500 transients with decays of 1e-3 to 1
# per cycle and beats of every length 0.6 % were still taken for settled too early, those that turn once within a decay and
# begin at a stationary point; the wait was 1.7 times the shortest possible.
IN_A_ROW = 2
SMALL = 1e-3  # amplitudes smaller than this fraction of the largest are judged relative to that fraction
# Largest number of quarters that a decay is extrapolated over. Steady amplitudes repeat within some 1e-12: at most 1e-6 then.
SLOWEST = 1e6


@dataclass(frozen=True, kw_only=True)
class Extremes:
    """Minimum and maximum of every tracked vector's components in every cycle, (n_cycles, n_channels, 3)."""

    minimum: Array
    maximum: Array

    @property
    def largest(self) -> Array:
        """Largest absolute values, (n_cycles, n_channels, 3)."""
        return np.maximum(self.maximum, -self.minimum)


class Cycles:
    """A system that is stepped through the cycles of its excitation, by the kernel or MuJoCo; made by `stepping`.

    The peak tracker of the simulation is read and emptied after every cycle: it sees every step and refines an extreme by the
    parabola through three of them, so that a cycle costs memory for its extremes alone. An extreme in the last half step of a
    cycle is found by the first step of the next and belongs to it.
    """

    def __init__(self, system: System, motion: Sine | Sweep, start: State, timestep: float, engines: ExitStack) -> None:
        self.steps, self.largest_step = 0, 0.0  # number of steps so far, and the largest of them [s]
        self._motion, self._timestep, self._engines = motion, timestep, engines
        self._system, self._mounts = system, Channels.of(system).mounts
        self._n_channels = system.assembly.tables.channels.size
        self.why = unsupported_run(system, motion)  # reason why MuJoCo steps, "" as long as the kernel does
        self._engine = self._with_callbacks(ByMujoco(system, motion, start)) if self.why else ByKernel(system, motion, start)

    def run(self, instants: Array) -> Extremes:
        """Step through the cycles that begin and end at `instants` [s], (n + 1,), and return their extremes.

        Raises:
            SimulationError: a mount went beyond the finite travel of its law, or the engine reported that the state is not
                valid any more; says at which frequency.
        """
        grid, ends = cycle_grid(instants, self._timestep)
        minimum, maximum = np.empty((2, ends.size, self._n_channels, 3))
        if not self._engine.step_cycles(grid, ends, minimum, maximum) and isinstance(self._engine, ByKernel):
            self.why = self._engine.failure
            self._engine = self._with_callbacks(self._engine.handed_over())
            self._engine.step_cycles(grid, ends, minimum, maximum)
        frequencies = frequencies_at(self._motion, (instants[:-1] + instants[1:]) / 2.0)
        require_lawful(self._system, frequencies, minimum[:, self._mounts], maximum[:, self._mounts])
        try:
            self._engine.check()
        except SimulationError as error:
            frequency = frequencies_at(self._motion, np.array([self._engine.time]))[0]
            raise SimulationError(f"at {frequency:.5g} Hz: {error}") from None
        self.steps += int(grid.steps.sum())
        self.largest_step = max(self.largest_step, grid.largest_step)
        return Extremes(minimum=minimum, maximum=maximum)

    def finish(self) -> State:
        return self._engine.finish()

    def _with_callbacks(self, engine: ByMujoco) -> ByMujoco:
        self._engines.enter_context(installed(engine.stepper.model, engine.stepper.data))
        return engine


@contextmanager
def stepping(system: System, motion: Sine | Sweep, start: State, timestep: float) -> Iterator[Cycles]:
    """Prepare for the cycles of `motion` from a state at its start, in steps of at most `timestep` [s]."""
    with ExitStack() as engines:
        yield Cycles(system, motion, start, timestep, engines)


def cycle_grid(instants: Array, timestep: float) -> tuple[Grid, Integers]:
    """Divide cycles that begin and end at `instants` [s], (n + 1,), into a grid, and number their last intervals, (n,).

    Each cycle is cut into equal steps of at most `timestep` [s], at least `STEPS_PER_CYCLE`.
    """
    start, stop, steps, cycle = divide_intervals(instants, timestep, least=STEPS_PER_CYCLE)
    never, smooth = np.zeros(cycle.size, dtype=bool), np.full(cycle.size, at.SMOOTH)
    grid = Grid(start=start, stop=stop, steps=steps, sampled=never, event=smooth, corner_after=never)
    return grid, np.flatnonzero(np.diff(cycle, append=-1))


def at_start(system: System, motion: Sine | Sweep, state: State) -> State:
    """Put `state` at the instant 0, its base moving as `motion` begins and the whole system carried along."""
    values = state.values.copy()
    values[0] = 0.0  # the time comes first in MuJoCo's integration state
    return moving_with_base(system, motion, State(values=values, time=0.0))


def frequencies_at(motion: Sine | Sweep, times: Array) -> Array:
    return np.full(times.size, motion.frequency) if isinstance(motion, Sine) else motion.frequency(times)


@dataclass(frozen=True, kw_only=True)
class Steady:
    """Response of a system after many cycles of a sine: extremes, state, and whether it has settled."""

    # extremes of every channel in the last cycle, or in the last quarter of them if it has not settled, (n_channels, 3)
    minimum: Array
    maximum: Array
    state: State  # at the end of the last cycle
    cycles: int
    steps: int
    largest_step: float  # of all steps [s]
    # estimated distance of the amplitudes from their limits, relative to them; `settled` if it is within the tolerance
    remaining: float
    settled: bool


def settle(system: System, motion: Sine, start: State, *, timestep: float, settled: float, largest_cycles: int) -> Steady:
    """Step a system under a sine until bodies' amplitudes are within `settled` of steady values, or for `largest_cycles`."""
    bodies = Channels.of(system).bodies
    chunks: list[Extremes] = []
    cycles, agreeing, remaining = 0, 0, np.inf  # agreeing: successive checks that found the amplitudes settled
    with stepping(system, motion, at_start(system, motion, start), timestep) as stepped:
        while agreeing < IN_A_ROW and cycles < largest_cycles:
            more = min(cycles // LOOK_EVERY if cycles else FEWEST, largest_cycles - cycles)
            chunks.append(stepped.run(np.arange(cycles, cycles + more + 1) / motion.frequency))
            cycles += more
            amplitudes = np.concatenate([chunk.largest[:, bodies] for chunk in chunks])
            remaining = distance_to_limit(amplitudes.reshape(cycles, -1))
            agreeing = agreeing + 1 if remaining <= settled else 0
        state = stepped.finish()
    done = agreeing == IN_A_ROW
    judged = 1 if done else max(cycles // 4, 1)
    return Steady(
        minimum=np.concatenate([chunk.minimum for chunk in chunks])[-judged:].min(axis=0),
        maximum=np.concatenate([chunk.maximum for chunk in chunks])[-judged:].max(axis=0),
        state=state, cycles=cycles, steps=stepped.steps, largest_step=stepped.largest_step, remaining=remaining, settled=done,
    )  # fmt: skip


def distance_to_limit(amplitudes: Array) -> float:
    """Estimate how far the amplitudes of successive cycles, (n, m), are from their steady values, the largest, relative.

    The cycles are cut into quarters, and the first, in which transients mix, is left out. If the means of the other three
    change by d1 and then by d2, an exponential through them is d2 r / (1 - r) from its limit, r = d2 / d1, however small d2
    is. The beat about the mean in the last quarter counts, too. Infinite with fewer than `FEWEST` cycles.
    """
    block = amplitudes.shape[0] // 4
    if 4 * block < FEWEST:
        return np.inf
    quarters = amplitudes[-3 * block :].reshape(3, block, -1)
    means = quarters.mean(axis=1)
    scale = np.maximum(means[2], SMALL * means[2].max())
    first, second = np.abs(np.diff(means, axis=0))
    tail = np.minimum(second, first) / np.maximum(first - second, first / SLOWEST + 1e-300)  # r / (1 - r)
    tail = np.where(second >= first, SLOWEST, np.minimum(tail, SLOWEST))
    beat = 0.5 * np.ptp(quarters[2], axis=0)
    distance = np.maximum(second * tail, beat)
    return float(np.max(np.where(distance > 0.0, distance, 0.0) / np.where(scale > 0.0, scale, 1.0)))
