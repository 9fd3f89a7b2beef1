"""What is known of unknowns before a test: distributions, sampled through independent standard normals."""

from collections.abc import Callable, Mapping
from dataclasses import dataclass
from typing import Self

import numpy as np
import scipy

from wirerope_mj.foundation.arrays import Array
from wirerope_mj.studies.inputs.distributions import LARGEST, SMALLEST, Normal, Uniform


@dataclass(frozen=True, kw_only=True)
class Prior:
    """Distributions of unknowns."""

    names: tuple[str, ...]  # of the unknowns
    units: tuple[str, ...]  # of their values; "" for factors
    quantiles: Callable[[Array], Array]  # maps probabilities (n, d) to values (n, d)

    @classmethod
    def of(cls, distributions: Mapping[str, Normal | Uniform]) -> Self:
        """Make the prior of independent unknowns without units."""
        own = tuple(distributions.values())
        return cls(
            names=tuple(distributions),
            units=("",) * len(own),
            quantiles=lambda p: np.stack([one.values(p[:, k]) for k, one in enumerate(own)], axis=1),
        )

    @property
    def size(self) -> int:
        """Number of unknowns d."""
        return len(self.names)

    def values(self, normals: Array) -> Array:
        """Return the values (n, d) at independent standard normals (n, d)."""
        return self.quantiles(np.clip(scipy.special.ndtr(normals), SMALLEST, LARGEST))
