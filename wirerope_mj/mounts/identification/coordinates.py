"""In which numbers a law is searched for: normalised, named, bounded, positive ones by their logarithm.

A Bouc-Wen law is searched for by its normalised form (z_max, x_y, sigma, n), whose numbers do not hang on each other as alpha,
beta and gamma do; b and c of Ni's law by their product, the only one that acts; Jenkin elements by their stiffnesses and the
deflections at which they slip, each further than the last.
"""

import math
from collections.abc import Callable, Mapping
from dataclasses import dataclass, field

import numpy as np

from wirerope_mj.mounts.laws import (
    AsymmetricBoucWen,
    BoucWen,
    EnhancedDryFriction,
    Law,
    Masing,
    Ozdemir,
    SymmetricBoucWen,
    VaianaRosati,
)


@dataclass(frozen=True, kw_only=True)
class Scales:
    """Sizes of what was measured.

    Attributes:
        deflection, least: the largest and the least amplitude [m].
        force: half the largest force range [N].
        below, above: how far a stop's sides that close were deflected [m]; 0 of one that does not.
    """

    deflection: float
    least: float
    force: float
    below: float = 0.0
    above: float = 0.0


SEEN = 0.02
"""Share of the least amplitude below which a deflection of slip is not seen: of a sine's 200 samples nine behind a turning
point still show the stiffness before it, fewer show a jump of the force alone."""


@dataclass(frozen=True, kw_only=True)
class Coordinate:
    """One number that is searched for.

    Attributes:
        name: what it is called.
        unit: of its value.
        lower, upper: bounds of its value; a coordinate with a lower bound > 0 is searched for by its logarithm.
        scale: size of its value, for one that may be zero.
        linear: whether the force is proportional to it, all others given.
        stiffness: whether it belongs to the elastic part, which the first of the thesis' three stages fits.
    """

    name: str
    unit: str
    lower: float
    upper: float
    scale: float = 1.0
    linear: bool = False
    stiffness: bool = False

    @property
    def logarithmic(self) -> bool:
        """Whether it is searched for by its logarithm."""
        return self.lower > 0.0

    def inside(self, value: float) -> float:
        """Return the number that stands for a value, within the bounds."""
        value = min(max(value, self.lower), self.upper)
        return math.log(value) if self.logarithmic else value / self.scale

    def value(self, number: float) -> float:
        """Return the value that a number stands for."""
        return math.exp(number) if self.logarithmic else number * self.scale

    def slope(self, number: float) -> float:
        """Return the derivative of the value by the number."""
        return math.exp(number) if self.logarithmic else self.scale


@dataclass(frozen=True, kw_only=True)
class Family:
    """How laws of one class are searched for.

    Attributes:
        coordinates: the numbers, from the sizes of what was measured.
        make: the law of their values.
        read: the values of a law.
        usual: values of coordinates that are given unless they are asked for.
    """

    coordinates: Callable[[Scales], list[Coordinate]]
    make: Callable[[dict[str, float]], Law]
    read: Callable[[Law], dict[str, float]]
    usual: Mapping[str, float] = field(default_factory=dict)


def least_exponent(s: Scales) -> float:
    """Return the n below which samples cannot show what it does: then half of the slope at z = 0 is lost before they see it.

    That is at x_y (1/2)^(1/n). A law that yields at the largest amplitude loses it there within what is seen of the least one.
    """
    return max(0.1, math.log(2.0) / math.log(s.deflection / (SEEN * s.least)))


def _hysteresis(s: Scales, *, sigma: bool = True) -> list[Coordinate]:
    # A yield deflection far above the amplitudes is elastic, far below them plain friction.
    rows = [
        Coordinate(name="z_max", unit="N", lower=1e-4 * s.force, upper=1e3 * s.force, linear=True),
        Coordinate(name="x_y", unit="m", lower=1e-4 * s.deflection, upper=1e3 * s.deflection),
        Coordinate(name="sigma", unit="-", lower=1e-3, upper=1e3),
        Coordinate(name="n", unit="-", lower=least_exponent(s), upper=20.0),
    ]
    return rows if sigma else [row for row in rows if row.name != "sigma"]


def _elastic(s: Scales, *names: str) -> list[Coordinate]:
    """Return polynomial stiffnesses; the linear one is that of a spring, which cannot be negative."""
    rows = []
    for power, name in enumerate(names, start=1):
        size = s.force / s.deflection**power
        rows.append(
            Coordinate(
                name=name,
                unit="N/m" if power == 1 else f"N/m^{power}",
                lower=0.0 if power == 1 else -1e3 * size,
                upper=1e3 * size,
                scale=size,
                linear=True,
                stiffness=True,
            )  # fmt: skip
        )
    return rows


def _asymmetry(s: Scales) -> Coordinate:
    # exp(10) between the ends of the travel is beyond any isolator.
    return Coordinate(
        name="c_ln_b",
        unit="1/m",
        lower=-5.0 / s.deflection,
        upper=5.0 / s.deflection,
        scale=1.0 / s.deflection,
        stiffness=True,
    )


def _read_normalised(law: Law) -> dict[str, float]:
    assert isinstance(law, BoucWen | Ozdemir | SymmetricBoucWen)
    form = law.normalised
    values = {"z_max": form.z_max, "x_y": form.x_y, "sigma": form.sigma, "n": form.n}
    if isinstance(law, BoucWen | Ozdemir):
        values["k"] = law.k
    else:
        values |= {"k1": law.k1, "k2": law.k2, "k3": law.k3}
    if isinstance(law, AsymmetricBoucWen):
        values["c_ln_b"] = law.asymmetry
    if isinstance(law, Ozdemir):
        del values["sigma"]
    return values


def _make_asymmetric(values: dict[str, float]) -> Law:
    rest = {key: value for key, value in values.items() if key != "c_ln_b"}
    return AsymmetricBoucWen.from_normalised(**rest, b=math.e, c=values["c_ln_b"])


def _vaiana_rosati(s: Scales) -> list[Coordinate]:
    f, x = s.force, s.deflection
    return [
        *_elastic(s, "kb"),
        Coordinate(name="f0", unit="N", lower=1e-4 * f, upper=1e3 * f, linear=True),
        Coordinate(name="alpha", unit="1/m", lower=1e-3 / x, upper=1e4 / x),
        Coordinate(name="b1", unit="N", lower=-1e3 * f, upper=1e3 * f, scale=f, linear=True, stiffness=True),
        Coordinate(name="b2", unit="1/m", lower=-20.0 / x, upper=20.0 / x, scale=1.0 / x, stiffness=True),
        Coordinate(name="g1", unit="N", lower=-1e3 * f, upper=1e3 * f, scale=f, linear=True, stiffness=True),
        Coordinate(name="g2", unit="1/m", lower=1e-2 / x, upper=1e2 / x, stiffness=True),
        Coordinate(name="g3", unit="m", lower=-2.0 * x, upper=2.0 * x, scale=x, stiffness=True),
    ]


def masing_family(elements: int) -> Family:
    """Return how Masing laws with a number of Jenkin elements are searched for."""

    def coordinates(s: Scales) -> list[Coordinate]:
        size = s.force / s.deflection
        rows = [*_elastic(s, "k")]
        for e in range(1, elements + 1):
            rows.append(Coordinate(name=f"c{e}", unit="N/m", lower=1e-5 * size, upper=1e4 * size, linear=True))
        rows.append(Coordinate(name="x1", unit="m", lower=SEEN * s.least, upper=10.0 * s.deflection))
        for e in range(2, elements + 1):
            rows.append(Coordinate(name=f"x{e}/x{e - 1}", unit="-", lower=1.01, upper=1e4))
        return rows

    def make(values: dict[str, float]) -> Law:
        stiffness = [values[f"c{e}"] for e in range(1, elements + 1)]
        slip = np.cumprod([values["x1"], *(values[f"x{e}/x{e - 1}"] for e in range(2, elements + 1))])
        return Masing(
            stiffness=stiffness, slip_force=[c * x for c, x in zip(stiffness, slip, strict=True)], k=values["k"]
        )

    def read(law: Law) -> dict[str, float]:
        assert isinstance(law, Masing)
        pairs = sorted(zip(law.stiffness, law.slip_force, strict=True), key=lambda pair: pair[1] / pair[0])
        slip = [h / c for c, h in pairs]
        values = {"k": law.k} | {f"c{e}": c for e, (c, _) in enumerate(pairs, start=1)} | {"x1": slip[0]}
        return values | {f"x{e + 1}/x{e}": slip[e] / slip[e - 1] for e in range(1, len(slip))}

    return Family(coordinates=coordinates, make=make, read=read)


FAMILIES: dict[type[Law], Family] = {
    BoucWen: Family(
        coordinates=lambda s: [*_hysteresis(s), *_elastic(s, "k")],
        make=lambda values: BoucWen.from_normalised(**values),
        read=_read_normalised,
    ),
    Ozdemir: Family(
        coordinates=lambda s: [*_hysteresis(s, sigma=False), *_elastic(s, "k")],
        make=lambda values: Ozdemir.from_normalised(**values),
        read=_read_normalised,
    ),
    SymmetricBoucWen: Family(
        coordinates=lambda s: [*_hysteresis(s), *_elastic(s, "k1", "k2", "k3")],
        make=lambda values: SymmetricBoucWen.from_normalised(**values),
        read=_read_normalised,
    ),
    AsymmetricBoucWen: Family(
        coordinates=lambda s: [*_hysteresis(s), *_elastic(s, "k1", "k2", "k3"), _asymmetry(s)],
        make=_make_asymmetric,
        read=_read_normalised,
    ),
    EnhancedDryFriction: Family(
        coordinates=lambda s: [
            Coordinate(name="d", unit="N", lower=1e-4 * s.force, upper=1e3 * s.force, linear=True),
            Coordinate(name="u_c", unit="m", lower=1e-4 * s.deflection, upper=1e3 * s.deflection),
            *_elastic(s, "k"),
        ],
        make=lambda values: EnhancedDryFriction(**values),
        read=lambda law: {key: getattr(law, key) for key in ("d", "u_c", "k")},
    ),
    VaianaRosati: Family(
        coordinates=_vaiana_rosati,
        make=lambda values: VaianaRosati(**values),
        read=lambda law: {key: getattr(law, key) for key in ("kb", "f0", "alpha", "b1", "b2", "g1", "g2", "g3")},
    ),
}
"""The laws that cyclic tests can fix: rate-independent, without wear."""
