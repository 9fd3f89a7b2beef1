"""A branch on disk: one Parquet file that grows while the branch is followed, from which an interrupted one resumes."""

import hashlib
import json
from dataclasses import asdict, dataclass
from pathlib import Path
from typing import Any

import numpy as np
import numpy.typing as npt

from wirerope_mj.dynamics.periodic.branch import Bifurcation
from wirerope_mj.dynamics.periodic.continuation import Point
from wirerope_mj.dynamics.periodic.observe import amplitude, body_acceleration
from wirerope_mj.dynamics.periodic.track import Track
from wirerope_mj.engine.system import System
from wirerope_mj.foundation.arrays import Array
from wirerope_mj.foundation.directions import Direction, unit_vector
from wirerope_mj.foundation.errors import RecordError
from wirerope_mj.foundation.parquet_files import read_content, read_table, write_columns

FILE = "branch.parquet"
_KIND = "the table of a branch"
_REMEDY = "Remove it, and the branch is followed anew, or give another folder."
PROGRESS = ("complete", "message", "model_steps", "gaps", "side_branches")
"""What says how far a branch has come, and does not belong to its question."""

_COLUMNS = (
    "frequency", "acceleration", "amplitude", "stable", "neutral", "smoothing_width", "steps", "tangent", "residual"
)  # fmt: skip


@dataclass(frozen=True, kw_only=True)
class Row:
    """A point of a branch; the attributes are those of `Branch`."""

    frequency: float
    acceleration: float
    amplitude: float
    stable: bool
    multipliers: npt.NDArray[np.complex128]
    neutral: int
    unknowns: Array
    smoothing_width: float
    steps: int
    tangent: float
    residual: float


def amplitude_of(system: System, track: Track, payload: str, direction: Direction) -> float:
    """Return the largest absolute acceleration of a payload along a direction over a track [m/s^2]."""
    return amplitude(body_acceleration(system, track, payload) @ unit_vector(direction))


def row_of(system: System, point: Point, payload: str, direction: Direction) -> Row:
    """Return the row of a point: the payload's acceleration is taken along `direction`."""
    drive = point.shot.track.drive
    return Row(
        frequency=drive.frequency,
        acceleration=drive.acceleration,
        amplitude=amplitude_of(system, point.shot.track, payload, direction),
        stable=point.stability.stable,
        multipliers=point.stability.multipliers,
        neutral=point.stability.neutral,
        unknowns=point.shot.x,
        smoothing_width=point.width,
        steps=drive.steps,
        tangent=float(point.tangent[-1]),
        residual=point.shot.residual,
    )


def fingerprint(system: System) -> str:
    """Return a short text that changes with the model, any of its isolators, and what a variant differs by."""
    isolators = {name: isolator.to_dict() for name, isolator in system.isolators.items()}
    content = system.mjcf + json.dumps(isolators, sort_keys=True, default=str)
    content += "".join(json.dumps(changes.to_dict(), sort_keys=True, default=str) for changes in system.changes)
    return hashlib.sha256(content.encode()).hexdigest()[:16]


def save_rows(folder: Path, rows: list[Row], events: list[Bifurcation], content: dict[str, Any]) -> None:
    """Write the points of a branch so far, atomically."""
    try:
        folder.mkdir(parents=True, exist_ok=True)
    except OSError as error:
        raise RecordError(f"{folder}: no folder can be made there ({error.strerror}). Choose another one.") from None
    columns: dict[str, Any] = {name: [getattr(row, name) for row in rows] for name in _COLUMNS}
    columns["multiplier_real"] = [row.multipliers.real for row in rows]
    columns["multiplier_imag"] = [row.multipliers.imag for row in rows]
    columns["unknowns"] = [row.unknowns for row in rows]
    stored = [asdict(event) | {"multiplier": [event.multiplier.real, event.multiplier.imag]} for event in events]
    write_columns(folder / FILE, columns, content | {"bifurcations": stored})


def load_rows(folder: Path, content: dict[str, Any]) -> tuple[list[Row], list[Bifurcation], dict[str, Any]] | None:
    """Return the points of a branch that was begun in `folder`, None if there is none.

    Raises:
        RecordError: what stands there is the branch of another system or of other arguments.
    """
    path = folder / FILE
    if not path.exists():
        return None
    _, stored = read_content(path, kind=_KIND, remedy=_REMEDY)
    table = read_table(path, kind=_KIND, remedy=_REMEDY)
    for key, value in content.items():
        if key in stored and stored[key] != value and key not in PROGRESS:
            raise RecordError(
                f"{path} holds another branch: its {key} is {stored[key]!r}, not {value!r}. Give another folder."
            )
    rows = [
        Row(
            **{name: record[name] for name in _COLUMNS},
            multipliers=np.array(record["multiplier_real"]) + 1j * np.array(record["multiplier_imag"]),
            unknowns=np.array(record["unknowns"]),
        )
        for record in table.to_pylist()
    ]
    events = [
        Bifurcation(**{**event, "multiplier": complex(*event["multiplier"])}) for event in stored.pop("bifurcations")
    ]
    return rows, events, stored
