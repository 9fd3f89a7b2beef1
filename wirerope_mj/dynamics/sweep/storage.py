"""A sweep as one Parquet file: a row per frequency, and everything else in the file's own metadata; a summary beside it."""

import json
from collections.abc import Sequence
from pathlib import Path
from typing import Any

import numpy as np

from wirerope_mj.dynamics.sweep.envelope import AXES, Envelope, FrequencySweep, MountEnvelope
from wirerope_mj.dynamics.sweep.summary import summary
from wirerope_mj.engine.response.storage import SampleWriter
from wirerope_mj.foundation.arrays import Array
from wirerope_mj.foundation.atomic_files import atomic_file
from wirerope_mj.foundation.errors import RecordError
from wirerope_mj.foundation.state import State
from wirerope_mj.mounts.isolator import AXES as MOUNT_AXES

FILE, SUMMARY = "frequency_sweep.parquet", "frequency_sweep.json"
FORMAT = 1
_KEY = b"wirerope_mj"
_FIRST = ("frequency", "base_amplitude", "cycles", "remaining", "settled")

STREAM_ROWS = 4096
"""Rows that are kept before a block is written to disk."""


def column_names(bodies: Sequence[str], mounts: Sequence[str]) -> list[str]:
    """Return the names of the table's columns."""
    names = [*_FIRST, *(f"bodies/{body}/acceleration/{c}" for body in bodies for c in AXES)]
    return names + [f"mounts/{m}/{part}/{c}" for m in mounts for part in ("lowest", "highest") for c in MOUNT_AXES]


class Table:
    """Takes the rows of a sweep, in memory or to a file, and makes the result of them."""

    def __init__(
        self, bodies: Sequence[str], mounts: Sequence[str], out: Path | None, *, replace: bool = False
    ) -> None:
        """Prepare for rows; `out` is the folder to which they are streamed, None to keep them in memory."""
        if out is not None and (out / FILE).exists() and not replace:
            raise RecordError(f"{out}: a sweep stands here already; give another `out`, or remove {FILE}.")
        self._bodies, self._mounts = list(bodies), list(mounts)
        self._writer = SampleWriter(out / FILE, column_names(bodies, mounts)) if out is not None else None
        self._rows: list[Array] = []

    def add(self, rows: Array) -> None:
        """Take rows, (n, n_columns)."""
        self._rows.append(rows)
        if self._writer is not None and sum(block.shape[0] for block in self._rows) >= STREAM_ROWS:
            self._writer.write(np.concatenate(self._rows))
            self._rows.clear()

    def finish(self, content: dict[str, Any]) -> FrequencySweep:
        """Return the result; `content` is what `content_of` returns but for the names."""
        content = {"format": FORMAT, "bodies": self._bodies, "mounts": self._mounts, **content}
        if self._writer is None:
            return _built(np.concatenate(self._rows), content)
        if self._rows:
            self._writer.write(np.concatenate(self._rows))
        self._writer.close(content)
        found = load_sweep(self._writer.path.parent)
        _write_summary(found, self._writer.path.parent)
        return found

    def discard(self) -> None:
        """Leave no half-written file."""
        if self._writer is not None:
            self._writer.discard()


def save_sweep(sweep: FrequencySweep, folder: Path) -> None:
    """Write `sweep` into `folder`, whole or not at all."""
    table = Table(list(sweep.envelopes), list(sweep.mounts), folder, replace=True)
    try:
        table.add(_rows(sweep))
        table.finish(content_of(sweep))
    except BaseException:
        table.discard()
        raise


def load_sweep(folder: Path) -> FrequencySweep:
    """Return the sweep that was written into `folder`."""
    path = folder / FILE
    if not path.is_file():
        raise RecordError(f"{folder}: there is no {FILE} here; `FrequencySweep.save` writes one.")
    try:
        import pyarrow.parquet as pq

        content = json.loads((pq.read_metadata(path).metadata or {})[_KEY])
        if content["format"] != FORMAT:
            raise RecordError(f"{path}: format {content['format']} is not {FORMAT}; use the version that wrote it.")
        columns = pq.read_table(path).columns
        return _built(np.column_stack([column.to_numpy() for column in columns]), content)
    except (OSError, KeyError, ValueError, TypeError):
        raise RecordError(
            f"{path}: this is not a table that `FrequencySweep.save` wrote, or it is damaged. Copy it "
            "again, or compute the sweep again."
        ) from None


def content_of(sweep: FrequencySweep) -> dict[str, Any]:
    """Return everything but the rows as plain values; floats survive bit by bit."""
    parts = ("payload", "response_direction", "excitation", "timestep", "estimated_error", "model_steps")
    states = {part: encoded(getattr(sweep, part)) for part in ("initial_state", "final_state")}
    return {**{part: getattr(sweep, part) for part in parts}, **states, "warnings": list(sweep.warnings)}


def encoded(state: State) -> dict[str, Any]:
    """Return a state as plain values."""
    return {"time": state.time, "values": state.values.tolist()}


def _decoded(content: dict[str, Any]) -> State:
    return State(values=np.array(content["values"]), time=content["time"])


def _rows(sweep: FrequencySweep) -> Array:
    bodies = [envelope.acceleration for envelope in sweep.envelopes.values()]
    mounts = [part for mount in sweep.mounts.values() for part in (mount.minimum, mount.maximum)]
    return np.column_stack([*(getattr(sweep, name) for name in _FIRST), *bodies, *mounts])


def _built(rows: Array, content: dict[str, Any]) -> FrequencySweep:
    """Return the sweep of a table's rows and metadata."""
    vectors = iter(rows[:, len(_FIRST) :].reshape(rows.shape[0], -1, 3).transpose(1, 0, 2))
    first = dict(zip(_FIRST, rows.T, strict=False))
    base = first["base_amplitude"][:, np.newaxis]
    accelerations = {name: next(vectors) for name in content["bodies"]}
    return FrequencySweep(
        frequency=first["frequency"],
        base_amplitude=first["base_amplitude"],
        cycles=first["cycles"],
        remaining=first["remaining"],
        settled=first["settled"] != 0.0,
        envelopes={name: Envelope(acceleration=a, transmissibility=a / base) for name, a in accelerations.items()},
        mounts={name: MountEnvelope(minimum=next(vectors), maximum=next(vectors)) for name in content["mounts"]},
        payload=content["payload"],
        response_direction=content["response_direction"],
        excitation=content["excitation"],
        timestep=content["timestep"],
        estimated_error=content["estimated_error"],
        model_steps=content["model_steps"],
        initial_state=_decoded(content["initial_state"]),
        final_state=_decoded(content["final_state"]),
        warnings=tuple(content["warnings"]),
    )


def _write_summary(sweep: FrequencySweep, folder: Path) -> None:
    with atomic_file(folder / SUMMARY) as beside:
        beside.write_text(json.dumps(summary(sweep), indent=2) + "\n", encoding="utf-8")
