"""What every restoring-force law has in common."""

import math
from abc import ABC, abstractmethod
from collections.abc import Mapping
from dataclasses import asdict, dataclass, fields, replace
from typing import Any, ClassVar, Self

import numpy as np
import numpy.typing as npt

from wirerope_mj.foundation.arrays import Array
from wirerope_mj.mounts.laws.loop import Loop
from wirerope_mj.mounts.laws.path import follow_path
from wirerope_mj.mounts.laws.timed import follow_time

ROUNDING = 1e-9
"""Of deflections [m]: less than that beyond the end of a law is none, positions being metres with 16 digits."""


@dataclass(frozen=True, kw_only=True)
class Law(ABC):
    """Restoring-force law of one isolator axis: force [N] from deflection [m], its rate [m/s] and internal states.

    Subclasses are frozen parameter sets. `name` is the word for the law in an isolator file, `kernel` its number in
    `wirerope_mj.mounts.laws.kernels`. States whose names begin with "z" are forces; their sum is the hysteretic state.
    """

    name: ClassVar[str]
    kernel: ClassVar[int]
    travel_rule: ClassVar[str] = "its force becomes infinite"
    needs_rating: ClassVar[bool] = True
    """Whether a law that ends somewhere asks for a rated travel short of that: its force is nothing to run into."""
    options: ClassVar[Mapping[str, type]] = {}
    """Parameters that are no numbers but choices, and their types."""
    leaders: ClassVar[Mapping[str, str]] = {}
    """The parameter that another one is equal to unless it is stated itself, by the name of that one."""

    def __post_init__(self) -> None:
        open_ones = {field.name for field in fields(self) if field.default is None}
        for key, value in list(vars(self).items()):
            if key in self.options:
                if not isinstance(value, self.options[key]):
                    raise ValueError(f"`{key}` must be a {self.options[key].__name__}, got {value!r}.")
                continue
            if isinstance(value, np.integer | np.floating):
                object.__setattr__(self, key, value.item())
                value = value.item()
            if value is None and key in open_ones:
                continue
            for number in value if isinstance(value, tuple) else (value,):
                if isinstance(number, bool) or not isinstance(number, int | float):
                    raise ValueError(f"`{key}` must be a number, got {number!r}.")
                if not math.isfinite(number):
                    raise ValueError(f"`{key}` must be finite, got {number}.")
        self._validate()

    @abstractmethod
    def _validate(self) -> None:
        """Raise ValueError if the parameters are not those of a passive law."""

    @property
    def rate_independent(self) -> bool:
        """Whether the force depends on the path of deflections alone, and not on how fast it is run through."""
        return True

    @property
    def remembers_slow_paths(self) -> bool:
        """Whether internal states depend on the path of deflections however slowly it is run through."""
        return self.rate_independent

    @property
    def components(self) -> "tuple[Law, ...]":
        """The laws that make it up: itself, or those in parallel."""
        return (self,)

    @abstractmethod
    def kernel_parameters(self) -> Array:
        """Return the parameters in the order that the law's kernel reads, (n_p,)."""

    @property
    @abstractmethod
    def initial_stiffness(self) -> float:
        """Tangent of the force at the unloaded state [N/m]."""

    @property
    @abstractmethod
    def damping_coefficient(self) -> float:
        """Derivative of the force by the deflection rate in the unloaded state [N s/m]; 0 for a rate-independent law."""

    @property
    def closed_stiffness(self) -> float:
        """The same tangent where it counts for the step that is stable [N/m]: behind the gap of a stop."""
        return self.initial_stiffness

    @property
    def closed_damping(self) -> float:
        """Derivative by the deflection rate there [N s/m]."""
        return self.damping_coefficient

    @property
    @abstractmethod
    def force_powers(self) -> Mapping[str, float]:
        """Power of force in the unit of each parameter, 1 for [N/m], -1 for [1/J]; those without force are left out."""

    @property
    def relaxation_rate(self) -> float:
        """Rate at which internal states decay at rest [1/s]; 0 for a rate-independent law."""
        return 0.0

    @property
    def finite_travel(self) -> float:
        """Deflection up to which the law holds [m], for the reason in `travel_rule`; infinite if it holds everywhere."""
        return math.inf

    @property
    def travel_ends(self) -> tuple[float, float]:
        """Deflections below and above zero up to which the law holds [m], both positive; `finite_travel` for most laws."""
        return self.finite_travel, self.finite_travel

    @property
    def largest_force(self) -> float:
        """What a law without an elastic part carries at most [N]; infinite for every other."""
        return math.inf

    @property
    def state_names(self) -> tuple[str, ...]:
        """Names of the internal states."""
        return ()

    @property
    def n_states(self) -> int:
        """Number of internal states."""
        return len(self.state_names)

    def surely_holds(self, columns: Mapping[str, Any]) -> bool:
        """Return whether the law is surely valid, and at any deflection, with each entry of columns of its parameters.

        False says nothing: each entry has to be tried. The law's own rules are asked, with columns in place of numbers; what
        they cannot say of many numbers at once NumPy refuses to take for true or false.

        Args:
            columns: by parameter; arrays (n,), or a tuple of them for a parameter that is several numbers.
        """
        for column in columns.values():
            if not all(np.isfinite(one).all() for one in (column if isinstance(column, tuple) else (column,))):
                return False
        many = object.__new__(type(self))
        for field in fields(self):
            object.__setattr__(many, field.name, columns.get(field.name, getattr(self, field.name)))
        try:
            # Entries that the law has no number for divide by zero, or lie beyond the largest one: they are not infinite.
            with np.errstate(all="ignore"):
                many._validate()
                return bool(np.all(many.finite_travel == math.inf))
        except (ArithmeticError, TypeError, ValueError):
            return False

    def scaled(self, factor: float) -> Self:
        """Return the law whose force is `factor` times this one's along every path from the unloaded state.

        It is the same law in another unit of force: every parameter is multiplied by the factor to its power of force.

        Raises:
            ValueError: `factor` is not a finite number > 0, or takes a parameter out of the law's range.
        """
        if not 0.0 < factor < math.inf:
            raise ValueError(f"`factor` must be finite and > 0, got {factor}.")
        values: dict[str, Any] = {}
        for name, power in self.force_powers.items():
            value, share = getattr(self, name), factor**power
            values[name] = tuple(share * one for one in value) if isinstance(value, tuple) else share * value
        return replace(self, **values)

    def parameter(self, name: str) -> Any:
        """Return a parameter by its name; "stiffness[0]" is the first entry of one that is several numbers."""
        key, _, place = name.partition("[")
        value = getattr(self, key)
        return value[int(place[:-1])] if place else value

    def completed(self, values: Mapping[str, Any]) -> dict[str, Any]:
        """Return new values of parameters, named as in `parameter`, together with all that changes with them.

        Entries stand in their list, and a parameter that is equal to its leader and not given itself follows it.
        """
        whole = {name: value for name, value in values.items() if "[" not in name}
        for name, value in values.items():
            key, bracket, place = name.partition("[")
            if bracket:
                entries = list(whole.get(key, getattr(self, key)))
                entries[int(place[:-1])] = value
                whole[key] = tuple(entries)
        follow = {
            name: whole[leader]
            for name, leader in self.leaders.items()
            if leader in whole and name not in whole and getattr(self, name) == getattr(self, leader)
        }
        return {**whole, **follow}

    def to_dict(self) -> dict[str, Any]:
        """Return the law as it stands in an isolator file."""
        stated = {key: value for key, value in asdict(self).items() if value is not None and value != ()}
        return {
            "law": self.name,
            **{key: list(value) if isinstance(value, tuple) else value for key, value in stated.items()},
        }

    def trace(
        self,
        deflection: npt.ArrayLike,
        *,
        time: npt.ArrayLike | None = None,
        rate: npt.ArrayLike | None = None,
        initial_states: npt.ArrayLike | None = None,
    ) -> Loop:
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

        Raises:
            ValueError: the path is not a finite series, a rate-dependent law has no `time`, or the force leaves the
                finite numbers along the path.
        """
        path = np.asarray(deflection, dtype=np.float64)
        self._check_path(path)
        states = np.zeros(self.n_states) if initial_states is None else np.array(initial_states, dtype=np.float64)
        if states.shape != (self.n_states,) or not np.isfinite(states).all():
            raise ValueError(f"`initial_states` must be {self.n_states} finite numbers, got {initial_states!r}.")
        if self.rate_independent:
            force, history, work = follow_path(self.kernel, self.kernel_parameters(), path, states, self.n_states)
        else:
            instants = _instants(self, path, time)
            rates = _rates(path, instants, rate)
            force, history, work = follow_time(
                self.kernel, self.kernel_parameters(), instants, path, rates, states, self.n_states
            )
        finite = np.isfinite(force) & np.isfinite(work)
        if not finite.all():
            last = max(int(np.argmin(finite)) - 1, 0)
            where = self._last_finite(path[last], path[last + 1], history[last])
            raise ValueError(f"the force of {self} leaves the finite numbers at a deflection of {where:.6g} m.")
        forces = [i for i, name in enumerate(self.state_names) if name.startswith("z")]
        z = history[:, forces].sum(axis=1)
        return Loop(deflection=path, force=force, hysteretic_state=z, work=work, internal_states=history)

    def _last_finite(self, start: float, stop: float, states: Array) -> float:
        """Return how far a rate-independent law leads from `start` towards `stop` with a finite force [m]."""
        if not self.rate_independent:
            return stop
        low, high = 0.0, 1.0
        for _ in range(60):
            middle = 0.5 * (low + high)
            path = np.array([start, start + middle * (stop - start)])
            force, _, work = follow_path(self.kernel, self.kernel_parameters(), path, states.copy(), self.n_states)
            low, high = (middle, high) if np.isfinite([force[1], work[1]]).all() else (low, middle)
        return start + low * (stop - start)

    def _check_path(self, path: Array) -> None:
        """Raise ValueError if a path is not a finite series, or leads to where the law does not hold."""
        if path.ndim != 1 or path.size < 2:
            raise ValueError(f"`deflection` must be a series of at least 2 numbers, got shape {path.shape}.")
        if not np.isfinite(path).all():
            raise ValueError(
                f"`deflection` must be finite, got {path[~np.isfinite(path)][0]} in sample {np.argmin(np.isfinite(path))}."
            )


def _instants(law: Law, path: Array, time: npt.ArrayLike | None) -> Array:
    """Return `time` as an array (n_t,) [s], or raise ValueError if it does not fit the path."""
    if time is None:
        raise ValueError(f"`time` must be given: the force of {law.name} depends on the deflection rate.")
    instants = np.asarray(time, dtype=np.float64)
    if instants.shape != path.shape:
        raise ValueError(f"`time` must have the shape of the deflection, {path.shape}, got {instants.shape}.")
    if not np.isfinite(instants).all() or (np.diff(instants) <= 0.0).any():
        raise ValueError("`time` must be finite and strictly increasing.")
    return instants


def _rates(path: Array, instants: Array, rate: npt.ArrayLike | None) -> Array:
    """Return `rate` as an array (n_t,) [m/s], by differences that are exact for a parabola if it is not given."""
    if rate is None:
        return np.gradient(path, instants, edge_order=2 if path.size > 2 else 1)
    rates = np.asarray(rate, dtype=np.float64)
    if rates.shape != path.shape or not np.isfinite(rates).all():
        raise ValueError(f"`rate` must be finite and of shape {path.shape}, got shape {rates.shape}.")
    return rates


def anywhere(condition: bool | npt.NDArray[np.bool_]) -> bool:
    """Return whether a condition on parameters is met, at any entry if they are columns."""
    return condition if isinstance(condition, bool) else bool(np.any(condition))


def require_not_negative(law: Law, *names: str) -> None:
    """Raise ValueError unless the named parameters of `law` are >= 0."""
    for name in names:
        if anywhere(getattr(law, name) < 0.0):
            raise ValueError(f"`{name}` must be >= 0, got {getattr(law, name)}.")


def require_positive(law: Law, *names: str) -> None:
    """Raise ValueError unless the named parameters of `law` are > 0."""
    for name in names:
        if anywhere(getattr(law, name) <= 0.0):
            raise ValueError(f"`{name}` must be > 0, got {getattr(law, name)}.")
