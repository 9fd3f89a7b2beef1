"""Values of one isolator on a vendor's data sheet, in SI units, and beside those of a law."""

import math
from dataclasses import dataclass

from wirerope_mj.mounts.vendor_parts.law_values import Secant
from wirerope_mj.mounts.vendor_parts.secants import VIBRATION_AMPLITUDE


@dataclass(frozen=True, kw_only=True)
class StatedValue:
    """One value of a data sheet as a secant stiffness.

    Attributes:
        unit: that it is printed in: N/mm, N (the force at the deflection) or Hz (of the mass of the static load).
        secant: deflection, stiffness and whether of the steady loop.
        fitted: whether the law is fitted to it.
        mass: of a resonance [kg].
    """

    name: str
    unit: str
    secant: Secant
    fitted: bool = True
    mass: float = math.nan

    def shown(self, stiffness: float) -> float:
        """Return the value that a secant stiffness [N/m] gives, in its unit."""
        if self.unit == "N":
            return stiffness * self.secant.deflection
        if self.unit == "Hz":
            return math.sqrt(stiffness / self.mass) / (2.0 * math.pi)
        return 1e-3 * stiffness


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
    """Values that a sheet states of one axis.

    Attributes:
        travel: rated [m].
        stated: the values.
        damping: damping ratio that the fit aims at [-]; None where it follows from the rest.
        hardening: k3 / k1 in parts of that of the rope loop; 1 unless the sheet says otherwise.
    """

    travel: float
    stated: tuple[StatedValue, ...]
    damping: float | None = None
    hardening: float = 1.0

    @property
    def fitted(self) -> tuple[Secant, ...]:
        """The secants that the law is fitted to."""
        return tuple(value.secant for value in self.stated if value.fitted)


@dataclass(frozen=True, kw_only=True)
class DataSheet:
    """A vendor's data sheet of one isolator, in SI units.

    Attributes:
        source: the document.
        height: unloaded [m].
        width: across the bars [m].
        rope: diameter [m].
        bar: thickness of one bar [m].
        bar_assumed: whether nobody states it: good for the shape of the loop, not for where the bars meet.
        loops: their number; None where it is not stated.
        bar_length: over which the loops are spread [m]; None where it is not stated: then nothing resists turning.
        compression: values of the axial axis.
        shear: values of the shear and roll axes; None where there are none.
        diagonal: values at 45 degrees between compression and roll, None where there are none.
        static_load: rated load in compression [N]; None where it is not stated.
        damping_amplitude: amplitude of the damping ratios [m].
        roll_of_loop: whether roll follows from the rope loop; else it is the same as shear.
        scales: of friction, the number of the rule (`wirerope_mj.mounts.vendor_parts.fit_rule`).
        yielding: yield deflection of friction [m]; None where a damping ratio gives it.
        damping_range: lowest and highest damping ratio that the vendor states [-]; None where it states none.
        assumed: what no source gives, one text each.
    """

    name: str
    source: str
    height: float
    width: float
    rope: float
    bar: float
    compression: AxisValues
    shear: AxisValues | None
    static_load: float | None
    damping_amplitude: float
    bar_assumed: bool = False
    loops: int | None = None
    bar_length: float | None = None
    diagonal: AxisValues | None = None
    roll_of_loop: bool = False
    yielding: float | None = None
    scales: int = 1
    damping_range: tuple[float, float] | None = None
    assumed: tuple[str, ...] = ()


def two_stiffnesses(
    travel: float, vibration: float, shock: float, amplitude: float | None = None
) -> tuple[StatedValue, ...]:
    """Return a vibration stiffness and a shock stiffness [N/m] as stated values.

    Args:
        travel: rated [m].
        vibration: secant of the steady loop of `amplitude`.
        shock: secant of the virgin path at the travel.
        amplitude: [m]; `VIBRATION_AMPLITUDE` of the travel by default.
    """
    small = VIBRATION_AMPLITUDE * travel if amplitude is None else amplitude
    return (
        StatedValue(
            name="vibration stiffness", unit="N/mm", secant=Secant(deflection=small, stiffness=vibration, steady=True)
        ),
        StatedValue(
            name="shock stiffness", unit="N/mm", secant=Secant(deflection=travel, stiffness=shock, steady=False)
        ),
    )
