"""Quantities that vary in a study: kind and unit of their numbers, what the model says, and the distribution."""

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np

from wirerope_mj.studies.definition import StudyDefinition
from wirerope_mj.studies.inputs.column import Quantity, nominal_text
from wirerope_mj.studies.inputs.distributions import (
    Choice,
    Distribution,
    Isotropic,
    Normal,
    Specimens,
    Uniform,
)

_CHOICES = 8  # numbers of a choice that are listed one by one


@dataclass(frozen=True, kw_only=True)
class Varied:
    """One quantity that varies.

    Attributes:
        name: as `vary` says it.
        kind: of its numbers: "value", "shift", "factor", "index" or "choice".
        unit: of its numbers; "" without one, "SI" as the law states.
        model: what the model says, as text: for a shift the position that is shifted, for a factor what it multiplies.
        nominal: the smallest and the largest number that the model says; empty if it says none.
        nominal_unit: of these; "SI" as the law states.
    """

    name: str
    kind: str
    unit: str
    model: str
    nominal: tuple[float, ...]
    nominal_unit: str
    distribution: Distribution

    @property
    def distribution_text(self) -> str:
        """Distribution as text: "normal, mean 0.35, standard deviation 0.03"."""
        return distribution_text(self.distribution)

    def to_dict(self) -> dict[str, Any]:
        """Return it as plain values for `summary.json`."""
        content: dict[str, Any] = {"name": self.name, "kind": self.kind}
        if self.unit:
            content["unit"] = self.unit
        if self.nominal:
            low, high = self.nominal
            content["nominal"] = low if low == high else [low, high]
            content |= {"nominal_unit": self.nominal_unit} if self.nominal_unit else {}
        return {**content, "distribution": self.distribution_text}


def varied_of(study: StudyDefinition) -> list[Varied]:
    """Return what varies in a study, in the order of `vary`."""
    return [_varied(quantity, study) for quantity in study.quantities]


def _varied(quantity: Quantity, study: StudyDefinition) -> Varied:
    column = quantity.columns[0]
    # Of specimens many parameters vary, each about its own value.
    many = isinstance(quantity.distribution, Specimens)
    every = [] if many else [one for own in quantity.columns for one in own.nominal(study.base, study.motions)]
    numbers = np.concatenate([np.ravel(one) for one in every]) if every else np.empty(0)
    ends = () if numbers.size == 0 or numbers.dtype == np.bool_ else (float(numbers.min()), float(numbers.max()))
    kind, text = column.nature_of_numbers, nominal_text(every, column.model_unit)
    return Varied(
        name=quantity.name,
        kind=kind,
        unit=column.unit,
        model="the isolator's" if many else f"shifted from {text}" if kind == "shift" else text,
        nominal=ends,
        nominal_unit=column.model_unit,
        distribution=quantity.distribution,
    )


def distribution_text(distribution: Distribution) -> str:
    """Return a distribution as text: "normal, mean 0.35, standard deviation 0.03"."""
    if isinstance(distribution, Normal):
        ends = [
            f"{bound} {end:g}"
            for bound, end in (("from", distribution.low), ("to", distribution.high))
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
        return f"one of {', '.join(map(_value, distinct))}"
    return f"one of {len(distinct)} values from {_value(min(distinct))} to {_value(max(distinct))}"


def _value(value: Any) -> str:
    return f"{value:.4g}" if isinstance(value, float) else str(value) or "none"
