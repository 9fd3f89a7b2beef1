"""Rates of a system's own motion from its mounts and joint springs, the step with which RK4 is stable, and its bounds."""

import mujoco
import numpy as np

from wirerope_mj.engine.kernel import layout as at
from wirerope_mj.engine.kernel.equations import equations
from wirerope_mj.engine.response.peaks import Peaks
from wirerope_mj.engine.statics.linear import linear_system
from wirerope_mj.engine.system import System, mount_rates, once_per_system
from wirerope_mj.foundation.arrays import Array, Booleans, ComplexArray
from wirerope_mj.mounts.laws.law import Law

# RK4 is stable for |lambda| h < 2.785 on the negative real axis and 2.828 on the imaginary one; a little less is used
RK4_LIMIT = 2.7
# angular frequency [rad/s] below which a mode is no oscillation on mounts, but a body that hangs or slides freely
SLOWEST_RATE = 1.0
ROUNDING = 1e-6  # fraction by which a bound must stay below the limit, to be one whatever is rounded
N_RATES = 5  # of a law, see `rates_of`


@once_per_system
def eigenvalues(system: System) -> ComplexArray:
    """Return the eigenvalues [1/s] of the linear system with unloaded mounts, base fixed, stops open, (2 n,)."""
    return _eigenvalues_of_system(system, closed=False)


def _eigenvalues_of_system(system: System, *, closed: bool) -> ComplexArray:
    """Return the eigenvalues [1/s] of a system with stops open or closed, (2 n,); n: motions that equalities leave free."""
    linear = linear_system(system, closed=closed)
    parts = (linear.motions.T @ part @ linear.motions for part in (linear.mass, linear.stiffness, linear.damping))
    return _eigenvalues_of_matrices(*parts) if linear.motions.size else np.zeros(0, dtype=np.complex128)


def _eigenvalues_of_matrices(inertia: Array, stiffness: Array, damping: Array) -> ComplexArray:
    """Return the eigenvalues [1/s] of linear systems, (..., 2 n), of matrices (..., n, n)."""
    inverse, n = np.linalg.inv(inertia), inertia.shape[-1]
    rates = np.zeros((*inertia.shape[:-2], 2 * n, 2 * n))  # of displacements and velocities
    rates[..., :n, n:] = np.eye(n)
    rates[..., n:, :n], rates[..., n:, n:] = -inverse @ stiffness, -inverse @ damping
    return np.asarray(np.linalg.eigvals(rates), dtype=np.complex128)


@once_per_system
def stable_step(system: System) -> float:
    """Return the largest step [s] with which RK4 is stable on the unloaded mounts and on all stops."""
    laws = [law for mount in system.mounts.values() for law in mount.isolator.axes.values() if law is not None]
    decay = max((law.relaxation_rate for law in laws), default=0.0)
    constraint = linear_system(system, closed=True).fastest_constraint if system.model.neq else 0.0
    fastest = max(float(np.abs(_eigenvalues_of_system(system, closed=True)).max(initial=0.0)), decay, constraint)
    return RK4_LIMIT / fastest if fastest > 0.0 else np.inf


def yield_rates(system: System, *, steep: bool = True) -> Array:
    """Return the largest n / x_y, exponent over yield deflection, of each mount axis [1/m], (n_mounts, 3); 0 if not hysteretic.

    A Bouc-Wen state near its bound tends to it at this times the rate of the deflection [1/s]. `steep`: whether states with
    n < 1 on axes that are not coupled count.
    """
    rates = np.zeros((len(system.mounts), 3))
    for number, mount in enumerate(system.mounts.values()):
        for axis, law in enumerate(mount.isolator.axes.values()):
            # of whose rate a bracket takes some, at the bound little
            for part in law.behind_bracket.components if law is not None else ():
                if steep or not part.unsmoothed.is_steep or axis in mount.isolator.coupled_axes:
                    rates[number, axis] = max(rates[number, axis], part.unsmoothed.yield_rate)
    return rates


def decay_over_step(system: System, peaks: Peaks, step: float) -> float:
    """Estimate the decay of the fastest hysteretic state towards its bound over a step [-]; see `yield_rates`.

    The deflection rate of a mount with the travel d is estimated as sqrt(a d), a the largest acceleration of a payload.
    """
    travel = np.array([mount.deflection.maximum - mount.deflection.minimum for mount in peaks.mounts.values()])
    moving = [name for name in system.payloads if name in peaks.bodies]  # one may be fixed, to drive the base
    acceleration = max((peaks.bodies[name].acceleration.value for name in moving), default=0.0)
    return step * float((_own_yield_rates(system) * np.sqrt(acceleration * travel.reshape(-1, 3))).max(initial=0.0))


_own_yield_rates = once_per_system(yield_rates)


def slowest_period(system: System) -> float:
    """Return the period of the slowest mode [s] for small amplitudes of the unloaded mounts, 1 s if nothing oscillates."""
    return float(_slowest_of(eigenvalues(system)))


def _slowest_of(eigenvalues: ComplexArray) -> Array:
    """Return the longest periods [s] of eigenvalues (..., n), 1 s where nothing oscillates."""
    rates = np.abs(eigenvalues.imag)
    slowest = np.where(rates > SLOWEST_RATE, rates, np.inf).min(axis=-1, initial=np.inf)
    return np.where(np.isfinite(slowest), 2.0 * np.pi / slowest, 1.0)


class VariantRates:
    """Bounds of the fastest, and periods of the slowest, natural motions of a system's variants, whose mounts may be shifted.

    With inertia M, stiffness K and damping C, symmetric and not negative, every eigenvalue is at most
    c / 2 + sqrt(c^2 / 4 + k), c and k the largest ones of M^-1 C and M^-1 K; these are at most the roots of the sums of the
    squares of all of them.
    """

    def __init__(self, system: System) -> None:
        """Compute how deflections and links move with the free coordinates, in the modelled geometry."""
        model, kernel_equations = system.model, equations(system)
        self._free = np.delete(np.arange(model.nv), system.assembly.driven_dofs)
        laws = [law for mount in system.mounts.values() for law in mount.isolator.axes.values()]
        self.own = np.array([rates_of(law) for law in laws]).reshape(-1, N_RATES).T  # of the system's laws, (5, 3 n_mounts)
        moving, turn_rates = np.zeros((2, 3, model.nv))
        with system.assembly.scratch.data(model) as data:
            mujoco.mj_fwdPosition(model, data)
            rates = np.array([*mount_rates(system, data)]).reshape(-1, 2, 3, model.nv)[..., self._free]
            axes = np.array([mount.axes.T for mount in system.mounts.values()]).reshape(-1, 3, 3)
            self._deflections = axes @ rates[:, 0]  # (n_mounts, 3, n_free)
            # what each shift of a mount along the world's axes adds to them, (n_mounts, 3, n_free, 3)
            swept = np.cross(rates[:, 1].swapaxes(1, 2)[:, :, np.newaxis], np.eye(3))
            self._by_shift = np.einsum("mac,mjkc->majk", axes, swept)
            links = kernel_equations.rows(at.LINKS, at.LINK_COLUMNS, kernel_equations.lay[at.N_LINKS])
            self._links = []
            bodies = np.flatnonzero((model.body_weldid == np.arange(model.nbody)) & (model.body_dofnum > 0))
            for body, row in zip(bodies.tolist(), links.tolist(), strict=True):
                mujoco.mj_jac(model, data, moving, turn_rates, data.xpos[body], body)
                axes = data.xmat[body].reshape(3, 3)
                parts = (axes.T @ moving)[:, self._free], (axes.T @ turn_rates)[:, self._free]
                self._links.append((int(row[at.INERTIA]), *parts))
        self._armature = np.diag(model.dof_armature[self._free])
        self._springs = kernel_equations.rows(at.DOFS, at.DOF_COLUMNS, model.nv)[self._free, at.DOF_NUM]
        self._turns = any(mount.isolator.rotation is not None for mount in system.mounts.values())

    def inertia(self, numbers: Array) -> Array:
        """Return the mass matrices of the free coordinates, (n, n_free, n_free), of variants with these numbers."""
        total = np.broadcast_to(self._armature, (len(numbers), *self._armature.shape)).copy()
        for first, moving, turn_rates in self._links:
            mass, centre = numbers[:, first + at.MASS_OF], numbers[:, first + at.CENTRE : first + at.CENTRE + 3]
            about = numbers[:, first + at.ABOUT + np.array([[0, 3, 4], [3, 1, 5], [4, 5, 2]])]
            velocity = moving + np.cross(turn_rates[np.newaxis], centre[:, :, np.newaxis], axis=1)
            total += mass[:, np.newaxis, np.newaxis] * (velocity.swapaxes(1, 2) @ velocity)
            total += turn_rates.T @ about @ turn_rates
        return total

    def certainly_stable(self, timestep: float, numbers: Array, rates: Array, shifts: Array) -> Booleans:
        """Return the variants for which a step [s] is certainly stable, (n,); `stable_step` decides on the others.

        `numbers` are those of the variants' equations, (n, n_num); `rates` of their laws, as `rates_of` has them, (n, 5, 3
        n_mounts); `shifts` those of their mounts along the world's axes [m], (n, n_mounts, 3).
        """
        if self._turns or not self._free.size:
            return np.zeros(len(numbers), dtype=np.bool_)
        inertia, (stiffness, damping, decay) = self.inertia(numbers), rates.swapaxes(0, 1)[:3]
        products = (np.linalg.solve(inertia, matrix) for matrix in self._matrices(numbers, stiffness, damping, shifts))
        k, c = (np.sqrt(np.maximum(np.einsum("nij,nji->n", product, product), 0.0)) for product in products)
        fastest = np.maximum(0.5 * c + np.sqrt(0.25 * c * c + k), decay.max(axis=1, initial=0.0))
        passive = (stiffness >= 0.0).all(axis=1) & (damping >= 0.0).all(axis=1)
        return np.asarray(passive & (fastest * timestep < (1.0 - ROUNDING) * RK4_LIMIT))

    def slowest_periods(self, numbers: Array, rates: Array, shifts: Array) -> Array:
        """Return the period of each variant's slowest mode [s], (n,); NaN where mounts resist turning."""
        if self._turns or not self._free.size:
            return np.full(len(numbers), np.nan)
        stiffness, damping = self._matrices(numbers, rates[:, 3], rates[:, 4], shifts)
        return _slowest_of(_eigenvalues_of_matrices(self.inertia(numbers), stiffness, damping))

    def _matrices(self, numbers: Array, stiffness: Array, damping: Array, shifts: Array) -> tuple[Array, Array]:
        """Return stiffness and damping matrices of the free coordinates, (n, n_free, n_free) each, from the laws' values."""
        moves = self._deflections + np.einsum("majk,nmk->nmaj", self._by_shift, shifts)
        moves = moves.reshape(len(numbers), -1, self._free.size)
        joints = (numbers[:, self._springs + at.STIFFNESS], numbers[:, self._springs + at.DAMPING])
        stiffnesses, dampings = (
            moves.swapaxes(1, 2) @ (values[:, :, np.newaxis] * moves) + of_joints[:, :, np.newaxis] * np.eye(of_joints.shape[1])
            for values, of_joints in zip((stiffness, damping), joints, strict=True)
        )
        return stiffnesses, dampings


def rates_of(law: Law | None) -> tuple[float, ...]:
    """Return closed stiffness [N/m] and damping [N s/m] of a law, its rate of decay [1/s], initial stiffness and damping."""
    if law is None:
        return (0.0,) * N_RATES
    closed = law.closed_stiffness, law.closed_damping, law.relaxation_rate
    return (*closed, law.initial_stiffness, law.damping_coefficient)


@once_per_system
def variant_rates(system: System) -> VariantRates:
    return VariantRates(system)
