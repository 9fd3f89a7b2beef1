"""Verdicts on mount deflections: rated travels along single axes and combined, bottoming, and tested ranges."""

import math
from collections.abc import Mapping
from dataclasses import replace

import numpy as np

from wirerope_mj.assessment.criteria.sampled import read_columns, sampled_peak, sampled_text
from wirerope_mj.assessment.criteria.verdict import BOTTOMING, COMBINED, EXCEEDED, TRAVEL, Criterion, Verdict
from wirerope_mj.engine.response import Peak, Response
from wirerope_mj.engine.response.peaks import CombinedTravel
from wirerope_mj.engine.response.scene import SceneMount
from wirerope_mj.engine.statics import StaticTable
from wirerope_mj.foundation.arrays import Array, Booleans
from wirerope_mj.foundation.units import duration_text
from wirerope_mj.mounts.isolator import Isolator
from wirerope_mj.mounts.isolator.travel import RATINGS, falling_text, one_way, travel_in, travel_reached


def travel_verdicts(response: Response) -> tuple[Verdict, ...]:
    """Judge the travel of every mount in compression, tension, shear and roll, and combined.

    Deflections count from the unloaded mount, so that the sag is part of them. Beyond its rated compression a wire-rope
    isolator bottoms; for how long is in the note. Stops of the model are contacts, judged by `contact_verdicts`: a
    deflection ends at a stop.

    No standard and no vendor gives a rule for several axes at once: the ellipsoid through the rated travels, beyond which
    "travel combined" is exceeded, is this project's own. A model or `wirerope run --no-combined-travel` switches it off.
    """
    verdicts: list[Verdict] = []
    for mount in response.scene.isolating:
        deflection = read_columns(response, f"mounts/{mount.name}/deflection/roll", 3)
        for rating, verdict in peak_travel_verdicts(mount, response.peaks.mounts[mount.name].deflection).items():
            if verdict.verdict == EXCEEDED:
                beyond = _duration_in_all(response.time, travel_in(rating, deflection) > mount.travel[rating])
                verdict = replace(verdict, note=beyond and f"beyond it for {beyond}")
            verdicts.append(verdict)
        if response.scene.combined_travel:
            verdicts.append(_combined_verdict(response, mount, deflection))
    return tuple(verdicts)


def peak_travel_verdicts(mount: SceneMount, peak: Peak) -> dict[str, Verdict]:
    """Judge a mount's extreme deflections over all steps against its rated travels; returns verdicts by rating."""
    reached, verdicts = travel_reached(peak.minimum, peak.maximum), {}
    notes = _unjudged(reached, mount.travel)
    for rating, (axis, way) in RATINGS.items():
        down = way < 0.0 or (way == 0.0 and -peak.minimum[axis] > peak.maximum[axis])
        verdicts[rating] = Verdict(
            criterion=Criterion(TRAVEL, sense=rating), subject=mount.name, value=float(reached[rating]),
            limit=None if rating in notes else mount.travel[rating], unit="m",
            time=float(peak.minimum_time[axis] if down else peak.maximum_time[axis]),
            note=notes.get(rating, ""),
        )  # fmt: skip
    return verdicts


def _unjudged(reached: Mapping[str, Array], rated: Mapping[str, float]) -> dict[str, str]:
    """Say why ratings are not judged: none is stated, or the mount moves only, and farther, in an unrated way along its axis.

    A rating that is exceeded is judged in any case.
    """
    notes = {rating: f"no travel in {rating} is rated" for rating in RATINGS if rating not in rated}
    if lone := one_way(reached, rated):
        reason = f"in {lone} throughout, and {notes[lone]}"
        notes |= {
            rating: reason for rating, travel in rated.items() if float(reached[rating]) <= min(travel, float(reached[lone]))
        }
    return notes


def rest_travel_verdicts(
    isolators: Mapping[str, Isolator], table: StaticTable, bottoms: Mapping[str, str] | None = None
) -> tuple[Verdict, ...]:
    """Judge the travel and bottoming of every mount at rest, virgin and relaxed.

    `isolators` and `bottoms`, the names of stops where mounts go solid, are by mount.
    """
    verdicts: list[Verdict] = []
    for history, sag in table.sags.items():
        for name, mount in sag.listed.items():
            if mount.stop:
                continue
            rated, geometry = isolators[name].limits.travel.stated, isolators[name].geometry
            reached = travel_reached(mount.deflection, mount.deflection)
            unjudged, note = _unjudged(reached, rated), f"at rest, {history}"
            solid = None if geometry is None else geometry.solid_compression
            verdicts += [
                Verdict(
                    criterion=Criterion(TRAVEL, sense=rating), subject=name, value=float(reached[rating]), unit="m",
                    limit=None if rating in unjudged else rated[rating],
                    note=f"{note}; {unjudged[rating]}" if rating in unjudged else note,
                )
                for rating in RATINGS
            ]  # fmt: skip
            if name in (bottoms or {}):
                law = isolators[(bottoms or {})[name]].axial
                solid, note = (law.parameter("gap_below") if law else solid), f"{note}: {STOPPED}"
            if one_way(reached, rated) == "tension":
                solid = None
            value = float(reached["compression"])
            verdicts.append(Verdict(criterion=BOTTOMING, subject=name, value=value, limit=solid, unit="m", note=note))
    return tuple(verdicts)


def bottoming_verdicts(response: Response) -> tuple[Verdict, ...]:
    """Judge the largest compression of every mount against the compression at which its bars meet, height - 2 bar.

    The rated compression, less than that, is where the vendor says that a mount bottoms: see `travel_verdicts`. No law knows
    that the bars meet; compressions beyond it cannot happen, and show that a stop is missing in the model. Where a stop stands
    at the sites of a mount its gap is the limit. Where the isolator does not state the thickness of its bars, the whole height
    is an upper bound, by which a value can only be exceeded.
    """
    verdicts = []
    bottoms = bottoms_of(response)
    for mount in response.scene.isolating:
        deflection = response.peaks.mounts[mount.name].deflection
        compression = max(-float(deflection.minimum[2]), 0.0)
        limit, note = None, "the isolator states no thickness of its bars"
        if mount.name in bottoms:
            name, gap = bottoms[mount.name]
            limit, note = gap, f"compression at which {name} closes: {STOPPED}"
        elif not math.isnan(mount.bar):
            limit = mount.height - 2.0 * mount.bar
            size = f"{1e3 * mount.height:.4g} mm - 2 x {1e3 * mount.bar:.4g} mm"
            note = f"compression at which the bars meet: height less two bars, {size}"
        elif math.isnan(mount.height):
            note = "the isolator states no height"
        elif compression > mount.height:
            limit, note = mount.height, f"compression against the whole height; {note}"
        if one_way(travel_reached(deflection.minimum, deflection.maximum), mount.travel) == "tension":
            limit, note = None, "in tension throughout, and no travel in tension is rated"
        verdicts.append(Verdict(
            criterion=BOTTOMING, subject=mount.name, value=compression, limit=limit, unit="m",
            time=float(deflection.minimum_time[2]), note=note,
        ))  # fmt: skip
    return tuple(verdicts)


STOPPED = "a stop holds the mount there"  # Ends the notes on bottoming of mounts with a stop of their own


def bottoms_of(response: Response) -> dict[str, tuple[str, float]]:
    """Find the stop at the sites of each mount where it bottoms: its name and gap in compression [m], by mount."""
    found = {}
    contacts = response.peaks.contacts or {}
    for stop in response.scene.stops:
        contact = contacts.get(stop.name)
        if contact is not None and contact.axis == "axial" and contact.gap_below and contact.rest is None:
            found[stop.sites] = stop.name, contact.gap_below
    return {mount.name: found[mount.sites] for mount in response.scene.isolating if mount.sites in found}


def combined_travel(mount: SceneMount, deflection: Array) -> Array:
    """Compute the combined utilisation of a mount's rated travels, (n_t,), from its deflection (n_t, 3)."""
    total = np.zeros(len(deflection))
    for rating, travel in mount.travel.items():
        total += (travel_in(rating, deflection) / travel) ** 2
    return np.sqrt(total)


def combined_utilisation(farthest: Array, judged: Array, reached: Array, rated: Array) -> Array:
    """Compute the combined utilisation of many mounts, (...), by the rule of a run's verdicts; NaN where it is not judged.

    `farthest` is the largest utilisation over all steps, `judged` that over the steps at which the direction of the axial
    deflection is rated, (...); `reached` and `rated` are travels in the order of RATINGS [m], (..., 4); NaN for missing values.
    """
    across = np.array([way == 0.0 for _, way in RATINGS.values()])
    bound = np.isnan(judged) | (np.isnan(rated) & (reached > 0.0))[..., across].any(axis=-1)
    return np.asarray(np.where(bound & (farthest <= 1.0) | np.isnan(rated).all(axis=-1), np.nan, farthest))


ELLIPSOID = "sqrt of the sum of (deflection / rated)^2 at one instant"


def _combined_verdict(response: Response, mount: SceneMount, deflection: Array) -> Verdict:
    """Judge all axes at once: the largest sqrt(sum (deflection / rated)^2) of every step against 1."""
    # A rebound into tension, which few vendors rate, counts nothing in the sum, and is noted; so no single axis uses more than
    # the sum. Of a mount that is never compressed, or whose shear or roll is not rated, the sum is a lower bound: it can exceed
    # the limit, but not be within. Older responses have samples alone, which must not miss the peaks of every step.
    peak = response.peaks.mounts[mount.name].deflection
    reached = travel_reached(peak.minimum, peak.maximum)
    missing = [rating for rating in RATINGS if rating not in mount.travel and reached[rating] > 0.0]
    followed = response.peaks.travels
    travel = _sampled_combined_travel(response.time, mount, deflection) if followed is None else followed[mount.name]
    value, when, notes = travel.value, travel.time, [ELLIPSOID]
    bound = travel.judged is None or any(RATINGS[rating][1] == 0.0 for rating in missing)
    ways = [rating for rating in missing if RATINGS[rating][1]]
    one_way = ways[0] if ways else None
    if one_way and value <= 1.0 and travel.judged is not None:
        length = _duration_in_all(response.time, travel_in(one_way, deflection) > 0.0)
        notes.append(f"up to {1e3 * reached[one_way]:.3g} mm of {one_way} count nothing{f', {length}' if length else ''}")
    if missing:
        always = f"in {one_way} throughout, and " if len(ways) == 1 and travel.judged is None else ""
        notes.append(f"{always}no travel in {', '.join(missing)} is rated")
    for rating, rated in mount.travel.items() if followed is None else ():
        missed = abs(float(reached[rating]) - sampled_peak(response.time, travel_in(rating, deflection))[0])
        if missed > MISSED * rated:
            bound = True
            notes.append(f"{sampled_text(response.time)}, which miss up to {100.0 * missed / rated:.2g} % of {rating}")
            break
    return Verdict(
        criterion=COMBINED, subject=mount.name, value=value, limit=1.0 if not bound or value > 1.0 else None, unit="",
        time=when, note="; ".join(notes),
    )  # fmt: skip


def _sampled_combined_travel(time: Array, mount: SceneMount, deflection: Array) -> CombinedTravel:
    """Find the largest combined travel of the samples, refined between them."""
    total, judged = np.zeros(time.size), np.ones(time.size, dtype=bool)
    for rating, (_, way) in RATINGS.items():
        travel = travel_in(rating, deflection)
        if rating in mount.travel:
            total += (travel / mount.travel[rating]) ** 2
        elif way:
            judged &= travel == 0.0
    square, when = sampled_peak(time, total)
    of_judged = float(np.sqrt(total[judged].max())) if judged.any() else None
    return CombinedTravel(value=math.sqrt(square), time=when, judged=of_judged, judged_time=math.nan)


# Fraction of a rated travel by which samples may miss the peaks of every step: the utilisation is then known within 1 %.
MISSED = 0.005


def _duration_in_all(time: Array, rows: Booleans) -> str:
    """Write the duration of the samples that are True in `rows`, "12 ms in all"; "" if they are too few."""
    count = np.count_nonzero(rows)
    spacing = (time[-1] - time[0]) / max(time.size - 1, 1)  # a very short run has one sample
    return f"{duration_text(count * spacing)} in all" if count >= _LEAST_SAMPLES else ""


_LEAST_SAMPLES = 10  # Least samples of a duration, for an error of a tenth


_NAMED = 3  # mounts and axes that a sentence names


def untested(isolators: Mapping[str, Isolator], ends: Mapping[str, tuple[Array, Array]]) -> str:
    """List the mounts that move outside their isolators' tested ranges, and how far, as part of a sentence; "" without any.

    `ends` are the lowest and highest deflections along roll, shear and axial [m], (3,) each, by mount.
    """
    outside = [
        f"{name} {axis} {text}"
        for name, isolator in isolators.items()
        for axis, text in isolator.validity.outside(*ends[name], small=True).items()
    ]
    more = len(outside) - _NAMED
    return ", ".join(outside[:_NAMED]) + (f" and {more} more" if more > 0 else "")


def untested_line(isolators: Mapping[str, Isolator], response: Response) -> str:
    """Warn of the mounts whose deflections in a run are outside the tested range; "" without such mounts."""
    peaks = {name: mount.deflection for name, mount in response.peaks.mounts.items()}
    ends = {name: (peak.minimum, peak.maximum) for name, peak in peaks.items()}
    where = untested(isolators, ends)
    return where and (
        f"Outside the cycles that the isolator was identified from, and so extrapolated: {where}. The error of the fit says "
        "nothing of forces there."
    )


def falling_line(isolators: Mapping[str, Isolator], response: Response) -> str:
    """Warn of the mounts whose force fell as the deflection grew; "" without such mounts."""
    falling = []
    for name, mount in response.peaks.mounts.items():
        ends = zip(isolators[name].axes.items(), mount.deflection.minimum, mount.deflection.maximum, strict=True)
        for (axis, law), low, high in ends:
            if law is not None and (text := falling_text(law, min(float(low), 0.0), max(float(high), 0.0))):
                falling.append(f"{name} {axis}: {text}")
    more = len(falling) - _NAMED
    listed = "; ".join(falling[:_NAMED]) + (f"; and {more} more" if more > 0 else "")
    return listed and f"Mounts went where their force falls as the deflection grows, and pushes the load away: {listed}."
