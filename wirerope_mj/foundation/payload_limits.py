"""Limits of a payload: the acceleration of a body or a point, and the clearance around it."""

import math
from dataclasses import dataclass

from wirerope_mj.foundation.arguments import one_of

SIZES = {"acceleration": (1, 3), "clearance": (3, 6)}
"""Kinds of limits and how many values each may have."""

UNITS = {"acceleration": "m/s^2", "clearance": "m"}

_LABELS = {1: ("",), 3: ("x", "y", "z"), 6: ("-x", "+x", "-y", "+y", "-z", "+z")}


@dataclass(frozen=True, kw_only=True)
class PayloadLimit:
    """A limit that the model states for one of its bodies or points.

    Attributes:
        kind: "acceleration" (fragility of what stands there, absolute acceleration) or "clearance" (rattle space: how far a
            point, or any corner of a body, may move from its modelled position relative to the base).
        name: the body or the point.
        values: acceleration [m/s^2]: one value for the norm, or three along x, y, z; clearance [m]: three values along x, y, z,
            both ways, or six along -x, +x, -y, +y, -z, +z. World axes. Zero: not judged there.
    """

    kind: str
    name: str
    values: tuple[float, ...]

    def __post_init__(self) -> None:
        one_of("kind", self.kind, SIZES)
        values = tuple(float(value) for value in self.values)
        if len(values) not in SIZES[self.kind]:
            few, many = SIZES[self.kind]
            raise ValueError(f"`values` of {self.kind} must be {few} or {many} numbers, got {len(values)}.")
        if not all(math.isfinite(value) and value >= 0.0 for value in values) or not any(values):
            raise ValueError(f"`values` must be finite and >= 0, one of them > 0, got {values}.")
        object.__setattr__(self, "values", values)

    @property
    def judged(self) -> dict[str, float]:
        """Limits by what they hold for: "" (the norm), "x", "y", "z" or "-x", "+x", ..; those of zero are left out."""
        return {axis: value for axis, value in zip(_LABELS[len(self.values)], self.values, strict=True) if value}
