"""Variants side by side, one to a lane: their states and memory, taken through a grid and read at its end."""

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from wirerope_mj.engine.control import layout as control
from wirerope_mj.engine.kernel import layout as at
from wirerope_mj.engine.kernel.equations import Equations, Integers
from wirerope_mj.engine.kernel.observe import CLOCK_SIZE
from wirerope_mj.engine.kernel.steps import advance, finish
from wirerope_mj.foundation.arrays import Array
from wirerope_mj.foundation.lanes import WIDTH

NOTHING = np.zeros((0, 0, 0))  # room for the samples of no variant


@dataclass(frozen=True, kw_only=True)
class Group:
    """Variants that share structure and fixed numbers, one to a lane; lanes that are left over repeat the last variant.

    Attributes:
        equations: of the first variant.
        numbers, states, memory: of all lanes, (n, WIDTH), see `wirerope_mj.engine.kernel.layout`.
        clock: see `wirerope_mj.engine.kernel.observe`.
        which: number of the motion that each lane's base follows, (WIDTH,).
        size: number of variants.
    """

    equations: Equations
    numbers: Array
    states: Array
    memory: Array
    clock: Array
    which: Integers
    size: int

    @property
    def failed(self) -> Array:
        """Why a variant was given up, 0 if it was not, (size,); see `wirerope_mj.engine.kernel.layout`."""
        return self._section(at.FAILED, at.N_WORK)[0, : self.size]

    def channels(self, number: int) -> Array:
        """Return the tracker's memory of one variant, (n_channels, ...), as `wirerope_mj.engine.control.layout` has it."""
        return self._section(at.MEMORY, at.TOUCHED)[:, number].reshape(-1, control.CHANNEL_MEMORY)

    def stops(self, number: int) -> Array:
        """Return the memory of one variant's stops, (n_stops, ...), as `wirerope_mj.engine.control.layout` has it."""
        return self._section(at.TOUCHED, at.TRAVELS)[:, number].reshape(-1, control.CONTACT_MEMORY)

    def travels(self, number: int) -> Array:
        """Return the memory of one variant's travels, (n_mounts, ...), as `wirerope_mj.engine.control.layout` has it."""
        return self._section(at.TRAVELS, at.FAILED)[:, number].reshape(-1, control.TRAVEL_MEMORY)

    def _section(self, first: int, behind: int) -> Array:
        lay = self.equations.lay
        return self.memory[lay[first] : lay[behind]]

    def go(
        self, grid: Array, positions: Array, rates: Array, table: Array, ends: Integers, out: Array, sample: int
    ) -> int:
        """Step through segments, see `wirerope_mj.engine.kernel.steps.advance`; returns the number of samples so far."""
        e = self.equations
        return int(
            advance(
                e.lay, e.fix, self.numbers, self.states, self.memory, self.clock, self.which, grid, positions, rates,
                table, ends, out, sample,
            )
        )  # fmt: skip

    def finish(self, time: float, positions: Array, rates: Array, table: Array, out: Array, sample: int) -> None:
        """Observe the last instant; `sample` is its number, -1 if it is none."""
        e = self.equations
        finish(
            e.lay, e.fix, self.numbers, self.states, self.memory, self.clock, self.which, time, positions, rates, table,
            out, sample,
        )  # fmt: skip


def group_of(equations: Sequence[Equations], states: Array, which: Sequence[int]) -> Group:
    """Return a group of at most WIDTH variants with the states (n, n_states) they start from, and their motions."""
    size = len(equations)
    lanes = np.minimum(np.arange(WIDTH), size - 1)
    first = equations[0]
    memory = np.zeros((int(first.lay[at.N_WORK]), WIDTH))
    memory[first.lay[at.KIN] : first.lay[at.KIN] + first.rest.size] = first.rest[:, np.newaxis]
    return Group(
        equations=first,
        numbers=np.ascontiguousarray(np.array([one.num for one in equations])[lanes].T),
        states=np.ascontiguousarray(states[lanes].T),
        memory=memory,
        clock=np.zeros(CLOCK_SIZE),
        which=np.asarray(which, dtype=np.int64)[lanes],
        size=size,
    )
