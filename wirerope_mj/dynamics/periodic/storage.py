"""Storage of a branch: its checked options, and its points in a Parquet file from which it is resumed."""

import hashlib
import json
from collections.abc import Sequence
from dataclasses import asdict, dataclass
from pathlib import Path

import numpy as np

from wirerope_mj.dynamics.periodic.branch import Bifurcation, Parameter
from wirerope_mj.dynamics.periodic.continuation import Point
from wirerope_mj.dynamics.periodic.motion import Track, amplitude, body_acceleration, observed_bodies
from wirerope_mj.engine.simulation.simulate import check_direction
from wirerope_mj.engine.statics import History
from wirerope_mj.engine.system import System
from wirerope_mj.foundation.arguments import one_of, positive
from wirerope_mj.foundation.arrays import Array, ComplexArray, Entries
from wirerope_mj.foundation.directions import Direction, checked_direction, direction_text, unit_vector
from wirerope_mj.foundation.errors import RecordError
from wirerope_mj.foundation.parquet_files import read_content, read_table, write_columns
from wirerope_mj.motions import Sine

# Fraction of the base's acceleration below which a payload's acceleration is rounding.
STILL = 1e-12
FILE = "branch.parquet"
_KIND = "the table of a branch"
_REMEDY = "Remove it, and the branch is followed anew, or give another folder."
# Stored keys of a branch's progress, which may differ when it is resumed.
PROGRESS = ("complete", "message", "model_steps", "gaps", "side_branches", "beyond_travel")
COLUMNS = ("frequency", "acceleration", "amplitude", "stable", "neutral", "smoothing_width", "steps", "tangent", "residual")


@dataclass(frozen=True, kw_only=True)
class Row:
    """A point of a branch as it is stored; the attributes are those of `Branch`."""

    frequency: float
    acceleration: float
    amplitude: float
    stable: bool
    multipliers: ComplexArray
    neutral: int
    unknowns: Array
    smoothing_width: float
    steps: int
    tangent: float
    residual: float


@dataclass(frozen=True, kw_only=True)
class BranchOptions:
    """The arguments of `follow_branch`, all checked; `held` is the parameter that stays fixed."""

    parameter: Parameter
    start: float
    stop: float
    held: float
    direction: Direction
    payload: str
    response_direction: Direction
    periods: int
    history: History
    accuracy: float
    smoothing: float | None
    tolerance: float
    largest_step: float
    smallest_step: float
    most_points: int

    @property
    def sign(self) -> float:
        """1 for a rising parameter, -1 for a falling one."""
        return 1.0 if self.stop > self.start else -1.0

    def followed(self, row: Row) -> float:
        return row.frequency if self.parameter == "frequency" else row.acceleration

    def fraction(self, value: float) -> float:
        return float(np.clip(np.log(value / self.start) / np.log(self.stop / self.start), 0.0, 1.0))


def branch_options(
    system: System, *, acceleration: float | None, frequency: float | None, direction: str | Sequence[float],
    payload: str, response_direction: str | Sequence[float] | None, periods: int, most_points: int, history: History,
    smoothing: float | None, **numbers: float,
) -> BranchOptions:  # fmt: skip
    """Check the arguments of `follow_branch`."""
    if (acceleration is None) == (frequency is None):
        raise ValueError("give either `acceleration` (to follow the frequency) or `frequency` (to follow the acceleration).")
    values = {name: positive(name, value) for name, value in numbers.items()}
    if values["start"] == values["stop"]:
        raise ValueError(f"`stop` must differ from `start`, got {values['start']!r} for both; use periodic_orbit instead.")
    check_steps(values["smallest_step"], values["largest_step"])
    one_of("payload", payload, observed_bodies(system))
    moved = checked_direction(direction)
    parameter: Parameter = "frequency" if frequency is None else "acceleration"
    name, value = ("acceleration", acceleration) if frequency is None else ("frequency", frequency)
    held = positive(name, value)
    check_direction(system, Sine(frequency=1.0, acceleration=1.0, direction=moved))
    along = moved if response_direction is None else checked_direction(response_direction, "response_direction")
    return BranchOptions(
        parameter=parameter, held=held, direction=moved, payload=payload, response_direction=along, periods=periods,
        history=history, most_points=most_points, smoothing=None if smoothing is None else positive("smoothing", smoothing),
        **values,
    )  # fmt: skip


def check_steps(smallest: float, largest: float) -> None:
    """Raise ValueError unless smallest < largest < 1 for the relative steps along a branch."""
    if not smallest < largest < 1.0:
        raise ValueError(f"`smallest_step` must be below `largest_step`, and that below 1, got {smallest!r} and {largest!r}.")


def require_motion(amplitude: float, acceleration: float, payload: str, along: Direction) -> None:
    """Raise ValueError if a payload's amplitude [m/s^2] is zero but for rounding of the base's acceleration [m/s^2]."""
    if amplitude <= STILL * abs(acceleration):
        raise ValueError(
            f"`response_direction`: {payload} does not move along {direction_text(along)} in this motion, so there is no "
            "response. Leave it out to take the response along the base's motion, or move the base along it."
        )


def amplitude_of(system: System, track: Track, payload: str, direction: Direction) -> float:
    """Find the largest absolute acceleration of a payload along a direction over a track [m/s^2]."""
    return amplitude(body_acceleration(system, track, payload) @ unit_vector(direction))


def row_of(system: System, point: Point, payload: str, direction: Direction) -> Row:
    """Make the stored row of a point, with the payload's amplitude along `direction`."""
    drive = point.shot.track.drive
    return Row(
        frequency=drive.frequency, acceleration=drive.acceleration,
        amplitude=amplitude_of(system, point.shot.track, payload, direction), stable=point.stability.stable,
        multipliers=point.stability.multipliers, neutral=point.stability.neutral, unknowns=point.shot.x,
        smoothing_width=point.width, steps=drive.steps, tangent=float(point.tangent[-1]), residual=point.shot.residual,
    )  # fmt: skip


def fingerprint(system: System) -> str:
    """Hash model, isolators and changes of a system, to recognise the branch of another system."""
    isolators = {name: isolator.to_dict() for name, isolator in system.isolators.items()}
    content = system.mjcf + json.dumps(isolators, sort_keys=True, default=str)
    content += "".join(json.dumps(changes.to_dict(), sort_keys=True, default=str) for changes in system.changes)
    return hashlib.sha256(content.encode()).hexdigest()[:16]


def save_rows(folder: Path, rows: list[Row], events: list[Bifurcation], content: Entries) -> None:
    try:
        folder.mkdir(parents=True, exist_ok=True)
    except OSError as error:
        raise RecordError(f"{folder}: no folder can be made there ({error.strerror}). Choose another one.") from None
    columns: dict[str, object] = {name: [getattr(row, name) for row in rows] for name in COLUMNS}
    columns["multiplier_real"] = [row.multipliers.real for row in rows]
    columns["multiplier_imag"] = [row.multipliers.imag for row in rows]
    columns["unknowns"] = [row.unknowns for row in rows]
    stored = [asdict(event) | {"multiplier": [event.multiplier.real, event.multiplier.imag]} for event in events]
    write_columns(folder / FILE, columns, content | {"bifurcations": stored})


def load_rows(folder: Path, content: Entries) -> tuple[list[Row], list[Bifurcation], Entries] | None:
    """Read points, events and content of a branch begun in `folder`; None without one, RecordError if its options differ."""
    path = folder / FILE
    if not path.exists():
        return None
    _, stored = read_content(path, kind=_KIND, remedy=_REMEDY)
    table = read_table(path, kind=_KIND, remedy=_REMEDY)
    for key, value in content.items():
        if key in stored and stored[key] != value and key not in PROGRESS:
            raise RecordError(f"{path} holds another branch: its {key} is {stored[key]!r}, not {value!r}. Give another folder.")
    rows = [
        Row(
            **{name: record[name] for name in COLUMNS},
            multipliers=np.array(record["multiplier_real"]) + 1j * np.array(record["multiplier_imag"]),
            unknowns=np.array(record["unknowns"]),
        )
        for record in table.to_pylist()
    ]
    events = [Bifurcation(**{**event, "multiplier": complex(*event["multiplier"])}) for event in stored.pop("bifurcations")]
    return rows, events, stored
