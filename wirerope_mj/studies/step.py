"""The step that all variants of a study take, chosen once before it starts."""

from collections.abc import Sequence
from typing import Any

import numpy as np
import numpy.typing as npt
import pyarrow as pa

from wirerope_mj.engine.simulation.initial import initial_state
from wirerope_mj.engine.simulation.timestep import choose_timestep
from wirerope_mj.engine.system import System
from wirerope_mj.studies.inputs.quantities import Column
from wirerope_mj.studies.inputs.variants import Maker


def common_step(
    system: System,
    maker: Maker,
    columns: Sequence[Column],
    inputs: pa.Table,
    *,
    initial: str,
    duration: float,
    sample_rate: float,
    accuracy: float,
) -> float:
    """Return the smallest of the steps that `simulate` chooses for the nominal system under the study's extreme motions [s].

    Of every record that is the motion of the highest level; if the direction varies, the motions that reach farthest along x,
    y and z.
    """
    steps = []
    for place in _extremes(columns, inputs):
        motion = maker.motion(inputs.slice(place, 1).to_pylist()[0])
        start = initial_state(system, motion, initial)
        chosen = choose_timestep(
            system, motion, start, duration=duration, sample_rate=sample_rate, accuracy=accuracy
        )  # fmt: skip
        steps.append(chosen.timestep)
    return min(steps)


def _extremes(columns: Sequence[Column], inputs: pa.Table) -> list[int]:
    """Return the places of the rows with the extreme motions."""
    values: dict[str, npt.NDArray[Any]] = {
        column.kind: np.asarray(inputs[column.name]) for column in columns if not column.targets
    }
    size = np.abs(values.get("level", np.ones(inputs.num_rows)))
    record = values.get("record", np.zeros(inputs.num_rows, dtype=np.int64))
    reaches = [size]
    if {"azimuth", "elevation"} & set(values):
        a, e = (np.radians(values.get(name, np.zeros(size.size))) for name in ("azimuth", "elevation"))
        reaches = [size * np.abs(part) for part in (np.cos(e) * np.cos(a), np.cos(e) * np.sin(a), np.sin(e))]
    found = []
    for number in np.unique(record):
        own = np.flatnonzero(record == number)
        found += [int(own[np.argmax(reach[own])]) for reach in reaches]
    return list(dict.fromkeys(found))
