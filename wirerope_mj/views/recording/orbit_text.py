"""Texts about the motion of a branch in view, and about all levels of the response."""

from typing import Any

import numpy as np

from wirerope_mj.dynamics.frequency_response import FrequencyResponse
from wirerope_mj.dynamics.frequency_response.summary import LevelSummary
from wirerope_mj.dynamics.periodic import Bifurcation, Branch, PeriodicOrbit
from wirerope_mj.foundation.plain_text import markdown
from wirerope_mj.foundation.tables import Column, Row, Table
from wirerope_mj.foundation.units import in_unit
from wirerope_mj.views.markdown import markdown_table
from wirerope_mj.views.recording.along import at_points
from wirerope_mj.views.recording.animation import Animation, Strip
from wirerope_mj.views.recording.orbit_loops import shown_loops
from wirerope_mj.views.recording.paths import AXES, entity

MOTION, ABOUT = "motion", "about"

_MOST_MULTIPLIERS = 5


def log_texts(rec: Any, result: FrequencyResponse, findings: list[LevelSummary], animation: Animation) -> None:
    """Log a text for every motion of the animation, and one about all levels."""
    import rerun as rr

    texts = [motion_text(animation, index) for index in range(animation.strip.points.size)]
    kind = rr.MediaType.MARKDOWN
    columns = rr.TextDocument.columns(text=texts, media_type=[kind] * len(texts))
    rec.send_columns(entity(MOTION), at_points(animation, animation.strip), columns)
    rec.log(entity(ABOUT), rr.TextDocument(about_text(result, findings), media_type=kind), static=True)


def motion_text(animation: Animation, index: int) -> str:
    """Return Markdown about the motion at an index of the animation."""
    strip = animation.strip
    branch, orbit, point = strip.branch, strip.orbits[index], int(strip.points[index])
    parts = [f"### {orbit.frequency:.5g} Hz, {strip.level:.4g} m/s²: {'stable' if orbit.stable else 'UNSTABLE'}"]
    parts += [f"**{markdown(event.description)}**" for event in _near(strip, index)]
    amplitude, ratio = branch.amplitude[point], branch.transmissibility[point]
    parts.append(f"Amplitude **{amplitude:.4g} m/s²**, transmissibility **{ratio:.4g}**")
    values = orbit.floquet_multipliers[:_MOST_MULTIPLIERS]
    columns = [Column("Floquet multiplier"), Column("modulus", form=".4f")]
    rows = [(f"{value.real:+.4f} {value.imag:+.4f} i", float(abs(value))) for value in values]
    parts.append(markdown_table(Table(title="", columns=columns, rows=rows)))
    parts += [_loop_text(orbit, *loop) for loop in shown_loops(animation)[:1]]
    neutral = f", {orbit.neutral} neutral directions" if orbit.neutral else ""
    parts.append(f"*point {point + 1} of {branch.frequency.size}, residual {orbit.residual:.1e}{neutral}*")
    return "\n\n".join(parts)


def about_text(result: FrequencyResponse, findings: list[LevelSummary]) -> str:
    """Return Markdown about all levels: peaks, and what happens on their branches."""
    options = result.options
    start, stop = options.range
    rows: list[Row] = []
    for summary in findings:
        level, branch = f"{summary.level.acceleration:.4g} m/s²", summary.level.branch
        rows += [
            (
                level,
                "peak" if n else "highest",
                f"{peak.frequency:.5g} Hz",
                f"{peak.amplitude:.4g} m/s²",
                f"{peak.transmissibility:.4g}",
            )
            for n, peak in enumerate(summary.peaks)
        ]
        events = branch.bifurcations if branch is not None else ()
        rows += [(level, e.kind, f"{e.frequency:.5g} Hz", f"{e.amplitude:.4g} m/s²", "") for e in events]
    columns = [Column("level"), Column(align="left"), *map(Column, ("frequency", "amplitude", "transmissibility"))]
    lines = [
        f"### {markdown(result.name)}",
        f"Acceleration of {markdown(str(options.payload))}, {start:g} to {stop:g} Hz ({options.range_from}).",
        markdown_table(Table(title="", columns=columns, rows=rows)),
        "Timeline *point*: from motion to motion along the branches; *frequency_mHz*: the same by frequency, all levels at "
        "one frequency; *sim_time*: one repetition of each motion after the other.",
    ]
    ended = [f.level.branch.message for f in findings if f.level.branch is not None and not f.level.branch.complete]
    return "\n\n".join([*lines, *(f"**A branch ended early: {markdown(message)}.**" for message in ended)])


def _near(strip: Strip, index: int) -> list[Bifurcation]:
    """Return the bifurcations of the branch between this motion and the next one shown."""
    branch: Branch = strip.branch
    first = int(strip.points[index])
    after = int(strip.points[index + 1]) if index + 1 < strip.points.size else branch.frequency.size
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
