"""Many systems of one layout through one time grid, side by side on several threads; what must be equal in all."""

from collections.abc import Callable, Sequence
from functools import cache, partial

import mujoco
import numpy as np
from mujoco.batch import MODEL_FIELDS, Batch
from mujoco.batch import SimulationError as BatchError

from wirerope_mj.engine.control import layout as at
from wirerope_mj.engine.control.install import STATE
from wirerope_mj.engine.simulation.grid import Grid, TimeGrid
from wirerope_mj.engine.simulation.run import CHECK_EVERY, RunResult, peaks_of
from wirerope_mj.engine.simulation.stages import Segment, Stages, StageTables, distinct_motions, events_key, loads_at
from wirerope_mj.engine.simulation.stepper import (
    Stepper,
    acceleration_before,
    base_before,
    leave_behind,
    side_by_side,
    velocity_jump,
)
from wirerope_mj.engine.system import System
from wirerope_mj.foundation.arrays import AnyArray, Array
from wirerope_mj.foundation.errors import ModelError, SimulationError
from wirerope_mj.foundation.state import State
from wirerope_mj.motions import BaseMotion

# beginnings of the names of fields that only name, describe or draw
_WORDS = ("name", "text", "tuple", "tex_", "skin_", "vis_")
_STEP = "opt.timestep"  # the option that belongs to the grid and not to a system
Sink = Callable[[int, Array], None]


def check_same_layout(systems: Sequence[System]) -> None:
    """Raise ModelError if one of the systems differs from the first in more than numbers of its model."""
    first = systems[0]
    sizes = _sizes_of(first.model)
    fixed = {name: getattr(first.model, name).tobytes() for name in _fixed()}
    for number, system in _distinct(systems):
        differs = [name for name, size in _sizes_of(system.model).items() if sizes[name] != size]
        differs += [name for name, content in fixed.items() if getattr(system.model, name).tobytes() != content]
        here, there = system.assembly, first.assembly
        parts = ("userdata", "activation", "sensor", "subjects")
        differs += [part for part in parts if getattr(here, part) != getattr(there, part)]
        differs += ["mounts"] if list(system.mounts) != list(first.mounts) else []
        differs += ["drive"] if not np.array_equal(here.tables.drive, there.tables.drive) else []
        if differs:
            raise ModelError(
                f"`systems[{number}]` has another layout than `systems[0]` ({', '.join(differs)} differ): the systems of a "
                "batch have the same bodies, joints, geoms, mounts and internal states. Give each layout a batch of its own."
            )


def expand_differences(batch: Batch, systems: Sequence[System]) -> None:
    """Give every simulation of a batch the numbers of its own system's model where they differ from the batch's model."""
    fields = [field for field in _expandable() if _content(batch.model, field).size]
    shared = {field: _content(batch.model, field).tobytes() for field in fields}
    own: dict[int, list[tuple[str, AnyArray]]] = {id(systems[0]): []}
    for _, system in _distinct(systems):
        contents = ((field, _content(system.model, field)) for field in fields)
        own[id(system)] = [(field, content) for field, content in contents if content.tobytes() != shared[field]]
    for number, system in enumerate(systems):
        for field, content in own[id(system)]:
            rows = batch.expand(field)
            rows[number] = content[: rows.shape[1]] if rows.ndim > 1 else content  # the batch shares what is a mesh's


def _distinct(systems: Sequence[System]) -> list[tuple[int, System]]:
    """Return the systems that are not the first object, each once, with their numbers."""
    numbers = {id(system): number for number, system in reversed(list(enumerate(systems)))}
    return [(number, systems[number]) for number in sorted(numbers.values()) if number]


def _content(model: mujoco.MjModel, field: str) -> AnyArray:
    return np.asarray(getattr(model.opt, field[4:]) if field.startswith("opt.") else getattr(model, field))


def _sizes_of(model: mujoco.MjModel) -> dict[str, int]:
    return {name: getattr(model, name) for name in _sizes()}


@cache
def _sizes() -> tuple[str, ...]:
    """Return the names of a model's counts; those of names, paths and texts may differ."""
    may_differ = ("nnames", "nnames_map", "npaths", "ntextdata", "nbuffer", "ntex", "ntexdata")
    model = mujoco.MjModel.from_xml_string("<mujoco/>")
    counts = (name for name in dir(model) if name.startswith("n") and isinstance(getattr(model, name), int))
    return tuple(name for name in counts if name not in may_differ)


@cache
def _expandable() -> tuple[str, ...]:
    """Return the names of the fields that act and of which every simulation of a batch may have its own."""
    acting = (f for f in MODEL_FIELDS if f != _STEP and not f.startswith(_WORDS))
    return tuple(sorted(f for f in acting if not f.endswith("pathadr")))


@cache
def _fixed() -> tuple[str, ...]:
    """Return the names of the arrays that act and that all simulations of a batch share."""
    model = mujoco.MjModel.from_xml_string("<mujoco/>")
    arrays = (name for name in dir(model) if isinstance(getattr(model, name), np.ndarray))
    kept = (name for name in arrays if name not in MODEL_FIELDS and not name.startswith((*_WORDS, "_", "bvh_")))
    return tuple(name for name in kept if not name.endswith("pathadr"))


class Lockstep:
    """Systems of one layout that take the same steps, each as `run` would take them alone."""

    def __init__(
        self, systems: Sequence[System], motions: Sequence[BaseMotion], starts: Sequence[State], *, threads: int
    ) -> None:
        """Prepare for stepping `systems` from `starts` with their bases following `motions`."""
        self.systems, self.motions = systems, motions
        self._distinct, which = distinct_motions(motions)
        self._which = np.array(which)
        assembly = systems[0].assembly
        self._drive, self._force_sites = assembly.tables.drive, assembly.subjects.force_names
        self._model = systems[0].model
        self.live = np.arange(len(systems))  # numbers of the systems that MuJoCo has not warned of so far, (n_live,)
        self.errors: dict[int, SimulationError] = {}  # what `run` raises for others, as far as it is known
        self.steps, self.largest_step = 0, 0.0  # so far [1, s]
        self._batch = Batch(self._model, nsim=len(systems), nthread=min(threads, len(systems)))
        self._timestep = self._batch.expand("opt.timestep")
        expand_differences(self._batch, systems)
        self._batch.state[:] = [start.values for start in starts]
        self._qpos, self._qvel = self._batch.bind("qpos"), self._batch.bind("qvel")
        self._user = assembly.user(self._batch.bind("userdata"))
        self._user[:, at.OBSERVING], self._user[:, at.HISTORY], self._user[:, at.EVENT] = 1.0, 0.0, at.SMOOTH
        self._dofs = side_by_side(np.array(assembly.driven_dofs, dtype=int))
        self._slides = side_by_side(self._model.jnt_qposadr[list(assembly.subjects.driven)])
        self._origin = np.array([system.model.qpos0[self._slides] for system in systems])
        self._finals, self._checked = np.empty_like(self._batch.state), self._batch.state.copy()
        self._sink: Sink | None = None
        self._sample, self._sensors = 0, np.empty(0)

    def go(self, grid: TimeGrid, sink: Sink | None = None) -> None:
        """Step through a grid, the mounts of the model acting; its motion says nothing here, its corners everything.

        `sink` takes every sample's number and the systems' sensor values, (n_systems, n_sensors), and must copy them.
        """
        if sink is not None:
            self._sink, self._sensors = sink, self._batch.bind("sensordata")[:, self.systems[0].assembly.sensor :]
        tables = [StageTables(motion, self._drive, self._force_sites) for motion in self._distinct]
        keys = [events_key(motion) for motion in self._distinct]
        by_corners = dict(zip(keys, self._distinct, strict=True))
        stop = grid.start
        for block in grid.blocks():
            events = {key: block.with_events_of(motion) for key, motion in by_corners.items()}
            grids = [events[key] for key in keys]
            for stages in zip(*(table.blocks(own) for table, own in zip(tables, grids, strict=True)), strict=True):
                self._advance(block, grids, stages)
            stop = float(block.stop[-1]) if block.stop.size else stop
            self.steps += int(block.steps.sum())
            self.largest_step = max(self.largest_step, block.largest_step)
        self._finish(stop)
        if self._sample < grid.sample_times.size:
            self._take_sample()
        self._base_peaks = [table.peak for table in tables]

    def result(self, number: int, why: str) -> RunResult:
        """Read the result of one of the systems that are live; `why` it was not the kernel's."""
        final = State(values=self._finals[number].copy(), time=float(self._finals[number, 0]))
        peaks = peaks_of(self.systems[number], self._user[number], self._base_peaks[self._which[number]])
        return RunResult(
            final_state=final, peaks=peaks, callback="native", steps=self.steps, largest_step=self.largest_step, why=why
        )

    def _advance(self, block: Grid, grids: list[Grid], stages: tuple[Stages, ...]) -> None:
        """Step through the segments of `stages`, each motion's own, in which the motions' `grids` have the events."""
        first, ends = stages[0].first, [0, *stages[0].ends.tolist()]
        n_segments = len(ends) - 1
        # (n_motions, ...), segments first where only one of them is needed at a time
        events = np.array([own.event[first : first + n_segments] for own in grids]).T
        jumps = (events == at.JUMP).any(axis=1)
        positions = np.array([own.positions for own in stages]).transpose(1, 0, 2)
        rates = np.array([own.rates for own in stages]).transpose(1, 0, 2)
        accelerations = np.array([own.accelerations.ravel() for own in stages])
        checked = 0
        for segment in range(n_segments):
            if not self.live.size:
                return
            start, stop = float(block.start[first + segment]), float(block.stop[first + segment])
            steps = int(block.steps[first + segment])
            if jumps[segment]:
                self._jump(events[segment], start)
            self._place_base(positions[segment], rates[segment])
            self._user[:, at.EVENT] = events[segment][self._which]
            self._set_table(accelerations[:, 3 * ends[segment] : 3 * ends[segment + 1]], start, 2.0 * steps / (stop - start))
            self._set_loads([own.forces[ends[segment] : ends[segment + 1]] for own in stages])
            self._batch.state[:, 0] = start  # so that rounding does not add up over the steps
            self._timestep[:] = (stop - start) / steps
            if self._sink is not None and block.sampled[first + segment]:
                self._call(partial(self._batch.step, self.live))
                self._take_sample()
                steps -= 1
            if steps:
                self._call(partial(self._batch.step, self.live, nstep=steps))
            if segment + 1 - checked == CHECK_EVERY or segment + 1 == n_segments:
                for number in self._drop_failed():
                    which = self._which[number]
                    self._look_again(number, grids[which], list(stages[which].segments(checked, segment + 1)))
                checked, self._checked[:] = segment + 1, self._batch.state

    def _take_sample(self) -> None:
        if self._sink is not None:
            self._sink(self._sample, self._sensors)
            self._sample += 1

    def _set_table(self, accelerations: Array, start: float, rate: float) -> None:
        """Give every base its accelerations (n_motions, 3 n_points), `rate` of them a second."""
        user, size = self._user, accelerations.shape[1]
        user[:, at.STAGE_POINTS], user[:, at.STAGE_START], user[:, at.STAGE_RATE] = size // 3, start, rate
        user[:, at.STAGES : at.STAGES + size] = self._of_each(accelerations)

    def _set_loads(self, forces: Sequence[Array]) -> None:
        """Give every system the forces on its payload, (n_points, n_forces, 6) for every motion, or nothing."""
        first = self.systems[0].assembly.tables.user.forces
        for number, own in enumerate(forces):
            if own.size:
                self._user[self._which == number, first : first + own.size] = own.ravel()

    def _of_each(self, rows: Array) -> Array:
        """Return the rows of the systems from those of the distinct motions."""
        return rows[self._which] if len(rows) > 1 else rows

    def _place_base(self, positions: Array, rates: Array) -> None:
        self._qpos[:, self._slides] = self._origin + self._of_each(positions)
        self._qvel[:, self._dofs] = self._of_each(rates)

    def _jump(self, events: Array, time: float) -> None:
        """Let what rides on a base whose velocity jumps now keep its momentum."""
        for number in self.live[events[self._which[self.live]] == at.JUMP]:
            system, row = self.systems[number], self._batch.state[number]
            data = mujoco.MjData(self._model)
            mujoco.mj_setState(system.model, data, row, STATE)
            leave_behind(system, system.model, data, velocity_jump(self.motions[number], time))
            self._qvel[number] = data.qvel

    def _call(self, work: Callable[[], None]) -> None:
        """Let the batch do some work, and leave out the systems with which MuJoCo could not go on."""
        if not self.live.size:
            return
        try:
            work()
        except BatchError as error:
            self.live = np.setdiff1d(self.live, error.ids)

    def _drop_failed(self) -> list[int]:
        """Return the numbers of the systems that MuJoCo has warned of since the last call; they are not live any more."""
        warned = self._batch.warning[self.live, :, 1].any(axis=1)
        failed, self.live = self.live[warned], self.live[~warned]
        return failed.tolist()

    def _look_again(self, number: int, grid: Grid, segments: list[Segment]) -> None:
        """Take a system alone through the segments in which it failed, to learn what `run` says of it."""
        start = State(values=self._checked[number], time=float(self._checked[number, 0]))
        stepper = Stepper(self.systems[number], self.motions[number], start)
        stepper.enter(grid)
        for segment in segments:
            stepper.begin(segment)
            mujoco.mj_step(stepper.model, stepper.data, nstep=int(grid.steps[segment.number]))
        try:
            stepper.check()
        except SimulationError as error:
            self.errors[number] = error

    def _finish(self, stop: float) -> None:
        """Keep the final states, and observe the last instant with the accelerations just before it."""
        before = [base_before(motion, self._drive, stop) for motion in self._distinct]
        self._place_base(np.array([positions for positions, _ in before]), np.array([rates for _, rates in before]))
        self._batch.state[:, 0] = stop
        user, kept = self._user, self._user.copy()
        # A state does not carry what belongs to this run alone: stage table and tracker.
        user[:] = 0.0
        self._finals[:] = self._batch.state
        user[:] = kept
        self._set_table(np.array([acceleration_before(motion, stop) for motion in self._distinct]), stop, 0.0)
        now = np.array([stop])
        self._set_loads([loads_at(one, self._force_sites if one.loaded_sites else (), now) for one in self._distinct])
        self._call(partial(self._batch.forward, self.live))
        self._drop_failed()
