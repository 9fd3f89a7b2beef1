"""Utilisation of limits over time: what leads to a verdict, for curves, lanes and events."""

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from wirerope_mj.assessment.criteria.rattle import between_points, body_corners, corner_displacements
from wirerope_mj.assessment.criteria.sampled import read_columns
from wirerope_mj.assessment.criteria.travel import BOTTOMING, COMBINED, combined_travel
from wirerope_mj.assessment.criteria.verdict import Verdict
from wirerope_mj.engine.response import Response
from wirerope_mj.engine.response.scene import SceneMount
from wirerope_mj.foundation.arrays import Array
from wirerope_mj.foundation.payload_limits import BETWEEN
from wirerope_mj.mounts.isolator.travel import travel_in


@dataclass(frozen=True, kw_only=True)
class Used:
    """What a mount, a body or a point uses of its limits.

    Attributes:
        subject: its name.
        verdicts: on it, those that change over time, the largest utilisation first.
        course: largest utilisation of them at each sample, (n_t,); peaks of every step may lie a little above.
    """

    subject: str
    verdicts: tuple[Verdict, ...]
    course: Array

    @property
    def governing(self) -> Verdict:
        """The verdict with the largest utilisation."""
        return self.verdicts[0]

    @property
    def largest(self) -> float:
        """Its utilisation, over every step."""
        return self.governing.utilisation or 0.0


def used_limits(response: Response, verdicts: Sequence[Verdict]) -> list[Used]:
    """Return what has limits that it uses more or less of over time, the largest utilisation first."""
    by_subject: dict[str, list[tuple[Verdict, Array]]] = {}
    for verdict in verdicts:
        course = utilisation_over_time(response, verdict)
        if course is not None:
            by_subject.setdefault(verdict.subject, []).append((verdict, course))
    used = []
    for subject, pairs in by_subject.items():
        pairs.sort(key=lambda pair: pair[0].utilisation or 0.0, reverse=True)
        rows, courses = zip(*pairs, strict=True)
        used.append(Used(subject=subject, verdicts=rows, course=np.max(courses, axis=0)))
    return sorted(used, key=lambda one: one.largest, reverse=True)


def utilisation_over_time(response: Response, verdict: Verdict) -> Array | None:
    """Return value over limit at each sample, (n_t,); None where nothing is judged, or it does not change over time."""
    if verdict.limit is None or verdict.utilisation is None:
        return None
    what, _, which = verdict.criterion.partition(" along ")
    mount = next((mount for mount in response.scene.isolating if mount.name == verdict.subject), None)
    if what == "acceleration":
        kind = "bodies" if verdict.subject in response.bodies else "points"
        value = _along(read_columns(response, f"{kind}/{verdict.subject}/acceleration/x", 3), which)
    elif what == "rattle space":
        value = _rattle(response, verdict.subject, which)
    elif mount is not None and what.startswith(("travel", BOTTOMING)):
        value = _travel(read_columns(response, f"mounts/{mount.name}/deflection/roll", 3), verdict, mount)
    else:
        return None
    return np.asarray(value / verdict.limit)


def _travel(deflection: Array, verdict: Verdict, mount: SceneMount) -> Array:
    if verdict.criterion == COMBINED:
        return combined_travel(mount, deflection)
    rating = verdict.criterion.removeprefix("travel in ")
    return travel_in("compression" if rating == BOTTOMING else rating, deflection)


def _rattle(response: Response, subject: str, which: str) -> Array:
    if subject not in response.points and BETWEEN in subject:
        return _along(between_points(response, subject), which)
    if subject in response.points:
        return _along(response.points[subject].relative_displacement, which)
    body = next(body for body in response.scene.bodies if body.name == subject)
    moved = corner_displacements(response, body, body_corners(body))
    return np.asarray(np.max([_along(corner, which) for corner in moved], axis=0))


def _along(values: Array, which: str) -> Array:
    """Return components of vectors (n_t, 3) along "x" (both ways), "-x" or "+x", or their length for ""."""
    if not which:
        return np.asarray(np.linalg.norm(values, axis=1))
    along = values[:, "xyz".index(which[-1])]
    return np.abs(along) if len(which) == 1 else np.maximum(along if which[0] == "+" else -along, 0.0)
