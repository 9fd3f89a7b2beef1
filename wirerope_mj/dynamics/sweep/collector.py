"""From the extremes of cycles to the rows of a sweep's table."""

from pathlib import Path
from typing import Any, Self

import numpy as np

from wirerope_mj.dynamics.sweep.channels import Channels
from wirerope_mj.dynamics.sweep.envelope import FrequencySweep
from wirerope_mj.dynamics.sweep.storage import Table, encoded
from wirerope_mj.dynamics.sweep.travel import TravelWatch
from wirerope_mj.engine.system import System
from wirerope_mj.foundation.arrays import Array
from wirerope_mj.foundation.directions import Direction, unit_vector
from wirerope_mj.foundation.state import State


class Collector:
    """Takes what the tracker saw at frequency after frequency and makes the result of it."""

    def __init__(self, system: System, *, direction: Direction, out: str | Path | None) -> None:
        """Prepare for an excitation along `direction`; `out` is the folder that the table goes to, if any."""
        self._steps, self._largest_step = 0, 0.0
        self._channels = Channels.of(system)
        unit = np.abs(unit_vector(direction))
        self._along = int(np.argmax(unit))  # the component that moves most stands for the whole of a straight motion
        self._share = float(unit[self._along])
        self._watch = TravelWatch(system)
        self._table = Table(self._channels.names, list(system.mounts), None if out is None else Path(out))

    def __enter__(self) -> Self:
        return self

    def __exit__(self, kind: type[BaseException] | None, *_: object) -> None:
        if kind is not None:
            self._table.discard()  # no half-written file

    def count(self, steps: int, largest_step: float) -> None:
        """Take how many steps were made, and the largest of them [s]."""
        self._steps, self._largest_step = self._steps + steps, max(self._largest_step, largest_step)

    def add(
        self, frequency: Array, minimum: Array, maximum: Array, *, cycles: int, remaining: float, settled: bool
    ) -> None:
        """Take extremes of all channels, (n, n_channels, 3), at frequencies [Hz], (n,), and what is alike for all of them."""
        on = self._channels
        self._watch.add(frequency, minimum[:, on.mounts], maximum[:, on.mounts])
        largest = np.maximum(maximum, -minimum)
        deflections = np.stack([minimum[:, on.mounts], maximum[:, on.mounts]], axis=2)  # (n, n_mounts, 2, 3)
        base = largest[:, on.base, self._along] / self._share
        alike = np.broadcast_to([cycles, remaining, settled], (frequency.size, 3))
        rows = [largest[:, on.bodies].reshape(frequency.size, -1), deflections.reshape(frequency.size, -1)]
        self._table.add(np.column_stack([frequency, base, alike, *rows]))

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
        return self._table.finish(
            {
                "payload": payload,
                "response_direction": response_direction,
                "excitation": excitation,
                "timestep": self._largest_step,
                "estimated_error": error,
                "model_steps": self._steps,
                "initial_state": encoded(initial_state),
                "final_state": encoded(final_state),
                "warnings": [*warnings, *self._watch.warnings()],
            }
        )
