"""Utilisation of limits over time: what leads to a verdict, for curves, lanes and events."""

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from wirerope_mj.assessment.criteria.criterion import ACCELERATION, BOTTOMING, COMBINED, RATTLE_SPACE, TRAVEL, Criterion
from wirerope_mj.assessment.criteria.rattle import between_points, body_corners, corner_displacements
from wirerope_mj.assessment.criteria.sampled import read_columns
from wirerope_mj.assessment.criteria.travel import combined_travel
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
    criterion = verdict.criterion
    mount = next((mount for mount in response.scene.isolating if mount.name == verdict.subject), None)
    if criterion.kind == ACCELERATION:
        kind = "bodies" if verdict.subject in response.bodies else "points"
        value = _along(read_columns(response, f"{kind}/{verdict.subject}/acceleration/x", 3), criterion)
    elif criterion.kind == RATTLE_SPACE:
        value = _rattle(response, verdict.subject, criterion)
    elif mount is not None and criterion.kind in (TRAVEL, COMBINED, BOTTOMING):
        value = _travel(read_columns(response, f"mounts/{mount.name}/deflection/roll", 3), criterion, mount)
    else:
        return None
    return np.asarray(value / verdict.limit)


def _travel(deflection: Array, criterion: Criterion, mount: SceneMount) -> Array:
    if criterion == COMBINED:
        return combined_travel(mount, deflection)
    return travel_in("compression" if criterion == BOTTOMING else criterion.sense, deflection)


def _rattle(response: Response, subject: str, criterion: Criterion) -> Array:
    if subject not in response.points and BETWEEN in subject:
        return _along(between_points(response, subject), criterion)
    if subject in response.points:
        return _along(response.points[subject].relative_displacement, criterion)
    body = next(body for body in response.scene.bodies if body.name == subject)
    moved = corner_displacements(response, body, body_corners(body))
    return np.asarray(np.max([_along(corner, criterion) for corner in moved], axis=0))


def _along(values: Array, criterion: Criterion) -> Array:
    """Return components of vectors (n_t, 3) along the axis of a criterion, in its sense or both; without one their length."""
    if not criterion.axis:
        return np.asarray(np.linalg.norm(values, axis=1))
    along = values[:, "xyz".index(criterion.axis)]
    return np.maximum(along if criterion.sense == "+" else -along, 0.0) if criterion.sense else np.abs(along)
