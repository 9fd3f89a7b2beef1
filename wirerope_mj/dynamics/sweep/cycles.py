"""Stepping a system through cycles of its excitation, keeping the extremes of each, also until a sine's response is steady."""

from collections.abc import Iterator
from contextlib import ExitStack, contextmanager
from dataclasses import dataclass

import numpy as np

from wirerope_mj.dynamics.sweep.channels import Channels, Lawful
from wirerope_mj.dynamics.sweep.engines import ByKernel, ByMujoco
from wirerope_mj.engine.control import installed
from wirerope_mj.engine.control import layout as at
from wirerope_mj.engine.simulation.engines import unsupported_run
from wirerope_mj.engine.simulation.grid import Grid, divided
from wirerope_mj.engine.simulation.stepper import moving_with_base
from wirerope_mj.engine.system import System
from wirerope_mj.foundation.arrays import Array, Integers
from wirerope_mj.foundation.errors import SimulationError
from wirerope_mj.foundation.state import State
from wirerope_mj.motions import Sine, Sweep

# Fewest steps in a cycle: the parabola through three of them meets the crest of a sine within 1e-5, of its third harmonic
# within 1e-3.
STEPS_PER_CYCLE = 40
FEWEST = 16  # cycles before which nothing is judged: four in each quarter
LOOK_EVERY = 4  # a look is taken whenever the cycles have grown by one part in this
# Looks that must agree: a slow beat may stand still at one of them. Of 1500 transients with decays of 1e-3 to 1 per cycle and
# beats of every length 0.6 % were still taken for settled too early, those that turn once within a decay and begin where they
# stand still; the wait was 1.7 times the shortest possible.
IN_A_ROW = 2
SMALL = 1e-3  # amplitudes smaller than this fraction of the largest are judged relative to that fraction
# Blocks that a decay may still take. Steady amplitudes repeat within some 1e-12, which is then at most 1e-6.
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
    """A copy of a system that is stepped through the cycles of its excitation; made by `stepping`.

    The peak tracker of the simulation is read and emptied after every cycle: it sees every step and refines an extreme by the
    parabola through three of them, so that a cycle costs memory for its extremes alone. An extreme in the last half step of a
    cycle is found by the first step of the next and belongs to it.
    """

    def __init__(self, system: System, motion: Sine | Sweep, start: State, timestep: float, engines: ExitStack) -> None:
        self.steps, self.largest_step = 0, 0.0  # so far [1, s]
        self._motion, self._timestep, self._engines = motion, timestep, engines
        self._lawful, self._mounts = Lawful(system), Channels.of(system).mounts
        self._n_channels = system.assembly.tables.channels.size
        self.why = unsupported_run(system, motion)  # why it is not the kernel that steps, "" as long as it is
        self._by = self._stepped(ByMujoco(system, motion, start)) if self.why else ByKernel(system, motion, start)

    def run(self, instants: Array) -> Extremes:
        """Step through the cycles that begin and end at `instants` [s], (n + 1,), and return their extremes.

        Raises:
            SimulationError: a mount went beyond the finite travel of its law, or the engine reported that the state is not
                valid any more; says at which frequency.
        """
        grid, ends = cycle_grid(instants, self._timestep)
        minimum, maximum = np.empty((2, ends.size, self._n_channels, 3))
        if not self._by.go(grid, ends, minimum, maximum) and isinstance(self._by, ByKernel):
            self.why = self._by.failure
            self._by = self._stepped(self._by.handed_over())
            self._by.go(grid, ends, minimum, maximum)
        frequencies = frequencies_at(self._motion, (instants[:-1] + instants[1:]) / 2.0)
        self._lawful.require(frequencies, minimum[:, self._mounts], maximum[:, self._mounts])
        try:
            self._by.check()
        except SimulationError as error:
            frequency = frequencies_at(self._motion, np.array([self._by.time]))[0]
            raise SimulationError(f"at {frequency:.5g} Hz: {error}") from None
        self.steps += int(grid.steps.sum())
        self.largest_step = max(self.largest_step, grid.largest_step)
        return Extremes(minimum=minimum, maximum=maximum)

    def finish(self) -> State:
        return self._by.finish()

    def _stepped(self, by: ByMujoco) -> ByMujoco:
        """Install MuJoCo's callbacks for as long as it steps."""
        self._engines.enter_context(installed(by.stepper.model, by.stepper.data))
        return by


@contextmanager
def stepping(system: System, motion: Sine | Sweep, start: State, timestep: float) -> Iterator[Cycles]:
    """Prepare for the cycles of `motion` from a state at its start, in steps of at most `timestep` [s]."""
    with ExitStack() as engines:
        yield Cycles(system, motion, start, timestep, engines)


def cycle_grid(instants: Array, timestep: float) -> tuple[Grid, Integers]:
    """Divide cycles that begin and end at `instants` [s], (n + 1,), into a grid, and number their last intervals, (n,).

    Each cycle is cut into equal steps of at most `timestep` [s], at least `STEPS_PER_CYCLE`.
    """
    start, stop, steps, cycle = divided(instants, timestep, least=STEPS_PER_CYCLE)
    none, smooth = np.zeros(cycle.size, dtype=bool), np.full(cycle.size, at.SMOOTH)
    grid = Grid(start=start, stop=stop, steps=steps, sampled=none, event=smooth, corner_after=none)
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
    """Motion of a system after many cycles of a sine."""

    # extremes of every channel in the last cycle, or in the last quarter of them if it has not settled, (n_channels, 3)
    minimum: Array
    maximum: Array
    state: State  # at the end of the last cycle
    cycles: int
    steps: int
    largest_step: float  # of all steps [s]
    # estimated distance of the amplitudes from their limits, relative to them; `settled` if that is small enough
    remaining: float
    settled: bool


def settle(system: System, motion: Sine, start: State, *, timestep: float, settled: float, largest_cycles: int) -> Steady:
    """Shake a system by a sine until the amplitudes of all bodies are within `settled` of their limits, or `largest_cycles`."""
    bodies = Channels.of(system).bodies
    chunks: list[Extremes] = []
    cycles, agreeing, remaining = 0, 0, np.inf
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
    """Estimate how far the amplitudes of successive cycles, (n, m), are from their limits: the largest relative distance.

    The cycles are cut into quarters, and the first, in which transients mix, is left out. If the means of the other three
    change by d1 and then by d2, an exponential that passes through them has d2 r / (1 - r) left to go, r = d2 / d1, however
    small d2 is. What beats about the mean in the last quarter is left too. Infinite with fewer than `FEWEST` cycles.
    """
    block = amplitudes.shape[0] // 4
    if 4 * block < FEWEST:
        return np.inf
    quarters = amplitudes[-3 * block :].reshape(3, block, -1)
    means = quarters.mean(axis=1)
    scale = np.maximum(means[2], SMALL * means[2].max())
    first, second = np.abs(np.diff(means, axis=0))
    going = np.minimum(second, first) / np.maximum(first - second, first / SLOWEST + 1e-300)  # r / (1 - r)
    going = np.where(second >= first, SLOWEST, np.minimum(going, SLOWEST))
    beating = 0.5 * np.ptp(quarters[2], axis=0)
    left = np.maximum(second * going, beating)
    return float(np.max(np.where(left > 0.0, left, 0.0) / np.where(scale > 0.0, scale, 1.0)))
