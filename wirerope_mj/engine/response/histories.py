"""Time histories of base, bodies, points and mounts as sampled columns, in memory or in a file, and how they were computed."""

import math
from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from functools import cached_property
from typing import Annotated, Protocol

import numpy as np

from wirerope_mj.foundation.arrays import AnyArray, Array, Entries
from wirerope_mj.foundation.exports import Exported
from wirerope_mj.foundation.structure import UNKNOWN, Positive, bounds
from wirerope_mj.foundation.summary import Brief, ByName, Summarised
from wirerope_mj.mounts.isolator import AXES

# what limits the steps of a run whose error estimate is the spread of several steps
SENSITIVE = "what it hits: the answer is sensitive, and finer steps do not agree better"
# rows of samples that are handed on at once where a long response must not stand in memory as a whole
BLOCK_ROWS = 1 << 16
BLOCK_NUMBERS = 1 << 22  # numbers that are handed on at once: of hundreds of columns fewer rows
_XYZ = ("x", "y", "z")
_KINEMATICS = (
    ("position", _XYZ), ("orientation", ("w", "x", "y", "z")), ("velocity", _XYZ), ("angular_velocity", _XYZ),
    ("acceleration", _XYZ), ("angular_acceleration", _XYZ),
)  # fmt: skip
_POINT = (*_KINEMATICS, ("relative_displacement", _XYZ))
BASE = ("displacement", "velocity", "acceleration")
CONTACT = ("force", "gap")
_UNITS = {
    "position": "m", "velocity": "m/s", "acceleration": "m/s^2", "displacement": "m", "relative_displacement": "m",
    "angular_velocity": "rad/s", "angular_acceleration": "rad/s^2", "deflection": "m", "force": "N", "gap": "m",
}  # fmt: skip


def block_rows(columns: int) -> int:
    """Return the number of rows to be read at once from so many columns."""
    return min(BLOCK_ROWS, max(1, BLOCK_NUMBERS // max(columns, 1)))


class SampledColumns(Protocol):
    """Sampled columns, in memory or in a file."""

    @property
    def names(self) -> list[str]:
        """Names of the columns."""
        ...

    def columns(self, first: int, last: int) -> Array:
        """Return columns `first` to `last` (exclusive), (n_t, last - first)."""
        ...

    def blocks(self, first: int, last: int) -> Iterator[Array]:
        """Yield columns `first` to `last` (exclusive) in blocks of at most `block_rows` rows."""
        ...


@dataclass(frozen=True)
class MemorySamples:
    """Samples in memory: `values` (n_t, n_columns)."""

    names: list[str]
    values: Array

    def columns(self, first: int, last: int) -> Array:
        return self.values[:, first:last]

    def blocks(self, first: int, last: int) -> Iterator[Array]:
        rows = block_rows(last - first)
        for row in range(0, self.values.shape[0], rows):
            yield self.values[row : row + rows, first:last]


@dataclass(frozen=True, repr=False)
class _Columns(Summarised):
    """Sampled columns of a part of a response, from column `first` on; each quantity is read at first use."""

    samples: SampledColumns
    first: int

    def _summary(self) -> tuple[str, dict[str, str]]:
        kinds = {name: part for base in reversed(type(self).__mro__) for name, part in vars(base).items()}
        parts = {name: part for name, part in kinds.items() if isinstance(part, cached_property)}
        lines = {name: str(part.__doc__).partition(":")[0].rstrip(".") for name, part in parts.items()}
        return type(self).__name__, lines

    def _part(self, offset: int, size: int) -> Array:
        return self.samples.columns(self.first + offset, self.first + offset + size)


def _columns(offset: int, size: int, text: str) -> "cached_property[Array]":
    """Make a property that reads `size` columns of a part from `offset` on; `text` is its docstring."""
    values = cached_property(lambda part: part._part(offset, size))
    values.__doc__ = text
    return values


class BodyResponse(_Columns):
    """Motion of a body at its own centre of mass, world frame."""

    position = _columns(0, 3, "Position [m], (n_t, 3).")
    orientation = _columns(3, 4, "Orientation, quaternion w first, (n_t, 4).")
    velocity = _columns(7, 3, "Velocity [m/s], (n_t, 3).")
    angular_velocity = _columns(10, 3, "Angular velocity [rad/s], (n_t, 3).")
    acceleration = _columns(13, 3, "Coordinate acceleration, 0 at rest under gravity [m/s^2], (n_t, 3).")
    angular_acceleration = _columns(16, 3, "Angular acceleration [rad/s^2], (n_t, 3).")


class PointResponse(BodyResponse):
    """Motion of a site, world frame."""

    relative_displacement = _columns(19, 3, "Displacement from the modelled geometry relative to the base [m], (n_t, 3).")


@dataclass(frozen=True, repr=False)
class MountResponse(_Columns):
    """Deflection, force and internal states of a mount in its axes roll, shear, axial."""

    hysteretic: list[list[int]]  # positions of the hysteretic forces of roll, shear, axial among the states
    state_names: tuple[str, ...]

    deflection = _columns(0, 3, "Payload site minus base site, axial positive in tension [m], (n_t, 3).")
    force = _columns(3, 3, "Restoring force, positive in tension [N], (n_t, 3).")

    @cached_property
    def hysteretic_state(self) -> Array:
        """Hysteretic state z [N], (n_t, 3): the sum of an axis' hysteretic forces, zero for an axis without one."""
        states = self._part(6, len(self.state_names))
        return np.stack([states[:, positions].sum(axis=1) for positions in self.hysteretic], axis=1)

    @cached_property
    def internal_states(self) -> dict[str, Array]:
        """Every internal state by name ("axial.z"), (n_t,)."""
        states = self._part(6, len(self.state_names))
        return {name: states[:, i] for i, name in enumerate(self.state_names)}


@dataclass(frozen=True, repr=False)
class ContactResponse(_Columns):
    """Force and gap of a pair of geoms that the model declares; the forces of all such pairs stand before their gaps."""

    n_pairs: int

    @cached_property
    def force(self) -> Array:
        """Normal force of all contact points together [N], (n_t,)."""
        return self._part(0, 1)[:, 0]

    @cached_property
    def gap(self) -> Array:
        """Gap between the two [m], negative where they are pressed into each other, (n_t,)."""
        return self._part(self.n_pairs, 1)[:, 0]


@dataclass(frozen=True, kw_only=True, repr=False)
class BaseResponse(Brief):
    """Motion of the base, from the closed form that drove it; right-hand limits at jumps.

    displacement [m], velocity [m/s], acceleration [m/s^2], world frame, (n_t, 3) each.
    """

    displacement: Array
    velocity: Array
    acceleration: Array


@dataclass(frozen=True, kw_only=True)
class Numerics:
    """Numerical settings of a response, and their estimated error."""

    timestep: Positive  # largest step [s]
    accuracy: Annotated[float, bounds(gt=0.0), UNKNOWN]  # error allowed, relative to the peaks; NaN where the step was given
    # error of samples and peaks estimated by step halving before the run; NaN where the step was given
    error_estimate: Annotated[float, bounds(ge=0.0), UNKNOWN]
    steps: Annotated[int, bounds(ge=0)]  # number of steps
    callback: str  # "native" or "python"
    versions: dict[str, str]  # of the packages that computed it
    limited_by: str = ""  # what keeps the step from being longer; "" for older responses, which do not say it
    engine: str = "mujoco"  # "kernel" or "mujoco"
    why: str = ""  # why it was not the kernel; "" for older responses, which knew none
    # instant at which the motion is over [s]; NaN if it has no end, and for older responses
    motion_end: Annotated[float, UNKNOWN] = math.nan
    # of the slowest mode for small amplitudes [s]; NaN for older responses
    slowest_period: Annotated[float, bounds(gt=0.0), UNKNOWN] = math.nan

    @property
    def error_text(self) -> str:
        """Sentence on the accuracy of samples and peaks."""
        if self.limited_by == SENSITIVE:
            return f"sensitive: runs with finer steps differ by up to {self.error_estimate:.1e} of the peaks"
        if math.isfinite(self.error_estimate):
            missed = f", above the {self.accuracy:.0e} asked for" if self.error_estimate > self.accuracy else ""
            return f"estimated error {self.error_estimate:.1e} of the peaks{missed}"
        not_estimated = math.isnan(self.accuracy)
        return "step given: no error estimated" if not_estimated else "no error estimated: halving the step changes nothing"

    @property
    def computed_by(self) -> str:
        """Name of the engine that computed the response, "the kernel" or "MuJoCo, native callback"."""
        return "the kernel" if self.engine == "kernel" else f"MuJoCo, {self.callback} callback"


@dataclass(frozen=True, kw_only=True)
class ColumnPlan:
    """Meaning of the columns of a response, in the order of the system's sensor values."""

    bodies: Sequence[str]  # names
    points: Sequence[str]
    mounts: Sequence[tuple[str, tuple[str, ...]]]  # per mount its name and the names of its internal states ("axial.z")
    contacts: Sequence[str] = ()  # names of the pairs of geoms that the model declares

    @cached_property
    def names(self) -> list[str]:
        """Column names: time, base, bodies, points, mounts, contacts."""
        names = ["time"]
        names += [f"base/{part}/{c}" for part in BASE for c in _XYZ]
        for group, members, parts in (("bodies", self.bodies, _KINEMATICS), ("points", self.points, _POINT)):
            names += [f"{group}/{m}/{part}/{c}" for m in members for part, cs in parts for c in cs]
        for mount, states in self.mounts:
            names += [f"mounts/{mount}/{part}/{c}" for part in ("deflection", "force") for c in AXES]
            names += [f"mounts/{mount}/state/{state}" for state in states]
        names += [f"contacts/{pair}/{part}" for part in CONTACT for pair in self.contacts]
        return names

    @property
    def first_sensor(self) -> int:
        """Column of the first sensor value, after time and base."""
        return 1 + 3 * len(BASE)

    def parts(self, samples: SampledColumns) -> Entries:
        """Return base, bodies, points, mounts and contacts of a response whose columns are `samples`, by their names."""
        moved = samples.columns(1, self.first_sensor)
        base = BaseResponse(displacement=moved[:, 0:3], velocity=moved[:, 3:6], acceleration=moved[:, 6:9])
        column = self.first_sensor
        bodies, points, mounts = {}, {}, {}
        for name in self.bodies:
            bodies[name] = BodyResponse(samples, column)
            column += _size(_KINEMATICS)
        for name in self.points:
            points[name] = PointResponse(samples, column)
            column += _size(_POINT)
        for name, states in self.mounts:
            z = [[i for i, state in enumerate(states) if state.startswith(f"{axis}.z")] for axis in AXES]
            mounts[name] = MountResponse(samples, column, z, states)
            column += 6 + len(states)
        n = len(self.contacts)
        contacts = {name: ContactResponse(samples, column + k, n) for k, name in enumerate(self.contacts)}
        groups: dict[str, Entries] = {"bodies": bodies, "points": points, "mounts": mounts, "contacts": contacts}
        return {"base": base} | {name: ByName(group) for name, group in groups.items()}


def same_columns(stored: Sequence[str], now: Sequence[str]) -> bool:
    """Tell whether stored columns are those sampled today; older files end before the contacts."""
    added = now[len(stored) :]
    return list(stored) == list(now[: len(stored)]) and all(name.startswith("contacts/") for name in added)


def _size(parts: Sequence[tuple[str, Sequence[str]]]) -> int:
    return sum(len(components) for _, components in parts)


def exported_samples(samples: SampledColumns, about: dict[str, str]) -> Exported:
    """Return the samples as a table whose columns have the names of response.parquet."""
    names = samples.names

    def blocks() -> Iterator[Sequence[AnyArray]]:
        for block in samples.blocks(0, len(names)):
            yield list(block.T)

    return Exported(
        names=names, units=[unit_of(name) for name in names],
        column=lambda number: samples.columns(number, number + 1)[:, 0], blocks=blocks, about=about,
    )  # fmt: skip


def unit_of(name: str) -> str:
    """Return the unit of a column; internal states have the unit of the hysteretic force."""
    parts = name.split("/")
    if name == "time":
        return "s"
    if parts[-2:-1] == ["state"]:
        return "N" if ".z" in parts[-1] else ""
    return next((_UNITS[part] for part in reversed(parts) if part in _UNITS), "")
