"""Coordinates, the parameters by which laws are searched for, and the laws that cyclic tests determine.

A Bouc-Wen law is searched for by its normalised form (z_max, x_y, sigma, n), whose numbers are less correlated than alpha, beta
and gamma; b and c of Ni's law by their product, the only one that acts; Jenkin elements by their stiffnesses and the
deflections at which they slip, each further than the last.
"""

import math
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, field, replace
from operator import attrgetter

import numpy as np

from wirerope_mj.foundation.arguments import integer
from wirerope_mj.mounts.laws import (
    AsymmetricBoucWen,
    BoucWen,
    EnhancedDryFriction,
    Hysteresis,
    Law,
    Masing,
    Ozdemir,
    Parallel,
    Stop,
    SymmetricBoucWen,
    VaianaRosati,
)


@dataclass(frozen=True, kw_only=True)
class Scales:
    """Sizes of the measured loops, from which bounds and starts of a search follow."""

    deflection: float  # the largest amplitude [m]
    least: float  # the least amplitude [m]
    force: float  # half the largest force range [N]
    # deflections into the lower and upper side of a stop [m]; 0 where it stays open
    below: float = 0.0
    above: float = 0.0


# Fraction of the least amplitude below which a slip deflection is not resolved: of a sine's 200 samples nine behind a turning
# point still show the stiffness before it, fewer show a jump of the force alone.
RESOLVED = 0.02


@dataclass(frozen=True)
class Coordinate:
    """One fitted parameter, an unknown of the search: its bounds, its scale, and the values at which a search begins."""

    name: str  # as tables print it
    unit: str
    # bounds of its value; a coordinate with a lower bound > 0 is searched for by its logarithm
    lower: float
    upper: float
    scale: float = 1.0  # size of its value, for one that may be zero
    linear: bool = False  # whether the force is proportional to it, all others given
    stiffness: bool = False  # whether it belongs to the elastic part, which the first of the thesis' three stages fits
    grid: Sequence[float] = ()  # values at which a search begins, of one that is not linear

    @property
    def logarithmic(self) -> bool:
        return self.lower > 0.0

    def inside(self, value: float) -> float:
        """Clip a value to its bounds; return the number that the search varies, its logarithm or the value over its scale."""
        value = min(max(value, self.lower), self.upper)
        return math.log(value) if self.logarithmic else value / self.scale

    def value(self, number: float) -> float:
        return math.exp(number) if self.logarithmic else number * self.scale

    def slope(self, number: float) -> float:
        """Return the derivative of the value by the number that the search varies."""
        return math.exp(number) if self.logarithmic else self.scale


@dataclass(frozen=True, kw_only=True)
class Family:
    """Parameters by which the laws of one class are fitted, and how a law is made of their values."""

    coordinates: Callable[[Scales], list[Coordinate]]  # the numbers, from the sizes of the measured loops
    make: Callable[[dict[str, float]], Law]  # the law of their values
    # the values of a law
    read: Callable[[Law], dict[str, float]] = attrgetter("coordinates")
    # fixed values of coordinates that are not named as free and of which the start has no other value
    usual: Mapping[str, float] = field(default_factory=dict)


ELASTIC = 1e-6  # Loss below which a stop is elastic: no test shows it, and the state of a lossy one costs time


def least_exponent(s: Scales) -> float:
    """Return the smallest exponent n that samples resolve: the slope at z = 0 halves at 2 % of the least amplitude.

    It halves at x_y (1/2)^(1/n), which with x_y at the largest amplitude is `RESOLVED` of the smallest one.
    """
    return max(0.1, math.log(2.0) / math.log(s.deflection / (RESOLVED * s.least)))


def _slip_starts(s: Scales) -> list[float]:
    return np.geomspace(0.1 * s.least, s.deflection, 8).tolist()


def _hysteresis(s: Scales, *, sigma: bool = True) -> list[Coordinate]:
    """List the fitted parameters of a Bouc-Wen force in its normalised form: z_max, x_y, sigma and n."""
    # A yield deflection far above the amplitudes is elastic, far below them plain friction.
    rows = [
        Coordinate("z_max", "N", 1e-4 * s.force, 1e3 * s.force, linear=True),
        Coordinate("x_y", "m", 1e-4 * s.deflection, 1e3 * s.deflection, grid=_slip_starts(s)),
        Coordinate("sigma", "-", 1e-3, 1e3, grid=(0.3, 0.6, 1.0, 1.5)),
        # The two with closed forms: the grid takes a tenth of the time.
        Coordinate("n", "-", least_exponent(s), 20.0, grid=(1.0, 2.0)),
    ]
    return rows if sigma else [row for row in rows if row.name != "sigma"]


def _elastic(s: Scales, *names: str) -> list[Coordinate]:
    """List polynomial stiffnesses as fitted parameters; the linear stiffness, that of a spring, cannot be negative."""
    rows = []
    for power, name in enumerate(names, start=1):
        size = s.force / s.deflection**power
        unit, lower = ("N/m", 0.0) if power == 1 else (f"N/m^{power}", -1e3 * size)
        rows.append(Coordinate(name, unit, lower, 1e3 * size, scale=size, linear=True, stiffness=True))
    return rows


def _of_springs(kind: type[Hysteresis], *names: str, sigma: bool = True) -> Family:
    """Make the family of a Bouc-Wen class of laws with the polynomial stiffnesses `names`."""
    return Family(
        coordinates=lambda s: [*_hysteresis(s, sigma=sigma), *_elastic(s, *names)],
        make=lambda values: kind.from_normalised(**values),
    )


def _vaiana_rosati(s: Scales) -> list[Coordinate]:
    """List the fitted parameters of the law of Vaiana and Rosati."""
    f, x = s.force, s.deflection
    return [
        *_elastic(s, "kb"),
        Coordinate("f0", "N", 1e-4 * f, 1e3 * f, linear=True),
        Coordinate("alpha", "1/m", 1e-3 / x, 1e4 / x, grid=[1.0 / slip for slip in _slip_starts(s)]),
        Coordinate("b1", "N", -1e3 * f, 1e3 * f, scale=f, linear=True, stiffness=True),
        Coordinate(
            "b2", "1/m", -20.0 / x, 20.0 / x, scale=1.0 / x, stiffness=True, grid=[b / x for b in (-8.0, -3.0, 3.0, 8.0)]
        ),
        Coordinate("g1", "N", -1e3 * f, 1e3 * f, scale=f, linear=True, stiffness=True),
        Coordinate("g2", "1/m", 1e-2 / x, 1e2 / x, stiffness=True, grid=(2.0 / x, 6.0 / x, 20.0 / x)),
        Coordinate("g3", "m", -2.0 * x, 2.0 * x, scale=x, stiffness=True, grid=(-0.4 * x, 0.0, 0.4 * x)),
    ]


def _stop(s: Scales) -> list[Coordinate]:
    """List the fitted parameters of a stop, with a gap for each side that closes."""
    x, f = s.deflection, s.force
    reaches = {"gap_below": s.below, "gap_above": s.above}
    closed = {name: end for name, end in reaches.items() if end > 0.0}
    tried = (0.0, 0.2, 0.4, 0.6, 0.75, 0.88, 0.96)  # loops may close by little
    gaps = [
        Coordinate(name, "m", 0.0, end, scale=x, stiffness=True, grid=[end * part for part in tried])
        for name, end in closed.items()
    ]
    # The depth may be a hundredth of the amplitude, and k is the force over its power.
    return [
        *gaps, Coordinate("k", "N/m^exponent", 1e-4 * f / x, f / (0.01 * x) ** 3, linear=True, stiffness=True),
        Coordinate("exponent", "-", 1.0, 3.0, stiffness=True, grid=(1.0, 2.0)),
        Coordinate("rounding", "m", 0.0, 2.0 * x, scale=x, stiffness=True, grid=(0.0, 0.3 * x)),
        Coordinate("loss", "-", 0.0, 1.0, grid=(0.1, 0.5)),
        Coordinate("reversal", "m", 1e-4 * x, 10.0 * x, grid=(0.03 * x, 0.2 * x)),
    ]  # fmt: skip


# Stops with a gap on the sides that close; viscous loss does not show in quasi-static tests.
STOP = Family(
    coordinates=_stop, usual={"exponent": 1.0, "rounding": 0.0},
    make=lambda v: Stop(**{name: v[name] for name in v if v["loss"] >= ELASTIC or name not in ("loss", "reversal")}),  # type: ignore[arg-type]
)  # fmt: skip


def beside_known(family: Family, known: Law | None) -> Family:
    """Return the family of laws, with the same fitted parameters, that act in parallel with a known law."""
    if known is None:
        return family
    return replace(family, make=lambda values: Parallel(laws=(*known.components, *family.make(values).components)))


def masing_family(elements: int) -> Family:
    """Make the family of Masing laws with a number of Jenkin elements."""
    integer("elements", elements, least=1)

    def coordinates(s: Scales) -> list[Coordinate]:
        size = s.force / s.deflection
        rows = [*_elastic(s, "k", "k2", "k3")]
        rows += [Coordinate(f"c{e}", "N/m", 1e-5 * size, 1e4 * size, linear=True) for e in range(1, elements + 1)]
        rows.append(Coordinate("x1", "m", RESOLVED * s.least, 10.0 * s.deflection, grid=(0.15 * s.least, 0.5 * s.least)))
        # They slip one after the other up to the largest amplitude.
        return rows + [Coordinate(f"x{e}/x{e - 1}", "-", 1.01, 1e4, grid=(2.0, 3.5)) for e in range(2, elements + 1)]

    def make(values: dict[str, float]) -> Law:
        stiffness = [values[f"c{e}"] for e in range(1, elements + 1)]
        slip = np.cumprod([values["x1"], *(values[f"x{e}/x{e - 1}"] for e in range(2, elements + 1))])
        spring = {name: values[name] for name in ("k", "k2", "k3")}
        return Masing(stiffness=stiffness, slip_force=[c * x for c, x in zip(stiffness, slip, strict=True)], **spring)

    return Family(coordinates=coordinates, make=make, usual={"k2": 0.0, "k3": 0.0})


# The laws that cyclic tests can fix: rate-independent, without wear.
FAMILIES: dict[type[Law], Family] = {
    BoucWen: _of_springs(BoucWen, "k"),
    Ozdemir: _of_springs(Ozdemir, "k", sigma=False),
    SymmetricBoucWen: _of_springs(SymmetricBoucWen, "k1", "k2", "k3"),
    AsymmetricBoucWen: Family(
        coordinates=lambda s: [
            *_hysteresis(s),
            *_elastic(s, "k1", "k2", "k3"),
            # exp(10) between the ends of the travel is beyond any isolator
            Coordinate(
                "c_ln_b",
                "1/m",
                -5.0 / s.deflection,
                5.0 / s.deflection,
                scale=1.0 / s.deflection,
                stiffness=True,
                grid=(-1.0 / s.deflection, 0.0, 1.0 / s.deflection),
            ),
        ],  # fmt: skip
        make=lambda values: AsymmetricBoucWen.from_normalised(
            **{key: value for key, value in values.items() if key != "c_ln_b"}, b=math.e, c=values["c_ln_b"]
        ),
    ),
    EnhancedDryFriction: Family(
        coordinates=lambda s: [
            Coordinate("d", "N", 1e-4 * s.force, 1e3 * s.force, linear=True),
            Coordinate("u_c", "m", 1e-4 * s.deflection, 1e3 * s.deflection, grid=_slip_starts(s)),
            *_elastic(s, "k"),
        ],
        make=lambda values: EnhancedDryFriction(**values),
    ),
    VaianaRosati: Family(coordinates=_vaiana_rosati, make=lambda values: VaianaRosati(**values)),
}


def family_of(law: type[Law], elements: int = 5) -> Family:
    """Find the fitted parameters of a class of laws; ValueError if cyclic tests cannot fix them."""
    require_law(law)
    if law is Stop:
        return STOP
    if law is Masing:
        return masing_family(elements)
    if law not in FAMILIES:
        kinds: list[type[Law]] = [*FAMILIES, Masing, Stop]
        known = ", ".join(sorted(kind.name for kind in kinds))
        raise ValueError(f"`law` must be one that cyclic tests can fix ({known}), got {getattr(law, 'name', law)!r}.")
    return FAMILIES[law]


def require_law(law: object, name: str = "law") -> None:
    if not (isinstance(law, type) and issubclass(law, Law)):
        raise ValueError(f"`{name}` must be a class of laws such as BoucWen, got {law!r}.")
