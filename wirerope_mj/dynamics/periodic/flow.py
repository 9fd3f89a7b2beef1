"""Many copies of a system through whole periods of its base's sine, in parallel."""

import copy
import os
from collections.abc import Iterator
from contextlib import contextmanager
from typing import cast

import mujoco
import numpy as np
import numpy.typing as npt
from mujoco.batch import Batch

from wirerope_mj.dynamics.periodic.coordinates import Coordinates
from wirerope_mj.dynamics.periodic.smoothing import set_width, width_indices
from wirerope_mj.dynamics.periodic.track import Drive, Track
from wirerope_mj.engine.control import installed
from wirerope_mj.engine.control import layout as at
from wirerope_mj.engine.system import System
from wirerope_mj.foundation.arrays import Array
from wirerope_mj.foundation.errors import SimulationError
from wirerope_mj.motions import Sine

STATE_PARTS = ("qpos", "qvel", "act")


class Flow:
    """The map from the unknowns at phase 0 to those some periods later.

    Attributes:
        coordinates: the unknowns.
        system: what is stepped: that of the coordinates, or one with the same states and smoothed laws.
        width: velocity over which its laws are smoothed [m/s]; 0 for laws as they are.
        taken: model steps taken so far, of all copies.
        passes: single forward passes in addition; a step has four.
    """

    def __init__(self, coordinates: Coordinates, *, copies: int, system: System | None = None) -> None:
        self.coordinates, self.system = coordinates, system or coordinates.system
        self.model, self.taken, self.passes = copy.copy(self.system.model), 0, 0
        self._batch = Batch(self.model, nsim=copies, nthread=min(copies, os.cpu_count() or 1))
        self.width_indices, self.width = width_indices(self.system), 0.0
        self._timestep = self._batch.expand("opt.timestep")
        self._qpos, self._qvel = self._batch.bind("qpos"), self._batch.bind("qvel")
        assembly = self.system.assembly
        self._user = assembly.user(self._batch.bind("userdata"))
        self._dofs = np.array(assembly.driven_dofs, dtype=int)
        self._driven_qpos = self.model.jnt_qposadr[list(assembly.subjects.driven)]

    @property
    def steps(self) -> int:
        """Model steps taken so far, forward passes counted as quarters."""
        return self.taken + self.passes // 4

    def smooth(self, width: float) -> None:
        """Smooth the laws over a velocity [m/s]."""
        self.width = width
        set_width(self._batch, self.width_indices, width)

    @contextmanager
    def ready(self) -> Iterator[None]:
        """Make the mounts act; everything else of a flow is called within."""
        with installed(self.model, mujoco.MjData(self.model)) as kind:
            if kind != "native":
                raise SimulationError("periodic motions need the native callback, which is not available here.")
            yield

    def ends(self, starts: Array, drives: list[Drive]) -> Array:
        """Return the unknowns at the end of each copy's periods, (n, n_x); NaN where a copy went astray.

        Args:
            starts: unknowns at phase 0, (n, n_x), n at most the number of copies.
            drives: every copy's sine, all with the same number of steps.
        """
        copies = np.arange(len(drives))
        carried = self._begin(starts, drives)
        for _ in self._tables(drives):
            self._batch.step(copies, nstep=self._table_steps)
        return self._finish(carried, copies)

    def follow(self, start: Array, drive: Drive) -> Track:
        """Return the track of one copy from `start`, (n_x,)."""
        first = np.zeros(1, dtype=int)
        carried = self._begin(start[np.newaxis], [drive])
        recorded = {name: [getattr(self._batch, name)[:1].copy()] for name in STATE_PARTS} | {"sensordata": []}
        for _ in self._tables([drive]):
            chunk = self._batch.rollout(self._table_steps, record=tuple(recorded), ids=first)
            for name, values in chunk.items():
                recorded[name].append(values[0])
        # The engine records states at the end of a step, sensors at its start.
        qpos, qvel, act = (np.concatenate(recorded[name])[:-1] for name in STATE_PARTS)
        sensors = np.concatenate(recorded["sensordata"])[:, self.system.assembly.sensor :]
        end = self._finish(carried, first)[0]
        return Track(end=end, sensors=sensors, qpos=qpos, qvel=qvel, act=act, drive=drive)

    def _begin(self, starts: Array, drives: list[Drive]) -> list[Array]:
        known: dict[tuple[float, float], Array] = {}
        carried = []
        for number, (start, drive) in enumerate(zip(starts, drives, strict=True)):
            key = (drive.frequency, drive.acceleration)
            if key not in known:
                known[key] = self.coordinates.carried(*key)
            self._batch.state[number] = self.coordinates.to_state(start, known[key])
            self._timestep[number] = drive.duration / drive.steps
            carried.append(known[key])
        n = len(drives)
        self._batch.warning[:n] = 0
        self._user[:n] = 0.0
        return carried

    def _tables(self, drives: list[Drive]) -> Iterator[None]:
        """Prepare the steps of one stage table after the other; `_piece` says how many there are in it."""
        total, done = drives[0].steps, 0
        motions = [
            Sine(frequency=d.frequency, acceleration=d.acceleration, direction=self.coordinates.direction)
            for d in drives
        ]
        while done < total:
            self._table_steps = min(at.MAX_STEPS, total - done)
            for row, (drive, motion) in enumerate(zip(drives, motions, strict=True)):
                self._place(row, motion, drive, done)
            yield
            done += self._table_steps
        self.taken += total * len(drives)

    def _place(self, row: int, motion: Sine, drive: Drive, done: int) -> None:
        step = drive.duration / drive.steps
        times = step * (done + 0.5 * np.arange(2 * self._table_steps + 1))
        table = self.system.assembly.tables.drive
        self._qpos[row, self._driven_qpos] = (
            self.model.qpos0[self._driven_qpos] + table @ motion.displacement(times[:1])[0]
        )
        self._qvel[row, self._dofs] = table @ motion.velocity(times[:1])[0]
        user = self._user[row]
        user[at.STAGE_POINTS], user[at.STAGE_START], user[at.STAGE_RATE] = times.size, times[0], 2.0 / step
        user[at.STAGES : at.STAGES + 3 * times.size] = motion.acceleration(times).ravel()
        self._batch.state[row, 0] = times[0]  # time, so that rounding does not add up

    def _finish(self, carried: list[Array], copies: npt.NDArray[np.int64]) -> Array:
        self._batch.forward(copies)  # takes out of the states what the last step carried beyond a slider's slip force
        ends = np.array(
            [self.coordinates.from_state(self._batch.state[i], c) for i, c in zip(copies, carried, strict=True)]
        )
        astray = self._batch.warning[: copies.size, :, 1].any(axis=1)
        ends[astray] = np.nan
        return cast(Array, ends)
