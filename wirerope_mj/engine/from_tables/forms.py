"""Blank tables of mounts, masses, stops and points: every column that is read, with its meaning, and rows of examples."""

from collections.abc import Sequence

from wirerope_mj.engine.from_tables.read import ACTS, COLUMNS
from wirerope_mj.engine.from_tables.sheet import with_unit

_HEAD = {
    "mounts": "Mounts, one a row; positions in the same axes as those of the masses, z up.",
    "masses": "Masses, one a row: their sum is the payload, which is rigid but for rows with a frequency.",
    "stops": "Bump stops and snubbers, one a row; delete this table where there are none.",
    "points": "Points of the payload that are observed, one a row; delete this table where there are none.",
}
# what is said of the columns of each, and of groups of them
_MEANING = {
    "mounts": {
        "name": "of the mount, without spaces",
        "x": "position of the mount's mid-height, with y and z",
        "isolator": "name in the catalogue, part of a vendor's table, or a file beside this table, such as isolator.toml",
        "direction_x": "axial, from the base's side to the payload's, with direction_y and direction_z; empty: 0, 0, 1",
        "bars_x": "along the bars, with bars_y and bars_z; empty: along x under an upright mount, else horizontal",
        "inclination": "of that direction from the vertical, in place of it; empty: upright",
        "azimuth": "of that direction from x, to an inclination; empty: 0",
        "bracket_axial": "stiffness of what the mount is bolted to, with bracket_shear and bracket_roll; empty: rigid",
    },
    "masses": {
        "name": "of the part",
        "mass": "> 0",
        "x": "centre of mass, with y and z",
        "size_x": "of a box filled evenly, with size_y and size_z, for its inertia; empty: see ixx",
        "ixx": "moments of inertia about the part's own centre of mass, with iyy and izz; empty: a point mass",
        "ixy": "products of inertia, with ixz and iyz, as elements of the tensor, ixy = -sum of x y dm (if +sum: "
        "`--products positive`); empty: 0",
        "frequency": "of a subassembly that rings on its own; empty: rigid",
        "damping": "ratio of such a subassembly; empty: 2 %",
        "along": "x, y or z, along which such a subassembly moves; empty: z",
    },
    "stops": {
        "name": "of the stop, another than of any mount, without spaces",
        "x": "position where it touches, with y and z",
        "mounts": "in place of x, y and z: all, or mounts such as m1 m2, at each of which one stands, with its direction",
        "gap": "free travel until it touches: below an upright stop, or along its direction",
        "gap_up": "free travel up, where it acts up, up-down or all-round; empty: gap",
        "gap_across": "free travel across, where it acts all-round; empty: gap",
        "rounding": "depth over which it closes softly; empty: 1 mm",
        "stiffness": "behind the gap",
        "damping": "viscous; empty: none",
        "acts": f"{', '.join(ACTS)}; empty: down",
        "gap_at": "unloaded, or installed: at rest under the weight; empty: unloaded",
        "isolator": "in place of all figures above: name in the catalogue, or a file beside this table",
        "direction_x": "from the base's side to the payload's, with direction_y and direction_z; empty: 0, 0, 1",
        "bars_x": "its x axis, with bars_y and bars_z; empty: along x of an upright stop, else horizontal",
        "inclination": "of that direction from the vertical, in place of it; empty: upright",
        "azimuth": "of that direction from x, to an inclination; empty: 0",
    },
    "points": {"name": "of the point, without spaces", "x": "its position, with y and z"},
}
_ROWS: dict[str, Sequence[dict[str, object]]] = {
    "mounts": [
        {"name": f"m{number}", "x": x, "y": y, "z": 0, "isolator": "WR2-800"}
        for number, (x, y) in enumerate([(-60, -40), (60, -40), (-60, 40), (60, 40)], start=1)
    ],
    "masses": [
        {"name": "camera", "mass": 2.4, "x": 0, "y": 0, "z": 60, "size_x": 120, "size_y": 80, "size_z": 100},
    ],
    "stops": [{"name": "s1", "x": 0, "y": 0, "z": 0, "gap": 15, "stiffness": 200000}],
    "points": [{"name": "lens", "x": 60, "y": 0, "z": 60}],
}


def blank_table(kind: str) -> str:
    """Write a CSV table of a kind in `COLUMNS` with all its columns, their meanings, and rows of examples."""
    needed, further = COLUMNS[kind]
    columns = {**needed, **further}
    lines = [f"# {_HEAD[kind]} Columns that may be empty may be left out; other units may stand in the brackets."]
    lines += [f"# {with_unit(name, columns[name])}: {text}" for name, text in _MEANING[kind].items()]
    rows = [", ".join(str(row.get(name, "")) for name in columns) for row in _ROWS[kind]]
    return "\n".join([*lines, ", ".join(with_unit(*column) for column in columns.items()), *rows]) + "\n"
