"""Names of the sampled columns, and the response's parts that stand behind them."""

from collections.abc import Sequence
from dataclasses import dataclass
from functools import cached_property
from typing import Any

from wirerope_mj.engine.response.histories import (
    BaseResponse,
    BodyResponse,
    ContactResponse,
    MountResponse,
    PointResponse,
    SampledColumns,
)
from wirerope_mj.foundation.summary import ByName
from wirerope_mj.mounts.isolator import AXES

_XYZ = ("x", "y", "z")
_KINEMATICS = (
    ("position", _XYZ),
    ("orientation", ("w", "x", "y", "z")),
    ("velocity", _XYZ),
    ("angular_velocity", _XYZ),
    ("acceleration", _XYZ),
    ("angular_acceleration", _XYZ),
)
_POINT = (*_KINEMATICS, ("relative_displacement", _XYZ))
BASE = ("displacement", "velocity", "acceleration")
CONTACT = ("force", "gap")


@dataclass(frozen=True, kw_only=True)
class ColumnPlan:
    """Meaning of the columns of a response, in the order of the system's sensor values.

    Attributes:
        bodies, points: names.
        mounts: per mount its name and the names of its internal states ("axial.z").
        contacts: names of the pairs of geoms that the model declares.
    """

    bodies: Sequence[str]
    points: Sequence[str]
    mounts: Sequence[tuple[str, tuple[str, ...]]]
    contacts: Sequence[str] = ()

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

    @cached_property
    def _hysteretic(self) -> list[list[list[int]]]:
        """Per mount the positions of the hysteretic forces of roll, shear and axial among its states."""
        axes = [f"{axis}.z" for axis in AXES]
        return [[[i for i, s in enumerate(states) if s.startswith(z)] for z in axes] for _, states in self.mounts]

    @property
    def first_sensor(self) -> int:
        """Column of the first sensor value, after time and base."""
        return 1 + 3 * len(BASE)

    def parts(self, samples: SampledColumns) -> dict[str, Any]:
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
        for (name, states), z in zip(self.mounts, self._hysteretic, strict=True):
            mounts[name] = MountResponse(samples, column, z, states)
            column += 6 + len(states)
        contacts = {
            name: ContactResponse(samples, column + k, len(self.contacts)) for k, name in enumerate(self.contacts)
        }
        groups: dict[str, Any] = {"bodies": bodies, "points": points, "mounts": mounts, "contacts": contacts}
        return {"base": base} | {name: ByName(group) for name, group in groups.items()}


def same_columns(stored: Sequence[str], now: Sequence[str]) -> bool:
    """Return whether stored columns are those that would be sampled now; older ones end before those of contacts."""
    added = now[len(stored) :]
    return list(stored) == list(now[: len(stored)]) and all(name.startswith("contacts/") for name in added)


def _size(parts: Sequence[tuple[str, Sequence[str]]]) -> int:
    return sum(len(components) for _, components in parts)
