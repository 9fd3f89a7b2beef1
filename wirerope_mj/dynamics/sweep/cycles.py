"""Stepping a system through complete cycles of its excitation, keeping nothing but the extremes of every cycle."""

from collections.abc import Iterator
from contextlib import ExitStack, contextmanager
from dataclasses import dataclass

import numpy as np
import numpy.typing as npt

from wirerope_mj.dynamics.sweep.by_kernel import ByKernel
from wirerope_mj.dynamics.sweep.by_mujoco import ByMujoco
from wirerope_mj.dynamics.sweep.channels import Channels
from wirerope_mj.dynamics.sweep.travel import Lawful
from wirerope_mj.engine.control import installed
from wirerope_mj.engine.control import layout as at
from wirerope_mj.engine.simulation.engines import unsupported_motion, unsupported_system
from wirerope_mj.engine.simulation.grid import Grid
from wirerope_mj.engine.simulation.stepper import moving_with_base
from wirerope_mj.engine.system import System
from wirerope_mj.foundation.arrays import Array
from wirerope_mj.foundation.errors import SimulationError
from wirerope_mj.foundation.state import State
from wirerope_mj.motions import Sine, Sweep

STEPS_PER_CYCLE = 40
"""Fewest steps in a cycle: the parabola through three of them meets the crest of a sine within 1e-5, of its third harmonic
within 1e-3."""


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

    Attributes:
        steps: number of steps so far.
        largest_step: largest of them [s].
        why: why it is not the kernel that steps, "" as long as it is.
    """

    def __init__(self, system: System, motion: Sine | Sweep, start: State, timestep: float, engines: ExitStack) -> None:
        self.steps, self.largest_step = 0, 0.0
        self._motion, self._timestep, self._engines = motion, timestep, engines
        self._lawful, self._mounts = Lawful(system), Channels.of(system).mounts
        self._n_channels = system.assembly.tables.channels.size
        self.why = unsupported_system(system) or unsupported_motion(system, motion)
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
        self._check()
        self.steps += int(grid.steps.sum())
        self.largest_step = max(self.largest_step, grid.largest_step)
        return Extremes(minimum=minimum, maximum=maximum)

    def finish(self) -> State:
        """Return the state at the end of the last cycle."""
        return self._by.finish()

    def _stepped(self, by: ByMujoco) -> ByMujoco:
        """Return MuJoCo's stepping with its callbacks installed."""
        self._engines.enter_context(installed(by.stepper.model, by.stepper.data))
        return by

    def _check(self) -> None:
        try:
            self._by.check()
        except SimulationError as error:
            frequency = frequencies_at(self._motion, np.array([self._by.time]))[0]
            raise SimulationError(f"at {frequency:.5g} Hz: {error}") from None


@contextmanager
def stepping(system: System, motion: Sine | Sweep, start: State, timestep: float) -> Iterator[Cycles]:
    """Prepare for the cycles of `motion` from a state at its start, in steps of at most `timestep` [s]."""
    with ExitStack() as engines:
        yield Cycles(system, motion, start, timestep, engines)


def cycle_grid(instants: Array, timestep: float) -> tuple[Grid, npt.NDArray[np.int64]]:
    """Return a grid of cycles that begin and end at `instants` [s], (n + 1,), and the numbers of their last intervals, (n,).

    Each cycle is cut into equal steps of at most `timestep` [s], at least `STEPS_PER_CYCLE`.
    """
    length = np.diff(instants)
    steps = np.maximum(np.ceil(length / timestep * (1.0 - 1e-9)), STEPS_PER_CYCLE).astype(np.int64)
    intervals = -(-steps // at.MAX_STEPS)
    steps = -(-steps // intervals)
    ends = np.cumsum(intervals)
    cycle = np.repeat(np.arange(length.size), intervals)
    number = np.arange(cycle.size) - (ends - intervals)[cycle]
    start = instants[cycle] + length[cycle] * (number / intervals[cycle])
    grid = Grid(
        start=start,
        stop=np.append(start[1:], instants[1:][-1:]),
        steps=steps[cycle],
        sampled=np.zeros(cycle.size, dtype=bool),
        event=np.full(cycle.size, at.SMOOTH),
        corner_after=np.zeros(cycle.size, dtype=bool),
    )
    return grid, ends - 1


def at_start(system: System, motion: Sine | Sweep, state: State) -> State:
    """Return `state` at the instant 0, its base moving as `motion` begins and the whole system carried along."""
    values = state.values.copy()
    values[0] = 0.0  # the time comes first in MuJoCo's integration state
    return moving_with_base(system, motion, State(values=values, time=0.0))


def frequencies_at(motion: Sine | Sweep, times: Array) -> Array:
    """Return the frequencies of the excitation at instants [s], (n,), in Hz."""
    return np.full(times.size, motion.frequency) if isinstance(motion, Sine) else motion.frequency(times)
