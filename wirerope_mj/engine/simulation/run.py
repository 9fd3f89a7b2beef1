"""Stepping a system through a time grid: the one loop of every simulation."""

import math
from collections.abc import Callable
from dataclasses import dataclass
from typing import Literal

import mujoco
import numpy as np

from wirerope_mj.engine.control import installed
from wirerope_mj.engine.control import layout as at
from wirerope_mj.engine.control.install import Kind
from wirerope_mj.engine.response.peaks import BodyPeaks, CombinedTravel, MountPeaks, Peak, Peaks, PointPeaks
from wirerope_mj.engine.simulation.contacts import contacts_of
from wirerope_mj.engine.simulation.grid import TimeGrid
from wirerope_mj.engine.simulation.stages import StageTables
from wirerope_mj.engine.simulation.stepper import Stepper
from wirerope_mj.engine.system import System
from wirerope_mj.foundation.arrays import Array
from wirerope_mj.foundation.state import State
from wirerope_mj.motions import BaseMotion

CHECK_EVERY = 64  # segments between two looks at MuJoCo's warning counters


@dataclass(frozen=True, kw_only=True)
class RunResult:
    """Result of stepping: state at the grid's end, peaks over every step, largest step [s], and who made it.

    `why` says why it is MuJoCo's and not the kernel's, if it is.
    """

    final_state: State
    peaks: Peaks
    callback: Kind
    steps: int
    largest_step: float
    engine: Literal["mujoco", "kernel"] = "mujoco"
    why: str = ""


def run(
    system: System,
    motion: BaseMotion,
    grid: TimeGrid,
    initial: State,
    *,
    callback: Kind,
    sink: Callable[[int, Array], None],
    progress: Callable[[float], None] | None = None,
) -> RunResult:
    """Step `system` through `grid` from `initial` by MuJoCo and hand every sample to `sink`.

    The system's model is copied, so that one system serves several threads. `sink` takes the number of the first of some
    samples and the system's sensor values, (n_samples, n_values), which it must copy; `progress` takes the simulated time [s]
    now and then.

    Raises:
        SimulationError: MuJoCo warned that the state is not valid any more.
    """
    stepper = Stepper(system, motion, initial)
    data, values = stepper.data, stepper.data.sensordata[system.assembly.sensor :]
    sample, all_steps, largest = 0, 0, 0.0
    tables = StageTables(motion, system.assembly.tables.drive, system.assembly.subjects.force_names)
    with installed(stepper.model, data, callback) as kind:
        for block in grid.blocks():
            stepper.enter(block)
            all_steps, largest = all_steps + int(block.steps.sum()), max(largest, block.largest_step)
            for base in tables.segments(block):
                segment = base.number
                if segment % CHECK_EVERY == 0:
                    stepper.check()
                    if progress is not None:
                        progress(float(block.start[segment]))
                stepper.begin(base)
                steps = int(block.steps[segment])
                if block.sampled[segment]:
                    mujoco.mj_step(stepper.model, data)
                    sink(sample, values[np.newaxis])
                    sample, steps = sample + 1, steps - 1
                if steps:
                    mujoco.mj_step(stepper.model, data, nstep=steps)
        final = stepper.finish()
        if sample < grid.sample_times.size:
            sink(sample, values[np.newaxis])
        stepper.check()
    if progress is not None:
        progress(grid.stop)
    return RunResult(
        final_state=final,
        peaks=peaks_of(system, stepper.user, tables.peak),
        callback=kind,
        steps=all_steps,
        largest_step=largest,
    )


def peaks_of(system: System, user: Array, base: Peak) -> Peaks:
    """Return the peaks from the tracker's memory in the system's userdata; what is fixed to the base has the base's own."""
    assembly = system.assembly
    rows = assembly.tables.user.channel_rows(user)
    every = [Peak.of(row) for row in rows.take(_NUMBERS, axis=1)]
    for number in assembly.tables.base_channels:
        every[number] = base
    channels = iter(every)
    bodies = {name: BodyPeaks(acceleration=next(channels)) for name in assembly.subjects.body_names}
    points = {
        name: PointPeaks(acceleration=next(channels), relative_displacement=next(channels))
        for name in assembly.subjects.point_names
    }
    mounts = {name: MountPeaks(deflection=next(channels), force=next(channels)) for name in system.mounts}
    travels = dict(zip(system.mounts, map(_travel, assembly.tables.user.travel_rows(user).tolist()), strict=True))
    return Peaks(bodies=bodies, points=points, mounts=mounts, contacts=contacts_of(system, user), travels=travels)


def _travel(row: list[float]) -> CombinedTravel:
    judged = row[at.JUDGED]
    return CombinedTravel(
        value=math.sqrt(row[at.FARTHEST]), time=row[at.FARTHEST_TIME],
        judged=math.sqrt(judged) if judged >= 0.0 else None, judged_time=row[at.JUDGED_TIME],
    )  # fmt: skip


# where the numbers of a `Peak` stand in the tracker's memory of a channel
_NUMBERS = np.array(
    [
        at.PEAK,
        at.PEAK_TIME,
        *(first + c for first in (at.PEAK_VECTOR, at.LOW, at.LOW_TIME, at.HIGH, at.HIGH_TIME) for c in range(3)),
    ]
)
