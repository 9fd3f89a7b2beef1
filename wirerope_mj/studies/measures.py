"""Measures of each variant: peaks over every step, as plain numbers."""

import math
from collections.abc import Iterable

import numpy as np

from wirerope_mj.engine.response.peaks import Peak, Peaks
from wirerope_mj.engine.statics.result import forces_at_rest
from wirerope_mj.engine.system import System
from wirerope_mj.foundation.state import State
from wirerope_mj.mounts.isolator.static_rating import static_utilisation
from wirerope_mj.mounts.isolator.travel import RATINGS, travel_reached, travel_utilisation
from wirerope_mj.studies.inputs.failure import acts

NAN = math.nan


def measure_names(system: System) -> list[str]:
    """Return the names of all measures, the columns of the table between inputs and status."""
    bodies, points = payload_bodies(system), payload_points(system)
    names = ["acceleration", "travel", "static_load", "fragility", "mounts", "struck"]
    names += [f"acceleration/{name}" for name in (*bodies, *points)]
    names += [f"displacement/{name}" for name in points]
    for name, mount in system.mounts.items():
        if not mount.isolator.is_stop:
            names += [f"deflection/{name}/{rating}" for rating in RATINGS]
            names += [f"{measure}/{name}" for measure in ("travel", "static_load")]
        names.append(f"force/{name}")
    return names


def measures(system: System, peaks: Peaks, rest: State | None) -> dict[str, float]:
    """Return the measures of one variant; `rest` is the equilibrium that it starts from, None if it starts from none.

    acceleration: largest norm of any payload body [m/s^2]; acceleration/NAME: of one body or point. travel: largest
    utilisation of a rated travel [-] of any mount; travel/MOUNT: of one; deflection/MOUNT/compression, tension, shear and
    roll [m], all positive; force/MOUNT: largest norm [N]. static_load: largest utilisation of a rated static load [-] of any
    mount at rest; static_load/MOUNT: of one, not judged where it hangs or carries more across its axis than along it.
    displacement/POINT: largest norm relative to the base [m]. fragility: largest utilisation [-] of an acceleration that the
    model states as a limit. mounts: number of mounts that are fitted and have not failed, stops left out, of which
    force/MOUNT alone is kept. struck: number of pairs of geoms, such as a stop and its pad, that came together, and of stops
    of mounts that closed. NaN where nothing is rated or stated.
    """
    bodies, points = payload_bodies(system), payload_points(system)
    at = {name: peaks.bodies[name].acceleration for name in bodies}
    at |= {name: peaks.points[name].acceleration for name in points}
    result = {"acceleration": _largest(at[name].value for name in bodies)}
    result |= dict.fromkeys(("travel", "static_load", "fragility"), NAN)
    result["mounts"] = float(
        sum(acts(mount.isolator) and not mount.isolator.is_stop for mount in system.mounts.values())
    )
    result["struck"] = float(len(peaks.struck))
    result |= {f"acceleration/{name}": peak.value for name, peak in at.items()}
    result |= {f"displacement/{name}": peaks.points[name].relative_displacement.value for name in points}
    utilisations = []
    deflections = [peaks.mounts[name].deflection for name in system.mounts]
    lowest, highest = (np.array([getattr(d, end) for d in deflections]) for end in ("minimum", "maximum"))
    every = {rating: values.tolist() for rating, values in travel_reached(lowest, highest).items()}
    for index, (name, mount) in enumerate(system.mounts.items()):
        result[f"force/{name}"] = peaks.mounts[name].force.value
        if mount.isolator.is_stop:
            continue
        reached = {rating: values[index] for rating, values in every.items()}
        utilisations.append(_largest(travel_utilisation(reached, mount.isolator.limits.travel.stated).values()))
        result |= {f"deflection/{name}/{rating}": value for rating, value in reached.items()}
        result[f"travel/{name}"] = utilisations[-1]
    loads = _static_loads(system, rest)
    result |= {f"static_load/{name}": value for name, value in loads.items()}
    for measure, values in (("travel", utilisations), ("static_load", loads.values())):
        result[measure] = _largest(value for value in values if not math.isnan(value))
    result["fragility"] = _fragility(system, at)
    return result


def payload_bodies(system: System) -> list[str]:
    """Return the observed bodies that are not fixed to the base."""
    bodies, on_base = system.assembly.subjects.body_names, system.assembly.tables.base_channels
    return [name for index, name in enumerate(bodies) if index not in on_base]


def payload_points(system: System) -> list[str]:
    """Return the points that are not fixed to the base."""
    subjects, on_base = system.assembly.subjects, system.assembly.tables.base_channels
    n = len(subjects.bodies)
    return [name for index, name in enumerate(subjects.point_names) if n + 2 * index not in on_base]


def _static_loads(system: System, rest: State | None) -> dict[str, float]:
    """Return the utilisation of the rated static load at rest of every mount but stops; NaN where it is not judged."""
    utilisations = {name: NAN for name, mount in system.mounts.items() if not mount.isolator.is_stop}
    if rest is None:
        return utilisations
    for (name, mount), force in zip(system.mounts.items(), forces_at_rest(system, rest), strict=True):
        used = static_utilisation(force, mount.isolator.limits.static_load)
        if used is not None:
            utilisations[name] = used
    return utilisations


def _fragility(system: System, at: dict[str, Peak]) -> float:
    """Return the largest utilisation of a stated acceleration limit."""
    utilisations = []
    for limit in system.limits:
        if limit.kind != "acceleration" or limit.name not in at:
            continue
        peak = at[limit.name]
        extremes = [max(-float(low), float(high)) for low, high in zip(peak.minimum, peak.maximum, strict=True)]
        sizes = {"": peak.value, **dict(zip("xyz", extremes, strict=True))}
        utilisations += [sizes[axis] / allowed for axis, allowed in limit.judged.items()]
    return _largest(utilisations)


def _largest(values: Iterable[float]) -> float:
    return max(values, default=NAN)
