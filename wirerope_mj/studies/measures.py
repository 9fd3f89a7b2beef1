"""What is kept of each variant: peaks over every step, as plain numbers."""

import math
from collections.abc import Iterable

import numpy as np

from wirerope_mj.engine.response.peaks import Peak, Peaks
from wirerope_mj.engine.simulation.run import point_name
from wirerope_mj.engine.statics.loads import forces_at_rest
from wirerope_mj.engine.system import System
from wirerope_mj.foundation.state import State
from wirerope_mj.mounts.isolator.static_rating import static_utilisation
from wirerope_mj.mounts.isolator.travel import RATINGS, travel_reached, travel_utilisation
from wirerope_mj.studies.inputs.variants import acts

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

    acceleration: largest norm of any payload body [m/s^2]; acceleration/NAME: of one body or point. travel: largest share of
    a rated travel [-] of any mount; travel/MOUNT: of one; deflection/MOUNT/compression, tension, shear and roll [m], all
    positive; force/MOUNT: largest norm [N]. static_load: largest share of a rated static load [-] of any mount at rest;
    static_load/MOUNT: of one, not judged where it hangs or carries more across its axis than along it.
    displacement/POINT: largest norm relative to the base [m]. fragility: largest share [-] of an acceleration that the model
    states as a limit. mounts: number of mounts that are fitted and have not failed, stops left out, of which force/MOUNT alone
    is kept. struck: number of pairs of geoms, such as a stop and its pad, that came together, and of stops of mounts that
    closed. NaN where nothing is rated or stated.
    """
    bodies, points = payload_bodies(system), payload_points(system)
    at = {name: peaks.bodies[name].acceleration for name in bodies}
    at |= {name: peaks.points[name].acceleration for name in points}
    found = {"acceleration": _largest(at[name].value for name in bodies)}
    found |= dict.fromkeys(("travel", "static_load", "fragility"), NAN)
    found["mounts"] = float(
        sum(acts(mount.isolator) and not mount.isolator.is_stop for mount in system.mounts.values())
    )
    found["struck"] = float(len(peaks.struck))
    found |= {f"acceleration/{name}": peak.value for name, peak in at.items()}
    found |= {f"displacement/{name}": peaks.points[name].relative_displacement.value for name in points}
    shares = []
    deflections = [peaks.mounts[name].deflection for name in system.mounts]
    lowest, highest = (np.array([getattr(d, end) for d in deflections]) for end in ("minimum", "maximum"))
    every = {rating: values.tolist() for rating, values in travel_reached(lowest, highest).items()}
    for place, (name, mount) in enumerate(system.mounts.items()):
        found[f"force/{name}"] = peaks.mounts[name].force.value
        if mount.isolator.is_stop:
            continue
        reached = {rating: values[place] for rating, values in every.items()}
        shares.append(_largest(travel_utilisation(reached, mount.isolator.limits.travel.stated).values()))
        found |= {f"deflection/{name}/{rating}": value for rating, value in reached.items()}
        found[f"travel/{name}"] = shares[-1]
    loads = _static_loads(system, rest)
    found |= {f"static_load/{name}": share for name, share in loads.items()}
    for measure, values in (("travel", shares), ("static_load", loads.values())):
        found[measure] = _largest(share for share in values if not math.isnan(share))
    found["fragility"] = _fragility(system, at)
    return found


def payload_bodies(system: System) -> list[str]:
    """Return the observed bodies that are not fixed to the base."""
    bodies = system.assembly.subjects.bodies
    on_base = set(system.assembly.tables.base_channels)
    return [system.model.body(body).name for place, body in enumerate(bodies) if place not in on_base]


def payload_points(system: System) -> list[str]:
    """Return the points that are not fixed to the base."""
    subjects, on_base = system.assembly.subjects, set(system.assembly.tables.base_channels)
    n = len(subjects.bodies)
    names = [point_name(system.model, point) for point in subjects.points]
    return [name for place, name in enumerate(names) if n + 2 * place not in on_base]


def _static_loads(system: System, rest: State | None) -> dict[str, float]:
    """Return the share of its rated static load that every mount but a stop carries at rest; NaN where it is not judged."""
    found = {name: NAN for name, mount in system.mounts.items() if not mount.isolator.is_stop}
    if rest is None:
        return found
    for (name, mount), force in zip(system.mounts.items(), forces_at_rest(system, rest), strict=True):
        used = static_utilisation(force, mount.isolator.limits.static_load)
        if used is not None:
            found[name] = used
    return found


def _fragility(system: System, at: dict[str, Peak]) -> float:
    """Return the largest share of a stated acceleration limit."""
    shares = []
    for limit in system.limits:
        if limit.kind != "acceleration" or limit.name not in at:
            continue
        peak = at[limit.name]
        extremes = [max(-float(low), float(high)) for low, high in zip(peak.minimum, peak.maximum, strict=True)]
        sizes = {"": peak.value, **dict(zip("xyz", extremes, strict=True))}
        shares += [sizes[axis] / allowed for axis, allowed in limit.judged.items()]
    return _largest(shares)


def _largest(values: Iterable[float]) -> float:
    return max(values, default=NAN)
