"""A frequency response as two Parquet files: one row for every point of the branches, and one for every row of the sweeps."""

from pathlib import Path
from typing import Any

import numpy as np
import numpy.typing as npt

from wirerope_mj.dynamics.frequency_response.result import FrequencyResponse, Level
from wirerope_mj.dynamics.periodic import Branch
from wirerope_mj.dynamics.sweep import FrequencySweep
from wirerope_mj.foundation.parquet_files import write_columns
from wirerope_mj.mounts.isolator import AXES

Array = npt.NDArray[Any]

BRANCHES, SWEEPS = "branches.parquet", "sweeps.parquet"


def save_tables(result: FrequencyResponse, folder: Path) -> None:
    """Write the tables of what was computed into `folder`; SI units, float64."""
    if result.branches:
        width = max(branch.floquet_multipliers.shape[1] for branch in result.branches)
        levels = [(n, level) for n, level in enumerate(result.levels) if level.branch is not None]
        _write(folder / BRANCHES, [_branch_columns(n, level, width) for n, level in levels])
    sweeps = [
        _sweep_columns(n, level, direction, sweep)
        for n, level in enumerate(result.levels)
        for direction, sweep in level.sweeps.items()
    ]
    if sweeps:
        _write(folder / SWEEPS, sweeps)


def _write(path: Path, tables: list[dict[str, Array]]) -> None:
    write_columns(path, {name: np.concatenate([table[name] for table in tables]) for name in tables[0]})


def _branch_columns(number: int, level: Level, width: int) -> dict[str, Array]:
    """Return the columns of a branch; `width` multipliers, NaN where it has fewer."""
    branch = level.branch
    assert branch is not None
    n = branch.frequency.size
    multipliers = np.full((n, width), complex(np.nan, np.nan))
    multipliers[:, : branch.floquet_multipliers.shape[1]] = branch.floquet_multipliers
    columns: dict[str, Array] = {
        "level": np.full(n, number),
        "point": np.arange(n),
        "frequency": branch.frequency,
        "acceleration": branch.acceleration,
        "amplitude": branch.amplitude,
        "transmissibility": branch.transmissibility,
        "stable": branch.stable,
        "neutral": branch.neutral,
        "residual": branch.residual,
        "steps": branch.steps,
        "smoothing_width": branch.smoothing_width,
        "bifurcation": np.array(_bifurcations(branch), dtype=object),
    }
    for i in range(width):
        columns[f"multiplier_{i + 1}/re"] = multipliers[:, i].real
        columns[f"multiplier_{i + 1}/im"] = multipliers[:, i].imag
    columns |= {f"unknown/{i}": branch.unknowns[:, i] for i in range(branch.unknowns.shape[1])}
    return columns


def _bifurcations(branch: Branch) -> list[str]:
    texts = [""] * branch.frequency.size
    for event in branch.bifurcations:
        texts[event.index] = event.description
    return texts


def _sweep_columns(number: int, level: Level, direction: str, sweep: FrequencySweep) -> dict[str, Array]:
    n = sweep.frequency.size
    columns: dict[str, Array] = {
        "level": np.full(n, number),
        "way": np.array([direction] * n, dtype=object),
        "frequency": sweep.frequency,
        "acceleration": np.full(n, level.acceleration),
        "base_amplitude": sweep.base_amplitude,
        "amplitude": sweep.amplitude,
        "transmissibility": sweep.transmissibility,
    }
    for body, envelope in sweep.envelopes.items():
        columns |= {f"bodies/{body}/acceleration/{c}": envelope.acceleration[:, i] for i, c in enumerate("xyz")}
    for name, mount in sweep.mounts.items():
        for extreme, values in (("lowest", mount.minimum), ("highest", mount.maximum)):
            columns |= {f"mounts/{name}/{extreme}/{c}": values[:, i] for i, c in enumerate(AXES)}
    return columns
