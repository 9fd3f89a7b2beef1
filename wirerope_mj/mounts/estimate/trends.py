"""The parts of a vendor's table beside the elastica of their loops, and trends over them from geometry to values."""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from functools import cache
from typing import Literal

import numpy as np

from wirerope_mj.foundation.arrays import Array
from wirerope_mj.mounts.rope_loop import LoopShape, RopeLoop, loop_shape
from wirerope_mj.mounts.vendor_parts.parts import MODES, SERIES, Series, VendorPart, vendor_parts

ENIDINE: Series = next(series for series in SERIES if series.file == "enidine_wr.csv")


@dataclass(frozen=True, kw_only=True)
class VendorLoop:
    """One isolator of the table, SI units."""

    name: str
    rope: float  # diameter [m]
    loops: int  # their number
    # of the unloaded isolator [m]
    width: float
    height: float
    bar: float  # thickness of one bar [m]
    # largest static load [N], largest deflection [m], stiffness of small vibration and mean stiffness over the travel [N/m],
    # by mode: compression, 45, and shear, which stands for roll as well
    static_load: Mapping[str, float]
    travel: Mapping[str, float]
    vibration: Mapping[str, float]
    shock: Mapping[str, float]

    @property
    def shape(self) -> LoopShape:
        """The half loop of its envelope."""
        return loop_shape(height=self.height, width=self.width, bar=self.bar, rope=self.rope)


@cache
def vendor_loops() -> tuple[VendorLoop, ...]:
    """Return the 50 parts that state geometry and all three modes, in their order.

    ModelError: the table cannot be read.
    """
    loops = (_loop(part) for part in vendor_parts() if part.series is ENIDINE)
    return tuple(loop for loop in loops if loop is not None)


def _loop(part: VendorPart) -> VendorLoop | None:
    """Return a part's loops, None where the table leaves something out."""
    rope, loops, width, height, bar = part.rope, part.loops, part.width, part.height, part.bar
    if rope is None or loops is None or width is None or height is None or bar is None:
        return None

    names = ("static_load", "travel", "vibration", "shock")
    values = {name: {mode: getattr(part.modes[mode], name) for mode in MODES} for name in names}
    if any(value is None for by_mode in values.values() for value in by_mode.values()):
        return None
    return VendorLoop(name=part.name, rope=rope, loops=loops, width=width, height=height, bar=bar, **values)


@dataclass(frozen=True, kw_only=True)
class Secants:
    """Force over deflection of a loop at three deflections from the unloaded position [N/m]."""

    compression: float  # straight down
    roll: float  # straight across the bars
    diagonal: float  # straight at 45 degrees between both; the force is the component along that line


@dataclass(frozen=True, kw_only=True)
class LoopCheck:
    """One isolator of a vendor beside the elastica; errors are prediction over catalogue - 1."""

    part: VendorLoop  # row of the table
    bending_stiffness: float  # EI of the rope [N m^2] that gives the catalogue's shock stiffness in compression
    roll_error: float  # of the shock stiffness in roll, which the catalogue has in one table with shear
    diagonal_error: float  # of the shock stiffness at 45 degrees


def loop_secants(shape: LoopShape, *, compression: float, roll: float, diagonal: float) -> Secants:
    """Return the secants of one loop of EI = 1 N m^2 at three travels [m], each > 0."""
    across = diagonal / np.sqrt(2.0)
    state = RopeLoop(shape).state([0.0, roll, across], [-compression, 0.0, -across])
    return Secants(
        compression=float(-state.axial_force[0] / compression),
        roll=float(state.roll_force[1] / roll),
        diagonal=float((state.roll_force[2] - state.axial_force[2]) / np.sqrt(2.0) / diagonal),
    )


@cache
def check_vendor_loops() -> tuple[LoopCheck, ...]:
    """Return all 50 rows beside the elastica; nothing is fitted but one EI for each row, to its compression."""
    return tuple(_check(part) for part in vendor_loops())


def _check(part: VendorLoop) -> LoopCheck:
    """Return one row beside the elastica."""
    travel = part.travel
    secants = loop_secants(part.shape, compression=travel["compression"], roll=travel["shear"], diagonal=travel["45"])
    stiffness = part.shock["compression"] / (part.loops * secants.compression)
    scale = stiffness * part.loops
    return LoopCheck(
        part=part, bending_stiffness=stiffness, roll_error=scale * secants.roll / part.shock["shear"] - 1.0,
        diagonal_error=scale * secants.diagonal / part.shock["45"] - 1.0,
    )  # fmt: skip


LeftOut = Literal["part", "rope size"]
# Rope diameters of the table [m]; outside them nothing was compared and nothing is estimated.
SMALLEST_ROPE, LARGEST_ROPE = 0.0016, 0.0222
SAME_ROPE = 0.02  # Relative difference of two rope diameters that are one size in two units


@dataclass(frozen=True, kw_only=True)
class LoopValues:
    """Estimated values of an isolator, in SI units; modes as in the vendor's table, shear standing for roll as well."""

    bending_stiffness: float  # EI of the rope over the compression travel [N m^2]
    travel: dict[str, float]  # largest deflection [m], by mode
    # stiffness [N/m], by mode; the table's vibration stiffness in shear is its shock stiffness
    vibration: dict[str, float]
    shock: dict[str, float]
    static_load: float  # largest static load in compression [N]

    def flat(self) -> dict[str, float]:
        """Return the values that a vendor states, by name."""
        named = {"static load": self.static_load}
        for name in ("travel", "vibration", "shock"):
            named |= {f"{mode} {name}": value for mode, value in getattr(self, name).items()}
        return named


@dataclass(frozen=True, kw_only=True)
class Trends:
    """Trends over the parts of a table.

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

    def predict(self, *, height: float, width: float, rope: float, bar: float, loops: float) -> LoopValues:
        """Return the values of an isolator from its geometry [m]; ValueError if it leaves no loop or no travel."""
        gap = height - 2.0 * bar
        if gap <= 0.0:
            raise ValueError(f"`height` of {height:g} m leaves no gap between two bars of {bar:g} m.")
        shape = loop_shape(height=height, width=width, bar=bar, rope=rope)
        travel = self.gap_fraction * gap
        stiffness = float(np.exp(_interpolated(rope, self.rope, np.log(self.bending_stiffness))))
        secant = -float(RopeLoop(shape).state(0.0, -travel).axial_force) / travel
        shock = loops * stiffness * secant
        slope, offset = self.vibration_power
        vibration = shock * float(np.exp(offset + slope * np.log(height - bar)))
        ratios, modes = self.ratios, ("45", "shear")
        shocks = {"compression": shock, **{mode: ratios[f"{mode} shock"] * shock for mode in modes}}
        return LoopValues(
            bending_stiffness=stiffness,
            travel={"compression": travel, **{mode: ratios[f"{mode} travel"] * travel for mode in modes}},
            shock=shocks,
            vibration={"compression": vibration, "45": ratios["45 vibration"] * vibration, "shear": shocks["shear"]},
            static_load=ratios["static load"] * shock * travel,
        )

    def bar_of(self, rope: float) -> float:
        """Return the thickness of a bar [m] for a rope diameter [m], interpolated between the table's own."""
        return float(np.exp(_interpolated(rope, self.rope, np.log(self.bar))))


def find_trends(parts: Sequence[int]) -> Trends:
    """Return the trends over the rows of `vendor_loops` with these indices."""
    checks = [check_vendor_loops()[index] for index in parts]
    rows = [check.part for check in checks]
    sizes = sorted({row.rope for row in rows})
    travel = np.array([row.travel["compression"] for row in rows])
    shock = np.array([row.shock["compression"] for row in rows])
    vibration = np.array([row.vibration["compression"] for row in rows])

    def mean(values: Array) -> float:
        return float(np.exp(np.mean(np.log(values))))

    def column(name: str, mode: str) -> Array:
        return np.array([getattr(row, name)[mode] for row in rows])

    stiffness = [mean(np.array([c.bending_stiffness for c in checks if c.part.rope == size])) for size in sizes]
    slope, offset = np.polyfit(np.log([row.height - row.bar for row in rows]), np.log(vibration / shock), 1)
    return Trends(
        rope=np.array(sizes),
        bending_stiffness=np.array(stiffness),
        bar=np.array([mean(np.array([row.bar for row in rows if row.rope == size])) for size in sizes]),
        gap_fraction=mean(travel / np.array([row.height - 2.0 * row.bar for row in rows])),
        vibration_power=(float(slope), float(offset)),
        ratios={
            "45 travel": mean(column("travel", "45") / travel),
            "shear travel": mean(column("travel", "shear") / travel),
            "45 shock": mean(column("shock", "45") / shock),
            "shear shock": mean(column("shock", "shear") / shock),
            "45 vibration": mean(column("vibration", "45") / vibration),
            "static load": mean(column("static_load", "compression") / (shock * travel)),
        },
    )


@cache
def all_trends() -> Trends:
    """Return the trends over all 50 rows."""
    return find_trends(range(len(check_vendor_loops())))


@cache
def left_out_errors(left_out: LeftOut) -> dict[str, Array]:
    """Return log(estimate / catalogue) of every value, (50,), each row estimated without itself.

    "part": without the row alone, as for a rope size that the table has; "rope size": without all rows with its rope, as for
    one that it has not (the smallest and the largest size are then extrapolated, which no estimate does).
    """
    rows = [check.part for check in check_vendor_loops()]
    errors: dict[str, list[float]] = {}
    for index, row in enumerate(rows):
        others = [i for i, other in enumerate(rows) if (i != index if left_out == "part" else other.rope != row.rope)]
        measures = {name: getattr(row, name) for name in ("height", "width", "rope", "bar", "loops")}
        predicted = find_trends(others).predict(**measures)
        stated = LoopValues(
            bending_stiffness=1.0, travel=dict(row.travel), vibration=dict(row.vibration), shock=dict(row.shock),
            static_load=row.static_load["compression"],
        )  # fmt: skip
        for name, value in predicted.flat().items():
            errors.setdefault(name, []).append(float(np.log(value / stated.flat()[name])))
    return {name: np.array(values) for name, values in errors.items()}


@cache
def other_vendor_errors() -> dict[str, Array]:
    """Return log(estimate / data sheet) of the values of VMC's table, which no trend has seen; one for each part stating it.

    Their bars are not stated and taken from the trend. The table has no values at 45 degrees.
    """
    trends, errors = all_trends(), dict[str, list[float]]()
    for part in vendor_parts():
        if part.series is ENIDINE or None in (part.height, part.width, part.rope, part.loops):
            continue
        height, width, rope, loops = (float(v or 0.0) for v in (part.height, part.width, part.rope, part.loops))
        predicted = trends.predict(height=height, width=width, rope=rope, bar=trends.bar_of(rope), loops=loops).flat()
        for mode, values in part.modes.items():
            stated = {f"{mode} {name}": getattr(values, name) for name in ("travel", "vibration", "shock")}
            if mode == "compression":
                stated["static load"] = values.static_load
            for name, value in stated.items():
                if value is not None:
                    errors.setdefault(name, []).append(float(np.log(predicted[name] / value)))
    return {name: np.array(values) for name, values in errors.items()}


def _interpolated(rope: float, sizes: Array, values: Array) -> float:
    """Return a value between rope sizes, linear over log d; outside, along the straight line through all sizes."""
    known, wanted = np.log(sizes), np.log(rope)
    nearest = float(np.clip(wanted, known[0], known[-1]))
    slope = float(np.polyfit(known, values, 1)[0])
    return float(np.interp(nearest, known, values)) + slope * (wanted - nearest)
