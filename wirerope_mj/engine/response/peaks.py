"""Peaks of a response: largest norm, extremes of the components, and their instants."""

from dataclasses import asdict, dataclass, replace
from typing import Any, ClassVar

import numpy as np

from wirerope_mj.engine.response.contacts import ContactPeak
from wirerope_mj.foundation.arrays import Array
from wirerope_mj.foundation.summary import Brief, ByName


@dataclass(frozen=True, init=False, repr=False)
class Peak:
    """Largest norm of a vector quantity, and the extremes of its components.

    Attributes:
        numbers: value, time, vector, minimum, minimum_time, maximum and maximum_time behind each other, (17,): a run has a peak
            for every channel, and few of them are looked at.
    """

    SIZE: ClassVar[int] = 17
    VECTOR, MINIMUM, MINIMUM_TIME, MAXIMUM, MAXIMUM_TIME = (slice(first, first + 3) for first in range(2, 17, 3))

    numbers: Array

    def __init__(
        self,
        *,
        value: float,
        time: float,
        vector: Array,
        minimum: Array,
        minimum_time: Array,
        maximum: Array,
        maximum_time: Array,
    ) -> None:
        numbers = np.hstack([value, time, vector, minimum, minimum_time, maximum, maximum_time]).astype(np.float64)
        object.__setattr__(self, "numbers", numbers)

    @classmethod
    def of(cls, numbers: Array) -> "Peak":
        """Return the peak of `SIZE` numbers, (17,), which it keeps."""
        peak = object.__new__(cls)
        object.__setattr__(peak, "numbers", numbers)
        return peak

    @property
    def value(self) -> float:
        """Largest norm."""
        return self.numbers.item(0)

    @property
    def time(self) -> float:
        """Its instant [s]."""
        return self.numbers.item(1)

    @property
    def vector(self) -> Array:
        """The vector at that instant, (3,)."""
        return self.numbers[self.VECTOR]

    @property
    def minimum(self) -> Array:
        """Smallest values of the components, (3,)."""
        return self.numbers[self.MINIMUM]

    @property
    def minimum_time(self) -> Array:
        """Their instants [s], (3,)."""
        return self.numbers[self.MINIMUM_TIME]

    @property
    def maximum(self) -> Array:
        """Largest values of the components, (3,)."""
        return self.numbers[self.MAXIMUM]

    @property
    def maximum_time(self) -> Array:
        """Their instants [s], (3,)."""
        return self.numbers[self.MAXIMUM_TIME]

    def __repr__(self) -> str:
        parts = ("value", "time", "vector", "minimum", "minimum_time", "maximum", "maximum_time")
        return f"Peak({', '.join(f'{part}={getattr(self, part)!r}' for part in parts)})"

    def later(self, by: float) -> "Peak":
        """Return the peak on a timeline `by` seconds later."""
        numbers = self.numbers.copy()
        for times in (1, self.MINIMUM_TIME, self.MAXIMUM_TIME):
            numbers[times] += by
        return Peak.of(numbers)

    def to_list(self) -> list[float]:
        """Return the peak as `SIZE` numbers."""
        return self.numbers.tolist()

    @classmethod
    def from_list(cls, numbers: Any) -> "Peak":
        """Return the peak that `to_list` wrote."""
        return cls.of(np.array(numbers, dtype=np.float64))


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


@dataclass(frozen=True, kw_only=True)
class CombinedTravel:
    """The farthest travel of a mount along all its axes at once, over every step.

    The utilisation is the root of the sum of (deflection / rated travel)^2 of one instant; what is not rated counts nothing.
    While the mount moves along its axis in the way that is not rated, the instant is not judged.

    Attributes:
        value: largest utilisation.
        time: its instant [s].
        judged: largest utilisation of the instants that are judged; None where there is none.
        judged_time: its instant [s].
    """

    value: float
    time: float
    judged: float | None
    judged_time: float

    def later(self, by: float) -> "CombinedTravel":
        """Return the same on a timeline `by` seconds later."""
        return replace(self, time=self.time + by, judged_time=self.judged_time + by)


KINDS = {"bodies": BodyPeaks, "points": PointPeaks, "mounts": MountPeaks}


@dataclass(frozen=True, kw_only=True, repr=False)
class Peaks(Brief):
    """Peaks by name of body, point, mount, and of what may touch.

    Attributes:
        bodies, points, mounts: by name.
        contacts: by name of the pair, "stop_1 on pad_1", or of the mount that has a stop, "s3"; None where they were not
            recorded, as in older responses.
        travels: travel along all axes at once by mount; None where it was not followed, as in older responses.
    """

    bodies: dict[str, BodyPeaks]
    points: dict[str, PointPeaks]
    mounts: dict[str, MountPeaks]
    contacts: dict[str, ContactPeak] | None = None
    travels: dict[str, CombinedTravel] | None = None

    def __post_init__(self) -> None:
        for name in ("bodies", "points", "mounts", *(["contacts"] if self.contacts is not None else [])):
            object.__setattr__(self, name, ByName(getattr(self, name)))

    @property
    def struck(self) -> list[str]:
        """Names of the pairs and stops of `contacts` that came together during the run, the first to touch first."""
        touches = {
            name: contact.first_touch or 0.0 for name, contact in (self.contacts or {}).items() if contact.struck
        }
        return sorted(touches, key=lambda name: touches[name])

    def same_as(self, other: "Peaks") -> bool:
        """Return whether all peaks have the same bits; contacts and travels are left out if only one of the two has them."""
        one, two = self.to_dict(), other.to_dict()
        for part in ("contacts", "travels"):
            if one[part] is None or two[part] is None:
                one[part] = two[part] = None
        return one == two

    def to_dict(self) -> dict[str, Any]:
        """Return the peaks as plain values."""
        contacts, travels = self.contacts, self.travels
        return {
            group: {
                name: {key: peak.to_list() for key, peak in vars(entry).items()}
                for name, entry in getattr(self, group).items()
            }
            for group in KINDS
        } | {
            "contacts": None if contacts is None else {name: pair.to_dict() for name, pair in contacts.items()},
            "travels": None if travels is None else {name: asdict(travel) for name, travel in travels.items()},
        }

    @classmethod
    def from_dict(cls, content: dict[str, Any]) -> "Peaks":
        """Return the peaks that `to_dict` wrote."""
        contacts, travels = content.get("contacts"), content.get("travels")  # older responses have none
        return cls(
            **{
                group: {
                    name: kind(**{key: Peak.from_list(numbers) for key, numbers in entry.items()})
                    for name, entry in content[group].items()
                }
                for group, kind in KINDS.items()
            },
            contacts=None if contacts is None else {n: ContactPeak.from_dict(pair) for n, pair in contacts.items()},
            travels=None if travels is None else {name: CombinedTravel(**travel) for name, travel in travels.items()},
        )
