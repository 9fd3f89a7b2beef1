"""Many copies of a system through whole periods of its base's sine, by the kernel, one to a lane."""

from collections.abc import Iterator
from contextlib import ExitStack, contextmanager
from dataclasses import replace

import numpy as np

from wirerope_mj.dynamics.periodic.coordinates import Coordinates
from wirerope_mj.dynamics.periodic.flow import Flow
from wirerope_mj.dynamics.periodic.mujoco_flow import MujocoFlow
from wirerope_mj.dynamics.periodic.scaled_states import ScaledStates
from wirerope_mj.dynamics.periodic.smoothing import widths_of
from wirerope_mj.dynamics.periodic.stepping import go, look_around
from wirerope_mj.dynamics.periodic.track import Drive, Track
from wirerope_mj.engine.control.layout import MAX_STEPS
from wirerope_mj.engine.kernel import layout as at
from wirerope_mj.engine.kernel.equations import Equations, Integers
from wirerope_mj.engine.kernel.variants import group_of
from wirerope_mj.engine.simulation.engines import equations, unsupported_system
from wirerope_mj.engine.system import System
from wirerope_mj.foundation.arrays import Array
from wirerope_mj.foundation.lanes import WIDTH

RATE = 6
"""Place of the deflection's rate in a mount's record, behind deflection and force."""


def flow_of(coordinates: Coordinates, system: System) -> Flow:
    """Return a flow of the kernel if it can compute the system, one of MuJoCo else."""
    return MujocoFlow(coordinates, system) if unsupported_system(system) else KernelFlow(coordinates, system)


class KernelFlow(Flow):
    """The map as the kernel steps it; a copy that touches something or comes to a limit is MuJoCo's."""

    def __init__(self, coordinates: Coordinates, system: System) -> None:
        super().__init__(coordinates, system)
        self._equations: Equations = equations(system)
        self._beyond: MujocoFlow | None = None
        self._within = ExitStack()
        self._carried = self._steep(ScaledStates(system))
        self._nowhere = np.zeros((0, coordinates.carried(1.0, 1.0)[coordinates.moving].size))

    @property
    def steps(self) -> int:
        """Model steps taken so far, also by MuJoCo, forward passes counted as quarters."""
        return super().steps + (self._beyond.steps if self._beyond is not None else 0)

    def smooth(self, width: float) -> None:
        """Smooth the laws over a velocity [m/s]."""
        super().smooth(width)
        lay, num = self._equations.lay, self._equations.num.copy()
        axes = lay[lay[at.AXES] :][: 3 * at.AXIS_COLUMNS * lay[at.N_MOUNTS]].reshape(-1, at.AXIS_COLUMNS)
        first = int(lay[at.PARAMETERS])
        num[first + widths_of(axes[:, :2], num[first:])] = width
        self._equations = replace(self._equations, num=num)
        if self._beyond is not None:
            self._beyond.smooth(width)

    @contextmanager
    def ready(self) -> Iterator[None]:
        """Let MuJoCo take over within, should it have to."""
        with self._within:
            if self._beyond is not None:
                self._within.enter_context(self._beyond.ready())
            yield

    def ends(self, starts: Array, drive: Drive) -> Array:
        """Return the unknowns at the end of each copy's periods, (n, n_x)."""
        ends, why = np.empty_like(starts), np.empty(len(starts))
        for first in range(0, len(starts), WIDTH):
            own = slice(first, first + WIDTH)
            ends[own], why[own] = self._go(starts[own], drive, self._nowhere, self._nowhere)
        beyond = why > at.WILD
        if beyond.any():
            ends[beyond] = self._by_mujoco().ends(starts[beyond], drive)
        return ends

    def follow(self, start: Array, drive: Drive) -> Track:
        """Return the track of one copy from `start`, (n_x,)."""
        values = np.empty((drive.steps, self._equations.n_values))
        track = np.empty((drive.steps, self._nowhere.shape[1]))
        ends, why = self._go(start[np.newaxis], drive, track, values)
        if why[0] > at.WILD:
            return self._by_mujoco().follow(start, drive)
        qpos, qvel, act = np.split(track, [self.model.nq, self.model.nq + self.model.nv], axis=1)
        return Track(end=ends[0], sensors=values, qpos=qpos, qvel=qvel, act=act, drive=drive)

    def look_around(self, track: Track, moves: Array, wanted: Integers, factors: Array, out: Array) -> bool:
        """Write how accelerations, rates and deflections change beside a motion at the start of every step.

        False if some of these states touch something or stand at a limit.

        Args:
            track: the motion.
            moves: displacements in the tangent space of configuration, velocities and internal states, (n, 2 nv + n_a).
            wanted: `addresses` of those that are, (n_wanted,).
            factors: of their changes, (n_wanted,).
            out: takes the changes in its last rows and first columns, (n_t, n_rows, n or more).
        """
        places = np.column_stack([track.qpos, track.qvel, track.act])
        lanes = np.zeros((out.shape[2], moves.shape[1]))
        lanes[: len(moves)] = moves
        lanes = np.ascontiguousarray(lanes.reshape(-1, WIDTH, moves.shape[1]).swapaxes(1, 2))
        instants = track.drive.duration / track.drive.steps * np.arange(track.drive.steps)
        motion = track.drive.sine(self.coordinates.direction).acceleration(instants)[np.newaxis]
        e, group = self._equations, group_of([self._equations] * WIDTH, places[[0] * WIDTH], [0] * WIDTH)
        look_around(
            e.lay, e.fix, group.numbers, group.states, group.memory, places, lanes, motion, wanted, factors,
            out.reshape(*out.shape[:2], -1, WIDTH),
        )  # fmt: skip
        self.passes += (1 + len(moves)) * len(places)
        return not group.memory[e.lay[at.FAILED]].any()

    def addresses(self, free: Integers, deflected: Integers) -> Integers:
        """Return where the kernel keeps accelerations of free coordinates, and rates of the internal states.

        For the states in `deflected` it is the deflection of their axis.
        """
        lay = self._equations.lay
        states = lay[at.RATES] + np.arange(self.model.na)
        states[deflected] = self._records(deflected)[0]
        return np.concatenate([lay[at.RHS] + free, states])

    def _records(self, states: Integers) -> tuple[Integers, Integers]:
        """Return for some states where the deflection of their axis is recorded, and where its parameters begin, (n,) each."""
        lay = self._equations.lay
        axes = lay[lay[at.AXES] :][: 3 * at.AXIS_COLUMNS * lay[at.N_MOUNTS]].reshape(-1, at.AXIS_COLUMNS)
        owner = np.repeat(np.arange(len(axes)), np.where(axes[:, 0] >= 0, axes[:, 3], 0))
        firsts = np.repeat(axes[:, 2], np.where(axes[:, 0] >= 0, axes[:, 3], 0))
        within = np.arange(owner.size) - np.searchsorted(owner, owner)
        row = np.empty(owner.size, dtype=np.int64)
        row[firsts + within] = owner
        mount, axis = np.divmod(row[states], 3)
        return lay[at.RECORD] + at.RECORD_SIZE * mount + axis, lay[at.PARAMETERS] + axes[row[states], 1]

    def _steep(self, scaled: ScaledStates) -> Integers:
        """Return the states that are carried in closed form, as `go` wants them, (n, 4)."""
        lay, chosen = self._equations.lay, np.flatnonzero(scaled.steep & ~scaled.smoothed)
        states = scaled.states[chosen]
        record, parameters = self._records(states)
        rows = lay[at.NQ] + lay[at.NV] + states
        return np.column_stack([record, record + RATE, parameters + scaled.offsets[chosen], rows])

    def _go(self, starts: Array, drive: Drive, track: Array, values: Array) -> tuple[Array, Array]:
        """Return the ends of at most WIDTH copies, NaN where one went astray, and why it did, 0 if it did not."""
        part = self.coordinates
        carried = part.carried(drive.frequency, drive.acceleration)
        full = np.array([part.to_state(start, carried) for start in starts])
        e, group = self._equations, group_of([self._equations] * len(starts), full[:, part.moving], [0] * len(starts))
        h, motion = drive.duration / drive.steps, drive.sine(part.direction)
        half = h * (0.5 * np.arange(2 * drive.steps + 1))
        begins, slides = half[: -1 : 2 * MAX_STEPS], self.system.assembly.tables.drive.T
        positions, rates = motion.displacement(begins) @ slides, motion.velocity(begins) @ slides
        go(
            e.lay, e.fix, group.numbers, group.states, group.memory, positions[np.newaxis], rates[np.newaxis],
            motion.acceleration(half)[np.newaxis], h, self._carried, len(starts), track, values,
        )  # fmt: skip
        self.taken += drive.steps * len(starts)
        full[:, part.moving] = group.states[:, : len(starts)].T
        why = group.memory[e.lay[at.FAILED], : len(starts)]
        ends = np.array([part.from_state(one, carried) for one in full])
        ends[why != 0.0] = np.nan
        return ends, why

    def _by_mujoco(self) -> MujocoFlow:
        if self._beyond is None:
            self._beyond = MujocoFlow(self.coordinates, self.system)
            self._within.enter_context(self._beyond.ready())
            if self.width:
                self._beyond.smooth(self.width)
        return self._beyond
