"""Limits of the payload: peak accelerations, shock response spectra against test spectra, and the rattle space around it."""

import itertools
from collections.abc import Iterator, Sequence

import numpy as np

from wirerope_mj.assessment.criteria.sampled import has_peak, peak_between, read_columns, sampled_peak, sampled_text
from wirerope_mj.assessment.criteria.verdict import (
    ACCELERATION,
    RATTLE_SPACE,
    Amplification,
    Criterion,
    Verdict,
    largest_each,
    limits_by_name,
    payload_bodies,
)
from wirerope_mj.engine.response import Response
from wirerope_mj.engine.response.scene import SceneBody
from wirerope_mj.foundation.arrays import Array, ArrayLike
from wirerope_mj.foundation.directions import rotation_matrices
from wirerope_mj.foundation.payload_limits import BETWEEN, PayloadLimit
from wirerope_mj.motions.spectra import ShockResponseSpectrum

UNIT = "m/s^2"
UNLIMITED = "no limit is stated"


def acceleration_verdicts(response: Response, limits: Sequence[PayloadLimit] | None = None) -> tuple[Verdict, ...]:
    """Judge the largest absolute acceleration of every payload body and every point.

    A limit of one value applies to the norm of the vector, one of three values to its components. Accelerations without a
    limit are not judged.

    Args:
        response: of a run.
        limits: of kind "acceleration"; without them the model's own.

    Raises:
        ValueError: a limit names neither a body nor a point.
    """
    bodies, points = payload_bodies(response), list(response.points)
    driven = response.peaks.bodies.get(response.scene.base)
    base = driven.acceleration.value if driven is not None and has_peak(response.motion) else 0.0
    stated = limits_by_name(response, limits, "acceleration", [*bodies, *points])
    verdicts: list[Verdict] = []
    for names, peaks in ((bodies, response.peaks.bodies), (points, response.peaks.points)):
        for name in names:
            peak = peaks[name].acceleration
            amplified = Amplification(measure="peak", value=peak.value, base=base) if base > 0.0 else None
            allowed = stated[name].values if name in stated else (0.0,)
            rows = [("", peak.value, peak.time, allowed[0])]
            if len(allowed) > 1:
                lows, highs = (peak.minimum, peak.minimum_time), (peak.maximum, peak.maximum_time)
                ends = [lows if -peak.minimum[i] > peak.maximum[i] else highs for i in range(3)]
                rows = [
                    (axis, float(abs(value[i])), float(when[i]), allowed[i])
                    for i, (axis, (value, when)) in enumerate(zip("xyz", ends, strict=True))
                ]
            verdicts += [
                Verdict(
                    criterion=Criterion(ACCELERATION, axis=axis), subject=name, value=value, limit=limit or None, unit=UNIT,
                    time=when, note="" if limit else UNLIMITED, amplification=amplified,
                )
                for axis, value, when, limit in rows
            ]  # fmt: skip
    return tuple(largest_each(verdicts))


def spectrum_verdict(
    spectrum: ShockResponseSpectrum, frequency: ArrayLike, acceleration: ArrayLike, *, subject: str,
    criterion: str = "shock response spectrum",
) -> Verdict:  # fmt: skip
    """Judge a maximax spectrum against a test spectrum, at the frequency of the highest utilisation.

    Not part of `judge`: call it with a measured test spectrum.

    Equipment that stood a test bears every shock whose spectrum lies below the test's, at the same Q. Only frequencies are
    judged that both have.

    Args:
        spectrum: of the acceleration where the equipment stands; of several directions, the largest counts.
        frequency: of the test spectrum's points [Hz], increasing.
        acceleration: of the test spectrum's points [m/s^2]; straight between them on logarithmic axes.
        subject: what is judged.
        criterion: what the verdict is called.

    Raises:
        ValueError: the points do not make a curve, or have no frequency in common with the spectrum.
    """
    f, v = (np.atleast_1d(np.asarray(values, dtype=np.float64)) for values in (frequency, acceleration))
    if f.ndim != 1 or f.shape != v.shape or not f.size:
        raise ValueError(f"`test spectrum` must be as many frequencies as values, got the shapes {f.shape} and {v.shape}.")
    if not (np.isfinite(f).all() and np.isfinite(v).all() and f.min() > 0.0 and v.min() > 0.0):
        raise ValueError("`test spectrum` must hold finite frequencies and values > 0.")
    if not (np.diff(f) > 0.0).all():
        raise ValueError(f"`test spectrum` must have increasing frequencies, got {', '.join(f'{x:.6g}' for x in f[:8])}.")
    values = spectrum.maximax if spectrum.maximax.ndim == 1 else spectrum.maximax.max(axis=1)
    inside = (spectrum.frequencies >= f[0] * (1.0 - 1e-9)) & (spectrum.frequencies <= f[-1] * (1.0 + 1e-9))
    allowed = np.exp(np.interp(np.log(spectrum.frequencies), np.log(f), np.log(v)))
    ratio = np.where(inside, values / allowed, -np.inf)
    worst = int(ratio.argmax())
    if not np.isfinite(ratio[worst]):
        low, high = spectrum.frequencies[[0, -1]]
        raise ValueError(
            f"`frequency` of the test spectrum, {f[0]:.6g} to {f[-1]:.6g} Hz, does not overlap the "
            f"spectrum's {low:.6g} to {high:.6g} Hz."
        )
    judged = spectrum.frequencies[np.isfinite(ratio)]
    note = f"at {spectrum.frequencies[worst]:.4g} Hz, Q = {spectrum.q:g}; judged from {judged[0]:.4g} to {judged[-1]:.4g} Hz"
    if judged[0] > f[0] * 1.06 or judged[-1] < f[-1] / 1.06:  # a twelfth of an octave
        note += f" of {f[0]:.4g} to {f[-1]:.4g} Hz"
    return Verdict(
        criterion=Criterion(criterion), subject=subject, value=float(values[worst]), limit=float(allowed[worst]),
        unit="m/s^2", note=note,
    )  # fmt: skip


NO_CLEARANCE = "no clearance is stated"


def rattle_verdicts(response: Response, limits: Sequence[PayloadLimit] | None = None) -> tuple[Verdict, ...]:
    """Judge the displacements of every point, and of the corners of every payload body, in world axes.

    Displacements count from the modelled geometry, so that the sag is part of them. Corners are those of the box, along the
    body's axes, around its own geoms; each body is judged by the corner that moves farthest in a direction.

    Args:
        response: of a run.
        limits: of kind "clearance", of points, of bodies, or between two points, "rack_1 to rack_2"; without them the model's
            own. Three values along x, y, z hold both ways, six along -x, +x, -y, +y, -z, +z; zero is not judged.

    Raises:
        ValueError: a limit names neither a point nor a body with geoms.
    """
    time, sampled, payload = response.time, sampled_text(response.time), payload_bodies(response)
    corners = {body.name: box for body in response.scene.bodies if body.name in payload and (box := body_corners(body)).size}
    pairs = [f"{first}{BETWEEN}{second}" for first, second in itertools.permutations(response.points, 2)]
    stated = limits_by_name(response, limits, "clearance", [*response.points, *corners], pairs)

    def sampled_sides(moved: Array, rate: Array) -> list[Side]:
        return [peak_between(time, sign * moved[:, axis], sign * rate[:, axis]) for axis in range(3) for sign in (-1.0, 1.0)]

    verdicts: list[Verdict] = []
    for name in response.points:
        peak = response.peaks.points[name].relative_displacement
        sides: list[Side] = []  # from the peaks of every step
        for axis in range(3):
            sides.append((-float(peak.minimum[axis]), float(peak.minimum_time[axis]), 0.0))
            sides.append((float(peak.maximum[axis]), float(peak.maximum_time[axis]), 0.0))
        verdicts += _clearance_verdicts(name, (peak.value, peak.time), sides, stated.get(name), note="", sampled="")
    for body in response.scene.bodies:
        if body.name not in corners:
            continue
        limit, box = stated.get(body.name), corners[body.name]
        farthest, corner = (-1.0, 0.0), box[0]
        for position, moved in zip(box, corner_displacements(response, body, box), strict=True):
            reached = sampled_peak(time, np.linalg.norm(moved, axis=1))
            if reached > farthest:
                farthest, corner = reached, position
        note, sides = "the corner that moves farthest", []
        if limit is None:
            note = f"corner at {', '.join(f'{1e3 * x:.4g}' for x in corner)} mm from the centre of mass"
        else:
            motion = read_columns(response, f"bodies/{body.name}/position/x", 13)  # up to its angular velocity
            centre, orientation, velocity, angular = np.split(motion, (3, 7, 10), axis=1)
            arms = (rotation_matrices(orientation) @ place for place in box)
            every = [
                sampled_sides(
                    moved,
                    response.velocity_from_base(centre + arm, velocity, np.cross(angular, arm)),
                )
                for arm, moved in zip(arms, corner_displacements(response, body, box), strict=True)
            ]
            for side in zip(*every, strict=True):  # of the farthest corner, and how much farther any corner may have gone
                value, when, _ = max(side)
                sides.append((value, when, max(reached + above for reached, _, above in side) - value))
        verdicts += _clearance_verdicts(body.name, farthest, sides, limit, note, sampled)
    for name in (name for name in pairs if name in stated):
        first, second = (response.points[end] for end in name.split(BETWEEN))
        moved = between_points(response, name)
        length = sampled_peak(time, np.linalg.norm(moved, axis=1))
        rate = first.velocity - second.velocity
        if response.base_rotation is not None:
            rate = np.subtract(*(response.velocity_from_base(end.position, end.velocity) for end in (first, second)))
        sides = sampled_sides(moved, rate)
        verdicts += _clearance_verdicts(name, length, sides, stated[name], "between two points", sampled)
    return tuple(largest_each(verdicts))


def between_points(response: Response, name: str) -> Array:
    """Compute the displacement of the first of two points, "a to b", relative to the second from as modelled [m], (n_t, 3)."""
    first, second = name.split(BETWEEN)
    return response.points[first].relative_displacement - response.points[second].relative_displacement


# Displacement one way [m], its instant [s], and by how much it may be larger between the samples [m].
Side = tuple[float, float, float]


def body_corners(body: SceneBody) -> Array:
    """Find the corners of the box around a body's geoms, planes left out, from its centre of mass, body axes [m], (n, 3)."""
    lows, highs = [], []
    for geom in (geom for geom in body.geoms if geom.shape != "plane"):
        rotation = rotation_matrices(geom.orientation)
        if geom.shape == "mesh":
            vertices = geom.position + geom.vertices @ rotation.T
            lows.append(vertices.min(axis=0))
            highs.append(vertices.max(axis=0))
        else:
            a, b, c = geom.size.tolist()
            half_sizes = {"sphere": (a, a, a), "capsule": (a, a, a + b), "cylinder": (a, a, b)}.get(geom.shape, (a, b, c))
            half_extents = np.abs(rotation) @ np.array(half_sizes)
            lows.append(geom.position - half_extents)
            highs.append(geom.position + half_extents)
    if not lows:
        return np.zeros((0, 3))
    low, high = np.min(lows, axis=0), np.max(highs, axis=0)
    return np.array([[x, y, z] for x in (low[0], high[0]) for y in (low[1], high[1]) for z in (low[2], high[2])])


def corner_displacements(response: Response, body: SceneBody, corners: Array) -> Iterator[Array]:
    """Yield the displacement of one corner after the other from its modelled position relative to the base [m], (n_t, 3)."""
    position, orientation = np.split(read_columns(response, f"bodies/{body.name}/position/x", 7), (3,), axis=1)
    axes, modelled = rotation_matrices(orientation), rotation_matrices(body.orientation)
    centre = response.displacement_from_base(position, body.position)
    if (base := response.base_rotation) is not None:
        axes = np.swapaxes(base, 1, 2) @ axes
    turns = axes - modelled  # (n_t, 3, 3)
    for corner in corners:
        yield centre + turns @ corner


# Fraction of a clearance that a displacement may exceed its largest sample by and still be judged.
MISSED = 0.01


def _clearance_verdicts(
    name: str, length: tuple[float, float], sides: Sequence[Side], limit: PayloadLimit | None, note: str, sampled: str
) -> list[Verdict]:
    """Make a verdict on the displacement's norm and instant if there is no limit, else one for each limited direction."""
    # A direction is not judged if more than `MISSED` may lie between the samples, unless its limit is exceeded already.
    if limit is None:
        note, (value, when) = f"{note}; {NO_CLEARANCE}" if note else UNLIMITED, length
        criterion = Criterion(RATTLE_SPACE)
        return [Verdict(criterion=criterion, subject=name, value=value, limit=None, unit="m", time=when, note=note)]
    allowed = limit.values if len(limit.values) == 6 else tuple(v for v in limit.values for _ in range(2))
    verdicts = []
    for side, (room, (reached, when, above)) in enumerate(zip(allowed, sides, strict=True)):
        unknown = above > MISSED * room and reached <= room
        why = f"{sampled}, too few to know it within {100.0 * MISSED:g} %" if unknown and room else "" if room else NO_CLEARANCE
        verdicts.append(Verdict(
            criterion=Criterion(RATTLE_SPACE, axis="xyz"[side // 2], sense="-+"[side % 2]), subject=name,
            value=max(reached, 0.0), limit=None if unknown else room or None, unit="m", time=when,
            note="; ".join(part for part in (note, why) if part),
        ))  # fmt: skip
    return verdicts
