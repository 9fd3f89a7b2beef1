"""A payload that is a box on equal mounts below it, and behind it where it is held at a bulkhead."""

import re

import numpy as np

from wirerope_mj.engine.from_tables.layout import Layout, Mass, MassProperties, Placed, Point, axes_along
from wirerope_mj.foundation.arguments import positive
from wirerope_mj.foundation.arrays import Array
from wirerope_mj.foundation.plain_text import quoted
from wirerope_mj.mounts.vendor_parts import VendorPart

NAME = "equipment"  # of the model and of its payload
# from the edges of the box to its mounts, in its sizes: a mount must stand below it with its whole width
_INSET = 0.125
_COUNTS = re.compile(r"(\d+)(?:\+(\d+))?")
_CUBE = 0.5  # side of the box where none is said [m]: its mounts are at the height of its centre, and it does not turn


def box_layout(part: VendorPart, *, mass: float, mounts: str, size: Array | None = None) -> Layout:
    """Place a box that is filled evenly on mounts of one part, with a point at each of its corners.

    Args:
        part: that the mounts are.
        mass: of the box [kg].
        mounts: how many stand below it, in two rows along its longer side, and behind it, in a row near its upper edge, as
            "4" or "4+2".
        size: along x, y (its back is at +y) and z [m], (3,); None: the mounts stand at the height of the centre of mass.

    Raises:
        ValueError: `mounts` or `size` is not what it must be.
    """
    match = _COUNTS.fullmatch(mounts.replace(" ", ""))
    below, behind = (int(count or 0) for count in match.groups()) if match else (0, 0)
    if not below or (below > 2 and below % 2) or below + behind > 100:
        raise ValueError(
            f'`mounts` must be how many stand below, 1 or an even number, and perhaps behind, as in "4" or "4+2"; got '
            f"{quoted(mounts)}. Write a model for others."
        )
    if behind and size is None:
        raise ValueError(f"`mounts` {mounts} stand behind the equipment: give its `size`.")
    box = np.full(3, _CUBE) if size is None else np.array([positive("size", one) for one in size])
    height = part.height or 0.0
    centre = np.array([0.0, 0.0, height + 0.5 * box[2]])
    half = box / 2.0 - _INSET * box
    level = 0.5 * height if size is not None else centre[2]
    longer, wide = float(max(half[:2])), half[0] >= half[1]
    rows = [0.0] if below <= 2 else [-float(min(half[:2])), float(min(half[:2]))]
    grid = [(along, across) for across in rows for along in _row(below // len(rows), longer)]
    places = [(np.array([*(pair if wide else pair[::-1]), level]), np.array([0.0, 0.0, 1.0])) for pair in grid]
    top = centre[2] + half[2]
    places += [(np.array([x, 0.5 * box[1] + 0.5 * height, top]), np.array([0.0, -1.0, 0.0])) for x in _row(behind, half[0])]
    names = [f"below_{n + 1}" for n in range(below)] + [f"behind_{n + 1}" for n in range(behind)]
    placed = [
        Placed(name, place, axes_along(axial), part.name, mounts) for name, (place, axial) in zip(names, places, strict=True)
    ]
    signs = [np.array([x, y, z]) for x in (-1, 1) for y in (-1, 1) for z in (-1, 1)]
    inertia = np.diag(mass / 12.0 * (box @ box - box**2))
    return Layout(
        name=NAME, masses=(Mass(NAME, MassProperties(positive("mass", mass, unit="kg"), centre, inertia)),),
        mounts=tuple(placed), points=tuple(Point(f"corner_{n + 1}", centre + 0.5 * sign * box) for n, sign in enumerate(signs)),
        isolators={part.name: part},
    )  # fmt: skip


def _row(count: int, half: float) -> list[float]:
    return [0.0] if count == 1 else np.linspace(-half, half, count).tolist()
