"""Peaks, limits and verdicts as plain values."""

from collections.abc import Sequence
from typing import Any

from wirerope_mj.assessment.criteria import Verdict, contact_verdicts
from wirerope_mj.assessment.verdicts.headline import headline
from wirerope_mj.assessment.verdicts.peaks import body_peaks, mount_peaks
from wirerope_mj.assessment.verdicts.sentences import verdict_lines
from wirerope_mj.engine.response import Response
from wirerope_mj.mounts.isolator import AXES


def summary(response: Response, verdicts: Sequence[Verdict]) -> dict[str, Any]:
    """Return headline, peaks, limits and `verdicts` as plain values: accelerations [g], deflections [m], forces [N]."""
    travel = {mount.name: mount.travel for mount in response.scene.mounts}
    return {
        "headline": headline(verdicts),
        "verdicts": verdict_lines(response),
        "judged": [verdict.to_dict() for verdict in verdicts],
        "accelerations": [
            {"name": row.name, "kind": row.kind, "peak_g": row.value, "time_s": row.time, "axes_g": list(row.axes)}
            for row in body_peaks(response)
        ],
        "mounts": [
            {
                "name": row.name,
                "isolator": row.isolator,
                "verdict": row.verdict,
                "share_of_travel": row.shares,
                "rated_travel_m": travel[row.name],
                "lowest_deflection_m": dict(zip(AXES, row.minimum, strict=True)),
                "highest_deflection_m": dict(zip(AXES, row.maximum, strict=True)),
                "extreme_force_N": dict(zip(AXES, row.force, strict=True)),
            }
            for row in mount_peaks(response)
        ],
        "contacts": _contacts(response),
    }


def _contacts(response: Response) -> list[dict[str, Any]] | None:
    """Return what is known of every pair of geoms that may touch and every stop; None where contacts were not recorded."""
    if response.peaks.contacts is None:
        return None
    return [
        {
            "name": name,
            "geoms": list(contact.geoms),
            "bodies": list(contact.bodies),
            "mount": contact.mount,
            "verdict": verdict.verdict,
            "from_start": contact.from_start,
            "touches": contact.touches,
            "first_touch_s": contact.first_touch,
            "duration_s": contact.duration,
            "peak_force_N": contact.force,
            "peak_force_time_s": contact.force_time,
            "penetration_m": contact.penetration,
            "penetration_time_s": contact.penetration_time,
        }
        for (name, contact), verdict in zip(response.peaks.contacts.items(), contact_verdicts(response), strict=True)
    ]
