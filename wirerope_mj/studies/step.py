"""The step that all variants of a study take, chosen once before it starts."""

from collections.abc import Sequence

import numpy as np
import pyarrow as pa

from wirerope_mj.engine.simulation.stepper import initial_state
from wirerope_mj.engine.simulation.timestep import choose_timestep
from wirerope_mj.engine.system import System
from wirerope_mj.studies.inputs.column import InputColumn
from wirerope_mj.studies.inputs.motion_columns import MotionSettings
from wirerope_mj.studies.inputs.variants import Maker


def common_step(
    system: System,
    maker: Maker,
    columns: Sequence[InputColumn],
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
    for row in _extremes(columns, inputs):
        motion = maker.motion(inputs.slice(row, 1).to_pylist()[0])
        start = initial_state(system, motion, initial)
        chosen = choose_timestep(
            system, motion, start, duration=duration, sample_rate=sample_rate, accuracy=accuracy
        )  # fmt: skip
        steps.append(chosen.timestep)
    return min(steps)


def _extremes(columns: Sequence[InputColumn], inputs: pa.Table) -> list[int]:
    """Return the indices of the rows with the extreme motions."""
    settings = MotionSettings.of(columns, {name: np.asarray(inputs[name]) for name in inputs.column_names})
    size = np.broadcast_to(np.abs(1.0 if settings.level is None else settings.level), inputs.num_rows)
    record = np.broadcast_to(settings.record, inputs.num_rows)
    reaches = [size]
    if settings.turns:
        a, e = (np.radians(0.0 if one is None else one) for one in (settings.azimuth, settings.elevation))
        axes = (np.cos(e) * np.cos(a), np.cos(e) * np.sin(a), np.sin(e))
        reaches = [size * np.abs(axis) for axis in axes]
    rows = []
    for number in np.unique(record):
        own = np.flatnonzero(record == number)
        rows += [int(own[np.argmax(reach[own])]) for reach in reaches]
    return list(dict.fromkeys(rows))
