"""System + base motion -> Response."""

import math
import warnings
from collections.abc import Sequence
from functools import cache
from pathlib import Path

import numpy as np

from wirerope_mj.engine.control.install import Kind
from wirerope_mj.engine.response.histories import Numerics
from wirerope_mj.engine.response.response import FILE, Response
from wirerope_mj.engine.simulation.engines import Engine, compute
from wirerope_mj.engine.simulation.grid import time_grid
from wirerope_mj.engine.simulation.progress import share_bar
from wirerope_mj.engine.simulation.recorder import Recorder, column_plan
from wirerope_mj.engine.simulation.run import (
    RunResult,
    require_lawful,
    warn_of_aliasing,
    warn_of_missing_modes,
    warn_of_uncertainty,
)
from wirerope_mj.engine.simulation.stability import decay_over_step, slowest_period, stable_step
from wirerope_mj.engine.simulation.stepper import initial_state
from wirerope_mj.engine.simulation.timestep import ChosenStep, choose_timestep, error_of_given, limit_of_given
from wirerope_mj.engine.statics.linear import soft_equalities
from wirerope_mj.engine.system import System
from wirerope_mj.foundation.arguments import positive
from wirerope_mj.foundation.arrays import Array
from wirerope_mj.foundation.budget import require_disk, require_memory, require_time
from wirerope_mj.foundation.errors import ModelError, ModelWarning, RecordError, SimulationError
from wirerope_mj.foundation.plain_text import quoted
from wirerope_mj.foundation.resources import version_of
from wirerope_mj.foundation.state import State
from wirerope_mj.motions import BaseMotion, Sweep

NUMBER = 8  # bytes of a number
# bytes of memory that every sample takes where it is streamed: its instant, its number, and one column that is looked at
OF_AN_INSTANT = 4 * NUMBER
FINEST = 1e-15  # accuracy that can be asked for: the rounding of one number
SHORTEST = 1e-12  # simulated time [s] below which steps vanish beside their instants
# steps of a run at the most: hours of computing, and far beyond where rounding outweighs the error of a step
MOST_STEPS = 1e9
# periods of the slowest mode that are simulated after the motion: at a damping ratio of a tenth a five-hundredth is left
RING_DOWN = 10.0


def simulate(
    system: System, motion: BaseMotion, *, duration: float, initial: str | State | None = None, timestep: float | None = None,
    accuracy: float = 1e-4, sample_rate: float = 1000.0, corners: Sequence[float] | Array = (), callback: Kind = "native",
    engine: Engine = "auto", out: str | Path | None = None, progress: bool = False, estimate: bool = True,
    longest: float = math.inf,
) -> Response:  # fmt: skip
    """Return the response of `system` to a base motion.

    Args:
        system: the system.
        motion: base motion; every component needs a driven slide of the base, a rotation the hinges of
            `wirerope_mj.with_rotation`.
        duration: simulated time [s].
        initial: "settled" (equilibrium under gravity on the virgin path), "relaxed" (equilibrium after long vibration, see
            `wirerope_mj.equilibrium`), "unloaded" (modelled geometry at rest relative to the base), or a State, from whose
            instant the simulation goes on; None is "settled", and "unloaded" where the base falls.
        timestep: largest step [s]; None chooses it before the run for `accuracy`.
        accuracy: error of samples and refined peaks allowed, relative to the peaks; used if `timestep` is None.
        sample_rate: samples per second [Hz], at k / sample_rate.
        corners: instants [s] at which steps end besides the motion's own corners, as the variants of a batch share theirs.
        callback: "native", or "python"; of MuJoCo.
        engine: "auto" (the kernel, see `wirerope_mj.engine.kernel`, where its equations hold, else MuJoCo), "mujoco" or
            "kernel"; `numerics.engine` says who computed it, and `numerics.why` why it was not the kernel.
        out: folder to which samples are streamed as `response.parquet`; the response then reads them when asked.
        progress: whether a progress bar is shown on standard error.
        longest: time of computing [s] after which no finer step is tried.
        estimate: whether the error of a given `timestep` is estimated, which takes another run.

    Raises:
        ValueError: an argument is out of range.
        ModelError: the motion needs a slide that the base does not have.
        RecordError: `out` already holds a response, which an open `Response` may be reading.
        BudgetError: the samples take more memory or disk, or the steps more time, than there is, or than `longest`.
        SimulationError: the step is too large, a mount went to where its law does not hold, or the engine reported that the
            state is not valid any more.
        ConvergenceError: there is no equilibrium to start from.

    Warns:
        AccuracyWarning: the estimated error is above `accuracy`, contacts were struck, or samples or a deck's modes are too few
            for the motion.
        ModelWarning: an equality constraint gives way.
    """
    check_arguments(duration=duration, sample_rate=sample_rate, accuracy=accuracy, timestep=timestep)
    if timestep is None and (accuracy is None or accuracy < FINEST):
        raise ValueError(f"`accuracy` must be at least {FINEST:.0e}, got {accuracy}: rounding hides what is finer.")
    check_direction(system, motion)
    instants = checked_corners(corners)
    if out is not None and (Path(out) / FILE).exists():
        raise RecordError(f"{out}: a response stands here already; give another `out`, or remove {FILE}.")
    folder = Path(out) if out is not None else None
    check_size(system, duration=duration, sample_rate=sample_rate, timestep=timestep, out=folder)
    start = initial_state(system, motion, initial)
    if timestep is None:
        with share_bar("choosing the step", f"of {duration:.4g} s", enabled=progress) as update:
            step = choose_timestep(
                system, motion, start, duration=duration, sample_rate=sample_rate, accuracy=accuracy, engine=engine,
                longest=longest, progress=lambda fraction, run: update(fraction, 0.0, run),
            )  # fmt: skip
    else:
        stated_step = checked_step(system, timestep, duration)
        step = ChosenStep(timestep=stated_step, error=math.nan, limited_by=limit_of_given(timestep, sample_rate))
    grid = time_grid(
        start=start.time, duration=duration, sample_rate=sample_rate, timestep=step.timestep, motion=motion, corners=instants
    )
    recorder = Recorder(system, motion, grid, folder)
    try:
        if step.done is not None and callback == "native" and not instants.size:
            done, rows = step.done
            recorder.add(0, rows)
        else:
            size = NUMBER * grid.sample_times.size * len(column_plan(system).names)
            memory, disk = (size, 0) if folder is None else (0, size)
            with share_bar("simulating", f"of {grid.stop:.4g} s", enabled=progress, memory=memory, disk=disk) as update:
                done = compute(
                    system, motion, grid, start, engine=engine, callback=callback, sink=recorder.add,
                    progress=lambda now: update((now - grid.start) / (grid.stop - grid.start), now),
                )  # fmt: skip
        require_lawful(system, done.peaks)
        error = step.error or math.nan  # no difference at all tells nothing
        if timestep is not None and estimate:
            error = error_of_given(
                system, motion, start, decay=decay_over_step(system, done.peaks, done.largest_step),
                timestep=done.largest_step, duration=duration, sample_rate=sample_rate, engine=engine,
            )  # fmt: skip
        asked = accuracy if timestep is None else math.nan
        numerics = numerics_of(system, motion, done, accuracy=asked, error=error, limited_by=step.limited_by)
        response = recorder.finish(start, done.final_state, done.peaks, numerics)
    except BaseException:
        recorder.discard()
        raise
    warn_of_uncertainty(response)
    warn_of_aliasing([motion], sample_rate)
    warn_of_missing_modes(system, [motion])
    for text in soft_equalities(system):
        warnings.warn(text, ModelWarning, stacklevel=2)
    return response


def check_size(
    system: System, *, duration: float, sample_rate: float, timestep: float | None = None, kept: float | None = None,
    out: Path | None = None,
) -> None:  # fmt: skip
    """Raise BudgetError if a run needs more memory, disk or time than is available.

    `kept` is the time whose samples are kept in memory [s], of several runs together (None: the duration); `out` the folder
    to which they are streamed instead.
    """
    samples, columns = duration * sample_rate, len(column_plan(system).names)
    asked = f"{duration:.4g} s with {sample_rate:.4g} samples a second"
    less = "Use a lower `sample_rate` or a shorter `duration`"
    require_time(f"a run of {asked}", max(samples, duration / timestep if timestep else 0.0), f"{less}.")
    subject, size = f"the samples of this run, {asked} and {columns} columns,", NUMBER * columns
    if out is None:
        kept_samples = samples if kept is None else kept * sample_rate
        require_memory(subject, kept_samples * size, f"{less}, or stream them to a folder (`out`).")
    else:
        require_disk(subject, samples * size, out, f"{less}, or write to another disk.")
    require_memory(f"the instants of this run, {asked},", samples * OF_AN_INSTANT, f"{less}.")


@cache
def versions() -> dict[str, str]:
    """Return the versions of the packages that compute a response, read once: that takes half as long as a short run."""
    return {name: version_of(name) for name in ("wirerope-mj", "mujoco", "numpy", "numba")}


def numerics_of(
    system: System, motion: BaseMotion, done: RunResult, *, accuracy: float, error: float, limited_by: str
) -> Numerics:
    """Describe how a run was computed."""
    return Numerics(
        timestep=done.largest_step, accuracy=accuracy, error_estimate=error, steps=done.steps, callback=done.callback,
        versions=dict(versions()), limited_by=limited_by, engine=done.engine, why=done.why,
        motion_end=motion.end if math.isfinite(motion.end) else math.nan, slowest_period=slowest_period(system),
    )  # fmt: skip


def check_arguments(**named: float | None) -> None:
    """Raise ValueError if a number is not positive, or a duration shorter than `SHORTEST`; None passes."""
    for name, value in named.items():
        if value is not None:
            positive(name, value)
            if name == "duration" and value < SHORTEST:
                raise ValueError(f"`duration` must be at least {SHORTEST:g} s, got {value!r}.")


def checked_corners(corners: Sequence[float] | Array) -> Array:
    """Return instants [s] sorted, or raise ValueError."""
    try:
        instants = np.asarray(corners, dtype=np.float64)
    except (TypeError, ValueError, OverflowError):
        instants = np.empty((0, 0))
    if instants.ndim != 1 or not np.isfinite(instants).all():
        raise ValueError(f"`corners` must be finite instants in seconds, got {quoted(corners)}.")
    return np.sort(instants)


def checked_step(system: System, timestep: float, duration: float) -> float:
    """Return the requested step, or raise SimulationError if RK4 is unstable with it or the run would never end."""
    if duration > MOST_STEPS * positive("timestep", timestep, unit="s"):
        raise SimulationError(
            f"`timestep` of {timestep:.3g} s makes {duration / timestep:.1e} steps of {duration:.4g} s; at most "
            f"{MOST_STEPS:.0e} are computed. Give a longer `timestep`, or None to have it chosen."
        )
    limit = stable_step(system)
    if timestep > limit:
        raise SimulationError(
            f"a step of {timestep:.4g} s is too large for the stiffest mount: RK4 is stable up to {limit:.4g} s here. "
            "Give a smaller `timestep`, or None to have it chosen."
        )
    return timestep


def check_direction(system: System, motion: BaseMotion) -> None:
    """Raise ModelError if a component of the motion has no driven slide, or a force of the motion has no site."""
    sites = system.assembly.subjects.force_names
    for site in motion.loaded_sites:
        if site not in sites:
            raise ModelError(
                f"a force acts at {site!r}, and the model has no site 'force/{site}' on what the mounts carry. Its sites for "
                f"forces: {', '.join(sites) or 'none'}; `wirerope new --forces TABLE` makes them."
            )
    base, drive = f"the base {system.base!r}" if system.base else "the base (the world)", system.assembly.tables.drive
    if motion.rotates and not system.assembly.tables.rotates:
        raise ModelError(
            f"the motion rotates {base}, which has no hinges that are driven: `wirerope_mj.with_rotation(system)` adds them."
        )
    if len(drive) == 3:
        return  # slides are independent: three follow any motion
    reach = np.linalg.pinv(drive) @ drive  # projector onto what the slides span
    for direction in motion.directions:
        missing = direction - reach @ direction
        if np.abs(missing).max() > 1e-9:
            axes = [f"{axis}" for axis, part in zip("xyz", missing, strict=True) if abs(part) > 1e-9]
            joints = [system.model.joint(int(system.model.dof_jntid[dof])).name for dof in system.assembly.driven_dofs]
            raise ModelError(
                f"the motion moves along {' and '.join(axes)}, but {base} has no driven slide there. "
                f"Its slides: {joints or 'none'}. Add one to the model, or change the motion's direction."
            )


# simulated time [s] that is questioned, and how many times it is the motion's: isolators rest within seconds, and who waits
# longer has a reason that a long motion shows
_LONG, _LONGER = 100.0, 20.0


# [s]: instant from which the begin of a motion is questioned, length below which a motion is a shock; fraction of its end by
# which rounding may cut it
_LATE, _SHOCK, _CUT = 5.0, 1.0, 1e-3


def _warn_of_cut(motion: BaseMotion, duration: float) -> None:
    """Warn of a motion that begins late, and of a shock that is not over when the simulation ends."""
    begins = motion.events[0][0] if motion.events else 0.0
    if _LATE < begins < duration:
        warnings.warn(
            f"nothing moves before {begins:g} s: was {begins:g} ms meant, {1e-3 * begins:g} s?", ModelWarning, stacklevel=3
        )
    for part in motion.parts:
        starts = part.events[0][0] if part.events else 0.0
        if not part.files and part.end - starts < _SHOCK and starts < duration < (1.0 - _CUT) * part.end:
            warnings.warn(
                f"`duration` of {duration:g} s ends within {part.description}, which goes on to {part.end:.4g} s, and before "
                "anything has swung out: leave it out, or give more.",
                ModelWarning, stacklevel=3,
            )  # fmt: skip


def duration_of(motion: BaseMotion, duration: float | None, system: System) -> float:
    """Return the simulated time [s]: as given, or ten periods of the slowest mode past the motion, or a sweep's end.

    A motion without an end, or that begins after the simulation, is a ValueError.
    """
    if duration is None:
        if not math.isfinite(motion.end):
            raise ValueError('this motion has no end: give `duration`, or say how long it lasts, as in "for 10 s".')
        # A sweep goes on at its last frequency, and is best cut there.
        sweeps = any(isinstance(part, Sweep) for part in motion.parts)
        duration = motion.end
        if not sweeps:
            duration = math.ceil(10.0 * (motion.end + RING_DOWN * slowest_period(system)) - 1e-6) / 10.0
    check_arguments(duration=duration)
    if max(_LONG, _LONGER * motion.end) < duration < 1e3 * _LONG and math.isfinite(motion.end):
        warnings.warn(
            f"`duration` of {duration:g} s goes on for {duration - motion.end:.4g} s after the motion: was {duration:g} ms "
            f"meant, {1e-3 * duration:g} s?",
            ModelWarning, stacklevel=2,
        )  # fmt: skip
    if motion.up is not None and duration <= motion.end:
        raise ValueError(f"`duration` {duration:g} ends the simulation before the base lands, at {motion.end:.4g} s.")
    if motion.events and duration <= motion.events[0][0]:
        raise ValueError(f"`duration` {duration:g} ends the simulation before anything begins, at {motion.events[0][0]:g} s.")
    _warn_of_cut(motion, duration)
    return duration
