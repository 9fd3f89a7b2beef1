"""Data sheets of vendors as TOML files, in the vendor's own units, and their values in SI units.

Every value carries its unit in its key, `travel_mm` or `travel_in`, `shock_stiffness_N_per_mm` or `..._lb_per_in`.
A sheet has the tables [compression] and [shear] (which also stands for roll, as in the catalogues, unless there is [roll]), and
[diagonal] if the vendor states values at 45 degrees: they are compared, never fitted. What its keys mean stands at the fields
of `DataSheet` and `AxisValues`. `scales = 2` fits friction on two scales by the rule of
`wirerope_mj.mounts.vendor_parts.secants`; the damping ratio is then that of the vibration stiffness' amplitude where
`damping_amplitude` does not say otherwise.
"""

import math
from dataclasses import dataclass, replace
from functools import cached_property
from pathlib import Path
from typing import Annotated, Literal

from wirerope_mj.foundation.structure import NEEDED, In, Key, Place, bounds, structure
from wirerope_mj.foundation.toml_file import read_toml
from wirerope_mj.foundation.units import FORCE_UNITS, LENGTH_UNITS, STANDARD_GRAVITY, STIFFNESS_UNITS
from wirerope_mj.mounts.isolator import Temperature
from wirerope_mj.mounts.rope_loop import LoopShape, loop_shape
from wirerope_mj.mounts.vendor_parts.law_values import Secant
from wirerope_mj.mounts.vendor_parts.secants import DAMPING_AMPLITUDE, VIBRATION_AMPLITUDE


@dataclass(frozen=True, kw_only=True)
class StatedValue(Secant):
    """One value of a data sheet as a secant stiffness."""

    name: str
    unit: str = "N/mm"  # that it is printed in: N/mm, N (the force at the deflection) or Hz (of the mass of the static load)
    fitted: bool = True  # whether the law is fitted to it
    mass: float = math.nan  # of a resonance [kg]

    @property
    def key(self) -> str:
        return self.name.replace(" ", "_")

    def shown(self, stiffness: float) -> float:
        """Convert a secant stiffness [N/m] to the stated quantity, in its unit."""
        if self.unit == "N":
            return stiffness * self.deflection
        if self.unit == "Hz":
            return math.sqrt(stiffness / self.mass) / (2.0 * math.pi)
        return 1e-3 * stiffness

    def beside(self, axis: str, stiffness: float) -> "ComparedValue":
        """Put the stated value beside that of a law, given by its secant stiffness [N/m]."""
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
        return None if self.vendor is None else self.fitted / self.vendor - 1.0


def two_stiffnesses(travel: float, vibration: float, shock: float, amplitude: float | None = None) -> tuple[StatedValue, ...]:
    """Return a vibration stiffness and a shock stiffness [N/m] as stated values of an axis with a rated travel [m].

    They are the secants of the steady loop of an amplitude [m], `VIBRATION_AMPLITUDE` of the travel by default, and of the
    virgin path at the travel.
    """
    small = VIBRATION_AMPLITUDE * travel if amplitude is None else amplitude
    of_loop = StatedValue(name="vibration stiffness", deflection=small, stiffness=vibration, steady=True)
    return of_loop, StatedValue(name="shock stiffness", deflection=travel, stiffness=shock, steady=False)


_LARGEST = 1e9  # number that no data sheet states, in any of its units; nor does any state one over it
Number = Annotated[float, bounds(ge=1.0 / _LARGEST, le=_LARGEST)]
Length = Annotated[Number, In({unit: LENGTH_UNITS[unit] for unit in ("mm", "in")})]
# a sheet's pound of load is one of force, as that of its stiffness in lb/in
Force = Annotated[Number, In({unit: FORCE_UNITS[unit] for unit in ("N", "daN", "kN", "lbf")} | {"lb": FORCE_UNITS["lbf"]})]
Stiffness = Annotated[Number, In({unit.replace("/", "_per_"): value for unit, value in STIFFNESS_UNITS.items()})]
Pairs = tuple[tuple[Number, Number], ...]


@dataclass(frozen=True, kw_only=True)
class AxisValues:
    """Values that a data sheet states of one axis, of which at least two are fitted."""

    travel: Length  #: rated
    vibration_stiffness: Stiffness | None = None  #: secant of the steady loop of `vibration_amplitude`
    vibration_amplitude: Length | None = None
    shock_stiffness: Stiffness | None = None  #: secant of the virgin path at the travel
    static_load: Force | None = None  #: on the virgin path at `static_deflection`
    static_deflection: Length | None = None
    shock_load: Force | None = None  #: on the virgin path at the travel
    #: of the mass of the static load [Hz]; compared only
    resonance: Annotated[Number, Key("resonance_Hz")] | None = None
    #: [[deflection, force], ...] of a force-deflection curve: the virgin path
    points: Annotated[Pairs, Key("points_mm_N")] = ()
    #: [[amplitude, secant stiffness], ...] of steady loops
    cycles: Annotated[Pairs, Key("cycles_mm_N_per_mm")] = ()
    damping_target: Number | None = None  #: damping ratio that the fit aims at
    hardening: Number = 1.0  #: k3 / k1 in parts of that of the rope loop
    compared: tuple[str, ...] = ()  #: values that are printed beside the fit and not fitted

    def __post_init__(self) -> None:
        if self.static_load is not None and self.static_deflection is None:
            raise ValueError("`static_deflection_mm` or `static_deflection_in` is missing.")
        if self.static_deflection is not None and self.static_deflection >= self.travel:
            raise ValueError("`static_deflection` must be below `travel`.")
        if self.resonance is not None and self.static_load is None:
            raise ValueError("`resonance_Hz` needs the static load whose mass it is of.")
        for name in self.compared:
            if name not in [value.key for value in self.stated]:
                raise ValueError(f"`compared` names {name!r}, which the table does not state.")
        if len(self.fitted) < 2:
            raise ValueError("it must state at least two stiffnesses or points to fit.")

    @cached_property
    def stated(self) -> tuple[StatedValue, ...]:
        """Stated values as secant stiffnesses."""
        vibration, shock = self.vibration_stiffness, self.shock_stiffness
        both = two_stiffnesses(self.travel, vibration or 0.0, shock or 0.0, self.vibration_amplitude)
        stated = [value for value in both if value.stiffness > 0.0]
        if self.static_load is not None and self.static_deflection is not None:
            stated.append(_force("static force", self.static_deflection, self.static_load))
            if self.resonance is not None:
                mass = self.static_load / STANDARD_GRAVITY
                stiffness = mass * (2.0 * math.pi * self.resonance) ** 2
                resonance = StatedValue(
                    name="resonance", unit="Hz", steady=True, fitted=False, deflection=self.static_deflection,
                    stiffness=stiffness, mass=mass,
                )  # fmt: skip
                stated.append(resonance)
        if self.shock_load is not None:
            stated.append(_force("shock force", self.travel, self.shock_load))
        stated += [_force(f"force at {x:g} mm", 1e-3 * x, force) for x, force in self.points]
        stated += [
            StatedValue(name=f"cycles of {x:g} mm", deflection=1e-3 * x, stiffness=1e3 * stiffness, steady=True)
            for x, stiffness in self.cycles
        ]
        return tuple(replace(value, fitted=value.fitted and value.key not in self.compared) for value in stated)

    @property
    def fitted(self) -> tuple[StatedValue, ...]:
        return tuple(value for value in self.stated if value.fitted)


def _force(name: str, deflection: float, force: float) -> StatedValue:
    return StatedValue(name=name, unit="N", deflection=deflection, stiffness=force / deflection, steady=False)


@dataclass(frozen=True, kw_only=True)
class DataSheet:
    """A vendor's data sheet of one isolator."""

    name: str  #: of the part
    source: str  #: the document that its values are from
    height: Length  #: unloaded
    width: Length  #: across the bars
    rope: Length  #: diameter
    bar: Length  #: thickness of one bar
    bar_assumed: bool = False  #: no source states the bars: bottoming is then not judged
    bar_length: Length | None = None
    loops: Annotated[int, bounds(gt=0)] | None = None
    static_load: Annotated[Force, NEEDED] | None = None  #: rated, in compression; None of a part whose table has none
    damping_target: Number | None = None  #: of compression, where its table has none
    stated_amplitude: Annotated[Length, Key("damping_amplitude")] | None = None  #: of the loop of the damping ratios
    damping_range: tuple[float, float] | None = None  #: [lowest, highest] that the vendor states
    yield_deflection: Length | None = None  #: in place of a damping ratio
    scales: Literal[1, 2] = 1  #: of friction
    temperature: Temperature | None = None  #: factors over temperature, which the isolator keeps
    assumed: tuple[str, ...] = ()  #: sentences on what the sheet does not say
    compression: AxisValues
    shear: Annotated[AxisValues | None, NEEDED] = None  #: of roll, too, unless it says otherwise
    #: "rope loop": the table of shear is that of shear alone, and roll follows from the loop
    stated_roll: Annotated[AxisValues | Literal["rope loop"] | None, Key("roll")] = None
    diagonal: AxisValues | None = None  #: the same at 45 degrees: compared, never fitted

    def __post_init__(self) -> None:
        if self.compression.damping_target is None:
            object.__setattr__(self, "compression", replace(self.compression, damping_target=self.damping_target))
        if (self.yield_deflection is None) == (self.compression.damping_target is None):
            raise ValueError("give either `damping_target` or `yield_deflection_mm`: stiffnesses do not fix the loop's width.")
        low, high = self.damping_range or (0.0, math.inf)
        for table in (self.compression, self.shear, self.roll, self.diagonal):
            target = None if table is None else table.damping_target
            if target is not None and not low <= target <= high:
                raise ValueError(f"`damping_target` must lie in the range {[low, high]}, got {target}.")

    @property
    def roll(self) -> AxisValues | None:
        return self.stated_roll if isinstance(self.stated_roll, AxisValues) else None

    @property
    def roll_of_loop(self) -> bool:
        """Whether roll follows from the rope loop; else it is the same as shear."""
        return self.stated_roll == "rope loop"

    @property
    def damping_amplitude(self) -> float:
        """Amplitude of the damping ratios [m]."""
        if self.stated_amplitude or self.scales == 1:
            return self.stated_amplitude or DAMPING_AMPLITUDE
        small = (value.deflection for value in self.compression.stated if value.name == "vibration stiffness")
        return next(small, VIBRATION_AMPLITUDE * self.compression.travel)

    @cached_property
    def shape(self) -> LoopShape:
        return loop_shape(height=self.height, width=self.width, bar=self.bar, rope=self.rope)

    @property
    def across(self) -> dict[str, AxisValues]:
        single_values = {"shear" if self.stated_roll else "shear and roll": self.shear, "roll": self.roll}
        return {name: values for name, values in single_values.items() if values is not None}


def read_datasheet(path: str | Path) -> DataSheet:
    """Return the data sheet in a TOML file; ModelError names file, line, table, key and rule."""
    return structure(DataSheet, read_toml(path, "data sheet"), Place(Path(path)))
