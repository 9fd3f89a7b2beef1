"""Peaks of bodies, and of mounts with what they use of their rated travel."""

from dataclasses import dataclass, replace

from wirerope_mj.assessment.criteria.ended import too_short
from wirerope_mj.assessment.criteria.travel import peak_travel_verdicts
from wirerope_mj.assessment.criteria.verdict import EXCEEDED, WITHIN, Verdict
from wirerope_mj.engine.response import Response
from wirerope_mj.mounts.isolator.travel import SIDES

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
    """Peaks of a mount and the verdicts on its travel."""

    name: str
    isolator: str  # name of the device
    # minimum, maximum: extreme deflections along roll, shear, axial [m]
    minimum: tuple[float, ...]
    maximum: tuple[float, ...]
    force: Vector  # extreme force along roll, shear, axial, with its sign [N]
    travel: dict[str, Verdict]  # verdicts by rating: "compression", "tension", "shear", "roll"

    @property
    def utilisation(self) -> float | None:
        """Largest utilisation of a rated travel; None = not judged."""
        return max((row.utilisation for row in self.travel.values() if row.utilisation is not None), default=None)

    @property
    def governing(self) -> str:
        """Rating of the largest utilisation, "" where nothing is judged."""
        if self.utilisation is None:
            return ""
        return max(self.travel, key=lambda rating: self.travel[rating].utilisation or 0.0)

    @property
    def exceeded(self) -> list[str]:
        """Ratings that are exceeded."""
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
            )
        )  # fmt: skip
    return sorted(rows, key=lambda row: -1.0 if row.utilisation is None else row.utilisation, reverse=True)
