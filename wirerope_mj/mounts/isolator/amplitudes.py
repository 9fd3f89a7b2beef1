"""Axes of an isolator that are worth a cyclic test, and its amplitudes."""

import math
from collections.abc import Sequence

from wirerope_mj.mounts.isolator.device import Isolator
from wirerope_mj.mounts.laws import Law, Stop, Tabulated
from wirerope_mj.mounts.laws.stop import largest_gap

_UNRATED_FRACTION = 0.05  # of the height, where no travel is rated: small enough for every mount
_UNRATED = 0.005  # [m], where not even the height is known


def distinct_axes(isolator: Isolator) -> list[tuple[str, str, Law]]:
    """Return title, axis and law of each axis with a force; roll and shear are one if they are the same in law and rating."""
    present = [(axis, law) for axis, law in isolator.axes.items() if law is not None]
    same = isolator.roll is not None and isolator.roll == isolator.shear
    if same and isolator.rated_travel("roll") == isolator.rated_travel("shear"):
        return [("roll and shear" if axis == "roll" else axis, axis, law) for axis, law in present if axis != "shear"]
    return [(axis, axis, law) for axis, law in present]


def largest_amplitude(isolator: Isolator, axis: str) -> float:
    """Return the amplitude of the largest loop worth drawing [m]: the rated travel, or 5 % of the height, or 5 mm.

    What is not rated goes that much beyond the largest gap of its stops; a table goes to its end. If the law ends before
    that on one side, it is what it has there.
    """
    rated = max((travel for travel in isolator.rated_travel(axis) if travel is not None), default=None)
    height = isolator.geometry.height if isolator.geometry is not None else None
    law, size = isolator.axes[axis], rated or (_UNRATED if height is None else _UNRATED_FRACTION * height)
    if law is None:
        return size
    if rated is None and any(isinstance(one, Tabulated) for one in law.components) and law.finite_travel < math.inf:
        return law.finite_travel
    return min(size if rated else largest_gap(law) + size, law.finite_travel)


def amplitudes_of(isolator: Isolator, axis: str, fractions: Sequence[float]) -> list[float]:
    """Return fractions of the largest amplitude [m]; where an unrated axis has nothing but stops, of what is beyond the gap."""
    law, largest = isolator.axes[axis], largest_amplitude(isolator, axis)
    only_stops = law is not None and all(isinstance(one, Stop) for one in law.components)
    rated = any(travel is not None for travel in isolator.rated_travel(axis))
    start = largest_gap(law) if law is not None and only_stops and not rated else 0.0
    return [start + fraction * (largest - start) for fraction in fractions]
