"""What every restoring-force law has in common."""

import math
from abc import ABC, abstractmethod
from dataclasses import asdict, dataclass
from typing import Any, ClassVar

import numpy as np
import numpy.typing as npt

from wirerope_mj.laws.loop import Loop
from wirerope_mj.laws.path import follow_path


@dataclass(frozen=True, kw_only=True)
class Law(ABC):
    """Restoring-force law of one isolator axis: force [N] from deflection [m], its rate [m/s] and internal states.

    Subclasses are frozen parameter sets. `name` is the word for the law in an isolator file, `kernel` its number in
    `wirerope_mj.laws.kernels`.
    """

    name: ClassVar[str]
    kernel: ClassVar[int]
    state_names: ClassVar[tuple[str, ...]] = ()
    rate_independent: ClassVar[bool] = True

    def __post_init__(self) -> None:
        for key, value in asdict(self).items():
            if isinstance(value, bool) or not isinstance(value, int | float):
                raise ValueError(f"`{key}` must be a number, got {value!r}.")
            if not math.isfinite(value):
                raise ValueError(f"`{key}` must be finite, got {value}.")
        self._validate()

    @abstractmethod
    def _validate(self) -> None:
        """Raise ValueError if the parameters are not those of a passive law."""

    @abstractmethod
    def kernel_parameters(self) -> npt.NDArray[np.float64]:
        """Return the parameters in the order that the law's kernel reads, (n_p,)."""

    @property
    @abstractmethod
    def initial_stiffness(self) -> float:
        """Tangent of the force at the unloaded state [N/m]."""

    @property
    @abstractmethod
    def damping_coefficient(self) -> float:
        """Largest derivative of the force by the deflection rate [N s/m]; 0 for a rate-independent law."""

    @property
    def finite_travel(self) -> float:
        """Deflection at which the force becomes infinite [m]; infinite for a law that is defined everywhere."""
        return math.inf

    @property
    def n_states(self) -> int:
        """Number of internal states."""
        return len(self.state_names)

    def to_dict(self) -> dict[str, Any]:
        """Return the law as it stands in an isolator file."""
        return {"law": self.name, **asdict(self)}

    def trace(
        self,
        deflection: npt.ArrayLike,
        *,
        time: npt.ArrayLike | None = None,
        initial_states: npt.ArrayLike | None = None,
    ) -> Loop:
        """Return the loop that the law draws along a path of deflections, entered unloaded.

        Between samples the deflection runs monotonely, so that the result of a rate-independent law depends on the
        turning points alone, neither on time nor on the number of samples.

        Args:
            deflection: path [m], (n_t,), at least two finite samples.
            time: strictly increasing instants [s], (n_t,); required by laws whose force depends on the rate.
            initial_states: internal states at the first sample, (n_states,); zero by default.

        Raises:
            ValueError: the path is not a finite series, a rate-dependent law has no `time`, or the force leaves the
                finite numbers along the path.
        """
        path = np.asarray(deflection, dtype=np.float64)
        if path.ndim != 1 or path.size < 2 or not np.isfinite(path).all():
            raise ValueError(f"`deflection` must be a series of at least 2 finite numbers, got shape {path.shape}.")
        states = np.zeros(self.n_states) if initial_states is None else np.array(initial_states, dtype=np.float64)
        if states.shape != (self.n_states,):
            raise ValueError(f"`initial_states` must have shape ({self.n_states},), got {states.shape}.")
        return self._trace(path, time, states)

    def _trace(
        self, path: npt.NDArray[np.float64], time: npt.ArrayLike | None, states: npt.NDArray[np.float64]
    ) -> Loop:
        del time  # a rate-independent law does not know it
        force, history, work = follow_path(self.kernel, self.kernel_parameters(), path, states, self.n_states)
        finite = np.isfinite(force) & np.isfinite(work)
        if not finite.all():
            first = path[np.argmin(finite)]
            raise ValueError(f"the force of {self} leaves the finite numbers at a deflection of {first:.6g} m.")
        z = history[:, 0] if self.n_states else np.zeros(path.size)
        return Loop(deflection=path, force=force, hysteretic_state=z, work=work, internal_states=history)


def require_not_negative(law: Law, *names: str) -> None:
    """Raise ValueError unless the named parameters of `law` are >= 0."""
    for name in names:
        if getattr(law, name) < 0.0:
            raise ValueError(f"`{name}` must be >= 0, got {getattr(law, name)}.")
