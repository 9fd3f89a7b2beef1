"""Data sheets of vendors as TOML files, in the vendor's own units, and their values in SI units.

Every value carries its unit in its key, `travel_mm` or `travel_in`, `shock_stiffness_N_per_mm` or `..._lb_per_in`.
A sheet has the tables [compression] and [shear] (which also stands for roll, as in the catalogues, unless there is [roll]), and
[diagonal] if the vendor states values at 45 degrees: they are compared, never fitted. An axis is fitted to the values it has:

    vibration_stiffness    secant of the steady loop of `vibration_amplitude` (default: `VIBRATION_AMPLITUDE` of the travel)
    shock_stiffness        secant of the virgin path at the rated travel
    static_load            on the virgin path at `static_deflection`
    shock_load             on the virgin path at the rated travel
    points_mm_N            [[deflection, force], ...] of a force-deflection curve: the virgin path
    cycles_mm_N_per_mm     [[amplitude, secant stiffness], ...] of steady loops
    resonance              of the mass of the static load, cycles of the static deflection about the sag; compared only

`scales = 2` fits friction on two scales by the rule of `wirerope_mj.mounts.vendor_parts.secants`; the damping ratio is then
that of the vibration stiffness' amplitude where `damping_amplitude` does not say otherwise.

`compared` lists values of an axis that are printed beside the fit and not fitted. `roll = "rope loop"` says that the table
[shear] is that of shear alone: roll is then what the loop gives beside the axial stiffness.
"""

import math
from dataclasses import dataclass, replace
from functools import cached_property
from pathlib import Path

from wirerope_mj.foundation.arrays import Entries
from wirerope_mj.foundation.errors import ModelError
from wirerope_mj.foundation.toml_file import read_toml
from wirerope_mj.foundation.units import STANDARD_GRAVITY
from wirerope_mj.mounts.rope_loop import LoopShape, loop_shape
from wirerope_mj.mounts.vendor_parts.law_values import Secant
from wirerope_mj.mounts.vendor_parts.secants import DAMPING_AMPLITUDE, RULES, VIBRATION_AMPLITUDE
from wirerope_mj.mounts.vendor_parts.toml_table import FORCE, FREQUENCY, LENGTH, STIFFNESS, TomlTable


@dataclass(frozen=True, kw_only=True)
class StatedValue(Secant):
    """One value of a data sheet as a secant stiffness."""

    name: str
    unit: str = "N/mm"  # that it is printed in: N/mm, N (the force at the deflection) or Hz (of the mass of the static load)
    fitted: bool = True  # whether the law is fitted to it
    mass: float = math.nan  # of a resonance [kg]

    def shown(self, stiffness: float) -> float:
        """Return the value that a secant stiffness [N/m] gives, in its unit."""
        if self.unit == "N":
            return stiffness * self.deflection
        if self.unit == "Hz":
            return math.sqrt(stiffness / self.mass) / (2.0 * math.pi)
        return 1e-3 * stiffness

    def beside(self, axis: str, stiffness: float) -> "ComparedValue":
        """Return the value of the sheet beside the secant stiffness [N/m] of a law."""
        vendor, fitted = self.shown(self.stiffness), self.shown(stiffness)
        return ComparedValue(axis=axis, name=self.name, unit=self.unit, vendor=vendor, fitted=fitted)


@dataclass(frozen=True, kw_only=True)
class ComparedValue:
    """One value: where it holds, its name and unit, the vendor's (None: not stated) and the law's."""

    axis: str
    name: str
    unit: str
    vendor: float | None
    fitted: float

    @property
    def error(self) -> float | None:
        """Relative error of the fitted value; None where the vendor states nothing."""
        return None if self.vendor is None else self.fitted / self.vendor - 1.0


@dataclass(frozen=True, kw_only=True)
class AxisValues:
    """Values that a sheet states of one axis."""

    travel: float  # rated [m]
    stated: tuple[StatedValue, ...]  # the values
    damping: float | None = None  # damping ratio that the fit aims at [-]; None where it follows from the rest
    hardening: float = 1.0  # k3 / k1 in parts of that of the rope loop; 1 unless the sheet says otherwise

    @property
    def fitted(self) -> tuple[StatedValue, ...]:
        """The values that the law is fitted to."""
        return tuple(value for value in self.stated if value.fitted)


@dataclass(frozen=True, kw_only=True)
class DataSheet:
    """A vendor's data sheet of one isolator, in SI units."""

    name: str
    source: str  # the document
    height: float  # unloaded [m]
    width: float  # across the bars [m]
    rope: float  # diameter [m]
    bar: float  # thickness of one bar [m]
    compression: AxisValues  # values of the axial axis
    # values of the shear axis, and of roll where it has none of its own; None where there are none
    shear: AxisValues | None
    static_load: float | None  # rated load in compression [N]; None where it is not stated
    damping_amplitude: float  # amplitude of the damping ratios [m]
    bar_assumed: bool = False  # whether nobody states it: good for the shape of the loop, not for where the bars meet
    loops: int | None = None  # their number; None where it is not stated
    # over which the loops are spread [m]; None where it is not stated: then nothing resists turning
    bar_length: float | None = None
    roll: AxisValues | None = None  # values of the roll axis; None where they are those of shear, or of the rope loop
    diagonal: AxisValues | None = None  # values at 45 degrees between compression and roll, None where there are none
    roll_of_loop: bool = False  # whether roll follows from the rope loop; else it is the same as shear
    yielding: float | None = None  # yield deflection of friction [m]; None where a damping ratio gives it
    scales: int = 1  # of friction, the number of the rule (`wirerope_mj.mounts.vendor_parts.secants`)
    # lowest and highest damping ratio that the vendor states [-]; None where it states none
    damping_range: tuple[float, float] | None = None
    assumed: tuple[str, ...] = ()  # what no source gives, one text each

    @cached_property
    def shape(self) -> LoopShape:
        """The half loop of its envelope; ValueError if there is none."""
        return loop_shape(height=self.height, width=self.width, bar=self.bar, rope=self.rope)

    @property
    def across(self) -> dict[str, AxisValues]:
        """Values across the axis, by the axes that they stand for."""
        one = {"shear" if self.roll_of_loop or self.roll else "shear and roll": self.shear, "roll": self.roll}
        return {name: values for name, values in one.items() if values is not None}


def two_stiffnesses(travel: float, vibration: float, shock: float, amplitude: float | None = None) -> tuple[StatedValue, ...]:
    """Return a vibration stiffness and a shock stiffness [N/m] as stated values of an axis with a rated travel [m].

    They are the secants of the steady loop of an amplitude [m], `VIBRATION_AMPLITUDE` of the travel by default, and of the
    virgin path at the travel.
    """
    small = VIBRATION_AMPLITUDE * travel if amplitude is None else amplitude
    of_loop = StatedValue(name="vibration stiffness", deflection=small, stiffness=vibration, steady=True)
    return of_loop, StatedValue(name="shock stiffness", deflection=travel, stiffness=shock, steady=False)


def read_datasheet(path: str | Path) -> DataSheet:
    """Return the data sheet in a TOML file; ModelError names file, table, key and rule."""
    table = TomlTable(read_toml(path, "data sheet"), f"{path}:")
    own_roll = isinstance(table.entries.get("roll"), dict)
    named = ("compression", "shear", "diagonal", *(["roll"] if own_roll else []))
    tables = {key: table.entries.pop(key) for key in named if key in table.entries}
    for key in ("compression", "shear"):
        if key not in tables:
            raise ModelError(f"{path}: the table [{key}] is missing.")
    axes: Entries = {key: _axis(TomlTable(content, f"{path}: [{key}]")) for key, content in tables.items()}
    target, scales = table.optional_number("damping_target"), table.optional_integer("scales") or 1
    if scales not in RULES:
        raise ModelError(f"{path}: `scales` must be {' or '.join(map(str, RULES))}, got {scales}.")
    if axes["compression"].damping is None:
        axes["compression"] = replace(axes["compression"], damping=target)
    height, width, rope, bar = (table.quantity(name, LENGTH) for name in ("height", "width", "rope", "bar"))
    sheet = DataSheet(
        name=table.text("name"), source=table.text("source"), height=height, width=width, rope=rope, bar=bar,
        bar_assumed=table.flag("bar_assumed"), loops=table.optional_integer("loops"),
        bar_length=table.optional_quantity("bar_length", LENGTH), static_load=table.quantity("static_load", FORCE),
        damping_amplitude=table.optional_quantity("damping_amplitude", LENGTH)
        or _damping_amplitude(axes["compression"], scales),
        scales=scales, roll_of_loop=_roll_of_loop(table), yielding=table.optional_quantity("yield_deflection", LENGTH),
        damping_range=_damping_range(table, axes), assumed=table.texts("assumed"), **axes,
    )  # fmt: skip
    table.require_empty()
    if (sheet.yielding is None) == (sheet.compression.damping is None):
        raise ModelError(
            f"{path}: give either `damping_target` or `yield_deflection_mm`: stiffnesses do not fix the loop's width."
        )
    return sheet


def _damping_amplitude(compression: AxisValues, scales: int) -> float:
    """Return the amplitude of damping ratios where the sheet states none [m]."""
    if scales == 1:
        return DAMPING_AMPLITUDE
    small = (value.deflection for value in compression.stated if value.name == "vibration stiffness")
    return next(small, VIBRATION_AMPLITUDE * compression.travel)


def _roll_of_loop(table: TomlTable) -> bool:
    if "roll" not in table.entries:
        return False
    if (value := table.entries.pop("roll")) != "rope loop":
        raise ModelError(f'{table.location} `roll` must be a table [roll], "rope loop", or absent (as shear), got {value!r}.')
    return True


def _damping_range(table: TomlTable, axes: dict[str, AxisValues]) -> tuple[float, float] | None:
    """Take the vendor's range of damping ratios; every target must lie inside."""
    if "damping_range" not in table.entries:
        return None
    ends = table.entries.pop("damping_range")
    if not isinstance(ends, list) or len(ends) != 2 or not all(isinstance(end, int | float) for end in ends):
        raise ModelError(f"{table.location} `damping_range` must be [lowest, highest], got {ends!r}.")
    for values in axes.values():
        if values.damping is not None and not ends[0] <= values.damping <= ends[1]:
            raise ModelError(f"{table.location} `damping_target` must lie in the range {ends}, got {values.damping}.")
    return float(ends[0]), float(ends[1])


def _axis(table: TomlTable) -> AxisValues:
    """Return the values of one axis."""
    damping, hardening = table.optional_number("damping_target"), table.optional_number("hardening")
    compared, travel = table.texts("compared"), table.quantity("travel", LENGTH)
    amplitude = table.optional_quantity("vibration_amplitude", LENGTH)
    vibration, shock = (table.optional_quantity(f"{name}_stiffness", STIFFNESS) for name in ("vibration", "shock"))
    both = two_stiffnesses(travel, vibration or 0.0, shock or 0.0, amplitude)
    stiffnesses = [value for value in both if value.stiffness > 0.0]
    stated = [*stiffnesses, *_loads(table, travel), *_curve_points(table)]
    table.require_empty()
    names = [value.name.replace(" ", "_") for value in stated]
    for name in compared:
        if name not in names:
            raise ModelError(f"{table.location} `compared` names {name!r}, which the table does not state.")
    pairs = zip(names, stated, strict=True)
    values = tuple(replace(value, fitted=value.fitted and name not in compared) for name, value in pairs)
    if sum(value.fitted for value in values) < 2:
        raise ModelError(f"{table.location} must state at least two stiffnesses or points to fit.")
    return AxisValues(travel=travel, stated=values, damping=damping, hardening=hardening or 1.0)


def _loads(table: TomlTable, travel: float) -> list[StatedValue]:
    """Take static and shock load, and the resonance of the static load's mass."""
    values: list[StatedValue] = []
    load, shock = (table.optional_quantity(f"{name}_load", FORCE) for name in ("static", "shock"))
    resonance = table.optional_quantity("resonance", FREQUENCY)
    if load is not None:
        depth = table.quantity("static_deflection", LENGTH)
        if depth >= travel:
            raise ModelError(f"{table.location} `static_deflection` must be below `travel`.")
        values.append(_force("static force", depth, load))
        if resonance is not None:
            mass = load / STANDARD_GRAVITY
            size = {"deflection": depth, "stiffness": mass * (2.0 * math.pi * resonance) ** 2, "mass": mass}
            values.append(StatedValue(name="resonance", unit="Hz", steady=True, fitted=False, **size))
    elif resonance is not None:
        raise ModelError(f"{table.location} `resonance_Hz` needs the static load whose mass it is of.")
    if shock is not None:
        values.append(_force("shock force", travel, shock))
    return values


def _curve_points(table: TomlTable) -> list[StatedValue]:
    """Take points of a force-deflection curve and secants of steady loops."""
    values = [_force(f"force at {x:g} mm", 1e-3 * x, force) for x, force in table.pairs("points_mm_N")]
    return values + [
        StatedValue(name=f"cycles of {x:g} mm", deflection=1e-3 * x, stiffness=1e3 * stiffness, steady=True)
        for x, stiffness in table.pairs("cycles_mm_N_per_mm")
    ]


def _force(name: str, deflection: float, force: float) -> StatedValue:
    """Return a force on the virgin path as a stated value."""
    return StatedValue(name=name, unit="N", deflection=deflection, stiffness=force / deflection, steady=False)
