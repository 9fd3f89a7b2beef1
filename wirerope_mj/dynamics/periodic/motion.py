"""A periodic motion: its unknowns, the base's sine, the track of a system through its periods, and quantities read from it."""

from dataclasses import dataclass
from functools import cached_property

import mujoco
import numpy as np

from wirerope_mj.engine.control import layout as at
from wirerope_mj.engine.control.peaks import parabola_extreme
from wirerope_mj.engine.simulation.stepper import moving_with_base
from wirerope_mj.engine.statics import History, equilibrium
from wirerope_mj.engine.system import System
from wirerope_mj.foundation.arrays import Array
from wirerope_mj.foundation.state import State
from wirerope_mj.motions import Sine
from wirerope_mj.mounts.isolator.travel import travel_reached, travel_utilisation


class Coordinates:
    """Coordinates of the shooting unknowns x = (configuration, velocity, internal states) at phase 0 of the base's sine.

    Configuration and velocity are those of the free coordinates relative to the equilibrium carried along by the base, the
    configuration in the tangent space of MuJoCo's. The base is prescribed and not among them.
    """

    def __init__(self, system: System, *, direction: str | tuple[float, float, float], history: History) -> None:
        self.system, self.direction = system, direction
        self.model = system.model
        self._rest = equilibrium(system, history=history).state
        slow = Sine(frequency=1.0, acceleration=1.0, direction=direction)
        rest = State(values=self._rest.values.copy(), time=0.0)
        self._carry = moving_with_base(system, slow, rest).values - self._rest.values
        self.free = np.setdiff1d(np.arange(self.model.nv), system.assembly.driven_dofs)
        n = self.free.size
        self.size = 2 * n + self.model.na  # number of unknowns, n_x
        self.configuration, self.velocity, self.internal = slice(0, n), slice(n, 2 * n), slice(2 * n, self.size)
        parts = (mujoco.mjtState.mjSTATE_TIME, mujoco.mjtState.mjSTATE_QPOS, mujoco.mjtState.mjSTATE_QVEL)
        time, nq, nv = (mujoco.mj_stateSize(self.model, part) for part in parts)
        self._qpos, self._qvel = slice(time, time + nq), slice(time + nq, time + nq + nv)
        self._act = slice(time + nq + nv, time + nq + nv + self.model.na)
        self.moving = slice(self._qpos.start, self._act.stop)  # qpos, qvel and act among the values of a state

    def rest(self) -> Array:
        """Unknowns of the equilibrium moving with the base, (n_x,)."""
        x = np.zeros(self.size)
        x[self.internal] = self._rest.values[self._act]
        return x

    def carried(self, frequency: float, acceleration: float) -> Array:
        """Evaluate the engine's state of the equilibrium moving with the base at phase 0 of the sine, (n_state,).

        The base then stands where it is modelled and moves with its largest velocity, -acceleration / (2 pi frequency).
        """
        return np.asarray(self._rest.values + acceleration / frequency * self._carry)

    @cached_property
    def ratios(self) -> Array:
        """sqrt(M / M_ii) of the free coordinates, (n_free,), see `scales`; M the mass of the heaviest payload."""
        mass = np.zeros((self.model.nv, self.model.nv))
        data = mujoco.MjData(self.model)
        mujoco.mj_fwdPosition(self.model, data)
        mujoco.mj_fullM(self.model, data, mass)
        payloads = [self.model.body(name).id for name in self.system.payloads]
        return np.asarray(np.sqrt(self.model.body_subtreemass[payloads].max() / np.diag(mass)[self.free]))

    def to_state(self, x: Array, carried: Array) -> Array:
        """Write unknowns as the engine's state, (n_state,)."""
        values, move, qpos = carried.copy(), np.zeros(self.model.nv), carried[self._qpos].copy()
        move[self.free] = x[self.configuration]
        mujoco.mj_integratePos(self.model, qpos, move, 1.0)
        values[self._qpos] = qpos
        values[self._qvel][self.free] += x[self.velocity]
        values[self._act] = x[self.internal]
        return values

    def from_state(self, values: Array, carried: Array) -> Array:
        """Read the unknowns from an engine's state, (n_x,)."""
        x, move = np.empty(self.size), np.empty(self.model.nv)
        mujoco.mj_differentiatePos(self.model, move, 1.0, carried[self._qpos], values[self._qpos])
        x[self.configuration] = move[self.free]
        x[self.velocity] = (values[self._qvel] - carried[self._qvel])[self.free]
        x[self.internal] = values[self._act]
        return x


@dataclass(frozen=True, kw_only=True)
class Ranges:
    """Largest half ranges over a period: of mount deflection [m], of its rate [m/s], of internal states."""

    deflection: float
    rate: float
    internal: Array  # for every state the largest of its kind, (n_a,)


def scales(coordinates: Coordinates, ranges: Ranges) -> Array:
    """Choose the size by which every unknown is divided, (n_x,).

    Units of lengths and speeds are the mounts' half ranges. A coordinate with the inertia M_ii has sqrt(M / M_ii) of them, M
    the mass of the heaviest payload: so an angle counts as the length that it moves at the radius of gyration. Internal states
    of one kind share a unit: in its own range the state of a slider that hardly slips would weigh more than its effect does.
    """
    ratio, internal = coordinates.ratios, np.where(ranges.internal > 0.0, ranges.internal, 1.0)
    return np.concatenate([ranges.deflection * ratio, ranges.rate * ratio, internal])


@dataclass(frozen=True, kw_only=True)
class Drive:
    """A sine of the base and its steps: frequency [Hz], acceleration [m/s^2], periods and steps in all."""

    frequency: float
    acceleration: float
    periods: int
    steps: int

    @property
    def duration(self) -> float:
        return self.periods / self.frequency

    def sine(self, direction: str | tuple[float, float, float]) -> Sine:
        return Sine(frequency=self.frequency, acceleration=self.acceleration, direction=direction)


@dataclass(frozen=True, kw_only=True)
class Track:
    """Time history of an integrated motion: unknowns at its end, (n_x,), and the engine's values at the start of every step.

    sensors are the system's sensor values (n_steps, n_s); qpos, qvel and act the engine's state, (n_steps, n_q|n_v|n_a).
    """

    end: Array
    sensors: Array
    qpos: Array
    qvel: Array
    act: Array
    drive: Drive


def observed_bodies(system: System) -> list[str]:
    """List the bodies whose motion is observed, the base left out, payloads first."""
    names = system.assembly.subjects.body_names
    return [*system.payloads, *(name for name in names if name not in system.payloads and name != system.base)]


def body_acceleration(system: System, track: Track, body: str) -> Array:
    """Read the absolute acceleration of a body's centre of mass at the start of every step [m/s^2], (n_t, 3)."""
    first = at.KINEMATICS * system.assembly.subjects.body_names.index(body) + at.ACCELERATION
    return track.sensors[:, first : first + 3]


def mount_deflections(system: System, track: Track) -> Array:
    """Read the deflections of all mounts in their axes [m], (n_t, n_mounts, 3)."""
    channels = system.assembly.tables.channels
    channels = channels[channels.size - 2 * len(system.mounts) :: 2]  # the last are deflection and force of each mount
    return np.asarray(track.sensors[:, channels[:, None] + np.arange(3)])


def ranges(system: System, track: Track) -> Ranges:
    """Measure the half ranges of deflections, rates and internal states over a motion."""
    deflection = mount_deflections(system, track)
    kinds = np.full(system.model.na, "", dtype="<U1")  # first letters of names: z are forces, others have other units
    for mount in system.mounts.values():
        for states, law in zip(mount.states, mount.isolator.axes.values(), strict=True):
            kinds[states] = [name[0] for name in law.state_names] if law is not None else []
    spread = np.ptp(track.act, axis=0) / 2.0
    internal = np.array([spread[kinds == kind].max() for kind in kinds])
    step = track.drive.duration / track.drive.steps
    rate = np.diff(deflection, axis=0, append=deflection[:1]) / step
    half_range, speed = (float(np.ptp(values, axis=0).max()) / 2.0 for values in (deflection, rate[:-1]))
    return Ranges(deflection=half_range, rate=speed, internal=internal)


def deflection_rates(system: System, track: Track) -> Array:
    """Compute the largest deflection rates of all mounts in their axes [m/s], (n_mounts, 3)."""
    moved = np.abs(np.diff(mount_deflections(system, track), axis=0)).max(axis=0)
    return np.asarray(moved * track.drive.steps / track.drive.duration)


def largest(values: Array) -> float:
    """Find the largest value of a periodic series (n_t,) by the parabola through its largest sample and the neighbours."""
    i = int(np.argmax(values))
    left, middle, right = values[i - 1], values[i], values[(i + 1) % values.size]
    return float(parabola_extreme(-1.0, left, 0.0, middle, 1.0, right)[1])


def amplitude(values: Array) -> float:
    """Find the largest absolute value of a periodic series (n_t,), refined by a parabola."""
    return max(largest(values), largest(-values))


def travel_exceeded(system: System, track: Track) -> str:
    """Describe the mount that exceeds its rated travel most and count the others; "" without such mounts."""
    deflections = mount_deflections(system, track)
    lowest, highest = deflections.min(axis=0), deflections.max(axis=0)
    exceeded = []
    for (name, mount), low, high in zip(system.mounts.items(), lowest, highest, strict=True):
        rated, reached = mount.isolator.limits.travel.stated, travel_reached(low, high)
        for rating, utilisation in travel_utilisation(reached, rated).items():
            far = f"mount {name!r} reaches {1e3 * reached[rating]:.4g} mm in {rating}, rated for {1e3 * rated[rating]:.4g} mm"
            exceeded += [(utilisation, far)] if utilisation > 1.0 else []
    exceeded.sort(reverse=True)
    more = f", and {len(exceeded) - 1} more" if len(exceeded) > 1 else ""
    return exceeded[0][1] + more if exceeded else ""
