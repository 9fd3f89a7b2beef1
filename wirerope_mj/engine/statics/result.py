"""Where a system rests: deflections and forces of its mounts, and the state to start from."""

from dataclasses import dataclass
from typing import Literal

from wirerope_mj.foundation.arrays import Array
from wirerope_mj.foundation.state import State

History = Literal["virgin", "relaxed"]


@dataclass(frozen=True, kw_only=True)
class MountLoad:
    """Deflection [m] and force [N] of a mount in its axes roll, shear, axial, (3,)."""

    deflection: Array
    force: Array


@dataclass(frozen=True, kw_only=True)
class Equilibrium:
    """Where a system rests.

    Attributes:
        state: integration state to start a simulation from.
        mounts: deflection and force of every mount.
        history: "virgin" (gravity applied slowly to the unloaded mounts) or "relaxed" (z = 0 throughout, after long
            vibration has let the hysteretic share of the load leak away).
        residual: largest acceleration left [m/s^2 or rad/s^2].
        free: a sentence for the motions of each body that no mount, joint or stop resists, such as the rotation of a body on
            mounts that stand in line.
    """

    state: State
    mounts: dict[str, MountLoad]
    history: History
    residual: float
    free: tuple[str, ...] = ()
