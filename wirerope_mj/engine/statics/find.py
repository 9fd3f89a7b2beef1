"""Equilibrium of a system under gravity, by a static solve along the loading path."""

import warnings
from weakref import WeakKeyDictionary

from wirerope_mj.engine.statics.loading import Loading
from wirerope_mj.engine.statics.result import HISTORIES, Equilibrium, History
from wirerope_mj.engine.statics.side_by_side import found_in_lanes
from wirerope_mj.engine.system import System
from wirerope_mj.foundation.arguments import one_of
from wirerope_mj.foundation.errors import ModelWarning

_known: WeakKeyDictionary[System, dict[str, Equilibrium]] = WeakKeyDictionary()


def equilibrium(system: System, *, history: History = "virgin") -> Equilibrium:
    """Return the equilibrium of `system` under its gravity, base at rest; computed once per system and history.

    Gravity grows from 0 in steps. In each, Newton's method makes MuJoCo's own accelerations vanish, contacts and joint springs
    included; the hysteretic states of a trial position are integrated along the law from the last step's, so that they lie
    exactly on the loading path. Where the kernel's equations hold its accelerations serve the search, and MuJoCo's own confirm
    what it found.

    Warns:
        ModelWarning: no mount, joint or stop resists a motion of a body; `free` says which.

    Raises:
        ConvergenceError: there is no equilibrium, or it was not found; names the mount that cannot carry its load.
    """
    one_of("history", history, HISTORIES)
    known = _known.setdefault(system, {})
    if history not in known:
        with system.assembly.scratch.data(system.model) as data:
            known[history] = found_in_lanes(system, history, data) or Loading(system, history, data).solve()
    for message in known[history].free:
        warnings.warn(message, ModelWarning, stacklevel=2)
    return known[history]
