"""Peaks of a response: largest norm, extremes of the components, and their instants."""

from dataclasses import dataclass
from typing import Any, ClassVar

import numpy as np

from wirerope_mj.engine.response.contacts import ContactPeak
from wirerope_mj.foundation.arrays import Array


@dataclass(frozen=True, kw_only=True)
class Peak:
    """Largest norm of a vector quantity, and the extremes of its components.

    Attributes:
        value: largest norm.
        time: its instant [s].
        vector: the vector at that instant, (3,).
        minimum, maximum: extremes of the components, (3,).
        minimum_time, maximum_time: their instants [s], (3,).
    """

    SIZE: ClassVar[int] = 17

    value: float
    time: float
    vector: Array
    minimum: Array
    minimum_time: Array
    maximum: Array
    maximum_time: Array

    def to_list(self) -> list[float]:
        """Return the peak as `SIZE` numbers."""
        return np.hstack(list(vars(self).values())).tolist()

    @classmethod
    def from_list(cls, numbers: Any) -> "Peak":
        """Return the peak that `to_list` wrote."""
        n = np.array(numbers, dtype=np.float64)
        return cls(
            value=float(n[0]), time=float(n[1]), vector=n[2:5],
            minimum=n[5:8], minimum_time=n[8:11], maximum=n[11:14], maximum_time=n[14:17],
        )  # fmt: skip


@dataclass(frozen=True, kw_only=True)
class BodyPeaks:
    """Peaks of a body: acceleration [m/s^2] of its centre of mass."""

    acceleration: Peak


@dataclass(frozen=True, kw_only=True)
class PointPeaks:
    """Peaks of a point: acceleration [m/s^2] and displacement relative to the base [m]."""

    acceleration: Peak
    relative_displacement: Peak


@dataclass(frozen=True, kw_only=True)
class MountPeaks:
    """Peaks of a mount in its axes roll, shear, axial: deflection [m] and force [N]."""

    deflection: Peak
    force: Peak


KINDS = {"bodies": BodyPeaks, "points": PointPeaks, "mounts": MountPeaks}


@dataclass(frozen=True, kw_only=True)
class Peaks:
    """Peaks by name of body, point, mount, and of what may touch.

    Attributes:
        bodies, points, mounts: by name.
        contacts: by name of the pair, "stop_1 on pad_1", or of the mount that has a stop, "s3"; None where they were not
            recorded, as in older responses.
    """

    bodies: dict[str, BodyPeaks]
    points: dict[str, PointPeaks]
    mounts: dict[str, MountPeaks]
    contacts: dict[str, ContactPeak] | None = None

    @property
    def struck(self) -> list[str]:
        """Names of the pairs and stops of `contacts` that came together during the run, the first to touch first."""
        touches = {
            name: contact.first_touch or 0.0 for name, contact in (self.contacts or {}).items() if contact.struck
        }
        return sorted(touches, key=lambda name: touches[name])

    def same_as(self, other: "Peaks") -> bool:
        """Return whether all peaks have the same bits; contacts are left out if only one of the two recorded them."""
        one, two = self.to_dict(), other.to_dict()
        if self.contacts is None or other.contacts is None:
            one["contacts"] = two["contacts"] = None
        return one == two

    def to_dict(self) -> dict[str, Any]:
        """Return the peaks as plain values."""
        contacts = self.contacts
        return {
            group: {
                name: {key: peak.to_list() for key, peak in vars(entry).items()}
                for name, entry in getattr(self, group).items()
            }
            for group in KINDS
        } | {"contacts": None if contacts is None else {name: pair.to_dict() for name, pair in contacts.items()}}

    @classmethod
    def from_dict(cls, content: dict[str, Any]) -> "Peaks":
        """Return the peaks that `to_dict` wrote."""
        contacts = content.get("contacts")  # older responses have none
        return cls(
            **{
                group: {
                    name: kind(**{key: Peak.from_list(numbers) for key, numbers in entry.items()})
                    for name, entry in content[group].items()
                }
                for group, kind in KINDS.items()
            },
            contacts=None if contacts is None else {n: ContactPeak.from_dict(pair) for n, pair in contacts.items()},
        )
