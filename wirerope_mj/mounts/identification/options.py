"""Options of `identify`, checked, and the unknowns that they leave."""

from collections.abc import Mapping, Sequence
from dataclasses import replace
from typing import Any, Literal, get_args

from wirerope_mj.foundation.arguments import finite, one_of, positive
from wirerope_mj.mounts.identification.coordinates import Coordinate, Family
from wirerope_mj.mounts.identification.residuals import Data
from wirerope_mj.mounts.identification.search import Method, Unknowns
from wirerope_mj.mounts.laws import Law

Constraint = Literal["beta>gamma", "beta=gamma", "beta<gamma"]


def require_options(
    method: Any,
    data: Any,
    constraint: Any,
    noise: Any,
    grid: bool,
    start: Any,
    fixed: Any,
    extra_residuals: Any,
) -> None:
    """Raise ValueError unless the options of `identify` are known and go together."""
    one_of("method", method, get_args(Method))
    one_of("data", data, get_args(Data))
    if constraint is not None:
        one_of("constraint", constraint, get_args(Constraint))
    if noise is not None:
        positive("noise", noise)
    if start is None and not grid:
        raise ValueError("`grid` is False and there is no `start`: a search has nowhere to begin.")
    if method == "frequency" and (start is None or data != "loops"):
        raise ValueError(
            "`method='frequency'` needs a law to `start` at and `data='loops'`: from the grid searches go by forces."
        )
    if not isinstance(fixed, Mapping):
        raise ValueError(f"`fixed` must be a mapping of names to values, got {fixed!r}.")
    for name, value in fixed.items():
        finite(f"fixed[{name!r}]", value)
    if not isinstance(extra_residuals, Sequence) or not all(callable(one) for one in extra_residuals):
        raise ValueError(f"`extra_residuals` must be a sequence of functions of a law, got {extra_residuals!r}.")


def unknowns_of(
    law: type[Law],
    family: Family,
    coordinates: list[Coordinate],
    fixed: dict[str, float],
    free: Sequence[str],
    constraint: Constraint | None,
    start: Law | None,
) -> Unknowns:
    """Return the coordinates that are searched for and those that are fixed; ValueError where the options contradict."""
    if start is not None and type(start) is not law:
        raise ValueError(f"`start` must be a {law.name} law, got {start!r}.")
    if fixed.get("loss") == 0.0:  # an elastic stop has none
        coordinates = [c for c in coordinates if c.name != "reversal"]
    names = [c.name for c in coordinates]
    for option, named in (("fixed", fixed), ("free", free)):
        for name in named:
            if name not in names:
                raise ValueError(
                    f"`{option}` names {name!r}, which {law.name} does not have; it has {', '.join(names)}."
                )
    if both := [name for name in free if name in fixed]:
        raise ValueError(f"`fixed` and `free` both name {', '.join(both)}.")
    begun = family.read(start) if start is not None else {}
    usual = {
        name: value for name, value in family.usual.items() if name not in free and begun.get(name, value) == value
    }
    fixed = {**usual, **fixed}
    if start is not None and (missing := [n for n in names if n not in fixed and n not in begun]):
        raise ValueError(
            f"`start` must give {', '.join(missing)}, which the loops show and the search moves, got {start!r}."
        )
    if set(names) <= set(fixed):
        raise ValueError(f"`fixed` names all parameters, {', '.join(names)}: nothing is left to search for.")
    if constraint is not None:
        if "sigma" not in names:
            raise ValueError(f"`constraint` is between beta and gamma, and {law.name} does not have both.")
        if "sigma" in fixed:
            raise ValueError(
                "`constraint` and `fixed` both say what sigma = beta / (beta + gamma) may be; give one of them."
            )
        coordinates = [_constrained(c, constraint) if c.name == "sigma" else c for c in coordinates]
        if constraint == "beta=gamma":
            fixed["sigma"] = 0.5
    return Unknowns(family=family, coordinates=coordinates, fixed=fixed)


def _constrained(sigma: Coordinate, constraint: Constraint) -> Coordinate:
    """Return the coordinate sigma = beta / (beta + gamma) within the thesis' constraint."""
    if constraint == "beta>gamma":
        return replace(sigma, lower=0.5)
    return replace(sigma, upper=0.5) if constraint == "beta<gamma" else sigma
