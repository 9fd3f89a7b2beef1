"""Several laws on one axis."""

import re
from collections.abc import Callable, Iterable, Iterator
from dataclasses import dataclass, fields, replace
from functools import cached_property
from itertools import accumulate, chain
from operator import attrgetter
from typing import Any, ClassVar, Self

import numpy as np

from wirerope_mj.foundation.arrays import Array, Entries
from wirerope_mj.mounts.laws.law import FACTORS, Law

PARALLEL = 14


def part_of(name: str) -> tuple[int, str]:
    """Split "laws[0].alpha", a parameter of one of several laws, into 0 and "alpha"; ValueError for other names."""
    if match := re.fullmatch(r"laws\[(\d+)\]\.(.+)", name):
        return int(match[1]), match[2]
    raise ValueError(f"a parameter of one of several laws is called laws[0].NAME, got {name!r}.")


def _of_laws(name: str, combine: Callable[[Iterator[Any]], Any], doc: str) -> Any:
    return property(lambda self: combine(getattr(law, name) for law in self.laws), doc=doc)


def _numbered(texts: Iterable[Iterable[str]]) -> tuple[str, ...]:
    return tuple(f"{text}_{number}" for number, of_law in enumerate(texts, 1) for text in of_law)


@dataclass(frozen=True, kw_only=True)
class Parallel(Law):
    """Several laws that share one deflection: F = F_1 + F_2 + .., as an isolator with a bump stop inside.

    In an isolator file an axis has `laws`, a list of tables, in place of `law`.
    """

    name: ClassVar[str] = "parallel"
    kernel: ClassVar[int] = PARALLEL

    laws: tuple[Law, ...]

    initial_stiffness = _of_laws("initial_stiffness", sum, "Sum of the tangents at the unloaded state [N/m].")
    closed_stiffness = _of_laws("closed_stiffness", sum, "Sum of the tangents with all stops closed [N/m].")
    damping_coefficient = _of_laws("damping_coefficient", sum, "Sum of the derivatives by the rate [N s/m].")
    closed_damping = _of_laws("closed_damping", sum, "Sum of the derivatives by the rate with all stops closed [N s/m].")
    largest_force = _of_laws("largest_force", sum, "Sum of the forces at most [N]: finite if none has an elastic part.")
    rate_independent = _of_laws("rate_independent", all, "True if all of them are.")
    remembers_slow_paths = _of_laws("remembers_slow_paths", any, "True if any of them does.")
    relaxation_rate = _of_laws("relaxation_rate", max, "Fastest decay of an internal state at rest [1/s].")
    is_steep = _of_laws("is_steep", any, "True if any of them is.")
    stops = _of_laws("stops", lambda each: tuple(chain.from_iterable(each)), "The stops among the laws.")
    components: ClassVar[Any] = property(attrgetter("laws"))
    damping_parameters = _of_laws("damping_parameters", _numbered, "Those of each law, with its number.")
    state_names = _of_laws("state_names", _numbered, "Names of the states of each law, with its number.")

    def __post_init__(self) -> None:
        laws = tuple(self.laws) if isinstance(self.laws, list | tuple) else ()
        if not laws or not all(isinstance(law, Law) and not isinstance(law, Parallel) for law in laws):
            raise ValueError(f"`laws` must be a list of one law or more, none of them parallel itself, got {self.laws!r}.")
        object.__setattr__(self, "laws", laws)

    def kernel_parameters(self) -> Array:
        """Return the number of laws; number, first parameter and first state of each; and all their parameters."""
        parameters = [law.kernel_parameters() for law in self.laws]
        first = accumulate((p.size for p in parameters[:-1]), initial=self.parameters_before)
        state = accumulate((law.n_states for law in self.laws[:-1]), initial=0)
        rows = [float(v) for row in zip((law.kernel for law in self.laws), first, state, strict=True) for v in row]
        return np.concatenate([[float(len(self.laws))], rows, *parameters])

    @property
    def parameters_before(self) -> int:  # type: ignore[override]
        return 1 + 3 * len(self.laws)

    def faint(self) -> Self:
        return replace(self, laws=tuple(law.faint() for law in self.laws))

    def same_structure(self, other: Law | None) -> bool:
        if other is None or type(self) is not type(other) or len(self.laws) != len(other.components):
            return False
        return all(law.same_structure(same) for law, same in zip(self.laws, other.components, strict=True))

    def unchecked(self, values: Entries) -> Self:
        if set(values) & set(FACTORS):
            return super().unchecked(values)
        varied = object.__new__(type(self))
        parts = zip(self.laws, self.composed(values), strict=True)
        vars(varied)["laws"] = tuple(law.unchecked(changes) for law, changes in parts)
        return varied

    @property
    def travel_rule(self) -> str:  # type: ignore[override]
        """Why the law does not hold beyond its finite travel."""
        return min(self.laws, key=lambda law: law.finite_travel).travel_rule

    def with_friction(self, factor: float) -> Self:
        return replace(self, laws=tuple(law.with_friction(factor) for law in self.laws))

    def multiplied(self, name: str, factor: float) -> Self:
        return replace(self, laws=tuple(law.multiplied(name, factor) for law in self.laws))

    @property
    def travel_ends(self) -> tuple[float, float]:
        ends = np.array([law.travel_ends for law in self.laws]).min(axis=0)
        return float(ends[0]), float(ends[1])

    @property
    def finite_travel(self) -> float:  # type: ignore[override]
        return min(self.travel_ends)

    @property
    def needs_rating(self) -> bool:  # type: ignore[override]
        """True if a component of limited travel requires a rated travel."""
        return any(law.needs_rating for law in self.laws if law.finite_travel < np.inf)

    def certainly_valid(self, columns: Entries) -> bool:
        """Tell whether each law is certainly valid with the columns' values of its parameters; False means unknown."""
        if not all(law.force_powers for law in self.laws):  # a law around another one is tried entry by entry
            return False
        for law, changes in zip(self.laws, self.composed(columns), strict=True):
            whole = law.completed(changes)
            for name in FACTORS:
                factor = np.asarray(columns.get(name, 1.0))
                if not (np.isfinite(factor) & (factor > 0.0)).all():
                    return False
                for key, power in law.powers_of(name).items() if name in columns else ():
                    value = whole.get(key, getattr(law, key))
                    many = isinstance(value, tuple)
                    whole[key] = tuple(number * factor**power for number in value) if many else value * factor**power
            if not law.certainly_valid(whole):
                return False
        return True

    @cached_property
    def factors(self) -> tuple[str, ...]:  # type: ignore[override]
        """Names of factors on all laws: `FACTORS`, and of laws of one kind the numbers that are not all 0, as "alpha"."""
        if len({type(law) for law in self.laws}) > 1:
            return FACTORS
        values = [{field.name: getattr(law, field.name) for field in fields(law)} for law in self.laws]
        numbers = [{name: value for name, value in of_law.items() if isinstance(value, float)} for of_law in values]
        shared = [
            key for key in numbers[0] if all(key in number for number in numbers) and any(number[key] for number in numbers)
        ]
        return (*FACTORS, *shared)

    def parameter(self, name: str) -> Any:
        """Return a parameter of one of the laws, "laws[0].alpha", or 1 for a factor on all of them."""
        if name in self.factors:
            return 1.0
        number, key = part_of(name)
        return self.laws[number].parameter(key)

    def completed(self, values: Entries) -> Entries:
        """Return the laws with new values of parameters and factors, named as in `parameter`."""
        changes = self.composed(values)
        pairs = zip(self.laws, changes, strict=True)
        varied = replace(self, laws=tuple(replace(law, **law.completed(change)) for law, change in pairs))
        for name in FACTORS:
            varied = varied.multiplied(name, values[name]) if name in values else varied
        return {"laws": varied.laws}

    def composed(self, values: Entries) -> list[Entries]:
        """Compute the new parameters of each law from single values and from factors on all laws."""
        changes: list[Entries] = [{} for _ in self.laws]
        for name, value in values.items():
            if name not in self.factors:
                row, key = part_of(name)
                changes[row][key] = value
        for name in set(values) & (set(self.factors) - set(FACTORS)):
            for law, change in zip(self.laws, changes, strict=True):
                change[name] = values[name] * change.get(name, law.parameter(name))
        return changes

    def to_dict(self) -> Entries:
        return {"laws": [law.to_dict() for law in self.laws]}
