"""Variants of a system: the numbers of their equations, written from the changes that make them, and several side by side."""

import copy
from collections.abc import Sequence
from dataclasses import dataclass

import mujoco
import numpy as np

from wirerope_mj.engine.control import layout as control
from wirerope_mj.engine.kernel import equations as made
from wirerope_mj.engine.kernel import layout as at
from wirerope_mj.engine.kernel.equations import Bodies, Equations, Integers
from wirerope_mj.engine.kernel.observe import CLOCK_SIZE
from wirerope_mj.engine.kernel.steps import advance
from wirerope_mj.engine.system import Changes, System
from wirerope_mj.engine.system.tables import rated_travel, rotational_stiffness
from wirerope_mj.engine.system.varied import change_masses, moving_bodies, tune
from wirerope_mj.foundation.arrays import Array
from wirerope_mj.foundation.lanes import WIDTH
from wirerope_mj.mounts.isolator import Isolator
from wirerope_mj.mounts.laws.law import Law

NOTHING = np.zeros((0, 0, 0))  # room for the samples of no variant


class _Changed:
    """A model in which some arrays are replaced; all else is the original's."""

    def __init__(self, model: mujoco.MjModel, arrays: dict[str, Array]) -> None:
        self._model = model
        vars(self).update(arrays)

    def __getattr__(self, name: str) -> object:
        return getattr(self._model, name)


class Numbers:
    """Writes the numbers of those variants of a system that keep its structure and its shared numbers."""

    def __init__(self, system: System, equations: Equations) -> None:
        """Locate the numbers of mounts, bodies and points."""
        model, tables, lay = system.model, system.assembly.tables, equations.lay
        self.equations, self._system = equations, system
        n = len(system.mounts)
        rows = equations.rows(at.MOUNTS, at.MOUNT_COLUMNS, n)
        self._points = dict(zip(system.mounts, rows[:, at.POINTS].tolist(), strict=True))
        parameters = int(lay[at.PARAMETERS])
        axes = tables.rows(control.AXES, control.AXIS_COLUMNS, 3 * n).reshape(n, 3, control.AXIS_COLUMNS)
        self._laws = dict(zip(system.mounts, (parameters + axes[:, :, 1]).astype(int).tolist(), strict=True))
        self._couplings = dict(zip(system.mounts, (parameters + rows[:, at.COUPLING]).tolist(), strict=True))
        self._bodies = Bodies(model)
        self._kinds = equations.rows(at.LINKS, at.LINK_COLUMNS, lay[at.N_LINKS])[:, at.KIND].tolist()
        data = mujoco.MjData(model)
        mujoco.mj_kinematics(model, data)
        self._axes = data.xmat.reshape(-1, 3, 3).copy()
        sites = tables.sites.ravel().tolist()
        # What moves these would change what the variants share, or is refused by `varied`.
        self._shared_sites = {site for site in sites if sites.count(site) > 1} | set(system.assembly.subjects.points)
        base = system.assembly.subjects.base
        self._of_base = set(np.flatnonzero(model.body_rootid == base).tolist()) if base else set()
        self._moving = set(moving_bodies(model))

    def of(self, changes: Changes) -> Array | None:
        """Return the numbers of a variant's equations from its changes, (n_num,); None if its structure may differ.

        They have the bits of those in `equations_of` of that variant.
        """
        numbers = self.equations.num.copy()
        for mount, isolator in changes.isolators.items():
            written = self.of_isolator(mount, isolator.conditioned) if mount in self._points else None
            if written is None:
                return None
            numbers[written[0]] = written[1]
        self.write_springs(numbers, changes)
        return numbers if self.write_geometry(numbers, changes) else None

    def write_springs(self, numbers: Array, changes: Changes) -> None:
        """Write springs and dampers of joints with other natural frequencies."""
        if not changes.tunings:
            return
        lay, model = self.equations.lay, self._system.model.__copy__()
        if changes.masses:
            change_masses(model, changes.masses)
            mujoco.mj_setConst(model, mujoco.MjData(model))
        tune(model, changes.tunings, self._system.model)
        for name in changes.tunings:
            dof = int(model.joint(name).dofadr[0])
            first = int(lay[lay[at.DOFS] + at.DOF_COLUMNS * dof + at.DOF_NUM])
            numbers[first : first + 3] = made.spring_of(model, dof)

    def write_law(self, numbers: Array, mount: str, axis: int, parameters: Array) -> None:
        """Write the parameters of a law of the same structure."""
        first = self._laws[mount][axis]
        numbers[first : first + parameters.size] = parameters

    def write_coupling(self, numbers: Array, mount: str, parameters: Array) -> None:
        """Write the first parameters of a coupling of the same structure."""
        first = self._couplings[mount]
        numbers[first : first + parameters.size] = parameters

    def of_isolator(self, mount: str, isolator: Isolator) -> tuple[Integers, Array] | None:
        """Return the numbers of a mount's acting isolator and their positions; None if its structure differs."""
        old = self._system.mounts[mount].isolator
        turns, coupled = rotational_stiffness(isolator), isolator.coupled
        grids = [device.loop and np.shape(device.loop.coefficients) for device in (isolator, old)]
        if isolator.coupling != old.coupling or grids[0] != grids[1] or any(turns) != any(rotational_stiffness(old)):
            return None
        if not all(map(same_structure, isolator.axes.values(), old.axes.values())):
            return None
        laws = zip(self._laws[mount], isolator.axes.values(), strict=True)
        parts = [(first, law.kernel_parameters()) for first, law in laws if law is not None]
        if coupled is not None:
            parts.append((self._couplings[mount], coupled.mount_parameters()))
        parts.append((self._points[mount] + at.RESISTING, np.array([*turns, *rated_travel(isolator)])))
        places = [np.arange(first, first + values.size) for first, values in parts]
        return np.concatenate(places), np.concatenate([values for _, values in parts])

    def write_geometry(self, numbers: Array, changes: Changes) -> bool:
        """Write the numbers that follow from masses, centres and mount positions; returns whether all others stay the same."""
        if not (changes.masses or changes.centres or changes.positions or changes.turns):
            return True
        if any(any(turn) for turn in changes.turns.values()):
            return False
        system, model, lay = self._system, self._system.model, self.equations.lay
        arrays = {name: getattr(model, name).copy() for name in ("body_mass", "body_inertia", "body_ipos", "site_pos")}
        touched: set[int] = set()
        for name in (*changes.masses, *changes.centres):
            if name not in self._moving or (body := int(model.body(name).id)) in self._of_base:
                return False
            touched.add(body)
        for name, factor in changes.masses.items():
            body = int(model.body(name).id)
            arrays["body_mass"][body] *= factor
            arrays["body_inertia"][body] *= factor
        for name, shift in changes.centres.items():
            body = int(model.body(name).id)
            if model.body_simple[body] and any(shift):
                return False
            arrays["body_ipos"][body] += np.asarray(np.array(shift) @ self._axes[body], dtype=np.float64)
        moved = [name for name, shift in changes.positions.items() if any(shift)]
        numbered = dict(zip(system.mounts, system.assembly.tables.sites.tolist(), strict=True))
        if any(name not in numbered or self._shared_sites & set(numbered[name]) for name in moved):
            return False
        for name in moved:
            for site in numbered[name]:
                axes = self._axes[int(model.site_bodyid[site])]
                arrays["site_pos"][site] += np.asarray(np.array(changes.positions[name]) @ axes, dtype=np.float64)
        bodies = copy.copy(self._bodies)
        bodies.model = _Changed(model, arrays)
        for body in touched:
            self._write_body(numbers, bodies, bodies.link[body])
        for name in moved:
            first = self._points[name]
            for part, site in enumerate(numbered[name]):
                link, pose = bodies.site(site)
                numbers[first + 3 * part : first + 3 * part + 3] = (
                    made.to_equation_axes(bodies, self._kinds, link) @ pose.origin
                )
        frames = self.equations.rows(at.FRAMES, at.FRAME_COLUMNS, lay[at.N_FRAMES]).tolist()
        for row, body in zip(frames, system.assembly.subjects.bodies, strict=False):
            if body in touched:
                centre = bodies.pose[body].then(arrays["body_ipos"][body], model.body_iquat[body]).origin
                numbers[row[1] : row[1] + 3] = centre
        return True

    def _write_body(self, numbers: Array, bodies: Bodies, link: int) -> None:
        """Write the inertia of a link, and the inverse mass matrix that follows from it."""
        lay, model = self.equations.lay, self._system.model
        first = int(lay[lay[at.LINKS] + at.LINK_COLUMNS * link + at.INERTIA])
        numbers[first : first + at.INERTIA_SIZE] = made.inertia_of(bodies, link)
        trees = self.equations.rows(at.TREES, at.TREE_COLUMNS, lay[at.N_TREES]).tolist()
        for number, (kind, _, size, first_link, _, inverse) in enumerate(trees):
            if kind == at.SLIDING_TREE and first_link == link:
                dofs = np.flatnonzero(model.dof_treeid == number)
                numbers[inverse : inverse + size * size] = made.inverse_mass(bodies, link, dofs).ravel()


def same_structure(law: Law | None, other: Law | None) -> bool:
    """Return whether two laws certainly differ only in the values of their parameters."""
    return law is other if law is None else law.same_structure(other)


@dataclass(frozen=True, kw_only=True)
class Group:
    """Variants that are stepped side by side, one to a lane of the arrays; surplus lanes repeat the last variant."""

    equations: Equations  # of the first variant
    numbers: Array  # of all lanes, (n, WIDTH), see `wirerope_mj.engine.kernel.layout`
    states: Array
    memory: Array
    clock: Array  # see `wirerope_mj.engine.kernel.observe`
    which: Integers  # number of the motion that each lane's base follows, (WIDTH,)
    size: int  # number of variants

    @property
    def failed(self) -> Array:
        """Codes of the reasons why variants were given up, 0 for none, (size,); see `wirerope_mj.engine.kernel.layout`."""
        return self._section(at.FAILED, at.LOADS)[0, : self.size]

    def channels(self, number: int) -> Array:
        """Return the peaks of one variant's tracked vectors, (n_channels, ...), laid out as in `engine.control.layout`."""
        return self._section(at.MEMORY, at.TOUCHED)[:, number].reshape(-1, control.CHANNEL_MEMORY)

    def stops(self, number: int) -> Array:
        """Return the memory of one variant's stops, (n_stops, ...), as `wirerope_mj.engine.control.layout` has it."""
        return self._section(at.TOUCHED, at.TRAVELS)[:, number].reshape(-1, control.CONTACT_MEMORY)

    def travels(self, number: int) -> Array:
        """Return the memory of one variant's travels, (n_mounts, ...), as `wirerope_mj.engine.control.layout` has it."""
        return self._section(at.TRAVELS, at.CLOSINGS)[:, number].reshape(-1, control.TRAVEL_MEMORY)

    def closings(self, number: int) -> Array:
        """Return the memory of the speeds at which one variant's stops close, (n_stops, ...), as the control layout has it."""
        return self._section(at.CLOSINGS, at.FAILED)[:, number].reshape(-1, control.CLOSING_MEMORY)

    def _section(self, first: int, behind: int) -> Array:
        lay = self.equations.lay
        return self.memory[lay[first] : lay[behind]]

    def step(self, grid: Array, positions: Array, rates: Array, table: Array, ends: Integers, out: Array) -> None:
        """Step through segments, see `wirerope_mj.engine.kernel.steps.advance`."""
        e = self.equations
        advance(
            e.lay, e.fix, self.numbers, self.states, self.memory, self.clock, self.which, grid, positions, rates, table, ends,
            out, 0,
        )  # fmt: skip

    def finish(self, time: float, positions: Array, rates: Array, table: Array, out: Array) -> None:
        """Observe the last instant; its values go to `out`, (n_kept, 1, n_values), or `NOTHING`."""
        instant = np.array([[time], [time], [0.0], [float(out.size > 0)], [control.SMOOTH]])
        self.step(instant, positions, rates, table, np.ones(1, dtype=np.int64), out)


def group_of(equations: Sequence[Equations], states: Array, which: Sequence[int]) -> Group:
    """Group at most WIDTH variants: their equations, start states (n, n_states), and the number of each one's motion."""
    size = len(equations)
    lanes = np.minimum(np.arange(WIDTH), size - 1)
    first = equations[0]
    memory = np.zeros((int(first.lay[at.N_WORK]), WIDTH))
    memory[first.lay[at.KIN] : first.lay[at.KIN] + first.rest.size] = first.rest[:, np.newaxis]
    return Group(
        equations=first, numbers=np.ascontiguousarray(np.array([equation.num for equation in equations])[lanes].T),
        states=np.ascontiguousarray(states[lanes].T), memory=memory, clock=np.zeros(CLOCK_SIZE),
        which=np.asarray(which, dtype=np.int64)[lanes], size=size,
    )  # fmt: skip
