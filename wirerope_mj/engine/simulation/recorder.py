"""The samples of a run on their way into a response."""

from pathlib import Path
from typing import Any

import numpy as np

from wirerope_mj.engine.response.columns import ColumnPlan
from wirerope_mj.engine.response.histories import MemorySamples, Numerics
from wirerope_mj.engine.response.peaks import Peaks
from wirerope_mj.engine.response.response import FILE, Response, response_metadata, response_of
from wirerope_mj.engine.response.storage import load_response
from wirerope_mj.engine.simulation.gaps import Gaps
from wirerope_mj.engine.simulation.grid import TimeGrid
from wirerope_mj.engine.simulation.scene import scene_of
from wirerope_mj.engine.system import System, once_per_system
from wirerope_mj.foundation.arrays import Array
from wirerope_mj.foundation.parquet_files import TableWriter
from wirerope_mj.foundation.state import State
from wirerope_mj.motions import BaseMotion

STREAM_ROWS = 4096  # samples that are kept in memory before a block is written to disk


class Recorder:
    """Takes the samples of a run, in memory or to a file, and makes the response of them."""

    def __init__(self, system: System, motion: BaseMotion, grid: TimeGrid, out: Path | None) -> None:
        """Prepare for the samples of `grid`; `out` is the folder they are streamed to, None to keep them in memory."""
        self._system, self._motion, self._times = system, motion, grid.sample_times
        self.plan = column_plan(system)
        self._names = self.plan.names.copy()
        self._first_gap = len(self._names) - len(self.plan.contacts)
        self._gaps = Gaps(system) if self.plan.contacts else None
        self._writer = TableWriter(out / FILE, self._names) if out is not None else None
        rows = min(STREAM_ROWS, self._times.size) if out is not None else self._times.size
        self._block = np.empty((rows, len(self._names)))
        self._written = 0

    def add(self, first: int, values: Array) -> None:
        """Take the sensor values of samples from number `first` on, (n_samples, n_values); 0 begins all over again."""
        if first == 0 and self._written and self._writer is not None:
            self._writer.discard()
            self._writer, self._written = TableWriter(self._writer.path, self._names), 0
        while len(values):
            row = first - self._written
            some = values[: self._block.shape[0] - row]
            self._block[row : row + len(some), self.plan.first_sensor : self._first_gap] = some
            first, values = first + len(some), values[len(some) :]
            if self._writer is not None and first - self._written == self._block.shape[0]:
                self._writer.write(self._completed(self._block.shape[0]))
                self._written = first

    def _completed(self, rows: int) -> Array:
        """Return the block's first rows with instants, base and gaps."""
        times = self._times[self._written : self._written + rows]
        self._block[:rows, 0] = times
        for column, part in enumerate((self._motion.displacement, self._motion.velocity, self._motion.acceleration)):
            self._block[:rows, 1 + 3 * column : 4 + 3 * column] = part(times)
        if self._gaps is not None:
            sensors = self._block[:rows, self.plan.first_sensor : self._first_gap]
            self._block[:rows, self._first_gap :] = self._gaps.of(sensors)
        return self._block[:rows]

    def finish(self, start: State, final: State, peaks: Peaks, numerics: Numerics) -> Response:
        """Return the response of a run that came to its end."""
        parts: dict[str, Any] = {
            "peaks": peaks,
            "scene": scene_of(self._system),
            "motion": self._motion.to_dict(),
            "events": self._motion.events,
            "numerics": numerics,
            "initial_state": State(values=start.values.copy(), time=start.time),  # others may start from it, too
            "final_state": final,
        }
        rest = self._completed(self._times.size - self._written)
        if self._writer is None:
            return response_of(self.plan, MemorySamples(self._names, rest), **parts)
        if rest.size:
            self._writer.write(rest)
        self._writer.close(response_metadata(plan=self.plan, **parts))
        return load_response(self._writer.path.parent)

    def discard(self) -> None:
        """Leave no half-written file."""
        if self._writer is not None:
            self._writer.discard()


@once_per_system
def column_plan(system: System) -> ColumnPlan:
    """Return the columns that are sampled of a system."""
    subjects = system.assembly.subjects
    return ColumnPlan(
        bodies=subjects.body_names,
        points=subjects.point_names,
        mounts=[(name, _state_names(system, name)) for name in system.mounts],
        contacts=list(system.assembly.contacts),
    )


def _state_names(system: System, mount: str) -> tuple[str, ...]:
    axes = system.mounts[mount].isolator.axes
    return tuple(f"{axis}.{state}" for axis, law in axes.items() if law is not None for state in law.state_names)
