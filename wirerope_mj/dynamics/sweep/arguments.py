"""Arguments of sweeps and stepped sines: payload, response axis, start and step."""

import math
from collections.abc import Sequence
from dataclasses import replace

import mujoco
import numpy as np

from wirerope_mj.dynamics.sweep.channels import Channels
from wirerope_mj.dynamics.sweep.cycles import at_start
from wirerope_mj.dynamics.sweep.envelope import AXES
from wirerope_mj.engine.control.install import STATE
from wirerope_mj.engine.simulation.stability import stable_step
from wirerope_mj.engine.simulation.timestep import GIVEN, ChosenStep, choose_timestep
from wirerope_mj.engine.statics import History, equilibrium
from wirerope_mj.engine.system import System
from wirerope_mj.foundation.arguments import one_of, positive
from wirerope_mj.foundation.directions import Direction, checked_direction, unit_vector
from wirerope_mj.foundation.errors import SimulationError
from wirerope_mj.foundation.state import State
from wirerope_mj.motions import Sine, Sweep

STEPS_PER_CYCLE, REFERENCE = 128, 1e-4
"""Fewest steps of a cycle, and the accuracy they are for: a peak is refined by a parabola, which misses it where a law without
an elastic part turns and its slope jumps. Pilots of two such steps have the same error and do not see it."""

SAMPLES_PER_CYCLE = 8
"""Samples by which steps are judged before the run, in a cycle of the highest frequency; peaks are judged from every step."""


def require_payload(system: System, payload: str) -> None:
    """Raise ValueError unless `payload` is a body that moves relative to the base."""
    names = Channels.of(system).names
    if payload not in names:
        others = [name for name in names if name not in system.payloads]
        more = f" Other bodies that move: {others}." if others else ""
        raise ValueError(
            f"`payload` must be a payload of the system, got {payload!r}. Payloads: {system.payloads}.{more}"
        )


def response_axis(response_direction: str | Sequence[float] | None, base: Direction) -> str:
    """Return "x", "y" or "z" for a response direction along one of them; without one, for the base's."""
    name = "direction" if response_direction is None else "response_direction"
    direction = base if response_direction is None else response_direction
    if isinstance(direction, str):
        return one_of(name, direction, AXES)
    unit = np.abs(unit_vector(checked_direction(direction, name)))
    along = int(np.argmax(unit))
    if unit[along] < 1.0 - 1e-12:
        raise ValueError(f"`{name}` must lie along x, y or z, for which envelopes are kept, got {list(direction)}.")
    return AXES[along]


def starting_state(system: System, *, history: History, initial: State | None) -> State:
    """Return the given state, or the equilibrium."""
    if initial is None:
        return equilibrium(system, history=history).state
    size = int(mujoco.mj_stateSize(system.model, STATE))
    if not isinstance(initial, State) or initial.values.shape != (size,):
        raise ValueError(f"`initial` must be a State of this system, with {size} values, such as a `final_state`.")
    return initial


def chosen_step(
    system: System, motion: Sine | Sweep, start: State, *, duration: float, timestep: float | None, accuracy: float
) -> ChosenStep:
    """Return the given step, or one that keeps the accuracy in pilots along the motion."""
    if timestep is None:
        rate = SAMPLES_PER_CYCLE / motion.shortest_time
        chosen = choose_timestep(
            system, motion, at_start(system, motion, start), duration=duration, sample_rate=rate,
            accuracy=positive("accuracy", accuracy),
        )  # fmt: skip
        longest = motion.shortest_time / STEPS_PER_CYCLE * math.sqrt(accuracy / REFERENCE)
        return replace(chosen, timestep=min(chosen.timestep, longest))
    given, limit = positive("timestep", timestep), stable_step(system)
    if given > limit:
        raise SimulationError(
            f"a step of {given:.4g} s is too large for the stiffest mount: RK4 is stable up to {limit:.4g} s here. Give a "
            "smaller `timestep`, or None to have it chosen."
        )
    return ChosenStep(timestep=given, error=math.nan, limited_by=GIVEN)


def acceleration_of(quantity: str, amplitude: float, frequency: float) -> float:
    """Return the acceleration amplitude [m/s^2] of a sine whose amplitude is given in `quantity`."""
    omega = 2.0 * math.pi * frequency
    return amplitude * {"acceleration": 1.0, "velocity": omega, "displacement": omega**2}[quantity]
