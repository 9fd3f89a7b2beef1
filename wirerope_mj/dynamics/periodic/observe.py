"""Quantities of a periodic motion: accelerations, deflections, and mounts that leave their rated travel."""

import numpy as np
import numpy.typing as npt

from wirerope_mj.dynamics.periodic.coordinates import Ranges
from wirerope_mj.dynamics.periodic.track import Track
from wirerope_mj.engine.control import layout as at
from wirerope_mj.engine.control.observer import parabola_extreme
from wirerope_mj.engine.system import System
from wirerope_mj.foundation.arrays import Array
from wirerope_mj.mounts.isolator.travel import travel_reached, travel_utilisation


def observed_bodies(system: System) -> list[str]:
    """Return the bodies whose motion is observed, the base left out, payloads first."""
    names = system.assembly.subjects.body_names
    others = [name for name in names if name not in system.payloads and name != system.base]
    return [*system.payloads, *others]


def body_acceleration(system: System, track: Track, body: str) -> Array:
    """Return the absolute acceleration of a body's centre of mass at the start of every step [m/s^2], (n_t, 3)."""
    first = at.KINEMATICS * system.assembly.subjects.body_names.index(body) + at.ACCELERATION
    return track.sensors[:, first : first + 3]


def mount_deflections(system: System, track: Track) -> Array:
    """Return the deflections of all mounts in their axes [m], (n_t, n_mounts, 3)."""
    channels = _mount_channels(system)
    return np.asarray(track.sensors[:, channels[:, None] + np.arange(3)])


def internal_states(system: System, track: Track) -> Array:
    """Return the internal states of all mounts in the order of the system's, (n_t, n_z)."""
    mounts = zip(_mount_channels(system), system.mounts.values(), strict=True)
    columns = [channel + at.MOUNT_VALUES + np.arange(m.states[2].stop - m.states[0].start) for channel, m in mounts]
    return np.asarray(track.sensors[:, np.concatenate(columns)])


def _mount_channels(system: System) -> npt.NDArray[np.int64]:
    """Return the sensor at which each mount's values begin: the deflections are every other of the last channels."""
    channels = system.assembly.tables.channels
    return channels[channels.size - 2 * len(system.mounts) :: 2]


def ranges(system: System, track: Track) -> Ranges:
    """Return the half ranges of deflections, rates and internal states over a track."""
    deflection = mount_deflections(system, track)
    states = internal_states(system, track)
    internal = np.zeros(system.model.na)
    activation = system.assembly.activation
    internal[activation : activation + states.shape[1]] = np.ptp(states, axis=0) / 2.0
    step = track.drive.duration / track.drive.steps
    rate = np.diff(deflection, axis=0, append=deflection[:1]) / step
    return Ranges(
        deflection=float(np.ptp(deflection, axis=0).max()) / 2.0,
        rate=float(np.ptp(rate[:-1], axis=0).max()) / 2.0,
        internal=internal,
    )


def largest(values: Array) -> float:
    """Return the largest value of a periodic series, refined by the parabola through three neighbours."""
    i = int(np.argmax(values))
    left, middle, right = values[i - 1], values[i], values[(i + 1) % values.size]
    return float(parabola_extreme(-1.0, left, 0.0, middle, 1.0, right)[1])


def amplitude(values: Array) -> float:
    """Return the largest absolute value of a periodic series, refined in the same way."""
    return max(largest(values), largest(-values))


def travel_exceeded(system: System, track: Track) -> str:
    """Return a text on the mounts that leave their rated travel by most, "" if none does or none is rated."""
    deflections = mount_deflections(system, track)
    lowest, highest = deflections.min(axis=0), deflections.max(axis=0)
    exceeded = []
    for (name, mount), low, high in zip(system.mounts.items(), lowest, highest, strict=True):
        rated, reached = mount.isolator.limits.travel.stated, travel_reached(low, high)
        for rating, utilisation in travel_utilisation(reached, rated).items():
            far = f"mount {name!r} reaches {reached[rating]:.4g} m in {rating}, rated for {rated[rating]:.4g} m"
            exceeded += [(utilisation, far)] if utilisation > 1.0 else []
    exceeded.sort(reverse=True)
    more = f", and {len(exceeded) - 1} more" if len(exceeded) > 1 else ""
    return exceeded[0][1] + more if exceeded else ""
