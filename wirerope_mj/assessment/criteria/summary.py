"""Summary of a run: its verdicts in sentences, and its peaks, limits and verdicts as plain values."""

from collections.abc import Sequence
from dataclasses import dataclass, replace

from wirerope_mj.assessment.criteria.ended import too_short
from wirerope_mj.assessment.criteria.judge import OF_MOUNTS, headline
from wirerope_mj.assessment.criteria.loads import closing_text
from wirerope_mj.assessment.criteria.travel import ELLIPSOID, STOPPED, peak_travel_verdicts
from wirerope_mj.assessment.criteria.verdict import (
    ACCELERATION,
    BOTTOMING,
    BY_LIMITS,
    COMBINED,
    CONTACT,
    EXCEEDED,
    NOT_JUDGED,
    RATTLE_SPACE,
    RESTED,
    STATIC_LOAD,
    STOP,
    TRAVEL,
    WITHIN,
    Verdict,
    against_limit,
    most_used,
    used_text,
)
from wirerope_mj.engine.response import Response
from wirerope_mj.foundation.arrays import Entries
from wirerope_mj.foundation.units import force_text, in_unit, instant_text
from wirerope_mj.mounts.isolator import AXES
from wirerope_mj.mounts.isolator.travel import RATINGS, SIDES, one_way, travel_reached

Vector = tuple[float, float, float]


@dataclass(frozen=True, kw_only=True)
class BodyPeak:
    """Largest acceleration of a body or a point [m/s^2]: its size, instant [s] and the largest along x, y and z."""

    name: str
    kind: str
    value: float
    time: float
    axes: Vector


@dataclass(frozen=True, kw_only=True)
class MountPeak:
    """Peaks of a mount's deflection and force, and the verdicts on its travel."""

    name: str
    isolator: str  # name of the device
    # minimum, maximum: extreme deflections along roll, shear, axial [m]
    minimum: tuple[float, ...]
    maximum: tuple[float, ...]
    force: Vector  # extreme force along roll, shear, axial, with its sign [N]
    travel: dict[str, Verdict]  # verdicts by rating: "compression", "tension", "shear", "roll"
    one_way: str  # rating that is not stated and in which alone it moves along its axis, "" if there is none

    @property
    def utilisation(self) -> float | None:
        """Largest utilisation of a rated travel; None = not judged."""
        return max((row.utilisation for row in self.travel.values() if row.utilisation is not None), default=None)

    @property
    def governing(self) -> str:
        """Rating with the largest utilisation, such as "shear"; "" where nothing is judged."""
        if self.utilisation is None:
            return ""
        return max(self.travel, key=lambda rating: self.travel[rating].utilisation or 0.0)

    @property
    def exceeded(self) -> list[str]:
        return [rating for rating, row in self.travel.items() if row.verdict == EXCEEDED]

    def utilisation_along(self, axis: str) -> float | None:
        """Find the largest utilisation of the ratings of "roll", "shear" or "axial"; None = not judged."""
        values = [self.travel[side].utilisation for side in SIDES[axis]]
        return max((value for value in values if value is not None), default=None)


def body_peaks(response: Response) -> list[BodyPeak]:
    """List the peaks of base, bodies and points; the base first, then the largest."""
    bodies, points = response.peaks.bodies, response.peaks.points
    peaks = [("base" if name == response.scene.base else "body", name, bodies[name].acceleration) for name in bodies]
    peaks += [("point", name, points[name].acceleration) for name in points]
    rows = []
    for kind, name, peak in peaks:
        x, y, z = (float(max(high, -low)) for low, high in zip(peak.minimum, peak.maximum, strict=True))
        rows.append(BodyPeak(name=name, kind=kind, value=peak.value, time=peak.time, axes=(x, y, z)))
    return sorted(rows, key=lambda row: (row.kind != "base", -row.value))


def mount_peaks(response: Response) -> list[MountPeak]:
    """List the peaks of the mounts; the largest utilisation of a rated travel first, those not judged last."""
    rows, early = [], too_short(response)
    for mount in response.scene.isolating:
        peaks = response.peaks.mounts[mount.name]
        force = zip(peaks.force.minimum.tolist(), peaks.force.maximum.tolist(), strict=True)
        roll, shear, axial = (high if high >= -low else low for low, high in force)
        rows.append(
            MountPeak(
                name=mount.name, isolator=mount.isolator, minimum=tuple(peaks.deflection.minimum.tolist()),
                maximum=tuple(peaks.deflection.maximum.tolist()), force=(roll, shear, axial),
                travel={
                    rating: replace(row, limit=None, note=early) if early and row.verdict == WITHIN else row
                    for rating, row in peak_travel_verdicts(mount, peaks.deflection).items()
                },
                one_way=one_way(travel_reached(peaks.deflection.minimum, peaks.deflection.maximum), mount.travel),
            )
        )  # fmt: skip
    return sorted(rows, key=lambda row: -1.0 if row.utilisation is None else row.utilisation, reverse=True)


# Stated wherever combined travel is exceeded.
OWN_RULE = (
    "Combined travel, the ellipsoid through the rated travels, is this program's own rule; `wirerope run "
    "--no-combined-travel`, or 0 for limit/combined_travel in the model, leaves it out."
)
COMBINED_MEANS = (
    "Combined travel (in-house rule): the root of the sum of the squares of what is used of a mount's rated travel along each "
    "of its axes at one instant; above 100 % it is exceeded."
)
_NAMED = 4  # contact pairs that a sentence names
_LIMITS = 8  # limits of payload, loads and stops that have lines of their own


def verdict_lines(response: Response, verdicts: Sequence[Verdict]) -> list[str]:
    """Describe the verdicts in a few sentences: payload and worst mount against their limits, and what is not judged."""
    early = too_short(response)  # the reason stands in the headline
    lines = ["What is not exceeded yet is not judged."] if early else []
    kinds = (ACCELERATION, RATTLE_SPACE)
    elsewhere = set(OF_MOUNTS) - {*BY_LIMITS}
    rows = [row for row in verdicts if row.criterion.kind not in elsewhere and not row.contact]
    judged = sorted((row for row in rows if row.utilisation is not None), key=lambda row: -(row.utilisation or 0.0))
    lines += [f"{row.verdict.capitalize()}: {against_limit(row)}." for row in judged[:_LIMITS]]
    if more := judged[_LIMITS:]:
        over = sum(row.verdict == EXCEEDED for row in more)
        lines.append(f"Of the other limits {over or 'none'} of {len(more)} is exceeded.")
    unjudged = [kind for kind in kinds if not any(row.criterion.kind == kind for row in judged)]
    if unjudged and rows and not early:
        lines.append(f"Not judged, because the model states no limit: {' and '.join(unjudged)} of the payload.")
    mounts = mount_peaks(response)
    rated = [row for row in mounts if row.utilisation is not None]
    lines += single_travel_lines([verdict for row in mounts for verdict in row.travel.values()])
    lines += (_combined_lines(response, verdicts, early) if rated else []) + pressed_lines(verdicts)
    together = any(row.criterion == COMBINED and row.verdict != NOT_JUDGED for row in verdicts)  # its line names tension
    untensioned = bool(rated) and not together and all(row.travel["tension"].utilisation is None for row in rated)
    unrated = ["tension of every mount"] * untensioned
    unrated += [f"{row.one_way} of {row.name}".removeprefix(" of ") for row in mounts if row.utilisation is None]
    if unrated and not early:
        lines.append(f"Not judged, because no travel is rated: {', '.join(unrated)}.")
    return lines + static_load_lines(verdicts) + contact_lines(response, early)


def static_load_lines(verdicts: Sequence[Verdict]) -> list[str]:
    """Describe the mount with most of its rated static load in a line; no line where no static load is judged."""
    worst = most_used(row for row in verdicts if row.criterion.kind == STATIC_LOAD)
    if worst is None:
        return []
    used = used_text(worst.utilisation or 0.0)
    return [f"Static load: {worst.verdict}; most used {worst.subject}, {used} of rated {worst.criterion}."]


def rested_lines(verdicts: Sequence[Verdict]) -> list[str]:
    """Describe the weight that stops or contacts carry at rest, virgin and relaxed; no line where they carry none."""
    return [f"{row.note[:1].upper()}{row.note[1:]}." for row in verdicts if row.criterion.kind == RESTED]


def rule_lines(verdicts: Sequence[Verdict]) -> list[str]:
    return [OWN_RULE] if any(row.criterion == COMBINED and row.verdict == EXCEEDED for row in verdicts) else []


def contact_lines(response: Response, early: str = "") -> list[str]:
    """Describe the contacts of a run: struck pairs of geoms and the hardest of them, closed stops, lasting contacts."""
    known, lines = response.peaks.contacts or {}, []
    for thing, of_mounts in (("contact pair", False), ("bump stop", True)):
        contacts = {name: contact for name, contact in known.items() if bool(contact.mount) is of_mounts}
        struck = [name for name in response.peaks.struck if name in contacts]
        if struck and of_mounts:
            text = _listed([closing_text(name, contacts[name]) for name in struck], "; ")
            lines.append(f"{text[0].upper()}{text[1:]}. From then on accelerations depend on what the stops are made of.")
        elif struck:
            first, hardest = contacts[struck[0]], max(struck, key=lambda name: contacts[name].force)
            lines.append(
                f"Struck: {_listed(struck)}; first {struck[0]} at {first.first_touch:.4f} s, hardest {hardest} with "
                f"{force_text(contacts[hardest].force)}. Accelerations are uncertain from the first touch on."
            )
        elif contacts and not any(contact.touches for contact in contacts.values()):
            which = f"The {thing} is not" if len(contacts) == 1 else f"None of the {len(contacts)} {thing}s is"
            lines.append(f"{which} touched{' until the run ends' if early else ''}.")
    resting = [contact.called(name) for name, contact in known.items() if contact.from_start and not contact.struck]
    return [*lines, f"Touching from the start: {_listed(resting)}."] if resting else lines


def _listed(names: list[str], between: str = ", ") -> str:
    """Join the first names, and say how many more there are."""
    more = f" and {len(names) - _NAMED} more" if len(names) > _NAMED else ""
    return between.join(names[:_NAMED]) + more


def single_travel_lines(verdicts: Sequence[Verdict]) -> list[str]:
    """Describe travel along single axes in a line: mounts that exceed it, and the most used; no line if no travel is judged."""
    rows = [row for row in verdicts if row.criterion.kind == TRAVEL]
    worst = most_used(rows)
    if worst is None:
        return []
    used = f"{used_text(worst.utilisation or 0.0)} in {worst.criterion.sense}{_instant(worst)}"
    over = [row for row in rows if row.verdict == EXCEEDED]
    names = {rating: dict.fromkeys(row.subject for row in over if row.criterion.sense == rating) for rating in RATINGS}
    exceeded = [f"in {rating} by {', '.join(mounts)}" for rating, mounts in names.items() if mounts]
    every = all(any(row.limit is not None for row in rows if row.subject == name) for name in {row.subject for row in rows})
    within = f"within at every mount{'' if every else ' that is judged'}"
    answer = f"exceeded {'; '.join(exceeded)}" if exceeded else within
    return [f"Travel along single axes: {answer}; most used {worst.subject}, {used}."]


def _instant(row: Verdict) -> str:
    return "" if row.time is None else f" at {instant_text(row.time)}"


def pressed_lines(verdicts: Sequence[Verdict]) -> list[str]:
    """Name in a line the mounts that are pressed until their bars meet and beyond; no line without such mounts."""
    rows = [row for row in verdicts if row.criterion == BOTTOMING and row.verdict == EXCEEDED]
    stopped = dict.fromkeys(row.subject for row in rows if row.note.endswith(STOPPED))
    lines = [f"Bottomed, pressed until solid: {', '.join(stopped)}."] if stopped else []
    flat = dict.fromkeys(row.subject for row in rows if row.subject not in stopped)
    return [
        *lines,
        f"Pressed until the bars meet and beyond, which cannot be: {', '.join(flat)}. A stop is missing in the model, or "
        "it is too far away or too soft."
    ] if flat else lines  # fmt: skip


def _combined_lines(response: Response, verdicts: Sequence[Verdict], early: str) -> list[str]:
    """Describe combined travel in a line: mounts that exceed it, directions without a rating, and mounts not judged."""
    every = [row for row in verdicts if row.criterion == COMBINED]
    rows = {row.subject: row for row in every if row.verdict != NOT_JUDGED}
    worst = most_used(rows.values())
    if worst is None:
        return []
    over = sum(row.verdict == EXCEEDED for row in rows.values())
    which = f"all {len(rows)} mounts{'' if len(rows) == len(every) else ' that are judged'}"
    within = f"is within at {'the only mount' if len(every) == 1 else which}"
    answer = f"exceeds 100 % at {over} of {len(rows)} mounts" if over else within
    parts = [f"Combined travel {answer}; most used {worst.subject}, {used_text(worst.value)}{_instant(worst)} (in-house rule)"]
    rated = {mount.name: mount.travel for mount in response.scene.mounts}
    travels = [row for row in verdicts if row.subject in rows and row.criterion.kind == TRAVEL and row.value > 0.0]
    for way in ("compression", "tension"):
        unrated = [row for row in travels if row.criterion.sense == way and way not in rated[row.subject]]
        if unrated:
            most = max(unrated, key=lambda row: row.value)
            parts.append(f"{way}, up to {1e3 * most.value:.3g} mm at {most.subject}, has no limit and is left out")
    reasons: dict[str, list[str]] = {}
    for row in every:
        if row.verdict == NOT_JUDGED and not early:
            reasons.setdefault(", ".join(part for part in row.note.split("; ") if part != ELLIPSOID), []).append(row.subject)
    parts += [f"not judged at {_listed(names)}: {reason}" for reason, names in reasons.items()]
    return [f"{'; '.join(parts)}."]


def summary(response: Response, verdicts: Sequence[Verdict]) -> Entries:
    """Summarise headline, peaks, limits and `verdicts` as plain values: accelerations [g], deflections [m], forces [N]."""
    travel = {mount.name: mount.travel for mount in response.scene.mounts}
    of_contacts = {row.subject: row.verdict for row in verdicts if row.criterion in (CONTACT, STOP)}
    accelerations = [
        {
            "name": row.name, "kind": row.kind, "peak_g": in_unit(row.value, "g"), "time_s": row.time,
            "axes_g": [in_unit(size, "g") for size in row.axes],
        }
        for row in body_peaks(response)
    ]  # fmt: skip
    mounts, early = [], too_short(response)
    for row in mount_peaks(response):
        # of rated travels that are not judged, since the mount moves one way, too
        alone = {} if early or not row.one_way else {way: row.travel[way].value / far for way, far in travel[row.name].items()}
        verdict = f"exceeds {', '.join(row.exceeded)}" if row.exceeded else NOT_JUDGED if row.utilisation is None else WITHIN
        mounts.append({
            "name": row.name, "isolator": row.isolator, "verdict": verdict,
            "share_of_travel": {rating: verdict.utilisation for rating, verdict in row.travel.items()} | alone,
            "rated_travel_m": travel[row.name],
            "lowest_deflection_m": dict(zip(AXES, row.minimum, strict=True)),
            "highest_deflection_m": dict(zip(AXES, row.maximum, strict=True)),
            "extreme_force_N": dict(zip(AXES, row.force, strict=True)),
        })  # fmt: skip
    contacts = None  # of older runs, which did not record them
    if response.peaks.contacts is not None:
        contacts = [
            {
                "name": name, "geoms": list(contact.geoms), "bodies": list(contact.bodies), "mount": contact.mount,
                "verdict": of_contacts.get(name, NOT_JUDGED), "from_start": contact.from_start, "touches": contact.touches,
                "first_touch_s": contact.first_touch, "duration_s": contact.duration, "peak_force_N": contact.force,
                "peak_force_time_s": contact.force_time, "penetration_m": contact.penetration,
                "penetration_time_s": contact.penetration_time,
            }
            | ({} if contact.energy is None else {"energy_J": contact.energy})
            | ({} if contact.closing_speed is None else {"closing_speed_m_s": contact.closing_speed})
            for name, contact in response.peaks.contacts.items()
        ]  # fmt: skip
    return {
        "headline": headline(verdicts), "verdicts": verdict_lines(response, verdicts),
        "judged": [verdict.to_dict() for verdict in verdicts],
        "accelerations": accelerations, "mounts": mounts, "contacts": contacts,
    }  # fmt: skip
