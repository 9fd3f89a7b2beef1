"""What the page is told of a run and the one before it, as plain values in the units that are displayed."""

import math
from typing import Any

import numpy as np

from wirerope_mj.assessment.criteria import EXCEEDED, STRUCK, WITHIN, MountPeak, Verdict, body_peaks, mount_peaks
from wirerope_mj.content.numbers import ABSENT, fixed, with_unit
from wirerope_mj.foundation.summary import json_values
from wirerope_mj.foundation.units import STANDARD_GRAVITY, in_unit
from wirerope_mj.views.explore.curves import acceleration_curve, deflection_curve
from wirerope_mj.views.explore.shown import ShownRun

_MOUNTS, _PARTS = 8, 6
"""Rows of the tables: those that a reader compares; the report of a run has them all."""


def answer(now: ShownRun, before: ShownRun | None) -> dict[str, Any]:
    """Return verdict, peaks, worst mounts and curves of a run beside those of the one before it, as JSON takes them."""
    worst, part = _worst_mount(now), _largest(now)
    curves = [deflection_curve(worst, now, before)] if worst is not None else []
    curves += [acceleration_curve(part, now, before)] if part else []
    return {
        "now": _told(now),
        "before": None if before is None else _told(before),
        "mounts": _mounts(now, before),
        "parts": _parts(now, before),
        "curves": json_values(curves),
    }


def _told(run: ShownRun) -> dict[str, Any]:
    numerics = run.response.numerics
    error = numerics.error_estimate
    known = f"estimated error {error:.0e} of the peaks" if math.isfinite(error) else "no error estimated"
    origin = "" if run.exact else ", after that of the first run"
    return {
        "name": run.name,
        "number": run.number,
        "values": dict(run.values),
        "changes": dict(run.changes),
        "motion": run.motion,
        "headline": run.headline,
        "tone": run.tone.replace(" ", "-"),
        "lines": _exceeded(run) + run.lines,
        "warnings": list(run.warnings),
        "exact": run.exact,
        "seconds": run.seconds,
        "step": f"Step {1e3 * numerics.timestep:.3g} ms{origin}; {known}.",
        "figures": _figures(run),
    }


def _exceeded(run: ShownRun) -> list[str]:
    """Return by which criteria how many limits are exceeded, and which one most."""
    kinds: dict[str, list[Verdict]] = {}
    for row in run.verdicts:
        if row.verdict == EXCEEDED:
            kinds.setdefault(row.criterion, []).append(row)
    lines = []
    for criterion, rows in kinds.items():
        worst = max(rows, key=lambda row: row.utilisation or 0.0)
        used = f"{fixed(100.0 * (worst.utilisation or 0.0), 0)} % at {worst.subject}"
        lines.append(f"Exceeded, {criterion}: {used}" + (f", and {len(rows) - 1} more." if len(rows) > 1 else "."))
    return lines


def _figures(run: ShownRun) -> list[dict[str, str]]:
    """Return the few figures by which two runs are compared."""
    over, within = (sum(row.verdict == verdict for row in run.verdicts) for verdict in (EXCEEDED, WITHIN))
    rows = [("Limits exceeded", f"{over} of {over + within}" if over + within else ABSENT, "")]
    if stops := [row for row in run.verdicts if row.contact]:
        rows.append(("Stops, contacts struck", f"{sum(row.contact == STRUCK for row in stops)} of {len(stops)}", ""))
    if part := _largest(run):
        peak = next(row for row in body_peaks(run.response) if row.name == part)
        rows.append(("Largest acceleration", f"{fixed(peak.value, 2)} g", part))
    if (worst := _worst_mount(run)) is not None:
        if worst.utilisation is not None:
            rows.append(
                ("Most used travel", f"{fixed(100.0 * worst.utilisation, 0)} %", f"{worst.name}, {worst.governing}")
            )
        else:
            rows.append(("Largest deflection", with_unit(_farthest(worst), "m"), f"{worst.name}, not rated"))
        strongest = max(mount_peaks(run.response), key=lambda row: max(map(abs, row.force)))
        rows.append(("Largest force of a mount", with_unit(max(map(abs, strongest.force)), "N"), strongest.name))
    return [{"label": label, "value": value, "where": where} for label, value, where in rows]


def _mounts(now: ShownRun, before: ShownRun | None) -> list[dict[str, Any]]:
    """Return what the worst mounts use of their rated travel, before too."""
    earlier = {} if before is None else {row.name: row for row in mount_peaks(before.response)}
    rows = []
    for row in mount_peaks(now.response)[:_MOUNTS]:
        verdict = row.travel[row.governing] if row.governing else None
        rows.append(
            {
                "name": row.name,
                "isolator": row.isolator,
                "governing": row.governing or "not rated",
                "deflection": fixed(in_unit(_farthest(row) if verdict is None else verdict.value, "mm"), 1),
                "rated": ABSENT if verdict is None or verdict.limit is None else fixed(in_unit(verdict.limit, "mm"), 1),
                "used": _percent(row.utilisation),
                "before": _percent(earlier[row.name].utilisation if row.name in earlier else None),
                "exceeded": bool(row.exceeded),
            }
        )
    return rows


def _parts(now: ShownRun, before: ShownRun | None) -> list[dict[str, Any]]:
    """Return the largest accelerations of the base, bodies and points, before too, with their limits."""
    earlier = {} if before is None else {row.name: row.value for row in body_peaks(before.response)}
    judged = {row.subject: row for row in now.verdicts if row.criterion == "acceleration" and row.limit is not None}
    rows = []
    for row in body_peaks(now.response)[: _PARTS + 1]:
        verdict: Verdict | None = judged.get(row.name)
        limit = None if verdict is None or verdict.limit is None else verdict.limit / STANDARD_GRAVITY
        rows.append(
            {
                "name": row.name,
                "kind": row.kind,
                "peak": fixed(row.value, 2),
                "before": fixed(earlier[row.name], 2) if row.name in earlier else ABSENT,
                "limit": ABSENT if limit is None else fixed(limit, 2),
                "exceeded": verdict is not None and verdict.verdict == EXCEEDED,
            }
        )
    return rows


def _largest(run: ShownRun) -> str:
    """Return the body or point with the largest acceleration besides the base, "" if nothing else moves."""
    return next((row.name for row in body_peaks(run.response) if row.kind != "base"), "")


def _worst_mount(run: ShownRun) -> MountPeak | None:
    """Return the mount that uses most of its rated travel; where nothing is rated, the one that deflects farthest."""
    rows = mount_peaks(run.response)
    if not rows:
        return None
    return rows[0] if rows[0].utilisation is not None else max(rows, key=_farthest)


def _farthest(row: MountPeak) -> float:
    """Return the largest deflection of a mount along any axis [m]."""
    return float(np.abs([row.minimum, row.maximum]).max())


def _percent(utilisation: float | None) -> str:
    return ABSENT if utilisation is None else f"{fixed(100.0 * utilisation, 0)} %"
