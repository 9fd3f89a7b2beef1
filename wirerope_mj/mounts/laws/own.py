"""A law that a program brings along: a class with the force as a function, in Python or compiled by Numba."""

import ctypes
import warnings
from abc import abstractmethod
from collections.abc import Callable, Mapping
from contextlib import suppress
from dataclasses import dataclass, fields
from functools import cache
from typing import ClassVar, Self

import numba
import numpy as np
from numba import carray, types
from numba.core.dispatcher import Dispatcher

from wirerope_mj.foundation.arguments import finite
from wirerope_mj.foundation.arrays import Array, Entries
from wirerope_mj.foundation.c_functions import SIGNATURE
from wirerope_mj.mounts.laws.law import Law
from wirerope_mj.mounts.laws.path import follow_path
from wirerope_mj.mounts.laws.registry import OWN

TRAVEL = 0.01  # deflection over which a law is tried unless it says its own [m]
RATE = 0.1  # deflection rate at which it is tried [m/s]
TINY = 1e-9  # deflection for the tangent of the unloaded law [m]: its curvature is nothing there
ROUNDING = 1e-6  # of forces and work that are compared: a thousand times the error of an integrated cycle
POINTER = types.CPointer(types.float64)


@dataclass(frozen=True, kw_only=True)
class OwnLaw(Law):
    """A law of one's own: derive a frozen dataclass from it whose fields are numbers, name its states, and write its force.

        @dataclass(frozen=True, kw_only=True)
        class Mine(wr.OwnLaw):
            name = "mine"
            state_names = ("z",)
            alpha: float
            beta: float
            k: float

            @staticmethod
            def force(p, x, v, z, zdot):
                alpha, beta, k = p
                zdot[0] = alpha * v - beta * abs(v) * z[0]
                return k * x + z[0]

    `force` takes the fields in their order p (n_p,), deflection x [m], rate v [m/s] and states z (n,), writes the states' rates
    to zdot (n,) and returns the force [N]. With `numba.njit` below `staticmethod` it is as fast as a law of the package; in
    Python each call takes microseconds, and a run of a floor minutes. It acts in simulations by MuJoCo's steps, in statics,
    modes, traces and cyclic tests; the kernel that steps systems side by side leaves it to MuJoCo.

    A new law is tried once: force and rates must be finite numbers that depend on the arguments alone, rates proportional to v,
    the force independent of v and 0 where it begins, and no closed cycle within `travel` may generate energy. ValueError says
    what is wrong. A viscous part stands beside it, in `Parallel`. It lives in memory: no file holds it.
    """

    name: ClassVar[str] = "own"
    kernel: ClassVar[int] = OWN
    state_names: ClassVar[tuple[str, ...]] = ()
    travel: ClassVar[float] = TRAVEL  # deflection up to which the law is tried [m]
    force_powers: ClassVar[Mapping[str, float]] = {}

    @staticmethod
    @abstractmethod
    def force(p: Array, x: float, v: float, z: Array, zdot: Array) -> float:
        """Return the force [N] and write the rates of the states to `zdot`."""

    def __post_init__(self) -> None:
        for item in fields(self):  # whatever their annotations say
            object.__setattr__(self, item.name, finite(item.name, getattr(self, item.name)))
        try:
            self._validate()
        except ValueError as error:
            raise ValueError(f"law {self.name!r}: {error}") from None

    def _validate(self) -> None:
        """Raise ValueError unless the function behaves as a law and no closed cycle generates energy."""
        if not self.state_names or isinstance(self.state_names, str):
            raise ValueError(f"`state_names` must name at least one state, got {self.state_names!r}; a curve is `Tabulated`.")
        for x, v in ((0.0, RATE), (self.travel, -RATE), (-self.travel, RATE)):
            force, rates = self._trial_call(x, v, np.zeros(self.n_states))
            again, _ = self._trial_call(x, v, np.zeros(self.n_states))
            if force != again:
                raise ValueError(f"`force` must depend on its arguments alone, got {force:.6g} N, then {again:.6g} N.")
            slower, half = self._trial_call(x, 0.5 * v, np.zeros(self.n_states))
            if not np.allclose(2.0 * half, rates, rtol=ROUNDING, atol=0.0) or abs(slower - force) > ROUNDING * abs(force):
                raise ValueError("`force` must not depend on the rate v, and `zdot` must be proportional to it.")
        force, _ = self._trial_call(0.0, RATE, np.zeros(self.n_states))
        if force != 0.0:
            raise ValueError(f"the force of the unloaded mount must be 0, got {force:.6g} N.")
        if not self.initial_stiffness > 0.0:
            raise ValueError(f"the tangent of the unloaded mount must be > 0, got {self.initial_stiffness:.6g} N/m.")
        for amplitude in (0.01 * self.travel, 0.1 * self.travel, self.travel):
            path = amplitude * np.interp(np.arange(0.0, 9.05, 0.1), np.arange(10), [0.0, *[1.0, -1.0] * 4, 1.0])
            force, _, work = follow_path(OWN, self.kernel_parameters(), path, np.zeros(self.n_states), self.n_states)
            if not np.isfinite(work).all():
                end = abs(path[np.argmin(np.isfinite(work))])
                raise ValueError(f"the force must be finite up to `travel` = {self.travel:g} m, got none at {end:.3g} m.")
            generated = work[-21] - work[-1]
            if generated > ROUNDING * amplitude * float(np.ptp(force)):
                raise ValueError(f"a closed cycle of {amplitude:g} m must not generate energy, got {generated:.6g} J.")

    def _trial_call(self, x: float, v: float, z: Array) -> tuple[float, Array]:
        """Call `force` once from Python; return the force [N] and the rates of the states, (n,)."""
        rates = np.full(self.n_states, np.nan)
        here = f"at x = {x:g} m, v = {v:g} m/s, z = {z.tolist()}"
        try:
            force = type(self).force(super().kernel_parameters(), x, v, z.copy(), rates)
        except Exception as error:
            raise ValueError(f"`force(p, x, v, z, zdot)` failed {here}: {type(error).__name__}: {error}") from None
        if not isinstance(force, float | int) or not np.isfinite(force):
            raise ValueError(f"`force` must return one finite number, got {force!r} {here}.")
        if not np.isfinite(rates).all():
            raise ValueError(f"`force` must write {self.n_states} finite rates to `zdot`, got {rates.tolist()} {here}.")
        return float(force), rates

    def kernel_parameters(self) -> Array:
        address = _address(type(self).force, len(fields(self)), self.n_states, self.name)
        return np.append(float(address), super().kernel_parameters())

    @property
    def initial_stiffness(self) -> float:
        """Tangent at the unloaded state [N/m], by a difference."""
        slopes = self._trial_call(0.0, 1.0, np.zeros(self.n_states))[1]
        forces = [self._trial_call(sign * TINY, sign, sign * TINY * slopes)[0] for sign in (1.0, -1.0)]
        return (forces[0] - forces[1]) / (2.0 * TINY)

    def same_structure(self, other: Law | None) -> bool:
        return self == other

    def multiplied(self, name: str, factor: float) -> Self:
        """Return the law with a factor of `FACTORS`; ValueError if it is on the force and `force_powers` are not stated."""
        if name == "stiffness" and factor != 1.0 and not self.force_powers:
            raise ValueError(f"law {self.name!r}: `force_powers` must state each parameter's power of force.")
        return super().multiplied(name, factor)

    def to_dict(self) -> Entries:
        raise ValueError(f"law {self.name!r} is a program's own and is not written to a file: keep the program.")


@cache
def _address(force: Callable[..., float], n_parameters: int, n_states: int, name: str) -> int:
    """Return the C address of a law's function, valid for the life of the process."""
    if isinstance(force, Dispatcher):

        def compiled(p, x, v, z, zdot):
            return force(carray(p, (n_parameters,)), x, v, carray(z, (n_states,)), carray(zdot, (n_states,)))

        callback = numba.cfunc(types.float64(POINTER, types.float64, types.float64, POINTER, POINTER))(compiled)
        _kept.append(callback)
        return int(callback.address)

    def numbers(address: int, count: int) -> Array:
        return np.frombuffer(memoryview((ctypes.c_double * count).from_address(address)))

    def called(p: int, x: float, v: float, z: int, zdot: int) -> float:
        try:
            with np.errstate(all="ignore"):
                return float(force(numbers(p, n_parameters), x, v, numbers(z, n_states), numbers(zdot, n_states)))
        except Exception as error:  # C knows no exceptions: a force that is not finite ends the run with its message
            with suppress(RuntimeWarning):
                warnings.warn(f"law {name!r} failed: {type(error).__name__}: {error}", RuntimeWarning, stacklevel=2)
            return float("nan")

    python = SIGNATURE(called)
    _kept.append(python)
    return int(ctypes.cast(python, ctypes.c_void_p).value or 0)


_kept: list[object] = []
