"""Envelopes of a system under a continuous sweep, cycle by cycle, or under one steady sine after another."""

import math
from collections.abc import Sequence
from dataclasses import replace
from pathlib import Path

import mujoco
import numpy as np

from wirerope_mj.dynamics.sweep.cycles import STEPS_PER_CYCLE, at_start, settle, stepping
from wirerope_mj.dynamics.sweep.envelope import AXES, Channels, Collector, FrequencySweep
from wirerope_mj.engine.control.install import STATE
from wirerope_mj.engine.simulation.progress import share_bar
from wirerope_mj.engine.simulation.run import warn_of_given_step
from wirerope_mj.engine.simulation.simulate import check_direction, checked_step
from wirerope_mj.engine.simulation.stability import yield_rates
from wirerope_mj.engine.simulation.timestep import GIVEN, ChosenStep, choose_timestep, error_of_given
from wirerope_mj.engine.statics import History, equilibrium
from wirerope_mj.engine.system import System
from wirerope_mj.foundation.arguments import integer, nonzero, one_of, positive, the_one_given
from wirerope_mj.foundation.arrays import ArrayLike
from wirerope_mj.foundation.budget import require_memory, require_time
from wirerope_mj.foundation.directions import Direction, checked_direction, plain_direction, unit_vector
from wirerope_mj.foundation.state import State
from wirerope_mj.motions import Sine, Sweep

# Fewest steps of a cycle, and the accuracy they are for: a peak is refined by a parabola, which misses it where a law without
# an elastic part turns and its slope jumps. Pilots of two such steps have the same error and do not detect it.
STEPS, REFERENCE = 128, 1e-4
# Samples in a cycle of the highest frequency by which steps are judged before the run; peaks are judged from every step.
SAMPLES_PER_CYCLE = 8
CHUNK = 64  # cycles between two checks of deflections and progress: their base motion is evaluated at once
# Memory of a cycle [byte]: its instants and their computation, and its row of extremes, of ten bodies and mounts at least.
CYCLE = 500.0
KIND = "stepped sine"
# Duration of the sweep over the frequencies along which a step is chosen [s]: long compared with the pilots' windows.
PILOT = 60.0


def require_payload(system: System, payload: str) -> None:
    """Raise ValueError unless `payload` is a body that moves relative to the base."""
    names = Channels.of(system).names
    if payload not in names:
        rest = [name for name in names if name not in system.payloads]
        more = f" Other bodies that move: {rest}." if rest else ""
        raise ValueError(f"`payload` must be a payload of the system, got {payload!r}. Payloads: {system.payloads}.{more}")


def response_axis(response_direction: str | Sequence[float] | None, base: Direction) -> str:
    """Return "x", "y" or "z" for a response direction along that axis, by default the base's."""
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
    """Check the initial state if it is given, or compute the equilibrium."""
    if initial is None:
        return equilibrium(system, history=history).state
    size = int(mujoco.mj_stateSize(system.model, STATE))
    if not isinstance(initial, State) or initial.values.shape != (size,):
        raise ValueError(f"`initial` must be a State of this system, with {size} values, such as a `final_state`.")
    return initial


def chosen_step(
    system: System, motion: Sine | Sweep, start: State, *, duration: float, timestep: float | None, accuracy: float
) -> ChosenStep:
    """Check the step if it is given, or choose one that keeps `accuracy` in short trial simulations along the motion."""
    if timestep is None:
        rate = SAMPLES_PER_CYCLE / motion.shortest_time
        chosen = choose_timestep(
            system, motion, at_start(system, motion, start), duration=duration, sample_rate=rate,
            accuracy=positive("accuracy", accuracy),
        )  # fmt: skip
        longest = motion.shortest_time / STEPS * math.sqrt(accuracy / REFERENCE)
        return replace(chosen, timestep=min(chosen.timestep, longest))
    given = checked_step(system, positive("timestep", timestep), 0.0)  # cycles are counted elsewhere
    return ChosenStep(timestep=given, error=math.nan, limited_by=GIVEN)


def acceleration_of(quantity: str, amplitude: float, frequency: float) -> float:
    """Convert the amplitude of a sine, given in `quantity`, to its acceleration amplitude [m/s^2]."""
    omega = 2.0 * math.pi * frequency
    return amplitude * {"acceleration": 1.0, "velocity": omega, "displacement": omega**2}[quantity]


def frequency_sweep(
    system: System, sweep: Sweep, *, payload: str, response_direction: str | Sequence[float] | None = None,
    history: History = "relaxed", initial: State | None = None, settled: float | None = 1e-3, largest_cycles: int = 1000,
    timestep: float | None = None, accuracy: float = 1e-4, out: str | Path | None = None, progress: bool = False,
    direction: None = None,
) -> FrequencySweep:  # fmt: skip
    """Compute the envelope of accelerations and deflections under a sweep, cycle by cycle.

    The system first follows a steady sine of the sweep's level at its start frequency until its amplitudes have settled, so
    that the envelope begins on the response and not on the transient of switching on. Then it follows the sweep through its
    complete cycles; an incomplete last cycle is not run, so that the final state stands at phase 0 and a sweep in the other
    direction may start from it. A sweep lags behind the steady response by about rate ln 2 / 60 times the decay time of
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
        accuracy: error of samples and peaks allowed in short trial runs along the sweep, relative to the peaks.
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
    with Collector(system, direction=sweep.direction, out=out) as collector:
        step = chosen_step(system, sweep, start, duration=float(instants[-1]), timestep=timestep, accuracy=accuracy)
        warnings: list[str] = []
        if wait is not None:
            level = acceleration_of(sweep.quantity, sweep.amplitude, sweep.start)
            sine = Sine(frequency=sweep.start, acceleration=level, direction=sweep.direction)
            lead = settle(system, sine, start, timestep=step.timestep, settled=wait, largest_cycles=most)
            collector.count(lead.steps, lead.largest_step)
            start = lead.state
            if not lead.settled:
                warnings.append(
                    f"amplitudes at the start frequency of {sweep.start:.5g} Hz were {lead.remaining:.2g} from their limits "
                    f"after {lead.cycles} cycles, not {wait:.2g}."
                )
        start = at_start(system, sweep, start)
        with stepping(system, sweep, start, step.timestep) as stepped, share_bar("sweeping", "Hz", enabled=progress) as update:
            for first in range(0, instants.size - 1, CHUNK):
                ends = instants[first : first + CHUNK + 1]
                extremes = stepped.run(ends)
                frequency = sweep.frequency((ends[:-1] + ends[1:]) / 2.0)
                collector.add(frequency, extremes.minimum, extremes.maximum, cycles=1, remaining=math.nan, settled=False)
                update(float(ends[-1] / instants[-1]), float(frequency[-1]))
            collector.count(stepped.steps, stepped.largest_step)
            final = stepped.finish()
        result = collector.finish(
            {
                "payload": payload, "response_direction": along, "estimated_error": step.error,
                "excitation": sweep.to_dict(),
            },
            initial_state=start, final_state=final, warnings=warnings,
        )  # fmt: skip
    if timestep is not None:
        _judge_step(system, result, sweep.direction)
    return result


def check_cycles(sweep: Sweep, timestep: float | None) -> None:
    """Raise BudgetError if the cycles of a sweep take too much memory or time."""
    cycles = abs(float(sweep.course.phase(np.array([sweep.duration]))[0])) / (2.0 * math.pi)
    what = f"a sweep of {sweep.duration:.4g} s"
    remedy = "Sweep faster (a larger `rate`), or over a narrower range."
    require_memory(f"{what}, {cycles:.3g} cycles,", cycles * CYCLE, remedy)
    require_time(what, max(STEPS_PER_CYCLE * cycles, sweep.duration / (timestep or math.inf)), remedy)


def stepped_sine(
    system: System, *, frequencies: ArrayLike, direction: str | Sequence[float], payload: str,
    acceleration: float | None = None, velocity: float | None = None, displacement: float | None = None,
    response_direction: str | Sequence[float] | None = None, settled: float = 1e-4, largest_cycles: int = 1000,
    history: History = "relaxed", initial: State | None = None, timestep: float | None = None, accuracy: float = 1e-4,
    out: str | Path | None = None, progress: bool = False,
) -> FrequencySweep:  # fmt: skip
    """Compute the settled amplitudes at one frequency after the other, each from the final state of the frequency before.

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
        accuracy: error of samples and peaks allowed in short trial runs over the frequencies, relative to the peaks.
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
    values = np.atleast_1d(np.asarray(frequencies, dtype=float))
    if values.ndim != 1 or not values.size:
        raise ValueError(f"`frequencies` must be a series of numbers, got shape {values.shape}.")
    sines = []
    for number, value in enumerate(values.tolist()):
        f = positive(f"frequencies[{number}]", value)
        sines.append(Sine(frequency=f, acceleration=acceleration_of(quantity, level, f), direction=base))
    check_direction(system, sines[0])
    require_payload(system, payload)
    along = response_axis(response_direction, base)
    tolerance, most = positive("settled", settled), integer("largest_cycles", largest_cycles, least=1)
    start = starting_state(system, history=history, initial=initial)
    # A step is chosen along a motion over all frequencies.
    low, high = min(sine.frequency for sine in sines), max(sine.frequency for sine in sines)
    rate = 60.0 / PILOT * float(np.log2(high / low))
    pilot: Sine | Sweep = sines[0]
    if low < high:
        pilot = Sweep(start=low, stop=high, rate=rate, direction=base, **{quantity: level})
    with Collector(system, direction=base, out=out) as collector, share_bar("stepping", "Hz", enabled=progress) as update:
        step = chosen_step(system, pilot, start, duration=PILOT, timestep=timestep, accuracy=accuracy)
        steps = sum(max(STEPS_PER_CYCLE, 1.0 / (sine.frequency * step.timestep)) for sine in sines)
        remedy = "Take fewer `frequencies`, or a larger `timestep`."
        require_time(f"a cycle at each of {len(sines)} frequencies", steps, remedy)
        state = start = at_start(system, sines[0], start)
        unsettled: list[str] = []
        for number, sine in enumerate(sines):
            steady = settle(system, sine, state, timestep=step.timestep, settled=tolerance, largest_cycles=most)
            state = steady.state
            collector.count(steady.steps, steady.largest_step)
            collector.add(
                np.array([sine.frequency]), steady.minimum[np.newaxis], steady.maximum[np.newaxis], cycles=steady.cycles,
                remaining=steady.remaining, settled=steady.settled,
            )  # fmt: skip
            if not steady.settled:
                unsettled.append(f"{sine.frequency:.5g} Hz ({steady.remaining:.2g})")
            update((number + 1) / len(sines), sine.frequency)
        warning = f"not settled to {tolerance:.2g} after {most} cycles (estimated distance from the limit): "
        result = collector.finish(
            {
                "payload": payload, "response_direction": along, "estimated_error": step.error,
                "excitation": {"kind": KIND, quantity: level, "direction": plain_direction(base)},
            },
            initial_state=start, final_state=state, warnings=[f"{warning}{', '.join(unsettled)}."] if unsettled else [],
        )  # fmt: skip
    if timestep is not None:
        _judge_step(system, result, base)
    return result


def _judge_step(system: System, sweep: FrequencySweep, direction: Direction) -> None:
    """Warn of a given step that is too long for friction at the frequency at which it yields most."""
    travel = np.stack([mount.maximum - mount.minimum for mount in sweep.mounts.values()], axis=1)
    decays = sweep.timestep * math.pi * sweep.frequency * (yield_rates(system) * travel).max(axis=(1, 2))
    cycle = int(np.argmax(decays))
    frequency = float(sweep.frequency[cycle])
    sine = Sine(frequency=frequency, acceleration=float(sweep.base_amplitude[cycle]), direction=direction)
    error = error_of_given(
        system, sine, at_start(system, sine, sweep.initial_state), decay=float(decays[cycle]), timestep=sweep.timestep,
        duration=PILOT, sample_rate=SAMPLES_PER_CYCLE * frequency,
    )  # fmt: skip
    warn_of_given_step(sweep.timestep, error, stacklevel=4)
