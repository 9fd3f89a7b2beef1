"""Rows of a sweep's table from the extremes of cycles, in memory or streamed to a file."""

from pathlib import Path
from typing import Any, Self

import numpy as np

from wirerope_mj.dynamics.sweep.channels import Channels
from wirerope_mj.dynamics.sweep.envelope import FILE, FORMAT, FrequencySweep, column_names, load_frequency_sweep
from wirerope_mj.dynamics.sweep.travel import TravelWatch
from wirerope_mj.engine.system import System
from wirerope_mj.foundation.arrays import Array
from wirerope_mj.foundation.directions import Direction, unit_vector
from wirerope_mj.foundation.errors import RecordError
from wirerope_mj.foundation.parquet_files import TableWriter
from wirerope_mj.foundation.state import State

STREAM_ROWS = 4096
"""Rows that are kept before a block is written to disk."""


class Collector:
    """Takes the extremes at frequency after frequency, in memory or to a file, and makes the result of them."""

    def __init__(self, system: System, *, direction: Direction, out: str | Path | None) -> None:
        """Prepare for an excitation along `direction`; `out` is the folder that the table goes to, if any."""
        self._steps, self._largest_step = 0, 0.0
        self._channels = Channels.of(system)
        unit = np.abs(unit_vector(direction))
        self._along = int(np.argmax(unit))  # the component that moves most stands for the whole of a straight motion
        self._component = float(unit[self._along])
        self._watch = TravelWatch(system)
        self._mounts, self._rows, self._writer = list(system.mounts), list[Array](), None
        if out is None:
            return
        if (Path(out) / FILE).exists():
            raise RecordError(f"{out}: a sweep stands here already; give another `out`, or remove {FILE}.")
        self._writer = TableWriter(Path(out) / FILE, column_names(self._channels.names, self._mounts))

    def __enter__(self) -> Self:
        return self

    def __exit__(self, kind: type[BaseException] | None, *_: object) -> None:
        if kind is not None and self._writer is not None:
            self._writer.discard()  # no half-written file

    def count(self, steps: int, largest_step: float) -> None:
        """Take a number of steps, and the largest of them [s]."""
        self._steps, self._largest_step = self._steps + steps, max(self._largest_step, largest_step)

    def add(
        self, frequency: Array, minimum: Array, maximum: Array, *, cycles: int, remaining: float, settled: bool
    ) -> None:
        """Take extremes of all channels, (n, n_channels, 3), at frequencies [Hz], (n,), and what they have in common."""
        on = self._channels
        self._watch.add(frequency, minimum[:, on.mounts], maximum[:, on.mounts])
        largest = np.maximum(maximum, -minimum)
        deflections = np.stack([minimum[:, on.mounts], maximum[:, on.mounts]], axis=2)  # (n, n_mounts, 2, 3)
        base = largest[:, on.base, self._along] / self._component
        common = np.broadcast_to([cycles, remaining, settled], (frequency.size, 3))
        vectors = [largest[:, on.bodies].reshape(frequency.size, -1), deflections.reshape(frequency.size, -1)]
        self._rows.append(np.column_stack([frequency, base, common, *vectors]))
        if self._writer is not None and sum(block.shape[0] for block in self._rows) >= STREAM_ROWS:
            self._writer.write(np.concatenate(self._rows))
            self._rows.clear()

    def finish(
        self,
        *,
        payload: str,
        response_direction: str,
        excitation: dict[str, Any],
        error: float,
        initial_state: State,
        final_state: State,
        warnings: tuple[str, ...],
    ) -> FrequencySweep:
        """Return the result; `error` is the one that was estimated for the step, `warnings` go before those of travel."""
        content = {
            "format": FORMAT,
            "bodies": list(self._channels.names),
            "mounts": self._mounts,
            "payload": payload,
            "response_direction": response_direction,
            "excitation": excitation,
            "timestep": self._largest_step,
            "estimated_error": error,
            "model_steps": self._steps,
            "initial_state": initial_state.to_plain(),
            "final_state": final_state.to_plain(),
            "warnings": [*warnings, *self._watch.warnings()],
        }
        if self._writer is None:
            return FrequencySweep.of_rows(np.concatenate(self._rows), content)
        if self._rows:
            self._writer.write(np.concatenate(self._rows))
        self._writer.close(content)
        sweep = load_frequency_sweep(self._writer.path.parent)
        sweep.save_summary(self._writer.path.parent)
        return sweep
