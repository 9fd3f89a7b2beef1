"""Rattle space: displacements of points and corners of bodies from their modelled position relative to the base."""

import itertools
from collections.abc import Iterator, Sequence

import numpy as np

from wirerope_mj.assessment.criteria.sampled import peak_between, read_columns, sampled_peak, sampled_text
from wirerope_mj.assessment.criteria.verdict import RATTLE_SPACE, Criterion, Verdict, limits_by_name, one_each, payload_bodies
from wirerope_mj.engine.response import Peak, Response
from wirerope_mj.engine.response.scene import Geom, SceneBody
from wirerope_mj.foundation.arrays import Array
from wirerope_mj.foundation.directions import rotation_matrices
from wirerope_mj.foundation.payload_limits import BETWEEN, PayloadLimit

UNLIMITED = "no clearance is stated"


def rattle_verdicts(response: Response, limits: Sequence[PayloadLimit] | None = None) -> tuple[Verdict, ...]:
    """Return verdicts on the displacements of every point, and of the corners of every payload body, in world axes.

    Displacements count from the modelled geometry, so that the sag is part of them. Corners are those of the box, along the
    body's axes, around its own geoms; each body is judged by the corner that moves farthest in a direction.

    Args:
        response: of a run.
        limits: of kind "clearance", of points, of bodies, or between two points, "rack_1 to rack_2"; without them the model's
            own. Three values along x, y, z hold both ways, six along -x, +x, -y, +y, -z, +z; zero is not judged.

    Raises:
        ValueError: a limit names neither a point nor a body with geoms.
    """
    corners = {
        body.name: box
        for body in response.scene.bodies
        if body.name in payload_bodies(response) and (box := body_corners(body)).size
    }
    pairs = [f"{one}{BETWEEN}{other}" for one, other in itertools.permutations(response.points, 2)]
    stated = limits_by_name(response, limits, "clearance", [*response.points, *corners], pairs)
    verdicts: list[Verdict] = []
    for name in response.points:
        peak = response.peaks.points[name].relative_displacement
        verdicts += _judge(name, peak.value, peak.time, _sides(peak), stated.get(name), "", "")
    for body in response.scene.bodies:
        if body.name in corners:
            verdicts += _judge_corners(response, body, corners[body.name], stated.get(body.name))
    for name in (name for name in pairs if name in stated):
        one, other = (response.points[end] for end in name.split(BETWEEN))
        moved, rate = between_points(response, name), one.velocity - other.velocity
        length = sampled_peak(response.time, np.linalg.norm(moved, axis=1))
        sides = _sampled_sides(response.time, moved, rate)
        verdicts += _judge(name, *length, sides, stated[name], "between two points", sampled_text(response.time))
    return tuple(one_each(verdicts))


def between_points(response: Response, name: str) -> Array:
    """Return how far the first of two points, "a to b", moved relative to the second [m], (n_t, 3), from as modelled."""
    one, other = name.split(BETWEEN)
    return response.points[one].relative_displacement - response.points[other].relative_displacement


# Displacement one way [m], its instant [s], and by how much it may be larger between the samples [m].
Side = tuple[float, float, float]


def _sampled_sides(time: Array, moved: Array, rate: Array) -> list[Side]:
    """Return how far something that moves at a rate went along -x, +x, -y, +y, -z, +z."""
    return [peak_between(time, sign * moved[:, axis], sign * rate[:, axis]) for axis in range(3) for sign in (-1.0, 1.0)]


def body_corners(body: SceneBody) -> Array:
    """Return the corners of the box around a body's geoms, planes left out, from its centre of mass, body axes [m], (n, 3)."""
    boxes = [_box(geom) for geom in body.geoms if geom.shape != "plane"]
    if not boxes:
        return np.zeros((0, 3))
    low, high = np.min([box[0] for box in boxes], axis=0), np.max([box[1] for box in boxes], axis=0)
    return np.array([[x, y, z] for x in (low[0], high[0]) for y in (low[1], high[1]) for z in (low[2], high[2])])


def corner_displacements(response: Response, body: SceneBody, corners: Array) -> Iterator[Array]:
    """Yield the displacement of one corner after the other from its modelled position relative to the base [m], (n_t, 3)."""
    moved = read_columns(response, f"bodies/{body.name}/position/x", 7)  # and the orientation
    turns = rotation_matrices(moved[:, 3:]) - rotation_matrices(body.orientation)  # (n_t, 3, 3)
    centre = moved[:, :3] - body.position - response.base.displacement
    for corner in corners:
        yield centre + turns @ corner


def _corner_rates(response: Response, body: SceneBody, corners: Array) -> Iterator[Array]:
    """Yield the velocity of one corner after the other relative to the base [m/s], (n_t, 3)."""
    moved = read_columns(response, f"bodies/{body.name}/orientation/w", 10)  # velocity and angular velocity, too
    axes, centre = rotation_matrices(moved[:, :4]), moved[:, 4:7] - response.base.velocity
    for corner in corners:
        yield centre + np.cross(moved[:, 7:], axes @ corner)


def _judge_corners(response: Response, body: SceneBody, corners: Array, limit: PayloadLimit | None) -> list[Verdict]:
    """Return the verdicts on a body by the corners that move farthest."""
    farthest, corner, time = (-1.0, 0.0), corners[0], response.time
    every: list[list[Side]] = []
    for position, moved in zip(corners, corner_displacements(response, body, corners), strict=True):
        reached = sampled_peak(time, np.linalg.norm(moved, axis=1))
        if reached > farthest:
            farthest, corner = reached, position
    if limit is not None:
        motions = zip(corner_displacements(response, body, corners), _corner_rates(response, body, corners), strict=True)
        every = [_sampled_sides(time, moved, rate) for moved, rate in motions]
    sides = [_farthest(side) for side in zip(*every, strict=True)]
    offset = ", ".join(f"{1e3 * x:.4g}" for x in corner)
    note = f"corner at {offset} mm from the centre of mass" if limit is None else "the corner that moves farthest"
    return _judge(body.name, *farthest, sides, limit, note, sampled_text(time))


def _farthest(sides: Sequence[Side]) -> Side:
    """Return the side of the corner that went farthest, and how much farther one of them may have gone."""
    value, when, _ = max(sides)
    return value, when, max(reached + above for reached, _, above in sides) - value


# Fraction of a clearance by which something may have gone farther between the samples and still be judged.
MISSED = 0.01


def _judge(
    name: str, value: float, when: float, sides: Sequence[Side], limit: PayloadLimit | None, note: str, sampled: str
) -> list[Verdict]:
    """Return one verdict on the length of the displacement without a limit, else one on every direction."""
    # Not judged is what may be `MISSED` between samples, unless it is exceeded already.
    if limit is None:
        note = "; ".join(part for part in (note, UNLIMITED) if part)
        return [
            Verdict(criterion=Criterion(RATTLE_SPACE), subject=name, value=value, limit=None, unit="m", time=when, note=note)
        ]
    allowed = limit.values if len(limit.values) == 6 else tuple(v for v in limit.values for _ in range(2))
    verdicts = []
    for side, room in enumerate(allowed):
        reached, then, above = sides[side]
        unknown = above > MISSED * room and reached <= room
        why = f"{sampled}, too few to know it within {100.0 * MISSED:g} %" if unknown and room else "" if room else UNLIMITED
        verdicts.append(Verdict(
            criterion=Criterion(RATTLE_SPACE, axis="xyz"[side // 2], sense="-+"[side % 2]), subject=name,
            value=max(reached, 0.0), limit=None if unknown else room or None, unit="m", time=then,
            note="; ".join(part for part in (note, why) if part),
        ))  # fmt: skip
    return verdicts


def _sides(peak: Peak) -> list[Side]:
    """Return how far something went along -x, +x, -y, +y, -z, +z, as every step tells."""
    sides = []
    for axis in range(3):
        sides.append((-float(peak.minimum[axis]), float(peak.minimum_time[axis]), 0.0))
        sides.append((float(peak.maximum[axis]), float(peak.maximum_time[axis]), 0.0))
    return sides


def _box(geom: Geom) -> tuple[Array, Array]:
    """Return the lowest and highest corner of the box around a geom, in body axes [m]."""
    turn = rotation_matrices(geom.orientation)
    if geom.shape == "mesh":
        vertices = geom.position + geom.vertices @ turn.T
        return vertices.min(axis=0), vertices.max(axis=0)
    a, b, c = geom.size.tolist()
    halves = {"sphere": (a, a, a), "capsule": (a, a, a + b), "cylinder": (a, a, b)}.get(geom.shape, (a, b, c))
    reach = np.abs(turn) @ np.array(halves)
    return geom.position - reach, geom.position + reach
