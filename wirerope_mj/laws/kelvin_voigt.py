"""Linear spring and viscous damper in parallel."""

from dataclasses import dataclass
from typing import ClassVar

import numpy as np
import numpy.typing as npt

from wirerope_mj.laws import kernels
from wirerope_mj.laws.law import Law, require_not_negative
from wirerope_mj.laws.loop import Loop


@dataclass(frozen=True, kw_only=True)
class KelvinVoigt(Law):
    """Kelvin-Voigt law F = k x + c xdot, k [N/m], c [N s/m]; loss factor eta = omega c / k."""

    name: ClassVar[str] = "kelvin-voigt"
    kernel: ClassVar[int] = kernels.KELVIN_VOIGT
    rate_independent: ClassVar[bool] = False

    k: float
    c: float

    def _validate(self) -> None:
        require_not_negative(self, "k", "c")
        if self.k == 0.0 and self.c == 0.0:
            raise ValueError("`k` and `c` must not both be 0: leave the axis out of the isolator instead.")

    def kernel_parameters(self) -> npt.NDArray[np.float64]:
        """Return k, c."""
        return np.array([self.k, self.c])

    @property
    def initial_stiffness(self) -> float:
        """Stiffness k [N/m]."""
        return self.k

    @property
    def damping_coefficient(self) -> float:
        """Damping c [N s/m]."""
        return self.c

    def _trace(
        self, path: npt.NDArray[np.float64], time: npt.ArrayLike | None, states: npt.NDArray[np.float64]
    ) -> Loop:
        instants = require_time(self, path, time)
        # Second-order differences are exact for a parabola.
        rate = np.gradient(path, instants, edge_order=2 if path.size > 2 else 1)
        force = self.k * path + self.c * rate
        elastic = self.k * (path**2 - path[0] ** 2) / 2.0
        power = self.c * rate**2
        dissipated = np.concatenate([[0.0], np.cumsum(np.diff(instants) * (power[1:] + power[:-1]) / 2.0)])
        return Loop(deflection=path, force=force, hysteretic_state=np.zeros(path.size), work=elastic + dissipated)


def require_time(law: Law, path: npt.NDArray[np.float64], time: npt.ArrayLike | None) -> npt.NDArray[np.float64]:
    """Return `time` as an array (n_t,) [s], or raise ValueError if it does not fit the path of a rate-dependent law."""
    if time is None:
        raise ValueError(f"`time` must be given: the force of {law.name} depends on the deflection rate.")
    instants = np.asarray(time, dtype=np.float64)
    if instants.shape != path.shape or not np.isfinite(instants).all() or (np.diff(instants) <= 0.0).any():
        raise ValueError(f"`time` must be strictly increasing and of shape {path.shape}, got shape {instants.shape}.")
    return instants
