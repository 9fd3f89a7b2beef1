"""Deflections of mounts against their rated travel: along each axis, and along all of them at once."""

import numpy as np
import numpy.typing as npt

from wirerope_mj.criteria.sampled import sampled_peak
from wirerope_mj.criteria.verdict import EXCEEDED, Verdict
from wirerope_mj.response import Response
from wirerope_mj.response.scene import SceneMount

Array = npt.NDArray[np.float64]

RATINGS = {"compression": (2, -1.0), "tension": (2, 1.0), "shear": (1, 0.0), "roll": (0, 0.0)}
"""Rated travels: the mount's axis, and which way along it; 0 = both."""


COMBINED = "travel combined"
"""Name of the criterion on all axes at once."""


def travel_verdicts(response: Response) -> tuple[Verdict, ...]:
    """Return a verdict on every mount for compression, tension, shear, roll and for all of them combined.

    Deflections count from the unloaded mount, so that the sag is part of them. Beyond its rated compression a wire-rope
    isolator bottoms; for how long is in the note. Stops of the model are contacts, which a response does not hold: what
    they stop shows as a deflection that ends there.
    """
    found: list[Verdict] = []
    for mount in response.scene.mounts:
        deflection = response.mounts[mount.name].deflection
        found += [_along(response, mount, rating, deflection) for rating in RATINGS]
        found.append(_combined(response.time, mount, deflection))
    return tuple(found)


def _along(response: Response, mount: SceneMount, rating: str, deflection: Array) -> Verdict:
    """Return the verdict on one rated travel, from the peaks of every step."""
    axis, way = RATINGS[rating]
    peak = response.peaks.mounts[mount.name].deflection
    low, high = -float(peak.minimum[axis]), float(peak.maximum[axis])
    down = way < 0.0 or (way == 0.0 and low > high)
    verdict = Verdict(
        criterion=f"travel in {rating}",
        subject=mount.name,
        value=max(low if down else high, 0.0),
        limit=mount.travel.get(rating),
        unit="m",
        time=float(peak.minimum_time[axis] if down else peak.maximum_time[axis]),
        note="" if rating in mount.travel else f"no travel in {rating} is rated",
    )
    if verdict.verdict != EXCEEDED:
        return verdict
    toward = np.abs(deflection[:, axis]) if way == 0.0 else way * deflection[:, axis]
    beyond = int(np.count_nonzero(toward > mount.travel[rating])) * (response.time[1] - response.time[0])
    return Verdict(**{**vars(verdict), "note": f"beyond it for {1e3 * beyond:.3g} ms in all"})


def _combined(time: Array, mount: SceneMount, deflection: Array) -> Verdict:
    """Return the verdict on all axes at once: the largest sqrt(sum (deflection / rated)^2) against 1.

    No standard and no vendor gives a rule; an ellipsoid through the rated travels is this project's. With a rating missing,
    the sum of the others is a lower bound: it can exceed, but not be within.
    """
    total = np.zeros(time.size)
    missing = []
    for rating, (axis, way) in RATINGS.items():
        toward = np.abs(deflection[:, axis]) if way == 0.0 else np.clip(way * deflection[:, axis], 0.0, None)
        if rating in mount.travel:
            total += (toward / mount.travel[rating]) ** 2
        elif toward.any():
            missing.append(rating)
    square, when = sampled_peak(time, total)
    note = "sqrt of the sum of (deflection / rated)^2 at one instant"
    if missing:
        note += f"; no travel in {', '.join(missing)} is rated"
    return Verdict(
        criterion=COMBINED,
        subject=mount.name,
        value=float(np.sqrt(square)),
        limit=1.0 if not missing or square > 1.0 else None,
        unit="",
        time=when,
        note=note,
    )
