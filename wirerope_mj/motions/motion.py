"""Base motions: acceleration, velocity and displacement that are exact closed forms of each other."""

import inspect
import math
from abc import ABC, abstractmethod
from collections.abc import Callable, Iterable, Mapping
from dataclasses import dataclass, field
from functools import cached_property
from pathlib import Path
from typing import ClassVar, NamedTuple

import numpy as np

from wirerope_mj.foundation.arguments import as_times
from wirerope_mj.foundation.arrays import Array, ArrayLike, Entries
from wirerope_mj.foundation.directions import Direction, direction_text, unit_vector
from wirerope_mj.foundation.summary import AsCall
from wirerope_mj.motions.phrases import SpokenMotion
from wirerope_mj.motions.rotation import angular_motion, swing

# corners closer than this are one corner [s]: far below any step, far above the roundoff of a time of hours
SAME_TIME = 1e-10
# number of instants below which one product with all components is fastest; above it a product for each component is
_FEW_INSTANTS = 200


class Said(NamedTuple):
    """Description of a motion: a line for a human reader, events (instants [s] and short texts), shortest time scale [s]."""

    description: str
    events: tuple[tuple[float, str], ...]
    shortest_time: float


class TargetSpectrum(NamedTuple):
    """Response spectrum that a motion was made for: points (frequency [Hz], acceleration [m/s^2]), damping, direction."""

    points: tuple[tuple[float, float], ...]  # straight on logarithmic axes between them
    damping: float  # damping ratio of the oscillators
    direction: Array  # unit vector, (3,)


class BaseMotion(ABC):
    """Translation and rotation of the driven base as functions of time, in the world frame.

    A base that rotates, `rotates`, turns by its roll, pitch and yaw, R = Rz(yaw) Ry(pitch) Rx(roll), about `centre`, a point of
    the base; acceleration, velocity and displacement are those of the base's own origin.

    At a corner the acceleration and the velocity have the value just after it (they are continuous from the right).
    Nothing is compensated in secret: a pulse leaves the base coasting at the pulse's velocity change.
    """

    kind: ClassVar[str]  # name of the motion in stored files
    phrases: ClassVar[tuple[SpokenMotion, ...]] = ()  # its phrases in commands, jobs and files of levels
    # constructor arguments and the attributes that hold them under other names; `quantity` says which of several such is held
    renamed: ClassVar[Mapping[str, str]] = {}

    # length of the motion [s]: of a pulse or a record from its own start, of a sweep from start to stop, of a sum from time
    # zero; infinite for an endless sine. `end` is the instant after which it is over.
    duration: float

    def acceleration(self, time: ArrayLike) -> Array:
        """Return the base's acceleration [m/s^2] at the times [s], (n_t, 3)."""
        return self._of_origin(as_times(time), 2)

    def velocity(self, time: ArrayLike) -> Array:
        """Return the base's velocity [m/s] at the times [s], (n_t, 3)."""
        return self._of_origin(as_times(time), 1)

    def displacement(self, time: ArrayLike) -> Array:
        """Return the base's displacement [m] at the times [s], (n_t, 3)."""
        return self._of_origin(as_times(time), 0)

    def angular_displacement(self, time: ArrayLike) -> Array:
        """Return the base's roll, pitch and yaw [rad] at the times [s], (n_t, 3)."""
        return self._angles(as_times(time), 0)

    def angular_velocity(self, time: ArrayLike) -> Array:
        """Return the base's angular velocity [rad/s] at the times [s], world axes, (n_t, 3)."""
        return angular_motion(*self._turning(as_times(time)))[0]

    def angular_acceleration(self, time: ArrayLike) -> Array:
        """Return the base's angular acceleration [rad/s^2] at the times [s], world axes, (n_t, 3)."""
        return angular_motion(*self._turning(as_times(time)))[1]

    def _of_origin(self, t: Array, order: int) -> Array:
        moved = self._derivative(t, order)
        return moved + swing(np.array(self.centre), order, *self._turning(t)) if self.rotates and any(self.centre) else moved

    @abstractmethod
    def _derivative(self, t: Array, order: int) -> Array:
        """Return displacement (order 0), velocity (1) or acceleration (2) of the centre at the times, (n_t, 3)."""

    def _angles(self, t: Array, order: int) -> Array:
        """Return roll, pitch and yaw (order 0) or their first and second derivatives (1, 2) at the times, (n_t, 3)."""
        return np.zeros((t.size, 3))

    def _turning(self, t: Array) -> tuple[Array, Array, Array]:
        """Return the angles of rotation [rad] and their first and second derivatives by time, (n, 3) each."""
        return self._angles(t, 0), self._angles(t, 1), self._angles(t, 2)

    @property
    def rotates(self) -> bool:
        """Whether the base rotates."""
        return False

    @property
    def centre(self) -> tuple[float, float, float]:
        """Point of the base about which it rotates, from the base's own origin as modelled, world axes [m]."""
        return 0.0, 0.0, 0.0

    @property
    def end(self) -> float:
        """Instant after which the motion is over [s]."""
        return self.duration

    @property
    def corners(self) -> Array:
        """Instants where velocity, acceleration or one of its derivatives jumps [s], sorted and unique, (n,).

        By default the instants of the motion's events.
        """
        return unique_times(time for time, _ in self.events)

    @property
    def velocity_jumps(self) -> tuple[tuple[float, Array], ...]:
        """Instants [s] at which the velocity jumps and the jumps (3,) [m/s]; `acceleration` does not contain them."""
        return ()

    @property
    def description(self) -> str:
        """Description of the motion in a line, for a human reader."""
        return self._said.description

    @property
    def events(self) -> tuple[tuple[float, str], ...]:
        """Events: instants [s] and short texts, in order of time."""
        return self._said.events

    @property
    def shortest_time(self) -> float:
        """Shortest time scale of the motion between two corners [s], to choose a step from; infinite if it has none."""
        return self._said.shortest_time

    @cached_property
    def _said(self) -> Said:
        """Description, events and shortest time scale of the motion, as the three properties above return them."""
        raise NotImplementedError

    @property
    @abstractmethod
    def directions(self) -> Array:
        """Vectors that span the directions in which the base moves, (n, 3)."""

    @property
    def up(self) -> Array | None:
        """Unit vector against gravity where the base falls onto a floor, (3,); None where nothing falls."""
        return None

    @property
    def initial(self) -> str:
        """Default start state of a simulation: "settled", or "unloaded" where the base falls."""
        return "settled" if self.up is None else "unloaded"

    @property
    def loaded_sites(self) -> tuple[str, ...]:
        """Sites of the payload at which the motion has forces; empty except for `PayloadForce` and sums with it."""
        return ()

    def load(self, site: str, time: ArrayLike) -> Array:
        """Return force [N] and moment [N m] at a site of the payload at the times [s], along the site's axes, (n_t, 6)."""
        return np.zeros((as_times(time).size, 6))

    @property
    def files(self) -> tuple[Path, ...]:
        """Files that the motion was read from and that are needed to rebuild it."""
        return ()

    @property
    def targets(self) -> tuple[TargetSpectrum, ...]:
        """Response spectra that the motion was made for, at their own level whatever the motion is scaled by."""
        return ()

    @property
    def doubt(self) -> str:
        """Question whether a unit in the motion's phrase is wrong, such as s for ms; "" without a doubt."""
        return ""

    @property
    def parts(self) -> "tuple[BaseMotion, ...]":
        """Elementary motions of which this motion is made by adding, scaling and turning; itself if it is elementary."""
        return (self,)

    def to_dict(self, *, files: Mapping[Path, str] | None = None) -> Entries:
        """Return every parameter as plain TOML values, from which `motion_from_dict` rebuilds the motion exactly.

        Args:
            files: what to write instead of the path of each of `self.files`, for instance the name of the copy that
                stands beside the stored parameters. A file that is not named keeps its absolute path.
        """
        return {"kind": self.kind, **self._parameters(files or {})}

    @classmethod
    def maker(cls) -> "Callable[..., BaseMotion]":
        """Return the callable that makes the motion from parameters that `to_dict` stored, in any version."""
        return cls

    def _parameters(self, files: Mapping[Path, str]) -> Entries:
        """Return the constructor's arguments as plain values, without those that are None or infinite."""
        stated = {name: self._argument(name) for name in inspect.signature(type(self)).parameters}
        return {name: _plain(value, files) for name, value in stated.items() if value is not None and value != math.inf}

    def _argument(self, name: str) -> object:
        """Return the value of a constructor's argument; None if the attribute holds another argument's value."""
        other = name in self.renamed and name != getattr(self, "quantity", name)
        return None if other else getattr(self, self.renamed.get(name, name))

    def _set(self, **values: object) -> None:
        for name, value in values.items():
            object.__setattr__(self, name, value)

    def __add__(self, other: "BaseMotion") -> "SumOfMotions":
        """Return the motion that is the sum of the two."""
        if not isinstance(other, BaseMotion):
            return NotImplemented
        return SumOfMotions(terms=(*_terms(self), *_terms(other)))


class StraightMotion(BaseMotion):
    """Base motion along one direction; a subclass gives the scalar functions of time."""

    direction: Direction

    @cached_property
    def unit(self) -> Array:
        """Unit vector of the direction, (3,)."""
        return unit_vector(self.direction)

    @property
    def directions(self) -> Array:
        """The unit vector of the direction, (1, 3)."""
        return self.unit[np.newaxis]

    def _derivative(self, t: Array, order: int) -> Array:
        """Return the derivative by time of this order, (n, 3): that along the line times the line's unit vector."""
        along = self._along(t, order)
        if along.size < _FEW_INSTANTS:
            return along[:, np.newaxis] * self.unit
        vectors = np.empty((along.size, 3))
        for axis, component in enumerate(self.unit):
            np.multiply(along, component, out=vectors[:, axis])
        return vectors

    @abstractmethod
    def _along(self, t: Array, order: int) -> Array:
        """Return displacement (order 0), velocity (1) or acceleration (2) along the direction, (n_t,)."""


class StartedMotion(StraightMotion):
    """Base motion along one direction that begins at its `start`."""

    start: float  # instant at which the motion begins [s]

    @property
    def end(self) -> float:
        """Instant at which the motion is over [s]."""
        return self.start + self.duration

    @property
    def _line_text(self) -> str:
        return f"along {direction_text(self.direction)}" + (f" at {self.start:.4g} s" if self.start else "")


_MOST_DESCRIBED = 6  # motions of a sum that are described one by one


@dataclass(frozen=True, kw_only=True, repr=False)
class SumOfMotions(AsCall, BaseMotion):
    """Several base motions at once; made by `a + b`."""

    kind: ClassVar[str] = "sum"

    terms: "tuple[BaseMotion, ...]"  # the motions that are added, none of them a sum itself
    duration: float = field(init=False, repr=False)

    def __post_init__(self) -> None:
        if not self.terms:
            raise ValueError("`terms` must hold at least one motion, got none.")
        self._set(terms=tuple(part for term in self.terms for part in _terms(term)))
        if sum(term.up is not None for term in self.terms) > 1:
            raise ValueError("a base falls once: give one drop, the others are load cases of their own.")
        if len({term.centre for term in self.terms if term.rotates}) > 1:
            raise ValueError(
                "a base rotates about one point: give all motions that rotate it the same place aboard (`position`)."
            )
        self._set(duration=max(term.end for term in self.terms))

    def _derivative(self, t: Array, order: int) -> Array:
        return np.asarray(sum(term._derivative(t, order) for term in self.terms))

    def _angles(self, t: Array, order: int) -> Array:
        return np.asarray(sum(term._angles(t, order) for term in self.terms))

    @cached_property
    def rotates(self) -> bool:
        """Whether a term rotates the base; angles of several add."""
        return any(term.rotates for term in self.terms)

    @property
    def centre(self) -> tuple[float, float, float]:
        """Centre of the terms that rotate the base."""
        return next((term.centre for term in self.terms if term.rotates), (0.0, 0.0, 0.0))

    @cached_property
    def corners(self) -> Array:
        return unique_times(np.concatenate([term.corners for term in self.terms]))

    @property
    def velocity_jumps(self) -> tuple[tuple[float, Array], ...]:
        """Velocity jumps of all terms; jumps at the same instant are added."""
        jumps: list[tuple[float, Array]] = []
        all_jumps = (jump for term in self.terms for jump in term.velocity_jumps)
        for time, change in sorted(all_jumps, key=lambda jump: jump[0]):
            if jumps and time - jumps[-1][0] <= SAME_TIME:
                jumps[-1] = (jumps[-1][0], jumps[-1][1] + change)
            else:
                jumps.append((time, change))
        return tuple(jumps)

    @cached_property
    def _said(self) -> Said:
        """Describe all terms; of more than six, such as dwells of a table, the first and the last only."""
        texts = [term.description for term in self.terms]
        events = sorted((event for term in self.terms for event in term.events), key=lambda event: event[0])
        if len(texts) > _MOST_DESCRIBED:
            texts = [texts[0], f".. {len(texts) - 2} more ..", texts[-1]]
            events = [events[0], events[-1]] if events else []
        return Said(" + ".join(texts), tuple(events), shortest_time=min(term.shortest_time for term in self.terms))

    @property
    def directions(self) -> Array:
        return np.concatenate([term.directions for term in self.terms])

    @property
    def up(self) -> Array | None:
        """Unit vector against gravity of the first term that falls, (3,); None where nothing falls."""
        return next((term.up for term in self.terms if term.up is not None), None)

    @property
    def initial(self) -> str:
        """Default start state of a simulation: the falling term's."""
        return next((term.initial for term in self.terms if term.up is not None), "settled")

    @property
    def loaded_sites(self) -> tuple[str, ...]:
        return tuple(dict.fromkeys(site for term in self.terms for site in term.loaded_sites))

    def load(self, site: str, time: ArrayLike) -> Array:
        """Return the sum of all terms' forces [N] and moments [N m] at a site, (n_t, 6)."""
        return np.asarray(sum(term.load(site, time) for term in self.terms))

    @property
    def files(self) -> tuple[Path, ...]:
        return tuple(dict.fromkeys(path for term in self.terms for path in term.files))

    @property
    def targets(self) -> tuple[TargetSpectrum, ...]:
        return tuple(target for term in self.terms for target in term.targets)

    @property
    def parts(self) -> "tuple[BaseMotion, ...]":
        return tuple(part for term in self.terms for part in term.parts)


def unique_times(times: Iterable[float] | Array) -> Array:
    """Return the instants [s] sorted; of those within `SAME_TIME` of their neighbour only the first stays."""
    ordered = np.sort(np.fromiter(times, dtype=float) if not isinstance(times, np.ndarray) else times)
    return ordered[np.diff(ordered, prepend=-np.inf) > SAME_TIME]


def _plain(value: object, files: Mapping[Path, str]) -> object:
    """Convert a parameter to plain values: lists for tuples, tables for motions."""
    if isinstance(value, BaseMotion):
        return value.to_dict(files=files)
    return [_plain(item, files) for item in value] if isinstance(value, tuple) else value


def _terms(motion: BaseMotion) -> "tuple[BaseMotion, ...]":
    return motion.terms if isinstance(motion, SumOfMotions) else (motion,)
