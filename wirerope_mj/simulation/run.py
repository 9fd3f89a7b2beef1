"""Stepping a system through a time grid: the one loop of every simulation."""

import copy
from collections.abc import Callable
from dataclasses import dataclass

import mujoco
import numpy as np
import numpy.typing as npt

from wirerope_mj.control import installed
from wirerope_mj.control import layout as at
from wirerope_mj.control.install import Kind
from wirerope_mj.errors import SimulationError
from wirerope_mj.excitation import BaseMotion
from wirerope_mj.response.peaks import BodyPeaks, MountPeaks, Peak, Peaks, PointPeaks
from wirerope_mj.response.response import State
from wirerope_mj.simulation.grid import SAME_TIME, Grid, StageTables
from wirerope_mj.system import System

Array = npt.NDArray[np.float64]

CHECK_EVERY = 64
"""Pieces between two looks at MuJoCo's warning counters."""

STATE = mujoco.mjtState.mjSTATE_INTEGRATION


@dataclass(frozen=True, kw_only=True)
class Run:
    """What stepping leaves behind: final state, peaks, the callback that made the forces, and whether bodies touched."""

    final_state: State
    peaks: Peaks
    callback: Kind
    touches: bool


def run(
    system: System,
    motion: BaseMotion,
    grid: Grid,
    initial: State,
    *,
    callback: Kind,
    sink: Callable[[int, Array], None],
    progress: Callable[[float], None] | None = None,
) -> Run:
    """Step `system` through `grid` from `initial` and hand every sample to `sink`.

    Args:
        system: the system; its model is copied, so that one system serves several threads.
        motion: base motion.
        grid: pieces of equal steps.
        initial: state at the grid's start.
        callback: "native" or "python".
        sink: called with the sample's number and the system's sensor values; it must copy them.
        progress: called with the simulated time [s] now and then.

    Raises:
        SimulationError: MuJoCo warned that the state is not valid any more.
    """
    model, data = copy.copy(system.model), mujoco.MjData(system.model)
    mujoco.mj_setState(model, data, initial.values, STATE)
    assembly = system.assembly
    w = assembly.userdata
    user = data.userdata[w : w + assembly.tables.user.size]
    user[at.OBSERVING], user[at.HISTORY], user[at.EVENT] = 1.0, 0.0, at.SMOOTH
    values = data.sensordata[assembly.sensor :]
    jumps = _velocity_jumps(motion, assembly.tables.drive)
    dofs = list(assembly.driven_dofs)
    warnings_before = _warning_counts(data)
    sample, touches = 0, False
    tables = StageTables(grid, motion)
    with installed(model, data, callback) as kind:
        for piece, accelerations in tables:
            start, stop, steps = grid.start[piece], grid.stop[piece], int(grid.steps[piece])
            event = grid.event[piece]
            if event == at.JUMP:
                data.qvel[dofs] += _jump_at(jumps, start)
            user[at.EVENT] = event
            user[at.STAGE_POINTS], user[at.STAGE_START] = accelerations.shape[0], start
            user[at.STAGE_RATE] = 2.0 * steps / (stop - start)
            user[at.STAGES : at.STAGES + accelerations.size] = accelerations.ravel()
            data.time = start  # so that rounding does not add up over the steps
            model.opt.timestep = (stop - start) / steps
            if grid.sampled[piece]:
                mujoco.mj_step(model, data)
                sink(sample, values)
                sample += 1
                steps -= 1
                touches |= data.ncon > 0
            if steps:
                mujoco.mj_step(model, data, nstep=steps)
            if piece % CHECK_EVERY == 0:
                _check(system, data, warnings_before)
                if progress is not None:
                    progress(float(stop))
        _check(system, data, warnings_before)
        if grid.stop.size:
            data.time = grid.stop[-1]
        final = _state(model, data, user)
        _finish(model, data, user, motion)
        if sample < grid.sample_times.size:
            sink(sample, values)
        _check(system, data, warnings_before)
    if progress is not None and grid.stop.size:
        progress(float(grid.stop[-1]))
    return Run(final_state=final, peaks=_peaks(system, user, tables.peak), callback=kind, touches=touches)


def _finish(model: mujoco.MjModel, data: mujoco.MjData, user: Array, motion: BaseMotion) -> None:
    """Observe the last instant: one forward pass with the acceleration just before it."""
    user[at.STAGE_POINTS], user[at.STAGE_START], user[at.STAGE_RATE] = 1.0, data.time, 0.0
    user[at.STAGES : at.STAGES + 3] = motion.acceleration(np.array([max(data.time - SAME_TIME, 0.0)]))[0]
    mujoco.mj_forward(model, data)


def _state(model: mujoco.MjModel, data: mujoco.MjData, user: Array) -> State:
    """Return the integration state without what belongs to this run alone."""
    kept = user[: at.STAGES + 3 * (2 * at.MAX_STEPS + 1)].copy()
    user[: kept.size] = 0.0
    values = np.empty(mujoco.mj_stateSize(model, STATE))
    mujoco.mj_getState(model, data, values, STATE)
    user[: kept.size] = kept
    return State(values=values, time=float(data.time))


def _velocity_jumps(motion: BaseMotion, drive: Array) -> list[tuple[float, Array]]:
    return [(time, drive @ jump) for time, jump in motion.velocity_jumps]


def _jump_at(jumps: list[tuple[float, Array]], time: float) -> Array:
    return np.sum([jump for instant, jump in jumps if abs(instant - time) <= SAME_TIME], axis=0)


def _warning_counts(data: mujoco.MjData) -> list[int]:
    return [int(warning.number) for warning in data.warning]


_REMEDIES = {
    "mjWARN_BADQACC": "the motion grew without bound; use a smaller `timestep`, and check masses, stops and mount loads",
    "mjWARN_BADQPOS": "the motion grew without bound; use a smaller `timestep`, and check masses, stops and mount loads",
    "mjWARN_BADQVEL": "the motion grew without bound; use a smaller `timestep`, and check masses, stops and mount loads",
    "mjWARN_BADCTRL": "a control is not finite or above 1e10; check what writes `ctrl`",
    "mjWARN_CNSTRFULL": "there are more contacts than memory; raise <size memory=...> in the model",
    "mjWARN_CONTACTFULL": "there are more contacts than memory; raise <size memory=...> in the model",
    "mjWARN_INERTIA": "a mass or inertia is close to zero; check the model's masses",
}


def _check(system: System, data: mujoco.MjData, before: list[int]) -> None:
    """Raise SimulationError if one of MuJoCo's warning counters rose."""
    for kind, (warning, count) in enumerate(zip(data.warning, before, strict=True)):
        if warning.number > count:
            name = mujoco.mjtWarning(kind).name
            remedy = _REMEDIES.get(name, "see MuJoCo's documentation of this warning")
            raise SimulationError(
                f"at t = {data.time:.6g} s MuJoCo reported {name.removeprefix('mjWARN_')} for "
                f"{_culprit(system, data)}: {remedy}."
            )


def _culprit(system: System, data: mujoco.MjData) -> str:
    """Return words for the body whose acceleration is the least credible."""
    model = system.model
    acceleration = np.nan_to_num(np.abs(data.qacc), nan=np.inf, posinf=np.inf)
    body = int(model.dof_bodyid[int(np.argmax(acceleration))])
    return f"body {model.body(body).name!r}"


def _peaks(system: System, user: Array, base: Peak) -> Peaks:
    """Return the peaks from the tracker's memory; what is fixed to the base has the base's own."""
    model, assembly = system.model, system.assembly
    first = assembly.tables.user.channels
    memory = user[first : first + at.CHANNEL_MEMORY * assembly.tables.user.n_channels].reshape(-1, at.CHANNEL_MEMORY)
    rigid = set(assembly.tables.base_channels)
    channels = iter([base if number in rigid else _peak(row) for number, row in enumerate(memory)])
    bodies = {model.body(body).name: BodyPeaks(acceleration=next(channels)) for body in assembly.subjects.bodies}
    points = {
        point_name(model, site): PointPeaks(acceleration=next(channels), relative_displacement=next(channels))
        for site in assembly.subjects.points
    }
    mounts = {name: MountPeaks(deflection=next(channels), force=next(channels)) for name in system.mounts}
    return Peaks(bodies=bodies, points=points, mounts=mounts)


def _peak(row: Array) -> Peak:
    vector = lambda place: row[place : place + 3].copy()  # noqa: E731
    return Peak(
        value=float(row[at.PEAK]),
        time=float(row[at.PEAK_TIME]),
        vector=vector(at.PEAK_VECTOR),
        minimum=vector(at.LOW),
        minimum_time=vector(at.LOW_TIME),
        maximum=vector(at.HIGH),
        maximum_time=vector(at.HIGH_TIME),
    )


def point_name(model: mujoco.MjModel, site: int) -> str:
    """Return the name of the point that a site `point/NAME` declares, prefixes of an attached model included."""
    return model.site(site).name.replace("point/", "", 1)
