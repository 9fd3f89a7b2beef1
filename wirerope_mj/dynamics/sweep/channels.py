"""What a sweep follows: accelerations, and deflections against the laws' ends and the isolators' ratings."""

import math
from dataclasses import dataclass

import numpy as np

from wirerope_mj.engine.system import System
from wirerope_mj.foundation.arrays import Array, Integers
from wirerope_mj.foundation.errors import SimulationError
from wirerope_mj.mounts.isolator.travel import RATINGS, travel_reached
from wirerope_mj.mounts.laws.law import ROUNDING

RAN_AWAY = 10.0  # finite travels beyond which a deflection is but the overflow of a law that has ended


@dataclass(frozen=True, kw_only=True)
class Channels:
    """Numbers of the peak tracker's channels."""

    base: int  # acceleration of the driven base
    names: tuple[str, ...]  # bodies that move and are not fixed to the base, payloads first
    bodies: Integers  # their accelerations, (n_bodies,)
    mounts: Integers  # deflections of the mounts, (n_mounts,)

    @classmethod
    def of(cls, system: System) -> "Channels":
        assembly = system.assembly
        every = assembly.subjects.body_names
        fixed = {every[channel] for channel in assembly.tables.base_channels if channel < len(every)}
        names = (*system.payloads, *(name for name in every if name not in fixed and name not in system.payloads))
        n_channels = assembly.tables.channels.size
        bodies = np.array([every.index(name) for name in names], dtype=np.int64)
        mounts = np.arange(n_channels - 2 * len(system.mounts), n_channels, 2)  # deflection, force of each
        return cls(base=every.index(system.base), names=names, bodies=bodies, mounts=mounts)


class Lawful:
    """How far the laws of all mounts hold."""

    def __init__(self, system: System) -> None:
        self._mounts = system.mounts
        axes = [mount.isolator.axes.values() for mount in system.mounts.values()]
        ends = [[(math.inf, math.inf) if law is None else law.travel_ends for law in laws] for laws in axes]
        self._ends = np.array(ends).reshape(-1, 3, 2)

    def require(self, frequency: Array, minimum: Array, maximum: Array) -> None:
        """Raise SimulationError at the first cycle in which a mount went to where its law does not hold.

        The cycles are given by frequencies [Hz], (n,), and extreme deflections [m], (n, n_mounts, 3).
        """
        reached = np.stack([-minimum, maximum], axis=-1)
        beyond = reached > self._ends + ROUNDING
        if not beyond.any():
            return
        row, number, index, side = np.argwhere(beyond)[0]
        name, mount = list(self._mounts.items())[number]
        axis, law = list(mount.isolator.axes.items())[index]
        assert law is not None  # what has no law has no end of it
        far, end = reached[row, number, index, side], law.travel_ends[side]
        went = f"reached {far:.4g} m" if far < RAN_AWAY * end else "ran away"
        raise SimulationError(
            f"at {frequency[row]:.5g} Hz mount {name!r} {went} on its {axis} axis, whose law holds up to {end:.4g} m, where "
            f"{law.travel_rule}. Shake more gently, or use an isolator with more travel."
        )


class TravelWatch:
    """The farthest travel of every mount during a sweep, and its frequency."""

    def __init__(self, system: System) -> None:
        self._rated = {name: mount.isolator.limits.travel.stated for name, mount in system.mounts.items()}
        self._largest = np.full((len(system.mounts), len(RATINGS)), -math.inf)
        self._at = np.zeros(self._largest.shape)

    def add(self, frequency: Array, minimum: Array, maximum: Array) -> None:
        """Take extreme deflections [m], (n, n_mounts, 3), at frequencies [Hz], (n,)."""
        reached = np.stack(list(travel_reached(minimum, maximum).values()), axis=-1)
        row = np.argmax(reached, axis=0)
        largest = np.take_along_axis(reached, row[np.newaxis], axis=0)[0]
        grown = largest > self._largest
        self._largest, self._at = np.where(grown, largest, self._largest), np.where(grown, frequency[row], self._at)

    def warnings(self) -> tuple[str, ...]:
        """Warn of every rated travel that was exceeded, where it was most."""
        return tuple(
            f"mount {name!r} goes {largest:.4g} m in {rating} at {frequency:.5g} Hz, beyond its rated {rated[rating]:.4g} m."
            for (name, rated), row, at in zip(self._rated.items(), self._largest, self._at, strict=True)
            for rating, largest, frequency in zip(RATINGS, row, at, strict=True)
            if largest > rated.get(rating, math.inf)
        )
