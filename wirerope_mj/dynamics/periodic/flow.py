"""The map of a system over whole periods of its base's sine, many copies at once, by the kernel or by MuJoCo."""

import copy
import os
from abc import ABC, abstractmethod
from collections.abc import Iterator
from contextlib import AbstractContextManager, ExitStack, contextmanager
from dataclasses import replace
from typing import cast

import mujoco
import numpy as np
from mujoco.batch import Batch

from wirerope_mj.dynamics.periodic.laws import ScaledStates, width_indices, widths_of
from wirerope_mj.dynamics.periodic.motion import Coordinates, Drive, Track
from wirerope_mj.dynamics.periodic.stepping import differences_about, step_periods
from wirerope_mj.engine.control import installed
from wirerope_mj.engine.control import layout as at
from wirerope_mj.engine.control.layout import MAX_STEPS
from wirerope_mj.engine.kernel import layout as kernel
from wirerope_mj.engine.kernel.equations import Equations
from wirerope_mj.engine.kernel.variants import group_of
from wirerope_mj.engine.simulation.engines import equations, unsupported_system
from wirerope_mj.engine.system import System
from wirerope_mj.foundation.arrays import Array, Integers
from wirerope_mj.foundation.errors import SimulationError
from wirerope_mj.foundation.lanes import WIDTH

STATE_PARTS = ("qpos", "qvel", "act")
# Least number of copies: Newton's trial steps need them; the columns of a matrix need one for each unknown.
COPIES = 8
RATE = 6  # offset of the deflection's rate in a mount's record, behind deflection and force


class Flow(ABC):
    """The map from the unknowns at phase 0 of the base's sine to the unknowns some periods later."""

    def __init__(self, coordinates: Coordinates, system: System) -> None:
        self.coordinates = coordinates
        # The system of the coordinates, or one with the same states and smoothed laws.
        self.system, self.model = system, system.model
        self.width = 0.0  # velocity over which its laws are smoothed [m/s]; 0 for unsmoothed laws
        self.taken, self.passes = 0, 0  # model steps of all copies so far, and single forward passes; a step has four

    @property
    def steps(self) -> int:
        """Steps of single copies so far; an evaluation of the accelerations without a step counts as a quarter."""
        return self.taken + self.passes // 4

    def smooth(self, width: float) -> None:
        """Smooth the sign of the rate in the laws over a velocity `width` [m/s]."""
        self.width = width

    @abstractmethod
    def ready(self) -> AbstractContextManager[None]:
        """Install the mounts' forces; all other methods of a flow are called within this context."""

    @abstractmethod
    def ends(self, starts: Array, drive: Drive) -> Array:
        """Step copies of the system through the drive's periods; returns their ends, (n, n_x), NaN where one diverged."""

    @abstractmethod
    def follow(self, start: Array, drive: Drive) -> Track:
        """Step one copy from `start`, (n_x,), through the drive's periods and keep its track."""


class MujocoFlow(Flow):
    """The map stepped by MuJoCo, for models with contacts, limits and constraints, too."""

    def __init__(self, coordinates: Coordinates, system: System) -> None:
        super().__init__(coordinates, system)
        self.model = copy.copy(system.model)
        copies = max(coordinates.size + 2, COPIES)
        self._batch = Batch(self.model, nsim=copies, nthread=min(copies, os.cpu_count() or 1))
        self.width_indices = width_indices(self.system)
        self._timestep = self._batch.expand("opt.timestep")
        self._qpos, self._qvel = self._batch.bind("qpos"), self._batch.bind("qvel")
        assembly = self.system.assembly
        self._user = assembly.user(self._batch.bind("userdata"))
        self._dofs = np.array(assembly.driven_dofs, dtype=int)
        self._driven_qpos = self.model.jnt_qposadr[list(assembly.subjects.driven)]

    def smooth(self, width: float) -> None:
        super().smooth(width)
        self._batch.expand("numeric_data")[:, self.width_indices] = width

    @contextmanager
    def ready(self) -> Iterator[None]:
        with installed(self.model, mujoco.MjData(self.model)) as kind:
            if kind != "native":
                raise SimulationError("periodic motions need the native callback, which is not available here.")
            yield

    def ends(self, starts: Array, drive: Drive) -> Array:
        """Step copies of the system, at most as many as the batch holds, to their ends, (n, n_x), NaN where one diverged."""
        copies = np.arange(len(starts))
        carried = self._begin(starts, drive)
        for _ in self._tables(copies, drive):
            self._batch.step(copies, nstep=self._table_steps)
        return self._finish(carried, copies)

    def follow(self, start: Array, drive: Drive) -> Track:
        first = np.zeros(1, dtype=int)
        carried = self._begin(start[np.newaxis], drive)
        recorded = {name: [getattr(self._batch, name)[:1].copy()] for name in STATE_PARTS} | {"sensordata": []}
        for _ in self._tables(first, drive):
            chunk = self._batch.rollout(self._table_steps, record=tuple(recorded), ids=first)
            for name, values in chunk.items():
                recorded[name].append(values[0])
        # The engine records states at the end of a step, sensors at its start.
        qpos, qvel, act = (np.concatenate(recorded[name])[:-1] for name in STATE_PARTS)
        sensors = np.concatenate(recorded["sensordata"])[:, self.system.assembly.sensor :]
        end = self._finish(carried, first)[0]
        return Track(end=end, sensors=sensors, qpos=qpos, qvel=qvel, act=act, drive=drive)

    def _begin(self, starts: Array, drive: Drive) -> Array:
        """Put the copies at their starts; returns the equilibrium's state carried by the base, from which unknowns count."""
        carried, n = self.coordinates.carried(drive.frequency, drive.acceleration), len(starts)
        self._batch.state[:n] = [self.coordinates.to_state(start, carried) for start in starts]
        self._timestep[:n] = drive.duration / drive.steps
        self._batch.warning[:n] = 0
        self._user[:n] = 0.0
        return carried

    def _tables(self, copies: Integers, drive: Drive) -> Iterator[None]:
        """Write the base's motion for one block of `_table_steps` steps after the other, and yield after each."""
        done, motion, n = 0, drive.sine(self.coordinates.direction), copies.size
        step, table = drive.duration / drive.steps, self.system.assembly.tables.drive
        origin = self.model.qpos0[self._driven_qpos]
        while done < drive.steps:
            self._table_steps = min(MAX_STEPS, drive.steps - done)
            times = step * (done + 0.5 * np.arange(2 * self._table_steps + 1))
            self._qpos[:n, self._driven_qpos] = origin + table @ motion.displacement(times[:1])[0]
            self._qvel[:n, self._dofs] = table @ motion.velocity(times[:1])[0]
            user = self._user[:n]
            user[:, at.STAGE_POINTS], user[:, at.STAGE_START], user[:, at.STAGE_RATE] = times.size, times[0], 2.0 / step
            user[:, at.STAGES : at.STAGES + 3 * times.size] = motion.acceleration(times).ravel()
            self._batch.state[:n, 0] = times[0]  # time, so that rounding does not add up
            yield
            done += self._table_steps
        self.taken += drive.steps * n

    def _finish(self, carried: Array, copies: Integers) -> Array:
        """Read the unknowns at the copies' ends, (n, n_x); NaN where the engine warned."""
        self._batch.forward(copies)  # limits the states that the last step carried beyond a slider's slip force
        ends = np.array([self.coordinates.from_state(self._batch.state[i], carried) for i in copies])
        diverged = self._batch.warning[: copies.size, :, 1].any(axis=1)
        ends[diverged] = np.nan
        return cast(Array, ends)


def flow_of(coordinates: Coordinates, system: System) -> Flow:
    return MujocoFlow(coordinates, system) if unsupported_system(system) else KernelFlow(coordinates, system)


class KernelFlow(Flow):
    """The map stepped by the kernel; a copy that comes to a contact or a limit is stepped by MuJoCo."""

    def __init__(self, coordinates: Coordinates, system: System) -> None:
        super().__init__(coordinates, system)
        self._equations: Equations = equations(system)
        self._axes = self._equations.rows(kernel.AXES, kernel.AXIS_COLUMNS, 3 * len(system.mounts))
        self._fallback: MujocoFlow | None = None
        self._contexts = ExitStack()
        # States that are carried in closed form: the argument `carried` of `step_periods`, (n, 4).
        lay, scaled = self._equations.lay, ScaledStates(system)
        chosen = np.flatnonzero(scaled.steep & ~scaled.smoothed)
        states = scaled.states[chosen]
        record, parameters = self._records(states)
        rows = lay[kernel.NQ] + lay[kernel.NV] + states
        self._closed_form = np.column_stack([record, record + RATE, parameters + scaled.offsets[chosen], rows])
        self._no_track = np.zeros((0, coordinates.carried(1.0, 1.0)[coordinates.moving].size))

    @property
    def steps(self) -> int:
        """Model steps taken so far, those by MuJoCo included."""
        return super().steps + (self._fallback.steps if self._fallback is not None else 0)

    def smooth(self, width: float) -> None:
        super().smooth(width)
        num, first = self._equations.num.copy(), int(self._equations.lay[kernel.PARAMETERS])
        num[first + widths_of(self._axes[:, :2], num[first:])] = width
        self._equations = replace(self._equations, num=num)
        if self._fallback is not None:
            self._fallback.smooth(width)

    @contextmanager
    def ready(self) -> Iterator[None]:
        """Install MuJoCo's callback, too, should it have to take over within this context."""
        with self._contexts:
            if self._fallback is not None:
                self._contexts.enter_context(self._fallback.ready())
            yield

    def ends(self, starts: Array, drive: Drive) -> Array:
        ends, cause = np.empty_like(starts), np.empty(len(starts))
        for first in range(0, len(starts), WIDTH):
            lanes = slice(first, first + WIDTH)
            ends[lanes], cause[lanes] = self._step_lanes(starts[lanes], drive, self._no_track, self._no_track)
        unsupported = cause > kernel.WILD
        if unsupported.any():
            ends[unsupported] = self._mujoco_flow().ends(starts[unsupported], drive)
        return ends

    def follow(self, start: Array, drive: Drive) -> Track:
        values = np.empty((drive.steps, self._equations.n_values))
        track = np.empty((drive.steps, self._no_track.shape[1]))
        ends, cause = self._step_lanes(start[np.newaxis], drive, track, values)
        if cause[0] > kernel.WILD:
            return self._mujoco_flow().follow(start, drive)
        qpos, qvel, act = np.split(track, [self.model.nq, self.model.nq + self.model.nv], axis=1)
        return Track(end=ends[0], sensors=values, qpos=qpos, qvel=qvel, act=act, drive=drive)

    def differences_about(self, track: Track, moves: Array, wanted: Integers, factors: Array, out: Array) -> bool:
        """Write how accelerations, rates and deflections change with displacements from a motion, at every step's start.

        `moves` are displacements in the tangent space of configuration, velocities and internal states, (n, 2 nv + n_a);
        `wanted` the `addresses` of the kept values, with factors, (n_wanted,); `out` takes the changes in its last rows and
        first columns, (n_t, n_rows, n or more). False if one of these states is at a contact or a limit.
        """
        places = np.column_stack([track.qpos, track.qvel, track.act])
        lanes = np.zeros((out.shape[2], moves.shape[1]))
        lanes[: len(moves)] = moves
        lanes = np.ascontiguousarray(lanes.reshape(-1, WIDTH, moves.shape[1]).swapaxes(1, 2))
        instants = track.drive.duration / track.drive.steps * np.arange(track.drive.steps)
        motion = track.drive.sine(self.coordinates.direction).acceleration(instants)[np.newaxis]
        e, group = self._equations, group_of([self._equations] * WIDTH, places[[0] * WIDTH], [0] * WIDTH)
        differences_about(
            e.lay, e.fix, group.numbers, group.states, group.memory, places, lanes, motion, wanted, factors,
            out.reshape(*out.shape[:2], -1, WIDTH),
        )  # fmt: skip
        self.passes += (1 + len(moves)) * len(places)
        return not group.memory[e.lay[kernel.FAILED]].any()

    def addresses(self, free: Integers, deflected: Integers) -> Integers:
        """Locate accelerations of free coordinates and rates of the internal states in the kernel's memory.

        For the states in `deflected` the address is that of the deflection of their axis.
        """
        lay = self._equations.lay
        states = lay[kernel.RATES] + np.arange(self.model.na)
        states[deflected] = self._records(deflected)[0]
        return np.concatenate([lay[kernel.RHS] + free, states])

    def _records(self, states: Integers) -> tuple[Integers, Integers]:
        """Locate each state's deflection in the kernel's memory and its law's first parameter in the numbers, (n,) each."""
        lay, axes = self._equations.lay, self._axes
        owner, firsts = np.repeat(np.arange(len(axes)), axes[:, 3]), np.repeat(axes[:, 2], axes[:, 3])
        within = np.arange(owner.size) - np.searchsorted(owner, owner)
        row = np.empty(owner.size, dtype=np.int64)
        row[firsts + within] = owner
        mount, axis = np.divmod(row[states], 3)
        return lay[kernel.RECORD] + kernel.RECORD_SIZE * mount + axis, lay[kernel.PARAMETERS] + axes[row[states], 1]

    def _step_lanes(self, starts: Array, drive: Drive, track: Array, values: Array) -> tuple[Array, Array]:
        """Step at most WIDTH copies to their ends, NaN where one diverged; returns also each failure's cause, 0 without."""
        coordinates = self.coordinates
        carried = coordinates.carried(drive.frequency, drive.acceleration)
        full = np.array([coordinates.to_state(start, carried) for start in starts])
        e, group = self._equations, group_of([self._equations] * len(starts), full[:, coordinates.moving], [0] * len(starts))
        h, motion = drive.duration / drive.steps, drive.sine(coordinates.direction)
        half = h * (0.5 * np.arange(2 * drive.steps + 1))
        begins, slides = half[: -1 : 2 * MAX_STEPS], self.system.assembly.tables.drive.T
        positions, rates = motion.displacement(begins) @ slides, motion.velocity(begins) @ slides
        step_periods(
            e.lay, e.fix, group.numbers, group.states, group.memory, positions[np.newaxis], rates[np.newaxis],
            motion.acceleration(half)[np.newaxis], h, self._closed_form, len(starts), track, values,
        )  # fmt: skip
        self.taken += drive.steps * len(starts)
        full[:, coordinates.moving] = group.states[:, : len(starts)].T
        cause = group.memory[e.lay[kernel.FAILED], : len(starts)]
        ends = np.array([coordinates.from_state(state, carried) for state in full])
        ends[cause != 0.0] = np.nan
        return ends, cause

    def _mujoco_flow(self) -> MujocoFlow:
        """Return the flow by MuJoCo that takes over, made at the first call."""
        if self._fallback is None:
            self._fallback = MujocoFlow(self.coordinates, self.system)
            self._contexts.enter_context(self._fallback.ready())
            if self.width:
                self._fallback.smooth(self.width)
        return self._fallback
