"""A branch on disk: one Parquet file that grows while the branch is followed, from which an interrupted one goes on."""

import hashlib
import json
from dataclasses import asdict
from pathlib import Path
from typing import Any

import numpy as np

from wirerope_mj.dynamics.periodic.branch import Bifurcation
from wirerope_mj.dynamics.periodic.rows import Row
from wirerope_mj.engine.system import System
from wirerope_mj.foundation.atomic_files import atomic_file
from wirerope_mj.foundation.errors import RecordError

FILE = "branch.parquet"
_KEY = b"wirerope_mj"


def fingerprint(system: System) -> str:
    """Return a short text that changes with the model, any of its isolators, and what a variant differs by."""
    isolators = {name: isolator.to_dict() for name, isolator in system.isolators.items()}
    content = system.mjcf + json.dumps(isolators, sort_keys=True, default=str)
    content += "".join(json.dumps(changes.to_dict(), sort_keys=True, default=str) for changes in system.changes)
    return hashlib.sha256(content.encode()).hexdigest()[:16]


def save_rows(folder: Path, rows: list[Row], events: list[Bifurcation], content: dict[str, Any]) -> None:
    """Write the points of a branch so far, whole or not at all."""
    import pyarrow as pa
    import pyarrow.parquet as pq

    try:
        folder.mkdir(parents=True, exist_ok=True)
    except OSError as error:
        raise RecordError(f"{folder}: no folder can be made there ({error.strerror}). Choose another one.") from None
    columns: dict[str, Any] = {
        name: [getattr(row, name) for row in rows]
        for name in (
            "frequency",
            "acceleration",
            "amplitude",
            "stable",
            "neutral",
            "smoothing_width",
            "steps",
            "tangent",
            "residual",
        )
    }
    columns["multiplier_real"] = [row.multipliers.real for row in rows]
    columns["multiplier_imag"] = [row.multipliers.imag for row in rows]
    columns["unknowns"] = [row.unknowns for row in rows]
    noted = [asdict(event) | {"multiplier": [event.multiplier.real, event.multiplier.imag]} for event in events]
    metadata = {_KEY: json.dumps(content | {"bifurcations": noted}).encode()}
    with atomic_file(folder / FILE) as beside:
        pq.write_table(pa.table(columns).replace_schema_metadata(metadata), beside)


def load_rows(folder: Path, content: dict[str, Any]) -> tuple[list[Row], list[Bifurcation], dict[str, Any]] | None:
    """Return the points of a branch that was begun in `folder`, None if there is none.

    Raises:
        RecordError: what stands there is the branch of another system or another question.
    """
    import pyarrow.parquet as pq

    path = folder / FILE
    if not path.exists():
        return None
    try:
        table = pq.read_table(path)
        stored = json.loads(table.schema.metadata[_KEY])
    except Exception:  # the words of pyarrow and JSON say what byte is wrong, and of no use to a user
        raise RecordError(
            f"{path}: this is not the table of a branch, or it is damaged. Remove it, and "
            "the branch is followed anew, or give another folder."
        ) from None
    for key, value in content.items():
        if key in stored and stored[key] != value and key not in ("complete", "message", "model_steps", "gaps"):
            raise RecordError(
                f"{path} holds another branch: its {key} is {stored[key]!r}, asked is {value!r}. Give another folder."
            )
    rows = [
        Row(
            **{name: record[name] for name in Row.__dataclass_fields__ if name in record and name != "unknowns"},
            multipliers=np.array(record["multiplier_real"]) + 1j * np.array(record["multiplier_imag"]),
            unknowns=np.array(record["unknowns"]),
        )
        for record in table.to_pylist()
    ]
    events = [
        Bifurcation(**{**event, "multiplier": complex(*event["multiplier"])}) for event in stored.pop("bifurcations")
    ]
    return rows, events, stored
