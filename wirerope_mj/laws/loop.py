"""A force-deflection loop and its measures."""

from dataclasses import dataclass, field

import numpy as np
import numpy.typing as npt


@dataclass(frozen=True, kw_only=True)
class Loop:
    """Force over deflection along a path, or over one cycle of a cyclic test.

    Attributes:
        deflection: path [m], (n_t,).
        force: restoring force [N], (n_t,).
        hysteretic_state: z [N], (n_t,); zero for a law without one.
        work: work done on the isolator since the first sample [J], (n_t,), integrated along the law's own segments
            where the loop comes from a law.
        cycles: cycles run before this one was kept; 0 for a plain trace.
        closure: distance between the last force and the first over the force range; NaN for a plain trace.
        internal_states: the law's internal states, (n_t, n_states); no columns where they are not known.
    """

    deflection: npt.NDArray[np.float64]
    force: npt.NDArray[np.float64]
    hysteretic_state: npt.NDArray[np.float64]
    work: npt.NDArray[np.float64]
    cycles: int = 0
    closure: float = float("nan")
    internal_states: npt.NDArray[np.float64] = field(default_factory=lambda: np.zeros((0, 0)), repr=False)

    @property
    def dissipated_energy(self) -> float:
        """Work done on the isolator over the whole path [J]: the loop's area if the path is a closed cycle."""
        return float(self.work[-1])

    @property
    def amplitude(self) -> float:
        """Half the range of the deflection [m]."""
        return float(np.ptp(self.deflection)) / 2.0

    @property
    def secant_stiffness(self) -> float:
        """K = [F(x_max) - F(x_min)] / (x_max - x_min) [N/m]."""
        top, bottom = int(np.argmax(self.deflection)), int(np.argmin(self.deflection))
        return float((self.force[top] - self.force[bottom]) / (self.deflection[top] - self.deflection[bottom]))

    @property
    def damping_ratio(self) -> float:
        """Equivalent viscous damping ratio W / (2 pi K A^2) of a closed cycle, W its area and K its secant stiffness."""
        return self.dissipated_energy / (2.0 * np.pi * self.secant_stiffness * self.amplitude**2)
