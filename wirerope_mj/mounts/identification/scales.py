"""Friction on several scales: Bouc-Wen sets in parallel with one spring and one asymmetry.

A rope slips on many scales, and one Bouc-Wen state yields on one. Here each scale has a state of its own,

    F = b^(c x) [z_1 + z_2 + .. + F1(x)]

with its bound, yield deflection and n. They share sigma: where each had one, amplitudes left out were predicted half as well.
Sums of dry sliders (Masing, Iwan) have sigma 1/2 on every scale.
"""

from collections.abc import Mapping
from dataclasses import replace
from itertools import pairwise

from wirerope_mj.mounts.identification.families import FAMILIES, RESOLVED, Coordinate, Family, Scales
from wirerope_mj.mounts.laws import AsymmetricBoucWen, BoucWen, Law, Parallel, SymmetricBoucWen

# Names of the scales, the first with the largest yield deflection, by their number; a law of one scale needs none.
SCALES: Mapping[int, tuple[str, ...]] = {1: (), 2: ("large", "small"), 3: ("large", "middle", "small")}
AUTO = "auto"
KINDS: tuple[type[Law], ...] = (BoucWen, SymmetricBoucWen, AsymmetricBoucWen)  # The laws that can have several scales
# Ratio of neighbouring yield deflections at least: nearer ones are one scale with a broader knee, as no loop can tell.
APART = 3.0
FARTHEST = 1e4  # The same ratio at most: more than from the largest amplitude to what the least one shows
# Least n of a scale: below, its own knee is spread over more than two decades of deflection, which the other scales are for,
# and its slope is lost where no test sees it; n = 0.1 to 0.25 is what one state does that stands for several scales.
LEAST_EXPONENT = 0.5


def require_scales(kind: type[Law], scales: object, *, start: Law | None, beside: Law | None) -> None:
    """Raise ValueError unless a law can have this number of scales, and the other arguments agree with it."""
    if scales != AUTO and (isinstance(scales, bool) or scales not in SCALES):
        raise ValueError(f"`scales` must be 1, 2, 3 or 'auto', got {scales!r}.")
    if scales != 1 and kind not in KINDS:
        known = ", ".join(law.name for law in KINDS)
        raise ValueError(f"`scales` of more than 1 are for the laws {known}, got {getattr(kind, 'name', kind)!r}.")
    if scales != 1 and beside is not None:
        raise ValueError("`scales` of more than 1 and a law `beside` do not go together.")
    if scales == AUTO and start is not None:
        raise ValueError("`start` has a number of scales already; give that in place of `scales='auto'`.")


def scales_family(kind: type[Law], names: tuple[str, ...]) -> Family:
    """Build the family of laws with several scales of friction: `Parallel` sets of one class, the spring in the first.

    The scales are named, the largest first; coordinates end with their names, as "n_small".
    """
    single_scale, pairs = FAMILIES[kind], [(f"x_y_{a}/{b}", b) for a, b in pairwise(names)]

    def coordinates(s: Scales) -> list[Coordinate]:
        single = {c.name: c for c in single_scale.coordinates(s)}
        rows = [replace(single["z_max"], name=f"z_max_{name}") for name in names]
        rows.append(replace(single["x_y"], name=f"x_y_{names[0]}", lower=RESOLVED * s.least))
        rows += [Coordinate(ratio, "-", APART, FARTHEST) for ratio, _ in pairs]
        rows += [replace(single["n"], name=f"n_{name}", lower=LEAST_EXPONENT) for name in names]
        return [*rows, single["sigma"], *(c for c in single_scale.coordinates(s) if c.stiffness)]

    def make(values: dict[str, float]) -> Law:
        """Make the parallel law: the spring in the first scale, yield deflections by their ratios."""
        spring = {name: value for name, value in values.items() if name in _SPRING}
        bare = {name: value if name == "c_ln_b" else 0.0 for name, value in spring.items()}
        x_y = {names[0]: values[f"x_y_{names[0]}"]}
        for (ratio, name), above in zip(pairs, names, strict=False):
            x_y[name] = x_y[above] / values[ratio]
        forms = {name: {"z_max": values[f"z_max_{name}"], "x_y": x_y[name], "n": values[f"n_{name}"]} for name in names}
        springs = [spring if name == names[0] else bare for name in names]
        return Parallel(laws=tuple(
            single_scale.make(forms[name] | {"sigma": values["sigma"]} | elastic)
            for name, elastic in zip(names, springs, strict=True)
        ))  # fmt: skip

    def read(law: Law) -> dict[str, float]:
        """Return the fitted parameters of a parallel law, its scales in the order of their yield deflections."""
        parts = law.components
        if [type(part) for part in parts] != [kind] * len(names):
            raise ValueError(f"`start` must be {len(names)} {kind.name} laws in parallel, got {law!r}.")
        each = [single_scale.read(part) for part in sorted(parts, key=yield_deflection, reverse=True)]
        values = {f"{key}_{name}": part[key] for key in ("z_max", "n") for name, part in zip(names, each, strict=True)}
        values |= {f"x_y_{names[0]}": each[0]["x_y"], "sigma": each[0]["sigma"]}
        values |= {ratio: a["x_y"] / b["x_y"] for (ratio, _), (a, b) in zip(pairs, pairwise(each), strict=True)}
        springs = {key: sum(part[key] for part in each) for key in each[0] if key in _SPRING}
        return values | springs | ({"c_ln_b": each[0]["c_ln_b"]} if "c_ln_b" in springs else {})

    return Family(coordinates=coordinates, make=make, read=read)


_SPRING = ("k", "k1", "k2", "k3", "c_ln_b")


def yield_deflection(law: Law) -> float:
    """Return the yield deflection of the law of one scale [m]."""
    assert law.normal_form is not None
    return law.normal_form.x_y
