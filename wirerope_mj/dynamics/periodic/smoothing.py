"""Smooth approximations of a system's laws, so wide as the motion is fast."""

from dataclasses import replace
from typing import Any

import numpy as np
import numpy.typing as npt
from mujoco.batch import Batch

from wirerope_mj.engine.control import layout as at
from wirerope_mj.engine.system import System
from wirerope_mj.engine.system.varied import with_other_laws
from wirerope_mj.mounts.isolator import Isolator
from wirerope_mj.mounts.laws.kernels import PARALLEL, SMOOTHED
from wirerope_mj.mounts.laws.smoothed import with_width


def smoothed(system: System, width: float) -> System:
    """Return the system with every law that can be smoothed over the velocity `width` [m/s].

    Raises:
        ValueError: none of its laws can be smoothed.
    """
    if all(_smoothed(mount.isolator, width) == mount.isolator for mount in system.mounts.values()):
        raise ValueError(
            "`smoothing` has nothing to smooth: no axis of this system has a law with one hysteretic state, or several such."
        )
    return with_other_laws(system, lambda isolator: _smoothed(isolator, width))


def _smoothed(isolator: Isolator, width: float) -> Isolator:
    axes: dict[str, Any] = {
        axis: with_width(law, width)
        for index, (axis, law) in enumerate(isolator.axes.items())
        if law is not None and index not in isolator.coupled_axes
    }
    return replace(isolator, **axes)


def width_indices(system: System) -> npt.NDArray[np.int64]:
    """Return the indices of the widths of a smoothed system's laws in its model's numeric_data."""
    model = system.model
    numbers = model.actuator_dynprm[-1]
    layout, parameters = int(numbers[1]), int(numbers[2])
    first = layout + int(model.numeric_data[layout + at.AXES])
    rows = model.numeric_data[first : first + 3 * at.AXIS_COLUMNS * len(system.mounts)].reshape(-1, at.AXIS_COLUMNS)
    return parameters + widths_of(rows[:, :2], model.numeric_data[parameters:])


def widths_of(laws: npt.NDArray[Any], parameters: npt.NDArray[np.float64]) -> npt.NDArray[np.int64]:
    """Find the widths of smoothed laws, also those in parallel, among the parameters of (number, first parameter) rows."""
    found = []
    for law, first in laws.astype(int).tolist():
        found += [first] if law == SMOOTHED else []
        parts = int(parameters[first]) if law == PARALLEL else 0
        for part in parameters[first + 1 : first + 1 + 3 * parts].reshape(-1, 3).astype(int).tolist():
            found += [first + part[1]] if part[0] == SMOOTHED else []
    return np.array(found, dtype=np.int64)


def set_width(batch: Batch, indices: npt.NDArray[np.int64], width: float) -> None:
    """Give every simulation of a batch laws that are smoothed over `width` [m/s]."""
    batch.expand("numeric_data")[:, indices] = width
