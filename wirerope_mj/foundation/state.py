"""The state of a system, from which a simulation may start: what statics finds and a response ends with."""

from dataclasses import dataclass

import numpy as np
import numpy.typing as npt


@dataclass(frozen=True, kw_only=True)
class State:
    """MuJoCo's integration state of a system (mjSTATE_INTEGRATION), (n,), and its instant [s]."""

    values: npt.NDArray[np.float64]
    time: float
