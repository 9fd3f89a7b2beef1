"""Limits of a payload, acceleration and clearance, and of mounts: load, and the force, closing speed and gap of stops."""

import math
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace
from fnmatch import filter as matching
from typing import NamedTuple

from wirerope_mj.foundation.arguments import finite, one_of
from wirerope_mj.foundation.plain_text import short
from wirerope_mj.foundation.quantities import values_with_unit
from wirerope_mj.foundation.units import ACCELERATION_UNITS, FORCE_UNITS, LENGTH_UNITS, VELOCITY_UNITS


class LimitKind(NamedTuple):
    """Number of values, unit, range and subject of the limits of one kind."""

    sizes: tuple[int, int]  # how many values one may have
    unit: str
    units: Mapping[str, float]  # in which texts may say it, each in `unit`
    least: float  # from the stillness of an optical table
    largest: float  # to what no equipment and no room has
    subject: str = "body of the payload and no point"  # what a limit of this kind is on, behind "there is no"


KINDS = {
    "acceleration": LimitKind((1, 3), "m/s^2", ACCELERATION_UNITS, 1e-6, 1e7),
    "clearance": LimitKind((3, 6), "m", LENGTH_UNITS, 1e-7, 1e3),
    "load": LimitKind((1, 1), "N", FORCE_UNITS, 1e-6, 1e9, "mount"),
    "force": LimitKind((1, 1), "N", FORCE_UNITS, 1e-6, 1e9, "mount with a stop"),
    "closing": LimitKind((1, 1), "m/s", VELOCITY_UNITS, 1e-6, 1e3, "mount with a stop"),
    "gap": LimitKind((1, 1), "", {"%": 0.01}, 1e-3, 1.0, "mount with a stop"),
}

ON_STOPS = ("force", "closing", "gap")  # kinds of limits on the stops of mounts
ON_MOUNTS = ("load", *ON_STOPS)  # kinds of limits on mounts, which runs and jobs judge

# Stands between two points in the name of the clearance between them.
BETWEEN = " to "

_EXAMPLES = (
    '"acceleration/rack = 15 g", "acceleration/rack = 0 0 15 g", "clearance/rack_top = 30 30 20 mm", "load/m3 = 5 kN", '
    '"force/s1 = 10 kN", "closing/s* = 0.5 m/s", "gap/s1 = 80 %" or "stops = none"'
)

# Ways that a clearance limits, in the order of its six values.
SIDES = ("-x", "+x", "-y", "+y", "-z", "+z")

# clearances [m] that are plausible: mounts travel a millimetre at least, and none two metres; an acceleration [m/s^2] below
# which people who walk by go beyond it; a load over the mean weight on a mount, which some mounts are off it by less
_CLEAR, _STILL, _OF_WEIGHT = (2e-4, 2.0), 0.05, 0.1
_TOUGH = 2e4  # acceleration [m/s^2] that nothing needs a limit for which stands on wire rope: projectiles have such

_LABELS = {1: ("",), 3: ("x", "y", "z"), 6: SIDES}


@dataclass(frozen=True, kw_only=True)
class PayloadLimit:
    """A limit that the model states for one of its bodies, points or mounts, along the axes of the world."""

    # "acceleration" (fragility of what stands there, absolute acceleration), "clearance" (rattle space: how far a point, or
    # any corner of a body, may move from its modelled position relative to the base), "load" (size of the force that a mount
    # hands on to what it stands on), "force" and "closing" (force of each stop of a mount, and speed at which it closes) or
    # "gap" (fraction of its gap, from the unloaded geometry, that a stop's travel may use: with 1 it must not be touched)
    kind: str
    # the body, the point or the mount; of a clearance also two points, "rack_1 to rack_2": how far the first moves relative to
    # the second
    name: str
    # acceleration [m/s^2]: one value for the norm, or three along x, y, z; clearance [m]: three values along x, y, z, both
    # ways, six along -x, +x, -y, +y, -z, +z, or one, which is taken for all three; load and force [N], closing speed [m/s],
    # fraction of the gap. Zero: not judged there.
    values: tuple[float, ...]

    def __post_init__(self) -> None:
        one_of("kind", self.kind, KINDS)
        (few, many), unit, _, low, high, _ = KINDS[self.kind]
        values = tuple(finite("values", value) for value in self.values)
        if self.kind == "clearance" and len(values) == 1:  # the same all around
            values *= few
        if len(values) not in (few, many):
            expected = "one number" if few == many else f"{'1, ' * (self.kind == 'clearance')}{few} or {many} numbers"
            raise ValueError(f"`values` of {self.kind} must be {expected}, got {len(values)}.")
        if not all(math.isfinite(value) and value >= 0.0 for value in values) or not any(values):
            raise ValueError(f"`values` must be finite and >= 0, one of them > 0, got {values}.")
        if (odd := next((value for value in values if value and not low <= value <= high), None)) is not None:
            raise ValueError(f"a limit of {self.kind} is from {low:g} to {high:g} {unit}, or 0 for none; got {odd:.6g} {unit}.")
        object.__setattr__(self, "values", values)

    @property
    def judged(self) -> dict[str, float]:
        """Limits by direction: "" (the norm), "x", "y", "z" or "-x", "+x", ..; zeros are left out."""
        return {axis: value for axis, value in zip(_LABELS[len(self.values)], self.values, strict=True) if value}

    def doubt(self, weight: float) -> str:
        """Return a question about the unit of a limit that nothing can need; "" if it is plausible.

        `weight` is what stands on one mount in the mean [N].
        """
        least, most = min(self.judged.values()), max(self.judged.values())
        if self.kind == "clearance" and not _CLEAR[0] <= least <= most <= _CLEAR[1]:
            odd = least if least < _CLEAR[0] else most
            return f"no equipment on wire rope has a clearance of {odd:.3g} m: is its unit mm where m is said, or m for mm?"
        if self.kind == "acceleration" and least < _STILL:
            return f"{least:.3g} m/s^2 is less than a footstep makes: is its unit mm/s^2 where m/s^2 or g is meant?"
        if self.kind == "acceleration" and most > _TOUGH:
            return f"{most:.4g} m/s^2 is borne by nothing that stands on wire rope: is it in another unit, such as mm/s^2?"
        if self.kind == "load" and least < _OF_WEIGHT * weight:
            return f"{least:.4g} N are less than a tenth of what stands on a mount at rest, {weight:.4g} N: is it in kN?"
        return ""

    @property
    def ways(self) -> dict[str, float]:
        """Limits of a clearance along each of `SIDES`; zeros are left out."""
        values = self.values if len(self.values) == len(SIDES) else tuple(v for v in self.values for _ in range(2))
        return {side: value for side, value in zip(SIDES, values, strict=True) if value}


def limits_by_patterns(limits: Sequence[PayloadLimit], known: Mapping[str, Sequence[str]]) -> list[PayloadLimit]:
    """Expand names with * or ? in limits; a name with a limit of its own keeps it.

    Args:
        limits: of any kind; one whose name matches nothing stays as it is.
        known: names of the bodies, points and mounts that a limit of each kind may be on.
    """
    stated = {(limit.kind, limit.name) for limit in limits}
    return [
        replace(limit, name=name)
        for limit in limits
        for name in matching(known[limit.kind], limit.name) or [limit.name]
        if name == limit.name or (limit.kind, name) not in stated
    ]


def limit_from_text(text: str) -> PayloadLimit:
    """Parse a limit such as `acceleration/rack = 15 g` or `clearance/rack_top = 30 30 20 mm`.

    `stops = none`, or `stops/NAME = none`, is `gap/NAME = 100 %`: no stop of these mounts may be touched.

    Raises:
        ValueError: the text is no limit, its unit is none of its kind, or it has the wrong number of values.
    """
    subject, _, said = text.rpartition("=")
    kind, _, name = (part.strip() for part in subject.partition("/"))
    if kind == "stops" and said.strip().lower() == "none":
        kind, name, said = "gap", name or "*", "100 %"
    if not name:
        raise ValueError(f"a limit is written like {_EXAMPLES}; got {short(text)!r}.")
    try:
        one_of("kind", kind, KINDS)
        return PayloadLimit(kind=kind, name=name, values=values_with_unit(said, kind, KINDS[kind].units))
    except ValueError as error:
        raise ValueError(f"limit {short(text)!r}: {error} It is written like {_EXAMPLES}.") from None
