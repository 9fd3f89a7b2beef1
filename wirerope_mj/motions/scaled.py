"""Base motions made from another motion: at another level, or in another direction."""

from abc import abstractmethod
from collections.abc import Sequence
from dataclasses import dataclass, field
from functools import cached_property
from typing import Any, ClassVar

import numpy as np

from wirerope_mj.foundation.arrays import Array, ArrayLike
from wirerope_mj.foundation.directions import Direction, checked_direction, direction_text, unit_vector
from wirerope_mj.motions import ranges
from wirerope_mj.motions.motion import BaseMotion, Said, SumOfMotions, TargetSpectrum

Rows = tuple[tuple[float, float, float], tuple[float, float, float], tuple[float, float, float]]
_ORTHONORMAL = 1e-9  # largest error of a product of rows of a rotation: a matrix whose numbers were written with ten digits


def _forwarded(name: str) -> Any:
    return property(lambda self: getattr(self.motion, name))


@dataclass(frozen=True)
class _Transformed(BaseMotion):
    """Motion whose vectors are those of another motion times a matrix, at the same instants."""

    motion: BaseMotion
    duration: float = field(init=False, repr=False)

    def __post_init__(self) -> None:
        if not isinstance(self.motion, BaseMotion):
            raise ValueError(f"`motion` must be a base motion, got {self.motion!r}.")
        self._set(duration=self.motion.duration)

    @abstractmethod
    def _transformed(self, vectors: Array) -> Array:
        """Transform vectors of the other motion, (n, 3), to this motion's."""

    def _derivative(self, t: Array, order: int) -> Array:
        return self._transformed(self.motion._derivative(t, order))

    def _angles(self, t: Array, order: int) -> Array:
        return self._transformed(self.motion._angles(t, order))

    @property
    def velocity_jumps(self) -> tuple[tuple[float, Array], ...]:
        return tuple((time, self._transformed(jump[np.newaxis])[0]) for time, jump in self.motion.velocity_jumps)

    def load(self, site: str, time: ArrayLike) -> Array:
        return self.motion.load(site, time)  # along the site's axes, which turn with the body

    end, corners, loaded_sites, files = map(_forwarded, ("end", "corners", "loaded_sites", "files"))
    parts, targets = map(_forwarded, ("parts", "targets"))  # as they are before the change
    rotates, centre = map(_forwarded, ("rotates", "centre"))

    @cached_property
    def _said(self) -> Said:
        """Describe the motion after the other motion, whose description stands in brackets if it is a sum."""
        text = self.motion.description
        quoted = f"({text})" if isinstance(self.motion, SumOfMotions) else text
        return Said(self._described(quoted), self.motion.events, shortest_time=self.motion.shortest_time)

    @abstractmethod
    def _described(self, quoted: str) -> str:
        """Return the description of the motion from the other motion's."""


@dataclass(frozen=True)
class Scaled(_Transformed):
    """Another motion at another level: acceleration, velocity, displacement and velocity jumps times a factor.

    A record is scaled after its baseline correction.
    """

    kind: ClassVar[str] = "scaled"

    factor: float  #: not zero; negative for the motion with its sense reversed

    def __post_init__(self) -> None:
        super().__post_init__()
        if self.motion.up is not None:
            raise ValueError(f"a fall has no level but its height: change that. Got {self.motion.description}.")
        self._set(factor=ranges.level("factor", self.factor))

    @property
    def directions(self) -> Array:
        return self.motion.directions

    def _described(self, quoted: str) -> str:
        """Describe the motion in a line, such as `1.5 x half-sine 15 g 11 ms along z`."""
        return f"{self.factor:.4g} x {quoted}"

    def load(self, site: str, time: ArrayLike) -> Array:
        """Return the other motion's forces [N] and moments [N m] at a site times the factor, (n_t, 6)."""
        return self.factor * self.motion.load(site, time)

    def _transformed(self, vectors: Array) -> Array:
        return self.factor * vectors


@dataclass(frozen=True, init=False)
class Turned(_Transformed):
    """Another motion in another direction; exactly one of `rotation` and `direction` is given.

    Args:
        motion: the motion that is turned.
        rotation: rotation matrix R, (3, 3): the base moves along R v where the other motion moves along v.
        direction: `"x"`, `"y"`, `"z"` or a 3-vector into which the line of a motion along one line is turned, as if the
            motion had been written with it.
    """

    kind: ClassVar[str] = "turned"

    rotation: Rows | None
    direction: Direction | None

    def __init__(
        self, motion: BaseMotion, *, rotation: ArrayLike | None = None, direction: str | Sequence[float] | Array | None = None
    ) -> None:
        self._set(motion=motion)
        super().__post_init__()
        if motion.rotates:
            raise ValueError(
                f"a motion that rotates the base is not turned: write it about other axes. Got {motion.description}."
            )
        if (rotation is None) == (direction is None):
            raise ValueError(
                f"exactly one of `rotation` and `direction` must be given, got {'none' if rotation is None else 'both'}."
            )
        if direction is not None:
            self._set(rotation=None, direction=checked_direction(direction))
            _line(motion)  # raises if there is none
            return
        try:
            matrix = np.asarray(rotation, dtype=float)
        except (TypeError, ValueError):
            matrix = np.empty(0)
        if matrix.shape != (3, 3) or not np.all(np.isfinite(matrix)):
            raise ValueError(f"`rotation` must be a rotation matrix of 3 x 3 finite numbers, got {rotation!r}.")
        if np.abs(matrix @ matrix.T - np.eye(3)).max() > _ORTHONORMAL or np.linalg.det(matrix) < 0.0:
            raise ValueError(f"`rotation` must be orthonormal and not mirror, got {matrix.tolist()}.")
        self._set(rotation=tuple(map(tuple, matrix.tolist())), direction=None)

    @cached_property
    def matrix(self) -> Array:
        """Matrix from the other motion's vectors to this one's, (3, 3); with `direction` it holds on the motion's line only."""
        if self.direction is None:
            return np.array(self.rotation)
        return np.outer(unit_vector(self.direction), _line(self.motion))

    @property
    def up(self) -> Array | None:
        """Unit vector against gravity of the other motion, turned, (3,); None where nothing falls."""
        return None if self.motion.up is None else self._transformed(self.motion.up[np.newaxis])[0]

    @property
    def targets(self) -> tuple[TargetSpectrum, ...]:
        """Response spectra that the other motion was made for, turned."""
        turned = ((target, self._transformed(target.direction[np.newaxis])[0]) for target in self.motion.targets)
        return tuple(target._replace(direction=direction) for target, direction in turned)

    @property
    def directions(self) -> Array:
        return self._transformed(self.motion.directions)

    def _described(self, quoted: str) -> str:
        """Describe the motion: `half-sine 15 g 11 ms along z, turned to (0, 1, 1)`, or `.. by 30 deg about (0, 0, 1)`."""
        if self.direction is not None:
            return f"{quoted}, turned to {direction_text(self.direction)}"
        from scipy.spatial.transform import Rotation  # slow to import

        vector = Rotation.from_matrix(np.array(self.rotation)).as_rotvec(degrees=True)
        angle = float(np.linalg.norm(vector))
        if angle < 1e-6:
            return f"{quoted}, turned by 0 deg"
        x, y, z = (float(part) + 0.0 for part in np.round(vector / angle, 4))
        return f"{quoted}, turned by {angle:.4g} deg about {direction_text((x, y, z))}"

    def _transformed(self, vectors: Array) -> Array:
        # Sums of three products in this order, so that a row has the same bits however many there are.
        columns = vectors[:, :, np.newaxis] * self.matrix.T[np.newaxis]
        return columns[:, 0] + columns[:, 1] + columns[:, 2]


def _line(motion: BaseMotion) -> Array:
    """Return the unit vector of the line along which a motion moves, (3,); ValueError if it moves along several."""
    directions = motion.directions
    if np.linalg.matrix_rank(directions, tol=1e-9) != 1:
        raise ValueError(
            f"`direction` turns a motion along one line, and this one moves along {len(directions)} directions: "
            f"{motion.description}. Give `rotation`, a rotation matrix."
        )
    return np.asarray(directions[0] / np.linalg.norm(directions[0]))
