"""What of a study's system and motion can vary: names such as "mount/m*/axial/alpha", resolved to columns of the table."""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, fields, replace
from fnmatch import fnmatchcase
from typing import Any

from wirerope_mj.engine.system import System
from wirerope_mj.engine.system.varied import moving_bodies
from wirerope_mj.foundation.errors import ModelError
from wirerope_mj.motions import BaseMotion
from wirerope_mj.mounts.isolator import AXES, Isolator, Stiffening
from wirerope_mj.mounts.laws import Parallel
from wirerope_mj.studies.inputs.distributions import Choice, Distribution, Isotropic, Specimens

WORLD = ("x", "y", "z")

MOTION = ("level", "azimuth", "elevation", "record")

STIFFENING = "stiffening"
"""Stands in a name where a law has its axis."""

FORMS = (
    "mount/NAME/AXIS/PARAMETER, mount/NAME/position_shift/x, mount/NAME/fitted, mount/NAME/failed, mount/NAME/spread, "
    "mount/NAME/stiffening/cycles, mount/NAME/stiffening/after_50, body/NAME/mass, body/NAME/centre/x, "
    "body/NAME/centre_shift/x, motion/level, motion/azimuth, motion/elevation, motion/record"
)
"""What a name may look like; NAME may hold * and ?, and be several, as in m01,m04,-m13."""


@dataclass(frozen=True, kw_only=True)
class Column:
    """One sampled number, its column in the table, and what it acts on.

    Attributes:
        name: of the column.
        kind: "law", "stiffening", "fitted", "failed", "position_shift", "mass", "centre", "centre_shift", "level", "azimuth",
            "elevation" or "record".
        targets: mounts or bodies.
        mirrored: those of them that a shift moves the other way.
        key: axis and parameter of a law, "stiffening" and what of it, world axis of a shift, or the body's axis of a centre.
        relative: whether it is a factor on what the model says.
        type: of its values: "double", "int64", "bool" or "string".
    """

    name: str
    kind: str
    targets: tuple[str, ...] = ()
    mirrored: tuple[str, ...] = ()
    key: tuple[str, ...] = ()
    relative: bool = False
    type: str = "double"


@dataclass(frozen=True, kw_only=True)
class Quantity:
    """What one entry of `vary` amounts to.

    Attributes:
        name: as it was written.
        distribution: of its values.
        columns: what is sampled: one column, or one for each mount or body; for specimens one for each parameter.
        isolators: of specimens, one for each group of columns that are sampled jointly.
    """

    name: str
    distribution: Distribution
    columns: tuple[Column, ...]
    isolators: tuple[Isolator, ...] = ()


def quantities(vary: Mapping[str, Distribution], system: System, motions: Sequence[BaseMotion]) -> tuple[Quantity, ...]:
    """Return what varies, resolved for a system and its motions.

    Raises:
        ModelError: a name stands for nothing that exists; says what does.
        ValueError: a distribution does not suit its quantity, or two names stand for the same.
    """
    if not vary:
        raise ValueError(f"`vary` must name at least one quantity: {FORMS}.")
    found = tuple(_quantity(name, distribution, system, motions) for name, distribution in vary.items())
    taken: dict[tuple[str, str, tuple[str, ...]], str] = {}
    for quantity in found:
        for column in quantity.columns:
            for target in column.targets or ("",):
                other = taken.setdefault((column.kind, target, column.key), quantity.name)
                if other != quantity.name:
                    raise ValueError(f"`vary`: {other!r} and {quantity.name!r} both say {column.name!r}.")
    for (kind, target, key), name in taken.items():
        whole = taken.get((kind, target, (*key[:-1], key[-1].partition("[")[0])), name) if key else name
        if whole != name:
            raise ValueError(f"`vary`: {whole!r} is all the numbers of which {name!r} is one.")
    return found


def _quantity(name: str, distribution: Distribution, system: System, motions: Sequence[BaseMotion]) -> Quantity:
    if not isinstance(distribution, Distribution):
        raise ValueError(
            f"`vary`: {name!r} must be a Normal, Uniform, Isotropic, Choice or Specimens, got {distribution!r}."
        )
    if isinstance(distribution, Isotropic) and name != "motion/elevation":
        raise ValueError(f"`vary`: {name!r} cannot be Isotropic; it is for motion/elevation.")
    room, *parts = name.split("/")
    if room == "mount" and len(parts) >= 2 and parts[-1] == "spread":
        return _specimens(name, "/".join(parts[:-1]), distribution, system)
    if isinstance(distribution, Specimens):
        raise ValueError(f"`vary`: {name!r} cannot be Specimens; they are for mount/NAME/spread.")
    if room == "mount" and len(parts) >= 2 and parts[-1] == "fitted":
        return _fitted(name, "/".join(parts[:-1]), distribution, system)
    if room == "mount" and len(parts) >= 2 and parts[-1] == "failed":
        return _failed(name, "/".join(parts[:-1]), distribution, system)
    if room == "mount" and len(parts) >= 3 and parts[-2] in ("position", "position_shift", STIFFENING, *AXES):
        return _of_mounts(name, "/".join(parts[:-2]), (parts[-2], parts[-1]), distribution, system)
    if room == "body" and len(parts) >= 2:
        return _of_bodies(name, parts, distribution, system)
    if room == "motion" and len(parts) == 1 and parts[0] in MOTION:
        return _of_motion(name, parts[0], distribution, motions)
    raise ModelError(f"`vary`: there is no quantity {name!r}. What can vary: {FORMS}.")


def _of_mounts(name: str, pattern: str, key: tuple[str, str], distribution: Distribution, system: System) -> Quantity:
    if key[0] == "position":
        raise ModelError(
            f"`vary`: there is no quantity {name!r}: a mount's position varies by shifts [m] of where the model has it, and "
            f"they are called {f'mount/{pattern}/position_shift/{key[1]}'!r}; for a position take the model's off."
        )
    if key[0] == "position_shift":
        _check_axis(name, key[1], distribution)
        return _shifted(
            name, pattern, list(system.mounts), "mount", distribution, stops=_stops(system), kind=key[0], key=(key[1],)
        )
    mounts = _mounts(name, pattern, system)
    nominal = [_parameter(name, system.mounts[mount].written, mount, *key) for mount in mounts]
    for value in nominal:
        if isinstance(value, tuple) and not distribution.relative:
            raise ValueError(f"`vary`: {name!r} is several numbers; give it factors, `relative=True`.")
    if distribution.relative and all(value == 0.0 for value in nominal):
        raise ValueError(f"`vary`: {name!r} is 0 in the model, and 0 times anything is 0; give absolute values.")
    kind = STIFFENING if key[0] == STIFFENING else "law"
    return _split(name, pattern, mounts, distribution, kind=kind, key=key)


def _parameter(name: str, isolator: Isolator, mount: str, axis: str, parameter: str) -> Any:
    """Return a parameter of a law or of the stiffening in the model; ModelError says what there is."""
    if axis == STIFFENING:
        if isolator.stiffening is None:
            raise ModelError(f"`vary`: {name!r}: isolator {isolator.name!r} of mount {mount!r} has no [stiffening].")
        if parameter not in (known := [item.name for item in fields(Stiffening)]):
            raise ModelError(f"`vary`: {name!r}: stiffening has no {parameter!r}; it has {', '.join(known)}.")
        return float(getattr(isolator.stiffening, parameter))
    law = isolator.axes[axis]
    if law is None:
        there = [axis for axis, law in isolator.axes.items() if law is not None]
        raise ModelError(f"`vary`: {name!r}: mount {mount!r} has no law on axis {axis!r}; it has {', '.join(there)}.")
    if isinstance(law, Parallel):
        raise ModelError(
            f"`vary`: {name!r}: mount {mount!r} has several laws on its {axis} axis, which do not vary. Make the one that "
            "varies a mount of its own between the same sites."
        )
    names = [key for key in law.to_dict() if key != "law" and key not in law.options]
    lists = {key: value for key in names if isinstance(value := getattr(law, key), tuple)}
    if parameter not in names + [f"{key}[{place}]" for key, value in lists.items() for place in range(len(value))]:
        raise ModelError(
            f"`vary`: {name!r}: law {law.name} of mount {mount!r} has no parameter {parameter!r}; it has {', '.join(names)}."
        )
    value = law.parameter(parameter)
    if not isinstance(value, float | int | tuple):
        raise ModelError(f"`vary`: {name!r}: {parameter!r} of mount {mount!r} is not a number.")
    return value


def _fitted(name: str, pattern: str, distribution: Distribution, system: System) -> Quantity:
    mounts = _mounts(name, pattern, system)
    choices = distribution.choices if isinstance(distribution, Choice) else (None,)
    if not all(isinstance(value, bool) for value in choices):
        raise ValueError(f"`vary`: {name!r} must be a Choice of True and False, got {distribution!r}.")
    return _split(name, pattern, mounts, distribution, kind="fitted", key=("fitted",), type="bool")


def _failed(name: str, pattern: str, distribution: Distribution, system: System) -> Quantity:
    mounts = _mounts(name, pattern, system)
    choices = distribution.choices if isinstance(distribution, Choice) else (None,)
    if all(isinstance(value, str) for value in choices) and not distribution.each:
        unknown = [value for value in choices if value not in ("", *mounts)]
        if unknown:
            raise ModelError(
                f'`vary`: {name!r}: there is no mount {unknown[0]!r} there; choose from "" (none), {", ".join(mounts)}.'
            )
        return Quantity(
            name=name,
            distribution=distribution,
            columns=(Column(name=name, kind="failed", targets=tuple(mounts), type="string"),),
        )
    if not all(isinstance(value, bool) for value in choices):
        raise ValueError(
            f'`vary`: {name!r} must be a Choice of True and False, or of the mount\'s name that has failed ("" = none).'
        )
    return _split(name, pattern, mounts, distribution, kind="failed", key=(), type="bool")


def _of_bodies(name: str, parts: list[str], distribution: Distribution, system: System) -> Quantity:
    key: tuple[str, ...] = ()
    if parts[-1] == "mass":
        pattern, kind = "/".join(parts[:-1]), "mass"
    elif len(parts) >= 3 and parts[-2] in ("centre", "centre_shift"):
        pattern, kind, key = "/".join(parts[:-2]), parts[-2], (parts[-1],)
        _check_axis(name, parts[-1], distribution)
    else:
        raise ModelError(f"`vary`: there is no quantity {name!r}. What can vary: {FORMS}.")
    existing = [body for body in moving_bodies(system.model) if body != system.base]  # whose mass drives nothing
    word = "moving body with a mass (the driven base does not count)"
    if kind == "centre_shift":
        return _shifted(name, pattern, existing, word, distribution, kind=kind, key=key)
    return _split(name, pattern, _matching(name, pattern, existing, word), distribution, kind=kind, key=key)


def _of_motion(name: str, kind: str, distribution: Distribution, motions: Sequence[BaseMotion]) -> Quantity:
    if distribution.relative:
        raise ValueError(f"`vary`: {name!r} cannot be relative; a level is a factor by itself.")
    values = distribution.choices if isinstance(distribution, Choice) else ()
    wrong = isinstance(distribution, Choice) and not all(type(value) in (int, float) for value in values)
    if wrong or (kind == "record" and (not values or not all(type(value) is int for value in values))):
        what = "a Choice of integers, places in `motions`" if kind == "record" else "a distribution of numbers"
        raise ValueError(f"`vary`: {name!r} must be {what}, got {distribution}.")
    if kind == "record" and not set(values) <= set(range(len(motions))):
        there = "is one record, 0" if len(motions) == 1 else f"are the records 0 to {len(motions) - 1}"
        raise ValueError(f"`vary`: {name!r}: there {there}, got {list(values)}.")
    column = Column(name=name, kind=kind, type="int64" if kind == "record" else "double")
    return Quantity(name=name, distribution=distribution, columns=(column,))


def _specimens(name: str, pattern: str, distribution: Distribution, system: System) -> Quantity:
    if not isinstance(distribution, Specimens):
        raise ValueError(f"`vary`: {name!r} must be Specimens, got {distribution!r}.")
    mounts = _mounts(name, pattern, system)
    isolators = [system.mounts[mount].written for mount in mounts]
    for mount, isolator in zip(mounts, isolators, strict=True):
        if isolator.spread is None:
            raise ModelError(f"`vary`: {name!r}: isolator {isolator.name!r} of mount {mount!r} has no [spread].")
        for parameter in isolator.spread.parameters:
            axis, _, key = parameter.partition(".")
            if axis not in AXES:
                raise ModelError(
                    f"`vary`: {name!r}: {parameter!r} in the [spread] of {isolator.name!r} is no parameter."
                )
            _parameter(name, isolator, mount, axis, key)
    if not distribution.each and any(isolator != isolators[0] for isolator in isolators):
        raise ValueError(f"`vary`: {name!r}: the mounts have different isolators and cannot share one specimen.")
    groups = [(mount, (mount,)) for mount in mounts] if distribution.each else [(pattern, tuple(mounts))]
    isolators = isolators[: len(groups)]
    columns = tuple(
        Column(
            name=f"mount/{word}/{parameter.replace('.', '/', 1)}", kind="law", targets=targets,
            key=tuple(parameter.split(".", 1)),
        )
        for (word, targets), isolator in zip(groups, isolators, strict=True)
        for parameter in (isolator.spread.parameters if isolator.spread else ())
    )  # fmt: skip
    return Quantity(name=name, distribution=distribution, columns=columns, isolators=tuple(isolators))


def _stops(system: System) -> list[str]:
    return [name for name, mount in system.mounts.items() if mount.isolator.is_stop]


def _mounts(name: str, pattern: str, system: System) -> list[str]:
    return _matching(name, pattern, list(system.mounts), "mount", _stops(system))


def _matching(name: str, pattern: str, existing: Sequence[str], word: str, stops: Sequence[str] = ()) -> list[str]:
    """Return what the parts of a pattern match; a part that matches isolators as well as stops, as * does, means those."""
    patterns = [pattern] if pattern in existing else pattern.split(",")
    found: list[str] = []
    for part in patterns:
        matched = [one for one in existing if fnmatchcase(one, part)]
        if not matched:
            raise ModelError(f"`vary`: {name!r}: there is no {word} {part!r}. There is: {', '.join(existing)}.")
        found += [one for one in matched if one not in stops] or matched
    return list(dict.fromkeys(found))


def _shifted(
    name: str, pattern: str, existing: Sequence[str], word: str, distribution: Distribution, *, kind: str,
    key: tuple[str, ...], stops: Sequence[str] = (),
) -> Quantity:  # fmt: skip
    """Return the quantity of a shift; what stands behind a minus moves the other way: "m01,m04,-m13,-m16"."""
    parts = [pattern] if pattern in existing else pattern.split(",")
    others = ",".join(part[1:] for part in parts if part.startswith("-"))
    every = _matching(name, ",".join(part.removeprefix("-") for part in parts), existing, word, stops)
    mirrored = _matching(name, others, existing, word, stops) if others else []
    both = set(mirrored) & {
        one for part in parts if not part.startswith("-") for one in _matching(name, part, existing, word, stops)
    }
    if both:
        raise ValueError(f"`vary`: {name!r}: {min(both)!r} cannot move both ways.")
    quantity = _split(name, pattern, every, distribution, kind=kind, key=key)
    columns = tuple(
        replace(column, mirrored=tuple(one for one in column.targets if one in mirrored)) for column in quantity.columns
    )
    return replace(quantity, columns=columns)


def _split(
    name: str, pattern: str, targets: Sequence[str], distribution: Distribution, *, kind: str, key: tuple[str, ...],
    type: str = "double",
) -> Quantity:  # fmt: skip
    """Return a quantity with one column, or with one for each target if each has its own."""
    values = distribution.choices if isinstance(distribution, Choice) and type == "double" else ()
    if any(isinstance(value, bool | str) for value in values):
        raise ValueError(f"`vary`: {name!r} must be a distribution of numbers, got {distribution}.")
    start = name.index("/") + 1
    after = name[start + len(pattern) :]
    groups = (
        [(f"{name[:start]}{one}{after}", (one,)) for one in targets] if distribution.each else [(name, tuple(targets))]
    )
    columns = tuple(
        Column(name=column, kind=kind, targets=group, key=key, relative=distribution.relative, type=type)
        for column, group in groups
    )
    return Quantity(name=name, distribution=distribution, columns=columns)


def _check_axis(name: str, axis: str, distribution: Distribution) -> None:
    if axis not in WORLD:
        raise ModelError(f"`vary`: {name!r}: there is no axis {axis!r}; there are {', '.join(WORLD)}.")
    if distribution.relative:
        what = "a position" if name.endswith(f"/centre/{axis}") else "a shift"
        raise ValueError(f"`vary`: {name!r} is {what} [m] and cannot be relative.")
