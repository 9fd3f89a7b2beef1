"""Peaks, limits and verdicts of a run as plain values."""

from collections.abc import Sequence
from typing import Any

from wirerope_mj.assessment.criteria.criterion import CONTACT, STOP
from wirerope_mj.assessment.criteria.judge import headline
from wirerope_mj.assessment.criteria.peaks import MountPeak, body_peaks, mount_peaks
from wirerope_mj.assessment.criteria.sentences import verdict_lines
from wirerope_mj.assessment.criteria.verdict import NOT_JUDGED, WITHIN, Verdict
from wirerope_mj.engine.response import Response
from wirerope_mj.mounts.isolator import AXES


def summary(response: Response, verdicts: Sequence[Verdict]) -> dict[str, Any]:
    """Return headline, peaks, limits and `verdicts` as plain values: accelerations [g], deflections [m], forces [N]."""
    travel = {mount.name: mount.travel for mount in response.scene.mounts}
    return {
        "headline": headline(verdicts),
        "verdicts": verdict_lines(response, verdicts),
        "judged": [verdict.to_dict() for verdict in verdicts],
        "accelerations": [
            {"name": row.name, "kind": row.kind, "peak_g": row.value, "time_s": row.time, "axes_g": list(row.axes)}
            for row in body_peaks(response)
        ],
        "mounts": [
            {
                "name": row.name,
                "isolator": row.isolator,
                "verdict": _travel_verdict(row),
                "share_of_travel": {rating: verdict.utilisation for rating, verdict in row.travel.items()},
                "rated_travel_m": travel[row.name],
                "lowest_deflection_m": dict(zip(AXES, row.minimum, strict=True)),
                "highest_deflection_m": dict(zip(AXES, row.maximum, strict=True)),
                "extreme_force_N": dict(zip(AXES, row.force, strict=True)),
            }
            for row in mount_peaks(response)
        ],
        "contacts": _contacts(response, verdicts),
    }


def _travel_verdict(row: MountPeak) -> str:
    """Return "within", "exceeds compression, ..." or "not judged"."""
    if row.exceeded:
        return f"exceeds {', '.join(row.exceeded)}"
    return NOT_JUDGED if row.utilisation is None else WITHIN


def _contacts(response: Response, verdicts: Sequence[Verdict]) -> list[dict[str, Any]] | None:
    """Return every pair of geoms that may touch and every stop; None where contacts were not recorded."""
    if response.peaks.contacts is None:
        return None
    judged = {row.subject: row.verdict for row in verdicts if row.criterion in (CONTACT, STOP)}
    return [
        {
            "name": name,
            "geoms": list(contact.geoms),
            "bodies": list(contact.bodies),
            "mount": contact.mount,
            "verdict": judged.get(name, NOT_JUDGED),
            "from_start": contact.from_start,
            "touches": contact.touches,
            "first_touch_s": contact.first_touch,
            "duration_s": contact.duration,
            "peak_force_N": contact.force,
            "peak_force_time_s": contact.force_time,
            "penetration_m": contact.penetration,
            "penetration_time_s": contact.penetration_time,
        }
        | ({} if contact.energy is None else {"energy_J": contact.energy})
        for name, contact in response.peaks.contacts.items()
    ]
