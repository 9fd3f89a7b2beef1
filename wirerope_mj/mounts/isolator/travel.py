"""Travel: how far a deflection goes in each direction that an isolator is rated for, and its utilisation of the rating."""

from collections.abc import Mapping

import numpy as np
import numpy.typing as npt

from wirerope_mj.foundation.arrays import Array
from wirerope_mj.mounts.laws.law import ROUNDING, Law

# Rated travels in the order of the tables: the mount's axis, and its sign along it; 0 = both.
RATINGS = {"compression": (2, -1.0), "tension": (2, 1.0), "shear": (1, 0.0), "roll": (0, 0.0)}
# Rated travels of each axis below and above zero.
SIDES = {"roll": ("roll", "roll"), "shear": ("shear", "shear"), "axial": ("compression", "tension")}


def travel_in(rating: str, deflection: Array) -> Array:
    """Return how far deflections, (..., 3), go in the direction of a rating [m], (...); 0 where they go the other way."""
    axis, sign = RATINGS[rating]
    along = deflection[..., axis]
    return np.asarray(np.abs(along) if sign == 0.0 else np.maximum(sign * along, 0.0) + 0.0)  # + 0.0: never -0.0


def travel_reached(lowest: Array, highest: Array) -> dict[str, Array]:
    """Return the largest travel by rating [m], (...), between extreme deflections, (..., 3)."""
    low, high = np.minimum(lowest, highest), np.maximum(lowest, highest)
    both_ways = np.maximum(np.abs(low), np.abs(high))
    reached = {-1.0: np.maximum(-low, 0.0) + 0.0, 0.0: both_ways, 1.0: np.maximum(high, 0.0) + 0.0}  # never -0.0
    return {rating: np.asarray(reached[sign][..., axis]) for rating, (axis, sign) in RATINGS.items()}


def travel_utilisation(reached: Mapping[str, npt.ArrayLike], rated: Mapping[str, float]) -> dict[str, float]:
    """Return travel over rated travel by rating; what is not rated is not judged and not in it."""
    return {rating: float(reached[rating]) / rated[rating] for rating in RATINGS if rating in rated}  # type: ignore[arg-type]


def largest_utilisation(reached: Array, rated: Array) -> Array:
    """Return the largest utilisation over the ratings, (...); NaN where nothing is rated.

    Args:
        reached: travel in the order of RATINGS [m], (..., 4).
        rated: rated travel [m], (..., 4); NaN where none is stated.
    """
    return np.asarray(np.fmax.reduce(reached / rated, axis=-1))


def beyond_law(axes: Mapping[str, Law | None], lowest: Array, highest: Array, *, fraction: float = 1.0) -> str:
    """Return a message of the first axis that went beyond a fraction of what its law holds for, "" if none did.

    Args:
        axes: laws by axis.
        lowest: deflections [m], (3,).
        highest: the same.
        fraction: of the deflections up to which a law holds.
    """
    for (axis, law), low, high in zip(axes.items(), lowest, highest, strict=True):
        for sign, reached, end in zip((-1.0, 1.0), (-low, high), law.travel_ends if law else (), strict=False):
            if law is not None and reached > fraction * end + ROUNDING:
                return (
                    f"at {sign * reached:.4g} m on its {axis} axis, whose law holds up to {end:.4g} m, where "
                    f"{law.travel_rule}"
                )
    return ""
