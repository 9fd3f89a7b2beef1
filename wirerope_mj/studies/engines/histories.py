"""Histories of many variants: columns of their responses, side by side where that can be, else one system each."""

import os
from collections.abc import Sequence
from typing import Any

import numpy as np

from wirerope_mj.engine.simulation import BatchFailure, simulate_batch
from wirerope_mj.engine.system import System
from wirerope_mj.foundation.arrays import Array
from wirerope_mj.foundation.errors import WireRopeError
from wirerope_mj.motions import BaseMotion
from wirerope_mj.studies.engines.together import histories_together
from wirerope_mj.studies.inputs.variants import Maker, Work


def histories(work: Work, rows: Sequence[dict[str, Any]], columns: Sequence[str]) -> tuple[Array, list[Array | None]]:
    """Return sample instants [s], (n_t,), and columns of variants, (n_t, n_columns); None of one that fails.

    Columns are those of a response, such as "bodies/rack/acceleration/z"; none of the base.
    """
    time, done = histories_together(work, rows, columns, threads=os.cpu_count() or 1)
    found: list[Array | None] = [done.get(index) for index in range(len(rows))]
    make = Maker(work.system, work.motions, work.columns)
    systems: list[System] = []
    motions: list[BaseMotion] = []
    indices: list[int] = []
    for index, row in enumerate(rows):
        if found[index] is not None:
            continue
        try:
            system, motion = make.system(row), make.motion(row)
        except (ValueError, WireRopeError):
            continue
        systems, motions, indices = [*systems, system], [*motions, motion], [*indices, index]
    if systems:
        results = simulate_batch(
            systems, motions, duration=work.duration, timestep=work.timestep, initial=work.initial,
            sample_rate=work.sample_rate, corners=work.corners, responses=True,
        )  # fmt: skip
        for index, result in zip(indices, results, strict=True):
            if not isinstance(result, BatchFailure) and result.response is not None:
                time = result.response.time
                found[index] = np.stack([result.response.column(name) for name in columns], axis=1)
    return time, found
