"""What a sweep answers: the envelopes of accelerations and deflections over frequency."""

from collections.abc import Mapping
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any

import numpy as np
import numpy.typing as npt

from wirerope_mj.foundation.arrays import Array
from wirerope_mj.foundation.directions import direction_text
from wirerope_mj.foundation.state import State
from wirerope_mj.foundation.summary import Summarised, quantity, span
from wirerope_mj.motions import Sweep, motion_from_dict

AXES = ("x", "y", "z")


@dataclass(frozen=True, kw_only=True)
class Envelope:
    """Largest acceleration of a body's centre of mass over frequency.

    Attributes:
        acceleration: largest absolute acceleration along x, y and z [m/s^2], (n, 3).
        transmissibility: that over the base's amplitude in the same cycle, (n, 3).
    """

    acceleration: Array
    transmissibility: Array


@dataclass(frozen=True, kw_only=True)
class MountEnvelope:
    """Extreme deflections of a mount over frequency, along roll, shear and axial [m], (n, 3); static sag included."""

    minimum: Array
    maximum: Array


@dataclass(frozen=True, kw_only=True, repr=False)
class FrequencySweep(Summarised):
    """Envelopes over frequency of a system shaken by a sweep, cycle by cycle, or by one steady sine after another.

    Attributes:
        frequency: of the excitation [Hz], (n,): in the middle of every cycle of a sweep, or of every steady sine.
        base_amplitude: largest absolute acceleration of the base along the excitation's direction [m/s^2], (n,).
        payload: the body that `amplitude` and `transmissibility` belong to.
        response_direction: the axis along which they are taken, "x", "y" or "z".
        envelopes: of every body that moves relative to the base, by name, payloads first.
        mounts: of every mount, by name.
        cycles: cycles of the excitation behind every frequency, (n,); 1 each for a sweep.
        remaining: estimated distance of the amplitudes from their limits in a steady sine, relative to them, (n,); NaN for a
            sweep, which does not wait.
        settled: whether they were as near as was asked for, (n,); False for a sweep.
        excitation: the excitation as plain values.
        timestep: largest step [s].
        estimated_error: of samples and peaks, estimated before the run relative to the peaks; NaN where the step was given.
        model_steps: steps of all that was simulated for the result, a lead-in included, the pilots that chose the step not.
        initial_state: state in which the first cycle began, after the lead-in of a sweep; `simulate` gives the whole history
            from it: `simulate(system, r.sweep, duration=r.final_state.time, initial=r.initial_state, out=folder)`.
        final_state: state at the end of the last cycle, from which another sweep may go on.
        warnings: rated travels that were exceeded, and what did not settle, one sentence each.
    """

    frequency: Array
    base_amplitude: Array
    payload: str
    response_direction: str
    envelopes: Mapping[str, Envelope]
    mounts: Mapping[str, MountEnvelope]
    cycles: Array
    remaining: Array
    settled: npt.NDArray[np.bool_]
    excitation: dict[str, Any]
    timestep: float
    estimated_error: float
    model_steps: int
    initial_state: State = field(repr=False)
    final_state: State = field(repr=False)
    warnings: tuple[str, ...]

    def _summary(self) -> tuple[str, dict[str, str]]:
        peak = int(np.argmax(self.amplitude))
        return "FrequencySweep", {
            "frequencies": f"{span((self.frequency[0], self.frequency[-1]), 'Hz')}, {self.frequency.size} of them",
            "base": f"along {direction_text(self.direction)}, {quantity(float(self.base_amplitude.max()), 'm/s^2')}",
            f"largest {self.response_direction} of {self.payload}": (
                f"{quantity(self.amplitude[peak], 'm/s^2')} at {self.frequency[peak]:.4g} Hz"
            ),
            "transmissibility there": f"{self.transmissibility[peak]:.4g}",
            "step": f"{1e6 * self.timestep:.4g} us",
            **({"warnings": "; ".join(self.warnings)} if self.warnings else {}),
        }

    @property
    def amplitude(self) -> Array:
        """Largest absolute acceleration of the payload along the response direction [m/s^2], (n,)."""
        return self.envelopes[self.payload].acceleration[:, AXES.index(self.response_direction)]

    @property
    def transmissibility(self) -> Array:
        """Amplitude over the base's amplitude in the same cycle, (n,)."""
        return self.envelopes[self.payload].transmissibility[:, AXES.index(self.response_direction)]

    @property
    def deflection(self) -> Array:
        """Largest absolute deflection of every mount along roll, shear and axial [m], (n_mounts, n, 3)."""
        return np.stack([np.maximum(mount.maximum, -mount.minimum) for mount in self.mounts.values()])

    @property
    def direction(self) -> str | tuple[float, float, float]:
        """Direction of the excitation."""
        direction = self.excitation["direction"]
        return direction if isinstance(direction, str) else tuple(direction)

    @property
    def sweep(self) -> Sweep | None:
        """The sweep; None for steady sines."""
        motion = motion_from_dict(self.excitation) if self.excitation["kind"] == Sweep.kind else None
        return motion if isinstance(motion, Sweep) else None

    def save(self, folder: str | Path) -> None:
        """Write table and summary into `folder` (made if missing), whole or not at all; those that are there are replaced."""
        from wirerope_mj.dynamics.sweep.storage import save_sweep

        save_sweep(self, Path(folder))

    @classmethod
    def load(cls, folder: str | Path) -> "FrequencySweep":
        """Return the sweep that was saved in `folder`.

        Raises:
            RecordError: the folder holds no sweep, or its file is damaged.
        """
        from wirerope_mj.dynamics.sweep.storage import load_sweep

        return load_sweep(Path(folder))
