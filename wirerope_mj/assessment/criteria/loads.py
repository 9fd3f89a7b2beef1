"""Loads of mounts against their ratings, contacts and stops that were struck, and the force on the foundation and its bolts."""

import math
from collections.abc import Collection, Sequence
from dataclasses import dataclass

import numpy as np

from wirerope_mj.assessment.criteria.sampled import read_start
from wirerope_mj.assessment.criteria.verdict import (
    CLEAR,
    CLOSING_SPEED,
    CONTACT,
    LOAD,
    RESTED,
    STATIC_LOAD,
    STOP,
    STOP_FORCE,
    STOP_GAP,
    STRUCK,
    TOUCHING,
    Criterion,
    Verdict,
    limits_by_name,
    payload_bodies,
)
from wirerope_mj.engine.response import ContactPeak, Response, Scene
from wirerope_mj.engine.response.scene import SceneMount
from wirerope_mj.engine.statics import StaticTable
from wirerope_mj.foundation.arrays import Array
from wirerope_mj.foundation.directions import rotation_matrices
from wirerope_mj.foundation.payload_limits import ON_STOPS, PayloadLimit
from wirerope_mj.foundation.units import STANDARD_GRAVITY, duration_text, force_text, instant_text, significant
from wirerope_mj.mounts.isolator import AXES
from wirerope_mj.mounts.isolator.travel import static_load_unjudged

AT_STOPS = 0.01  # fraction of the weight that stops may carry at rest: less is a stop that is just reached
LEAST_GAP = 1e-6  # Taken for a gap of zero [m], of which nothing can be a fraction
_NAMED = 4  # stops that a sentence names
# Acceleration below which the first sample is taken for rest [m/s^2]: an equilibrium leaves far less, a falling payload 1 g.
AT_REST = 1e-3 * STANDARD_GRAVITY


def starting_load_verdicts(response: Response) -> tuple[Verdict, ...]:
    """Judge the compression of every mount at the start of the run against its rated static load.

    The rating holds for compression. A mount that hangs, or carries more across its axis than along it, is not judged, nor
    is a run that does not begin at rest in equilibrium.
    """
    moving = payload_bodies(response)
    start = [float(np.abs(read_start(response, f"bodies/{name}/acceleration/x")).max()) for name in moving]
    unsettled = "" if max(start, default=0.0) < AT_REST else "the run does not begin at rest in equilibrium"
    return tuple(
        _static_load_verdict(
            Criterion(STATIC_LOAD), mount.name, read_start(response, f"mounts/{mount.name}/force/roll"), mount.static_load,
            "" if math.isnan(mount.static_load) else unsettled,
        )
        for mount in response.scene.isolating
    )  # fmt: skip


def static_load_verdicts(table: StaticTable) -> tuple[Verdict, ...]:
    """Judge the compression of every mount at rest, virgin and relaxed, against its rated static load.

    Not judged where no load is rated, where the mount hangs, and where it carries more across its axis than along it.
    """
    return tuple(
        _static_load_verdict(Criterion(STATIC_LOAD, sense=history), name, mount.force, mount.static_load)
        for history, sag in table.sags.items()
        for name, mount in sag.listed.items()
    )


def rested_verdicts(table: StaticTable) -> tuple[Verdict, ...]:
    """Judge the fraction of the weight on stops or contacts at rest, virgin and relaxed; () where they carry no weight.

    Isolation is short-circuited there: the base's motion passes through the stops and contacts. Forces across gravity carry
    no weight.
    """
    verdicts = []
    for history, sag in table.sags.items():
        pressed = {name: mount.on_stops for name, mount in sag.mounts.items() if mount.on_stops > 0.0}
        contacts = abs(sag.on_contacts)
        share = (sum(pressed.values()) + contacts) / sag.weight if sag.weight else 0.0
        if share > AT_STOPS:
            names = [*sorted(pressed, key=lambda name: -pressed[name]), *(["contacts"] if contacts > 0.0 else [])]
            some = ", ".join(names[:_NAMED]) + (f" and {len(names) - _NAMED} more" if len(names) > _NAMED else "")
            when = {"virgin": "on the first loading", "relaxed": "after long vibration"}[history]
            note = (
                f"isolation is short-circuited at rest, {when}: {some} {'carries' if len(names) == 1 else 'carry'} "
                f"{significant(100.0 * share, 2)} % of the weight"
            )
            criterion = Criterion(RESTED, sense=history)
            verdicts.append(Verdict(criterion=criterion, subject=names[0], value=share, limit=AT_STOPS, unit="", note=note))
    return tuple(verdicts)


def missing_load_verdicts(table: StaticTable) -> tuple[Verdict, ...]:
    """Note, if there is no virgin or no relaxed equilibrium, that its static loads are not judged, and why."""
    return tuple(
        Verdict(
            criterion=Criterion(STATIC_LOAD, sense=history), subject="every mount", value=math.nan, limit=None, unit="N",
            note=reason.rstrip("."),
        )
        for history, reason in table.missing.items()
    )  # fmt: skip


def _static_load_verdict(
    criterion: Criterion, name: str, force: Sequence[float] | Array, rated: float | None, unjudged: str = ""
) -> Verdict:
    """Judge the compression of a mount's force (3,) [N] against its rated load, unless `unjudged` gives a reason not to."""
    note = unjudged or static_load_unjudged(force, rated)
    compression = max(-float(force[2]), 0.0)
    limit = None if note else rated
    return Verdict(criterion=criterion, subject=name, value=compression, limit=limit, unit="N", note=note)


def force_verdicts(response: Response, limits: Sequence[PayloadLimit] | None = None) -> tuple[Verdict, ...]:
    """Judge the largest force [N] of mounts, and the force [N], closing speed [m/s] and travel in the gap [m] of their stops.

    () without such limits. The load of a mount is that of its foot: where a stop stands at the mount's own sites and was
    pressed, their forces together are bounded by the peaks of both, which no instant exceeds.

    Args:
        response: of a run.
        limits: of kind "load" (a mount) and "force", "closing", "gap" (each stop of a mount); without them the model's own.

    Raises:
        ValueError: a limit names no mount, or one of stops a mount without a stop.
    """
    contacts = response.peaks.contacts or {}
    stops = [(contact.mount, name, contact) for name, contact in contacts.items() if contact.mount]
    loads = limits_by_name(response, limits, "load", list(response.peaks.mounts))
    of_stops = {kind: limits_by_name(response, limits, kind, [mount for mount, _, _ in stops]) for kind in ON_STOPS}
    verdicts = []
    for name, limit in loads.items():
        of_mount = response.peaks.mounts[name].force
        value, time, note = of_mount.value, of_mount.time, ""
        beside = {stop: response.peaks.mounts[stop].force for stop in stops_beside(response.scene, [name])}
        pressed = {stop: peak for stop, peak in beside.items() if peak.value > 0.0}
        if pressed:
            peaks = [of_mount, *pressed.values()]
            low, high = sum(peak.minimum for peak in peaks), sum(peak.maximum for peak in peaks)
            along = np.maximum(np.abs(low), np.abs(high))  # all share the axes of the sites
            value = min(float(np.linalg.norm(along)), sum(peak.value for peak in peaks))
            time = max(peaks, key=lambda peak: peak.value).time
            note = f"bound of the foot's load: the peaks of {name} and of {' and '.join(pressed)}, which stands in it, together"
        verdicts.append(
            Verdict(criterion=Criterion(LOAD), subject=name, value=value, limit=limit.values[0], unit="N", time=time, note=note)
        )
    return (
        *verdicts,
        *(
            verdict
            for kind in ON_STOPS
            for mount, name, stop in stops
            if mount in of_stops[kind]
            for verdict in _stop_verdicts(response, kind, of_stops[kind][mount].values[0], name, stop)
        ),
    )  # fmt: skip


def stops_beside(scene: Scene, names: Collection[str]) -> list[str]:
    """List the stops that stand at the same sites, and so on the same feet, as mounts; stops among `names` are left out."""
    feet = {mount.sites for mount in scene.isolating if mount.name in names}
    return [stop.name for stop in scene.stops if stop.sites in feet and stop.name not in names]


def _stop_verdicts(response: Response, kind: str, limit: float, name: str, stop: ContactPeak) -> list[Verdict]:
    """Judge force or closing speed of a stop, or its travel in the gap of each side, by peaks over all steps."""
    if kind == "force":
        of_force = Verdict(
            criterion=Criterion(STOP_FORCE), subject=name, value=stop.force, limit=limit, unit="N", time=stop.force_time
        )
        return [of_force]
    which, unit = (CLOSING_SPEED, "m/s") if kind == "closing" else (STOP_GAP, "m")
    if not stop.axis:
        note = "an older version made the run, and recorded neither gaps nor closing speeds"
        return [Verdict(criterion=Criterion(which), subject=name, value=math.nan, limit=None, unit=unit, note=note)]
    if kind == "closing":
        speed, when = stop.closing_speed or 0.0, stop.closing_time
        return [Verdict(criterion=Criterion(which), subject=name, value=speed, limit=limit, unit=unit, time=when)]
    peak, axis, verdicts = response.peaks.mounts[stop.mount].deflection, AXES.index(stop.axis), []
    rest = stop.rest or 0.0
    start = read_start(response, f"mounts/{stop.mount}/deflection/roll")[axis] - rest
    ends = {
        "below": (-start, rest - peak.minimum[axis], peak.minimum_time[axis]),
        "above": (start, peak.maximum[axis] - rest, peak.maximum_time[axis]),
    }
    for side, gap in stop.gaps.items():
        at_start, value, time = (float(number) for number in ends[side])
        note = f"travel to the stop from {'rest, where it was installed' if stop.rest else 'the unloaded geometry'}"
        allowed: float | None = limit * gap or max(at_start, LEAST_GAP)
        if not stop.struck and (at_start >= gap or not gap):
            allowed, note = None, f"{note}; {RESTS if stop.from_start else NO_GAP}"
        elif not gap:
            taken = "where it rests" if at_start > LEAST_GAP else f"{1e3 * LEAST_GAP:g} mm"
            note += f"; for its gap of 0 {taken} is taken, which any motion exceeds: a limit on force/{stop.mount} says more"
        sense = side if len(stop.gaps) > 1 else ""
        verdicts.append(
            Verdict(
                criterion=Criterion(which, sense=sense), subject=name, unit=unit, value=max(value, 0.0), limit=allowed,
                time=time, note=note,
            )
        )  # fmt: skip
    return verdicts


# Why the use of its gap is not judged of a stop that is not struck
RESTS = "the payload rests on it from the start of the run, which is no strike"
NO_GAP = "its gap is 0, of which nothing is a fraction, and it is not struck"


def contact_verdicts(response: Response) -> tuple[Verdict, ...]:
    """Report for every contact pair and every stop whether it was struck, touching or clear, with its largest force [N].

    () without recorded contacts. No limit is stated for a contact: that a stop is struck is the finding, since the
    accelerations depend on its stiffness and damping from then on.
    """
    return tuple(
        Verdict(
            criterion=STOP if contact.mount else CONTACT, subject=name, value=contact.force, limit=None, unit="N",
            time=contact.force_time, note=contact_text(contact),
            contact=STRUCK if contact.struck else TOUCHING if contact.touches else CLEAR,
        )
        for name, contact in (response.peaks.contacts or {}).items()
    )  # fmt: skip


def contact_text(contact: ContactPeak) -> str:
    """Describe the first touch of a pair or stop, the number of strikes, duration and depth; "" if it never touched."""
    if not contact.touches:
        return ""
    strikes = contact.touches - int(contact.from_start)
    begin = "touching from the start" if contact.from_start else f"first at {contact.first_touch:.4f} s"
    again = "again " if contact.from_start else ""
    often = f", struck {again}{'once' if strikes == 1 else f'{strikes} times'}" if strikes else ""
    return f"{begin}{often}, {duration_text(contact.duration)} in all, {1e3 * contact.penetration:.3g} mm deep"


def closing_text(name: str, contact: ContactPeak) -> str:
    """Describe the first closing of a mount's stop and its largest force: "stop s3 closed at 61.2 ms, up to 4.1 kN"."""
    when = instant_text(contact.first_touch or 0.0)
    return f"{contact.called(name)} closed at {when}, up to {force_text(contact.force)}"


def foundation_force(response: Response, names: Collection[str] | None = None) -> Array:
    """Sum the forces of all mounts, or of those named, on the base or world, weight included [N], world axes, (n_t, 3).

    A mount pulls its payload by minus R F and its base by R F, with R the axes of the base site, see
    `wirerope_mj.engine.control.mounts`; those whose base moves by itself, such as a frame between two stages, are left out.
    """
    bodies = {body.name: body for body in response.scene.bodies}
    total = np.zeros((response.time.size, 3))
    for mount in mounts_on_base(response.scene):
        if names is None or mount.name in names:
            body = bodies.get(mount.base_body)  # None: the world
            axes = mount.axes if body is None else rotation_matrices(body.orientation) @ mount.axes
            total += response.mounts[mount.name].force @ axes.T
    return total


def mounts_on_base(scene: Scene) -> list[SceneMount]:
    """List the mounts that stand on the base or on the world, not on a body that moves by itself."""
    moving = {body.name for body in scene.bodies if body.moves and not body.on_base}
    return [mount for mount in scene.mounts if mount.base_body not in moving]


@dataclass(frozen=True, kw_only=True)
class AreaForce:
    """Loads of the mounts on an area of the deck, the largest over all samples."""

    name: str  # of the area; "" for all mounts together
    mounts: int  # number of mounts that stand on it
    at_rest: float  # downward force at the first sample [N]
    # down, up, across: largest force downwards, upwards and level, >= 0 [N]
    down: float
    # down_time, up_time, across_time: their instants [s]
    down_time: float
    up: float
    up_time: float
    across: float
    across_time: float


def area_forces(response: Response, up: Array | None = None) -> list[AreaForce]:
    """Find the largest forces on the deck of all mounts and of each area's mounts, with the stops at their sites.

    Contacts of geoms are left out. `up` is the unit vector against gravity, (3,), z by default.
    """
    vertical = np.array([0.0, 0.0, 1.0]) if up is None else up
    time, on_deck = response.time, [mount.name for mount in mounts_on_base(response.scene)]
    areas: dict[str, Collection[str]] = {"": on_deck, **response.scene.areas}
    loads = []
    for name, mounts in areas.items():
        force = foundation_force(response, [*mounts, *stops_beside(response.scene, mounts)])
        along = force @ vertical
        across = np.linalg.norm(force - along[:, np.newaxis] * vertical, axis=1)
        low, high, side = int(along.argmin()), int(along.argmax()), int(across.argmax())
        loads.append(
            AreaForce(
                name=name, mounts=len(set(mounts) & set(on_deck)), at_rest=float(-along[0]),
                down=max(float(-along[low]), 0.0), down_time=float(time[low]),
                up=max(float(along[high]), 0.0), up_time=float(time[high]),
                across=float(across[side]), across_time=float(time[side]),
            )
        )  # fmt: skip
    return loads


@dataclass(frozen=True, kw_only=True)
class BoltLoad:
    """Largest loads of a bolt on the base side of a mount, over the samples: tension and shear [N], and their instants [s]."""

    mount: str
    bolts: int
    tension: float
    tension_time: float
    shear: float
    shear_time: float


def bolt_loads(response: Response) -> list[BoltLoad]:
    """Compute the bolt loads of every mount whose isolator states its number of bolts, the largest tension first.

    The bolts bear the forces of stops at the mount's sites, too. The plate is rigid. A bolt has its share of the axial tension
    and of the force across. The force across acts at half the height: its moment pulls the bolts of one side by F h / 2 over
    their distance, shared by half of them; about its own line a row of bolts bears no moment, the plate's edges do.
    Prying and preload are left out.
    """
    loads = []
    for mount in response.scene.mounts:
        number, *distances = mount.bolts
        if math.isnan(number):
            continue
        beside = stops_beside(response.scene, [mount.name])
        force = sum((response.mounts[stop].force for stop in beside), response.mounts[mount.name].force)
        height = mount.height if math.isfinite(mount.height) else 0.0
        tension = force[:, 2] / number
        for axis, distance in enumerate(distances):
            if number > 1 and math.isfinite(distance):
                tension = tension + np.abs(force[:, axis]) * 0.5 * height / (distance * 0.5 * number)
        shear = np.hypot(force[:, 0], force[:, 1]) / number
        top, side = int(tension.argmax()), int(shear.argmax())
        loads.append(
            BoltLoad(
                mount=mount.name, bolts=int(number), tension=max(float(tension[top]), 0.0),
                tension_time=float(response.time[top]), shear=float(shear[side]), shear_time=float(response.time[side]),
            )
        )  # fmt: skip
    return sorted(loads, key=lambda load: -load.tension)


@dataclass(frozen=True, kw_only=True)
class StopLoad:
    """Largest force of a stop on its anchor, over every step.

    For a mount that is itself a stop, the resultant of all its axes at one instant.
    """

    name: str
    base: str  # body that it stands on
    force: float  # [N]
    vector: Array  # its components in the world's axes, of the modelled orientation [N], (3,)
    time: float  # its instant [s]


def stop_loads(response: Response) -> list[StopLoad]:
    """Find the largest load of every stop of a mount that touched, the largest first."""
    bodies, loads = {body.name: body for body in response.scene.bodies}, []
    touched = {name: contact for name, contact in (response.peaks.contacts or {}).items() if contact.mount and contact.touches}
    for mount in response.scene.mounts:
        axes = mount.axes
        if (body := bodies.get(mount.base_body)) is not None:  # None: the world
            axes = rotation_matrices(body.orientation) @ mount.axes
        own = {name: contact for name, contact in touched.items() if contact.mount == mount.name}
        peak = response.peaks.mounts[mount.name]
        if mount.stop and own:
            largest = peak.force
            loads.append(
                StopLoad(
                    name=mount.name, base=mount.base_body, force=largest.value, vector=axes @ largest.vector, time=largest.time
                )
            )
            continue
        for name, contact in own.items():
            if contact.axis:
                axis, rest = AXES.index(contact.axis), contact.rest or 0.0
                ends = {"below": rest - peak.deflection.minimum[axis], "above": peak.deflection.maximum[axis] - rest}
                _, pushed = max((ends[side] - gap, -1.0 if side == "below" else 1.0) for side, gap in contact.gaps.items())
                along = pushed * contact.force * axes[:, axis]
                when = contact.force_time or 0.0
                loads.append(StopLoad(name=name, base=mount.base_body, force=contact.force, vector=along, time=when))
    return sorted(loads, key=lambda load: -load.force)
