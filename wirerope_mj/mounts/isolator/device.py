"""The isolator itself, and the amplitudes at which its axes are worth a test."""

import math
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, fields, replace
from functools import cached_property
from pathlib import Path
from typing import Annotated, Literal, cast

import numpy as np
import tomli_w

from wirerope_mj.foundation.arguments import one_of
from wirerope_mj.foundation.arrays import Entries
from wirerope_mj.foundation.atomic_files import atomic_file
from wirerope_mj.foundation.plain_text import plain
from wirerope_mj.foundation.quantities import values_with_unit
from wirerope_mj.foundation.structure import Place, bounds, check, structure
from wirerope_mj.foundation.summary import Brief
from wirerope_mj.foundation.units import TEMPERATURE_UNITS
from wirerope_mj.mounts.isolator.parts import (
    Bracket,
    Geometry,
    Limits,
    Part,
    Provenance,
    Rotation,
    Spread,
    Stiffening,
    Temperature,
    Validity,
    require_law_in_metres,
)
from wirerope_mj.mounts.isolator.tables import AXES, read_law
from wirerope_mj.mounts.isolator.travel import SIDES
from wirerope_mj.mounts.laws import BiaxialBoucWen, Law, LoopBoucWen, LoopCoupling, is_law, on_bracket
from wirerope_mj.mounts.laws.stop import Stop, largest_gap

COUPLINGS = {"biaxial": ("roll", "shear"), "loop": ("roll", "axial")}  # The axes that a coupling couples, by its name


@dataclass(frozen=True, kw_only=True, repr=False)
class Isolator(Brief):
    """A device between two sites: one restoring-force law for each axis, limits and provenance."""

    name: Annotated[str, bounds(min_length=1)]  #: what the vendor or the laboratory calls it
    roll: Law | None = None  #: law across the bars (x); None = no force on this axis, as for the next two
    shear: Law | None = None  #: law along the bars (y)
    axial: Law | None = None  #: law from the base's bar to the payload's bar (z), deflection positive in tension
    #: None for independent axes; "biaxial": roll and shear share one hysteretic force, see `BiaxialBoucWen`; "loop": roll and
    #: axial share one and an elastic energy, as in a loop of rope, see `wirerope_mj.mounts.laws.LoopBoucWen`
    coupling: Literal["biaxial", "loop"] | None = None
    #: axes without a law along which the device is meant to let its payload go; of others a model warns
    free: tuple[Literal["roll", "shear", "axial"], ...] = ()
    loop: LoopCoupling | None = None  #: the elastic energy of the coupling "loop"
    rotation: Rotation | None = None  #: stiffness against turning; None = the mount turns freely
    #: factor on all forces for the cycles gone through; None = none, `conditioned` is the isolator with it
    stiffening: Stiffening | None = None
    #: factors on stiffness and damping over temperature, and the temperature that it has; None = none are stated
    temperature: Temperature | None = None
    #: what it is bolted to, in series with its axes; None = rigid. `conditioned` is the isolator on it.
    bracket: Bracket | None = None
    limits: Limits = Limits()  #: rated static load and travel
    geometry: Geometry | None = None  #: unloaded envelope, for drawing
    provenance: Provenance = Provenance()  #: where the parameters come from
    spread: Spread | None = None  #: scatter of the parameters
    validity: Validity = Validity()  #: cycles that the laws were identified from, by axis

    def __post_init__(self) -> None:
        check(self)
        if plain(self.name) != self.name or not self.name.strip():
            raise ValueError(f"`name` must be one line of visible characters, got {self.name!r}.")
        for axis, law in self.axes.items():
            if law is not None and not is_law(law):
                raise ValueError(f"`{axis}` must be a law or None, got {law!r}.")
        if not any(self.axes.values()):
            raise ValueError(f"the isolator must have a law on at least one axis of {', '.join(AXES)}.")
        both = COUPLINGS[self.coupling] if self.coupling is not None else ()
        if any(getattr(self, axis) is None for axis in both):
            raise ValueError(f"`coupling` {self.coupling!r} needs a law on both axes, {' and '.join(both)}.")
        if (self.coupling == "loop") != (self.loop is not None):
            has = "there is none" if self.loop is None else f"`coupling` is {self.coupling!r}"
            raise ValueError(f"`coupling` 'loop' and its table `loop` need each other; {has}.")
        for axis in self.free:
            if self.axes[axis] is not None:
                raise ValueError(f"`free` names {axis}, which has a law: leave one of them out.")
        for axis, law in self.axes.items():
            require_law_in_metres(axis, law)
        _ = self.coupled  # raises if the two laws cannot be coupled
        for axis, law in self.axes.items():
            if law is None:
                continue
            for end, rated in zip(law.travel_ends, self.rated_travel(axis), strict=True):
                ends = f"[{axis}] {law.name} holds up to a deflection of {end:.6g} m, where {law.travel_rule}"
                if rated is None and end < math.inf and law.needs_rating:
                    raise ValueError(f"{ends}: such a law needs a rated travel on both sides, less than that.")
                if rated is not None and (end < rated or (end == rated and law.needs_rating)):
                    raise ValueError(f"{ends}; that is inside the rated travel of {rated:.6g} m.")
        if self.geometry is not None:
            self.geometry.require_room(self.limits.travel)
        _ = self.conditioned  # raises if a stiffened law is none

    @property
    def axes(self) -> dict[str, Law | None]:
        """The laws by axis in the order roll (x), shear (y), axial (z)."""
        return {"roll": self.roll, "shear": self.shear, "axial": self.axial}

    @cached_property
    def coupled(self) -> BiaxialBoucWen | LoopBoucWen | None:
        """The laws of the coupled axes as one, or None if the axes are independent."""
        if self.coupling is None:
            return None
        both = {axis: self.axes[axis] for axis in COUPLINGS[self.coupling]}
        stiff = [law.bracket_stiffness for law in both.values() if law is not None]
        laws: Entries = {axis: law.behind_bracket for axis, law in both.items() if law is not None}
        laws["brackets"] = None if min(stiff) == math.inf else tuple(stiff)
        return BiaxialBoucWen(**laws) if self.loop is None else LoopBoucWen(**laws, loop=self.loop)

    @property
    def coupled_axes(self) -> tuple[int, ...]:
        """Indices of the two coupled axes among roll, shear and axial; none if the axes are independent."""
        return () if self.coupling is None else tuple(AXES.index(axis) for axis in COUPLINGS[self.coupling])

    @cached_property
    def holds_everywhere(self) -> bool:
        """True if all laws hold at any deflection."""
        return all(math.isinf(end) for law in self.axes.values() if law is not None for end in law.travel_ends)

    @cached_property
    def stops(self) -> tuple[str, ...]:
        return tuple(axis for axis, law in self.axes.items() if law is not None for _ in law.stops)

    @cached_property
    def is_stop(self) -> bool:
        """True if all laws are stops and nothing is rated: listed with contacts, and not among the isolators."""
        return all(law is None or law.only_stops for law in self.axes.values()) and self.limits == Limits()

    @cached_property
    def conditioned(self) -> "Isolator":
        """The isolator as it acts: with the factors of its stiffening and temperature, on its bracket; itself without any.

        It has neither these, nor spread, which speaks of the laws as written.
        """
        if self.bracket is not None:
            rigid = replace(self, bracket=None).conditioned
            laws: Entries = {}
            for axis, stiffness in self.bracket.stated.items():
                law = rigid.axes[axis]
                if law is None:
                    raise ValueError(f"`bracket` holds {axis}, along which {self.name} has no law.")
                laws[axis] = on_bracket(law, stiffness)
            return replace(rigid, spread=None, **laws)
        if self.temperature is not None and (factors := self.temperature.factors) != (1.0, 1.0):
            stiffness, damping = factors
            return replace(self, temperature=None).scaled(stiffness).with_damping(damping).conditioned
        if self.stiffening is None or (factor := self.stiffening.factor) == 1.0:
            return self
        return replace(self, stiffening=None).scaled(factor)

    @property
    def n_states(self) -> int:
        """Number of internal states of the laws as they act: a damper on a bracket has one."""
        return sum(law.n_states for law in self.conditioned.axes.values() if law is not None)

    def scaled(self, factor: float) -> "Isolator":
        """Return the isolator with all forces and torques times a factor > 0; limits are kept, its spread is dropped."""
        parts = {**self.axes, "loop": self.loop, "rotation": self.rotation}
        scaled = {name: part.scaled(factor) for name, part in parts.items() if part is not None}
        return replace(self, spread=None, **scaled)  # type: ignore[arg-type]

    def with_damping(self, factor: float) -> "Isolator":
        """Return the isolator with the hysteretic and viscous part of every law times a factor > 0, see `Law.with_damping`."""
        return self.multiplied("friction", factor)

    def with_friction(self, factor: float) -> "Isolator":
        """Return the isolator with the hysteretic part of every law times a factor > 0, see `Law.with_friction`."""
        laws = {axis: law.with_friction(factor) for axis, law in self.axes.items() if law is not None}
        return replace(self, spread=None, **laws)  # type: ignore[arg-type]

    def multiplied(self, name: str, factor: float) -> "Isolator":
        """Return the isolator with a factor of `wirerope_mj.mounts.laws.law.FACTORS` on every law, see `Law.multiplied`."""
        laws = {axis: law.multiplied(name, factor) for axis, law in self.axes.items() if law is not None}
        return replace(self, spread=None, **laws)  # type: ignore[arg-type]

    def rated_travel(self, axis: str) -> tuple[float | None, float | None]:
        """Look up how far the axis may deflect below and above zero [m], both positive; None = not judged."""
        one_of("axis", axis, AXES)
        below, above = (self.limits.travel.stated.get(rating) for rating in SIDES[axis])
        return below, above

    def save(self, path: str | Path) -> None:
        """Write the isolator file, atomically."""
        text = tomli_w.dumps(self.to_dict(), multiline_strings=True)
        with atomic_file(Path(path)) as temporary:
            temporary.write_text(text, encoding="utf-8")

    def to_dict(self) -> Entries:
        """Return the isolator as it stands in its file."""
        stated = {"name": self.name, "coupling": self.coupling, "free": list(self.free)}
        content: Entries = {name: value for name, value in stated.items() if value}
        content |= {axis: law.to_dict() for axis, law in self.axes.items() if law is not None}
        parts = {item.name: getattr(self, item.name) for item in fields(self)}
        tables = {name: part.to_dict() for name, part in parts.items() if isinstance(part, Part | LoopCoupling)}
        return content | {name: table for name, table in tables.items() if table}

    @classmethod
    def from_dict(cls, content: Entries, *, where: str | Path = "isolator") -> "Isolator":
        """Return the isolator that a file's content describes; messages call it `where`, by the lines of that file if a path.

        ModelError: something is missing, extra, wrongly typed, not finite or not passive; the message names where, axis, key
        and rule.
        """
        return structure(cls, content, Place(where), {Law: read_law})


BOTTOM = "bottom_of_"  # Begins the names of stops where devices bottom
# Stiffness of that stop over the device's secant to there, as bump stops beside such devices have (14 MN/m at a WR16-400), and
# its rounding over the travel: assumed, nobody states them.
_SOLID, _SEATING = 50.0, 0.02


def bottom_stop(device: Isolator) -> Isolator | None:
    """Make the stop that acts where a device goes solid in compression, and where its rope is straight in tension.

    It goes solid where its bars meet, height - 2 bar, else, of a part of a catalogue, at its largest travel in compression,
    beyond which the vendor says that it bottoms. None where neither is known, and without an axial law.
    """
    geometry, law = device.geometry or Geometry(), device.conditioned.axial
    if law is None or device.is_stop:
        return None
    solid, where = geometry.solid_compression, "its height less two bars"
    if solid is None and device.provenance.kind == "catalogue":
        solid, where = device.limits.travel.compression, "the vendor's largest travel in compression"
    if solid is None:
        return None
    straight = geometry.straight_tension
    assumed = ["the stiffness is 50 times the device's secant to there, without loss, and closes over a fiftieth of the travel"]
    if straight is not None:
        assumed.append("the rope is straight where the roundest loop of this size is, and holds there with the same stiffness")
    reach = min(solid, 0.999 * law.travel_ends[0])
    path = np.array([0.0, -reach])
    force = law.trace(path, time=None if law.rate_independent else np.array([0.0, 1e3])).force[-1]
    stop = Stop(
        gap_below=round(solid, 9), gap_above=None if straight is None else round(straight, 9), rounding=_SEATING * solid,
        k=float(f"{_SOLID * abs(float(force)) / reach:.4g}"),
    )  # fmt: skip
    return Isolator(
        name=f"Bottom of {device.name}", axial=stop, geometry=_core_geometry(device),
        provenance=Provenance(kind="estimated", source=f"{device.name}: {where}", assumed=tuple(assumed)),
    )  # fmt: skip


def _core_geometry(device: Isolator) -> Geometry | None:
    """Return the geometry of a stop inside a device, as tall as it, so that one of another height moves the stop along."""
    height = device.geometry and device.geometry.height
    return Geometry(height=height, width=0.25 * height) if height else None


_NOWHERE = 1.0  # Gap of a stop [m] where it is not known where a device goes solid: none travels as far


def bottom_in_place(stop: Isolator, device: Isolator) -> Isolator:
    """Make a mount's bottom stop anew for another device; one that never closes if the device's sizes are unknown."""
    unknown = replace(
        stop, axial=replace(cast(Stop, stop.axial), gap_below=_NOWHERE, gap_above=None), geometry=_core_geometry(device)
    )
    return bottom_stop(device) or unknown


_UNRATED_FRACTION = 0.05  # of the height, where no travel is rated: small enough for every mount
_UNRATED = 0.005  # [m], where not even the height is known


def isolators_at(temperature: str, isolators: Mapping[str, Isolator]) -> dict[str, Isolator]:
    """Return isolators at a temperature, such as "-20 degC", by name; stops stay as they are.

    ValueError: the text is no temperature, or an isolator states no factors, or none for it; says what to write where.
    """
    celsius, *more = values_with_unit(temperature, "temperature", TEMPERATURE_UNITS)
    if more:
        raise ValueError(f'one temperature must stand there, such as "-20 degC", got {temperature!r}.')
    silent = [device.name for device in isolators.values() if device.temperature is None and not device.is_stop]
    if silent:
        raise ValueError(
            f"no factors over temperature are stated for {', '.join(dict.fromkeys(silent))}. Write those of the data sheet "
            "into the isolator file, [temperature] with celsius = [-40, 20, 70], stiffness = [1.3, 1.0, 0.95] and damping = "
            "[..], or leave the temperature out."
        )
    made = {}
    for name, device in isolators.items():
        try:
            stated = device.temperature and replace(device.temperature, at=celsius)
        except ValueError as error:
            raise ValueError(f"{device.name}: [temperature] {error}") from None
        made[name] = replace(device, temperature=stated)
    return made


def distinct_axes(isolator: Isolator) -> list[tuple[str, str, Law]]:
    """Return title, axis and law of each axis with a force; roll and shear are one if equal in law and rating."""
    present = [(axis, law) for axis, law in isolator.axes.items() if law is not None]
    same = isolator.roll is not None and isolator.roll == isolator.shear
    if same and isolator.rated_travel("roll") == isolator.rated_travel("shear"):
        return [("roll and shear" if axis == "roll" else axis, axis, law) for axis, law in present if axis != "shear"]
    return [(axis, axis, law) for axis, law in present]


def largest_amplitude(isolator: Isolator, axis: str) -> float:
    """Return the amplitude of the largest loop worth drawing [m]: the rated travel, or 5 % of the height, or 5 mm.

    An unrated law goes that much beyond the largest gap of its stops, a tabulated one to its end; none beyond the nearer
    end of its range.
    """
    rated = max((travel for travel in isolator.rated_travel(axis) if travel is not None), default=None)
    height = isolator.geometry.height if isolator.geometry is not None else None
    law, size = isolator.axes[axis], rated or (_UNRATED if height is None else _UNRATED_FRACTION * height)
    if law is None:
        return size
    if rated is None and law.finite_travel < math.inf and any(not part.needs_rating for part in law.components):
        return law.finite_travel
    return min(size if rated else largest_gap(law) + size, law.finite_travel)


def amplitudes_of(isolator: Isolator, axis: str, fractions: Sequence[float]) -> list[float]:
    """Return amplitudes as fractions of the largest [m]; of an unrated axis with stops alone, of the travel beyond the gap."""
    law, largest = isolator.axes[axis], largest_amplitude(isolator, axis)
    rated = any(travel is not None for travel in isolator.rated_travel(axis))
    start = largest_gap(law) if law is not None and law.only_stops and not rated else 0.0
    return [start + fraction * (largest - start) for fraction in fractions]
