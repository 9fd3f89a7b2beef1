"""Data sheets of vendors as TOML files, in the vendor's own units.

Every figure carries its unit in its key, `travel_mm` or `travel_in`, `shock_stiffness_N_per_mm` or `..._lb_per_in`.
A sheet has the tables [compression] and [shear] (which also stands for roll, as in the catalogues), and [diagonal] if
the vendor states figures at 45 degrees: they are compared, never fitted. An axis is fitted to the figures that it has:

    vibration_stiffness    secant of the steady loop of `vibration_amplitude` (default: `VIBRATION_AMPLITUDE` of the travel)
    shock_stiffness        secant of the virgin path at the rated travel
    static_load            on the virgin path at `static_deflection`
    shock_load             on the virgin path at the rated travel
    points_mm_N            [[deflection, force], ...] of a force-deflection curve: the virgin path
    cycles_mm_N_per_mm     [[amplitude, secant stiffness], ...] of steady loops
    resonance              of the mass of the static load, cycles of the static deflection about the sag; compared only

`compared` lists figures of an axis that are printed beside the fit and not fitted. `roll = "rope loop"` says that the table
[shear] is that of shear alone: roll is then what the loop gives beside the axial stiffness.
"""

import math
from dataclasses import dataclass, replace
from pathlib import Path
from typing import Any

from wirerope_mj.foundation.errors import ModelError
from wirerope_mj.foundation.toml_file import read_toml
from wirerope_mj.foundation.units import FORCE_UNITS, LENGTH_UNITS, STANDARD_GRAVITY
from wirerope_mj.mounts.identification.secants import DAMPING_AMPLITUDE, Secant
from wirerope_mj.mounts.identification.sheet import AxisFigures, DataSheet, Stated, two_stiffnesses

_UNITS = {
    **LENGTH_UNITS,
    **FORCE_UNITS,
    "N_per_mm": 1e3,
    "lb_per_in": 175.12683524647636,  # 4.4482216152605 N / 0.0254 m
    "Hz": 1.0,
}
LENGTH, FORCE, _STIFFNESS, _FREQUENCY = ("mm", "in"), ("N", "daN", "kN"), ("N_per_mm", "lb_per_in"), ("Hz",)


def read_datasheet(path: str | Path) -> DataSheet:
    """Return the data sheet in a TOML file; ModelError names file, table, key and rule."""
    return Reader(str(path)).sheet(read_toml(path, "data sheet"))


@dataclass(frozen=True)
class Reader:
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
        axes = {key: self.axis(tables[key], f"{self.path}: [{key}]") for key in tables}
        target = self.optional_number(content, "damping_target", place)
        if axes["compression"].damping is None:
            axes["compression"] = replace(axes["compression"], damping=target)
        sheet = DataSheet(
            name=self.text(content, "name", place),
            source=self.text(content, "source", place),
            height=self.quantity(content, "height", LENGTH, place),
            width=self.quantity(content, "width", LENGTH, place),
            rope=self.quantity(content, "rope", LENGTH, place),
            bar=self.quantity(content, "bar", LENGTH, place),
            loops=self.loops(content, place),
            bar_length=self.optional(content, "bar_length", LENGTH, place),
            static_load=self.quantity(content, "static_load", FORCE, place),
            damping_amplitude=self.optional(content, "damping_amplitude", LENGTH, place) or DAMPING_AMPLITUDE,
            roll_of_loop=self.roll_of_loop(content, place),
            yielding=self.optional(content, "yield_deflection", LENGTH, place),
            damping_range=self.damping_range(content, axes, place),
            assumed=self.sentences(content, "assumed", place),
            **axes,
        )
        self.require_empty(content, place)
        if (sheet.yielding is None) == (sheet.compression.damping is None):
            raise ModelError(
                f"{place} give either `damping_target` or `yield_deflection_mm`: stiffnesses do not fix the loop's width."
            )
        return sheet

    def roll_of_loop(self, content: dict[str, Any], place: str) -> bool:
        """Take out of the table whether roll follows from the rope loop."""
        if "roll" not in content:
            return False
        if (value := content.pop("roll")) != "rope loop":
            raise ModelError(f'{place} `roll` must be "rope loop" or absent (as shear), got {value!r}.')
        return True

    def damping_range(
        self, content: dict[str, Any], axes: dict[str, AxisFigures], place: str
    ) -> tuple[float, float] | None:
        """Take the vendor's range of damping ratios out of the table; every target must lie inside."""
        if "damping_range" not in content:
            return None
        ends = content.pop("damping_range")
        if not isinstance(ends, list) or len(ends) != 2 or not all(isinstance(end, int | float) for end in ends):
            raise ModelError(f"{place} `damping_range` must be [lowest, highest], got {ends!r}.")
        for figures in axes.values():
            if figures.damping is not None and not ends[0] <= figures.damping <= ends[1]:
                raise ModelError(f"{place} `damping_target` must lie in the range {ends}, got {figures.damping}.")
        return float(ends[0]), float(ends[1])

    def axis(self, content: Any, place: str) -> AxisFigures:
        """Return the figures of one axis."""
        if not isinstance(content, dict):
            raise ModelError(f"{place} must be a table, got {content!r}.")
        table = dict(content)
        damping = self.optional_number(table, "damping_target", place)
        hardening = self.optional_number(table, "hardening", place)
        compared = self.sentences(table, "compared", place)
        travel = self.quantity(table, "travel", LENGTH, place)
        stated = [
            *self.stiffnesses(table, travel, place),
            *self.loads(table, travel, place),
            *self.curves(table, place),
        ]
        self.require_empty(table, place)
        for name in compared:
            if name not in {figure.name.replace(" ", "_") for figure in stated}:
                raise ModelError(f"{place} `compared` names {name!r}, which the table does not state.")
        figures = tuple(
            replace(figure, fitted=figure.fitted and figure.name.replace(" ", "_") not in compared) for figure in stated
        )
        if sum(figure.fitted for figure in figures) < 2:
            raise ModelError(f"{place} must state at least two stiffnesses or points to fit.")
        return AxisFigures(travel=travel, stated=figures, damping=damping, hardening=hardening or 1.0)

    def stiffnesses(self, table: dict[str, Any], travel: float, place: str) -> list[Stated]:
        """Take vibration and shock stiffness out of the table."""
        amplitude = self.optional(table, "vibration_amplitude", LENGTH, place)
        vibration = self.optional(table, "vibration_stiffness", _STIFFNESS, place)
        shock = self.optional(table, "shock_stiffness", _STIFFNESS, place)
        both = two_stiffnesses(travel, vibration or 0.0, shock or 0.0, amplitude)
        return [figure for figure in both if figure.secant.stiffness > 0.0]

    def loads(self, table: dict[str, Any], travel: float, place: str) -> list[Stated]:
        """Take static and shock load, and the resonance of the static load's mass, out of the table."""
        found: list[Stated] = []
        load, shock = (self.optional(table, f"{name}_load", FORCE, place) for name in ("static", "shock"))
        resonance = self.optional(table, "resonance", _FREQUENCY, place)
        if load is not None:
            depth = self.quantity(table, "static_deflection", LENGTH, place)
            if depth >= travel:
                raise ModelError(f"{place} `static_deflection` must be below `travel`.")
            found.append(_force("static force", depth, load))
            if resonance is not None:
                mass = load / STANDARD_GRAVITY
                secant = Secant(deflection=depth, stiffness=mass * (2.0 * math.pi * resonance) ** 2, steady=True)
                found.append(Stated(name="resonance", unit="Hz", secant=secant, fitted=False, mass=mass))
        elif resonance is not None:
            raise ModelError(f"{place} `resonance_Hz` needs the static load whose mass it is of.")
        if shock is not None:
            found.append(_force("shock force", travel, shock))
        return found

    def curves(self, table: dict[str, Any], place: str) -> list[Stated]:
        """Take points of a force-deflection curve and secants of steady loops out of the table."""
        found = [_force(f"force at {x:g} mm", 1e-3 * x, force) for x, force in self.pairs(table, "points_mm_N", place)]
        for x, stiffness in self.pairs(table, "cycles_mm_N_per_mm", place):
            secant = Secant(deflection=1e-3 * x, stiffness=1e3 * stiffness, steady=True)
            found.append(Stated(name=f"cycles of {x:g} mm", unit="N/mm", secant=secant))
        return found

    def pairs(self, table: dict[str, Any], key: str, place: str) -> list[tuple[float, float]]:
        """Take pairs of numbers > 0 out of the table, none if it has none."""
        rows = table.pop(key, [])
        good = isinstance(rows, list) and all(
            isinstance(row, list) and len(row) == 2 and all(_positive(value) for value in row) for row in rows
        )
        if not good:
            raise ModelError(f"{place} `{key}` must be pairs of numbers > 0, got {rows!r}.")
        return [(float(x), float(y)) for x, y in rows]

    def optional(self, table: dict[str, Any], name: str, units: tuple[str, ...], place: str) -> float | None:
        """Take the quantity `name` out of the table; None if it is not there."""
        if not any(f"{name}_{unit}" in table for unit in units):
            return None
        return self.quantity(table, name, units, place)

    def optional_number(self, table: dict[str, Any], key: str, place: str) -> float | None:
        """Take a number > 0 out of the table; None if it is not there."""
        return self.number(table, key, place) if key in table else None

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
        if not _positive(value):
            raise ModelError(f"{place} `{key}` must be a finite number > 0, got {value!r}.")
        return float(value)

    def loops(self, table: dict[str, Any], place: str) -> int | None:
        """Take the number of loops out of the table; None if it is not there."""
        if "loops" not in table:
            return None
        value = table.pop("loops")
        if isinstance(value, bool) or not isinstance(value, int) or value < 1:
            raise ModelError(f"{place} `loops` must be an integer > 0, got {value!r}.")
        return value

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
            way = " Tension follows from the rope loop: leave it out." if key == "tension_ratio" else ""
            raise ModelError(f"{place} `{key}` is not known.{way}")


def _force(name: str, deflection: float, force: float) -> Stated:
    """Return a force on the virgin path as a figure."""
    return Stated(name=name, unit="N", secant=Secant(deflection=deflection, stiffness=force / deflection, steady=False))


def _positive(value: Any) -> bool:
    """Return whether a value of the file is a finite number > 0."""
    return not isinstance(value, bool) and isinstance(value, int | float) and 0.0 < value < math.inf
