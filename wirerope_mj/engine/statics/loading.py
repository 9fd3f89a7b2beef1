"""Equilibrium of a system under its weight, by steps of load from weightlessness to the full weight."""

from dataclasses import dataclass
from typing import Literal

import mujoco
import numpy as np

from wirerope_mj.engine.control import installed
from wirerope_mj.engine.control.install import STATE, state_of
from wirerope_mj.engine.statics.linear import linear_system
from wirerope_mj.engine.statics.payloads import payloads_of, unresisted
from wirerope_mj.engine.statics.slow_path import SlowPath
from wirerope_mj.engine.system import System, beyond_laws
from wirerope_mj.foundation.arrays import Array
from wirerope_mj.foundation.errors import ConvergenceError
from wirerope_mj.foundation.state import State
from wirerope_mj.foundation.summary import ByName, Summarised, quantity

History = Literal["virgin", "relaxed"]
HISTORIES: tuple[History, History] = ("virgin", "relaxed")
# steps in which gravity grows from 0 to g: each is short enough for Newton's method to start from the last. Mounts move
# straight within one: on a path that bends, twenty and sixty differed by up to 1e-4 of the deflections.
LOAD_STEPS = 20
SMALLEST_LOAD_STEP = 1e-4  # fraction of gravity below which a load step that fails is a load that cannot be carried
TOLERANCE = 1e-11  # largest acceleration left, relative to gravity: two orders above the rounding of forces of tonnes
# accepted acceleration, relative to gravity, where rounding or a contact's own iteration stops Newton's method earlier
ACCEPTED = 1e-8
# positions that are tried before a search is given up, and more for each coordinate: twenty times what the shipped models take,
# seconds of computing; a Jacobian takes two of each coordinate, and every load step may need some
MOST_POSITIONS, POSITIONS_PER_COORDINATE = 3_000, 300
# step of a fall over the shortest time in which anything swings, and number of steps: the slowest sink by then, too
FALL, FALLING = 0.5, 2000
FARTHEST = 10.0  # deflection of a mount [m] that is no longer one: fifty heights of the largest in the vendors' tables
ITERATIONS = 60  # iterations for one root: ten times what a smooth one takes
# halvings of a step before it counts as leading nowhere: 1/4096 of it is rounding where Newton's method works at all
HALVINGS = 12
LONGEST = 0.1  # longest step [m or rad]: more than any mount travels
# fraction of the residual that a step may leave; beyond it a new Jacobian is cheaper than the iterations that it saves
SLOW = 0.2
# step of the differences [m or rad]: small against any travel, and they stand eight digits above the rounding of forces
DIFFERENCE = 1e-7
# fraction of the largest singular value below which a direction has no stiffness: differences are rounded at 1e-11 of it
INDIFFERENT = 1e-10
# argument with which `mj_forwardSkip` leaves out the sensors, which measure a motion and do not act
WITHOUT_SENSORS = 1


def position_limit(coordinates: int) -> int:
    """Return how many trial positions a search for equilibrium over so many coordinates may take."""
    return MOST_POSITIONS + POSITIONS_PER_COORDINATE * coordinates


def largest(values: Array) -> float:
    return float(np.abs(values).max(initial=0.0))


@dataclass(frozen=True, kw_only=True)
class MountLoad:
    """Deflection [m] and force [N] of a mount in its axes roll, shear, axial, (3,)."""

    deflection: Array
    force: Array


@dataclass(frozen=True, kw_only=True, repr=False)
class Equilibrium(Summarised):
    """Equilibrium of a system under its weight."""

    state: State  #: integration state to start a simulation from
    mounts: dict[str, MountLoad]  #: deflection and force of every mount
    #: "virgin" (gravity applied slowly to the unloaded mounts) or "relaxed" (z = 0 throughout, after long vibration has let
    #: the hysteretic part of the load leak away)
    history: History
    residual: float  #: largest acceleration left [m/s^2 or rad/s^2]
    #: a message about the motions of each body that no mount, joint or stop resists, such as the rotation of a body on mounts
    #: that stand in line
    free: tuple[str, ...] = ()

    @classmethod
    def of(
        cls, system: System, state: State, rows: Array, history: History, residual: float, free: tuple[str, ...]
    ) -> "Equilibrium":
        """Make the equilibrium of a system from deflection and force of every mount, (n_mounts, 2, 3)."""
        loads = {name: MountLoad(deflection=d, force=f) for name, (d, f) in zip(system.mounts, rows, strict=True)}
        return cls(state=state, mounts=ByName(loads), history=history, residual=residual, free=free)

    def _summary(self) -> tuple[str, dict[str, str]]:
        lines = {
            name: f"axial {quantity(mount.deflection[2], 'm')}, {quantity(mount.force[2], 'N')}"
            for name, mount in self.mounts.items()
        }
        return f"Equilibrium, {self.history}: largest acceleration left {self.residual:.1e} m/s^2", lines


def forces_at_rest(system: System, state: State) -> Array:
    """Return the forces of all mounts in an equilibrium's state, roll, shear, axial [N], (n_mounts, 3).

    The state holds them, since the callback's memory is part of it: nothing is computed.
    """
    assembly, memory = system.assembly, np.empty(system.model.nuserdata)
    mujoco.mj_extractState(system.model, state.values, STATE, memory, mujoco.mjtState.mjSTATE_USERDATA)
    return assembly.tables.user.mount_rows(assembly.user(memory))[:, 1]


class Loading:
    """Search for the equilibrium of a system in steps of load from weightlessness to the full weight."""

    def __init__(self, system: System, history: History, data: mujoco.MjData) -> None:
        """Prepare `system`, with MuJoCo data of its layout."""
        self.system, self.history, self.data = system, history, data
        self.gravity = system.model.opt.gravity.copy()
        # Its gravity grows, and other threads may step the system meanwhile; without gravity nothing of it changes.
        self.model = system.model.__copy__() if self.gravity.any() else system.model
        self.free = np.delete(np.arange(self.model.nv), system.assembly.driven_dofs)
        self.path = SlowPath(system) if history == "virgin" else None
        self.tried, self.position_limit = 0, position_limit(self.free.size)
        self.inverse: Array | None = None  # of the Jacobian, which serves the next root too

    def solve(self) -> Equilibrium:
        """Return the equilibrium under the full weight."""
        scale = max(float(np.linalg.norm(self.gravity)), 1.0)  # without gravity rounding is still that of the forces
        with installed(self.model, self.data):
            # Without gravity all steps are one.
            qpos, load, step = self.model.qpos0.copy(), 0.0, 1.0 / LOAD_STEPS if self.gravity.any() else 1.0
            # contacts or limits may act, which have no slope where parts just touch
            model, residual = self.model, 0.0
            touches = model.jnt_limited.any() or model.tendon_limited.any() or model.npair or model.geom_contype.any()
            while load < 1.0:
                trial_load = min(load + step, 1.0)
                self.model.opt.gravity[:] = trial_load * self.gravity
                trial, residual = self._root(qpos, TOLERANCE * scale)
                carried = residual <= ACCEPTED * scale  # not if it is no number
                if not carried and touches and not load:  # nothing carries weightless parts that just touch: no slope to follow
                    self.inverse = None
                    trial, residual = self._root(self._fall(qpos), TOLERANCE * scale)
                    carried = residual <= ACCEPTED * scale
                if self.tried > self.position_limit and not (carried and trial_load == 1.0):
                    raise ConvergenceError(
                        f"the search for the equilibrium was ended after {self.tried} trial positions, with {100 * load:.3g} % "
                        f"of the weight in equilibrium and body {self._fastest(trial)!r} accelerating by {residual:.3g} m/s^2: "
                        "it may exist. Use fewer modes of flexible parts, or laws that yield less suddenly under the weight."
                    )
                if not carried and step < 2.0 * SMALLEST_LOAD_STEP:
                    self._accelerations(qpos)  # back to the last load that was carried
                    raise ConvergenceError(self._diagnosis(trial_load, residual))
                if not carried:
                    step /= 2.0
                    self.inverse = None
                    continue
                qpos, load = trial, trial_load
                deflections = np.abs(self._mounts()[:, 0]).max(axis=1)
                if deflections.max(initial=0.0) > FARTHEST:
                    name = list(self.system.mounts)[int(np.argmax(deflections))]
                    raise ConvergenceError(
                        f"there is no equilibrium that mounts can bear: {100 * load:.3g} % of the weight deflects mount "
                        f"{name!r} by {deflections.max():.3g} m. {self._loads()}"
                    )
                if self.path is not None:
                    self._go_to(qpos)
                    self.path.rest_at(self.data)
            self._accelerations(qpos)
            mujoco.mj_forward(model, self.data)  # sensors too
            rows = self._mounts().copy()
            if fault := beyond_laws(self.system, rows[:, 0]):
                raise ConvergenceError(f"there is no equilibrium: mount {fault[0]!r} would stand {fault[1]}. {self._loads()}")
            state = state_of(model, self.data)
            return Equilibrium.of(self.system, state, rows, self.history, residual, self._unresisted(qpos))

    def _root(self, position: Array, tolerance: float) -> tuple[Array, float]:
        """Find the equilibrium next to `position`, and the largest acceleration there, > `tolerance` if the search failed.

        Newton's method for neighbouring equilibria, each with the last one's Jacobian. Broyden's updates (1965, his first)
        carry the inverse Jacobian along; a new one is taken from differences only where convergence slows. Directions without
        any stiffness are left as they are.
        """
        value = self._accelerations(position)
        for _ in range(ITERATIONS):
            if not largest(value) > tolerance or not np.isfinite(value).all():
                break
            fresh, inverse = self.inverse is None, self.inverse
            if inverse is None:
                # To both sides: where a load step begins a law is stiffer one way than the other, and one-sided columns of two
                # bodies that deflect the same mount against each other would take a slope each.
                columns = []
                for unit in DIFFERENCE * np.eye(self.free.size):
                    above, below = (self._accelerations(self._moved(position, side)) for side in (unit, -unit))
                    columns.append((above - below) / (2.0 * DIFFERENCE))
                jacobian = np.stack(columns, axis=1)
                inverse = np.zeros_like(jacobian)  # leads nowhere: the root is not found
                if np.isfinite(jacobian).all():
                    inverse = np.asarray(np.linalg.pinv(jacobian, rcond=INDIFFERENT))
            step = -inverse @ value
            step *= min(1.0, LONGEST / max(largest(step), 1e-12))
            for _halving in range(HALVINGS if fresh else 1):
                trial = self._moved(position, step)
                trial_value = self._accelerations(trial)
                if largest(trial_value) < largest(value):
                    break
                step *= 0.5
            else:
                self.inverse = None
                if fresh:
                    break
                continue
            expected = inverse @ (trial_value - value)
            agreement = float(step @ expected)
            # the inverse that maps the last change of the residual to the step; none where it no longer serves
            self.inverse = None
            if not (largest(trial_value) > SLOW * largest(value) or agreement < SLOW * float(step @ step)):
                self.inverse = np.asarray(inverse + np.outer(step - expected, step @ inverse) / agreement)
            position, value = trial, trial_value
        return position, largest(value)

    def _moved(self, qpos: Array, step: Array) -> Array:
        velocity, moved = np.zeros(self.model.nv), qpos.copy()
        velocity[self.free] = step
        mujoco.mj_integratePos(self.model, moved, velocity, 1.0)
        return moved

    def _accelerations(self, qpos: Array) -> Array:
        """Return MuJoCo's accelerations of the free coordinates at rest in `qpos`."""
        self.tried += 1
        self._go_to(qpos)
        if self.path is not None:
            first, states = self.system.assembly.activation, self.path.states_at(self.data)
            self.data.act[first : first + states.size] = states
        mujoco.mj_forwardSkip(self.model, self.data, mujoco.mjtStage.mjSTAGE_POS, WITHOUT_SENSORS)
        return self.data.qacc[self.free].copy()

    def _fall(self, qpos: Array) -> Array:
        """Let the system fall from a position, stopping each coordinate where its velocity reverses, to near an equilibrium."""
        linear = linear_system(self.system, closed=True)
        fastest = float(np.sqrt(max(np.linalg.eigvals(np.linalg.solve(linear.mass, linear.stiffness)).real.max(), 1.0)))
        step, velocity, tried = FALL / fastest, np.zeros(self.free.size), self.tried
        for _ in range(FALLING):
            acceleration = self._accelerations(qpos)
            velocity = np.where(velocity * acceleration < 0.0, 0.0, velocity + step * acceleration)
            qpos = self._moved(qpos, step * velocity)
        self.tried = tried
        return qpos

    def _go_to(self, qpos: Array) -> None:
        self.data.qpos[:], self.data.qvel[:] = qpos, 0.0
        mujoco.mj_fwdPosition(self.model, self.data)

    def _unresisted(self, qpos: Array) -> tuple[str, ...]:
        return unresisted(self.system, self.data, self.free, lambda step: self._accelerations(self._moved(qpos, step)))

    def _loads(self) -> str:
        """Describe where the weight comes from, and what to check."""
        mass = sum(payload.mass for payload in payloads_of(self.system))
        return (
            f"Gravity is {np.linalg.norm(self.gravity):.6g} m/s^2 and the mass on the mounts {mass:.6g} kg: check "
            "both, and the stiffness of the isolators."
        )

    def _mounts(self) -> Array:
        """Return deflection and force of every mount in the last position, (n_mounts, 2, 3)."""
        return self.system.assembly.tables.user.mount_rows(self.system.assembly.user(self.data.userdata))

    def _fastest(self, qpos: Array) -> str:
        fastest = self.free[int(np.argmax(np.abs(self._accelerations(qpos))))]
        return str(self.model.body(self.model.dof_bodyid[fastest]).name)

    def _diagnosis(self, load: float, residual: float) -> str:
        """Explain why the weight cannot be carried; `load` is the fraction of it that failed."""
        # What would rest on each under the whole weight:
        carried = self._mounts()[:, 1, 2] / max(load, SMALLEST_LOAD_STEP)
        for (name, mount), axial in zip(self.system.mounts.items(), carried, strict=True):
            law = mount.isolator.axes["axial"]
            if law is None or law.largest_force == np.inf:
                continue
            if self.history == "relaxed":
                return (
                    f"there is no relaxed equilibrium: the axial law of mount {name!r} has no elastic part, so that with "
                    "z = 0 it carries nothing. Use a law with an elastic part."
                )
            if abs(axial) > law.largest_force:
                return (
                    f"there is no equilibrium: mount {name!r} carries at most {law.largest_force:.4g} N along its axis (its "
                    f"law has no elastic part), but about {abs(axial):.4g} N would rest on it. Use a stiffer isolator, more "
                    "mounts, or a law with an elastic part."
                )
        qpos = self.data.qpos.copy()
        body = self._fastest(qpos)
        free = " ".join(self._unresisted(qpos))
        return (
            f"no equilibrium was found beyond {100 * load:.3g} % of the weight: body {body!r} still accelerates by "
            f"{residual:.3g} m/s^2. {free or self._loads()} Check that every direction has a mount with stiffness, and that "
            "the payload cannot tip over."
        )
