"""A system shaken by a continuous sweep, cycle by cycle."""

import math
from collections.abc import Sequence
from pathlib import Path

import numpy as np

from wirerope_mj.dynamics.sweep.arguments import (
    acceleration_of,
    chosen_step,
    require_payload,
    response_axis,
    starting_state,
)
from wirerope_mj.dynamics.sweep.collector import Collector
from wirerope_mj.dynamics.sweep.cycles import STEPS_PER_CYCLE, at_start, stepping
from wirerope_mj.dynamics.sweep.envelope import FrequencySweep
from wirerope_mj.dynamics.sweep.settling import settle
from wirerope_mj.engine.simulation.progress import share_bar
from wirerope_mj.engine.simulation.simulate import check_direction
from wirerope_mj.engine.statics import History
from wirerope_mj.engine.system import System
from wirerope_mj.foundation.arguments import integer, positive
from wirerope_mj.foundation.budget import require_memory, require_time
from wirerope_mj.foundation.state import State
from wirerope_mj.motions import Sine, Sweep

CHUNK = 64
"""Cycles between two looks at deflections and progress: their base motion is evaluated at once."""

CYCLE = 500.0
"""Bytes of a cycle: its instants and how they are found, and its row of extremes, of ten bodies and mounts at the least."""


def frequency_sweep(
    system: System,
    sweep: Sweep,
    *,
    payload: str,
    response_direction: str | Sequence[float] | None = None,
    history: History = "relaxed",
    initial: State | None = None,
    settled: float | None = 1e-3,
    largest_cycles: int = 1000,
    timestep: float | None = None,
    accuracy: float = 1e-4,
    out: str | Path | None = None,
    progress: bool = False,
    direction: None = None,
) -> FrequencySweep:
    """Return the envelope of accelerations and deflections that a sweep leaves, cycle by cycle.

    The system first follows a steady sine of the sweep's level at its start frequency until its amplitudes have settled, so
    that the envelope begins on the response and not on the transient of switching on. Then it follows the sweep through its
    complete cycles; what is left of the last one is not run, so that the final state stands at phase 0 and a sweep in the
    other direction may start from it. A sweep lags behind the steady response by about rate ln 2 / 60 times the decay time of
    the transients, relative to the frequency: repeat it at half the rate, or in the other direction, to see by how much.

    Args:
        system: the system.
        sweep: base motion, up or down.
        payload: the body that `amplitude` belongs to; envelopes of all others are kept too.
        response_direction: axis along which the payload's acceleration is taken, "x", "y", "z" or a vector along one of them;
            None: that of the base.
        history: equilibrium from which the system starts. Vibration lets the hysteretic part of the static load leak away:
            a "relaxed" system has that behind it, a "virgin" one sinks during the sweep.
        initial: a state to start from instead, for instance the `final_state` of a sweep up before one down.
        settled: relative distance from the limit at which the amplitudes at the start frequency count as settled; None: the
            sweep begins at once.
        largest_cycles: number of cycles after which that wait ends.
        timestep: largest step [s]; None chooses it before the run for `accuracy`.
        accuracy: error of samples and peaks allowed in pilots along the sweep, relative to the peaks.
        out: folder to which the table of the envelope is streamed, and an adjacent summary, atomically.
        progress: whether a progress bar is shown on standard error.
        direction: refused: the sweep states the base's.

    Raises:
        ValueError: an argument is out of range, or payload or direction do not exist.
        ModelError: the base has no driven slide in the sweep's direction.
        RecordError: `out` already holds a sweep.
        SimulationError: the step is too large, or a mount left the range of its law; says at which frequency.
        ConvergenceError: there is no equilibrium to start from.
    """
    if not isinstance(sweep, Sweep):
        raise ValueError(f"`sweep` must be a wirerope_mj.Sweep, got {type(sweep).__name__}.")
    if direction is not None:
        raise ValueError(
            "`direction` is the base's axis, which the sweep motion states; give `response_direction` for the payload's."
        )
    check_direction(system, sweep)
    require_payload(system, payload)
    along = response_axis(response_direction, sweep.direction)
    check_cycles(sweep, timestep)
    instants = sweep.course.whole_cycles()
    if instants.size < 2:
        raise ValueError(
            f"`sweep` ends after {sweep.duration:.4g} s, before its first cycle does; lower its rate or widen its range."
        )
    wait = None if settled is None else positive("settled", settled)
    most = integer("largest_cycles", largest_cycles, least=1)
    start = starting_state(system, history=history, initial=initial)
    with (
        Collector(system, direction=sweep.direction, out=out) as collector,
        share_bar("sweeping", "Hz", enabled=progress) as update,
    ):
        step = chosen_step(system, sweep, start, duration=float(instants[-1]), timestep=timestep, accuracy=accuracy)
        led, warnings = _lead_in(system, sweep, start, collector, step.timestep, wait, most)
        start = at_start(system, sweep, led)
        with stepping(system, sweep, start, step.timestep) as stepped:
            for first in range(0, instants.size - 1, CHUNK):
                ends = instants[first : first + CHUNK + 1]
                seen = stepped.run(ends)
                frequency = sweep.frequency((ends[:-1] + ends[1:]) / 2.0)
                collector.add(frequency, seen.minimum, seen.maximum, cycles=1, remaining=math.nan, settled=False)
                update(float(ends[-1] / instants[-1]), float(frequency[-1]))
            collector.count(stepped.steps, stepped.largest_step)
            final = stepped.finish()
        return collector.finish(
            payload=payload, response_direction=along, excitation=sweep.to_dict(), error=step.error, initial_state=start,
            final_state=final, warnings=warnings,
        )  # fmt: skip


def _lead_in(
    system: System,
    sweep: Sweep,
    start: State,
    collector: Collector,
    timestep: float,
    settled: float | None,
    largest_cycles: int,
) -> tuple[State, tuple[str, ...]]:
    """Return the state after the steady sine at the start frequency, and a warning if it has not settled."""
    if settled is None:
        return start, ()
    sine = sine_at_start(sweep)
    lead = settle(system, sine, start, timestep=timestep, settled=settled, largest_cycles=largest_cycles)
    collector.count(lead.steps, lead.largest_step)
    if lead.settled:
        return lead.state, ()
    text = f"amplitudes at the start frequency of {sweep.start:.5g} Hz were {lead.remaining:.2g} from their limits"
    return lead.state, (f"{text} after {lead.cycles} cycles, not {settled:.2g}.",)


def check_cycles(sweep: Sweep, timestep: float | None) -> None:
    """Raise BudgetError if a sweep has more cycles than there is memory or time for."""
    cycles = abs(float(sweep.course.phase(np.array([sweep.duration]))[0])) / (2.0 * math.pi)
    what = f"a sweep of {sweep.duration:.4g} s"
    remedy = "Sweep faster (a larger `rate`), or over a narrower range."
    require_memory(f"{what}, {cycles:.3g} cycles,", cycles * CYCLE, remedy)
    require_time(what, max(STEPS_PER_CYCLE * cycles, sweep.duration / (timestep or math.inf)), remedy)


def sine_at_start(sweep: Sweep) -> Sine:
    """Return the steady sine of the sweep's level at its start frequency."""
    acceleration = acceleration_of(sweep.quantity, sweep.amplitude, sweep.start)
    return Sine(frequency=sweep.start, acceleration=acceleration, direction=sweep.direction)
