"""The state of a system, from which a simulation may start: what statics finds and a response ends with."""

from dataclasses import dataclass

from wirerope_mj.foundation.arrays import Array


@dataclass(frozen=True, kw_only=True)
class State:
    """MuJoCo's integration state of a system (mjSTATE_INTEGRATION), (n,), and its instant [s]."""

    values: Array
    time: float
