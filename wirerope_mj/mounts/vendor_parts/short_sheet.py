"""Data sheets of three figures, stiffness, load and travel: what such a sheet leaves open is taken from the vendors' tables.

What a sheet does not state is the median of the parts in the tables that ship, in proportion to what it states, and nine in ten
of those parts lie in the band beside it. The isolator says all of it among what is assumed.
"""

from collections.abc import Mapping, Sequence
from contextlib import suppress
from dataclasses import dataclass, replace
from functools import cache
from itertools import product
from pathlib import Path
from typing import Annotated, Literal

import numpy as np

from wirerope_mj.foundation.arrays import Array, Entries
from wirerope_mj.foundation.errors import ConvergenceError
from wirerope_mj.foundation.schema import example
from wirerope_mj.foundation.structure import Place, bounds, keys_of, structure
from wirerope_mj.foundation.toml_file import read_toml
from wirerope_mj.foundation.units import STANDARD_GRAVITY
from wirerope_mj.mounts.isolator import Geometry, Isolator
from wirerope_mj.mounts.vendor_parts.law_values import Secant, compression_sag, damping_ratio, secant, virgin_force
from wirerope_mj.mounts.vendor_parts.parts import SERIES, VendorPart, vendor_parts
from wirerope_mj.mounts.vendor_parts.secants import VIBRATION_AMPLITUDE, first_state
from wirerope_mj.mounts.vendor_parts.sheet import AxisValues, ComparedValue, DataSheet, Force, Length, Stiffness
from wirerope_mj.mounts.vendor_parts.sheet_fit import fit_sheet

INSIDE = 0.9  # of the tables' parts, which a band holds
# Damping ratio that is assumed first, between Enidine's and VMC's, and parts of the way from it, and from the tables' median of
# the shock stiffness, to the ends of both bands, until a law has the values: stiffnesses that are near each other leave little
# friction.
_DAMPING, _TRIED = 0.12, (0.0, 0.5, 1.0, -0.5, -1.0)
# Largest yield deflection of the first scale of friction, in travels: of the tables' parts it is below a tenth, and friction
# that yields later is a spring that long vibration takes away.
_YIELD = 0.2
_PARTS = (1.0, 0.75, 0.5, 0.25, 0.1)  # of the way to the end of a band, until a law has these values


@dataclass(frozen=True, kw_only=True)
class ShortSheet:
    """A data sheet of few figures of one isolator."""

    name: Annotated[str, bounds(min_length=1), example("Camera mount")]  #: of the part
    #: in compression, of small vibration
    stiffness: Annotated[Stiffness, example(8.0)]
    static_load: Annotated[Force, example(20.0)]  #: rated, in compression
    travel: Annotated[Length, example(20.0)]  #: rated, in compression
    source: Annotated[str, example("vendor's drawing 4711, revision B")] = ""  #: the document that its values are from
    #: "shock" where `stiffness` is the mean over the travel; absent: "vibration"
    stiffness_of: Annotated[Literal["vibration", "shock"], example("shock")] = "vibration"
    #: in compression, mean over the travel; absent: 0.43 of `stiffness`, as the tables' parts have it
    shock_stiffness: Annotated[Stiffness, example(3.5)] | None = None
    #: in shear and roll; absent: 0.26 of `stiffness`
    shear_stiffness: Annotated[Stiffness, example(2.0)] | None = None
    shear_travel: Annotated[Length, example(20.0)] | None = None  #: in shear and roll; absent: `travel`
    #: ratio, of cycles of 7 % of the travel; absent: 0.12, or the nearest that the stiffnesses leave room for
    damping: Annotated[float, bounds(gt=0.0, lt=1.0), example(0.12)] | None = None
    #: unloaded, over both bars; absent: twice the travel for the shape of the loop, and bottoming is not judged
    height: Annotated[Length, example(40.0)] | None = None
    #: over the ropes, across the bars; absent: 1.2 heights
    width: Annotated[Length, example(48.0)] | None = None
    rope: Annotated[Length, example(2.4)] | None = None  #: diameter of the rope; absent: 0.12 heights
    bar: Annotated[Length, example(5.0)] | None = None  #: thickness of one bar; absent: 0.21 heights
    #: sentences on what the sheet does not say
    assumed: Annotated[tuple[str, ...], example(["the stiffness is that of small vibration"])] = ()

    def __post_init__(self) -> None:
        if self.stiffness_of == "shock" and self.shock_stiffness is not None:
            raise ValueError('`shock_stiffness` says what `stiffness` is with stiffness_of = "shock": leave one of them out.')


@dataclass(frozen=True, kw_only=True)
class Assumption:
    """A figure that a sheet does not state, as the vendors' parts have it."""

    name: str
    factors: tuple[str, ...]  # quantities of a study that move it in proportion
    value: float
    low: float  # ends of the band that holds nine in ten parts, as the next
    high: float

    source: str

    @property
    def text(self) -> str:
        return f"{self.name} {self.value:.2g}, band {self.low:.2g} to {self.high:.2g}: {self.source}"


_NAMES = {
    "shock": "shock stiffness over that of small vibration",
    "shear": "stiffness in shear and roll over that in compression, of small vibration",
}
# Of the shock stiffness none: friction and spring both hang on it.
_FACTORS = {
    "shock": (), "shear": ("mount/*/shear/stiffness", "mount/*/roll/stiffness"), "damping": ("mount/*/damping",),
}  # fmt: skip


@cache
def ratios() -> Mapping[str, Array]:
    """Collect ratios of stated figures over all parts of the vendors' tables that state both."""

    def all_of(ratio: Sequence[float | None]) -> Array:
        return np.array([value for value in ratio if value is not None])

    def over(a: float | None, b: float | None) -> float | None:
        return None if a is None or b is None else a / b

    parts: Sequence[VendorPart] = vendor_parts()
    along, across = ([part.modes[mode] for part in parts] for mode in ("compression", "shear"))
    both = list(zip(along, across, strict=True))
    return {
        "shock": all_of([over(axial.shock, axial.vibration) for axial in along]),
        "shear": all_of([over(shear.vibration, axial.vibration) for axial, shear in both]),
        "height": all_of([over(part.height, axial.travel) for part, axial in zip(parts, along, strict=True)]),
        "width": all_of([over(part.width, part.height) for part in parts]),
        "rope": all_of([over(part.rope, part.height) for part in parts]),
        "bar": all_of([over(part.bar, part.height) for part in parts]),
    }


def assumptions(sheet: ShortSheet) -> dict[str, Assumption]:
    """Return the relevant figures that a sheet leaves open, by name, with the values to be tried first."""
    tables, ends = ratios(), ((1.0 - INSIDE) / 2.0, (1.0 + INSIDE) / 2.0)
    assumed: dict[str, Assumption] = {}
    for key, name in _NAMES.items():
        if getattr(sheet, f"{key}_stiffness") is None:
            (low, high), middle = np.quantile(tables[key], ends).tolist(), float(np.median(tables[key]))
            source = f"the median and nine in ten of {tables[key].size} parts in the vendors' tables"
            assumed[key] = Assumption(name=name, factors=_FACTORS[key], value=middle, low=low, high=high, source=source)
    if sheet.damping is None:
        low, high = (end(series.damping_range[k] for series in SERIES) for k, end in enumerate((min, max)))
        source = "the band is what Enidine and VMC state for their series"
        name = "damping ratio of small vibration"
        factors = _FACTORS["damping"]
        assumed["damping"] = Assumption(name=name, factors=factors, value=_DAMPING, low=low, high=high, source=source)
    return assumed


def read_short_sheet(path: Path) -> ShortSheet | None:
    """Read a sheet of few figures; None where the file is a sheet of tables or of curves. ModelError if it breaks a rule."""
    content = read_toml(path, "data sheet")
    longer = {*keys_of(DataSheet), "curve"} - {*keys_of(ShortSheet)}
    return None if longer & content.keys() else structure(ShortSheet, content, Place(path))


def completed(sheet: ShortSheet, **assumed: float) -> DataSheet:
    """Complete a sheet of few figures to a data sheet, by the `assumed` values or the medians of the vendors' tables."""
    values = {name: assumption.value for name, assumption in assumptions(sheet).items()} | assumed
    median = {name: float(np.median(values)) for name, values in ratios().items()}
    height = sheet.height or median["height"] * sheet.travel
    sizes: Entries = {name: getattr(sheet, name) or median[name] * height for name in ("width", "rope", "bar")}
    if sheet.stiffness_of == "shock":
        vibration, shock = sheet.stiffness / values["shock"], sheet.stiffness
    else:
        vibration, shock = sheet.stiffness, sheet.shock_stiffness or values["shock"] * sheet.stiffness
    # one stiffness in shear, as Enidine's table has it, is a shock stiffness; the loop hardens that of small vibration
    shear = sheet.shear_stiffness or values["shear"] * vibration
    return DataSheet(
        name=sheet.name, source=sheet.source, height=height, **sizes, bar_assumed=sheet.bar is None, scales=2,
        static_load=sheet.static_load, damping_target=sheet.damping or values["damping"],
        compression=AxisValues(travel=sheet.travel, vibration_stiffness=vibration, shock_stiffness=shock),
        shear=AxisValues(travel=sheet.shear_travel or sheet.travel, vibration_stiffness=shear, shock_stiffness=shear),
    )  # fmt: skip


@dataclass(frozen=True, kw_only=True)
class BandEnd:
    """The isolator at the end of a band, or so far towards it that a law has all values."""

    part: float  # of the way from the assumed value to the end
    isolator: Isolator


@dataclass(frozen=True, kw_only=True)
class ShortFit:
    """The isolator of a sheet of few figures, and those of the ends of each band."""

    sheet: ShortSheet
    isolator: Isolator
    assumed: Mapping[str, Assumption]
    ends: Mapping[str, tuple[BandEnd, BandEnd]]  # by assumption

    def bands(self) -> list[tuple[ComparedValue, float, float]]:
        """Compute the isolator's figures with their bands: deviations of all assumptions, added squared."""
        nominal = _figures(self.sheet, self.isolator)
        ends = [[(end.part, _figures(self.sheet, end.isolator, end=True)) for end in pair] for pair in self.ends.values()]
        rows = []
        for number, figure in enumerate(nominal):
            down = up = 0.0
            for pair in ends:
                changes = [(figures[number].fitted - figure.fitted) / part for part, figures in pair]
                down, up = down + min(0.0, *changes) ** 2, up + max(0.0, *changes) ** 2
            rows.append((figure, max(0.0, figure.fitted - down**0.5), figure.fitted + up**0.5))
        return rows


def _figures(sheet: ShortSheet, isolator: Isolator, *, end: bool = False) -> list[ComparedValue]:
    """Compute sag, frequency, damping, and force at the travel of an isolator.

    At the end of a band one that does not carry the rated load counts as sagging through its travel.
    """
    axial, shear = isolator.axial, isolator.shear
    assert axial is not None  # of every fit
    assert shear is not None
    small, mass = VIBRATION_AMPLITUDE * sheet.travel, sheet.static_load / STANDARD_GRAVITY
    sags = list[float]()
    for vibrated in (False, True):
        try:
            sags.append(compression_sag(axial, sheet.static_load, sheet.travel, relaxed=vibrated))
        except ConvergenceError:
            if not end:
                raise
            sags.append(sheet.travel)  # at least
    virgin, relaxed = sags
    cycles = Secant(deflection=small, stiffness=1.0, steady=True)
    along, across = secant(axial, cycles, -relaxed), secant(shear, cycles)
    at = f"cycles of {1e3 * small:.3g} mm"
    rows = [
        ("axial", "sag under the rated load, gravity applied slowly", "mm", 1e3 * virgin),
        ("axial", "sag after long vibration", "mm", 1e3 * relaxed),
        ("axial", f"natural frequency under the rated load, {at}", "Hz", float(np.sqrt(along / mass)) / (2.0 * np.pi)),
        ("shear, roll", f"the same, {at}", "Hz", float(np.sqrt(across / mass)) / (2.0 * np.pi)),
        ("axial", f"damping ratio, {at}", "-", damping_ratio(axial, small)),
        ("axial", "force at the rated compression", "N", -virgin_force(axial, -sheet.travel)),
    ]
    return [ComparedValue(axis=axis, name=name, unit=unit, vendor=None, fitted=value) for axis, name, unit, value in rows]


def fit_short(sheet: ShortSheet) -> ShortFit:
    """Fit the isolator of a sheet of few figures; its provenance says what the sheet leaves open, with the bands.

    Raises:
        ValueError: no rope loop has the envelope of the sheet.
        ConvergenceError: no law has all its values.
    """
    isolator, assumed = _fit_first(sheet)
    values = {name: assumption.value for name, assumption in assumed.items()}
    ends = {
        name: (_end(sheet, isolator, values, name, assumption.low), _end(sheet, isolator, values, name, assumption.high))
        for name, assumption in assumed.items()
    }
    stated = isolator.provenance
    ours = [assumption.text for assumption in assumed.values()]
    if sheet.stiffness_of == "vibration":
        ours.append(
            '`stiffness` is that of small vibration; where it is the mean over the travel, write stiffness_of = "shock"'
        )
    if missing := [name for name in ("height", "width", "rope", "bar") if getattr(sheet, name) is None]:
        ours.append(
            f"{', '.join(missing)}: in proportion to the travel as those parts have it, for the shape of the loop alone"
        )
    provenance = replace(stated, kind="catalogue", assumed=(*ours, *sheet.assumed, *stated.assumed))
    geometry = Geometry(height=sheet.height, width=sheet.width, bar=sheet.bar) if sheet.height else None
    whole = replace(isolator, provenance=provenance, geometry=geometry)
    return ShortFit(sheet=sheet, isolator=whole, assumed=assumed, ends=ends)


def _fit_first(sheet: ShortSheet) -> tuple[Isolator, dict[str, Assumption]]:
    """Fit the isolator with the assumed values, or the first beside them with which a law is found; return it and them."""
    assumed, failed = assumptions(sheet), list[ConvergenceError]()
    free: list[str] = [name for name in ("shock", "damping") if name in assumed]
    for parts in product(_TRIED, repeat=len(free)):
        moved: dict[str, float] = {
            name: assumed[name].value
            + abs(part) * ((assumed[name].high if part > 0.0 else assumed[name].low) - assumed[name].value)
            for name, part in zip(free, parts, strict=True)
        }
        try:
            isolator = _fitted(sheet, moved)
        except ConvergenceError as error:
            failed.append(error)
            continue
        return isolator, {
            name: replace(assumption, value=moved.get(name, assumption.value)) for name, assumption in assumed.items()
        }
    raise failed[0]


def _fitted(sheet: ShortSheet, values: Mapping[str, float]) -> Isolator:
    """Fit the isolator with values of what the sheet leaves open; ConvergenceError if friction yields later than a rope's."""
    isolator = fit_sheet(completed(sheet, **values))
    assert isolator.axial is not None  # of every fit
    reach = first_state(isolator.axial).normalised.x_y  # type: ignore[arg-type]  # the rule's law
    if reach > _YIELD * sheet.travel:
        raise ConvergenceError(
            f"with these stiffnesses and this damping friction would yield over {1e3 * reach:.3g} mm of a travel of "
            f"{1e3 * sheet.travel:.3g} mm, as no rope does: state a larger `damping`, or leave it out."
        )
    return isolator


def _end(sheet: ShortSheet, isolator: Isolator, values: Mapping[str, float], name: str, end: float) -> BandEnd:
    """Fit the isolator with one assumed value at the end of its band, or as far towards it as a law has all values."""
    for part in _PARTS:
        with suppress(ConvergenceError):
            moved = {**values, name: values[name] + part * (end - values[name])}
            return BandEnd(part=part, isolator=_fitted(sheet, moved))
    return BandEnd(part=1.0, isolator=isolator)  # the other values leave no room
