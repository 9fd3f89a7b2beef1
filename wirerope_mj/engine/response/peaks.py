"""Peaks of a response: largest norm, extremes of the components and their instants; and what touched."""

from dataclasses import asdict, dataclass, replace
from typing import ClassVar

import numpy as np

from wirerope_mj.foundation.arrays import Array, ArrayLike, Entries
from wirerope_mj.foundation.summary import Brief, ByName

# Depth up to which a mount's stop counts as open [m]: where nothing moves, rounding presses a stop without gap 1e-17 m deep.
FAINT = 1e-9


@dataclass(frozen=True, kw_only=True)
class ContactPeak:
    """First touch, largest force and deepest penetration of a pair of geoms, or of a stop of a mount, over every step.

    A stop of a mount touches while it presses: its penetration is how far the deflection is beyond the gap.
    """

    # names of the two geoms; a stop and its pad as the model's `pair` has them; of a mount's stop ""
    geoms: tuple[str, str]
    bodies: tuple[str, str]  # names of the bodies that they belong to
    mount: str = ""  # name of the mount whose law the stop is; "" for geoms
    touches: int = 0  # how often they came together; a touch that begins and ends between two steps is not seen
    # whether they touch at the start already, as what rests on its stops does; counted among the touches
    from_start: bool = False
    first_touch: float | None = None  # instant of the first touch [s]; None if they never touch
    duration: float = 0.0  # how long they touch, all touches together [s]
    force: float = 0.0  # largest normal force [N], all contact points of the pair together
    force_time: float | None = None  # its instant [s]; None without a force
    penetration: float = 0.0  # deepest penetration [m]
    penetration_time: float | None = None  # its instant [s]; None without one
    # what it took up from the motion, friction included [J]: dissipated once it is open again; None if they never touch,
    # and in older responses
    energy: float | None = None
    # of a mount's stop: its axis, the gaps on both sides [m], None on a side without one, the deflection from which they count
    # [m], and the largest speed at which it was pressed, that of the touch among them [m/s], and its instant [s]; "" and None
    # in older responses
    axis: str = ""
    gap_below: float | None = None
    gap_above: float | None = None
    rest: float | None = None
    closing_speed: float | None = None
    closing_time: float | None = None

    @property
    def struck(self) -> bool:
        """True if the two came into contact during the run; contact from the start does not count."""
        return self.touches > int(self.from_start)

    @property
    def gaps(self) -> dict[str, float]:
        """Gaps of a mount's stop measured from the deflection `rest` [m], by side: "below" and "above"."""
        sides = {"below": self.gap_below, "above": self.gap_above}
        return {side: gap for side, gap in sides.items() if gap is not None}

    def called(self, name: str) -> str:
        """Name the contact in sentences: a stop of a mount as "stop s3", a pair of geoms by its name."""
        return f"stop {name}" if self.mount and not name.startswith("stop") else name

    def later(self, by: float) -> "ContactPeak":
        """Return the contact with all instants `by` seconds later."""
        instants = ("first_touch", "force_time", "penetration_time", "closing_time")
        times = {name: getattr(self, name) for name in instants}
        return replace(self, **{name: time + by for name, time in times.items() if time is not None})

    def to_dict(self) -> Entries:
        return asdict(self) | {"geoms": list(self.geoms), "bodies": list(self.bodies)}  # as a file has them


def _part(numbers: slice, text: str) -> property:
    """Make a property of a peak that returns some of its numbers; `text` is its docstring."""
    return property(lambda peak: peak.numbers[numbers], doc=text)


@dataclass(frozen=True, init=False, repr=False)
class Peak:
    """Largest norm of a vector quantity, and the extremes of its components."""

    SIZE: ClassVar[int] = 17
    VECTOR, MINIMUM, MINIMUM_TIME, MAXIMUM, MAXIMUM_TIME = (slice(first, first + 3) for first in range(2, 17, 3))

    #: value, time, vector, minimum, minimum_time, maximum and maximum_time behind each other, (17,): a run has a peak for
    #: every channel, and few of them are looked at
    numbers: Array

    def __init__(
        self, *, value: float, time: float, vector: Array, minimum: Array, minimum_time: Array, maximum: Array,
        maximum_time: Array,
    ) -> None:  # fmt: skip
        numbers = np.hstack([value, time, vector, minimum, minimum_time, maximum, maximum_time]).astype(np.float64)
        object.__setattr__(self, "numbers", numbers)

    @classmethod
    def of(cls, numbers: Array) -> "Peak":
        """Make a peak of its `SIZE` numbers, (17,), which are not copied."""
        peak = object.__new__(cls)
        object.__setattr__(peak, "numbers", numbers)
        return peak

    @property
    def value(self) -> float:
        """Largest norm of the vector."""
        return self.numbers.item(0)

    @property
    def time(self) -> float:
        """Instant of the largest norm [s]."""
        return self.numbers.item(1)

    vector = _part(VECTOR, "The vector at that instant, (3,).")
    minimum = _part(MINIMUM, "Smallest values of the components, (3,).")
    minimum_time = _part(MINIMUM_TIME, "Their instants [s], (3,).")
    maximum = _part(MAXIMUM, "Largest values of the components, (3,).")
    maximum_time = _part(MAXIMUM_TIME, "Their instants [s], (3,).")

    def __repr__(self) -> str:
        parts = ("value", "time", "vector", "minimum", "minimum_time", "maximum", "maximum_time")
        return f"Peak({', '.join(f'{part}={getattr(self, part)!r}' for part in parts)})"

    def later(self, by: float) -> "Peak":
        """Return the peak with its instant `by` seconds later."""
        numbers = self.numbers.copy()
        for times in (1, self.MINIMUM_TIME, self.MAXIMUM_TIME):
            numbers[times] += by
        return Peak.of(numbers)

    def to_list(self) -> list[float]:
        """Return the peak as `SIZE` numbers."""
        return self.numbers.tolist()

    @classmethod
    def from_list(cls, numbers: ArrayLike) -> "Peak":
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
    """

    value: float  # largest utilisation
    time: float  # its instant [s]
    judged: float | None  # largest utilisation of the instants that are judged; None where there is none
    judged_time: float  # its instant [s]

    def later(self, by: float) -> "CombinedTravel":
        """Return the same travel with its instants `by` seconds later."""
        return replace(self, time=self.time + by, judged_time=self.judged_time + by)


KINDS = {"bodies": BodyPeaks, "points": PointPeaks, "mounts": MountPeaks}


@dataclass(frozen=True, kw_only=True, repr=False)
class Peaks(Brief):
    """Peaks by name of body, point, mount, contact pair and stop."""

    bodies: dict[str, BodyPeaks]  # by name
    points: dict[str, PointPeaks]
    mounts: dict[str, MountPeaks]
    # by name of the pair, "stop_1 on pad_1", or of the mount that has a stop, "s3"; None where they were not recorded, as
    # in older responses
    contacts: dict[str, ContactPeak] | None = None
    # travel along all axes at once by mount; None where it was not followed, as in older responses
    travels: dict[str, CombinedTravel] | None = None

    def __post_init__(self) -> None:
        for name in ("bodies", "points", "mounts", *(["contacts"] if self.contacts is not None else [])):
            object.__setattr__(self, name, ByName(getattr(self, name)))

    @property
    def struck(self) -> list[str]:
        """Names of the pairs and stops that came into contact during the run, in the order of their first contact."""
        touches = {name: contact.first_touch or 0.0 for name, contact in (self.contacts or {}).items() if contact.struck}
        return sorted(touches, key=lambda name: touches[name])

    def same_as(self, other: "Peaks") -> bool:
        """Return whether all peaks are bit-identical; contacts and travels count only if both have them."""
        content, other_content = self.to_dict(), other.to_dict()
        for part in ("contacts", "travels"):
            if content[part] is None or other_content[part] is None:
                content[part] = other_content[part] = None
        return content == other_content

    def to_dict(self) -> Entries:
        """Return the peaks as plain values."""
        contacts, travels = self.contacts, self.travels
        return {
            group: {
                name: {key: peak.to_list() for key, peak in vars(entry).items()} for name, entry in getattr(self, group).items()
            }
            for group in KINDS
        } | {
            "contacts": None if contacts is None else {name: pair.to_dict() for name, pair in contacts.items()},
            "travels": None if travels is None else {name: asdict(travel) for name, travel in travels.items()},
        }
