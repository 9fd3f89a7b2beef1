"""What a motion of a branch is, in words and numbers, and what the whole response shows."""

from typing import Any

import numpy as np

from wirerope_mj.dynamics.frequency_response import FrequencyResponse
from wirerope_mj.dynamics.frequency_response.summary import LevelSummary
from wirerope_mj.dynamics.periodic import Bifurcation, Branch, PeriodicOrbit
from wirerope_mj.foundation.plain_text import markdown
from wirerope_mj.foundation.units import in_unit
from wirerope_mj.views.recording.along import at_points
from wirerope_mj.views.recording.animation import Film, Strip
from wirerope_mj.views.recording.orbit_loops import shown_loops
from wirerope_mj.views.recording.paths import AXES, entity

MOTION, ABOUT = "motion", "about"

_MOST_MULTIPLIERS = 5


def log_texts(
    rec: Any,
    result: FrequencyResponse,
    findings: list[LevelSummary],
    film: Film,
) -> None:
    """Log a text for every motion of the film, and one about all levels."""
    import rerun as rr

    texts = [motion_text(film, place) for place in range(film.strip.points.size)]
    kind = rr.MediaType.MARKDOWN
    columns = rr.TextDocument.columns(text=texts, media_type=[kind] * len(texts))
    rec.send_columns(entity(MOTION), at_points(film, film.strip), columns)
    rec.log(entity(ABOUT), rr.TextDocument(about_text(result, findings), media_type=kind), static=True)


def motion_text(film: Film, place: int) -> str:
    """Return Markdown about the motion at a place of the film."""
    strip = film.strip
    branch, orbit, point = strip.branch, strip.orbits[place], int(strip.points[place])
    parts = [f"### {orbit.frequency:.5g} Hz, {strip.level:.4g} m/s²: {'stable' if orbit.stable else 'UNSTABLE'}"]
    parts += [f"**{markdown(event.description)}**" for event in _near(strip, place)]
    amplitude, ratio = branch.amplitude[point], branch.transmissibility[point]
    parts.append(f"Amplitude **{amplitude:.4g} m/s²**, transmissibility **{ratio:.4g}**")
    values = orbit.floquet_multipliers[:_MOST_MULTIPLIERS]
    rows = ["| Floquet multiplier | modulus |", "|--:|--:|"]
    rows += [f"| {value.real:+.4f} {value.imag:+.4f} i | {abs(value):.4f} |" for value in values]
    parts.append("\n".join(rows))
    parts += [_loop_text(orbit, *loop) for loop in shown_loops(film)[:1]]
    neutral = f", {orbit.neutral} neutral directions" if orbit.neutral else ""
    parts.append(f"*point {point + 1} of {branch.frequency.size}, residual {orbit.residual:.1e}{neutral}*")
    return "\n\n".join(parts)


def about_text(result: FrequencyResponse, findings: list[LevelSummary]) -> str:
    """Return Markdown about all levels: peaks, and what happens on their branches."""
    asked = result.options
    start, stop = asked.range
    rows = ["| level | | frequency | amplitude | transmissibility |", "|--:|:--|--:|--:|--:|"]
    for found in findings:
        level = f"{found.level.acceleration:.4g} m/s²"
        rows += [
            f"| {level} | {'highest' if n == 0 else 'peak'} | {peak.frequency:.5g} Hz | {peak.amplitude:.4g} m/s² | "
            f"{peak.transmissibility:.4g} |"
            for n, peak in enumerate(found.peaks)
        ]
        events = found.level.branch.bifurcations if found.level.branch is not None else ()
        rows += [f"| {level} | {e.kind} | {e.frequency:.5g} Hz | {e.amplitude:.4g} m/s² | |" for e in events]
    lines = [
        f"### {markdown(result.name)}",
        f"Acceleration of {markdown(str(asked.payload))}, {start:g} to {stop:g} Hz ({asked.range_from}).",
        "\n".join(rows),
        "Timeline *point*: from motion to motion along the branches; *frequency_mHz*: the same by frequency, all levels at "
        "one frequency; *sim_time*: one repetition of each motion after the other.",
    ]
    ended = [f.level.branch.message for f in findings if f.level.branch is not None and not f.level.branch.complete]
    return "\n\n".join([*lines, *(f"**A branch ended early: {markdown(message)}.**" for message in ended)])


def _near(strip: Strip, place: int) -> list[Bifurcation]:
    """Return what happens on the branch between this motion and the next one shown."""
    branch: Branch = strip.branch
    first = int(strip.points[place])
    after = int(strip.points[place + 1]) if place + 1 < strip.points.size else branch.frequency.size
    return [event for event in branch.bifurcations if first <= event.index < max(after, first + 1)]


def _loop_text(orbit: PeriodicOrbit, name: str, axis: int) -> str:
    """Return range of deflection and force of a mount, and the work of its loop."""
    mount = orbit.response.mounts[name]
    x, force = mount.deflection[:, axis], mount.force[:, axis]
    work = float(np.sum(0.5 * (force[1:] + force[:-1]) * np.diff(x)))
    x, force = in_unit(x, "mm"), in_unit(force, "kN")
    return (
        f"Mount {markdown(name)}, {AXES[axis]}: {x.min():.4g} to {x.max():.4g} mm, {force.min():.4g} to {force.max():.4g} kN, "
        f"{work:.3g} J per repetition"
    )
