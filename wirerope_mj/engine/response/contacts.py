"""Contacts of a response: what two geoms that may touch, or a stop among the mounts' laws, did over every step."""

from dataclasses import asdict, dataclass, replace
from typing import Any


@dataclass(frozen=True, kw_only=True)
class ContactPeak:
    """First touch, largest force and deepest penetration of a pair of geoms, or of a stop of a mount, over every step.

    A stop of a mount touches while it presses: its penetration is how far the deflection is beyond the gap.

    Attributes:
        geoms: names of the two geoms; a stop and its pad as the model's `pair` has them; of a mount's stop "".
        bodies: names of the bodies that they belong to.
        mount: name of the mount whose law the stop is; "" for geoms.
        touches: how often they came together; a touch that begins and ends between two steps is not seen.
        from_start: whether they touch at the start already, as what rests on its stops does; counted among the touches.
        first_touch: instant of the first touch [s]; None if they never touch.
        duration: how long they touch, all touches together [s].
        force: largest normal force [N], all contact points of the pair together.
        force_time: its instant [s]; None without a force.
        penetration: deepest penetration [m].
        penetration_time: its instant [s]; None without one.
        energy: what it took up from the motion, friction included [J]: dissipated once it is open again; None if they
            never touch, and in older responses.
    """

    geoms: tuple[str, str]
    bodies: tuple[str, str]
    mount: str = ""
    touches: int = 0
    from_start: bool = False
    first_touch: float | None = None
    duration: float = 0.0
    force: float = 0.0
    force_time: float | None = None
    penetration: float = 0.0
    penetration_time: float | None = None
    energy: float | None = None

    @property
    def struck(self) -> bool:
        """True if they came together during the run; resting on each other from the start is no strike."""
        return self.touches > int(self.from_start)

    def called(self, name: str) -> str:
        """Return what a text calls the contact of this name: a stop of a mount "stop s3", a pair of geoms by its name."""
        return f"stop {name}" if self.mount and not name.startswith("stop") else name

    def later(self, by: float) -> "ContactPeak":
        """Return the contact on a timeline `by` seconds later."""
        times = {name: getattr(self, name) for name in ("first_touch", "force_time", "penetration_time")}
        return replace(self, **{name: time + by for name, time in times.items() if time is not None})

    def to_dict(self) -> dict[str, Any]:
        """Return the contact as plain values."""
        return asdict(self) | {"geoms": list(self.geoms), "bodies": list(self.bodies)}  # as a file has them

    @classmethod
    def from_dict(cls, content: dict[str, Any]) -> "ContactPeak":
        """Return the contact that `to_dict` wrote."""
        pairs = {name: (str(content[name][0]), str(content[name][1])) for name in ("geoms", "bodies")}
        return cls(**(content | pairs))
