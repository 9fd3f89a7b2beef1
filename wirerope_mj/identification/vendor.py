"""Data sheets of vendors as TOML files, in the vendor's own units.

Every figure carries its unit in its key, `travel_mm` or `travel_in`, `shock_stiffness_N_per_mm` or `..._lb_per_in`.
A sheet has the tables [compression] and [shear] (which also stands for roll, as in the catalogues), and [diagonal] if
the vendor states figures at 45 degrees: they are compared, never fitted.
"""

import math
from dataclasses import dataclass
from pathlib import Path
from typing import Any

from wirerope_mj.errors import ModelError
from wirerope_mj.identification.shapes import Points, Stiffnesses
from wirerope_mj.toml_file import read_toml

_UNITS = {
    "mm": 1e-3,
    "in": 0.0254,
    "N": 1.0,
    "daN": 10.0,
    "N_per_mm": 1e3,
    "lb_per_in": 175.12683524647636,  # 4.4482216152605 N / 0.0254 m
    "Hz": 1.0,
}
_LENGTH, _FORCE, _STIFFNESS, _FREQUENCY = ("mm", "in"), ("N", "daN"), ("N_per_mm", "lb_per_in"), ("Hz",)

_STIFFNESS_FIGURES = {"travel": _LENGTH, "vibration_stiffness": _STIFFNESS, "shock_stiffness": _STIFFNESS}
_POINT_FIGURES = {
    "static_load": _FORCE,
    "static_deflection": _LENGTH,
    "shock_load": _FORCE,
    "travel": _LENGTH,
    "resonance": _FREQUENCY,
}


@dataclass(frozen=True, kw_only=True)
class DataSheet:
    """What a vendor states about one isolator, in SI units.

    Attributes:
        name: of the part.
        source: the document.
        height: unloaded [m].
        width: across the bars [m].
        compression: figures of the axial axis.
        shear: figures of the shear and roll axes.
        diagonal: figures at 45 degrees between compression and roll, None where there are none.
        static_load: rated load in compression [N].
        damping: the damping ratio aimed at [-]; None where the figures leave no freedom for it.
        damping_range: lowest and highest damping ratio that the vendor states [-]; None where it states none.
        tension_ratio: F(+D) / |F(-D)| in the axial direction [-], assumed.
        assumed: what else no source gives, one sentence each.
    """

    name: str
    source: str
    height: float
    width: float
    compression: Stiffnesses | Points
    shear: Stiffnesses | Points
    diagonal: Stiffnesses | Points | None
    static_load: float
    damping: float | None
    damping_range: tuple[float, float] | None
    tension_ratio: float
    assumed: tuple[str, ...]


def read_datasheet(path: str | Path) -> DataSheet:
    """Return the data sheet in a TOML file; ModelError names file, table, key and rule."""
    return _Reader(str(path)).sheet(read_toml(path, "data sheet"))


@dataclass(frozen=True)
class _Reader:
    """Reads tables of one file and names it in every message."""

    path: str

    def sheet(self, content: dict[str, Any]) -> DataSheet:
        """Return the data sheet of a file's content."""
        content, place = dict(content), f"{self.path}:"
        tables: dict[str, Any] = {
            key: content.pop(key) for key in ("compression", "shear", "diagonal") if key in content
        }
        for key in ("compression", "shear"):
            if key not in tables:
                raise ModelError(f"{place} the table [{key}] is missing.")
        damping = self.number(content, "damping_target", place) if "damping_target" in content else None
        sheet = DataSheet(
            name=self.text(content, "name", place),
            source=self.text(content, "source", place),
            height=self.quantity(content, "height", _LENGTH, place),
            width=self.quantity(content, "width", _LENGTH, place),
            static_load=self.quantity(content, "static_load", _FORCE, place),
            damping=damping,
            tension_ratio=self.number(content, "tension_ratio", place),
            damping_range=self.damping_range(content, damping, place),
            assumed=self.sentences(content, "assumed", place),
            compression=self.figures(tables, "compression", damping),
            shear=self.figures(tables, "shear", damping),
            diagonal=self.figures(tables, "diagonal", damping) if "diagonal" in tables else None,
        )
        self.require_empty(content, place)
        return sheet

    def damping_range(self, content: dict[str, Any], damping: float | None, place: str) -> tuple[float, float] | None:
        """Take the vendor's range of damping ratios out of the table; the target must lie inside."""
        if "damping_range" not in content:
            return None
        ends = content.pop("damping_range")
        if not isinstance(ends, list) or len(ends) != 2 or not all(isinstance(end, int | float) for end in ends):
            raise ModelError(f"{place} `damping_range` must be [lowest, highest], got {ends!r}.")
        if damping is not None and not ends[0] <= damping <= ends[1]:
            raise ModelError(f"{place} `damping_target` must lie in the range {ends}, got {damping}.")
        return float(ends[0]), float(ends[1])

    def figures(self, tables: dict[str, Any], axis: str, damping: float | None) -> Stiffnesses | Points:
        """Return the figures of one axis: two stiffnesses, or two points and a resonance."""
        place = f"{self.path}: [{axis}]"
        if not isinstance(tables[axis], dict):
            raise ModelError(f"{place} must be a table, got {tables[axis]!r}.")
        table = dict(tables[axis])
        wanted = _POINT_FIGURES if any(key.startswith("resonance") for key in table) else _STIFFNESS_FIGURES
        found = {name: self.quantity(table, name, units, place) for name, units in wanted.items()}
        self.require_empty(table, place)
        if wanted is _STIFFNESS_FIGURES:
            if damping is None:
                raise ModelError(
                    f"{self.path}: `damping_target` is missing: two stiffnesses do not fix the loop's width."
                )
            return Stiffnesses(
                travel=found["travel"],
                vibration=found["vibration_stiffness"],
                shock=found["shock_stiffness"],
                damping=damping,
            )
        if found["static_deflection"] >= found["travel"]:
            raise ModelError(f"{place} `static_deflection` must be below `travel`.")
        return Points(
            static_force=found["static_load"],
            static_deflection=found["static_deflection"],
            shock_force=found["shock_load"],
            travel=found["travel"],
            resonance=found["resonance"],
        )

    def quantity(self, table: dict[str, Any], name: str, units: tuple[str, ...], place: str) -> float:
        """Take the figure `name` with one of `units` at its end out of the table and return it in SI."""
        for unit in units:
            if f"{name}_{unit}" in table:
                value = self.number(table, f"{name}_{unit}", place) * _UNITS[unit]
                return float(f"{value:.12g}")  # 45.2 mm are 0.0452 m, not 0.045200000000000004 m
        wanted = " or ".join(f"`{name}_{unit}`" for unit in units)
        raise ModelError(f"{place} {wanted} is missing.")

    def number(self, table: dict[str, Any], key: str, place: str) -> float:
        """Take a number > 0 out of the table."""
        if key not in table:
            raise ModelError(f"{place} `{key}` is missing.")
        value = table.pop(key)
        if isinstance(value, bool) or not isinstance(value, int | float) or not 0.0 < value < math.inf:
            raise ModelError(f"{place} `{key}` must be a finite number > 0, got {value!r}.")
        return float(value)

    def text(self, table: dict[str, Any], key: str, place: str) -> str:
        """Take a string out of the table."""
        if not isinstance(table.get(key), str):
            raise ModelError(f"{place} `{key}` must be a string, got {table.get(key)!r}.")
        return str(table.pop(key))

    def sentences(self, table: dict[str, Any], key: str, place: str) -> tuple[str, ...]:
        """Take a list of strings out of the table, empty if it is not there."""
        found = table.pop(key, [])
        if not isinstance(found, list) or not all(isinstance(item, str) for item in found):
            raise ModelError(f"{place} `{key}` must be a list of strings, got {found!r}.")
        return tuple(found)

    def require_empty(self, table: dict[str, Any], place: str) -> None:
        """Raise ModelError if anything is left that nobody asked for."""
        for key in table:
            raise ModelError(f"{place} `{key}` is not known.")
