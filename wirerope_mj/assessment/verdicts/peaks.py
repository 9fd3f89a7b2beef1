"""Peaks of bodies, and of mounts beside what their isolators are rated for."""

from dataclasses import dataclass

from wirerope_mj.engine.response import Response
from wirerope_mj.foundation.units import STANDARD_GRAVITY
from wirerope_mj.mounts.isolator.travel import RATINGS, travel_reached, travel_shares


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
        minimum, maximum: extreme deflections along roll, shear, axial [m].
        force: extreme force along roll, shear, axial, with its sign [N].
        shares: peak over rated travel by "compression", "tension", "shear", "roll"; None = not judged.
    """

    name: str
    isolator: str
    minimum: tuple[float, float, float]
    maximum: tuple[float, float, float]
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
    for mount in response.scene.isolating:
        peaks = response.peaks.mounts[mount.name]
        low, high = peaks.deflection.minimum, peaks.deflection.maximum
        force = [_extreme(float(a), float(b)) for a, b in zip(peaks.force.minimum, peaks.force.maximum, strict=True)]
        shares = travel_shares(travel_reached(low, high), mount.travel)
        found.append(
            MountPeak(
                name=mount.name,
                isolator=mount.isolator,
                minimum=(float(low[0]), float(low[1]), float(low[2])),
                maximum=(float(high[0]), float(high[1]), float(high[2])),
                force=(force[0], force[1], force[2]),
                shares={name: shares.get(name) for name in RATINGS},
            )
        )
    return sorted(found, key=lambda row: -1.0 if row.share is None else row.share, reverse=True)


def _extreme(low: float, high: float) -> float:
    return high if high >= -low else low
