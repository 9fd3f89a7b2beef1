"""A quantity that can vary: how it is written, what the model says of it, and what its numbers do to a variant.

Each kind of quantity is a class of columns of a study's inputs; `quantities.KINDS` lists them.
"""

import re
from collections.abc import Collection, Sequence
from dataclasses import dataclass, field, replace
from fnmatch import fnmatchcase
from typing import Any, ClassVar, Literal, Self

import numpy as np
import pyarrow as pa

from wirerope_mj.engine.system import System
from wirerope_mj.foundation.arrays import AnyArray, Array, Booleans
from wirerope_mj.foundation.errors import ModelError
from wirerope_mj.motions import BaseMotion
from wirerope_mj.mounts.isolator import Isolator
from wirerope_mj.studies.vary.distributions import Choice, Distribution

WHOLE = "whole"  # Stands in the key of a parameter where a law has its axis: the factor is on all of a mount
FAR = 10.0  # Factor between the model's value and all of a study's beyond which these may have been meant as factors
WORLD = ("x", "y", "z")
_FARTHEST = 2.0  # Shift [m] from which its unit is questioned: half of a large foundation
NEAR = 1e-6  # Distance from 0 below which a position is 0 [m]: there a value and a shift are the same


@dataclass(kw_only=True)
class Draft:
    """Changes of a variant's system, gathered column by column."""

    system: System
    # by mount, and there by ("axial", parameter), ("stiffening", parameter) or (WHOLE, a factor on it)
    parameters: dict[str, dict[tuple[str, ...], Any]] = field(default_factory=dict)
    isolators: dict[str, Isolator] = field(default_factory=dict)  # in place of the model's, by mount
    failed: set[str] = field(default_factory=set)  # mounts
    absent: set[str] = field(default_factory=set)  # mounts
    masses: dict[str, float] = field(default_factory=dict)  # factors by body
    centres: dict[str, Array] = field(default_factory=dict)  # of mass in the body's axes [m], by body
    centre_shifts: dict[str, list[float]] = field(default_factory=dict)  # along the world's axes [m], by body
    position_shifts: dict[str, list[float]] = field(default_factory=dict)  # along the world's axes [m], by mount
    turns: dict[str, list[float]] = field(default_factory=dict)  # rotation vectors about the world's axes [°], by mount
    tunings: dict[str, float] = field(default_factory=dict)  # factors on natural frequencies, by joint

    @property
    def gone(self) -> list[str]:
        """Mounts that exert no force: failed or absent."""
        return sorted(self.failed | self.absent)


@dataclass(frozen=True, kw_only=True)
class Entry:
    """One entry of `vary` with the system and the motions in which it varies."""

    name: str
    pattern: str  # of mounts or bodies in the name; "" of a motion
    key: tuple[str, ...]  # the rest of the name: axis and parameter, for instance
    distribution: Distribution
    system: System
    motions: Sequence[BaseMotion]

    def chooses_among(self, *kinds: type) -> bool:
        """Tell whether the distribution is a Choice whose values are exactly of these types."""
        return isinstance(self.distribution, Choice) and all(type(value) in kinds for value in self.distribution.choices)


@dataclass(frozen=True, kw_only=True)
class Quantity:
    """One entry of `vary`, resolved to columns of the inputs."""

    name: str
    distribution: Distribution
    columns: "tuple[InputColumn, ...]"  # one, or one for each mount or body; for specimens one for each parameter
    isolators: tuple[Isolator, ...] = ()  # of specimens, one for each group of columns that are sampled jointly


@dataclass(frozen=True, kw_only=True)
class InputColumn:
    """One sampled number, its column in the table, and what it acts on."""

    form: ClassVar[str]  # the name as it is written, with NAME for mounts or bodies
    #: of such names, that of the form unless a class says otherwise; its first group is NAME, the others are the key
    pattern: ClassVar[re.Pattern[str]]
    acts: ClassVar[Literal["value", "shift", "factor", "index", "choice"]] = "value"  # how the numbers do
    model_unit: ClassVar[str] = ""  # of what the model says: "SI" as the law states
    type: ClassVar[pa.DataType] = pa.float64()  # of the numbers in the table
    places_mounts: ClassVar[bool] = False  # whether it says where mounts are
    noun: ClassVar[str] = ""  # what its targets are called
    into: ClassVar[str] = ""  # the field of `Draft` that gathers the numbers by target, or the setting of the motion
    bounds: ClassVar[Literal["", "finite", "positive"]] = ""  # of all numbers that are valid; "" where they do not tell

    name: str  # of the column
    targets: tuple[str, ...] = ()  # mounts or bodies
    key: tuple[str, ...] = ()  # axis and parameter, for instance
    relative: bool = False  # whether the numbers are factors on what the model says

    def __init_subclass__(cls) -> None:
        if "form" in vars(cls) and "pattern" not in vars(cls):
            cls.pattern = re.compile(re.sub("/x$", "/([^/]*)", cls.form).replace("NAME", "(.*)"))

    @property
    def parts(self) -> "tuple[InputColumn, ...]":
        """Columns that share one draw; itself if it shares none."""
        return (self,)

    @property
    def nature(self) -> str:
        """Effect of the numbers: "value", "shift", "factor", "index" or "choice"."""
        return "factor" if self.relative else self.acts

    @property
    def unit(self) -> str:
        """Unit of the numbers; "" of factors, indices and choices."""
        return "" if self.relative else self.model_unit

    @property
    def label(self) -> str:
        """Words for the name with the unit of the numbers, as an axis or a heading says it: "motion level [factor]"."""
        unit, words = "factor" if self.nature == "factor" else self.unit, self.name.replace("/", " ")
        return words if unit in ("", "SI") else f"{words} [{unit}]"

    @classmethod
    def existing(cls, system: System) -> dict[str, bool]:
        """Return the names that can vary, each with whether it is a stop, which * leaves out if other names match."""
        raise NotImplementedError

    @classmethod
    def resolve(cls, entry: Entry) -> "tuple[InputColumn, ...]":
        """Return the columns of an entry whose name has this form.

        ModelError if it stands for nothing that exists; ValueError if the distribution does not suit it.
        """
        return cls.split(entry, cls.matching(entry, entry.pattern))

    @classmethod
    def matching(cls, entry: Entry, pattern: str) -> list[str]:
        """Return the names that match a pattern's parts; a part that matches isolators and stops, as *, means isolators."""
        matches: list[str] = []
        existing = cls.existing(entry.system)
        for part in parts_of(pattern, existing):
            matched = [name for name in existing if fnmatchcase(name, part)]
            if not matched:
                raise ModelError(f"`vary`: {entry.name!r}: there is no {cls.noun} {part!r}. There is: {', '.join(existing)}.")
            matches += [name for name in matched if not existing[name]] or matched
        return list(dict.fromkeys(matches))

    @classmethod
    def split(cls, entry: Entry, targets: Sequence[str]) -> "tuple[Self, ...]":
        """Return one column for all targets, or one for each target if the distribution says `each`."""
        name, distribution = entry.name, entry.distribution
        choices = distribution.choices if isinstance(distribution, Choice) and cls.type == pa.float64() else ()
        if any(isinstance(value, bool | str) for value in choices):
            raise ValueError(f"`vary`: {name!r} must be a distribution of numbers, got {distribution}.")
        start = name.index("/") + 1
        before, after = name[:start], name[start + len(entry.pattern) :]
        each = [(f"{before}{target}{after}", (target,)) for target in targets]
        groups = each if distribution.each else [(name, tuple(targets))]
        return tuple(cls(name=name, targets=part, key=entry.key, relative=distribution.relative) for name, part in groups)

    def nominal(self, system: System, motions: Sequence[BaseMotion] = ()) -> list[Any]:
        """Return the values in the model, one for each target; empty where the model has none.

        Of a shift it is the position that is shifted, of a factor the value that is multiplied: [m], [kg], SI, [deg].
        """
        values = (self.nominal_of(system, target) for target in self.targets)
        return [value for value in values if value is not None]

    def nominal_of(self, system: System, target: str) -> Any:
        """Return the value of one target in the model; None where it is not one number."""
        return None

    def nominal_text(self, system: System) -> str:
        return nominal_text(self.nominal(system), self.model_unit)

    def apply(self, draft: Draft, value: Any) -> None:
        """Apply a value of the column to a variant; ValueError if it is invalid."""
        raise NotImplementedError

    def certainly_valid(self, draft: Draft, values: AnyArray) -> bool:
        """Tell whether all values are valid; False means unknown. Parameters of laws go into `draft`, to be checked jointly."""
        if not self.bounds:
            return False
        return bool(np.isfinite(values).all()) and (self.bounds == "finite" or bool(values.min() > 0.0))

    def moved(self, system: System, values: AnyArray) -> Booleans:
        """Return the mask of the values that give something another position than the model, (n,)."""
        return np.zeros(len(values), dtype=np.bool_)

    def warnings(self, system: System, values: Array) -> list[str]:
        """Return warnings if the sampled values look like another kind than the name says."""
        return []


class ValueOrFactor(InputColumn):
    """Column of values in place of the model's, or of factors on them."""

    def warnings(self, system: System, values: Array) -> list[str]:
        """Return a warning if factors look like values, or values like factors on the model's."""
        low, high = np.abs(values).min(), np.abs(values).max()
        if self.relative:
            if high >= 1.0 / FAR and low <= FAR:
                return []
            return [
                f"{self.name} is a factor, from {low:.3g} to {high:.3g} in the study, on {self.nominal_text(system)} in the "
                "model; if these are values, leave out `relative`."
            ]
        model = np.abs(np.array(self.nominal(system), dtype=np.float64))
        if not (high < model.min() / FAR or low > model.max() * FAR > 0.0):
            return []
        return [
            f"{self.name} is from {low:.3g} to {high:.3g} in the study and {nominal_text(sorted(model), '')} in the model; if "
            "these are to be factors on the model's value, say `relative`."
        ]


class Positive(ValueOrFactor):
    """Positive quantity, which changes by a factor."""

    bounds = "positive"

    def apply(self, draft: Draft, value: float) -> None:
        if not (np.isfinite(value) and value > 0.0):
            unit = "" if self.relative else f" {self.model_unit}"
            raise ValueError(f"{self.name} must be finite and > 0{unit}, got {value:g}{unit}.")
        for target in self.targets:
            getattr(draft, self.into)[target] = value if self.relative else value / self.nominal_of(draft.system, target)


@dataclass(frozen=True, kw_only=True)
class Shift(InputColumn):
    """Shift of a mount or a centre of mass; its key is the axis."""

    acts = "shift"
    model_unit = "m"
    bounds = "finite"

    mirrored: tuple[str, ...] = ()  # targets that move the other way

    @classmethod
    def resolve(cls, entry: Entry) -> tuple[Self, ...]:
        """Return the columns of a shift; what stands behind a minus moves the other way: "m01,m04,-m13,-m16"."""
        check_axis(entry, f"a shift [{cls.model_unit}]")

        def match(parts: list[str]) -> list[str]:
            return cls.matching(entry, ",".join(parts)) if parts else []

        parts = parts_of(entry.pattern, cls.existing(entry.system))
        every = match([part.removeprefix("-") for part in parts])
        mirrored = match([part[1:] for part in parts if part.startswith("-")])
        straight = match([part for part in parts if not part.startswith("-")])
        if both := set(mirrored) & set(straight):
            raise ValueError(f"`vary`: {entry.name!r}: {min(both)!r} cannot move both ways.")
        columns = cls.split(entry, every)
        return tuple(replace(column, mirrored=tuple(t for t in column.targets if t in mirrored)) for column in columns)

    def apply(self, draft: Draft, value: float) -> None:
        check_finite(self.name, value)
        for target in self.targets:
            shift = getattr(draft, self.into).setdefault(target, [0.0, 0.0, 0.0])
            shift[WORLD.index(self.key[0])] = -value if target in self.mirrored else value

    def moved(self, system: System, values: AnyArray) -> Booleans:
        return np.asarray(values != 0.0)

    def warnings(self, system: System, values: Array) -> list[str]:
        """Return a warning if shifts look like millimetres, or like positions."""
        low, high = float(values.min()), float(values.max())
        middle = (low + high) / 2.0
        positions = [position for position in self.nominal(system) if abs(position) > NEAR]
        if self.model_unit == "m" and _FARTHEST < (most := max(-low, high)) < np.inf:
            return [f"{self.name} shifts by up to {most:.3g} m, more than any tolerance or layout: are the numbers in mm?"]
        if low <= 0.0 <= high or not any(abs(middle - position) < abs(middle) for position in positions):
            return []
        return [
            f"{self.name} is a shift, from {low:.3g} to {high:.3g} m in the study, of what stands at "
            f"{self.nominal_text(system)} in the model; if these are positions, {self.remedy(system)}."
        ]

    def remedy(self, system: System) -> str:
        return "take the model's position off them"


def acts(isolator: Isolator) -> bool:
    """True if an isolator exerts forces: the law of an axis is not its faint replacement (`without_force`)."""
    return any(law is not None and law != law.faint() for law in isolator.axes.values())


def without_force(isolator: Isolator) -> Isolator:
    """Return an isolator with laws of the same kinds that exert next to no force, as after a failure: equations stay alike."""
    acting = isolator.conditioned
    laws = {axis: law.faint() for axis, law in acting.axes.items() if law is not None}
    loop = None if acting.loop is None else acting.loop.scaled(0.0)
    return replace(isolator, loop=loop, rotation=None, stiffening=None, temperature=None, bracket=None, **laws)  # type: ignore[arg-type]


def parts_of(pattern: str, existing: Collection[str]) -> list[str]:
    """Split a pattern "m01,m04" into its parts; an existing name is one part whatever it contains."""
    return [pattern] if pattern in existing else pattern.split(",")


def nominal_text(values: Sequence[Any], unit: str) -> str:
    """Format nominal values for a cell: "0.35 m", "0.2 to 0.9 m", "True"; "-" where there are none."""
    numbers = np.concatenate([np.ravel(value) for value in values]) if values else np.empty(0)
    if numbers.size == 0:
        return "-"
    if numbers.dtype == np.bool_:
        return " or ".join(map(str, np.unique(numbers)))
    low, high = f"{numbers.min():.4g}", f"{numbers.max():.4g}"
    text = low if low == high else f"{low} to {high}"
    return f"{text} {unit}" if unit not in ("", "SI") else text


def check_axis(entry: Entry, noun: str) -> None:
    """Raise an error unless the axis of an entry is x, y or z, and its distribution is not relative."""
    (axis,) = entry.key
    if axis not in WORLD:
        raise ModelError(f"`vary`: {entry.name!r}: there is no axis {axis!r}; there are {', '.join(WORLD)}.")
    if entry.distribution.relative:
        raise ValueError(f"`vary`: {entry.name!r} is {noun} and cannot be relative.")


def check_finite(name: str, value: float) -> None:
    if not np.isfinite(value):
        raise ValueError(f"{name} must be finite, got {value}.")
