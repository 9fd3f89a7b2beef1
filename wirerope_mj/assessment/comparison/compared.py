"""One run among several, and what is compared: base, bodies and points by their accelerations, mounts by their deflections."""

from dataclasses import dataclass
from typing import Literal

from wirerope_mj.assessment.criteria import Verdict
from wirerope_mj.engine.response import Peak, Response
from wirerope_mj.foundation.arrays import Array


@dataclass(frozen=True, kw_only=True)
class ComparedRun:
    """One of the runs.

    Attributes:
        name: of the run in every output.
        response: its response, on the timeline that all runs share.
        moved: by how much it was moved to that timeline [s].
        verdicts: on it.
    """

    name: str
    response: Response
    moved: float
    verdicts: tuple[Verdict, ...]


@dataclass(frozen=True, kw_only=True, order=True)
class Component:
    """Something whose acceleration is compared: the base, which every run may call as it likes, a body or a point."""

    kind: Literal["base", "body", "point"]
    name: str

    @property
    def label(self) -> str:
        """Name in plots and tables."""
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


BASE = Component(kind="base", name="base")
Subject = Component | str  # A component, or a mount by its name


def subjects_of(response: Response) -> list[Subject]:
    """Return the base, if there is one, the other bodies, the points, and the mounts that are no stops."""
    base = response.scene.base
    return [
        *([BASE] if base in response.peaks.bodies else []),
        *(Component(kind="body", name=name) for name in response.peaks.bodies if name != base),
        *(Component(kind="point", name=name) for name in response.peaks.points),
        *(mount.name for mount in response.scene.isolating),
    ]
