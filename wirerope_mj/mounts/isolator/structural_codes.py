"""An isolator's laws as entries of structural codes: static curves as tables, and a stiffness and damping for one amplitude.

Nastran has CBUSH with PBUSH and PBUSHT (tables TABLED1), Abaqus a connector, Ansys COMBIN39 with COMBIN14 beside it. All of
them are elastic: what a loop dissipates stands beside the table as damping of one amplitude, and what that leaves out is said.
"""

import math
import textwrap
from collections.abc import Callable, Iterator, Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Literal

import numpy as np

from wirerope_mj.foundation.arrays import Array
from wirerope_mj.foundation.units import STANDARD_GRAVITY
from wirerope_mj.mounts.isolator.device import Isolator, largest_amplitude
from wirerope_mj.mounts.isolator.tables import AXES
from wirerope_mj.mounts.laws import Law, Loop
from wirerope_mj.mounts.test_rig import cyclic_test

Units = Literal["N-m-kg", "N-mm-t"]
Damping = Literal["structural", "viscous"]
CLOSE = 1e-6  # of the largest force, which straight lines between the points of a table may miss the curve by
_ANSYS_POINTS = 20  # of a COMBIN39, the origin among them
_SAMPLES = 5_000  # of a curve's side, among which points are chosen
_MOST = 4_000  # points of a side
_FRACTIONS = (0.1, 1.0)  # of the range on its shorter side, at which loops say how far secants differ


@dataclass(frozen=True, kw_only=True)
class AxisTable:
    """One axis of an isolator for structural codes: points of its static curve, a closed loop, and their differences."""

    axis: str  # roll, shear or axial
    points: Array  # of the static curve, first loading from rest: deflection [m] and force [N], (n, 2), rising, the origin one
    missed: float  # largest distance of the straight lines between them from the curve, over the largest force [-]
    loop: Loop  # closed cycle of the stated amplitude about zero
    width: float  # largest distance of that loop's force from the static curve, over the loop's largest force [-]
    # secant stiffness of loops of a tenth of the range on its shorter side, and of all of it, in this order [N/m]
    secants: tuple[float, float]

    @property
    def loss_factor(self) -> float:
        """Twice the damping ratio: W / (pi K A^2) of the loop."""
        return 2.0 * self.loop.damping_ratio

    @property
    def slope(self) -> float:
        """The steeper slope of the table at zero [N/m]."""
        origin = int(np.argmin(np.abs(self.points[:, 0])))
        steps = np.diff(self.points[max(origin - 1, 0) : origin + 2], axis=0)
        return float((steps[:, 1] / steps[:, 0]).max())

    def viscous(self, frequency: float) -> float:
        """Return the damper [N s/m] that dissipates the loop's energy at a frequency [Hz]: W / (pi omega A^2)."""
        return self.loop.dissipated_energy / (2.0 * math.pi**2 * frequency * self.loop.amplitude**2)


@dataclass(frozen=True, kw_only=True)
class StructuralExport:
    """An isolator as entries of one structural code."""

    isolator: Isolator
    code: str  # a key of `CODES`
    amplitude: float  # of stiffness and damping [m]
    frequency: float  # of viscous damping [Hz]
    damping: Damping
    units: Units
    tables: Sequence[AxisTable]  # of the axes with a law, in the order roll, shear, axial

    @property
    def remarks(self) -> tuple[str, ...]:
        """Remarks on the export, one sentence each: frame, units, approximations and their errors."""
        damped = "loss factor" if self.damping == "structural" else f"damper at {self.frequency:.4g} Hz"
        size = f"{1e3 * self.amplitude:.4g} mm"
        texts = [
            f"{self.isolator.name}: {self.units.replace('-', ', ')}, s",
            "frame: 1 = x = roll, across the bars; 2 = y = shear, along them; 3 = z = axial, from base to payload",
            "first node: base, second: payload, both at mid-height; deflection = payload less base, axial positive in tension",
            "tables: static curves of the first loading from rest; they unload along themselves and dissipate nothing; "
            "beyond their ends the last slope goes on",
            f"stiffness and {damped}: of closed cycles of {size} about zero, and of no other amplitude",
        ]
        if self.code in _LINEAR:
            unit = "N/mm" if self.units == "N-mm-t" else "N/m"
            stiff = {table.axis: self.scaled(table.loop.secant_stiffness, "N/m") for table in self.tables}
            slopes = [table.slope / table.loop.secant_stiffness for table in self.tables]
            texts.append(
                "a linear analysis (modal, harmonic) takes the slope of the tables at zero, that of the first loading, "
                f"{min(slopes):.3g} to {max(slopes):.3g} times the stiffness of the cycles; it needs this stiffness in place "
                f"of the tables: {', '.join(f'{axis} {k:.6g}' for axis, k in stiff.items())} {unit}, {_LINEAR[self.code]}"
            )
        for table in self.tables:
            loop, (small, whole) = table.loop, table.secants
            texts.append(
                f"{table.axis}: a loop of {size} dissipates {loop.dissipated_energy:.6g} J a cycle (damping "
                f"ratio {loop.damping_ratio:.4g}) that the table leaves out, and its force is up to "
                f"{100.0 * table.width:.3g} % of its largest away from the table's"
            )
            texts.append(
                f"{table.axis}: secant stiffness {1e-3 * loop.secant_stiffness:.6g} N/mm at this amplitude, "
                f"{1e-3 * small:.4g} N/mm at a tenth of the table's range and {1e-3 * whole:.4g} N/mm at all of it; between "
                f"its {len(table.points)} points the table misses the curve by up to {100.0 * table.missed:.2g} % of the "
                "largest force"
            )
        if self.isolator.coupling is not None:
            texts.append(f"the coupling of the axes ({self.isolator.coupling}) is left out: each axis is as it is alone")
        absent = [axis for axis, law in self.isolator.axes.items() if law is None]
        texts += [f"no law along {', '.join(absent)}: no stiffness there"] if absent else []
        texts += [] if self.isolator.rotation is not None else ["no rotational stiffness is stated: none is written"]
        return tuple(texts)

    def scaled(self, value: float, unit: str) -> float:
        """Convert a value in SI, of unit "m", "N/m", "N s/m" or "N m", to the units of the file."""
        per_metre = {"m": 1e3, "N/m": 1e-3, "N s/m": 1e-3, "N m": 1e3, "N": 1.0}[unit]
        return value * per_metre if self.units == "N-mm-t" else value

    def text(self) -> str:
        """Return the text of the file: remarks as comments, then its entries."""
        _, mark, write = CODES[self.code]
        said = (line for remark in self.remarks for line in textwrap.wrap(remark, 76 - len(mark), subsequent_indent="  "))
        return "\n".join([*(f"{mark} {line}" for line in said), *write(self)]) + "\n"


def export_structural(
    isolator: Isolator, path: Path, *, amplitude: float, frequency: float | None = None, damping: Damping | None = None,
    units: Units = "N-m-kg",
) -> StructuralExport:  # fmt: skip
    """Tabulate the laws of an isolator for a structural code.

    Args:
        isolator: whose laws act as it stands, stiffened and on its bracket.
        path: file that will be written, whose ending names the code.
        amplitude: of the cycles of which stiffness and damping are [m].
        frequency: of viscous damping and of laws that know the rate [Hz]; by default the natural one under the rated load.
        damping: as a loss factor or as a damper; by default a loss factor where the code has one beside tables.
        units: of the file.

    Raises:
        ValueError: the ending names no code, the amplitude is beyond the range of an axis, no frequency is known, or the code
            has no such damping.
    """
    code = next((name for name, (endings, *_) in CODES.items() if path.suffix.lower() in endings), None)
    if code is None:
        listed = "; ".join(f"{', '.join(endings)} {name}" for name, (endings, *_) in CODES.items())
        raise ValueError(f"the file's ending names the code: {listed}; got {path.name!r}.")
    if code == "Ansys" and damping == "structural":
        raise ValueError("COMBIN39 has no damping, and COMBIN14 beside it is a damper: leave `--damping structural` out.")
    acting = isolator.conditioned
    tables: list[AxisTable] = []
    natural = frequency
    axes = [(axis, law) for axis in reversed(AXES) if (law := acting.axes[axis]) is not None]
    for axis, law in axes:
        # As rated, else that of the largest loop worth drawing.
        rated = (largest_amplitude(acting, axis) if end is None else end for end in acting.rated_travel(axis))
        below, above = (min(way, math.nextafter(end, 0.0)) for way, end in zip(rated, law.travel_ends, strict=True))
        if not 0.0 < amplitude <= min(below, above):
            raise ValueError(
                f"`amplitude` must be > 0 and within the range of each axis, {1e3 * min(below, above):.4g} mm along {axis}; "
                f"got {1e3 * amplitude:.6g} mm."
            )
        if natural is None:
            load = isolator.limits.static_load
            if load is None:
                raise ValueError(
                    "`frequency` must be given: no static load is rated, of which it could be the natural frequency."
                )
            stiffness = cyclic_test(law, amplitude)[0].secant_stiffness
            natural = math.sqrt(stiffness * STANDARD_GRAVITY / load) / (2.0 * math.pi)
        tables.append(_table(axis, law, (below, above), amplitude, natural, _ANSYS_POINTS if code == "Ansys" else None))
    assert natural is not None  # an isolator has a law
    how: Damping = damping or ("viscous" if code == "Ansys" else "structural")
    return StructuralExport(
        isolator=isolator, code=code, amplitude=amplitude, frequency=natural, damping=how, units=units, tables=tables[::-1]
    )


def _table(axis: str, law: Law, ends: tuple[float, float], amplitude: float, frequency: float, most: int | None) -> AxisTable:
    """Tabulate a law's static curve between its ends [m], by at most so many points, and its loop of an amplitude [m]."""
    sides = [_side(law, -ends[0]), _side(law, ends[1])]
    largest = max(float(np.abs(force).max()) for _, force in sides)
    # both sides share the points of a table that holds few, the origin being one of them
    counts = [_MOST, _MOST] if most is None else [(most - 1) // 2, most - 1 - (most - 1) // 2]
    (below, missed_below), (above, missed_above) = (
        _choose_points(*side, largest, count, few=most is not None) for side, count in zip(sides, counts, strict=True)
    )
    points = np.concatenate([below[::-1], [[0.0, 0.0]], above])
    loop = cyclic_test(law, amplitude, frequency=frequency)[0]
    if loop.secant_stiffness <= 0.0:
        raise ValueError(f"cycles of {1e3 * amplitude:.6g} mm meet no force along {axis}: take a larger `amplitude`.")
    way, force = (np.concatenate([low[::-1], high]) for low, high in zip(*sides, strict=True))
    static = np.interp(loop.deflection, way, force)
    loops = cyclic_test(law, [part * min(ends) for part in _FRACTIONS], frequency=frequency)
    small, whole = (loop.secant_stiffness for loop in loops)
    return AxisTable(
        axis=axis, points=points, missed=max(missed_below, missed_above), loop=loop,
        width=float(np.abs(loop.force - static).max() / np.abs(loop.force).max()), secants=(small, whole),
    )  # fmt: skip


def _side(law: Law, end: float) -> tuple[Array, Array]:
    """Return deflections from zero to an end and the static forces of first loading, (n,) each."""
    # denser near zero, where friction yields
    way = end * np.linspace(0.0, 1.0, _SAMPLES + 1) ** 2
    force = np.zeros(way.size)
    for part in law.components:
        if part.rate_independent:
            force += part.trace(way).force
        elif part.bracket_stiffness < math.inf:
            raise ValueError(f"{part.name} on a bracket has no static curve here: export the isolator without its bracket.")
        else:  # at rest, with its branches relaxed
            force += [part.trace([x, x], time=[0.0, 1.0], rate=[0.0, 0.0]).force[0] for x in way.tolist()]
    return way, force


def _choose_points(way: Array, force: Array, largest: float, count: int, *, few: bool) -> tuple[Array, float]:
    """Choose points of one side of a curve, without the origin, (n, 2); return them and the largest error over `largest`.

    Their density follows the root of the curvature, with which lines miss a curve least; they are as many as `CLOSE` asks
    for, or `count`.
    """
    slope = np.gradient(force, way)
    bent = np.sqrt(np.abs(np.gradient(slope, way))) * np.abs(np.gradient(way))
    reach = np.concatenate([[0.0], np.cumsum(0.5 * (bent[1:] + bent[:-1]))])
    reach += 1e-3 * reach[-1] * np.abs(way) / abs(way[-1]) + np.abs(way) * 1e-30  # what is straight has points, too
    size = count if few else 16
    while True:
        rows = np.unique(np.searchsorted(reach, np.linspace(0.0, reach[-1], size + 1)[1:-1]))
        rows = np.unique(np.concatenate([[0], rows, [way.size - 1]]))
        order = np.argsort(way[rows])
        missed = float(np.abs(np.interp(way, way[rows][order], force[rows][order]) - force).max()) / largest
        if few or missed <= CLOSE or size >= count:
            return np.column_stack([way, force])[rows[1:]], missed
        size *= 2


def _nastran(export: StructuralExport) -> Iterator[str]:
    """Yield the lines of Nastran's bulk data: large fields for tables, of ten digits."""
    by_axis, rotation = {table.axis: table for table in export.tables}, export.isolator.conditioned.rotation
    present = [by_axis.get(axis) for axis in AXES]
    turning = [0.0 if rotation is None else export.scaled(getattr(rotation, axis), "N m") for axis in AXES]
    stiff = [0.0 if axis is None else export.scaled(axis.loop.secant_stiffness, "N/m") for axis in present] + turning
    yield "$ K, GE and B: linear runs; KN: nonlinear ones, U = U(GB) - U(GA)"
    yield "$ GRID 2 lies on GRID 1, CORD2R 1 is the frame: place them, number all anew"
    yield "CORD2R,1,,0.,0.,0.,0.,0.,1."
    yield ",1.,0.,0."
    yield "GRID,1,,0.,0.,0.,1"
    yield "GRID,2,,0.,0.,0.,1"
    yield "CBUSH,1,1,1,2,,,,1"
    yield from _large("PBUSH", ["1", "K", *map(_real, stiff)])
    if export.damping == "structural":
        losses = [0.0 if axis is None else axis.loss_factor for axis in present]
        yield from _large("", ["", "GE", *map(_real, [*losses, 0.0, 0.0, 0.0])])
    else:
        dampers = [0.0 if axis is None else export.scaled(axis.viscous(export.frequency), "N s/m") for axis in present]
        yield from _large("", ["", "B", *map(_real, [*dampers, 0.0, 0.0, 0.0])])
    numbers = ["" if axis is None else str(number) for number, axis in enumerate(present, start=1)]
    yield f"PBUSHT,1,KN,{','.join(numbers)}"
    for number, axis in enumerate(present, start=1):
        if axis is not None:
            yield from _large("TABLED1", [str(number), *[""] * 7, *_cells(export, axis), "ENDT"])


def _large(name: str, fields: Sequence[str]) -> Iterator[str]:
    """Yield an entry of bulk data in large fields, four of sixteen characters on a line."""
    for start in range(0, len(fields), 4):
        head = f"{name}*" if start == 0 and name else "*"
        yield (head.ljust(8) + "".join(field.ljust(16) for field in fields[start : start + 4])).rstrip()


def _cells(export: StructuralExport, table: AxisTable) -> list[str]:
    return [_real(export.scaled(value, unit)) for row in table.points for value, unit in zip(row, ("m", "N"), strict=True)]


def _real(value: float) -> str:
    return f"{value:.9E}"


def _abaqus(export: StructuralExport) -> Iterator[str]:
    """Yield the lines of an Abaqus input file: a connector section, its orientation, and a behaviour by component."""
    yield "** its element: *ELEMENT, TYPE=CONN3D2, ELSET=MOUNT, with the base's node first"
    yield "*ORIENTATION, NAME=MOUNT_AXES"
    yield "1., 0., 0., 0., 1., 0."
    yield "*CONNECTOR SECTION, ELSET=MOUNT, BEHAVIOR=MOUNT_LAW"
    yield "CARTESIAN, CARDAN" if export.isolator.rotation is not None else "CARTESIAN"
    yield "MOUNT_AXES"
    # beyond a table's ends its force stays by default, and Abaqus/Explicit thins its points out
    yield "*CONNECTOR BEHAVIOR, NAME=MOUNT_LAW, EXTRAPOLATION=LINEAR, REGULARIZE=OFF"
    for table in export.tables:
        component = AXES.index(table.axis) + 1
        yield f"*CONNECTOR ELASTICITY, NONLINEAR, COMPONENT={component}"
        yield from (f"{_real(force)}, {_real(export.scaled(x, 'm'))}" for x, force in table.points.tolist())
        if export.damping == "structural":
            yield f"*CONNECTOR DAMPING, TYPE=STRUCTURAL, COMPONENT={component}"
            yield _real(table.loss_factor)
        else:
            yield f"*CONNECTOR DAMPING, TYPE=VISCOUS, COMPONENT={component}"
            yield _real(export.scaled(table.viscous(export.frequency), "N s/m"))
    if (rotation := export.isolator.conditioned.rotation) is not None:
        for component, axis in enumerate(AXES, start=4):
            yield f"*CONNECTOR ELASTICITY, COMPONENT={component}"
            yield _real(export.scaled(getattr(rotation, axis), "N m"))


def _ansys(export: StructuralExport) -> Iterator[str]:
    """Yield the commands of an Ansys macro: for each axis a COMBIN39 and a COMBIN14 between nodes that lie on each other."""
    yield "! nodes 1 (base) and 2 (payload) lie on each other, rotated to the mount's axes"
    yield "! (NROTAT); types and real constants count from 1: number all anew"
    yield "/PREP7"
    yield "N,1,0,0,0"
    yield "N,2,0,0,0"
    for table in export.tables:
        number = AXES.index(table.axis) + 1
        yield f"! {table.axis}"
        yield f"ET,{number},COMBIN39"
        yield f"KEYOPT,{number},1,0 ! unloads along the same curve"
        yield f"KEYOPT,{number},3,{number} ! along the nodal axis {'xyz'[number - 1]}"
        values = _cells(export, table)
        for start in range(0, len(values), 6):
            head = f"R,{number}" if start == 0 else "RMORE"
            yield f"{head},{','.join(values[start : start + 6])}"
        yield from (f"TYPE,{number}", f"REAL,{number}", "E,1,2")
        damper = export.scaled(table.viscous(export.frequency), "N s/m")
        yield f"ET,{number + 3},COMBIN14"
        yield f"KEYOPT,{number + 3},2,{number}"
        yield f"R,{number + 3},0,{_real(damper)}"
        yield from (f"TYPE,{number + 3}", f"REAL,{number + 3}", "E,1,2")
    if (rotation := export.isolator.conditioned.rotation) is not None:
        for number, axis in enumerate(AXES, start=7):
            yield f"ET,{number},COMBIN14 ! turning about {axis}"
            yield f"KEYOPT,{number},2,{number - 3}"
            yield f"R,{number},{_real(export.scaled(getattr(rotation, axis), 'N m'))}"
            yield from (f"TYPE,{number}", f"REAL,{number}", "E,1,2")


# Where codes whose entries hold no stiffness of the cycles take it
_LINEAR = {
    "Abaqus": "each as *CONNECTOR ELASTICITY without NONLINEAR",
    "Ansys": "each as K of its COMBIN14, without the COMBIN39",
}

# Codes, the endings of their files, what begins a comment, and what writes their entries
CODES: Mapping[str, tuple[tuple[str, ...], str, Callable[[StructuralExport], Iterator[str]]]] = {
    "Nastran": ((".bdf", ".dat", ".nas"), "$", _nastran),
    "Abaqus": ((".inp",), "**", _abaqus),
    "Ansys": ((".mac",), "!", _ansys),
}
