"""Room for mounts: which stand in each other, and which so far from the equipment that a part must join them to it."""

import numpy as np

from wirerope_mj.engine.from_tables.layout import Layout
from wirerope_mj.engine.system import System
from wirerope_mj.foundation.arrays import Array

_TOUCH = 1e-4  # by how much mounts may overlap [m]
_AWAY, _SIZE = 2.0, 0.1  # distance from the equipment in sizes of a mount that a foot bridges, and the size of one without [m]


def overlapping(system: System) -> list[tuple[str, str]]:
    """Name the pairs of mounts that stand in each other, as boxes of their height and width turned as they stand."""
    boxes = []
    for name, mount in system.mounts.items():
        size = mount.isolator.geometry
        if not mount.isolator.is_stop and size is not None and size.height and size.width:
            boxes.append((name, mount.position, mount.axes, 0.5 * np.array([size.width, size.width, size.height])))
    if not boxes:
        return []
    centres, reach = np.array([box[1] for box in boxes]), np.linalg.norm([box[3] for box in boxes], axis=1)
    near = np.linalg.norm(centres[:, None] - centres, axis=2) < reach[:, None] + reach
    pairs = [(boxes[i], boxes[j]) for i, j in np.argwhere(np.triu(near, 1))]
    return [(one[0], other[0]) for one, other in pairs if _apart(one[1:], other[1:]) < -_TOUCH]


def box_of(layout: Layout) -> tuple[Array, Array]:
    """Return the lowest and highest corner [m], (3,) each, of the equipment: of its envelope, or of the boxes of its masses."""
    boxes = [(box.centre, box.size) for box in layout.envelope] or [
        (mass.properties.centre, mass.properties.box) for mass in layout.masses
    ]
    return np.min([c - 0.5 * s for c, s in boxes], axis=0), np.max([c + 0.5 * s for c, s in boxes], axis=0)


def in_thin_air(system: System, layout: Layout | None) -> list[str]:
    """Return notes on mounts that stand so far from the equipment, over twice their size, that a part must join them to it."""
    said = []
    low, high = (np.zeros(3), np.zeros(3)) if layout is None else box_of(layout)
    for mount in () if layout is None else (system.mounts[row.name] for row in layout.mounts):
        away = float(np.linalg.norm(np.maximum(np.maximum(low - mount.position, mount.position - high), 0.0)))
        size = mount.isolator.geometry
        if away > _AWAY * max((size.height or 0.0, size.width or 0.0) if size is not None else (_SIZE,)):
            said.append(
                f"{mount.name} stands {1e3 * away:.0f} mm from the equipment; what reaches it is taken as rigid and weightless."
            )
    return said


def _apart(first: tuple[Array, Array, Array], second: tuple[Array, Array, Array]) -> float:
    """Find the largest gap between two boxes along any axis that could separate them [m]; negative where there is none."""
    (here, ours, half), (there, theirs, other) = first, second
    crossed = np.cross(ours.T[:, None], theirs.T[None]).reshape(-1, 3)
    lengths = np.linalg.norm(crossed, axis=1)
    axes = np.vstack([ours.T, theirs.T, crossed[lengths > 1e-6] / lengths[lengths > 1e-6, None]])
    reach = np.abs(axes @ ours) @ half + np.abs(axes @ theirs) @ other
    return float((np.abs(axes @ (there - here)) - reach).max())
