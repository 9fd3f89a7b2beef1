"""State of a system, from which a simulation may start: a result of statics, and the end of a response."""

import base64
from dataclasses import dataclass
from typing import Any

import numpy as np

from wirerope_mj.foundation.arrays import Array, Entries


@dataclass(frozen=True, kw_only=True)
class State:
    """MuJoCo's integration state of a system (mjSTATE_INTEGRATION), (n,), and its instant [s]."""

    values: Array
    time: float

    def to_plain(self) -> list[object]:
        """Return the state as plain values, bit by bit: the instant, and the numbers as base64 of little-endian float64."""
        return [self.time, base64.b64encode(self.values.astype("<f8").tobytes()).decode()]

    @classmethod
    def from_plain(cls, content: Entries | list[Any]) -> "State":
        """Return the state that `to_plain` wrote, or an earlier version as a table of `time` and `values`."""
        if isinstance(content, dict):
            return cls(values=np.array(content["values"], dtype=np.float64), time=float(content["time"]))
        values = np.frombuffer(base64.b64decode(content[1]), dtype="<f8").astype(np.float64)
        return cls(values=values, time=float(content[0]))
