"""Equilibrium of a system under gravity, by a static solve along the loading path; of many variants, one to a lane."""

import os
import warnings
from collections.abc import Sequence
from concurrent.futures import ThreadPoolExecutor
from dataclasses import dataclass
from weakref import WeakKeyDictionary

import mujoco
import numpy as np

from wirerope_mj.engine.control import installed
from wirerope_mj.engine.control import layout as control
from wirerope_mj.engine.control.install import check_callbacks, state_of
from wirerope_mj.engine.kernel import layout as at
from wirerope_mj.engine.kernel.equations import Equations, equations, not_held
from wirerope_mj.engine.kernel.rest import SETTINGS, settle
from wirerope_mj.engine.statics import loading
from wirerope_mj.engine.statics.loading import ACCEPTED, FARTHEST, HISTORIES, Equilibrium, History, Loading
from wirerope_mj.engine.statics.payloads import unresisted
from wirerope_mj.engine.statics.slow_path import remembering_axes
from wirerope_mj.engine.system import System, beyond_laws, once_per_system
from wirerope_mj.foundation.arguments import one_of
from wirerope_mj.foundation.arrays import Array, Booleans
from wirerope_mj.foundation.errors import ModelWarning
from wirerope_mj.foundation.lanes import WIDTH

# ratio of the squared singular values of the deflections' rates above which every motion is resisted for certain
HELD = 1e-12
_known: WeakKeyDictionary[System, dict[str, Equilibrium]] = WeakKeyDictionary()


@dataclass(frozen=True, kw_only=True)
class Equilibria:
    """Equilibria of variants."""

    # whether it was found here, (n,): what was not is for `equilibrium`, which says why if there is none
    found: Booleans
    held: Booleans  # whether the mounts certainly resist every motion, (n,)
    states: Array  # qpos, qvel and act, (n, n_state)
    mounts: Array  # deflection and force of every mount, (n, n_mounts, 2, 3)
    residual: Array  # largest acceleration left [m/s^2 or rad/s^2], (n,)


class EquilibriumSolver:
    """Finds equilibria of variants that share the structure of `system`, whose equations are `equations`."""

    def __init__(self, system: System, equations: Equations) -> None:
        """Prepare the tables that all variants share."""
        tables, model = system.assembly.tables, system.model
        self._equations = equations
        self._free = np.delete(np.arange(model.nv), system.assembly.driven_dofs).astype(np.int64)
        self._follows = remembering_axes(system)
        firsts = tables.rows(control.AXES, control.AXIS_COLUMNS, self._follows.size)[:, 1]
        self._sizes = np.diff(np.append(firsts, tables.parameters.size)).astype(np.int64)
        self._start = np.concatenate([model.qpos0, np.zeros(model.nv + tables.user.n_states)])
        gravity = float(np.linalg.norm(model.opt.gravity))
        scale = max(gravity, 1.0)
        self._settings = np.array([
            loading.TOLERANCE * scale, ACCEPTED * scale, loading.DIFFERENCE, loading.LONGEST, loading.SLOW, loading.ITERATIONS,
            loading.HALVINGS, loading.position_limit(self._free.size),
        ])  # fmt: skip
        assert self._settings.size == SETTINGS
        # Without gravity all steps are one.
        steps = np.full(loading.LOAD_STEPS, 1.0 / loading.LOAD_STEPS)
        self._loads = np.minimum(np.cumsum(steps), 1.0) if gravity else np.ones(1)

    def solve(self, numbers: Array, history: History) -> Equilibria:
        """Return the equilibria of variants with these numbers, (n, n_num)."""
        e, n, n_free = self._equations, len(numbers), self._free.size
        lay, record, n_records = e.lay, int(e.lay[at.RECORD]), int(e.lay[at.N_MOUNTS]) * at.RECORD_SIZE
        states, residual, grams = np.empty((n, self._start.size)), np.empty(n), np.empty((n, n_free, n_free))
        records, follows = np.empty((n, n_records)), self._follows if history == "virgin" else np.zeros(0, dtype=np.bool_)
        for first in range(0, n, WIDTH):
            size = min(WIDTH, n - first)
            lanes, some = first + np.minimum(np.arange(WIDTH), size - 1), slice(first, first + size)
            memory, places = np.zeros((int(lay[at.N_WORK]), WIDTH)), np.tile(self._start[:, np.newaxis], WIDTH)
            memory[lay[at.KIN] : lay[at.KIN] + e.rest.size] = e.rest[:, np.newaxis]
            remainder, products = np.zeros(WIDTH), np.zeros((WIDTH, n_free, n_free))
            settle(
                lay, e.fix.copy(), np.ascontiguousarray(numbers[lanes].T), places, memory, self._free, self._loads, follows,
                self._sizes, self._settings, remainder, products,
            )  # fmt: skip
            states[some], residual[some], grams[some] = places.T[:size], remainder[:size], products[:size]
            records[some] = memory[record : record + n_records].T[:size]
        mounts = records.reshape(n, -1, 4, 3)[:, :, :2].copy()
        converged = np.isfinite(residual) & (np.abs(mounts[:, :, 0]).max(axis=(1, 2), initial=0.0) < FARTHEST)
        sizes = np.linalg.eigvalsh(np.where(converged[:, np.newaxis, np.newaxis], grams, 0.0))
        constrained = sizes[:, 0] > HELD * sizes[:, -1] if self._free.size else converged
        return Equilibria(found=converged, held=constrained, states=states, mounts=mounts, residual=residual)


@once_per_system
def equilibrium_solver(system: System) -> EquilibriumSolver:
    return EquilibriumSolver(system, equations(system))


def settle_together(systems: Sequence[System], history: History) -> None:
    """Find equilibria of systems of one structure side by side, bit-identical to single solutions, and cache them.

    An equilibrium that is not found here is left to `equilibrium`, which finds it or says why there is none.
    """
    systems = [system for system in systems if history not in _known.get(system, {}) and not not_held(system)]
    systems = [system for system in systems if equations(system).key == equations(systems[0]).key]
    groups = [systems[first : first + WIDTH] for first in range(0, len(systems), WIDTH)]
    if not groups:
        return
    solver = equilibrium_solver(systems[0])
    numbers = [np.array([equations(system).num for system in group]) for group in groups]
    with ThreadPoolExecutor(os.cpu_count()) as pool:
        run = pool.map if len(groups) > 1 else map
        solved = list(run(lambda some: solver.solve(some, history), numbers))
    for group, rests in zip(groups, solved, strict=True):
        for number, system in enumerate(group):
            with system.assembly.scratch.data(system.model) as data:
                if confirmed := _confirm(system, history, data, rests, number):
                    _known.setdefault(system, {})[history] = confirmed


def _confirm(system: System, history: History, data: mujoco.MjData, rests: Equilibria, number: int) -> Equilibrium | None:
    """Return the equilibrium of variant `number` if MuJoCo's accelerations vanish there, else None."""
    if not rests.found[number]:
        return None
    model, qpos = system.model, rests.states[number, : system.model.nq]
    free = np.delete(np.arange(model.nv), system.assembly.driven_dofs)

    def accelerations(step: Array) -> Array:
        mujoco.mj_resetData(model, data)
        data.qpos[:], data.act[:] = qpos, rests.states[number, model.nq + model.nv :]
        if step.any():  # else the state keeps its bits
            whole = np.zeros(model.nv)
            whole[free] = step
            mujoco.mj_integratePos(model, data.qpos, whole, 1.0)
        mujoco.mj_forward(model, data)
        return np.asarray(data.qacc[free])

    with installed(model, data):
        residual = float(np.abs(accelerations(np.zeros(free.size))).max(initial=0.0))
        # What mounts do not resist does not deflect them: their states stay as they are.
        unheld = () if rests.held[number] else unresisted(system, data, free, accelerations)
        accelerations(np.zeros(free.size))
    # A study's variants have these forces too, whose rounding is another one than that of the callback's.
    rows = rests.mounts[number]
    system.assembly.tables.user.mount_rows(system.assembly.user(data.userdata))[:] = rows
    lawful = beyond_laws(system, rows[:, 0]) is None
    if not (lawful and residual <= ACCEPTED * max(float(np.linalg.norm(model.opt.gravity)), 1.0)):
        return None
    return Equilibrium.of(system, state_of(model, data), rows, history, residual, unheld)


def equilibrium(system: System, *, history: History = "virgin") -> Equilibrium:
    """Return the equilibrium of `system` under its gravity, base at rest; computed once per system and history.

    Gravity grows from 0 in steps. In each, Newton's method makes MuJoCo's own accelerations vanish, contacts and joint springs
    included; the hysteretic states of a trial position are integrated along the law from the last step's, so that they lie
    exactly on the loading path. Where the kernel's equations hold its accelerations serve the search, and MuJoCo's own confirm
    what it found.

    Warns:
        ModelWarning: no mount, joint or stop resists a motion of a body; `free` says which.

    Raises:
        ConvergenceError: there is no equilibrium, or it was not found; names the mount that cannot carry its load.
    """
    one_of("history", history, HISTORIES)
    check_callbacks()
    settle_together([system], history)
    known = _known.setdefault(system, {})
    if history not in known:
        with system.assembly.scratch.data(system.model) as data:
            known[history] = Loading(system, history, data).solve()
    for message in known[history].free:
        warnings.warn(message, ModelWarning, stacklevel=2)
    return known[history]
