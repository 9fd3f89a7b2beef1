"""Measures of each variant: peaks over every step, as plain numbers, of one variant or of many of one structure at once."""

import math
from collections.abc import Mapping, Sequence
from dataclasses import dataclass

import numpy as np

from wirerope_mj.assessment.criteria.ended import GROWTH
from wirerope_mj.assessment.criteria.payload import rattle_verdicts
from wirerope_mj.assessment.criteria.sampled import SAMPLED
from wirerope_mj.assessment.criteria.travel import combined_utilisation
from wirerope_mj.engine.control import layout as at
from wirerope_mj.engine.response import Response
from wirerope_mj.engine.response.peaks import FAINT, Peak, Peaks
from wirerope_mj.engine.simulation.in_lanes import InLanes
from wirerope_mj.engine.statics.loading import forces_at_rest
from wirerope_mj.engine.system import System
from wirerope_mj.foundation.arrays import Array, Booleans
from wirerope_mj.foundation.payload_limits import SIDES
from wirerope_mj.foundation.state import State
from wirerope_mj.mounts.isolator import Isolator
from wirerope_mj.mounts.isolator.travel import RATINGS, largest_utilisation, travel_reached
from wirerope_mj.studies.vary.quantity import acts

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
    return names + [f"load/{name}" for name in _stops_beside(system)]


def measures(system: System, peaks: Peaks, rest: State | None, response: Response | None = None) -> dict[str, float]:
    """Return the measures of one variant; `rest` is the equilibrium from which it starts, if it starts from one.

    The `response` is needed where `needs_samples` is True of the system.

    acceleration: largest norm of any payload body [m/s^2]; acceleration/NAME: of one body or point. travel: largest
    utilisation of a rated travel [-] of any mount along one axis; travel/MOUNT: of one; combined_travel: of all axes at
    once, by this project's own rule; deflection/MOUNT/compression, tension, shear and roll [m], all positive, of mounts that
    are fitted; force/MOUNT: largest norm [N], without that of stops at its sites; load/MOUNT: with theirs, the load of its
    foot, bounded by the peaks of all as a run's is. static_load: largest utilisation of a rated static load [-] of any mount
    at rest; static_load/MOUNT: of one, not judged where it hangs or carries more across its axis than along it.
    displacement/POINT: largest norm relative to the base [m]; displacement/POINT/-x, +x and so on: how far that way.
    fragility: largest utilisation [-] of an acceleration that the model states as a limit. clearance: of a clearance that it
    states, of a point, of a body's corners or between two points. mounts: number of mounts that are fitted and have not failed,
    stops left out, of which force/MOUNT alone is kept. struck: number of pairs of geoms, such as a stop and its pad, that came
    together, and of stops of mounts that closed. NaN where nothing is rated or stated, or samples are too few to judge it.
    """
    forces = None if rest is None else forces_at_rest(system, rest)[np.newaxis]
    results = {
        name: float(values[0]) for name, values in measures_together(system, Extremes.of_peaks(system, peaks), forces).items()
    }
    if response is None:
        return results
    rows = rattle_verdicts(response)  # NaN where one is not known and none exceeded
    worst = max((row.utilisation for row in rows if row.utilisation is not None), default=NAN)
    unknown = any(row.limit is None and SAMPLED in row.note for row in rows)
    return results | {"clearance": NAN if unknown and not worst > 1.0 else worst}


def latest_extreme(system: System, peaks: Peaks) -> float:
    """Return the latest instant at which a variant reached a significant extreme [s]."""
    return float(Extremes.of_peaks(system, peaks).late[0])


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
    def of_lanes(cls, system: System, done: InLanes) -> "Extremes":
        """Collect the extremes of variants of a system that the kernel stepped side by side in lanes."""
        tables, n = system.assembly.tables, len(done.which)
        channels = np.zeros((n, tables.channels.size, at.CHANNEL_MEMORY))
        failed, struck = np.zeros(n, dtype=bool), np.zeros(n)
        travels = np.zeros((n, len(system.mounts), 2))
        for group, indices in done.groups:
            failed[indices] = group.failed != 0.0
            for lane, index in enumerate(indices):
                channels[index, tables.tracked] = group.channels(lane)
                squares = group.travels(lane)[:, [at.FARTHEST, at.JUDGED]]
                travels[index] = np.sqrt(np.where(squares >= 0.0, squares, NAN))
                stops = group.stops(lane)
                closes = stops[:, at.TOUCHES] > stops[:, at.FROM_START]
                struck[index] = np.sum(closes & (stops[:, at.DEPTH] > FAINT))
        channels[:, tables.base_channels] = 0.0
        low, high = (channels[:, :, part : part + 3] for part in (at.LOW, at.HIGH))
        value = channels[:, :, at.PEAK]
        times = [channels[:, :, part : part + 3] for part in (at.LOW_TIME, at.HIGH_TIME)]
        late = _latest(value, list(zip((low, high), times, strict=True)))
        return cls(failed=failed, value=value, lowest=low, highest=high, struck=struck, travels=travels, late=late)

    @classmethod
    def of_peaks(cls, system: System, peaks: Peaks) -> "Extremes":
        """Return the extremes of one variant that was simulated alone."""
        moved = [peak for point in peaks.points.values() for peak in (point.acceleration, point.relative_displacement)]
        stretched = [peak for mount in peaks.mounts.values() for peak in (mount.deflection, mount.force)]
        every = [*(body.acceleration for body in peaks.bodies.values()), *moved, *stretched]
        numbers = np.array([peak.numbers for peak in every])[np.newaxis]
        numbers[:, system.assembly.tables.base_channels] = 0.0
        low, high = numbers[:, :, Peak.MINIMUM], numbers[:, :, Peak.MAXIMUM]
        times = numbers[:, :, Peak.MINIMUM_TIME], numbers[:, :, Peak.MAXIMUM_TIME]
        followed = [(peaks.travels or {}).get(name) for name in system.mounts]
        travels = [
            (NAN, NAN) if travel is None else (travel.value, NAN if travel.judged is None else travel.judged)
            for travel in followed
        ]
        return cls(
            failed=np.zeros(1, dtype=bool), value=numbers[:, :, 0], lowest=low, highest=high,
            struck=np.array([float(len(peaks.struck))]), travels=np.array(travels).reshape(1, -1, 2),
            late=_latest(numbers[:, :, 0], list(zip((low, high), times, strict=True))),
        )  # fmt: skip


def measures_together(
    system: System, extremes: Extremes, forces: Array | None, isolators: Sequence[Mapping[str, Isolator]] = ()
) -> dict[str, Array]:
    """Return the measures of variants of one system by name, (n,) each, from their extremes and limits.

    `forces` are those of their mounts at rest [N], (n, n_mounts, 3); None if they do not start there. `isolators` are those
    of each variant's mounts that have others than the system's.
    """
    n = len(extremes.value)
    channels = _channels(system)
    bodies = [extremes.value[:, channel] for channel in channels["body"].values()]
    names = [name for name, mount in system.mounts.items() if not mount.isolator.is_stop]
    judged = [number for number, name in enumerate(system.mounts) if name in names]
    rated, loads, act = _ratings(system, names, isolators or [{}] * n)
    deflections = [channels["deflection"][name] for name in names]
    reached = travel_reached(extremes.lowest[:, deflections], extremes.highest[:, deflections])
    present = (act > 0.0) | np.isfinite(rated).any(axis=-1)  # an empty place travels nothing; what has failed keeps its ratings
    reached = {rating: np.where(present, values, NAN) for rating, values in reached.items()}
    travels = np.stack(list(reached.values()), axis=-1)
    used = largest_utilisation(travels, rated)
    combined = np.full_like(used, NAN)
    if system.combined_travel and judged:
        farthest, of_judged = np.moveaxis(extremes.travels[:, judged], -1, 0)
        combined = combined_utilisation(farthest, of_judged, travels, rated)
    used_loads = np.full_like(loads, NAN)  # compression over rated static load; NaN where it is not judged
    if forces is not None:
        roll, shear, axial = np.moveaxis(forces[:, judged] * act[..., np.newaxis], -1, 0)  # 0 of mounts that have failed
        stands = (np.hypot(roll, shear) <= np.abs(axial)) & (axial <= 0.0)
        used_loads = np.where(stands, np.maximum(-axial, 0.0) / loads, NAN)
    utilisations = []
    for limit in system.limits:
        if limit.kind != "acceleration":
            continue
        for channel in (channels[kind][limit.name] for kind in ("body", "point") if limit.name in channels[kind]):
            sizes = np.maximum(-extremes.lowest[:, channel], extremes.highest[:, channel])
            by_axis = {"": extremes.value[:, channel], **dict(zip("xyz", sizes.T, strict=True))}
            utilisations += [by_axis[axis] / allowed for axis, allowed in limit.judged.items()]
    result = {
        "acceleration": _largest(np.array(bodies).reshape(-1, n).T), "travel": _largest(used),
        "combined_travel": _largest(combined), "static_load": _largest(used_loads),
        "fragility": _largest(np.array(utilisations).reshape(-1, n).T),
        "mounts": act.sum(axis=1), "struck": extremes.struck,
    }  # fmt: skip
    for name, channel in (*channels["body"].items(), *channels["point"].items()):  # of two of one name the larger
        result[f"acceleration/{name}"] = np.maximum(extremes.value[:, channel], result.get(f"acceleration/{name}", 0.0))
    result |= {f"displacement/{name}": extremes.value[:, c] for name, c in channels["displacement"].items()}
    result |= {f"force/{name}": extremes.value[:, c] for name, c in channels["force"].items()}
    for name, stops in _stops_beside(system).items():
        own = channels["force"][name]
        low, high, value = (part[:, own].copy() for part in (extremes.lowest, extremes.highest, extremes.value))
        for channel in (channels["force"][stop] for stop in stops):
            pressed = extremes.value[:, channel] > 0.0
            low += np.where(pressed[:, np.newaxis], extremes.lowest[:, channel], 0.0)
            high += np.where(pressed[:, np.newaxis], extremes.highest[:, channel], 0.0)
            value += extremes.value[:, channel]
        along = np.linalg.norm(np.maximum(np.abs(low), np.abs(high)), axis=1)
        alone = value == extremes.value[:, own]
        result[f"load/{name}"] = np.where(alone, value, np.minimum(along, value))
    for name, c in channels["displacement"].items():  # how far it went along -x, +x and so on, >= 0
        ways = {"-": np.maximum(-extremes.lowest[:, c], 0.0), "+": np.maximum(extremes.highest[:, c], 0.0)}
        result |= {f"displacement/{name}/{side}": ways[side[0]][:, "xyz".index(side[1])] for side in SIDES}
    clearances = [limit for limit in system.limits if limit.kind == "clearance" and limit.name in channels["displacement"]]
    utilisations = [
        result[f"displacement/{clearance.name}/{side}"] / most
        for clearance in clearances
        for side, most in clearance.ways.items()
    ]
    result["clearance"] = _largest(np.array(utilisations).reshape(-1, n).T)
    for number, name in enumerate(names):
        result |= {f"deflection/{name}/{rating}": values[:, number] for rating, values in reached.items()}
        result |= {f"travel/{name}": used[:, number], f"static_load/{name}": used_loads[:, number]}
    return result


def _stops_beside(system: System) -> dict[str, list[str]]:
    """List the stops that stand at the same sites as a mount, by the mount's name."""
    found: dict[tuple[str, str], list[str]] = {}
    for name, one in system.mounts.items():
        if one.isolator.is_stop:
            found.setdefault((one.payload_site, one.base_site), []).append(name)
    isolating = {name: (one.payload_site, one.base_site) for name, one in system.mounts.items() if not one.isolator.is_stop}
    return {name: found[sites] for name, sites in isolating.items() if sites in found}


def _channels(system: System) -> dict[str, dict[str, int]]:
    """Return the indices of the channels of `Extremes`, of the payload's bodies and points and of mounts, by kind and name."""
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
        return np.full(len(values), NAN)
    return np.asarray(np.fmax.reduce(values, axis=1))


def _ratings(system: System, names: Sequence[str], isolators: Sequence[Mapping[str, Isolator]]) -> tuple[Array, Array, Array]:
    """Tabulate ratings of variants' mounts: travels (n, n_names, 4) and static loads (n, n_names), NaN where none is stated.

    The third array says which of them act, 1.0 or 0.0, (n, n_names).
    """
    rows, numbers = dict[int, list[float]](), {name: number for number, name in enumerate(names)}

    def row(isolator: Isolator) -> list[float]:
        if id(isolator) not in rows:
            travel, load = isolator.limits.travel.stated, isolator.limits.static_load
            travels = [travel.get(rating, NAN) for rating in RATINGS]
            rows[id(isolator)] = [*travels, NAN if load is None else load, acts(isolator)]
        return rows[id(isolator)]

    nominal = np.array([row(system.mounts[name].isolator) for name in names]).reshape(-1, len(RATINGS) + 2)
    table = np.tile(nominal, (len(isolators), 1, 1))
    for of_variant, changed in zip(table, isolators, strict=True):
        for name, isolator in changed.items():
            if name in numbers:
                of_variant[numbers[name]] = row(isolator)
    return table[..., :-2], table[..., -2], table[..., -1]


def _latest(norms: Array, extremes: Sequence[tuple[Array, Array]]) -> Array:
    """Return the latest instant [s] of channels' significant extremes, (...).

    Args:
        norms: largest norm of each channel, (..., n).
        extremes: extremes of the channels' components, and their instants [s], (..., n, 3) each.
    """
    counts = GROWTH * norms[..., np.newaxis]
    instants = [np.where(np.abs(values) > counts, times, 0.0) for values, times in extremes]
    return np.asarray(np.max(instants, axis=(0, -1, -2), initial=0.0))


def needs_samples(system: System) -> bool:
    """Tell whether judging a model needs samples beside peaks: for clearances of corners or between two points."""
    alone = set(payload_points(system)) - set(payload_bodies(system))
    return any(limit.kind == "clearance" and limit.name not in alone for limit in system.limits)


def payload_bodies(system: System) -> list[str]:
    bodies, on_base = system.assembly.subjects.body_names, system.assembly.tables.base_channels
    return [name for index, name in enumerate(bodies) if index not in on_base]


def payload_points(system: System) -> list[str]:
    subjects, on_base = system.assembly.subjects, system.assembly.tables.base_channels
    n = len(subjects.bodies)
    return [name for index, name in enumerate(subjects.point_names) if n + 2 * index not in on_base]
