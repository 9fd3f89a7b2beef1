"""Measures of each variant: peaks over every step, as plain numbers."""

import math
from collections.abc import Iterable, Mapping, Sequence
from functools import cache

import numpy as np

from wirerope_mj.assessment.criteria.ended import GROWTH
from wirerope_mj.assessment.criteria.rattle import rattle_verdicts
from wirerope_mj.assessment.criteria.sampled import SAMPLED
from wirerope_mj.assessment.criteria.travel import combined_utilisation
from wirerope_mj.engine.response import Response
from wirerope_mj.engine.response.peaks import Peak, Peaks
from wirerope_mj.engine.statics.loading import forces_at_rest
from wirerope_mj.engine.system import System
from wirerope_mj.foundation.arrays import Array
from wirerope_mj.foundation.payload_limits import SIDES
from wirerope_mj.foundation.state import State
from wirerope_mj.mounts.isolator import Isolator
from wirerope_mj.mounts.isolator.travel import RATINGS, largest_utilisation, static_utilisation, travel_reached
from wirerope_mj.studies.inputs.failure import acts

NAN = math.nan


def measure_names(system: System) -> list[str]:
    """Return the names of all measures, the columns of the table between inputs and status."""
    bodies, points = payload_bodies(system), payload_points(system)
    names = ["acceleration", "travel", "combined_travel", "static_load", "fragility", "clearance", "mounts", "struck"]
    names += [f"acceleration/{name}" for name in dict.fromkeys((*bodies, *points))]
    names += [f"displacement/{name}" for name in points]
    names += [f"displacement/{name}/{side}" for name in points for side in SIDES]
    for name, mount in system.mounts.items():
        if not mount.isolator.is_stop:
            names += [f"deflection/{name}/{rating}" for rating in RATINGS]
            names += [f"{measure}/{name}" for measure in ("travel", "static_load")]
        names.append(f"force/{name}")
    return names


def measures(system: System, peaks: Peaks, rest: State | None, response: Response | None = None) -> dict[str, float]:
    """Return the measures of one variant; `rest` is the equilibrium that it starts from, None if it starts from none.

    The `response` is wanted of a system of which `needs_samples` says so.

    acceleration: largest norm of any payload body [m/s^2]; acceleration/NAME: of one body or point. travel: largest
    utilisation of a rated travel [-] of any mount along one axis; travel/MOUNT: of one; combined_travel: of all axes at
    once, by this project's own rule; deflection/MOUNT/compression, tension, shear and
    roll [m], all positive; force/MOUNT: largest norm [N]. static_load: largest utilisation of a rated static load [-] of any
    mount at rest; static_load/MOUNT: of one, not judged where it hangs or carries more across its axis than along it.
    displacement/POINT: largest norm relative to the base [m]; displacement/POINT/-x, +x and so on: how far that way.
    fragility: largest utilisation [-] of an acceleration that the model states as a limit. clearance: of a clearance that it
    states, of a point, of a body's corners or between two points. mounts: number of mounts that are fitted and have not failed,
    stops left out, of which force/MOUNT alone is kept. struck: number of pairs of geoms, such as a stop and its pad, that came
    together, and of stops of mounts that closed. NaN where nothing is rated or stated, or samples are too few to judge it.
    """
    bodies, points = payload_bodies(system), payload_points(system)
    of_bodies = {name: peaks.bodies[name].acceleration for name in bodies}
    of_points = {name: peaks.points[name].acceleration for name in points}
    result = {"acceleration": _largest(peak.value for peak in of_bodies.values())}
    result |= dict.fromkeys(("travel", "combined_travel", "static_load", "fragility", "clearance"), NAN)
    isolators = {id(mount.isolator): mount.isolator for mount in system.mounts.values()}  # few, and asked once each
    fitted = {key: acts(isolator) and not isolator.is_stop for key, isolator in isolators.items()}
    result["mounts"] = float(sum(fitted[id(mount.isolator)] for mount in system.mounts.values()))
    result["struck"] = float(len(peaks.struck))
    for name, peak in (*of_bodies.items(), *of_points.items()):  # of a body and a point of one name the larger
        result[f"acceleration/{name}"] = max(peak.value, result.get(f"acceleration/{name}", 0.0))
    result |= {f"displacement/{name}": peaks.points[name].relative_displacement.value for name in points}
    moved = {name: peaks.points[name].relative_displacement for name in points}
    sides = {name: sides_of(peak.minimum, peak.maximum) for name, peak in moved.items()}
    result |= {f"displacement/{name}/{side}": float(value) for name, of in sides.items() for side, value in of.items()}
    result.update(zip(_force_names(tuple(system.mounts)), [m.force.value for m in peaks.mounts.values()], strict=True))
    judged = tuple(name for name, mount in system.mounts.items() if not mount.isolator.is_stop)
    reached, used, combined = _travel(system, peaks, judged, isolators)
    loads = _static_loads(system, rest, judged, isolators)
    result.update(zip(_judged_names(judged), [*reached, *used, *loads], strict=True))
    for measure, values in (("travel", used), ("combined_travel", combined), ("static_load", loads)):
        result[measure] = _largest([value for value in values if not math.isnan(value)])
    result["fragility"] = _fragility(system, (of_bodies, of_points))
    used_room = [float(used) for used in clearances_used(system, sides)] if response is None else _sampled(response)
    result["clearance"] = _largest(used_room)
    return result


def late(system: System, peaks: Peaks) -> float:
    """Return when something of a variant last reached an extreme that counts beside its norm [s]."""
    of_bodies = [peaks.bodies[name].acceleration for name in payload_bodies(system)]
    points = [peaks.points[name] for name in payload_points(system)]
    of_points = [peak for one in points for peak in (one.acceleration, one.relative_displacement)]
    of_mounts = [peak for one in peaks.mounts.values() for peak in (one.deflection, one.force)]
    numbers = np.array([peak.numbers for peak in (*of_bodies, *of_points, *of_mounts)])
    sides = [(Peak.MINIMUM, Peak.MINIMUM_TIME), (Peak.MAXIMUM, Peak.MAXIMUM_TIME)]
    extremes = [(numbers[:, value], numbers[:, time]) for value, time in sides]
    return float(latest(numbers[:, 0], extremes))


def latest(norms: Array, extremes: Sequence[tuple[Array, Array]]) -> Array:
    """Return the latest instant [s] of channels' extremes that count beside their norms, (...).

    Args:
        norms: the largest, (..., n).
        extremes: of the components, and their instants, (..., n, 3) each.
    """
    counts = GROWTH * norms[..., np.newaxis]
    instants = [np.where(np.abs(values) > counts, times, 0.0) for values, times in extremes]
    return np.asarray(np.max(instants, axis=(0, -1, -2), initial=0.0))


def sides_of(lowest: Array, highest: Array) -> dict[str, Array]:
    """Return how far something went along -x, +x, -y, +y, -z, +z by these names, >= 0, from its extremes (..., 3) [m]."""
    ways = {"-": np.maximum(-lowest, 0.0), "+": np.maximum(highest, 0.0)}
    return {side: ways[side[0]][..., "xyz".index(side[1])] for side in SIDES}


def clearances_used(system: System, sides: Mapping[str, Mapping[str, Array]]) -> list[Array]:
    """Return the utilisations of the clearances that a model states of points, by how far each point went each way."""
    return [
        sides[limit.name][side] / allowed
        for limit in system.limits
        if limit.kind == "clearance" and limit.name in sides
        for side, allowed in limit.ways.items()
    ]


def needs_samples(system: System) -> bool:
    """Return whether peaks do not judge every limit of a model: it states clearances of corners or between two points."""
    alone = set(payload_points(system)) - set(payload_bodies(system))
    return any(one.kind == "clearance" and one.name not in alone for one in system.limits)


def _sampled(response: Response) -> list[float]:
    """Return the utilisations of all clearances of a run; NaN alone if one is not known and none exceeded."""
    rows = rattle_verdicts(response)
    used = [row.utilisation for row in rows if row.utilisation is not None]
    unknown = any(row.limit is None and SAMPLED in row.note for row in rows)
    return [NAN] if unknown and max(used, default=0.0) <= 1.0 else used


def payload_bodies(system: System) -> list[str]:
    """Return the observed bodies that are not fixed to the base."""
    bodies, on_base = system.assembly.subjects.body_names, system.assembly.tables.base_channels
    return [name for index, name in enumerate(bodies) if index not in on_base]


def payload_points(system: System) -> list[str]:
    """Return the points that are not fixed to the base."""
    subjects, on_base = system.assembly.subjects, system.assembly.tables.base_channels
    n = len(subjects.bodies)
    return [name for index, name in enumerate(subjects.point_names) if n + 2 * index not in on_base]


@cache
def _force_names(mounts: tuple[str, ...]) -> tuple[str, ...]:
    """Return the names of the forces of mounts, made once for all variants of a system."""
    return tuple(f"force/{name}" for name in mounts)


@cache
def _judged_names(mounts: tuple[str, ...]) -> tuple[str, ...]:
    """Return the names of what is judged of mounts: travel by rating, utilisations of travel and of static load."""
    deflections = [f"deflection/{name}/{rating}" for rating in RATINGS for name in mounts]
    return (*deflections, *(f"{measure}/{name}" for measure in ("travel", "static_load") for name in mounts))


def _travel(
    system: System, peaks: Peaks, judged: Sequence[str], isolators: Mapping[int, Isolator]
) -> tuple[list[float], list[float], list[float]]:
    """Return the travel of mounts [m] by rating, their largest utilisation, and those of all axes at once; NaN if not rated."""
    if not judged:
        return [], [], []
    deflections = np.array([peaks.mounts[name].deflection.numbers for name in judged])
    reached = np.array(list(travel_reached(deflections[:, Peak.MINIMUM], deflections[:, Peak.MAXIMUM]).values()))
    stated = {key: isolator.limits.travel.stated for key, isolator in isolators.items()}
    ratings = {key: [travel.get(rating, NAN) for rating in RATINGS] for key, travel in stated.items()}
    rated = np.array([ratings[id(system.mounts[name].isolator)] for name in judged])
    used, combined = largest_utilisation(reached.T, rated).tolist(), [NAN] * len(judged)
    if system.combined_travel and peaks.travels is not None:
        travels = [peaks.travels[name] for name in judged]
        of_judged = np.array([NAN if one.judged is None else one.judged for one in travels])
        farthest = np.array([one.value for one in travels])
        combined = combined_utilisation(farthest, of_judged, reached.T, rated).tolist()
    return reached.ravel().tolist(), used, combined


def _static_loads(system: System, rest: State | None, judged: Sequence[str], isolators: Mapping[int, Isolator]) -> list[float]:
    """Return the utilisation of the rated static load at rest of some mounts; NaN where it is not judged."""
    if rest is None or all(isolator.limits.static_load is None for isolator in isolators.values()):
        return [NAN] * len(judged)
    forces = dict(zip(system.mounts, forces_at_rest(system, rest).tolist(), strict=True))
    used = [static_utilisation(forces[name], system.mounts[name].isolator.limits.static_load) for name in judged]
    return [NAN if one is None else one for one in used]


def _fragility(system: System, places: Sequence[Mapping[str, Peak]]) -> float:
    """Return the largest utilisation of a stated acceleration limit; a body and a point of one name must both bear it."""
    utilisations = []
    for limit in system.limits:
        if limit.kind != "acceleration":
            continue
        for peak in (at[limit.name] for at in places if limit.name in at):
            extremes = [max(-float(low), float(high)) for low, high in zip(peak.minimum, peak.maximum, strict=True)]
            sizes = {"": peak.value, **dict(zip("xyz", extremes, strict=True))}
            utilisations += [sizes[axis] / allowed for axis, allowed in limit.judged.items()]
    return _largest(utilisations)


def _largest(values: Iterable[float]) -> float:
    return max(values, default=NAN)
