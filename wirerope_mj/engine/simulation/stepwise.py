"""A system that another program takes from instant to instant, and whose base and loads it gives as they come."""

import math
from collections.abc import Mapping
from typing import Any

import mujoco
import numpy as np

from wirerope_mj.engine.control import installed
from wirerope_mj.engine.control import layout as at
from wirerope_mj.engine.control.install import state_of
from wirerope_mj.engine.simulation.grid import Grid
from wirerope_mj.engine.simulation.recorder import column_plan
from wirerope_mj.engine.simulation.simulate import checked_step
from wirerope_mj.engine.simulation.stages import Segment, along_slides
from wirerope_mj.engine.simulation.stepper import Stepper, initial_state
from wirerope_mj.engine.system import System, beyond_laws
from wirerope_mj.foundation.arguments import positive
from wirerope_mj.foundation.arrays import Array, ArrayLike, Entries
from wirerope_mj.foundation.errors import SimulationError
from wirerope_mj.foundation.state import State
from wirerope_mj.motions import HarmonicForce

# what a run begins with: the base stands, and what moves it comes from outside. The force acts at no site of any system.
_STILL = HarmonicForce(site="none", frequency=1.0, force=(1.0, 0.0, 0.0))


class Stepwise:
    """A system that is stepped from instant to instant; between two, its base's acceleration and its loads are constant."""

    def __init__(self, system: System, *, timestep: float, initial: str = "settled", start: float = 0.0) -> None:
        """Begin at the instant `start` [s] in one of the named start states of `simulate`, with a largest step [s].

        Raises:
            SimulationError: RK4 is not stable with such a step.
            ConvergenceError: there is no equilibrium to start from.
        """
        self.timestep = checked_step(system, positive("timestep", timestep), 1.0)
        self.system, self.time = system, float(start)  # the instant that was reached [s]
        self.plan = column_plan(system)  # of `values`, the sensors there; columns of time and base come before them
        self.values: Array
        self._stepper = Stepper(system, _STILL, initial_state(system, _STILL, initial))
        self._drive, self._sites = system.assembly.tables.drive, system.assembly.subjects.force_names
        self._moved, self._rate = np.zeros(3), np.zeros(3)
        self._observe(np.zeros(3), np.zeros((len(self._sites), 6)))

    def advance(self, length: float, acceleration: ArrayLike, loads: Mapping[str, ArrayLike] | None = None) -> None:
        """Advance by a time [s] with constant base acceleration [m/s^2], (3,), and loads [N, N m], (6,) by site.

        A SimulationError if a mount went to where its law does not hold, or the state is not valid any more.
        """
        length = positive("length", length)
        held_acceleration = np.asarray(acceleration, dtype=np.float64)
        wrench = np.array([np.asarray((loads or {}).get(site, np.zeros(6)), dtype=np.float64) for site in self._sites])
        wrench = wrench.reshape(len(self._sites), 6)
        steps = max(1, math.ceil(length / self.timestep - 1e-9))
        with installed(self._stepper.model, self._stepper.data):
            while steps:
                some = min(steps, at.MAX_STEPS)
                part = length * some / steps
                self._begin(part, some, held_acceleration, wrench)
                mujoco.mj_step(self._stepper.model, self._stepper.data, nstep=some)
                self._stepper.check()
                self._moved = self._moved + (self._rate + 0.5 * held_acceleration * part) * part
                self._rate = self._rate + held_acceleration * part
                self.time += part
                length, steps = length - part, steps - some
        self._observe(held_acceleration, wrench)
        rows = self.system.assembly.tables.user.mount_rows(self._stepper.user)[:, 0]
        if message := beyond_laws(self.system, rows):
            raise SimulationError(
                f"mount {message[0]!r} was {message[1]}, at {self.time:.6g} s: shake it more gently, or take an isolator with "
                "more travel."
            )

    def to_plain(self) -> dict[str, Any]:
        """Save the state in plain values, to which `restore` returns bit by bit."""
        state = state_of(self._stepper.model, self._stepper.data)
        base = [self._moved.tolist(), self._rate.tolist()]
        return {"time": self.time, "base": base, "state": state.to_plain(), "values": self.values.tolist()}

    def restore(self, saved: Entries) -> None:
        """Return to the state that `to_plain` of this system saved, also after an error."""
        self._stepper.return_to(State.from_plain(saved["state"]))
        self.time, self.values = float(saved["time"]), np.array(saved["values"])
        self._moved, self._rate = map(np.array, saved["base"])

    def _begin(self, length: float, steps: int, acceleration: Array, wrench: Array) -> None:
        """Prepare a segment of equal steps with constant base acceleration and loads."""
        points, sampled = 2 * steps + 1, np.ones(1, dtype=bool)
        grid = Grid(
            start=np.array([self.time]), stop=np.array([self.time + length]), steps=np.array([steps]), sampled=sampled,
            event=np.array([at.CORNER]), corner_after=sampled,
        )  # fmt: skip
        self._stepper.enter(grid)
        base = Segment(
            number=0, positions=along_slides(self._drive, self._moved[np.newaxis])[0],
            rates=along_slides(self._drive, self._rate[np.newaxis])[0], accelerations=np.tile(acceleration, (points, 1)),
            turns=np.empty(0), forces=np.tile(wrench, (points, 1, 1)) if self._sites else np.empty(0),
        )  # fmt: skip
        self._stepper.begin(base)

    def _observe(self, acceleration: Array, wrench: Array) -> None:
        """Compute the values of the present instant."""
        stepper = self._stepper
        with installed(stepper.model, stepper.data):
            self._begin(self.timestep, 1, acceleration, wrench)
            mujoco.mj_forward(stepper.model, stepper.data)
        self.values = stepper.data.sensordata[self.system.assembly.sensor :].copy()
