"""A system shaken by one steady sine after another."""

from collections.abc import Sequence
from pathlib import Path

import numpy as np
import numpy.typing as npt

from wirerope_mj.dynamics.sweep.arguments import (
    acceleration_of,
    chosen_step,
    require_payload,
    response_axis,
    starting_state,
)
from wirerope_mj.dynamics.sweep.collector import Collector
from wirerope_mj.dynamics.sweep.cycles import at_start
from wirerope_mj.dynamics.sweep.envelope import FrequencySweep
from wirerope_mj.dynamics.sweep.settling import Steady, settle
from wirerope_mj.engine.simulation.progress import share_bar
from wirerope_mj.engine.simulation.simulate import check_direction
from wirerope_mj.engine.statics import History
from wirerope_mj.engine.system import System
from wirerope_mj.foundation.arguments import integer, nonzero, positive, the_one_given
from wirerope_mj.foundation.directions import Direction, checked_direction, plain_direction
from wirerope_mj.foundation.state import State
from wirerope_mj.motions import Sine, Sweep

KIND = "stepped sine"

PILOT = 60.0
"""Duration of the sweep over the frequencies along which a step is chosen [s]: long compared with the pilots' windows."""


def stepped_sine(
    system: System,
    *,
    frequencies: npt.ArrayLike,
    direction: str | Sequence[float],
    payload: str,
    acceleration: float | None = None,
    velocity: float | None = None,
    displacement: float | None = None,
    response_direction: str | Sequence[float] | None = None,
    settled: float = 1e-4,
    largest_cycles: int = 1000,
    history: History = "relaxed",
    initial: State | None = None,
    timestep: float | None = None,
    accuracy: float = 1e-4,
    out: str | Path | None = None,
    progress: bool = False,
) -> FrequencySweep:
    """Return the settled amplitudes at one frequency after the other, each from the last one's final state.

    A frequency has settled when the amplitudes of all bodies are estimated to lie within `settled` of their limits; the limit
    of a slow approach is extrapolated, so that a slow change is not taken for none. Where that takes more than
    `largest_cycles`, as it does for ever with a subharmonic, `settled` says so and the row holds the largest of the last
    quarter of the cycles.

    Args:
        system: the system.
        frequencies: of the base [Hz], (n,), in the order in which they are taken.
        direction: of the base, "x", "y", "z" or a vector.
        payload: the body that `amplitude` belongs to; envelopes of all others are kept too.
        acceleration: amplitude of the base's acceleration [m/s^2]; exactly one of the three amplitudes is given.
        velocity: amplitude of its velocity [m/s].
        displacement: amplitude of its displacement [m].
        response_direction: axis along which the payload's acceleration is taken; None: that of the base.
        settled: relative distance from the limit at which an amplitude counts as settled.
        largest_cycles: number of cycles after which the wait at a frequency ends.
        history: equilibrium from which the system starts.
        initial: a state to start from instead.
        timestep: largest step [s]; None chooses it before the run for `accuracy`.
        accuracy: error of samples and peaks allowed in pilots over the frequencies, relative to the peaks.
        out: folder to which the table is written, and an adjacent summary, atomically.
        progress: whether a progress bar is shown on standard error.

    Raises:
        ValueError: an argument is out of range, or payload or direction do not exist.
        ModelError: the base has no driven slide in this direction.
        RecordError: `out` already holds a sweep.
        SimulationError: the step is too large, or a mount left the range of its law; says at which frequency.
        ConvergenceError: there is no equilibrium to start from.
    """
    quantity, level = the_one_given({"acceleration": acceleration, "velocity": velocity, "displacement": displacement})
    level = nonzero(quantity, level)
    base = checked_direction(direction)
    sines = [
        Sine(frequency=f, acceleration=acceleration_of(quantity, level, f), direction=base)
        for f in checked_frequencies(frequencies)
    ]
    check_direction(system, sines[0])
    require_payload(system, payload)
    along = response_axis(response_direction, base)
    tolerance, most = positive("settled", settled), integer("largest_cycles", largest_cycles, least=1)
    start = starting_state(system, history=history, initial=initial)
    pilot = _pilot(sines, quantity, level, base)
    excitation = {"kind": KIND, quantity: level, "direction": plain_direction(base)}
    with (
        Collector(system, direction=base, out=out) as collector,
        share_bar("stepping", "Hz", enabled=progress) as update,
    ):
        step = chosen_step(system, pilot, start, duration=PILOT, timestep=timestep, accuracy=accuracy)
        state = start = at_start(system, sines[0], start)
        unsettled: list[str] = []
        for number, sine in enumerate(sines):
            at = settle(system, sine, state, timestep=step.timestep, settled=tolerance, largest_cycles=most)
            state = at.state
            _keep(collector, sine.frequency, at)
            if not at.settled:
                unsettled.append(f"{sine.frequency:.5g} Hz ({at.remaining:.2g})")
            update((number + 1) / len(sines), sine.frequency)
        return collector.finish(
            payload=payload, response_direction=along, excitation=excitation, error=step.error, initial_state=start,
            final_state=state, warnings=_warnings(unsettled, most, tolerance),
        )  # fmt: skip


def checked_frequencies(frequencies: npt.ArrayLike) -> list[float]:
    """Return the frequencies [Hz] as plain numbers; none, or one that is not positive, is a ValueError."""
    values = np.atleast_1d(np.asarray(frequencies, dtype=float))
    if values.ndim != 1 or not values.size:
        raise ValueError(f"`frequencies` must be a series of numbers, got shape {values.shape}.")
    return [positive(f"frequencies[{number}]", value) for number, value in enumerate(values.tolist())]


def _pilot(sines: list[Sine], quantity: str, level: float, direction: Direction) -> Sine | Sweep:
    """Return a motion over all frequencies along which a step can be chosen."""
    low, high = min(sine.frequency for sine in sines), max(sine.frequency for sine in sines)
    if low == high:
        return sines[0]
    rate = 60.0 / PILOT * float(np.log2(high / low))
    return Sweep(start=low, stop=high, rate=rate, direction=direction, **{quantity: level})


def _keep(collector: Collector, frequency: float, at: Steady) -> None:
    """Take a frequency into the table."""
    collector.count(at.steps, at.largest_step)
    collector.add(
        np.array([frequency]), at.minimum[np.newaxis], at.maximum[np.newaxis], cycles=at.cycles, remaining=at.remaining,
        settled=at.settled,
    )  # fmt: skip


def _warnings(unsettled: list[str], most: int, tolerance: float) -> tuple[str, ...]:
    if not unsettled:
        return ()
    return (
        f"not settled to {tolerance:.2g} after {most} cycles (estimated distance from the limit): {', '.join(unsettled)}.",
    )
