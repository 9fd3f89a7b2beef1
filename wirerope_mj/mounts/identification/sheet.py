"""What a vendor's data sheet states of one isolator, in SI units."""

import math
from dataclasses import dataclass

from wirerope_mj.mounts.identification.secants import VIBRATION_AMPLITUDE, Secant


@dataclass(frozen=True, kw_only=True)
class Stated:
    """One figure of a data sheet as a secant stiffness.

    Attributes:
        name: of the figure.
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
        """Return the figure that a secant stiffness [N/m] gives, in its unit."""
        if self.unit == "N":
            return stiffness * self.secant.deflection
        if self.unit == "Hz":
            return math.sqrt(stiffness / self.mass) / (2.0 * math.pi)
        return 1e-3 * stiffness


@dataclass(frozen=True, kw_only=True)
class AxisFigures:
    """What a sheet states of one axis.

    Attributes:
        travel: rated [m].
        stated: the figures.
        damping: damping ratio that the fit aims at [-]; None where it follows from the rest.
        hardening: k3 / k1 in parts of that of the rope loop; 1 unless the sheet says otherwise.
    """

    travel: float
    stated: tuple[Stated, ...]
    damping: float | None = None
    hardening: float = 1.0

    @property
    def fitted(self) -> tuple[Secant, ...]:
        """The secants that the law is fitted to."""
        return tuple(figure.secant for figure in self.stated if figure.fitted)


@dataclass(frozen=True, kw_only=True)
class DataSheet:
    """What a vendor states about one isolator, in SI units.

    Attributes:
        name: of the part.
        source: the document.
        height: unloaded [m].
        width: across the bars [m].
        rope: diameter [m].
        bar: thickness of one bar [m].
        loops: their number; None where it is not stated.
        bar_length: over which the loops are spread [m]; None where it is not stated: then nothing resists turning.
        compression: figures of the axial axis.
        shear: figures of the shear and roll axes; None where there are none.
        diagonal: figures at 45 degrees between compression and roll, None where there are none.
        static_load: rated load in compression [N]; None where it is not stated.
        damping_amplitude: amplitude of the damping ratios [m].
        roll_of_loop: whether roll follows from the rope loop; else it is the same as shear.
        yielding: yield deflection of friction [m]; None where a damping ratio gives it.
        damping_range: lowest and highest damping ratio that the vendor states [-]; None where it states none.
        assumed: what no source gives, one sentence each.
    """

    name: str
    source: str
    height: float
    width: float
    rope: float
    bar: float
    compression: AxisFigures
    shear: AxisFigures | None
    static_load: float | None
    damping_amplitude: float
    loops: int | None = None
    bar_length: float | None = None
    diagonal: AxisFigures | None = None
    roll_of_loop: bool = False
    yielding: float | None = None
    damping_range: tuple[float, float] | None = None
    assumed: tuple[str, ...] = ()


def two_stiffnesses(
    travel: float, vibration: float, shock: float, amplitude: float | None = None
) -> tuple[Stated, ...]:
    """Return a vibration stiffness and a shock stiffness [N/m] as figures.

    Args:
        travel: rated [m].
        vibration: secant of the steady loop of `amplitude`.
        shock: secant of the virgin path at the travel.
        amplitude: [m]; `VIBRATION_AMPLITUDE` of the travel by default.
    """
    small = VIBRATION_AMPLITUDE * travel if amplitude is None else amplitude
    return (
        Stated(
            name="vibration stiffness", unit="N/mm", secant=Secant(deflection=small, stiffness=vibration, steady=True)
        ),
        Stated(name="shock stiffness", unit="N/mm", secant=Secant(deflection=travel, stiffness=shock, steady=False)),
    )
