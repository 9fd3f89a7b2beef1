"""A restoring-force law: its parameters, its properties that the rest of the package uses, and its form in a file."""

import math
from abc import ABC
from collections.abc import Callable, Mapping
from dataclasses import asdict, dataclass, fields, replace
from functools import cache
from typing import Annotated, Any, ClassVar, Self

import numpy as np

from wirerope_mj.foundation.arguments import positive
from wirerope_mj.foundation.arrays import Array, ArrayLike, Booleans, Entries
from wirerope_mj.foundation.structure import bounds, bounds_of, check, unit_of
from wirerope_mj.mounts.laws.loop import Loop

# Of deflections [m]: less than that beyond the end of a law is none, positions being metres with 16 digits.
ROUNDING = 1e-9
# Factors on a law: on all its force, on that of friction, on the deflection over which it builds up to the same force.
FACTORS = ("stiffness", "friction", "yield")
# Stiffness [N/m], damping [N s/m] and slip force [N] of what has failed: it carries nothing, and keeps its states' places.
FAINT = 1e-12
# Parameters of springs, each with its unit; that of a linear one may not be negative.
Spring = Annotated[float, bounds("N/m", ge=0.0)]
Stiffness = Annotated[float, bounds("N/m")]
Quadratic = Annotated[float, bounds("N/m^2")]
Cubic = Annotated[float, bounds("N/m^3")]


@dataclass(frozen=True, kw_only=True)
class Normalised:
    """Bouc-Wen's parameters in a form whose shape does not depend on units.

        dw/dx = (1 / x_y) {1 - [sigma sgn(xdot w) + 1 - sigma] |w|^n},   w = z / z_max

    Source: Ikhouane and Rodellar's form of the law; beta of the thesis multiplies the dissipative term.
    """

    z_max: float  #: bound of z, (alpha / (beta + gamma))^(1/n) [N]
    x_y: float  #: yield deflection z_max / alpha [m]
    sigma: float  #: beta / (beta + gamma) [-]; with 1/2 the unloading branch leaves with the slope alpha
    n: float  #: sharpness of the transition [-]

    def __post_init__(self) -> None:
        for name in ("z_max", "x_y", "sigma", "n"):
            positive(name, getattr(self, name))


@dataclass(frozen=True, kw_only=True)
class Law(ABC):
    """Restoring-force law of one isolator axis: force [N] from deflection [m], its rate [m/s] and internal states.

    Subclasses are frozen parameter sets whose fields state unit and bounds. States whose names begin with "z" are forces; their
    sum is the hysteretic state.
    """

    name: ClassVar[str]  # in an isolator file
    kernel: ClassVar[int]  # its number in `wirerope_mj.mounts.laws.registry`
    example: ClassVar[Entries]  # parameters in SI units for a mass of about 20 kg that moves by about 10 mm
    # Whether the force depends on the path of deflections alone, and not on how fast it is run through.
    rate_independent: ClassVar[bool] = True
    # Whether its kernel is one of those that `Smoothed` takes: one state, its rate a slope for each direction times xdot.
    smoothable: ClassVar[bool] = False
    # Derivative of the force by the deflection rate in the unloaded state [N s/m].
    damping_coefficient: ClassVar[float] = 0.0
    relaxation_rate: ClassVar[float] = 0.0  # at which internal states decay at rest [1/s]
    # Parameters of an elastic part without which `z_max`, the bound of the hysteretic force [N], is all that a law bears.
    elastic: ClassVar[tuple[str, ...]] = ()
    # Deflection up to which the law holds [m], for the reason in `travel_rule`; infinite if it holds everywhere.
    finite_travel: ClassVar[float] = math.inf
    travel_rule: ClassVar[str] = "its force becomes infinite"
    # Whether a law that ends somewhere asks for a rated travel short of that: its force is nothing to run into.
    needs_rating: ClassVar[bool] = True
    state_names: ClassVar[tuple[str, ...]] = ()  # of the internal states
    # Stiffnesses [N/m] whose sum is the tangent of the force at the unloaded state.
    tangents: ClassVar[tuple[str, ...]] = ()
    # Parameters of the hysteretic or viscous part of the force alone; none if it is no part that stands by itself.
    damping_parameters: ClassVar[tuple[str, ...]] = ()
    # Power of the deflection over which friction builds up in the unit of each parameter; none of a law without friction.
    yield_powers: ClassVar[Mapping[str, float]] = {}
    leaders: ClassVar[Mapping[str, str]] = {}  # the parameter that another one is equal to unless it is stated itself
    factors: ClassVar[tuple[str, ...]] = ()  # names of factors on all of several laws in parallel
    stops: ClassVar[tuple[Any, ...]] = ()  # the stops among its components
    parameters_before: ClassVar[int] = 0  # kernel parameters before those of its first component
    bracket_stiffness: ClassVar[float] = math.inf  # of what it stands on [N/m]
    normal_form: ClassVar[Normalised | None] = None  # Bouc-Wen's; None of a law without one, or whose z has no bound
    # alpha, beta, gamma, n of the Bouc-Wen equation of its only state, smoothed or not; None of other states
    bouc_wen_parameters: ClassVar[Array | None] = None
    # Whether the slope of a state has no limit as its deflections vanish: Bouc-Wen's n is below 1.
    is_steep: ClassVar[bool] = False
    # Rate over deflection at which a Bouc-Wen state near its bound goes back there, n alpha / z_max [1/m].
    yield_rate: ClassVar[float] = 0.0
    faint_parameters: ClassVar[Mapping[str, float]] = {}  # of a law that has failed, see `faint`
    # What is left of a law that has failed and cannot be made faint itself, by its number of states.
    _faint: "ClassVar[tuple[Law, ...]]" = ()
    # `wirerope_mj.mounts.laws.timed.trace`, which knows the kernels of all laws and so stands above them.
    _trace: ClassVar[Callable[..., Loop]]

    def __post_init__(self) -> None:
        check(self)
        self._validate()

    def _validate(self) -> None:  # noqa: B027
        """Raise ValueError if the parameters, each within its bounds, do not make a passive law."""

    @classmethod
    def units(cls) -> dict[str, str]:
        """Units of the parameters that have one."""
        return {name: unit for name, meta in bounds_of(cls).items() if (unit := unit_of(meta))}

    @property
    def force_powers(self) -> Mapping[str, float]:
        """Power of force in the unit of each parameter, 1 for [N/m], -1 for [1/J]; parameters without force are left out."""
        parts = {name: unit.partition("/") for name, unit in self.units().items()}
        powers = {name: float((above[:1] in "NJ") - (below[:1] == "J")) for name, (above, _, below) in parts.items()}
        return {name: power for name, power in powers.items() if power}

    @property
    def remembers_slow_paths(self) -> bool:
        """True if internal states depend on the path of deflections even when it is followed slowly."""
        return self.rate_independent

    @property
    def components(self) -> "tuple[Law, ...]":
        """Parallel laws of which the law consists; a single law: itself."""
        return (self,)

    @property
    def only_stops(self) -> bool:
        """True if all its components are stops."""
        return len(self.stops) == len(self.components)

    @property
    def behind_bracket(self) -> "Law":
        """The law that stands on a bracket; itself without one."""
        return self

    @property
    def unsmoothed(self) -> "Law":
        """Law before its slopes were blended; itself where they were not."""
        return self

    @property
    def coordinates(self) -> dict[str, float]:
        """Coordinates by which cyclic tests identify the law, see `wirerope_mj.mounts.identification.families`."""
        raise TypeError(f"{self.name} is no law that cyclic tests identify.")

    def kernel_parameters(self) -> Array:
        """Return the parameters in the order of the law's kernel, (n_p,), which for most laws is that of declaration."""
        return np.array([getattr(self, name) for name in _names(type(self))], dtype=np.float64)

    @property
    def initial_stiffness(self) -> float:
        """Tangent of the force at the unloaded state [N/m]."""
        return sum(getattr(self, name) for name in self.tangents)

    @property
    def closed_stiffness(self) -> float:
        """Tangent that limits the stable step [N/m]: the initial tangent, of a stop the tangent behind its gap."""
        return self.initial_stiffness

    @property
    def closed_damping(self) -> float:
        """Derivative of the force by the deflection rate that limits the stable step [N s/m]; of a stop behind its gap."""
        return self.damping_coefficient

    @property
    def largest_force(self) -> float:
        """Largest force at rest of a law without an elastic part [N]; infinite for every other."""
        bound = getattr(self, "z_max", 0.0)
        return float(bound) if self.elastic and not any(getattr(self, name) for name in self.elastic) else math.inf

    @property
    def travel_ends(self) -> tuple[float, float]:
        """Deflections below and above zero up to which the law holds [m], both positive; `finite_travel` for most laws."""
        return self.finite_travel, self.finite_travel

    @property
    def n_states(self) -> int:
        """Number of internal states."""
        return len(self.state_names)

    def faint(self) -> "Law":
        """Return a law with as many states and hardly any force, for a failed mount; of the same class where possible."""
        if self.faint_parameters:
            names = {field.name for field in fields(self)} & self.faint_parameters.keys()
            return replace(self, **{name: self.faint_parameters[name] for name in names})
        return self._faint[self.n_states] if self.n_states < len(self._faint) else self.scaled(FAINT / self.initial_stiffness)

    def same_structure(self, other: "Law | None") -> bool:
        """Tell whether two laws certainly differ in nothing but the values of their parameters."""
        # lists say how many parameters there are, texts and flags what is done with them
        counted = any(isinstance(value, tuple | str | bool) for value in vars(self).values())
        return type(self) is type(other) and (not counted or self == other)

    def unchecked(self, values: Entries) -> Self:
        """Return the law with other parameters, which are known to be valid and not checked."""
        varied = object.__new__(type(self))
        vars(varied).update(vars(self), **self.completed(values))
        return varied

    def certainly_valid(self, columns: Entries) -> bool:
        """Tell whether the law is valid at any deflection for every row of columns, (n,), of its parameters.

        False says nothing: each entry has to be tried. The law's own rules are asked, with columns in place of numbers; what
        they cannot say of many numbers at once NumPy refuses to take for true or false. A parameter that is several numbers
        has a tuple of columns.
        """
        for column in columns.values():
            if not all(np.isfinite(values).all() for values in (column if isinstance(column, tuple) else (column,))):
                return False
        many = object.__new__(type(self))
        for field in fields(self):
            object.__setattr__(many, field.name, columns.get(field.name, getattr(self, field.name)))
        try:
            # Entries that the law has no number for divide by zero, or lie beyond the largest one: they are not infinite.
            with np.errstate(all="ignore"):
                limits = {name: meta for name, meta in bounds_of(type(self)).items() if name in columns}
                if any(meta.gt is not None and anywhere(columns[name] <= meta.gt) for name, meta in limits.items()):
                    return False
                if any(meta.ge is not None and anywhere(columns[name] < meta.ge) for name, meta in limits.items()):
                    return False
                many._validate()
                return bool(np.all(many.finite_travel == math.inf))
        except (ArithmeticError, NameError, TypeError, ValueError):  # a program's law may be annotated as it likes
            return False

    def powers_of(self, name: str) -> Mapping[str, float]:
        """Return the parameters on which a factor of `FACTORS` acts, with its exponent in each."""
        friction = {key: self.force_powers[key] for key in self.damping_parameters}
        return {"stiffness": self.force_powers, "friction": friction, "yield": self.yield_powers}[name]

    def multiplied(self, name: str, factor: float) -> Self:
        """Apply a factor of `FACTORS`; a law without such parameters is unchanged.

        ValueError: `factor` is not a finite number > 0, or takes a parameter out of the law's range.
        """
        positive("factor", factor)
        values: Entries = {}
        for key, power in self.powers_of(name).items():
            value, ratio = getattr(self, key), factor**power
            values[key] = tuple(ratio * number for number in value) if isinstance(value, tuple) else ratio * value
        return replace(self, **values)

    def scaled(self, factor: float) -> Self:
        """Return the law whose force is `factor` times this one's along every path from the unloaded state.

        It is the same law in another unit of force. ValueError as `multiplied`.
        """
        return self.multiplied("stiffness", factor)

    def with_friction(self, factor: float) -> Self:
        """Return the law whose hysteretic part is `factor` times this one's along every path; what is viscous stays."""
        return self.multiplied("friction", factor) if self.rate_independent else self

    def with_damping(self, factor: float) -> Self:
        """Return the law whose hysteretic or viscous part is `factor` times this one's along every path, the rest the same.

        A hysteretic part resists small deflections too: with it the stiffness of a rope at small amplitudes changes.
        ValueError as `multiplied`.
        """
        return self.multiplied("friction", factor)

    def parameter(self, name: str) -> Any:
        """Return a parameter by its name; "stiffness[0]" is the first entry of a vector-valued parameter."""
        key, _, index = name.partition("[")
        value = getattr(self, key)
        return value[int(index[:-1])] if index else value

    def completed(self, values: Entries) -> Entries:
        """Complete new values of parameters, named as in `parameter`, by all that changes with them.

        Entries stand in their list, and a parameter that is equal to its leader and not given itself follows it.
        """
        whole = {name: value for name, value in values.items() if "[" not in name}
        for name, value in values.items():
            key, bracket, index = name.partition("[")
            if bracket:
                entries = list(whole.get(key, getattr(self, key)))
                entries[int(index[:-1])] = value
                whole[key] = tuple(entries)
        followers = [(name, leader) for name, leader in self.leaders.items() if leader in whole and name not in whole]
        follow = {name: whole[leader] for name, leader in followers if getattr(self, name) == getattr(self, leader)}
        return {**whole, **follow}

    def to_dict(self) -> Entries:
        """Return the law as it stands in an isolator file."""
        stated = {key: value for key, value in asdict(self).items() if value is not None and value != ()}
        plain = {key: list(value) if isinstance(value, tuple) else value for key, value in stated.items()}
        return {"law": self.name, **plain}

    def trace(
        self, deflection: ArrayLike, *, time: ArrayLike | None = None, rate: ArrayLike | None = None,
        initial_states: ArrayLike | None = None,
    ) -> Loop:  # fmt: skip
        """Return the loop that the law draws along a path of deflections, entered unloaded.

        Between samples the deflection of a rate-independent law runs monotonely, so that the result depends on the turning
        points alone, neither on time nor on the number of samples; that of a law that depends on the rate is the cubic
        through deflections and rates. States and work follow a closed form or series where there is one, else they are
        integrated to better than 1e-8.

        Args:
            deflection: path [m], (n_t,), at least two finite samples.
            time: strictly increasing instants [s], (n_t,); required by laws whose force depends on the rate.
            rate: deflection rate at the samples [m/s], (n_t,); by second-order differences if it is not given.
            initial_states: internal states at the first sample, (n_states,); zero by default.

        ValueError: the path is not a finite series, a rate-dependent law has no `time`, or the force leaves the finite
        numbers along the path.
        """
        return self._trace(deflection, time=time, rate=rate, initial_states=initial_states)

    def check_path(self, path: Array) -> None:
        """Raise ValueError if a path is not a finite series, or leads to where the law does not hold."""
        if path.ndim != 1 or path.size < 2:
            raise ValueError(f"`deflection` must be a series of at least 2 numbers, got shape {path.shape}.")
        if not np.isfinite(path).all():
            raise ValueError(
                f"`deflection` must be finite, got {path[~np.isfinite(path)][0]} in sample {np.argmin(np.isfinite(path))}."
            )


@cache
def _names(law: type[Law]) -> tuple[str, ...]:
    return tuple(field.name for field in fields(law))


def is_law(value: object) -> bool:
    return isinstance(value, Law)


def anywhere(condition: bool | Booleans) -> bool:
    """Tell whether a condition on parameters is met, at any entry if they are columns."""
    return condition if isinstance(condition, bool) else bool(np.any(condition))
