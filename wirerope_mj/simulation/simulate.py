"""System + base motion -> Response."""

import math
from importlib.metadata import version
from pathlib import Path
from typing import Any

import numpy as np
import numpy.typing as npt

from wirerope_mj.control.install import Kind
from wirerope_mj.errors import ModelError, SimulationError
from wirerope_mj.excitation import BaseMotion
from wirerope_mj.response.columns import ColumnPlan
from wirerope_mj.response.response import MemorySamples, Numerics, Response, State
from wirerope_mj.response.storage import FILE, SampleWriter, build_response, load_response, response_metadata
from wirerope_mj.simulation.grid import Grid, time_grid
from wirerope_mj.simulation.initial import initial_state
from wirerope_mj.simulation.progress import progress_bar
from wirerope_mj.simulation.run import Run, point_name, run
from wirerope_mj.simulation.scene import scene_of
from wirerope_mj.simulation.stability import stable_step
from wirerope_mj.simulation.timestep import choose_timestep
from wirerope_mj.system import System

Array = npt.NDArray[np.float64]

STREAM_ROWS = 4096
"""Samples that are kept in memory before a block is written to disk."""


def simulate(
    system: System,
    motion: BaseMotion,
    *,
    duration: float,
    initial: str | State = "settled",
    timestep: float | None = None,
    accuracy: float = 1e-4,
    sample_rate: float = 1000.0,
    callback: Kind = "native",
    out: str | Path | None = None,
    progress: bool = False,
) -> Response:
    """Return the response of `system` to a base motion.

    Args:
        system: the system.
        motion: base motion; every component needs a driven slide of the base.
        duration: simulated time [s].
        initial: "settled" (equilibrium under gravity on the virgin path), "unloaded" (modelled geometry at rest relative to
            the base), or a State, from whose instant the simulation goes on.
        timestep: largest step [s]; None chooses it before the run for `accuracy`.
        accuracy: error of samples and refined peaks allowed, relative to the peaks; used if `timestep` is None.
        sample_rate: samples per second [Hz], at k / sample_rate.
        callback: "native", or "python".
        out: folder to which samples are streamed as `response.parquet`; the response then reads them when asked.
        progress: whether a progress bar is shown on standard error.

    Raises:
        ValueError: an argument is out of range.
        ModelError: the motion needs a slide that the base does not have.
        SimulationError: the step is too large, or the engine reported that the state is not valid any more.
        ConvergenceError: there is no equilibrium to start from.
    """
    _check_arguments(duration=duration, sample_rate=sample_rate, accuracy=accuracy, timestep=timestep)
    _check_direction(system, motion)
    start = initial_state(system, motion, initial)
    limit = stable_step(system)
    if timestep is not None and timestep > limit:
        raise SimulationError(
            f"a step of {timestep:.4g} s is too large for the stiffest mount: RK4 is stable up to {limit:.4g} s here. "
            "Give a smaller `timestep`, or None to have it chosen."
        )
    error = math.nan
    if timestep is None:
        chosen = choose_timestep(
            system, motion, start, duration=duration, sample_rate=sample_rate, accuracy=accuracy, limit=limit
        )
        timestep, error = chosen.timestep, chosen.error
    grid = time_grid(start=start.time, duration=duration, sample_rate=sample_rate, timestep=timestep, motion=motion)
    recorder = _Recorder(system, motion, grid, Path(out) if out is not None else None)
    try:
        with progress_bar(grid, enabled=progress) as update:
            done = run(system, motion, grid, start, callback=callback, sink=recorder.add, progress=update)
        numerics = Numerics(
            timestep=grid.largest_step,
            accuracy=accuracy if not math.isnan(error) else math.nan,
            error_estimate=error,
            steps=int(grid.steps.sum()),
            callback=done.callback,
            versions={name: version(name) for name in ("wirerope-mj", "mujoco", "numpy", "numba")},
        )
        return recorder.finish(start, done, numerics)
    except BaseException:
        recorder.discard()
        raise


def _check_arguments(*, duration: float, sample_rate: float, accuracy: float, timestep: float | None) -> None:
    named = {"duration": duration, "sample_rate": sample_rate, "accuracy": accuracy, "timestep": timestep}
    for name, value in named.items():
        if value is not None and not (math.isfinite(value) and value > 0.0):
            raise ValueError(f"`{name}` must be a positive number, got {value}.")


def _check_direction(system: System, motion: BaseMotion) -> None:
    """Raise ModelError if the motion has a component that no driven slide of the base can follow."""
    drive = system.assembly.tables.drive
    reach = np.linalg.pinv(drive) @ drive  # projector onto what the slides span
    for direction in motion.directions:
        missing = direction - reach @ direction
        if np.abs(missing).max() > 1e-9:
            axes = [f"{axis}" for axis, part in zip("xyz", missing, strict=True) if abs(part) > 1e-9]
            joints = [system.model.joint(int(system.model.dof_jntid[dof])).name for dof in system.assembly.driven_dofs]
            base = f"the base {system.base!r}" if system.base else "the base (the world)"
            raise ModelError(
                f"the motion moves along {' and '.join(axes)}, but {base} has no driven slide there. "
                f"Its slides: {joints or 'none'}. Add one to the model, or change the motion's direction."
            )


class _Recorder:
    """Takes the samples of a run, in memory or to a file, and makes the response of them."""

    def __init__(self, system: System, motion: BaseMotion, grid: Grid, out: Path | None) -> None:
        self._system, self._motion, self._times = system, motion, grid.sample_times
        model, assembly = system.model, system.assembly
        self.plan = ColumnPlan(
            bodies=[model.body(body).name for body in assembly.subjects.bodies],
            points=[point_name(model, site) for site in assembly.subjects.points],
            mounts=[(name, _state_names(system, name)) for name in system.mounts],
        )
        self._names = self.plan.names
        self._writer = SampleWriter(out / FILE, self._names) if out is not None else None
        rows = min(STREAM_ROWS, self._times.size) if out is not None else self._times.size
        self._block = np.empty((rows, len(self._names)))
        self._written = 0

    def add(self, sample: int, values: Array) -> None:
        row = sample - self._written
        self._block[row, self.plan.first_sensor :] = values[: len(self._names) - self.plan.first_sensor]
        if self._writer is not None and row == self._block.shape[0] - 1:
            self._writer.write(self._with_base(row + 1))
            self._written += row + 1

    def _with_base(self, rows: int) -> Array:
        times = self._times[self._written : self._written + rows]
        self._block[:rows, 0] = times
        for column, part in enumerate((self._motion.displacement, self._motion.velocity, self._motion.acceleration)):
            self._block[:rows, 1 + 3 * column : 4 + 3 * column] = part(times)
        return self._block[:rows]

    def finish(self, start: State, done: Run, numerics: Numerics) -> Response:
        content = self._metadata(start, done, numerics)
        rest = self._with_base(self._times.size - self._written)
        if self._writer is None:
            return build_response(
                names=self._names, column_reader=lambda names: MemorySamples(names, rest), content=content, path=None
            )
        if rest.size:
            self._writer.write(rest)
        self._writer.close(content)
        return load_response(self._writer.path.parent)

    def _metadata(self, start: State, done: Run, numerics: Numerics) -> dict[str, Any]:
        return response_metadata(
            plan=self.plan,
            peaks=done.peaks,
            scene=scene_of(self._system),
            motion=self._motion.to_dict(),
            events=self._motion.events,
            numerics=numerics,
            initial_state=start,
            final_state=done.final_state,
        )

    def discard(self) -> None:
        if self._writer is not None:
            self._writer.discard()


def _state_names(system: System, mount: str) -> tuple[str, ...]:
    axes = system.mounts[mount].isolator.axes
    return tuple(f"{axis}.{state}" for axis, law in axes.items() if law is not None for state in law.state_names)
