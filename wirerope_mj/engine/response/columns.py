"""Names of the sampled columns, and the response's parts that stand behind them."""

from collections.abc import Sequence
from dataclasses import dataclass
from functools import cached_property

from wirerope_mj.engine.response.histories import (
    BaseResponse,
    BodyResponse,
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


@dataclass(frozen=True, kw_only=True)
class ColumnPlan:
    """Meaning of the columns of a response, in the order of the system's sensor values.

    Attributes:
        bodies, points: names.
        mounts: per mount its name and the names of its internal states ("axial.z").
    """

    bodies: Sequence[str]
    points: Sequence[str]
    mounts: Sequence[tuple[str, tuple[str, ...]]]

    @cached_property
    def names(self) -> list[str]:
        """Column names: time, base, bodies, points, mounts."""
        names = ["time"]
        names += [f"base/{part}/{c}" for part in BASE for c in _XYZ]
        for group, members, parts in (("bodies", self.bodies, _KINEMATICS), ("points", self.points, _POINT)):
            names += [f"{group}/{m}/{part}/{c}" for m in members for part, cs in parts for c in cs]
        for mount, states in self.mounts:
            names += [f"mounts/{mount}/{part}/{c}" for part in ("deflection", "force") for c in AXES]
            names += [f"mounts/{mount}/state/{state}" for state in states]
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

    def parts(
        self, samples: SampledColumns
    ) -> tuple[BaseResponse, dict[str, BodyResponse], dict[str, PointResponse], dict[str, MountResponse]]:
        """Return base, bodies, points and mounts of a response whose columns are `samples`."""
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
        return base, ByName(bodies), ByName(points), ByName(mounts)


def _size(parts: Sequence[tuple[str, Sequence[str]]]) -> int:
    return sum(len(components) for _, components in parts)
