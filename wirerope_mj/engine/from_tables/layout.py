"""What the tables of a model say, in SI: mass properties, mounts, stops and points, and whether they stand where they can."""

import re
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field
from pathlib import Path

import numpy as np

from wirerope_mj.foundation.arguments import positive
from wirerope_mj.foundation.arrays import Array
from wirerope_mj.foundation.errors import RecordError
from wirerope_mj.foundation.plain_text import quoted, short
from wirerope_mj.mounts.isolator import Bracket, Isolator
from wirerope_mj.mounts.vendor_parts import VendorPart

# by how much of the largest principal moment another may miss a bound: a plate lies on it, but for rounding
TOLERANCE = 1e-9
_SAME = 1e-3  # closer than this no two mounts can stand [m]
_NARROW = 0.03  # distance of all mounts [m] below which any two of them would overlap
_LEVEL = 0.1  # a mount whose direction rises less than this (6 degrees) counts as horizontal
# radii of gyration from the centre of mass, or times the distance of the mounts, or of [m] where these are nearer: no machine's
# foot is so far out, no machine so large; a table in other units is a thousand
_FAR, _LEAST = 20.0, 0.3
_LARGEST = 300.0  # distance of mounts [m] that no floor reaches: a cabinet's in mm are farther apart
NAME = "equipment"  # of the model and of its payload
# from the edges of the box to its mounts, in its sizes: a mount must stand below it with its whole width
_INSET = 0.125
# how many mounts stand at one side of the box, and at corners by how much they lean: "4", "2 wall", "8 corners 45 deg"
_GROUP = re.compile(r"(\d+) ?([a-z]*)(?: ([\d.]+) ?deg)?")
_BELOW_AND_BEHIND = re.compile(r"\d+ *\+ *\d+")
_SIDES = {
    "below": ("", "below", "bottom", "floor"), "above": ("top", "above", "ceiling"), "behind": ("wall", "behind"),
    "diagonal": ("corner", "corners"),
}  # fmt: skip
_LEANING = 45.0  # of a mount at a corner from the vertical, towards the middle of the box [deg]
_CUBE = 0.5  # side of the box where none is said [m]: its mounts are at the height of its centre, and it does not turn


@dataclass(frozen=True, eq=False)
class MassProperties:
    """Mass [kg], centre of mass (3,) [m], and tensor of inertia (3, 3) about it, in the table's axes [kg m^2].

    Off-diagonal elements are those of the tensor: ixy = -sum of x y dm.
    """

    mass: float
    centre: Array
    inertia: Array

    @property
    def box(self) -> Array:
        """Sides of the uniform box that has these moments of inertia [m], (3,)."""
        moments = np.diag(self.inertia)
        return np.asarray(np.sqrt(np.maximum(6.0 * (moments.sum() - 2.0 * moments) / self.mass, 0.0)))


def combine(parts: Sequence[MassProperties]) -> MassProperties:
    """Return the mass properties of rigidly joined parts: sums, and the theorem of parallel axes (Huygens-Steiner)."""
    mass = sum(part.mass for part in parts)
    centre = sum((part.mass * part.centre for part in parts), np.zeros(3)) / mass
    inertia = np.zeros((3, 3))
    for part in parts:
        arm = part.centre - centre
        inertia += part.inertia + part.mass * (arm @ arm * np.eye(3) - np.outer(arm, arm))
    return MassProperties(mass, centre, inertia)


def why_impossible(inertia: Array) -> str:
    """Say why no body can have an inertia tensor: a moment < 0, or above the sum of the other two; "" if a body can."""
    small, middle, large = np.linalg.eigvalsh(inertia)
    slack = TOLERANCE * max(abs(large), abs(small))
    values = f"its principal moments are {small:.4g}, {middle:.4g} and {large:.4g} kg m^2"
    if small < -slack:
        return f"{values}, and none can be negative"
    if large > small + middle + slack:
        return f"{values}, and none can be larger than the sum of the other two"
    return ""


@dataclass(frozen=True)
class Sprung:
    """Spring of a subassembly in the payload: its natural frequency [Hz], damping ratio, the axis along which it moves."""

    frequency: float
    damping: float
    axis: str


@dataclass(frozen=True, eq=False)
class Mass:
    """A row of the table of masses."""

    name: str
    properties: MassProperties
    sprung: Sprung | None = None  # of a subassembly that rings on its own; else it is part of the rigid payload
    location: str = ""  # file and row, as messages begin


# Ways in which a stop acts: along its direction, in which the payload goes down onto it, against it, and across.
ACTS = {"down": ("gap",), "up": ("gap_up",), "up-down": ("gap", "gap_up"), "all-round": ("gap", "gap_up", "gap_across")}


@dataclass(frozen=True, kw_only=True)
class StopLaw:
    """A bump stop as a row of the table of stops states it: gaps, rounding [m], stiffness [N/m], damping [N s/m].

    A gap is None where the stop does not act that way; `rest` are the deflections along roll, shear and axial from which gaps
    count that were measured installed, under the weight [m], NaN until they are known; None for gaps as unloaded.
    """

    gap: float | None
    gap_up: float | None = None
    gap_across: float | None = None
    stiffness: float
    damping: float
    rounding: float
    rest: tuple[float, float, float] | None = None


@dataclass(frozen=True, eq=False)
class Placed:
    """A mount or a stop: name, position of its mid-height (3,) [m], axes, names of the isolator and of its bracket."""

    name: str
    position: Array
    # roll, shear and axial as rows (3, 3), unit vectors; axial points from the base's side to the payload's
    axes: Array
    isolator: str
    location: str  # file and row that say so, for messages
    law: StopLaw | None = None  # of a stop with figures of its own; else the isolator's file says it
    bracket: Bracket | None = None

    @property
    def device(self) -> str:
        """Name of the isolator with its bracket."""
        stated = self.bracket.stated if self.bracket is not None else {}
        return "_".join([self.isolator, *(f"on_{axis}_{1e-3 * k:.6g}" for axis, k in stated.items())])


@dataclass(frozen=True, eq=False)
class Point:
    """A point of the payload that is observed: name and position (3,) [m]."""

    name: str
    position: Array
    location: str = ""  # file and line, as messages begin


@dataclass(frozen=True, eq=False)
class Box:
    """A box of the payload's envelope: name, centre (3,) [m], sizes along x, y and z (3,) [m]."""

    name: str
    centre: Array
    size: Array


@dataclass(frozen=True, kw_only=True, eq=False)
class Layout:
    """A payload on mounts as the tables of a model describe it."""

    name: str  # of the payload, and of the model unless that has a name of its own
    masses: tuple[Mass, ...]
    mounts: tuple[Placed, ...]
    stops: tuple[Placed, ...] = ()
    points: tuple[Point, ...] = ()
    forces: tuple[Point, ...] = ()  # points at which forces may act on the payload
    # of the payload, whose corners its clearances hold for; else boxes of the masses' inertia
    envelope: tuple[Box, ...] = ()
    # files, or parts of the vendors' tables, that mounts and stops name, by name
    isolators: Mapping[str, Path | VendorPart] = field(default_factory=dict)
    bottoms: Mapping[str, Isolator] = field(default_factory=dict)  # stops where devices bottom, by the device of their mounts

    @property
    def payload(self) -> MassProperties:
        """Mass properties of the whole payload, subassemblies at their positions included."""
        return combine([mass.properties for mass in self.masses])

    @property
    def rigid(self) -> MassProperties:
        """Mass properties of the payload without its sprung subassemblies."""
        return combine([mass.properties for mass in self.masses if mass.sprung is None])


def axes_along(axial: Array, bars: Array | None = None) -> Array:
    """Return the axes of a mount as rows roll, shear, axial, (3, 3), from its axial direction and the direction of its bars.

    Without `bars` they run along x under an upright mount, and else horizontally, square to the direction.
    """
    axial = axial / np.linalg.norm(axial)
    if bars is None:
        horizontal = np.cross([0.0, 0.0, 1.0], axial)
        upright = np.linalg.norm(horizontal) < 1e-6  # less than what a table says of a direction
        bars = np.array([-np.sign(axial[2]), 0.0, 0.0]) if upright else horizontal
    shear = bars - (bars @ axial) * axial
    shear /= np.linalg.norm(shear)
    return np.array([np.cross(shear, axial), shear, axial])


def check_places(layout: Layout, masses: Path) -> None:
    """Raise RecordError if the masses form no possible body, or a mount's position is impossible."""
    places = np.array([mount.position for mount in layout.mounts])
    apart = float(np.linalg.norm(np.ptp(places, axis=0)))
    far = _FAR * max(apart, _LEAST)
    for mass in layout.masses:
        properties = mass.properties
        away = float(np.linalg.norm(properties.centre - places.mean(axis=0)))
        radius = float(np.sqrt(0.5 * properties.inertia.trace() / properties.mass))
        if away > far or radius > far:
            columns = ['"x", "y", "z"'] * (away > far) + ['"size_x" to "size_z", or "ixx" to "iyz",'] * (radius > far)
            raise RecordError(
                f'{mass.location}: "{short(mass.name)}" has its centre of mass {away:.4g} m from the middle of mounts that are '
                f"{apart:.3g} m apart, and a radius of gyration of {radius:.4g} m: are columns {' and '.join(columns)} in mm "
                "where the header says m?"
            )
    if all(mass.sprung is not None for mass in layout.masses):
        raise RecordError(f'{masses}: every mass has a "frequency"; what the mounts carry needs one without.')
    payload = layout.rigid
    if np.linalg.eigvalsh(payload.inertia)[0] <= 1e-9 * payload.inertia.trace() or why_impossible(payload.inertia):
        raise RecordError(
            f'{masses}: the masses together have no moment of inertia about some axis. Fill in columns "ixx", "iyy" '
            'and "izz" of at least one of them.'
        )
    radius = float(np.sqrt(0.5 * payload.inertia.trace() / payload.mass))
    everything: tuple[Placed | Point, ...] = (*layout.mounts, *layout.stops, *layout.points, *layout.forces)
    for placed in everything:
        distance = float(np.linalg.norm(placed.position - payload.centre))
        if distance > _FAR * radius:
            raise RecordError(
                f'{placed.location}: "{placed.name}" stands outside, {distance:.4g} m from the centre of mass of a payload '
                f'whose radius of gyration is {radius:.4g} m. Check columns "x", "y", "z" and their units in both tables.'
            )
    if apart > _LARGEST:
        raise RecordError(
            f'{layout.mounts[0].location}: mounts are up to {apart:.4g} m apart: are columns "x", "y", "z" of the tables in mm '
            "where the header says m?"
        )
    for mount in layout.mounts:
        axial, towards = mount.axes[2], payload.centre - mount.position
        level = abs(axial[2]) <= _LEVEL
        away = axial[:2] @ towards[:2] < -_SAME if level else axial[2] < 0.0 and towards[2] > _SAME
        if away:
            raise RecordError(
                f'{mount.location}: mount "{mount.name}" has its sites swapped: its direction leads from the base to the '
                "payload, and here it leads away from the payload's centre of mass at "
                f"({', '.join(f'{x:.4g}' for x in payload.centre)}) m. Turn the direction round, or check where the masses are."
            )
    for n, mount in enumerate(layout.mounts):
        for earlier in layout.mounts[:n]:
            if np.linalg.norm(mount.position - earlier.position) < _SAME:
                raise RecordError(
                    f'{mount.location}: columns "x", "y", "z": mount "{mount.name}" stands where "{earlier.name}" stands '
                    f"({earlier.location})"
                    + (": are they in m where the header says mm?" if apart < _NARROW else ". Check the signs.")
                )


def box_layout(part: VendorPart, *, mass: float, mounts: str, size: Array | None = None) -> Layout:
    """Lay out a uniformly filled box on mounts of one part, with a point at each of its corners.

    Args:
        part: that the mounts are.
        mass: of the box [kg].
        mounts: how many stand where, joined by "+": "4" or "4 bottom" below it in two rows along its longer side, "4 top" or
            "4 ceiling" so above it, "4 wall" behind it in two rows; "4+2": below, and in a row behind near its upper edge;
            "8 corners 45 deg", or "4 corners" at those below, leaning so far from the vertical towards its middle.
        size: along x, y (its back is at +y) and z [m], (3,); None: the mounts stand at the height of the centre of mass.

    Raises:
        ValueError: `mounts` or `size` is not what it must be.
    """
    groups = _mount_groups(mounts)
    if size is None and groups.keys() != {"below"}:
        where = " and ".join("at corners of" if side == "diagonal" else side for side in groups if side != "below")
        raise ValueError(f"`mounts` {mounts} stand {where} the equipment: give its `size`.")
    box = np.full(3, _CUBE) if size is None else np.array([positive("size", side) for side in size])
    height = part.height or 0.0
    half = box / 2.0 - _INSET * box
    signs = [np.array([x, y, z]) for z in (-1, 1) for x in (-1, 1) for y in (-1, 1)]  # those below first
    under = {"above": 0.0}.get(next(iter(groups)), height) if len(groups) == 1 else height
    centre = np.array([0.0, 0.0, under + 0.5 * box[2]])
    longer, wide = float(max(half[:2])), half[0] >= half[1]
    places: list[tuple[str, Array, Array]] = []  # name, end at the box and axial direction of each mount
    for side, (count, angle, rows) in groups.items():
        axial = np.array({"behind": (0.0, -1.0, 0.0), "above": (0.0, 0.0, -1.0)}.get(side, (0.0, 0.0, 1.0)))
        ends: list[tuple[Array, Array]] = []
        if side in ("below", "above"):
            level = centre[2] - axial[2] * 0.5 * box[2] if size is not None else centre[2] + 0.5 * height
            across = [0.0] if count <= 2 else [-float(min(half[:2])), float(min(half[:2]))]
            grid = [(along, row) for row in across for along in _row(count // len(across), longer)]
            ends = [(np.array([*(pair if wide else pair[::-1]), level]), axial) for pair in grid]
        elif side == "behind":
            levels = [centre[2] + half[2]] if rows == 1 else [centre[2] - half[2], centre[2] + half[2]]
            ends = [(np.array([x, 0.5 * box[1], z]), axial) for z in levels for x in _row(count // rows, half[0])]
        else:
            lean = np.radians(angle)
            inward = np.array([np.sin(lean) / np.sqrt(2.0), np.sin(lean) / np.sqrt(2.0), np.cos(lean)])
            ends = [(centre + 0.5 * sign * box, -sign * inward) for sign in signs[:count]]
        places += [(f"{side}_{n + 1}", end, axial) for n, (end, axial) in enumerate(ends)]
    placed = [Placed(name, end - 0.5 * height * axial, axes_along(axial), part.name, mounts) for name, end, axial in places]
    inertia = np.diag(mass / 12.0 * (box @ box - box**2))
    corners = sorted(signs, key=lambda sign: sign.tolist())
    return Layout(
        name=NAME, masses=(Mass(NAME, MassProperties(positive("mass", mass, unit="kg"), centre, inertia)),),
        points=tuple(Point(f"corner_{n + 1}", centre + 0.5 * sign * box) for n, sign in enumerate(corners)),
        mounts=tuple(placed), isolators={part.name: part},
    )  # fmt: skip


def _mount_groups(mounts: str) -> dict[str, tuple[int, float, int]]:
    """Parse the mounts by side of a box: how many, inclination of corner mounts [deg], rows of those behind it."""
    groups: dict[str, tuple[int, float, int]] = {}
    for position, text in enumerate(mounts.lower().split("+")):
        match = _GROUP.fullmatch(text.strip())
        number, word, angle = match.groups() if match else ("0", "", None)
        side = next((name for name, words in _SIDES.items() if word in words), "")
        if position == 1 and _BELOW_AND_BEHIND.fullmatch(mounts.strip()):
            side = "behind"
        count, lean = int(number), _LEANING if angle is None else float(angle)
        even = side == "behind" and word == "" or count <= 2 or count % 2 == 0
        right = {"diagonal": count in (4, 8) and lean < 90.0}.get(side, even and angle is None)
        if not (side and right and side not in groups and 0 < count <= 100):
            raise ValueError(
                '`mounts` must be how many stand where, at one side 1 or an even number: "4", "4+2" (below and behind), '
                '"4 top + 4 bottom", "4 ceiling", "4 wall", "8 corners 45 deg" or "4 corners"; got '
                f"{quoted(mounts)}. Write a model for others."
            )
        groups[side] = count, lean, 1 if word == "" or count <= 2 else 2
    return groups


def _row(count: int, half: float) -> list[float]:
    return [0.0] if count == 1 else np.linspace(-half, half, count).tolist()
