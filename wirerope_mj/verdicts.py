"""Peaks of a response against what its payload can bear and its isolators are rated for, in words and as plain values."""

from dataclasses import dataclass
from typing import Any

from wirerope_mj.criteria import (
    EXCEEDED,
    NOT_JUDGED,
    Verdict,
    acceleration_verdicts,
    judge,
    rattle_verdicts,
    travel_verdicts,
)
from wirerope_mj.criteria.travel import COMBINED
from wirerope_mj.response import Response
from wirerope_mj.units import STANDARD_GRAVITY

RATINGS = ("compression", "tension", "shear", "roll")
"""Rated travels of an isolator, in the order of the tables."""

AXES = ("roll", "shear", "axial")


@dataclass(frozen=True, kw_only=True)
class BodyPeak:
    """Largest acceleration of a body or a point [g]: its size, instant [s] and the largest along x, y and z."""

    name: str
    kind: str
    value: float
    time: float
    axes: tuple[float, float, float]


@dataclass(frozen=True, kw_only=True)
class MountPeak:
    """Peaks of a mount against its rated travel.

    Attributes:
        name: of the mount.
        isolator: name of the device.
        lowest, highest: extreme deflections along roll, shear, axial [m].
        force: extreme force along roll, shear, axial, with its sign [N].
        shares: peak over rated travel by "compression", "tension", "shear", "roll"; None = not judged.
    """

    name: str
    isolator: str
    lowest: tuple[float, float, float]
    highest: tuple[float, float, float]
    force: tuple[float, float, float]
    shares: dict[str, float | None]

    @property
    def share(self) -> float | None:
        """Largest share of a rated travel; None = not judged."""
        return max((share for share in self.shares.values() if share is not None), default=None)

    @property
    def verdict(self) -> str:
        """Return "within", "exceeds compression, ..." or "not judged"."""
        if self.share is None:
            return "not judged"
        over = [name for name, share in self.shares.items() if share is not None and share > 1.0]
        return f"exceeds {', '.join(over)}" if over else "within"


def body_peaks(response: Response) -> list[BodyPeak]:
    """Return the peaks of base, bodies and points; the base first, then the largest."""
    rows = [("base" if name == response.scene.base else "body", name, p) for name, p in response.peaks.bodies.items()]
    rows += [("point", name, peaks) for name, peaks in response.peaks.points.items()]  # type: ignore[misc]
    found = []
    for kind, name, peaks in rows:
        peak = peaks.acceleration
        axes = [float(max(high, -low)) / STANDARD_GRAVITY for low, high in zip(peak.minimum, peak.maximum, strict=True)]
        found.append(
            BodyPeak(
                name=name,
                kind=kind,
                value=peak.value / STANDARD_GRAVITY,
                time=peak.time,
                axes=(axes[0], axes[1], axes[2]),
            )
        )
    return sorted(found, key=lambda row: (row.kind != "base", -row.value))


def mount_peaks(response: Response) -> list[MountPeak]:
    """Return the peaks of the mounts; the largest share of a rated travel first, those not judged last."""
    found = []
    for mount in response.scene.mounts:
        peaks = response.peaks.mounts[mount.name]
        low, high = peaks.deflection.minimum, peaks.deflection.maximum
        reached = {
            "compression": max(-float(low[2]), 0.0),
            "tension": max(float(high[2]), 0.0),
            "shear": float(max(high[1], -low[1])),
            "roll": float(max(high[0], -low[0])),
        }
        force = [_extreme(float(a), float(b)) for a, b in zip(peaks.force.minimum, peaks.force.maximum, strict=True)]
        shares = {name: reached[name] / mount.travel[name] if name in mount.travel else None for name in RATINGS}
        found.append(
            MountPeak(
                name=mount.name,
                isolator=mount.isolator,
                lowest=(float(low[0]), float(low[1]), float(low[2])),
                highest=(float(high[0]), float(high[1]), float(high[2])),
                force=(force[0], force[1], force[2]),
                shares=shares,
            )
        )
    return sorted(found, key=lambda row: -1.0 if row.share is None else row.share, reverse=True)


def verdict_lines(response: Response) -> list[str]:
    """Return the verdicts in a few sentences: payload and worst mount against their limits, and what is not judged."""
    return _payload_lines(response) + _travel_lines(response)


def payload_verdicts(response: Response) -> tuple[Verdict, ...]:
    """Return the verdicts on accelerations and rattle space."""
    return (*acceleration_verdicts(response), *rattle_verdicts(response))


def _payload_lines(response: Response) -> list[str]:
    found = payload_verdicts(response)
    judged = sorted((row for row in found if row.share is not None), key=lambda row: row.share or 0.0, reverse=True)
    over = [row for row in judged if row.verdict == EXCEEDED]
    lines = [f"Exceeded: {_words(row)}." for row in over]
    if judged and not over:
        lines.append(f"Payload within its limits; nearest is {_words(judged[0])}.")
    unjudged = [
        word
        for word in ("acceleration", "rattle space")
        if not any(row.criterion.startswith(word) and row.verdict != NOT_JUDGED for row in found)
    ]
    if unjudged and found:
        lines.append(f"Not judged, because the model states no limit: {' and '.join(unjudged)} of the payload.")
    return lines


def _words(row: Verdict) -> str:
    factor, unit = (1.0 / STANDARD_GRAVITY, "g") if row.unit == "m/s^2" else (1e3, "mm")
    reached = f"{factor * row.value:.3g} of {factor * (row.limit or 0.0):.3g} {unit}"
    return f"{row.criterion} of {row.subject}, {reached} ({100.0 * (row.share or 0.0):.0f} %)"


def _travel_lines(response: Response) -> list[str]:
    """Return what the worst mount uses of its rated travel, which mounts exceed it, and which are not judged."""
    mounts = mount_peaks(response)
    judged = [row for row in mounts if row.share is not None]
    lines = []
    if judged:
        worst = judged[0]
        axis = max(RATINGS, key=lambda name: worst.shares[name] or 0.0)
        lines.append(f"{worst.name} uses most of its rated travel: {100 * (worst.share or 0.0):.0f} % in {axis}.")
        over = {rating: [row.name for row in judged if (row.shares[rating] or 0.0) > 1.0] for rating in RATINGS}
        words = [f"in {rating} by {', '.join(names)}" for rating, names in over.items() if names]
        lines.append(f"Rated travel exceeded {'; '.join(words)}." if words else "No mount exceeds a rated travel.")
        lines += _combined_line(response)
    untensioned = bool(judged) and all(row.shares["tension"] is None for row in judged)
    unjudged = ["tension of every mount"] if untensioned else []
    unjudged += [row.name for row in mounts if row.share is None]
    if unjudged:
        lines.append(f"Not judged, because no travel is rated: {', '.join(unjudged)}.")
    return lines


def _combined_line(response: Response) -> list[str]:
    """Return which mounts come to more than their ratings with all axes taken together."""
    rows = [row for row in travel_verdicts(response) if row.criterion == COMBINED and row.verdict == EXCEEDED]
    if not rows:
        return []
    worst = max(rows, key=lambda row: row.value)
    names = ", ".join(row.subject for row in rows)
    return [
        f"All axes together leave the ellipsoid through the rated travels at {names}; farthest at {worst.subject}: "
        f"{100.0 * worst.value:.0f} %."
    ]


def summary(response: Response) -> dict[str, Any]:
    """Return peaks, limits and verdicts as plain values: accelerations [g], deflections [m], forces [N]."""
    travel = {mount.name: mount.travel for mount in response.scene.mounts}
    return {
        "verdicts": verdict_lines(response),
        "judged": [verdict.to_dict() for verdict in judge(response)],
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
                "lowest_deflection_m": dict(zip(AXES, row.lowest, strict=True)),
                "highest_deflection_m": dict(zip(AXES, row.highest, strict=True)),
                "extreme_force_N": dict(zip(AXES, row.force, strict=True)),
            }
            for row in mount_peaks(response)
        ],
    }


def _extreme(low: float, high: float) -> float:
    return high if high >= -low else low
