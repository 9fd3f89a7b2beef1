"""Many variants of one system, each with its own base motion and start, side by side on several threads."""

import math
import os
import warnings
from collections.abc import Sequence
from concurrent.futures import ThreadPoolExecutor
from dataclasses import dataclass, replace
from functools import cache
from typing import Any

import mujoco
import numpy as np

from wirerope_mj.engine.control import installed
from wirerope_mj.engine.control.install import check_callbacks
from wirerope_mj.engine.flexible import Panel
from wirerope_mj.engine.flexible.panel import NAME
from wirerope_mj.engine.response.peaks import Peaks
from wirerope_mj.engine.response.response import Response
from wirerope_mj.engine.simulation.engines import Engine, refusal_message, run_in_lanes, unsupported_run
from wirerope_mj.engine.simulation.grid import TimeGrid, merge_instants, time_grid
from wirerope_mj.engine.simulation.recorder import Recorder
from wirerope_mj.engine.simulation.run import (
    RunResult,
    require_lawful,
    run,
    warn_of_aliasing,
    warn_of_given_step,
    warn_of_missing_modes,
)
from wirerope_mj.engine.simulation.simulate import (
    check_arguments,
    check_direction,
    check_size,
    checked_corners,
    checked_step,
    numerics_of,
)
from wirerope_mj.engine.simulation.stability import decay_over_step, stable_step
from wirerope_mj.engine.simulation.stepper import initial_state
from wirerope_mj.engine.simulation.timestep import error_of_given, limit_of_given
from wirerope_mj.engine.statics.linear import soft_equalities
from wirerope_mj.engine.system import System, on_deck, varied
from wirerope_mj.foundation.arguments import integer, one_of
from wirerope_mj.foundation.arrays import Array
from wirerope_mj.foundation.errors import ModelError, ModelWarning, SimulationError, WireRopeError
from wirerope_mj.foundation.state import State
from wirerope_mj.foundation.summary import Brief
from wirerope_mj.motions import BaseMotion


@dataclass(frozen=True, kw_only=True, repr=False)
class BatchResult(Brief):
    """Result of one variant of a batch that was simulated to its end."""

    peaks: Peaks  #: peaks over every step
    #: initial_state, final_state: states at the start and at the end
    initial_state: State
    final_state: State
    timestep: float  #: largest step [s]
    steps: int  #: number of steps
    engine: str = "mujoco"  #: "kernel" or "mujoco"
    why: str = ""  #: why it was not the kernel
    response: Response | None = None  #: the whole response, if it was asked for


@dataclass(frozen=True, kw_only=True)
class BatchFailure:
    """Failure of a variant: `error` is what `simulate` raises for it."""

    error: WireRopeError

    @property
    def message(self) -> str:
        """Message of the error."""
        return str(self.error)


@dataclass(frozen=True, kw_only=True)
class _Variant:
    """A variant of a batch: its number, system, base motion and start state."""

    number: int
    system: System
    motion: BaseMotion
    start: State


def simulate_batch(
    systems: System | Sequence[System], motions: BaseMotion | Sequence[BaseMotion], *, duration: float, timestep: float,
    initial: str | State | Sequence[str | State] = "settled", sample_rate: float = 1000.0,
    corners: Sequence[float] | Array = (), threads: int | None = None, responses: bool = False, engine: Engine = "auto",
    judged: bool = True,
) -> list[BatchResult | BatchFailure]:  # fmt: skip
    """Simulate many variants of one layout and return their peaks, in order; samples are kept only on request.

    All variants take the same steps: the corners of every motion end steps of all. Each is bit for bit what `simulate` returns
    alone with `timestep` and with the corners of all motions as its `corners`, whatever the number of threads.
    A variant that fails does not stop the others.

    Args:
        systems: systems that differ in numbers only (laws and their parameters, masses, positions); one for all variants.
        motions: base motions; one for all variants.
        duration: simulated time [s].
        timestep: largest step [s].
        initial: as `simulate` takes it; one for all variants. States must be of one instant.
        sample_rate: steps end at k / sample_rate [Hz], as those of `simulate` do at its samples. A lower rate lets more
            steps be taken at once.
        corners: instants [s] at which steps end besides the motions' own corners: give those of all motions of a study, so
            that the results do not depend on which variants share a batch.
        threads: number of threads; None for one per processor.
        responses: whether whole responses are kept, too: in memory, those of all variants at once.
        engine: as `simulate` takes it, for each variant by itself.
        judged: whether warnings are given, a step that is too long for friction being looked for by one more run.

    Raises:
        ValueError: an argument is out of range.
        ModelError: the systems are not of one layout.

    Warns:
        AccuracyWarning: `timestep` is too long for friction that yields within it; by the variant in which it yields most.
        ModelWarning: an equality constraint of the first system gives way.
    """
    check_callbacks()
    check_arguments(duration=duration, timestep=timestep, sample_rate=sample_rate)
    threads = (os.cpu_count() or 1) if threads is None else integer("threads", threads, least=1)
    systems, motions, starts = _variants(systems, motions, initial)
    if not systems:
        return []
    one_of("engine", engine, ("auto", "mujoco", "kernel"))
    _check_same_layout(systems)
    samples = len(systems) * duration if responses else 0.0  # of all that are kept at once
    check_size(systems[0], duration=duration, sample_rate=sample_rate, timestep=timestep, kept=samples)
    results: dict[int, BatchResult | BatchFailure] = {}
    variants = []
    step = cache(lambda system: checked_step(system, timestep, duration))
    for number, (system, motion, start) in enumerate(zip(systems, motions, starts, strict=True)):
        try:
            check_direction(system, motion)
            state = initial_state(system, motion, start)
            step(system)
            variants.append(_Variant(number=number, system=system, motion=motion, start=state))
        except WireRopeError as error:
            results[number] = BatchFailure(error=error)
    if variants:
        first, last = min(v.start.time for v in variants), max(v.start.time for v in variants)
        if first != last:
            raise ValueError(f"`initial` states must be of one instant, got {first:.6g} s and {last:.6g} s.")
        # Motions that are variants of one share their corners.
        own_corners = {motion.corners.tobytes(): motion.corners for motion in {id(each): each for each in motions}.values()}
        grid = time_grid(
            start=first, duration=duration, sample_rate=sample_rate, timestep=timestep,
            motion=motions[0], corners=merge_instants(checked_corners(corners), *own_corners.values()),
        )  # fmt: skip
        results |= _together(variants, grid, threads, responses, engine)
        if judged:
            warn_of_missing_modes(systems[0], {id(motion): motion for motion in motions}.values())
            for text in soft_equalities(systems[0]):
                warnings.warn(text, ModelWarning, stacklevel=2)
            came = [(outcome, v) for v in variants if isinstance(outcome := results[v.number], BatchResult)]
            if decays := [decay_over_step(variant.system, result.peaks, result.timestep) for result, variant in came]:
                worst = came[int(np.argmax(decays))][1]  # in which friction yields most within a step
                error_of_step = error_of_given(
                    worst.system, worst.motion, worst.start, decay=max(decays), timestep=timestep, duration=duration,
                    sample_rate=sample_rate, engine=engine,
                )  # fmt: skip
                warn_of_given_step(timestep, error_of_step)
    if responses:
        warn_of_aliasing({id(motion): motion for motion in motions}.values(), sample_rate)
    return [results[number] for number in range(len(systems))]


def _check_same_layout(systems: Sequence[System]) -> None:
    """Raise ModelError if a system differs from the first in more than the numbers of its model."""

    def layout(system: System) -> dict[str, object]:
        sizes = ("nq", "nv", "na", "nbody", "njnt", "ngeom", "nsite", "nuserdata")
        return {
            **{size: getattr(system.model, size) for size in sizes}, "subjects": system.assembly.subjects,
            "mounts": list(system.mounts), "drive": system.assembly.tables.drive.tolist(),
        }  # fmt: skip

    first = layout(systems[0])
    for number, system in enumerate(systems):
        differs = [part for part, value in layout(system).items() if value != first[part]] if system is not systems[0] else []
        if differs:
            raise ModelError(
                f"`systems[{number}]` has another layout than `systems[0]` ({', '.join(differs)} differ): the systems of a "
                "batch have the same bodies, joints, geoms, mounts and internal states. Give each layout a batch of its own."
            )


def _variants(
    systems: System | Sequence[System], motions: BaseMotion | Sequence[BaseMotion], initial: str | State | Sequence[str | State]
) -> tuple[list[System], list[BaseMotion], list[str | State]]:
    """Return one system, motion and start for each variant."""
    arguments: dict[str, list[Any]] = {
        "systems": [systems] if isinstance(systems, System) else list(systems),
        "motions": [motions] if isinstance(motions, BaseMotion) else list(motions),
        "initial": [initial] if isinstance(initial, str | State) else list(initial),
    }
    several = {name: len(values) for name, values in arguments.items() if len(values) != 1}
    if len(set(several.values())) > 1:
        raise ValueError(f"`systems`, `motions` and `initial` must hold one each or equally many, got {several}.")
    size = min(several.values(), default=1)
    systems, motions, initial = (values if len(values) == size else values * size for values in arguments.values())
    return systems, motions, initial


def _together(
    variants: Sequence[_Variant], grid: TimeGrid, threads: int, responses: bool, engine: Engine
) -> dict[int, BatchResult | BatchFailure]:
    """Step variants through one time grid, by the kernel or else by MuJoCo, and return results by variant number."""
    asked = "it was asked for" if engine == "mujoco" else ""
    why = {v.number: asked or unsupported_run(v.system, v.motion) for v in variants}
    results: dict[int, BatchResult | BatchFailure] = {}
    if fit := [variant for variant in variants if not why[variant.number]]:
        done, gave_up = _in_lanes(fit, grid, threads, responses)
        results, why = results | done, why | gave_up
    rest = [variant for variant in variants if variant.number not in results]
    if engine == "kernel":
        return results | {v.number: BatchFailure(error=SimulationError(refusal_message(why[v.number]))) for v in rest}
    return results | (_by_mujoco(rest, grid, threads, responses, why) if rest else {})


def _in_lanes(
    variants: Sequence[_Variant], grid: TimeGrid, threads: int, responses: bool
) -> tuple[dict[int, BatchResult | BatchFailure], dict[int, str]]:
    """Compute variants by the kernel; returns results, and for variants that it gave up the reasons, by variant number."""
    recorders = [Recorder(variant.system, variant.motion, grid, None) for variant in variants] if responses else []
    done = run_in_lanes(
        [v.system for v in variants], [v.motion for v in variants], [v.start for v in variants], grid, threads=threads,
        sink=(lambda index, first, rows: recorders[index].add(first, rows)) if responses else None,
    )  # fmt: skip
    results: dict[int, BatchResult | BatchFailure] = {}
    gave_up: dict[int, str] = {}
    for index, (variant, ended) in enumerate(zip(variants, done, strict=True)):
        if isinstance(ended, RunResult):
            results[variant.number] = _result(variant, grid, ended, recorders[index] if responses else None)
        else:
            gave_up[variant.number] = ended
    return results, gave_up


def _by_mujoco(
    variants: Sequence[_Variant], grid: TimeGrid, threads: int, responses: bool, why: dict[int, str]
) -> dict[int, BatchResult | BatchFailure]:
    """Compute variants one by one with MuJoCo through one grid; returns results by number."""

    def compute(variant: _Variant) -> BatchResult | BatchFailure:
        recorder = Recorder(variant.system, variant.motion, grid, None) if responses else None
        own_grid, sink = replace(grid, motion=variant.motion), recorder.add if recorder is not None else None
        try:
            done = run(variant.system, variant.motion, own_grid, variant.start, callback=kind, sink=sink)
        except WireRopeError as error:
            return BatchFailure(error=error)
        return _result(variant, grid, replace(done, why=why[variant.number]), recorder)

    model = variants[0].system.model
    with installed(model, mujoco.MjData(model)) as kind, ThreadPoolExecutor(threads) as pool:
        # one thread at a time may be in the interpreter's callbacks
        step = pool.map if threads > 1 and kind == "native" else map
        return {variant.number: result for variant, result in zip(variants, step(compute, variants), strict=True)}


def _result(variant: _Variant, grid: TimeGrid, done: RunResult, kept: Recorder | None) -> BatchResult | BatchFailure:
    """Make the result of a variant that ran to its end; a failure if a mount left the range of its law."""
    try:
        require_lawful(variant.system, done.peaks)
    except SimulationError as error:
        return BatchFailure(error=error)
    response = None
    if kept is not None:
        limit, none = limit_of_given(grid.timestep, grid.sample_rate), math.nan
        numerics = numerics_of(variant.system, variant.motion, done, accuracy=none, error=none, limited_by=limit)
        response = kept.finish(variant.start, done.final_state, done.peaks, numerics)
    return BatchResult(
        peaks=done.peaks, initial_state=variant.start, final_state=done.final_state, timestep=done.largest_step,
        steps=done.steps, engine=done.engine, why=done.why, response=response,
    )  # fmt: skip


def peaks_on_decks(
    system: System, motion: BaseMotion, panels: Sequence[Panel], *, duration: float, timestep: float, initial: str,
    sample_rate: float,
) -> list[Peaks | str]:  # fmt: skip
    """Simulate a system on deck panels that differ in frequency alone; returns the peaks on each, or the message of its error.

    `timestep` is that of the run on the rigid deck, and is shortened where a panel needs it.
    """
    first = on_deck(system, panels[0])
    systems = [varied(first, tunings={NAME: panel.frequency / panels[0].frequency}) for panel in panels]
    step = min(timestep, *map(stable_step, systems))
    results = simulate_batch(
        systems, motion, duration=duration, timestep=step, initial=initial, sample_rate=sample_rate, threads=1, judged=False
    )
    return [result.peaks if isinstance(result, BatchResult) else result.message for result in results]
