"""The response of a system to a base motion: time histories of bodies, points and mounts, and their peaks."""

from collections.abc import Iterable, Mapping
from dataclasses import asdict, dataclass, field
from pathlib import Path
from typing import Any

from wirerope_mj.engine.response.columns import ColumnPlan
from wirerope_mj.engine.response.export import exported_samples
from wirerope_mj.engine.response.histories import (
    BaseResponse,
    BodyResponse,
    ContactResponse,
    MountResponse,
    Numerics,
    PointResponse,
    SampledColumns,
)
from wirerope_mj.engine.response.peaks import Peaks
from wirerope_mj.engine.response.scene import Scene, scene_to_dict
from wirerope_mj.foundation.arrays import Array
from wirerope_mj.foundation.exports import Exportable, Exported
from wirerope_mj.foundation.parquet_files import write_rows
from wirerope_mj.foundation.state import State
from wirerope_mj.foundation.summary import Summarised, quantity

FILE = "response.parquet"
FORMAT = 1

_ROUNDING = 1e-9  # what the sum of a start and a duration may be off by [s]


@dataclass(frozen=True, kw_only=True, repr=False)
class Response(Exportable, Summarised):
    """Response of a system to a base motion.

    Attributes:
        time: sample instants [s], (n_t,).
        base: motion of the base.
        bodies: motion of every moving body by name.
        points: motion of every site `point/NAME` by NAME.
        mounts: every mount by name.
        contacts: every pair of geoms that the model declares, by name; what else touched has peaks alone.
        peaks: peaks over every step, not only over the samples.
        scene: what can be drawn.
        motion: the base motion as plain values, as `BaseMotion.to_dict` wrote it.
        events: instants [s] and texts that name what the motion does.
        numerics: how it was computed.
        initial_state, final_state: states from which a simulation may start again.
        path: the Parquet file that holds the samples, None if they are in memory.
    """

    time: Array
    base: BaseResponse
    bodies: Mapping[str, BodyResponse]
    points: Mapping[str, PointResponse]
    mounts: Mapping[str, MountResponse]
    contacts: Mapping[str, ContactResponse] = field(default_factory=dict)
    peaks: Peaks
    scene: Scene
    motion: dict[str, Any]
    events: tuple[tuple[float, str], ...]
    numerics: Numerics
    initial_state: State
    final_state: State
    samples: SampledColumns
    path: Path | None = None

    def _summary(self) -> tuple[str, dict[str, str]]:
        peaks, last = self.peaks, float(self.time[-1])
        heading = (
            f"Response: {last:.4g} s in {self.time.size} samples, {len(self.bodies)} bodies, {len(self.mounts)} mounts"
        )
        lines = {
            name: f"peak {quantity(body.acceleration.value, 'm/s^2')} at {body.acceleration.time:.4f} s"
            for name, body in peaks.bodies.items()
        }
        if peaks.mounts:
            farthest = max(peaks.mounts, key=lambda name: peaks.mounts[name].deflection.value)
            strongest = max(peaks.mounts, key=lambda name: peaks.mounts[name].force.value)
            lines[f"largest deflection, {farthest}"] = quantity(peaks.mounts[farthest].deflection.value, "m")
            lines[f"largest force, {strongest}"] = quantity(peaks.mounts[strongest].force.value, "N")
        if peaks.struck:
            lines["struck"] = ", ".join(peaks.struck)
        lines["step"] = f"{1e6 * self.timestep:.4g} us, {self.numerics.error_text.removeprefix('step ')}"
        return heading, lines

    @property
    def timestep(self) -> float:
        """Largest step of the simulation [s]."""
        return self.numerics.timestep

    @property
    def estimated_error(self) -> float:
        """Error of samples and peaks relative to the peaks, estimated before the run; NaN where the step was given."""
        return self.numerics.error_estimate

    def reaches(self, instant: float) -> bool:
        """Return whether an instant [s] lies in the run, which may end a part of an interval after its last sample."""
        return instant <= self.final_state.time + _ROUNDING

    def column(self, name: str) -> Array:
        """Return one sampled column such as "bodies/floor/acceleration/z", (n_t,).

        Nothing else of the samples is read or kept, so that of a long response in a file only this column is in memory.
        """
        index = self.samples.names.index(name)
        return self.samples.columns(index, index + 1)[:, 0]

    @property
    def exported(self) -> Exported:
        """The samples as a table for other programs."""
        return exported_samples(self.samples, {"motion": str(self.motion.get("kind", "")), "model": self.scene.name})

    @property
    def plan(self) -> ColumnPlan:
        """What the samples' columns mean."""
        return ColumnPlan(
            bodies=list(self.bodies),
            points=list(self.points),
            mounts=[(name, mount.state_names) for name, mount in self.mounts.items()],
            contacts=list(self.contacts),
        )

    def save(self, folder: str | Path) -> None:
        """Write `response.parquet` into `folder` (made if missing), atomically; one that is there is replaced."""
        names = self.samples.names
        parts = ("peaks", "scene", "motion", "events", "numerics", "initial_state", "final_state")
        content = response_metadata(plan=self.plan, **{part: getattr(self, part) for part in parts})
        write_rows(Path(folder) / FILE, names, self.samples.columns(0, len(names)), content)


def response_of(
    plan: ColumnPlan,
    samples: SampledColumns,
    *,
    peaks: Peaks,
    scene: Scene,
    motion: dict[str, Any],
    events: Iterable[tuple[float, str]],
    numerics: Numerics,
    initial_state: State,
    final_state: State,
    path: Path | None = None,
) -> Response:
    """Return the response whose samples stand in the columns of `plan`."""
    return Response(
        time=samples.columns(0, 1)[:, 0],
        **plan.parts(samples),
        peaks=peaks,
        scene=scene,
        motion=motion,
        events=tuple((float(time), str(text)) for time, text in events),
        numerics=numerics,
        initial_state=initial_state,
        final_state=final_state,
        samples=samples,
        path=path,
    )


def response_metadata(
    *,
    plan: ColumnPlan,
    peaks: Peaks,
    scene: Scene,
    motion: dict[str, Any],
    events: Iterable[tuple[float, str]],
    numerics: Numerics,
    initial_state: State,
    final_state: State,
) -> dict[str, Any]:
    """Return everything but the samples as plain values; floats survive bit by bit."""
    return {
        "format": FORMAT,
        "peaks": peaks.to_dict(),
        "scene": scene_to_dict(scene),
        "motion": motion,
        "events": [list(event) for event in events],
        "numerics": asdict(numerics),
        "states": [initial_state.to_plain(), final_state.to_plain()],
        "bodies": list(plan.bodies),
        "points": list(plan.points),
        "mounts": [[name, list(states)] for name, states in plan.mounts],
        "contacts": list(plan.contacts),
    }
