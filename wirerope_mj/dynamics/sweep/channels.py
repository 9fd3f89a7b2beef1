"""Channels of the peak tracker: accelerations of bodies and of the base, deflections of mounts."""

from dataclasses import dataclass

import numpy as np
import numpy.typing as npt

from wirerope_mj.engine.system import System


@dataclass(frozen=True, kw_only=True)
class Channels:
    """Numbers of the peak tracker's channels.

    Attributes:
        base: acceleration of the driven base.
        names: bodies that move and are not fixed to the base, payloads first.
        bodies: their accelerations, (n_bodies,).
        mounts: deflections of the mounts, (n_mounts,).
    """

    base: int
    names: tuple[str, ...]
    bodies: npt.NDArray[np.int64]
    mounts: npt.NDArray[np.int64]

    @classmethod
    def of(cls, system: System) -> "Channels":
        """Return the channels of a system with a driven base."""
        assembly = system.assembly
        every = assembly.subjects.body_names
        fixed = {every[channel] for channel in assembly.tables.base_channels if channel < len(every)}
        others = [name for name in every if name not in fixed and name not in system.payloads]
        names = (*system.payloads, *others)
        n_channels = assembly.tables.channels.size
        return cls(
            base=every.index(system.base),
            names=names,
            bodies=np.array([every.index(name) for name in names], dtype=np.int64),
            mounts=np.arange(n_channels - 2 * len(system.mounts), n_channels, 2),  # deflection, force of each
        )
