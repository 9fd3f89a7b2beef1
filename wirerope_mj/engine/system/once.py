"""Values that depend on a system alone, computed once for each."""

from collections.abc import Callable
from functools import wraps
from typing import TypeVar
from weakref import WeakKeyDictionary

from wirerope_mj.engine.system.system import System

Value = TypeVar("Value")


def once_per_system(compute: Callable[[System], Value]) -> Callable[[System], Value]:
    """Return `compute` with a memory that forgets a value together with its system; callers share it and leave it as it is."""
    known: WeakKeyDictionary[System, Value] = WeakKeyDictionary()

    @wraps(compute)
    def value_of(system: System) -> Value:
        try:
            return known[system]
        except KeyError:
            return known.setdefault(system, compute(system))

    return value_of
