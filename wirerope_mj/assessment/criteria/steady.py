"""When a base vibrates at random and steadily."""

import math
from collections.abc import Iterator, Mapping
from typing import Any

from wirerope_mj.motions import RandomVibration, motion_from_dict

# Kinds of motions that go on steadily.
STEADY = frozenset({"sweep", "sine", "vibration-lines", "harmonic-force", "unbalance"})


def steady_interval(motion: Mapping[str, Any]) -> tuple[bool, float, float]:
    """Return whether a motion is random vibration alone, and the instants [s] between which all of that is stationary.

    Without any random vibration these are minus and plus infinity. Files of records are not read.

    Args:
        motion: as plain values, as a response holds it.
    """
    parts = list(elements(motion))
    intervals = [_steady(part) for part in parts if part.get("kind") == RandomVibration.kind]
    first = max((interval[0] for interval in intervals), default=-math.inf)
    last = min((interval[1] for interval in intervals), default=math.inf)
    return bool(parts) and len(intervals) == len(parts), first, last


def _steady(stored: Mapping[str, Any]) -> tuple[float, float]:
    motion = motion_from_dict(stored)
    assert isinstance(motion, RandomVibration)
    return motion.steady


def elements(stored: Mapping[str, Any]) -> Iterator[Mapping[str, Any]]:
    """Yield the elementary motions of which one is made by adding, scaling and turning."""
    inner = [*stored.get("terms", ()), *([stored["motion"]] if "motion" in stored else ())]
    if not inner:
        yield stored
    for part in inner:
        yield from elements(part)
