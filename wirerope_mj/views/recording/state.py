"""The exact samples under /state: every Parquet column, float64, bit for bit."""

from pathlib import Path
from typing import Any

import numpy as np
import rerun as rr
from rerun.chunk import RrdReader

from wirerope_mj.engine.response import Response
from wirerope_mj.foundation.arrays import Array
from wirerope_mj.foundation.errors import RecordError
from wirerope_mj.views.recording.paths import TIMELINE, at, entity, root_of

ROOT = "state"


def log_state(rec: Any, response: Response) -> None:
    """Log every column of the response's samples.

    Columns of one kind ("base", "bodies", "points", "mounts", and "time" itself) stand side by side in one entity: each
    entity costs about 20 bytes a row beyond its numbers, which for one per mount would be as much as the view.
    """
    names = list(response.samples.names)
    first = 0
    while first < len(names):
        kind = names[first].split("/")[0]
        last = first + 1
        while last < len(names) and names[last].split("/")[0] == kind:
            last += 1
        rec.log(entity(ROOT, kind), rr.AnyValues(columns=names[first:last], first=first), static=True)
        row = 0
        for values in response.samples.blocks(first, last):  # a long run need not stand in memory, let alone twice
            index = at(response.time[row : row + len(values)])
            rec.send_columns(entity(ROOT, kind), index, rr.Scalars.columns(scalars=np.ascontiguousarray(values)))
            row += len(values)
        first = last


def read_state(path: str | Path, *, run: str = "") -> dict[str, Array]:
    """Return the columns under /state of a recording, (n_t,) each, by name and in the order of `response.parquet`.

    Where it lays several runs over each other, `run` is the name of one.

    Raises:
        RecordError: the file holds none.
    """
    root = root_of(run) + entity(ROOT)
    names: dict[str, tuple[int, list[str]]] = {}
    blocks: dict[str, list[tuple[int, Array]]] = {}
    for chunk in RrdReader(str(path)).stream():
        kind = str(chunk.entity_path).removeprefix(f"{root}/")
        if kind == str(chunk.entity_path):
            continue
        batch = chunk.to_record_batch()
        if "Scalars:scalars" in batch.schema.names:
            column = batch["Scalars:scalars"]
            start = int(batch[TIMELINE].cast("int64")[0].as_py())
            blocks.setdefault(kind, []).append((start, column.flatten().to_numpy().reshape(len(column), -1)))
        elif "columns" in batch.schema.names:
            names[kind] = (batch["first"].flatten()[0].as_py(), batch["columns"].flatten().to_pylist())
    if not blocks or set(blocks) != set(names):
        raise RecordError(f"{path}: there are no samples under {root} here; record the response again.")
    arrays = {
        kind: np.concatenate([values for _, values in sorted(parts, key=lambda part: part[0])])
        for kind, parts in blocks.items()
    }
    kinds = sorted(names, key=lambda kind: names[kind][0])
    return {name: arrays[kind][:, n] for kind in kinds for n, name in enumerate(names[kind][1])}
