"""One run among several, and the parts whose accelerations are compared."""

from dataclasses import dataclass
from typing import Literal

from wirerope_mj.engine.response import Peak, Response
from wirerope_mj.foundation.arrays import Array
from wirerope_mj.views.recording.frame import Color
from wirerope_mj.views.recording.poses import Frame
from wirerope_mj.views.recording.selection import Selection


@dataclass(frozen=True, kw_only=True)
class Run:
    """One of the runs.

    Attributes:
        name: what it is called everywhere.
        response: its response, on the timeline that all runs share.
        moved: by how much it was moved to that timeline [s].
        color: of its lines, mounts and ghosts.
        selection: what of it a recording of its own would show, mounts in the run's colour.
        frames: of its bodies.
    """

    name: str
    response: Response
    moved: float
    color: Color
    selection: Selection
    frames: dict[str, Frame]


@dataclass(frozen=True, kw_only=True, order=True)
class Part:
    """Something whose acceleration is compared: the base, which every run may call as it likes, a body or a point."""

    kind: Literal["base", "body", "point"]
    name: str

    @property
    def label(self) -> str:
        """What it is called in plots and tables."""
        return f"point {self.name}" if self.kind == "point" else self.name

    def acceleration(self, response: Response) -> Array:
        """Return its acceleration [m/s^2], (n_t, 3)."""
        if self.kind == "base":
            return response.base.acceleration
        return (response.points if self.kind == "point" else response.bodies)[self.name].acceleration

    def peak(self, response: Response) -> Peak:
        """Return the peak of its acceleration."""
        peaks = response.peaks
        if self.kind == "point":
            return peaks.points[self.name].acceleration
        return peaks.bodies[response.scene.base if self.kind == "base" else self.name].acceleration


BASE = Part(kind="base", name="base")


def parts_of(response: Response) -> list[Part]:
    """Return the base, if there is one, the other bodies and the points."""
    base = response.scene.base
    parts = [BASE] if base in response.peaks.bodies else []
    parts += [Part(kind="body", name=name) for name in response.peaks.bodies if name != base]
    return parts + [Part(kind="point", name=name) for name in response.peaks.points]


def has(response: Response, thing: Part | str) -> bool:
    """Return whether a response has a part, or a mount of that name."""
    if isinstance(thing, str):
        return any(mount.name == thing for mount in response.scene.isolating)
    return thing in parts_of(response)
