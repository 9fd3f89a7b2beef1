"""Whether a mount is pressed flat: its compression against its own height."""

import math

from wirerope_mj.assessment.criteria.verdict import Verdict
from wirerope_mj.engine.response import Response


def bottoming_verdicts(response: Response) -> tuple[Verdict, ...]:
    """Return a verdict on the largest compression of every mount against the height of the unloaded device.

    The rated compression, less than that, is where the vendor says that a mount bottoms: see `travel_verdicts`. At its height
    its bars would meet. No law knows that end, so that what is beyond it cannot happen: a stop is missing in the model.
    """
    found = []
    for mount in response.scene.isolating:
        deflection = response.peaks.mounts[mount.name].deflection
        unknown = math.isnan(mount.height)
        verdict = Verdict(
            criterion="bottoming",
            subject=mount.name,
            value=max(-float(deflection.minimum[2]), 0.0),
            limit=None if unknown else mount.height,
            unit="m",
            time=float(deflection.minimum_time[2]),
            note="the isolator states no height" if unknown else "compression against the height of the unloaded mount",
        )
        found.append(verdict)
    return tuple(found)
