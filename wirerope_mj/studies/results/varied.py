"""What varies in a study as a table says it: kind and unit of the numbers, what the model says, and the distribution."""

from collections.abc import Sequence
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

import numpy as np

from wirerope_mj.studies.inputs.distributions import (
    Choice,
    Distribution,
    Isotropic,
    Normal,
    Specimens,
    Uniform,
)
from wirerope_mj.studies.inputs.nominal import kind_of, model_unit, nominal, nominal_text, unit_of
from wirerope_mj.studies.inputs.quantities import Quantity

if TYPE_CHECKING:
    from wirerope_mj.studies.study import Study

HEAD = ("quantity", "is a", "in the model", "values", "of what the name matches")
"""Headings of a table of what varies."""

_CHOICES = 8  # numbers of a choice that are told one by one


@dataclass(frozen=True, kw_only=True)
class Varied:
    """One quantity that varies.

    Attributes:
        name: as `vary` says it.
        kind: of its numbers: "value", "shift", "factor", "index" or "choice".
        unit: of its numbers; "" without one, "SI" as the law states.
        model: what the model says, in words: for a shift the position that is shifted, for a factor what it multiplies.
        nominal: the smallest and the largest number that the model says; empty if it says none.
        nominal_unit: of these; "SI" as the law states.
        distribution: of its numbers.
    """

    name: str
    kind: str
    unit: str
    model: str
    nominal: tuple[float, ...]
    nominal_unit: str
    distribution: Distribution

    @property
    def cells(self) -> tuple[str, str, str, str, str]:
        """A row of a table under `HEAD`."""
        group = self.distribution.group
        name = f"{self.name} ({group})" if group else self.name
        kind = f"{self.kind} [{self.unit}]" if self.unit else self.kind
        own = "each its own" if self.distribution.each else "one for all"
        return name, kind, self.model, distribution_words(self.distribution), own

    def to_dict(self) -> dict[str, Any]:
        """Return it as plain values for `summary.json`."""
        found: dict[str, Any] = {"name": self.name, "kind": self.kind}
        if self.unit:
            found["unit"] = self.unit
        if self.nominal:
            lowest, highest = self.nominal
            found["nominal"] = lowest if lowest == highest else [lowest, highest]
            found |= {"nominal_unit": self.nominal_unit} if self.nominal_unit else {}
        return {**found, "distribution": distribution_words(self.distribution)}


def varied_of(study: "Study") -> list[Varied]:
    """Return what varies in a study, in the order of `vary`."""
    return [_varied(quantity, study) for quantity in study.quantities]


def _varied(quantity: Quantity, study: "Study") -> Varied:
    column = quantity.columns[0]
    # Of specimens many parameters vary, each about its own value.
    many = isinstance(quantity.distribution, Specimens)
    every = [] if many else [one for own in quantity.columns for one in nominal(own, study.base, study.motions)]
    numbers = np.concatenate([np.ravel(one) for one in every]) if every else np.empty(0)
    ends = () if numbers.size == 0 or numbers.dtype == np.bool_ else (float(numbers.min()), float(numbers.max()))
    kind, there = kind_of(column), nominal_text(every, model_unit(column))
    return Varied(
        name=quantity.name,
        kind=kind,
        unit=unit_of(column),
        model="the isolator's" if many else f"shifted from {there}" if kind == "shift" else there,
        nominal=ends,
        nominal_unit=model_unit(column),
        distribution=quantity.distribution,
    )


def distribution_words(distribution: Distribution) -> str:
    """Return a distribution in words: "normal, mean 0.35, standard deviation 0.03"."""
    if isinstance(distribution, Normal):
        ends = [
            f"{word} {end:g}"
            for word, end in (("from", distribution.low), ("to", distribution.high))
            if end is not None
        ]
        bounds = f", {' '.join(ends)}" if ends else ""
        return f"normal, mean {distribution.mean:g}, standard deviation {distribution.deviation:g}{bounds}"
    if isinstance(distribution, Uniform):
        points = f", {distribution.points} values" if distribution.points is not None else ""
        return f"uniform, from {distribution.low:g} to {distribution.high:g}{points}"
    if isinstance(distribution, Isotropic):
        between = f"from {distribution.low:g} to {distribution.high:g}"
        return f"directions equally likely over the sphere, {between} above the horizon"
    if isinstance(distribution, Choice):
        return _choices(distribution.choices)
    return "scatter of the specimens that the isolator was identified from"


def _choices(values: Sequence[Any]) -> str:
    """Return the values of a choice; of many numbers how many, and from where to where."""
    distinct = list(dict.fromkeys(values))
    if len(distinct) <= _CHOICES or not all(isinstance(value, int | float) for value in distinct):
        return f"one of {', '.join(map(_word, distinct))}"
    return f"one of {len(distinct)} values from {_word(min(distinct))} to {_word(max(distinct))}"


def _word(value: Any) -> str:
    return f"{value:.4g}" if isinstance(value, float) else str(value) or "none"
