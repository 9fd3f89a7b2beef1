"""Measures of many variants of one structure at once, from the kernel's memory: those of `wirerope_mj.studies.measures`."""

import math
from collections.abc import Mapping, Sequence
from dataclasses import dataclass

import numpy as np

from wirerope_mj.assessment.criteria.travel import combined_utilisation
from wirerope_mj.engine.control import layout as at
from wirerope_mj.engine.simulation.in_lanes import InLanes
from wirerope_mj.engine.system import System
from wirerope_mj.foundation.arrays import Array, Booleans
from wirerope_mj.mounts.isolator.travel import RATINGS, largest_utilisation, travel_reached
from wirerope_mj.studies.inputs.failure import acts
from wirerope_mj.studies.measures import clearances_used, latest, payload_bodies, payload_points, sides_of


@dataclass(frozen=True, kw_only=True)
class Extremes:
    """Peaks of variants over every step."""

    failed: Booleans  # whether the kernel gave a variant up, (n,)
    value: Array  # largest norm of every channel, (n, n_channels); of what is fixed to the base 0
    # lowest, highest: extremes of the components, (n, n_channels, 3)
    lowest: Array
    highest: Array
    struck: Array  # number of stops that closed, (n,)
    # largest utilisation of all rated travels of a mount at once, and that of instants that are judged, NaN without
    # any, (n, n_mounts, 2)
    travels: Array
    late: Array  # when something last reached an extreme that counts [s], (n,)

    @classmethod
    def of(cls, system: System, done: InLanes) -> "Extremes":
        """Return the extremes of variants of a system that came to the end of a grid."""
        tables, n = system.assembly.tables, len(done.which)
        tracked = np.setdiff1d(np.arange(tables.channels.size), tables.base_channels)
        channels = np.zeros((n, tables.channels.size, at.CHANNEL_MEMORY))
        failed, struck = np.zeros(n, dtype=bool), np.zeros(n)
        travels = np.zeros((n, len(system.mounts), 2))
        for group, indices in done.groups:
            failed[indices] = group.failed != 0.0
            for lane, index in enumerate(indices):
                channels[index, tracked] = group.channels(lane)
                squares = group.travels(lane)[:, [at.FARTHEST, at.JUDGED]]
                travels[index] = np.sqrt(np.where(squares >= 0.0, squares, math.nan))
                stops = group.stops(lane)
                struck[index] = np.sum(stops[:, at.TOUCHES] > stops[:, at.FROM_START])
        low, high = (channels[:, :, part : part + 3] for part in (at.LOW, at.HIGH))
        value = channels[:, :, at.PEAK]
        times = [channels[:, :, part : part + 3] for part in (at.LOW_TIME, at.HIGH_TIME)]
        late = latest(value, list(zip((low, high), times, strict=True)))
        return cls(failed=failed, value=value, lowest=low, highest=high, struck=struck, travels=travels, late=late)


def measures_together(system: System, extremes: Extremes, forces: Array | None) -> dict[str, Array]:
    """Return the measures of variants by name, (n,) each, of a system with their limits, ratings and fitted mounts.

    `forces` are those of their mounts at rest [N], (n, n_mounts, 3); None if they do not start there.
    """
    n = len(extremes.value)
    channels = _channels(system)
    bodies = [extremes.value[:, channel] for channel in channels["body"].values()]
    isolators = [mount.isolator for mount in system.mounts.values()]
    judged = [number for number, isolator in enumerate(isolators) if not isolator.is_stop]
    names = [name for name, isolator in zip(system.mounts, isolators, strict=True) if not isolator.is_stop]
    deflections = [channels["deflection"][name] for name in names]
    reached = travel_reached(extremes.lowest[:, deflections], extremes.highest[:, deflections])
    stated = [isolators[number].limits.travel.stated for number in judged]
    rated = np.array([[one.get(rating, math.nan) for rating in RATINGS] for one in stated]).reshape(-1, len(RATINGS))
    ways = np.stack(list(reached.values()), axis=-1)
    used = largest_utilisation(ways, rated)
    combined = np.full_like(used, math.nan)
    if system.combined_travel and judged:
        farthest, of_judged = np.moveaxis(extremes.travels[:, judged], -1, 0)
        combined = combined_utilisation(farthest, of_judged, ways, rated)
    loads = _static_loads([isolators[number].limits.static_load for number in judged], forces, judged, n)
    result = {
        "acceleration": _largest(np.array(bodies).reshape(-1, n).T), "travel": _largest(used),
        "combined_travel": _largest(combined), "static_load": _largest(loads),
        "fragility": _fragility(system, extremes, (channels["body"], channels["point"])),
        "mounts": np.full(n, float(sum(acts(isolators[number]) for number in judged))), "struck": extremes.struck,
    }  # fmt: skip
    for name, channel in (*channels["body"].items(), *channels["point"].items()):  # of two of one name the larger
        result[f"acceleration/{name}"] = np.maximum(extremes.value[:, channel], result.get(f"acceleration/{name}", 0.0))
    result |= {f"displacement/{name}": extremes.value[:, c] for name, c in channels["displacement"].items()}
    result |= {f"force/{name}": extremes.value[:, c] for name, c in channels["force"].items()}
    by_side = {c: sides_of(extremes.lowest[:, c], extremes.highest[:, c]) for c in channels["displacement"].values()}
    sides = {name: by_side[channel] for name, channel in channels["displacement"].items()}
    result |= {f"displacement/{name}/{side}": values for name, of in sides.items() for side, values in of.items()}
    result["clearance"] = _largest(np.array(clearances_used(system, sides)).reshape(-1, n).T)
    for number, name in enumerate(names):
        result |= {f"deflection/{name}/{rating}": values[:, number] for rating, values in reached.items()}
        result |= {f"travel/{name}": used[:, number], f"static_load/{name}": loads[:, number]}
    return result


def _channels(system: System) -> dict[str, dict[str, int]]:
    """Return the numbers of the channels of the payload's bodies and points and of the mounts, by name."""
    subjects, mounts = system.assembly.subjects, list(system.mounts)
    bodies, points = payload_bodies(system), payload_points(system)
    n, first = len(subjects.bodies), len(subjects.bodies) + 2 * len(subjects.points)
    of_points = {name: n + 2 * i for i, name in enumerate(subjects.point_names) if name in points}
    of_bodies = {name: i for i, name in enumerate(subjects.body_names) if name in bodies}
    return {
        "body": of_bodies, "point": of_points,
        "displacement": {name: channel + 1 for name, channel in of_points.items()},
        "deflection": {name: first + 2 * i for i, name in enumerate(mounts)},
        "force": {name: first + 2 * i + 1 for i, name in enumerate(mounts)},
    }  # fmt: skip


def _largest(values: Array) -> Array:
    """Return the largest of each row, (n,); NaN counts only where there is nothing else."""
    if not values.shape[1]:
        return np.full(len(values), math.nan)
    return np.asarray(np.fmax.reduce(values, axis=1))


def _static_loads(limits: list[float | None], forces: Array | None, judged: list[int], n: int) -> Array:
    """Return compression over rated static load, (n, n_judged), as `static_utilisation` does; NaN where it is not judged."""
    loads = np.full((n, len(judged)), math.nan)
    if forces is None or not judged:
        return loads
    roll, shear, axial = np.moveaxis(forces[:, judged], -1, 0)
    rated = np.array([math.nan if limit is None else limit for limit in limits])
    stands = (np.hypot(roll, shear) <= np.abs(axial)) & (axial <= 0.0)
    return np.where(stands, np.maximum(-axial, 0.0) / rated, math.nan)


def _fragility(system: System, extremes: Extremes, places: Sequence[Mapping[str, int]]) -> Array:
    utilisations = []
    for limit in system.limits:
        if limit.kind != "acceleration":
            continue
        for channel in (channels[limit.name] for channels in places if limit.name in channels):
            sizes = np.maximum(-extremes.lowest[:, channel], extremes.highest[:, channel])
            by_axis = {"": extremes.value[:, channel], **dict(zip("xyz", sizes.T, strict=True))}
            utilisations += [by_axis[axis] / allowed for axis, allowed in limit.judged.items()]
    return _largest(np.array(utilisations).reshape(-1, len(extremes.value)).T)
