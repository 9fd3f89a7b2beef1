"""Forces of mounts: the static load against its rating, and the largest force of a run."""

import math
from collections.abc import Mapping

import numpy as np

from wirerope_mj.assessment.criteria.limits import payload_bodies
from wirerope_mj.assessment.criteria.sampled import read_start
from wirerope_mj.assessment.criteria.verdict import Verdict
from wirerope_mj.engine.response import Response
from wirerope_mj.engine.response.scene import SceneMount
from wirerope_mj.foundation.units import STANDARD_GRAVITY
from wirerope_mj.mounts.isolator.static_rating import static_load_unjudged

AT_REST = 1e-3 * STANDARD_GRAVITY
"""Acceleration below which the first sample is taken for rest: an equilibrium leaves far less, a falling payload 1 g."""


def starting_load_verdicts(response: Response) -> tuple[Verdict, ...]:
    """Return a verdict on the compression every mount carries at the start of the run against its rated static load.

    The rating holds for compression. A mount that hangs, or carries more across its axis than along it, is not judged, nor
    is a run that does not begin at rest in equilibrium.
    """
    moving = payload_bodies(response)
    start = [float(np.abs(read_start(response, f"bodies/{name}/acceleration/x", 3)).max()) for name in moving]
    rest = max(start, default=0.0) < AT_REST
    return tuple(
        _static(mount, read_start(response, f"mounts/{mount.name}/force/roll", 3), rest)
        for mount in response.scene.isolating
    )


def peak_force_verdicts(response: Response, limits: Mapping[str, float] | None = None) -> tuple[Verdict, ...]:
    """Return a verdict on the largest force of every mount, for what it is bolted to.

    Args:
        response: of a run.
        limits: largest force [N] by name of the mount; no isolator file rates one.

    Raises:
        ValueError: a limit names no mount.
    """
    allowed = dict(limits or {})
    for name in allowed:
        if name not in response.mounts:
            raise ValueError(f"`limits` name {name!r}, which is no mount. There are: {', '.join(response.mounts)}.")
    found = []
    for name in response.mounts:
        peak, limit = response.peaks.mounts[name].force, allowed.get(name)
        note = "" if limit is not None else "no largest force is rated"
        found.append(
            Verdict(
                criterion="peak force", subject=name, value=peak.value, limit=limit, unit="N", time=peak.time, note=note
            )
        )
    return tuple(found)


def _static(mount: SceneMount, force: np.ndarray, rest: bool) -> Verdict:
    """Return the verdict on the static load of one mount."""
    note = static_load_unjudged(force, mount.static_load)
    if not rest and not math.isnan(mount.static_load):
        note = "the run does not begin at rest in equilibrium"
    return Verdict(
        criterion="static load in compression",
        subject=mount.name,
        value=max(-float(force[2]), 0.0),
        limit=None if note else mount.static_load,
        unit="N",
        note=note,
    )
