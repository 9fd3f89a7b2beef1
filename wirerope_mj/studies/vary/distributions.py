"""Distributions and choices of the quantities of a study, each a function of a number between 0 and 1."""

import math
import sys
from collections.abc import Sequence
from dataclasses import KW_ONLY, dataclass
from typing import Any, ClassVar, get_args

import numpy as np
import scipy

from wirerope_mj.foundation.arguments import finite, integer, positive
from wirerope_mj.foundation.arrays import AnyArray, Array, Entries
from wirerope_mj.foundation.budget import require_memory

# In place of 0 and 1, at which a normal distribution is infinite: Sobol points may be 0, and sums be rounded to 1.
SMALLEST, LARGEST = 2.0**-54, 1.0 - 2.0**-53
# Of a mean, the least deviation whose values double precision tells apart by a hundred steps.
NARROWEST = 1e-14
# Deviations from the mean beyond which nothing of a normal distribution is left that a number could say.
FARTHEST = 37.0


@dataclass(frozen=True)
class Normal:
    """A normal distribution, truncated at `low` and `high` if they are given."""

    mean: float
    deviation: float  #: standard deviation, > 0
    _: KW_ONLY
    relative: bool = False  #: whether its values are factors on what the model says, and not values themselves
    each: bool = False  #: whether every mount or body that the name matches has a sample of its own; else they share one
    #: factor of Sobol's indices that it belongs to, together with all of the same group; None: one of its own
    group: str | None = None
    low: float | None = None  #: bounds of the values; None = unbounded
    high: float | None = None

    def __post_init__(self) -> None:
        _check_group(self.group)
        _keep(self, mean=finite("mean", self.mean), deviation=positive("deviation", self.deviation))
        _keep(self, low=None if self.low is None else finite("low", self.low))
        _keep(self, high=None if self.high is None else finite("high", self.high))
        if self.low is not None and self.high is not None:
            _check_bounds(self.low, self.high)
        if self.deviation < NARROWEST * abs(self.mean):
            raise ValueError(
                f"`deviation` must be at least {NARROWEST:g} of the mean, got {self.deviation:g} and {self.mean:g}: no number "
                "holds values so close together."
            )
        if not math.isfinite(abs(self.mean) + FARTHEST * self.deviation):
            raise ValueError(f"`mean` and `deviation` are not small enough for numbers: {self.mean:g} and {self.deviation:g}.")
        low, high = self._ends
        if low > FARTHEST or high < -FARTHEST:
            raise ValueError(
                f"`low` and `high` must leave something of the distribution: no value lies more than {FARTHEST:g} standard "
                f"deviations from its mean {self.mean:g}."
            )

    @property
    def _ends(self) -> tuple[float, float]:
        """Bounds in standard deviations from the mean."""
        low = -math.inf if self.low is None else (self.low - self.mean) / self.deviation
        return low, math.inf if self.high is None else (self.high - self.mean) / self.deviation

    def values(self, probabilities: Array) -> Array:
        """Return the quantiles at probabilities, (n,)."""
        low, high = self._ends
        sign = 1.0
        if low > 0.0:  # of the upper tail a number near 1 says nothing: its mirror image is the lower one
            low, high, probabilities, sign = -high, -low, 1.0 - probabilities, -1.0
        first, last = scipy.special.ndtr(np.array([low, high]))
        inside = np.clip(first + probabilities * (last - first), SMALLEST * last, LARGEST)
        lowest, highest = -math.inf if self.low is None else self.low, math.inf if self.high is None else self.high
        return np.clip(self.mean + sign * self.deviation * scipy.special.ndtri(inside), lowest, highest)


@dataclass(frozen=True)
class Uniform:
    """Values between two bounds, low < high, all equally likely; relative, each and group are as for `Normal`."""

    low: float
    high: float
    _: KW_ONLY
    relative: bool = False
    each: bool = False
    group: str | None = None
    points: int | None = None  #: equally spaced values from `low` to `high` in a grid, at least 2; of no use otherwise

    def __post_init__(self) -> None:
        _check_group(self.group)
        _keep(self, low=finite("low", self.low), high=finite("high", self.high))
        _check_bounds(self.low, self.high)
        if self.points is not None:
            _keep(self, points=integer("points", self.points, least=2))

    def values(self, probabilities: Array) -> Array:
        """Return the quantiles at probabilities, (n,)."""
        return self.low + probabilities * (self.high - self.low)

    @property
    def listed(self) -> list[float]:
        """The values in a grid; empty if `points` is not given."""
        if self.points is None:
            return []
        require_memory(f"a grid of {self.points} values", 40.0 * self.points, "Give fewer `points`.")  # [B] of an entry
        return np.linspace(self.low, self.high, self.points).tolist()


@dataclass(frozen=True, init=False)
class Choice:
    """Equally likely numbers, booleans or strings, in a grid each of them; other arguments are those of `Normal`."""

    choices: tuple[Any, ...]
    relative: bool
    each: bool
    group: str | None

    def __init__(self, *choices: object, relative: bool = False, each: bool = False, group: str | None = None) -> None:
        if len(choices) == 1 and not isinstance(choices[0], str) and isinstance(choices[0], Sequence):
            choices = tuple(choices[0])
        if not choices:
            raise ValueError("`Choice` must have at least one value, got none.")
        _check_group(group)
        plain = tuple(choice.item() if isinstance(choice, np.generic) else choice for choice in choices)
        _keep(self, choices=plain, relative=relative, each=each, group=group)
        booleans = [isinstance(choice, bool) for choice in plain]
        numbers = [isinstance(choice, int | float) for choice in plain]
        if not (all(booleans) or (all(numbers) and not any(booleans)) or all(isinstance(choice, str) for choice in plain)):
            raise ValueError(f"the values of a `Choice` must all be numbers, booleans or strings, got {list(plain)}.")
        for choice in plain:
            if isinstance(choice, int) and finite("Choice", int(choice)) != choice:
                raise ValueError(
                    f"`Choice`: {choice} is no number that a computer holds exactly; the next is {float(choice):.17g}."
                )

    def values(self, probabilities: Array) -> AnyArray:
        """Return the choices at probabilities, (n,)."""
        indices = np.minimum((probabilities * len(self.choices)).astype(np.int64), len(self.choices) - 1)
        return np.array(self.choices)[indices]

    @property
    def listed(self) -> list[Any]:
        """The values in a grid."""
        return list(self.choices)


@dataclass(frozen=True, kw_only=True)
class Specimens:
    """The scatter of specimens that an isolator's file states: the joint normal distribution of its `spread`."""

    each: bool = True  #: whether every mount has specimens of its own; else those that the name matches share one
    group: str | None = None  #: as for `Normal`
    relative: bool = False

    def __post_init__(self) -> None:
        _check_group(self.group)


@dataclass(frozen=True)
class Isotropic:
    """Elevations of directions that are equally likely over the sphere: not the angle but its sine is uniform.

    With azimuths that are uniform over the circle, no direction is then more likely than another. A uniform elevation would
    crowd them about the vertical.
    """

    relative: ClassVar[bool] = False
    each: ClassVar[bool] = False

    #: low, high: bounds of the elevation [deg], -90 <= low < high <= 90; from 0 up it is the half above the horizon
    low: float = -90.0
    high: float = 90.0
    group: str | None = None  #: as for `Normal`

    def __post_init__(self) -> None:
        _check_group(self.group)
        _keep(self, low=finite("low", self.low), high=finite("high", self.high))
        _check_bounds(self.low, self.high)
        if self.low < -90.0 or self.high > 90.0:
            raise ValueError(f"`low` and `high` must be from -90 to 90 degrees, got {self.low:g} and {self.high:g}.")

    def values(self, probabilities: Array) -> Array:
        """Return the quantiles [deg] at probabilities of 0 to 1, (n,)."""
        first, last = math.sin(math.radians(self.low)), math.sin(math.radians(self.high))
        heights = np.clip(first + probabilities * (last - first), -1.0, 1.0)
        return np.array([math.degrees(math.asin(height)) for height in heights.tolist()])


Distribution = Normal | Uniform | Isotropic | Choice | Specimens


def distribution_to_dict(distribution: Distribution) -> Entries:
    values = {key: list(value) if isinstance(value, tuple) else value for key, value in vars(distribution).items()}
    return {"kind": type(distribution).__name__, **{key: v for key, v in values.items() if v is not None}}


def distribution_from_dict(content: Entries) -> Distribution:
    """Return the distribution that `distribution_to_dict` stored."""
    kinds: dict[str, type] = {kind.__name__: kind for kind in get_args(Distribution)}
    rest = {key: value for key, value in content.items() if key not in ("kind", "choices")}
    return kinds[content["kind"]](*content.get("choices", ()), **rest)


def _keep(distribution: object, **values: object) -> None:
    """Set attributes of a frozen distribution."""
    for name, value in values.items():
        object.__setattr__(distribution, name, value)


def _check_group(group: object) -> None:
    if group is not None and (not isinstance(group, str) or not group):
        raise ValueError(f"`group` must be a string or None, got {group!r}.")


def _check_bounds(low: float, high: float) -> None:
    if not math.isfinite(high - low):
        raise ValueError(f"`low` and `high` must be less than {sys.float_info.max:g} apart, got {low:g} and {high:g}.")
    if not low < high:
        raise ValueError(f"`low` must be less than `high`, got {low:g} and {high:g}: the bounds may be reversed.")
