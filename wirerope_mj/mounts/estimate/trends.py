"""The parts of a vendor's table beside the elastica of their loops, and trends over them from geometry to values."""

from collections.abc import Sequence
from dataclasses import dataclass
from functools import cache, cached_property
from typing import Literal

import numpy as np

from wirerope_mj.foundation.arrays import Array
from wirerope_mj.mounts.rope_loop import LoopShape, RopeLoop, loop_shape
from wirerope_mj.mounts.vendor_parts.parts import MODES, SERIES, Series, VendorPart, vendor_parts

ENIDINE: Series = next(series for series in SERIES if series.file == "enidine_wr.csv")
Values = dict[str, float]  # of an isolator in SI by mode and quantity, as "compression shock", and "static load" in compression
QUANTITIES = ("travel", "vibration", "shock")


def stated_values(part: VendorPart) -> Values:
    """List the values that a vendor states of a part."""
    values = {f"{mode} {name}": getattr(part.modes[mode], name) for name in QUANTITIES for mode in MODES}
    stated = {"static load": part.modes["compression"].static_load} | values
    return {name: value for name, value in stated.items() if value is not None}


@dataclass(frozen=True, kw_only=True)
class VendorLoop:
    """One isolator of Enidine's table, in SI units."""

    name: str
    rope: float  # diameter [m]
    loops: int  # their number
    # of the unloaded isolator [m]
    width: float
    height: float
    bar: float  # thickness of one bar [m]
    values: Values

    @cached_property
    def shape(self) -> LoopShape:
        return loop_shape(height=self.height, width=self.width, bar=self.bar, rope=self.rope)

    @cached_property
    def bending_stiffness(self) -> float:
        """EI of the rope [N m^2] that gives the catalogue's shock stiffness in compression."""
        return self.values["compression shock"] / (self.loops * _secant(self.shape, self.values["compression travel"]))


def _secant(shape: LoopShape, compression: float) -> float:
    """Return force over deflection of one loop of rope with EI = 1 N m^2 at a compression [m], in N/m."""
    return -float(RopeLoop(shape).state(0.0, -compression).axial_force) / compression


@cache
def vendor_loops() -> tuple[VendorLoop, ...]:
    """Choose Enidine's 50 parts that state geometry and values in all three modes, in the table's order.

    ModelError: the table cannot be read.
    """
    loops = []
    for part in vendor_parts():
        measures = {name: getattr(part, name) for name in ("rope", "loops", "width", "height", "bar")}
        values = stated_values(part)
        if part.series is ENIDINE and None not in measures.values() and len(values) == 1 + len(QUANTITIES) * len(MODES):
            loops.append(VendorLoop(name=part.name, values=values, **measures))
    return tuple(loops)


LeftOut = Literal["part", "rope size"]
# Rope diameters of the table [m]; outside them nothing was compared and nothing is estimated.
SMALLEST_ROPE, LARGEST_ROPE = 0.0016, 0.0222
SAME_ROPE = 0.02  # Relative difference of two rope diameters that are one size in two units


@dataclass(frozen=True, kw_only=True)
class Trends:
    """Trends from geometry to values over the parts of a vendor's table.

    EI is interpolated between the rope sizes, log over log; each size has the geometric mean of its parts. The compression
    travel is a fraction of the gap between the bars, height - 2 bar: the parts close up at 0.78 to 0.96 of it. Vibration over
    shock stiffness in compression grows with a power of the loop's height. All other values are constant ratios.
    """

    rope: Array
    bending_stiffness: Array
    bar: Array
    gap_fraction: float
    vibration_power: tuple[float, float]
    ratios: dict[str, float]

    def predict(self, *, height: float, width: float, rope: float, bar: float, loops: float) -> Values:
        """Predict the values of an isolator from its geometry [m]; ValueError if no loop or no travel would remain.

        The vibration stiffness in shear is the shock stiffness, as in the table.
        """
        gap = height - 2.0 * bar
        if gap <= 0.0:
            raise ValueError(f"`height` of {height:g} m leaves no gap between two bars of {bar:g} m.")
        shape = loop_shape(height=height, width=width, bar=bar, rope=rope)
        travel = self.gap_fraction * gap
        stiffness = float(np.exp(_interpolated(rope, self.rope, np.log(self.bending_stiffness))))
        shock = loops * stiffness * _secant(shape, travel)
        slope, offset = self.vibration_power
        vibration = shock * float(np.exp(offset + slope * np.log(height - bar)))
        values = {"compression travel": travel, "compression vibration": vibration, "compression shock": shock}
        values |= {name: ratio * _of_compression(name, values) for name, ratio in self.ratios.items()}
        return values | {"shear vibration": values["shear shock"]}

    def bar_of(self, rope: float) -> float:
        """Interpolate the thickness of a bar [m] for a rope diameter [m] between the table's own."""
        return float(np.exp(_interpolated(rope, self.rope, np.log(self.bar))))


# Values that are constant ratios to those of compression.
_IN_RATIO = ("45 travel", "shear travel", "45 shock", "shear shock", "45 vibration", "static load")


def _of_compression(name: str, values: Values) -> float:
    """Return the value in compression to which a value has a constant ratio; for the static load travel x shock stiffness."""
    if name == "static load":
        return values["compression travel"] * values["compression shock"]
    return values[f"compression {name.partition(' ')[2]}"]


def find_trends(rows: Sequence[VendorLoop]) -> Trends:
    """Find the trends over parts of the table: geometric means for each rope size and of ratios, a power of the height."""
    sizes = sorted({row.rope for row in rows})
    of_size = [[row for row in rows if row.rope == size] for size in sizes]
    stiffer = [row.values["compression vibration"] / row.values["compression shock"] for row in rows]
    slope, offset = np.polyfit(np.log([row.height - row.bar for row in rows]), np.log(stiffer), 1)
    return Trends(
        rope=np.array(sizes),
        bending_stiffness=np.array([_mean([row.bending_stiffness for row in some]) for some in of_size]),
        bar=np.array([_mean([row.bar for row in some]) for some in of_size]),
        gap_fraction=_mean([row.values["compression travel"] / (row.height - 2.0 * row.bar) for row in rows]),
        vibration_power=(float(slope), float(offset)),
        ratios={name: _mean([row.values[name] / _of_compression(name, row.values) for row in rows]) for name in _IN_RATIO},
    )


def _mean(values: Sequence[float]) -> float:
    """Return the geometric mean."""
    return float(np.exp(np.mean(np.log(values))))


@cache
def all_trends() -> Trends:
    return find_trends(vendor_loops())


@cache
def left_out_errors(left_out: LeftOut) -> dict[str, Array]:
    """Compute log(estimate / catalogue) of every value, by name, (50,): each part by the trends without it.

    "part": without the row alone, as for a rope size that the table has; "rope size": without all rows with its rope, as for
    one that it has not (the smallest and the largest size are then extrapolated, which no estimate does).
    """
    errors: dict[str, list[float]] = {}
    for row in vendor_loops():
        rest = [part for part in vendor_loops() if (part is not row if left_out == "part" else part.rope != row.rope)]
        measures = {name: getattr(row, name) for name in ("height", "width", "rope", "bar", "loops")}
        for name, value in find_trends(rest).predict(**measures).items():
            errors.setdefault(name, []).append(float(np.log(value / row.values[name])))
    return {name: np.array(values) for name, values in errors.items()}


@cache
def other_vendor_errors() -> dict[str, Array]:
    """Compute log(estimate / data sheet) of the values of VMC's table, to which no trend was fitted, one for each part.

    Their bars are not stated and taken from the trend. The table has no values at 45 degrees.
    """
    trends, errors = all_trends(), dict[str, list[float]]()
    for part in vendor_parts():
        if part.series is ENIDINE or None in (part.height, part.width, part.rope, part.loops):
            continue
        height, width, rope, loops = (float(v or 0.0) for v in (part.height, part.width, part.rope, part.loops))
        predicted = trends.predict(height=height, width=width, rope=rope, bar=trends.bar_of(rope), loops=loops)
        for name, value in stated_values(part).items():
            errors.setdefault(name, []).append(float(np.log(predicted[name] / value)))
    return {name: np.array(values) for name, values in errors.items()}


def _interpolated(rope: float, sizes: Array, values: Array) -> float:
    """Interpolate between rope diameters, linear over their logarithms; outside, along the straight line through all."""
    known, wanted = np.log(sizes), np.log(rope)
    nearest = float(np.clip(wanted, known[0], known[-1]))
    slope = float(np.polyfit(known, values, 1)[0])
    return float(np.interp(nearest, known, values)) + slope * (wanted - nearest)
