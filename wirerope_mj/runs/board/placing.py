"""Edits of a board's tables: what their rows place is moved, turned, copied and taken away, and cells are written."""

import math
from collections.abc import Mapping, Sequence
from typing import Literal

import numpy as np

from wirerope_mj.engine.from_tables.forms import blank_table
from wirerope_mj.engine.from_tables.layout import Layout, Placed, axes_along
from wirerope_mj.engine.from_tables.places import ANGLES
from wirerope_mj.engine.from_tables.read import SIZES
from wirerope_mj.foundation.arrays import Array, Entries
from wirerope_mj.foundation.errors import ModelError
from wirerope_mj.mounts.vendor_parts import load_isolator
from wirerope_mj.runs.board.table_text import TableText
from wirerope_mj.runs.room import box_of

TABLE_OF = {
    "mount": "mounts", "stop": "stops", "mass": "masses", "point": "points", "force": "forces", "envelope": "envelope",
}  # fmt: skip
PREFIX_OF = {table: prefix for prefix, table in TABLE_OF.items()}
ADDED = ("stops", "points")  # tables that a board adds
# Edits of what is selected, with what is said of them
PLACED = {
    "move": "moved", "turn": "turned", "mirror": "mirrored", "align": "aligned", "distribute": "distributed",
    "stand": "placed", "duplicate": "copied", "remove": "taken away",
}  # fmt: skip
TABLE_EDITS = (*PLACED, "cell", "part", "add")
_ANGLES = (90, 45, -45, -90)
_UP = np.array([0.0, 0.0, 1.0])
_ASIDE, _ADDED = 0.05, 0.2  # by how much a copy of what has no width, and a row that is added, stand aside [m]
_MOMENTS = {"ixx": (0, 0), "iyy": (1, 1), "izz": (2, 2), "ixy": (0, 1), "ixz": (0, 2), "iyz": (1, 2)}


class Placing:
    """Tables that are edited, with the positions of what their rows place, each called by kind and name: "mount/m1"."""

    def __init__(self, tables: Mapping[str, TableText], layout: Layout) -> None:
        self.tables = dict(tables)
        self._layout = layout
        self._placed: dict[str, Placed] = {f"mount/{mount.name}": mount for mount in layout.mounts}
        self._placed |= {f"stop/{stop.name}": stop for stop in layout.stops}
        self._positions: dict[str, Array] = {name: mount.position for name, mount in self._placed.items()}
        self._positions |= {f"mass/{mass.name}": mass.properties.centre for mass in layout.masses}
        self._positions |= {f"point/{point.name}": point.position for point in layout.points}
        self._positions |= {f"force/{point.name}": point.position for point in layout.forces}
        self._positions |= {f"envelope/{box.name}": box.centre for box in layout.envelope}

    def edit(self, asked: str, action: Entries) -> tuple[str, list[str]]:
        """Carry out one of the edits `PLACED`; return a phrase that says what was done, and the names of copies."""
        names, copies, sides = names_of(action), list[str](), dict[str, None]()
        if asked == "remove":
            for name in names:
                self._remove(name)
        elif asked == "duplicate":
            copies = [self.copy(name, 2.0 * self._size(name, "height") or _ASIDE) for name in names]
        elif asked == "stand":
            on = _choice(action, "on", "floor", "wall", "ceiling")
            sides = dict.fromkeys(side for name in names if (side := self._stand(name, on)))
        else:
            self._arrange(asked, names, action)
        called = [name.partition("/")[2] for name in names]
        where = f" at the wall towards {', '.join(sides)}, the side of the equipment that was nearest" if sides else ""
        return f"{PLACED[asked]} {', '.join(called) if len(called) < 4 else f'{len(called)} things'}{where}", copies

    def _arrange(self, asked: str, names: Sequence[str], action: Entries) -> None:
        """Move, turn, mirror, align or distribute what is called `names`, and write it to the tables."""
        if unknown := [name for name in names if name not in self._positions]:
            raise ModelError(f"there is no {unknown[0][:40]!r} here.")
        positions = np.array([self._positions[name] for name in names])
        rotation = np.eye(3)
        if asked == "move":
            positions += shift_of(action)
        elif asked == "turn":  # about the vertical through their middle, against the clock seen from above
            degrees = float(_choice(action, "degrees", *map(str, _ANGLES)))
            c, s = math.cos(math.radians(degrees)), math.sin(math.radians(degrees))
            rotation = np.array([[c, -s, 0.0], [s, c, 0.0], [0.0, 0.0, 1.0]]).round(15)
            middle = positions.mean(axis=0)
            positions = middle + (positions - middle) @ rotation.T
        else:
            along = "xyz".index(_choice(action, "axis", *("xy" if asked == "mirror" else "xyz")))
            placed = positions[:, along]
            if asked == "mirror":  # about the middle of the equipment
                rotation[along, along] = -1.0
                placed[:] = sum(corner[along] for corner in box_of(self._layout)) - placed
            elif asked == "align":
                placed[:] = placed[0]
            else:  # evenly between the outermost
                placed[np.argsort(placed, kind="stable")] = np.linspace(placed.min(), placed.max(), len(names))
        for name, position in zip(names, positions, strict=True):
            self._put(name, position)
            if name in self._placed and asked in ("turn", "mirror"):
                axes = self._placed[name].axes @ rotation.T
                self._direct(name, axes[2], axes[1])
            elif name.startswith("mass/") and asked in ("turn", "mirror"):
                self._turn_mass(name, rotation)

    def _stand(self, name: str, on: str) -> str:
        """Stand a mount on the floor below the equipment, at the nearest wall, whose side is returned, or under the ceiling."""
        if name not in self._placed:
            raise ModelError(f"{name} is no mount or stop, and stands at no wall.")
        low, high = box_of(self._layout)
        half, position, direction, wall = 0.5 * self._size(name, "height"), self._positions[name].copy(), _UP, ""
        if on == "wall":
            across = [position[:2] - low[:2], high[:2] - position[:2]]
            side, axis = np.unravel_index(int(np.argmin(across)), (2, 2))
            wall = "\N{MINUS SIGN}+"[side] + "xy"[axis]
            direction = np.zeros(3)
            direction[axis] = 1.0 - 2.0 * side
            position[axis] = (low, high)[side][axis] - half * direction[axis]
            position[2] = 0.5 * (low[2] + high[2])
        else:
            direction = _UP if on == "floor" else -_UP
            inside = np.minimum(0.5 * self._size(name, "width"), 0.5 * (high - low)[:2])  # whole below or above it
            position[:2] = np.clip(position[:2], low[:2] + inside, high[:2] - inside)
            position[2] = low[2] - half if on == "floor" else high[2] + half
        self._put(name, position.round(3))
        self._direct(name, direction, None)
        return wall

    def _row(self, name: str) -> tuple[str, str, TableText]:
        """Find kind, row and table of what is called `name`; ModelError if no row of its own places it."""
        kind, _, row = name.partition("/")
        table = self.tables.get(TABLE_OF.get(kind, ""))
        if table is None or row not in table.rows:
            if name in self._positions:
                raise ModelError(f"{name} stands where its mount stands: move that one, or edit the table of stops.")
            raise ModelError(f"there is no {name[:40]!r} here.")
        return kind, row, table

    def write(self, name: str, cells: Mapping[str, str | float]) -> None:
        """Write cells, by column, of the row that is called `name`; numbers are in SI units."""
        _, row, table = self._row(name)
        self.tables[table.kind] = table.with_cells(row, cells)

    def _put(self, name: str, position: Array) -> None:
        """Write a new position [m], (3,), to the row that is called `name`, of which only the coordinates that change."""
        kind, row, table = self._row(name)
        cells = dict[str, float]()
        for number in np.flatnonzero(np.abs(position - self._positions[name]) > 1e-9):
            column, value = "xyz"[number], float(position[number])
            if kind == "envelope":
                cornered = bool(table.rows[row].get(f"corner_{column}"))
                size = next(box.size for box in self._layout.envelope if box.name == row)
                column = f"{'corner' if cornered else 'centre'}_{column}"
                value -= 0.5 * float(size[number]) * cornered
            cells[column] = value
        self.write(name, cells)
        self._positions[name] = position

    def _direct(self, name: str, axial: Array, bars: Array | None) -> None:
        """Write the direction of a mount or stop as its table states directions, and that of its bars where it is not usual."""
        table = self._row(name)[2]
        cells: dict[str, str | float] = dict.fromkeys(ANGLES, "")
        if table.has("inclination") and not table.has("direction_x"):
            upright = math.hypot(axial[0], axial[1]) < 1e-9
            cells["inclination"] = math.acos(min(max(float(axial[2]), -1.0), 1.0))
            cells["azimuth"] = 0.0 if upright else math.atan2(axial[1], axial[0])
        else:
            usual = np.allclose(axial, _UP, atol=1e-12)
            cells |= {f"direction_{axis}": "" if usual else float(value) for axis, value in zip("xyz", axial, strict=True)}
        bars = axes_along(axial)[1] if bars is None else bars
        usual = np.allclose(axes_along(axial)[1], bars, atol=1e-12)
        cells |= {f"bars_{axis}": "" if usual else float(value) for axis, value in zip("xyz", bars, strict=True)}
        self.write(name, cells)

    def _turn_mass(self, name: str, rotation: Array) -> None:
        """Write the inertia of a turned or mirrored mass, or the sizes of its box."""
        _, row, table = self._row(name)
        inertia = next(mass.properties.inertia for mass in self._layout.masses if mass.name == row)
        if table.rows[row].get("size_x"):
            if np.abs(np.abs(rotation).max(axis=0) - 1.0).max() > 1e-9:
                raise ModelError(f"{row} is a box, which stands square to the axes: turn it by 90 degrees.")
            self.write(name, {SIZES[n]: table.rows[row][SIZES[int(np.abs(rotation)[n].argmax())]] for n in range(3)})
        else:
            turned = rotation @ inertia @ rotation.T
            changed = np.abs(turned - inertia) > 1e-12 * inertia.max()
            self.write(name, {column: float(turned[place]) for column, place in _MOMENTS.items() if changed[place]})

    def copy(self, name: str, aside: float) -> str:
        """Copy a row to the end of its table, shift the copy by `aside` [m] along x, and return its name."""
        kind, row, table = self._row(name)
        free = table.free_name(row)
        self.tables[table.kind] = table.with_row(free, like=row)
        copy = f"{kind}/{free}"
        if name in self._positions:  # else it stands at mounts
            self._positions[copy] = self._positions[name]
            self._put(copy, self._positions[name] + np.array([aside, 0.0, 0.0]))
        return copy

    def _remove(self, name: str) -> None:
        """Remove a row, with its table if it is the last; ModelError if it is the last mount or mass."""
        kind, row, table = self._row(name)
        if (rest := table.without_row(row)).rows:
            self.tables[table.kind] = rest
        elif kind in ("mount", "mass"):
            raise ModelError(f"one {kind} at least must stay.")
        else:
            del self.tables[table.kind]

    def _size(self, name: str, side: Literal["height", "width"]) -> float:
        """Return the height or the width of the isolator of a mount [m]; 0 if none is stated."""
        isolator = self._placed[name].isolator if name in self._placed else ""
        geometry = load_isolator(self._layout.isolators[isolator]).geometry if isolator in self._layout.isolators else None
        return (getattr(geometry, side) if geometry is not None else None) or 0.0


def edited_tables(
    tables: Mapping[str, TableText], layout: Layout, asked: str, action: Entries
) -> tuple[dict[str, str], str, list[str]]:  # fmt: skip
    """Edit tables by one of `TABLE_EDITS`; return their texts, a phrase that says what was done, and the names of copies."""
    placing, copies, blank = Placing(tables, layout), list[str](), dict[str, str]()
    kind, value = str(action.get("table")), str(action.get("value", "")).strip()
    if asked == "cell":
        row, column = str(action.get("row")), str(action.get("column"))
        placing.write(f"{PREFIX_OF.get(kind, kind)}/{row}", {column: value})
        said = f"{row}, {column} {value or 'left empty'}"
    elif asked == "part":  # of what is selected, or of all mounts
        names = action.get("names") or [f"mount/{row}" for row in tables["mounts"].rows]
        rows = [row for row in tables["mounts"].rows if f"mount/{row}" in names]
        if not value or not rows:
            raise ModelError("select mounts, and name a part.")
        for row in rows:
            placing.write(f"mount/{row}", {"isolator": value})
        said = f"part of {', '.join(rows) if len(rows) < 4 else f'{len(rows)} mounts'}: {value}"
    elif asked == "add" and kind in tables:
        last = list(tables[kind].rows)[-1]
        said = f"{placing.copy(f'{PREFIX_OF[kind]}/{last}', _ADDED).partition('/')[2]} added"
    elif asked == "add" and kind in ADDED:
        blank, said = {kind: blank_table(kind)}, f"table of {kind} added"
    elif asked == "add":
        raise ModelError(f"there is no table {kind[:40]!r} here.")
    else:
        said, copies = placing.edit(asked, action)
    return {kind: table.text for kind, table in placing.tables.items()} | blank, said, copies


def names_of(action: Entries) -> list[str]:
    """Read the names of what is selected; ModelError if nothing is."""
    names = action.get("names")
    names = [names] if isinstance(names, str) else names
    if not isinstance(names, list) or not names or not all(isinstance(name, str) for name in names):
        raise ModelError("nothing is selected.")
    return names


def shift_of(action: Entries) -> Array:
    """Read a shift [m]; ModelError if it is none."""
    by = action.get("by")
    if not isinstance(by, list) or len(by) != 3 or not all(type(part) in (int, float) and abs(part) < 1e6 for part in by):
        raise ModelError("a shift is three numbers [mm].")
    return 1e-3 * np.array(by)


def _choice(action: Entries, key: str, *known: str) -> str:
    if (chosen := str(action.get(key))) not in known:
        raise ModelError(f"`{key}` must be {', '.join(known[:-1])} or {known[-1]}.")
    return chosen
