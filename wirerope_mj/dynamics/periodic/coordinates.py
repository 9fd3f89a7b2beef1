"""The unknowns of a periodic motion, and their conversion to and from a state of the engine."""

from dataclasses import dataclass
from functools import cached_property

import mujoco
import numpy as np

from wirerope_mj.engine.simulation.stepper import moving_with_base
from wirerope_mj.engine.statics import History, equilibrium
from wirerope_mj.engine.system import System
from wirerope_mj.foundation.arrays import Array
from wirerope_mj.foundation.state import State
from wirerope_mj.motions import Sine

SMALLEST_STATE = 1e-2
"""Fraction of the largest range among the internal states below which a state's own range is no scale for it."""


class Coordinates:
    """Unknowns x = (configuration, velocity, internal states) of a system at phase 0 of its base's sine.

    Configuration and velocity are those of the free coordinates relative to the equilibrium carried along by the base, the
    configuration in the tangent space of MuJoCo's. The base is prescribed and not among them.

    Attributes:
        size: number of unknowns, 2 n_free + n_a.
    """

    def __init__(self, system: System, *, direction: str | tuple[float, float, float], history: History) -> None:
        self.system, self.direction = system, direction
        self.model = system.model
        self._rest = equilibrium(system, history=history).state
        slow = Sine(frequency=1.0, acceleration=1.0, direction=direction)
        rest = State(values=self._rest.values.copy(), time=0.0)
        self._carry = moving_with_base(system, slow, rest).values - self._rest.values
        self.free = np.setdiff1d(np.arange(self.model.nv), system.assembly.driven_dofs)
        self.size = 2 * self.free.size + self.model.na
        parts = (mujoco.mjtState.mjSTATE_TIME, mujoco.mjtState.mjSTATE_QPOS, mujoco.mjtState.mjSTATE_QVEL)
        time, nq, nv = (mujoco.mj_stateSize(self.model, part) for part in parts)
        self._qpos, self._qvel = slice(time, time + nq), slice(time + nq, time + nq + nv)
        self._act = slice(time + nq + nv, time + nq + nv + self.model.na)

    @property
    def configuration(self) -> slice:
        """Indices of the configuration among the unknowns."""
        return slice(0, self.free.size)

    @property
    def velocity(self) -> slice:
        """Indices of the velocities among the unknowns."""
        return slice(self.free.size, 2 * self.free.size)

    @property
    def internal(self) -> slice:
        """Indices of the internal states among the unknowns."""
        return slice(2 * self.free.size, self.size)

    def rest(self) -> Array:
        """Return the unknowns of the equilibrium moving with the base, (n_x,)."""
        x = np.zeros(self.size)
        x[self.internal] = self._rest.values[self._act]
        return x

    @property
    def moving(self) -> slice:
        """Indices of qpos, qvel and act among the values of an engine's state."""
        return slice(self._qpos.start, self._act.stop)

    def carried(self, frequency: float, acceleration: float) -> Array:
        """Return the engine's state of the equilibrium moving with the base at phase 0 of the sine, (n_state,).

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
        """Return the engine's state for the unknowns, (n_state,)."""
        values, move, qpos = carried.copy(), np.zeros(self.model.nv), carried[self._qpos].copy()
        move[self.free] = x[self.configuration]
        mujoco.mj_integratePos(self.model, qpos, move, 1.0)
        values[self._qpos] = qpos
        values[self._qvel][self.free] += x[self.velocity]
        values[self._act] = x[self.internal]
        return values

    def from_state(self, values: Array, carried: Array) -> Array:
        """Return the unknowns of an engine's state, (n_x,)."""
        x, move = np.empty(self.size), np.empty(self.model.nv)
        mujoco.mj_differentiatePos(self.model, move, 1.0, carried[self._qpos], values[self._qpos])
        x[self.configuration] = move[self.free]
        x[self.velocity] = (values[self._qvel] - carried[self._qvel])[self.free]
        x[self.internal] = values[self._act]
        return x


@dataclass(frozen=True, kw_only=True)
class Ranges:
    """Half ranges over a period: the largest of mount deflection [m], its rate [m/s], and every internal state, (n_a,)."""

    deflection: float
    rate: float
    internal: Array


def scales(coordinates: Coordinates, ranges: Ranges) -> Array:
    """Return the unit of every unknown, (n_x,).

    Lengths and speeds are those of the mounts. A coordinate with the inertia M_ii has sqrt(M / M_ii) of them, M
    the mass of the heaviest payload: so an angle counts as the length that it moves at the radius of gyration.
    """
    ratio = coordinates.ratios
    internal = np.maximum(ranges.internal, SMALLEST_STATE * ranges.internal.max(initial=0.0))
    internal = np.where(internal > 0.0, internal, 1.0)
    return np.concatenate([ranges.deflection * ratio, ranges.rate * ratio, internal])
