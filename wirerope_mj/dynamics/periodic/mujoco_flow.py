"""Many copies of a system through whole periods of its base's sine, in parallel, by MuJoCo."""

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
from wirerope_mj.dynamics.periodic.flow import Flow
from wirerope_mj.dynamics.periodic.smoothing import set_width, width_indices
from wirerope_mj.dynamics.periodic.track import Drive, Track
from wirerope_mj.engine.control import installed
from wirerope_mj.engine.control import layout as at
from wirerope_mj.engine.system import System
from wirerope_mj.foundation.arrays import Array
from wirerope_mj.foundation.errors import SimulationError
from wirerope_mj.motions import Sine

STATE_PARTS = ("qpos", "qvel", "act")

COPIES = 8
"""Copies that there are at least: Newton's trial steps need them; the columns of a matrix need one for each unknown."""


class MujocoFlow(Flow):
    """The map as MuJoCo steps it, with whatever the model has: contacts, limits, constraints."""

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
        """Smooth the laws over a velocity [m/s]."""
        super().smooth(width)
        set_width(self._batch, self.width_indices, width)

    @contextmanager
    def ready(self) -> Iterator[None]:
        """Make the mounts act; everything else of a flow is called within."""
        with installed(self.model, mujoco.MjData(self.model)) as kind:
            if kind != "native":
                raise SimulationError("periodic motions need the native callback, which is not available here.")
            yield

    def ends(self, starts: Array, drive: Drive) -> Array:
        """Return the unknowns at the end of each copy's periods, (n, n_x), n at most the number of copies."""
        copies = np.arange(len(starts))
        carried = self._begin(starts, drive)
        for _ in self._tables(copies, drive):
            self._batch.step(copies, nstep=self._table_steps)
        return self._finish(carried, copies)

    def follow(self, start: Array, drive: Drive) -> Track:
        """Return the track of one copy from `start`, (n_x,)."""
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
        """Put the copies at their starts; return the state relative to which they are."""
        carried, n = self.coordinates.carried(drive.frequency, drive.acceleration), len(starts)
        self._batch.state[:n] = [self.coordinates.to_state(start, carried) for start in starts]
        self._timestep[:n] = drive.duration / drive.steps
        self._batch.warning[:n] = 0
        self._user[:n] = 0.0
        return carried

    def _tables(self, copies: npt.NDArray[np.int64], drive: Drive) -> Iterator[None]:
        """Prepare the steps of one stage table after the other; `_table_steps` says how many there are in it."""
        done, motion = 0, drive.sine(self.coordinates.direction)
        while done < drive.steps:
            self._table_steps = min(at.MAX_STEPS, drive.steps - done)
            self._place(copies.size, motion, drive.duration / drive.steps, done)
            yield
            done += self._table_steps
        self.taken += drive.steps * copies.size

    def _place(self, n: int, motion: Sine, step: float, done: int) -> None:
        times = step * (done + 0.5 * np.arange(2 * self._table_steps + 1))
        table = self.system.assembly.tables.drive
        self._qpos[:n, self._driven_qpos] = (
            self.model.qpos0[self._driven_qpos] + table @ motion.displacement(times[:1])[0]
        )
        self._qvel[:n, self._dofs] = table @ motion.velocity(times[:1])[0]
        user = self._user[:n]
        user[:, at.STAGE_POINTS], user[:, at.STAGE_START], user[:, at.STAGE_RATE] = times.size, times[0], 2.0 / step
        user[:, at.STAGES : at.STAGES + 3 * times.size] = motion.acceleration(times).ravel()
        self._batch.state[:n, 0] = times[0]  # time, so that rounding does not add up

    def _finish(self, carried: Array, copies: npt.NDArray[np.int64]) -> Array:
        self._batch.forward(copies)  # takes out of the states what the last step carried beyond a slider's slip force
        ends = np.array([self.coordinates.from_state(self._batch.state[i], carried) for i in copies])
        astray = self._batch.warning[: copies.size, :, 1].any(axis=1)
        ends[astray] = np.nan
        return cast(Array, ends)
