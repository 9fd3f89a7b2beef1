"""Records of the base-isolated building: the table's motion and what six levels did, ordered from the base upwards."""

import json
from dataclasses import dataclass, replace
from pathlib import Path

import numpy as np
import pyarrow.parquet as pq

from verification.case import NotRunError
from wirerope_mj.foundation.arrays import Array

FOLDER, FITTED, LEVELS = "base_isolated_building", "ICA100", 6

QUIET = 0.03
"""Deflection over the largest of a test below which nothing is looked for in a fit."""


@dataclass(frozen=True, kw_only=True)
class Motion:
    """One test.

    Attributes:
        name: of the motion, that of its file.
        time: instants [s], (n_t,), evenly spaced.
        table: acceleration of the table [m/s^2], (n_t,).
        acceleration: absolute, of the levels from the base to the roof [m/s^2], (n_t, 6).
        displacement: of the levels relative to the table [m], (n_t, 6); that of the base is the isolators' deflection.
        source: repository, commit, files and licence.
    """

    name: str
    time: Array
    table: Array
    acceleration: Array
    displacement: Array
    source: str

    def thinned(self, every: int) -> "Motion":
        """Return the strong part of the test, one sample of every few: for fits, which run it hundreds of times.

        From 2 s before the first to 2 s after the last deflection of `QUIET` times the largest.
        """
        moving = np.flatnonzero(np.abs(self.deflection) > QUIET * np.abs(self.deflection).max())
        margin = round(2.0 / self.interval)
        kept = slice(max(0, moving[0] - margin), moving[-1] + margin, every)
        return replace(
            self, time=self.time[kept] - self.time[kept][0], table=self.table[kept], acceleration=self.acceleration[kept],
            displacement=self.displacement[kept],
        )  # fmt: skip

    @property
    def interval(self) -> float:
        """Interval of the samples [s]."""
        return float(self.time[-1] - self.time[0]) / (self.time.size - 1)

    @property
    def deflection(self) -> Array:
        """Deflection of the isolators [m], (n_t,)."""
        return np.asarray(self.displacement[:, 0])

    @property
    def force(self) -> Array:
        """Restoring force of all isolators over the mass above them [m/s^2], of levels of one mass, (n_t,)."""
        return np.asarray(-self.acceleration.mean(axis=1))


def read_motion(path: Path) -> Motion:
    """Read a test; levels are put in the order of their largest displacement, since the roof moves most.

    Raises:
        NotRunError: a column is missing.
    """
    table = pq.read_table(path)
    wanted = ["time_s", "table_acceleration", *(f"{letter}{i}" for letter in "ad" for i in range(1, LEVELS + 1))]
    if missing := [name for name in wanted if name not in table.column_names]:
        raise NotRunError(f"{path}: columns {', '.join(missing)} are missing; it has {', '.join(table.column_names)}")
    columns = {name: table[name].to_numpy().astype(np.float64) for name in wanted}
    acceleration, displacement = (np.column_stack([columns[f"{letter}{i}"] for i in range(1, LEVELS + 1)]) for letter in "ad")
    upwards = np.argsort(np.abs(displacement).max(axis=0))
    source = json.loads((table.schema.metadata or {}).get(b"source", b"{}"))
    return Motion(
        name=path.stem,
        time=columns["time_s"] - columns["time_s"][0],
        table=columns["table_acceleration"],
        acceleration=acceleration[:, upwards],
        displacement=displacement[:, upwards],
        source=" ".join(str(value) for value in source.values()),
    )


def read_motions(folder: Path | None) -> dict[str, Motion]:
    """Read all tests of a folder by name, that which is fitted to first.

    Raises:
        NotRunError: there is no folder, or nothing in it to fit to.
    """
    if folder is None:
        raise NotRunError("no data")
    paths = {path.stem: path for path in sorted((folder / FOLDER).glob("*.parquet"))}
    if FITTED not in paths:
        raise NotRunError(f"no data: {folder / FOLDER} holds no {FITTED}.parquet")
    return {name: read_motion(paths[name]) for name in (FITTED, *(name for name in paths if name != FITTED))}
