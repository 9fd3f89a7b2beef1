"""Parts of an isolator beside its laws: limits, geometry, provenance, spread, stiffening, and its range of validity.

The latter is the cycles that its laws were identified from, and what of a motion lies outside them.
"""

import math
from collections.abc import Sequence
from dataclasses import dataclass, field, fields, replace
from typing import Annotated, Literal, Self, get_args

import numpy as np

from wirerope_mj.foundation.arrays import Array, Entries
from wirerope_mj.foundation.structure import NEEDED, bounds, check
from wirerope_mj.mounts.laws import Law
from wirerope_mj.mounts.rope_loop.half_loop import loop_shape

# Kinds of provenance: fitted to vendor figures, to measurements, taken from a publication, estimated from the geometry, or an
# example.
Kind = Literal["catalogue", "identified", "published", "estimated", "illustrative"]
KINDS = get_args(Kind)
# Largest travel, height or width [m]: the vendors' tables reach 0.24 m, and 2 mm taken for metres are as much.
LARGEST = 2.0
Length = Annotated[float, bounds("m", gt=0.0, le=LARGEST)]
Stiffness = Annotated[float, bounds("N/m", gt=0.0)]
# Largest rated travel in heights of the isolator: it cannot become shorter than nothing; in the other directions the 72 parts
# of the vendors' tables reach 0.7, and 10 keeps clear of inches (26), centimetres and millimetres taken for metres.
HEIGHTS = {"compression": 1.0, "tension": 10.0, "shear": 10.0, "roll": 10.0}
# Lengths of laws that a file states as they are measured.
_LENGTHS = {"stop": ("gap_below", "gap_above", "rest", "depths", "rounding", "reversal"), "tabulated": ("deflection",)}


def require_law_in_metres(axis: str, law: Law | None) -> None:
    """Raise ValueError if a stop or a table has lengths so large that they are probably not in metres."""
    for part in law.components if law else ():
        for name in _LENGTHS.get(part.name, ()):
            value = getattr(part, name)
            largest = max(map(abs, value), default=0.0) if isinstance(value, tuple) else abs(value or 0.0)
            if largest > LARGEST:
                raise ValueError(
                    f"[{axis}] {part.name}: `{name}` must be in metres and at most {LARGEST:g} m, got {largest:.6g}. "
                    f"If these are millimetres, write {1e-3 * largest:.6g}."
                )


class Part:
    """A part of an isolator, a dataclass; what is None is not stated."""

    def __post_init__(self) -> None:
        check(self)

    @property
    def stated(self) -> Entries:
        values = ((item.name, getattr(self, item.name)) for item in fields(self))  # type: ignore[arg-type]
        return {name: value for name, value in values if value is not None}

    def to_dict(self) -> Entries:
        """Return the part as stored in an isolator file, without empty fields."""
        values = {name: value.to_dict() if isinstance(value, Part) else value for name, value in self.stated.items()}
        plain = {name: list(value) if isinstance(value, tuple) else value for name, value in values.items()}
        return {name: value for name, value in plain.items() if value or isinstance(value, float | int)}


@dataclass(frozen=True, kw_only=True)
class Bracket(Part):
    """Stiffness of what an isolator is bolted to, in series with it, by axis [N/m]; it has no mass. None = rigid."""

    roll: Stiffness | None = None
    shear: Stiffness | None = None
    axial: Stiffness | None = None

    def __post_init__(self) -> None:
        super().__post_init__()
        if not self.stated:
            raise ValueError("`bracket` must have a stiffness along roll, shear or axial.")


@dataclass(frozen=True, kw_only=True)
class Stiffening(Part):
    """A factor on all forces of an isolator, 1 + after_50 ln(cycles) / ln(50), for the cycles that it has gone through.

    It is held constant within a run: the effect takes tens of cycles, a shock or a look at one resonance few. It multiplies
    stiffness and friction of all axes alike, which the source does not say: it speaks of stiffness. Beyond 50 cycles the
    logarithm is an extrapolation.

    Source: M. Fu and Z. Yang, Stiffness hardening effect of wire rope isolators under small cyclic loads, Materials 17 (2024)
    4983, abstract: under small cycles at a large preload the stiffness grows with the logarithm of the number of cycles, by
    about 10 to 30 % after 50.
    """

    #: ratio by which the stiffness has grown after 50 cycles; published 0.1 to 0.3
    after_50: Annotated[float, bounds(ge=0.0, le=1.0)]
    #: cycles that the isolator has gone through when the run starts; at 1 nothing changes
    cycles: Annotated[float, bounds(ge=1.0)] = 1.0

    @property
    def factor(self) -> float:
        """Factor on all forces [-], >= 1; exactly 1 at one cycle and 1 + after_50 at fifty."""
        return 1.0 + self.after_50 * (math.log(self.cycles) / math.log(50.0))

    @property
    def description(self) -> str:
        """The values and the factor that they amount to, as text."""
        values = f"after_50 = {self.after_50:.6g}, cycles = {self.cycles:.6g}"
        return f"{values}: all forces are {self.factor:.6g} times those of the laws"


@dataclass(frozen=True, kw_only=True)
class Temperature(Part):
    """Factors on stiffness and damping over temperature that a data sheet states, straight between its temperatures.

    `stiffness` multiplies all forces, stiffness and friction of every axis, `damping` the hysteretic and viscous part of every
    law beside that (`Law.with_damping`). The factors are 1 where the laws were identified.
    """

    celsius: tuple[float, ...]  #: rising temperatures that are stated [degC], two or more
    stiffness: tuple[Annotated[float, bounds(ge=0.01, le=100.0)], ...]  #: factor at each of them
    damping: tuple[Annotated[float, bounds(ge=0.01, le=100.0)], ...] = ()  #: factor at each of them; left out: 1
    #: temperature that the isolator has [degC], within those that are stated; left out: as the laws are written
    at: float | None = None

    def __post_init__(self) -> None:
        super().__post_init__()
        if len(self.celsius) < 2 or any(b <= a for a, b in zip(self.celsius[:-1], self.celsius[1:], strict=True)):
            raise ValueError(f"`celsius` must be two or more rising temperatures [degC], got {list(self.celsius)}.")
        for name in ("stiffness", "damping"):
            values = getattr(self, name)
            if len(values) != len(self.celsius) and (values or name == "stiffness"):
                raise ValueError(
                    f"`{name}` must have a factor for each of the {len(self.celsius)} temperatures, got {len(values)}."
                )
        low, high = self.celsius[0], self.celsius[-1]
        if self.at is not None and not low <= self.at <= high:
            raise ValueError(f"`at` must be within the {low:g} to {high:g} degC that are stated, got {self.at:g} degC.")

    @property
    def factors(self) -> tuple[float, float]:
        """Factors on all forces, and in addition on the hysteretic and viscous part; 1 without a temperature."""
        if self.at is None:
            return 1.0, 1.0
        stiffness, damping = (np.interp(self.at, self.celsius, values or [1.0] * len(self.celsius)) for values in (
            self.stiffness, self.damping
        ))  # fmt: skip
        return float(stiffness), float(damping)

    @property
    def description(self) -> str:
        """Temperature and its factors, or the temperatures for which factors are stated, as text."""
        if self.at is None:
            return f"stated from {self.celsius[0]:g} to {self.celsius[-1]:g} degC; the laws are as written"
        stiffness, damping = self.factors
        return (
            f"at {self.at:g} degC all forces are {stiffness:.4g} times those of the laws, their loss {damping:.4g} times that"
        )


@dataclass(frozen=True, kw_only=True)
class Travel(Part):
    """Rated deflections [m], all positive; None where the vendor states none: not judged.

    compression and tension limit the axial deflection below and above zero, shear and roll both directions of theirs.
    """

    compression: Length | None = None
    tension: Length | None = None
    shear: Length | None = None
    roll: Length | None = None


@dataclass(frozen=True, kw_only=True)
class Limits(Part):
    """Ratings of the isolator: static_load [N] in compression and travel [m]; None = not judged."""

    static_load: Annotated[float, bounds("N", gt=0.0)] | None = None
    travel: Travel = Travel()


@dataclass(frozen=True, kw_only=True)
class Geometry(Part):
    """Unloaded envelope: height along the axial axis and width across the bars [m], thickness of one bar [m], and bolts.

    bar: at a compression of height - 2 bar the bars meet. The rope is held inside them and bulges aside, and takes no height:
    rated compressions of Enidine's 50 parts are 0.78 to 0.96 of that, and 36 of them beyond that less a rope.
    rope is its diameter [m]; with all four the tension is known at which the loops are straight.
    bolts is the number of bolts of the base side, 1, 2 or 4, bolts_along_roll and bolts_along_shear their distances along
    these axes [m]; None = not stated.
    """

    height: Length | None = None
    width: Length | None = None
    bar: Length | None = None
    rope: Length | None = None
    bolts: float | None = None
    bolts_along_roll: Length | None = None
    bolts_along_shear: Length | None = None

    def __post_init__(self) -> None:
        super().__post_init__()
        if self.bar is not None and (self.height is None or 2.0 * self.bar >= self.height):
            raise ValueError(f"`bar`, the thickness of one bar, must be less than half the `height`, got {self.bar:g} m.")
        if self.bolts not in (None, 1, 2, 4):
            raise ValueError(f"`bolts` must be 1, 2 (in a line) or 4 (in a rectangle), got {self.bolts:g}.")
        if self.bolts is None and (self.bolts_along_roll or self.bolts_along_shear):
            raise ValueError("`bolts_along_roll` and `bolts_along_shear` need `bolts`, their number.")

    def require_room(self, travel: Travel) -> None:
        """Raise ValueError if a rated travel is larger than a mount of this height can have."""
        for name, rated in travel.stated.items():
            if self.height is not None and rated > HEIGHTS[name] * self.height:
                raise ValueError(
                    f"[limits] travel: `{name}` of {rated:.6g} m is more than {HEIGHTS[name]:g} times the `height` of "
                    f"{self.height:.6g} m in [geometry]; both must be in metres. "
                    f"If these are millimetres, write {1e-3 * rated:.6g}."
                )
        compression, largest = travel.compression, self.solid_compression
        if compression is not None and largest is not None and compression > largest * (1.0 + 1e-9):  # but for rounding
            raise ValueError(
                f"[limits] travel: `compression` of {compression:.6g} m is more than the {largest:.6g} m between the bars in "
                "[geometry], `height` less twice `bar`."
            )

    @property
    def solid_compression(self) -> float | None:
        """Compression at which the bars meet [m]; None where height or bar are not stated."""
        return None if self.height is None or self.bar is None else self.height - 2.0 * self.bar

    @property
    def straight_tension(self) -> float | None:
        """Tension at which the rope of the roundest loop of this size is straight [m]; None where a size is not stated."""
        if self.height is None or self.width is None or self.bar is None or self.rope is None:
            return None
        try:
            taut = loop_shape(height=self.height, width=self.width, bar=self.bar, rope=self.rope).taut()
        except ValueError:  # no loop: another shape of isolator
            return None
        return taut if taut > 0.0 else None


@dataclass(frozen=True, kw_only=True)
class Rotation(Part):
    """Stiffness against turning the payload's bar relative to the base's [N m/rad], each >= 0.

    roll, shear and axial are about the axes x, y and z of the mount. For a turn theta about one of them the torque is
    K sin theta, from the potential K (1 - cos theta): elastic, without loss.
    """

    roll: Annotated[float, bounds("N m/rad", ge=0.0)] = 0.0
    shear: Annotated[float, bounds("N m/rad", ge=0.0)] = 0.0
    axial: Annotated[float, bounds("N m/rad", ge=0.0)] = 0.0

    def scaled(self, factor: float) -> Self:
        """Return `factor` times these stiffnesses."""
        return replace(self, roll=factor * self.roll, shear=factor * self.shear, axial=factor * self.axial)


@dataclass(frozen=True, kw_only=True)
class Provenance(Part):
    """Origin of the parameters."""

    kind: Annotated[Kind, NEEDED] = "illustrative"  #: where the parameters come from
    source: str = ""  #: the document or measurement that the figures were taken from
    fitted_to: str = ""  #: which figures the parameters reproduce, and how
    assumed: tuple[str, ...] = ()  #: values that no source gives, one sentence each
    #: what the fitted axes give at 45 degrees against the vendor's figures there, by name; not fitted
    check_45: dict[str, float] = field(default_factory=dict)


@dataclass(frozen=True, kw_only=True)
class Spread(Part):
    """Scatter of the parameters: names such as "axial.alpha" and their covariance in SI units, (n, n).

    It is that of specimens of one make, unless it was `calibrated`: then it is what tests of a system leave open.
    """

    parameters: tuple[str, ...]
    covariance: tuple[tuple[float, ...], ...]
    calibrated: bool = False

    def __post_init__(self) -> None:
        super().__post_init__()
        n = len(self.parameters)
        if len(self.covariance) != n or any(len(row) != n for row in self.covariance):
            raise ValueError(f"`covariance` must have {n} rows of {n} numbers, one for each of `parameters`.")

    def to_dict(self) -> Entries:
        stated = {"parameters": list(self.parameters), "covariance": [list(row) for row in self.covariance]}
        return stated | ({"calibrated": True} if self.calibrated else {})


# What is said of cycles below the least tested ones: of three devices of 5 to 40 sliders, tested from 0.5 to 15 mm
# (`tests/slider_devices.py`)
BELOW = (
    "not judged: at a fifth of the least tested amplitude laws were up to 17 % low in frequency (7 % with three scales), and "
    "their damping was off by a tenth to several times"
)
SLACK = 0.05  # Ratio by which amplitudes may differ and count as one: strokes of one run at a rig differ by as much
# Half-range of an axis over its mount's largest, below which its force decides nothing that small cycles could change.
MOVING = 0.1
_MILLI = 1e3  # metres to millimetres
Pair = tuple[float, float]


@dataclass(frozen=True, kw_only=True)
class MeasuredRange(Part):
    """Cycles that were measured along one axis, each as its lowest and highest value."""

    amplitude: Pair  # half-ranges of the deflection [m], >= 0
    deflection: Pair  # ends of the deflection [m]
    frequency: Pair | None = None  # of the cycles [Hz], >= 0; None where the records have no time
    rate: Pair | None = None  # largest deflection rates of the cycles [m/s], >= 0; None in the same way

    def __post_init__(self) -> None:
        super().__post_init__()
        for name, (low, high) in self.stated.items():
            if low > high:
                raise ValueError(f"`{name}` must be the lowest and then the highest, got {low:g} and {high:g}.")
            if name != "deflection" and low < 0.0:
                raise ValueError(f"`{name}` must be >= 0, got {low!r}.")

    @property
    def text(self) -> str:
        """The range as text: "0.5 to 10 mm amplitude between -10 and 10 mm"."""
        low, high = (f"{_MILLI * end:.3g}" for end in self.deflection)
        return f"{_span(self.amplitude, _MILLI)} mm amplitude between {low} and {high} mm"

    @property
    def pace(self) -> str:
        """Frequency and speeds of the tested cycles, as "at 1 Hz, 3.1 to 63 mm/s"; "" where they are unknown."""
        texts = [] if self.frequency is None else [f"{_span(self.frequency, 1.0)} Hz"]
        texts += [] if self.rate is None else [f"{_span(self.rate, _MILLI)} mm/s"]
        return f"at {', '.join(texts)}" if texts else ""

    def joined(self, other: "MeasuredRange | None") -> "MeasuredRange":
        """Join two measured ranges; where frequency or rate is missing in one, the other's is taken."""
        if other is None:
            return self
        spans, other_spans = self.stated, other.stated
        known = {name: [both[name] for both in (spans, other_spans) if name in both] for name in spans | other_spans}
        ends = {name: (min(pair[0] for pair in both), max(pair[1] for pair in both)) for name, both in known.items()}
        return MeasuredRange(**ends)

    def outside(self, lowest: float, highest: float, *, small: bool) -> str:
        """Say how a motion between two deflections [m] leaves the range, as text; "" where it does not.

        If `small`, motions smaller than what was measured count.
        """
        half = 0.5 * (highest - lowest)
        room = SLACK * self.amplitude[1]
        beyond = half > self.amplitude[1] + room or (small and half < (1.0 - SLACK) * self.amplitude[0])
        if beyond:
            return f"±{_MILLI * half:.3g} mm (tested {_span(self.amplitude, _MILLI)} mm)"
        if lowest < self.deflection[0] - room or highest > self.deflection[1] + room:
            ends, tested = (
                [f"{round(_MILLI * end, 6) + 0.0:.3g}" for end in pair] for pair in ((lowest, highest), self.deflection)
            )
            return f"{ends[0]} to {ends[1]} mm (tested {tested[0]} to {tested[1]} mm)"
        return ""


@dataclass(frozen=True, kw_only=True)
class Validity(Part):
    """Range of validity along each axis; None where nothing is said of it."""

    roll: MeasuredRange | None = None
    shear: MeasuredRange | None = None
    axial: MeasuredRange | None = None

    def outside(self, lowest: Sequence[float] | Array, highest: Sequence[float] | Array, *, small: bool) -> dict[str, str]:
        """Say how a mount's motion leaves the ranges, as text by axis; nothing of the axes that stay inside.

        Deflections are those along roll, shear and axial [m], (3,). If `small`, small motions count along axes that move at
        least a tenth as far as the mount's farthest one.
        """
        pairs = zip(map(float, lowest), map(float, highest), strict=True)
        ends = dict(zip((item.name for item in fields(self)), pairs, strict=True))
        far = MOVING * max(high - low for low, high in ends.values())
        moving = {axis: high - low > far for axis, (low, high) in ends.items()}
        texts = {axis: span.outside(*ends[axis], small=small and moving[axis]) for axis, span in self.stated.items()}
        return {axis: text for axis, text in texts.items() if text}


def _span(pair: Pair, factor: float) -> str:
    low, high = (f"{factor * value:.3g}" for value in pair)
    return low if low == high else f"{low} to {high}"
