"""Cycles of the mounts of a run: their deflections and forces along every axis."""

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Literal

from wirerope_mj.assessment.durability.cycles import Cycles, rainflow_cycles
from wirerope_mj.engine.response import Response
from wirerope_mj.foundation.arguments import one_of
from wirerope_mj.mounts.isolator import AXES

Quantity = Literal["deflection", "force"]


@dataclass(frozen=True, kw_only=True)
class MountCycles:
    """Cycles of one axis of a mount: of its deflection [m] or its force [N]."""

    mount: str
    axis: str
    cycles: Cycles


def mount_cycles(response: Response, *, quantity: Quantity = "deflection") -> list[MountCycles]:
    """Return the cycles of every mount but stops along roll, shear and axial, in the order of the model.

    Samples are counted, not every step: a sampling rate of ten times the highest frequency that matters is enough.

    Args:
        response: of a run; of a long one each column is read by itself.
        quantity: "deflection" or "force".
    """
    one_of("quantity", quantity, ("deflection", "force"))
    mounts: Sequence[str] = [mount.name for mount in response.scene.mounts if not mount.stop]
    return [
        MountCycles(mount=name, axis=axis, cycles=rainflow_cycles(response.column(f"mounts/{name}/{quantity}/{axis}")))
        for name in mounts
        for axis in AXES
    ]
