"""Texts of a run alone: the scenario as it was given, and the peaks as tables."""

import math
import re
import tomllib
from typing import Any

import numpy as np

from wirerope_mj.assessment.criteria import headline, verdict_lines
from wirerope_mj.assessment.criteria.sentences import against_limit, rule_lines
from wirerope_mj.assessment.criteria.verdict import most_used
from wirerope_mj.content.selection import Selection
from wirerope_mj.content.verdicts import full_table
from wirerope_mj.engine.response import Response
from wirerope_mj.foundation.arrays import Array
from wirerope_mj.foundation.plain_text import markdown, plain_lines
from wirerope_mj.foundation.tables import Column, Mark, Row, Table
from wirerope_mj.foundation.units import in_unit
from wirerope_mj.views.recording.drawn_runs import DrawnRun
from wirerope_mj.views.recording.markdown_tables import markdown_table
from wirerope_mj.views.recording.paths import AXES, entity

VERDICT = "verdict"


def texts_of(run: DrawnRun, *, title: str, scenario_text: str) -> dict[str, str]:
    """Return verdict, scenario and tables of peaks of a run alone as Markdown, by their entities.

    `scenario_text` is Markdown, or TOML, which is set as such.
    """
    return {
        entity(VERDICT): verdict_markdown(run.selection),
        entity("scenario"): scenario_markdown(run.response, title, scenario_text),
        entity("peaks"): peaks_markdown(run.response, run.selection),
        entity("verdicts"): verdicts_markdown(run.selection),
    }


def verdict_markdown(selection: Selection) -> str:
    """Return the headline of the verdicts, and what uses most of its limits, in one line."""
    most = most_used(selection.verdicts)
    worst = "" if most is None else f"Nearest to its limit, or farthest beyond: {against_limit(most)}."
    return f"**{markdown(headline(selection.verdicts))}** {markdown(worst)}"


def scenario_markdown(response: Response, title: str, text: str) -> str:
    """Return title, scenario and the numerics."""
    body = _fenced(text) if _is_toml(text) else text.strip()
    numerics = response.numerics
    limit = f", limited by {numerics.limited_by}" if numerics.limited_by else ""
    how = f"{numerics.steps} steps of at most {in_unit(numerics.timestep, 'ms'):.4g} ms{limit}"
    how += f", computed by {numerics.computed_by}"
    if np.isfinite(numerics.error_estimate):
        how += f", {numerics.error_text}"
    return "\n\n".join(part for part in (f"### {markdown(title or response.scene.name)}", body, f"*{how}*") if part)


def verdicts_markdown(selection: Selection) -> str:
    """Return every verdict as a table, as the report has it."""
    table = full_table(selection.verdicts)
    return "" if table is None else markdown_table(table)


def peaks_markdown(response: Response, selection: Selection) -> str:
    """Return verdicts, peak accelerations, and peaks of the mounts against their rated travel."""
    lines = [
        headline(selection.verdicts),
        *verdict_lines(response, selection.verdicts),
        *rule_lines(selection.verdicts),
    ]
    parts = ["### Verdicts\n" + "\n".join(f"- {markdown(line)}" for line in lines)]
    parts.append(markdown_table(_acceleration_table(response)))
    if selection.mounts:
        parts.append(markdown_table(_mount_table(response, selection)))
    return "\n\n".join(parts)


def _acceleration_table(response: Response) -> Table:
    accelerations = [(name, peaks.acceleration) for name, peaks in response.peaks.bodies.items()]
    accelerations += [(f"point {name}", peaks.acceleration) for name, peaks in response.peaks.points.items()]
    accelerations.sort(key=lambda item: item[1].value, reverse=True)
    base, rows = response.scene.base, []
    for name, peak in sorted(accelerations, key=lambda item: item[0] != base):
        extremes = np.maximum(peak.maximum, -peak.minimum)
        rows.append(_acceleration_row(f"{name} (base)" if name == base else name, peak.value, peak.time, extremes))
    if base not in response.peaks.bodies:
        acceleration = response.base.acceleration
        norms = np.linalg.norm(acceleration, axis=1)
        at = int(norms.argmax())
        extremes = np.abs(acceleration).max(axis=0)
        rows.insert(0, _acceleration_row("base (samples)", float(norms[at]), float(response.time[at]), extremes))
    columns = [Column(align="left"), Column("peak [g]"), Column("at", "ms", ".1f")]
    columns += [Column(axis, "g", ".2f") for axis in "xyz"]
    return Table(title="Peak accelerations", columns=columns, rows=rows)


def _acceleration_row(name: str, size: float, time: float, extremes: Array) -> Row:
    return name, Mark(f"{in_unit(size, 'g'):.2f}", "strong"), time, *map(float, extremes)


def _mount_table(response: Response, selection: Selection) -> Table:
    largest = np.fmax.reduce(selection.utilisations, axis=1)  # NaN where nothing is rated
    worst = dict(zip(selection.mounts, largest.tolist(), strict=True))
    rows: list[Row] = []
    for name in sorted(worst, key=lambda name: (-np.nan_to_num(worst[name]), name)):
        peaks, ratio = response.peaks.mounts[name], worst[name]
        extremes = [_extreme(peak, axis) for peak in (peaks.deflection, peaks.force) for axis in (2, 1, 0)]
        used = "not rated" if math.isnan(ratio) else f"{in_unit(ratio, '%'):.0f} %"
        rows.append((name, *extremes, Mark(f"{used}, exceeded", "exceeded") if ratio > 1.0 else used))
    columns = [Column("mount", align="left"), *(Column(axis, "mm", ".1f") for axis in reversed(AXES))]
    columns += [*(Column(axis, "kN", ".2f") for axis in reversed(AXES)), Column("rated travel used")]
    return Table(title="Mounts", columns=columns, rows=rows)


def _extreme(peak: Any, axis: int) -> float:
    low, high = float(peak.minimum[axis]), float(peak.maximum[axis])
    return high if high >= -low else low


def _fenced(text: str) -> str:
    """Return TOML as a block of code, whose fence is longer than any row of backticks in it."""
    longest = max(map(len, re.findall("`+", text)), default=0)
    fence = "`" * max(longest + 1, 3)
    return f"{fence}toml\n{plain_lines(text.strip())}\n{fence}"


def _is_toml(text: str) -> bool:
    try:
        return bool(tomllib.loads(text))
    except tomllib.TOMLDecodeError:
        return False
