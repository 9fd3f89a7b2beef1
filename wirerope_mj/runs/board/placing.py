"""Edits of what stands on a board: rows of tables moved, turned, mirrored, aligned, copied and taken away."""

import math
from collections.abc import Callable, Mapping, Sequence

import numpy as np

from wirerope_mj.engine.from_tables.layout import Layout, Placed, axes_along
from wirerope_mj.engine.from_tables.read import SIZES
from wirerope_mj.foundation.arrays import Array, Entries
from wirerope_mj.foundation.errors import ModelError
from wirerope_mj.mounts.vendor_parts import load_isolator
from wirerope_mj.runs.board.room import box_of
from wirerope_mj.runs.board.table_text import TableText

Tables = Mapping[str, TableText]  # by their kinds
TABLE_OF = {
    "mount": "mounts", "stop": "stops", "mass": "masses", "point": "points", "force": "forces", "envelope": "envelope",
}  # fmt: skip
_UP, _DOWN = np.array([0.0, 0.0, 1.0]), np.array([0.0, 0.0, -1.0])
_ASIDE = 0.05  # by how much a copy of what has no width stands aside [m]
_MOMENTS = {"ixx": (0, 0), "iyy": (1, 1), "izz": (2, 2), "ixy": (0, 1), "ixz": (0, 2), "iyz": (1, 2)}


class Placing:
    """Tables under edits of what they place."""

    def __init__(self, tables: Tables, layout: Layout) -> None:
        self.tables = dict(tables)
        self._layout = layout
        self._placed: dict[str, Placed] = {f"mount/{mount.name}": mount for mount in layout.mounts}
        self._placed |= {f"stop/{stop.name}": stop for stop in layout.stops}
        self._positions: dict[str, Array] = {name: mount.position for name, mount in self._placed.items()}
        self._positions |= {f"mass/{mass.name}": mass.properties.centre for mass in layout.masses}
        self._positions |= {f"point/{point.name}": point.position for point in layout.points}
        self._positions |= {f"force/{point.name}": point.position for point in layout.forces}
        self._positions |= {f"envelope/{box.name}": box.centre for box in layout.envelope}

    def position(self, name: str) -> Array:
        """Return where a thing stands [m]; ModelError if there is none of the name."""
        if name not in self._positions:
            raise ModelError(f"there is no {name!r} here.")
        return self._positions[name]

    def move(self, names: Sequence[str], by: Array) -> None:
        for name in names:
            self._put(name, self.position(name) + by)

    def turn(self, names: Sequence[str], degrees: float) -> None:
        """Turn things together about the vertical through their middle, against the clock seen from above."""
        c, s = math.cos(math.radians(degrees)), math.sin(math.radians(degrees))
        rotation = np.array([[c, -s, 0.0], [s, c, 0.0], [0.0, 0.0, 1.0]]).round(15)
        middle = np.mean([self.position(name) for name in names], axis=0)
        for name in names:
            self._put(name, middle + rotation @ (self.position(name) - middle))
            if name in self._placed:
                axes = self._placed[name].axes @ rotation.T
                self._direct(name, axes[2], axes[1])
            elif name.startswith("mass/"):
                self._turn_mass(name, rotation)

    def mirror(self, names: Sequence[str], axis: str) -> None:
        """Mirror things along a horizontal axis about the middle of the equipment."""
        along = "xyz".index(axis)
        ends = [corner[along] for corner in box_of(self._layout)]
        flip = np.ones(3)
        flip[along] = -1.0
        for name in names:
            position = self.position(name).copy()
            position[along] = min(ends) + max(ends) - position[along]
            self._put(name, position)
            if name in self._placed:
                axes = self._placed[name].axes * flip
                self._direct(name, axes[2], axes[1])
            elif name.startswith("mass/"):
                self._turn_mass(name, np.diag(flip))

    def align(self, names: Sequence[str], axis: str) -> None:
        """Bring things to the coordinate that the first has."""
        along = "xyz".index(axis)
        for name in names[1:]:
            position = self.position(name).copy()
            position[along] = self.position(names[0])[along]
            self._put(name, position)

    def distribute(self, names: Sequence[str], axis: str) -> None:
        """Space things evenly between the outermost along an axis."""
        along = "xyz".index(axis)
        order = sorted(names, key=lambda name: float(self.position(name)[along]))
        first, last = (self.position(order[end])[along] for end in (0, -1))
        for name, place in zip(order, np.linspace(first, last, len(order)), strict=True):
            position = self.position(name).copy()
            position[along] = place
            self._put(name, position)

    def stand(self, names: Sequence[str], on: str) -> None:
        """Stand mounts on the floor below the equipment, at the nearest wall, or under the ceiling above it."""
        low, high = box_of(self._layout)
        for name in names:
            if name not in self._placed:
                raise ModelError(f"{name} is no mount or stop, and stands at no wall.")
            half = 0.5 * self._height(name)
            position = self.position(name).copy()
            if on == "wall":
                across = [position[:2] - low[:2], high[:2] - position[:2]]
                side, axis = np.unravel_index(int(np.argmin(across)), (2, 2))
                direction = np.zeros(3)
                direction[axis] = 1.0 - 2.0 * side
                position[axis] = (low, high)[side][axis] - half * direction[axis]
                position[2] = 0.5 * (low[2] + high[2])
            else:
                direction = _UP if on == "floor" else _DOWN
                position[2] = low[2] - half if on == "floor" else high[2] + half
            self._put(name, position.round(3))
            self._direct(name, direction, None)

    def duplicate(self, names: Sequence[str]) -> list[str]:
        """Copy things beside themselves and return the names of the copies."""
        return [self._copy(name) for name in names]

    def remove(self, names: Sequence[str]) -> None:
        for name in names:
            self.position(name)
            kind, _, row = name.partition("/")
            table = self.tables[TABLE_OF[kind]]
            if row not in table.rows:
                raise ModelError(f"{name} stands at mounts by a row for several; edit the table of stops.")
            if (rest := table.without_row(row)).rows:
                self.tables[TABLE_OF[kind]] = rest
            elif kind in ("mount", "mass"):
                raise ModelError(f"one {kind} at least must stay.")
            else:
                del self.tables[TABLE_OF[kind]]

    def _copy(self, name: str) -> str:
        position = self.position(name)
        kind, _, row = name.partition("/")
        table = self.tables[TABLE_OF[kind]]
        new = table.free_name(row)
        aside = self._height(name) if name in self._placed else 0.0
        self.tables[TABLE_OF[kind]] = table.with_row(new, {}, like=row)
        copy = f"{kind}/{new}"
        self._positions[copy] = position
        if name in self._placed:
            self._placed[copy] = self._placed[name]
        self._put(copy, position + np.array([2.0 * aside or _ASIDE, 0.0, 0.0]))
        return copy

    def _put(self, name: str, position: Array) -> None:
        """Write a position into the cells of its row, those of the coordinates that change."""
        kind, _, row = name.partition("/")
        table = self.tables[TABLE_OF[kind]]
        if row not in table.rows or (kind == "stop" and table.rows[row].get("mounts")):
            raise ModelError(f"{name} stands where its mount stands: move that one.")
        shift, columns = position - self._positions[name], "xyz"
        cells = {}
        for number, axis in enumerate(columns):
            if abs(shift[number]) > 1e-9:
                column, value = axis, position[number]
                if kind == "envelope":
                    cornered = bool(table.rows[row].get(f"corner_{axis}"))
                    column = f"{'corner' if cornered else 'centre'}_{axis}"
                    size = next(box.size for box in self._layout.envelope if box.name == row)
                    value -= 0.5 * size[number] * cornered
                cells[column] = table.written(column, float(value))
        self.tables[TABLE_OF[kind]] = table.with_cells(row, cells)
        self._positions[name] = position

    def _direct(self, name: str, axial: Array, bars: Array | None) -> None:
        """Write the direction of a mount or stop as its table states directions, and that of its bars where it is not usual."""
        kind, _, row = name.partition("/")
        table, cells = self.tables[TABLE_OF[kind]], dict[str, str]()
        angles = table.has("inclination") and not table.has("direction_x")
        if angles:
            inclination, azimuth = math.acos(min(max(float(axial[2]), -1.0), 1.0)), math.atan2(axial[1], axial[0])
            upright = math.hypot(axial[0], axial[1]) < 1e-9
            cells["inclination"] = table.written("inclination", inclination)
            cells["azimuth"] = table.written("azimuth", 0.0 if upright else azimuth)
        else:
            usual = np.allclose(axial, _UP, atol=1e-12)
            for axis, value in zip("xyz", axial, strict=True):
                cells[f"direction_{axis}"] = "" if usual else table.written(f"direction_{axis}", float(value))
            cells |= {} if not table.has("inclination") else {"inclination": "", "azimuth": ""}
        usual = bars is None or np.allclose(axes_along(axial)[1], bars, atol=1e-12)
        for axis, value in zip("xyz", np.zeros(3) if bars is None else bars, strict=True):
            cells[f"bars_{axis}"] = "" if usual else table.written(f"bars_{axis}", float(value))
        self.tables[TABLE_OF[kind]] = table.with_cells(row, cells)

    def _turn_mass(self, name: str, rotation: Array) -> None:
        """Write the inertia of a turned or mirrored mass, or the sizes of its box."""
        row = name.partition("/")[2]
        mass = next(mass for mass in self._layout.masses if mass.name == row)
        table, cells = self.tables["masses"], dict[str, str]()
        if table.rows[row].get("size_x"):
            if np.abs(np.abs(rotation).max(axis=0) - 1.0).max() > 1e-9:
                raise ModelError(f"{row} is a box, which stands square to the axes: turn it by 90 degrees.")
            turned = [table.rows[row][SIZES[int(np.abs(rotation)[n].argmax())]] for n in range(3)]
            cells = dict(zip(SIZES, turned, strict=True))
        elif mass.properties.inertia.any():
            inertia = rotation @ mass.properties.inertia @ rotation.T
            cells = {
                column: table.written(column, float(inertia[place])) for column, place in _MOMENTS.items()
                if abs(inertia[place] - mass.properties.inertia[place]) > 1e-12 * mass.properties.inertia.max()
            }  # fmt: skip
        self.tables["masses"] = table.with_cells(row, cells)

    def _height(self, name: str) -> float:
        isolator = self._placed[name].isolator
        geometry = load_isolator(self._layout.isolators[isolator]).geometry if isolator in self._layout.isolators else None
        return (geometry.height if geometry is not None else None) or 0.0


def shift_of(action: Entries) -> Array:
    """Read a shift [m]; ModelError if it is none."""
    by = action.get("by")
    if not isinstance(by, list) or len(by) != 3 or not all(type(part) in (int, float) and abs(part) < 1e6 for part in by):
        raise ModelError("a shift is three numbers [mm].")
    return 1e-3 * np.array(by)


def _degrees(action: Entries) -> float:
    if action.get("degrees") not in (*_ANGLES, *map(str, _ANGLES)):
        raise ModelError(f"things are turned by {', '.join(map(str, _ANGLES))} degrees.")
    return float(action["degrees"])


def _one_of(action: Entries, key: str, *known: str) -> str:
    if action.get(key) not in known:
        raise ModelError(f"`{key}` must be {', '.join(known[:-1])} or {known[-1]}.")
    return str(action[key])


_ANGLES = (90, 45, -45, -90)
# Edits by what asks for them, with what is said of them
EDITS: dict[str, tuple[Callable[[Placing, list[str], Entries], list[str] | None], str]] = {
    "move": (lambda placing, names, action: placing.move(names, shift_of(action)), "moved"),
    "turn": (lambda placing, names, action: placing.turn(names, _degrees(action)), "turned"),
    "mirror": (lambda placing, names, action: placing.mirror(names, _one_of(action, "axis", "x", "y")), "mirrored"),
    "align": (lambda placing, names, action: placing.align(names, _one_of(action, "axis", *"xyz")), "aligned"),
    "distribute": (lambda placing, names, action: placing.distribute(names, _one_of(action, "axis", *"xyz")), "distributed"),
    "stand": (
        lambda placing, names, action: placing.stand(names, _one_of(action, "on", "floor", "wall", "ceiling")), "placed",
    ),
    "duplicate": (lambda placing, names, action: placing.duplicate(names), "copied"),
    "remove": (lambda placing, names, action: placing.remove(names), "taken away"),
}  # fmt: skip
