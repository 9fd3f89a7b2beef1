"""Where things stand on a board while they are dragged, and which mounts would stand in each other."""

from collections.abc import Mapping, Sequence
from itertools import combinations

import numpy as np

from wirerope_mj.engine.system import System
from wirerope_mj.engine.system.varied import varied
from wirerope_mj.foundation.arrays import Array
from wirerope_mj.runs.board.table_text import TableText

_TOUCH = 1e-4  # by how much mounts may overlap [m]


def with_shifted(system: System, tables: Mapping[str, TableText], names: Sequence[str], by: Array) -> System:
    """Return a variant in which mounts and stops of tables stand elsewhere by a shift [m], (3,), with all that stands at them.

    At a mount stand the stop where it goes solid, and those of a row of stops for several mounts. ModelError: there is none.
    """
    held = {name.partition("/")[2] for name in names}
    rows = tables["stops"].rows if "stops" in tables else {}
    at_mounts = tuple(f"_{name.partition('/')[2]}" for name in names if name.startswith("mount/"))
    joined = {
        name for name in system.mounts if name not in rows and name not in tables["mounts"].rows and name.endswith(at_mounts)
    }
    return varied(system, positions=dict.fromkeys([*held, *sorted(joined)], by))


def overlapping(system: System) -> list[tuple[str, str]]:
    """Name the pairs of mounts that stand in each other, as boxes of their height and width turned as they stand."""
    boxes = []
    for name, mount in system.mounts.items():
        size = mount.isolator.geometry
        if not mount.isolator.is_stop and size is not None and size.height and size.width:
            boxes.append((name, mount.position, mount.axes, 0.5 * np.array([size.width, size.width, size.height])))
    return [
        (first[0], second[0]) for first, second in combinations(boxes, 2)
        if np.linalg.norm(second[1] - first[1]) < np.linalg.norm(first[3]) + np.linalg.norm(second[3])
        and _apart(first[1:], second[1:]) < -_TOUCH
    ]  # fmt: skip


def _apart(first: tuple[Array, Array, Array], second: tuple[Array, Array, Array]) -> float:
    """Find the largest gap between two boxes along any axis that could separate them [m]; negative where there is none."""
    (here, ours, half), (there, theirs, other) = first, second
    crossed = np.cross(ours.T[:, None], theirs.T[None]).reshape(-1, 3)
    lengths = np.linalg.norm(crossed, axis=1)
    axes = np.vstack([ours.T, theirs.T, crossed[lengths > 1e-6] / lengths[lengths > 1e-6, None]])
    reach = np.abs(axes @ ours) @ half + np.abs(axes @ theirs) @ other
    return float((np.abs(axes @ (there - here)) - reach).max())
