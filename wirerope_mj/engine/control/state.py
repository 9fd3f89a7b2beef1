"""MuJoCo's integration state as a value, from which statics and simulation start and which they return."""

import mujoco
import numpy as np

from wirerope_mj.foundation.state import State

STATE = mujoco.mjtState.mjSTATE_INTEGRATION


def state_of(model: mujoco.MjModel, data: mujoco.MjData) -> State:
    """Return the integration state of `data`."""
    values = np.empty(mujoco.mj_stateSize(model, STATE))
    mujoco.mj_getState(model, data, values, STATE)
    return State(values=values, time=float(data.time))
