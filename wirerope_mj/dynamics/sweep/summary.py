"""The largest figures of a sweep in plain values."""

from typing import Any

import numpy as np

from wirerope_mj.dynamics.sweep.envelope import AXES, FrequencySweep


def summary(sweep: FrequencySweep) -> dict[str, Any]:
    """Return excitation, cost, warnings and the peaks of all bodies and mounts: [Hz], [m/s^2], [m]."""
    bodies = {
        name: {
            axis: {
                "largest_acceleration_m_s2": float(envelope.acceleration[:, i].max()),
                "at_Hz": float(sweep.frequency[int(np.argmax(envelope.acceleration[:, i]))]),
                "largest_transmissibility": float(envelope.transmissibility[:, i].max()),
                "transmissibility_at_Hz": float(sweep.frequency[int(np.argmax(envelope.transmissibility[:, i]))]),
            }
            for i, axis in enumerate(AXES)
        }
        for name, envelope in sweep.envelopes.items()
    }
    mounts = {
        name: {
            "lowest_deflection_m": mount.minimum.min(axis=0).tolist(),
            "highest_m": mount.maximum.max(axis=0).tolist(),
        }
        for name, mount in sweep.mounts.items()
    }
    return {
        "excitation": sweep.excitation,
        "payload": sweep.payload,
        "response_direction": sweep.response_direction,
        "frequencies": int(sweep.frequency.size),
        "unsettled_frequencies_Hz": [] if sweep.sweep else sweep.frequency[~sweep.settled].tolist(),
        "cycles": int(sweep.cycles.sum()),
        "model_steps": sweep.model_steps,
        "largest_step_s": sweep.timestep,
        "warnings": list(sweep.warnings),
        "bodies": bodies,
        "mounts_roll_shear_axial": mounts,
    }
