"""The response of a system to a base motion, histories and peaks, and its Parquet file: float64 samples, metadata beside."""

from collections.abc import Iterable, Iterator, Mapping
from dataclasses import asdict, dataclass, field
from functools import lru_cache
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np

from wirerope_mj.engine.response.checked import read_metadata
from wirerope_mj.engine.response.histories import (
    BaseResponse,
    BodyResponse,
    ColumnPlan,
    ContactResponse,
    MountResponse,
    Numerics,
    PointResponse,
    SampledColumns,
    block_rows,
    exported_samples,
)
from wirerope_mj.engine.response.peaks import Peaks
from wirerope_mj.engine.response.scene import Scene, scene_to_dict
from wirerope_mj.foundation.arrays import Array, Entries
from wirerope_mj.foundation.directions import rotation_matrices
from wirerope_mj.foundation.errors import RecordError
from wirerope_mj.foundation.exports import Exportable, Exported
from wirerope_mj.foundation.parquet_files import read_content, write_rows
from wirerope_mj.foundation.state import State
from wirerope_mj.foundation.structure import Place
from wirerope_mj.foundation.summary import Summarised, quantity

if TYPE_CHECKING:
    import pyarrow.parquet as pq

FILE = "response.parquet"
FORMAT = 1
_ROUNDING = 1e-9  # what the sum of a start and a duration may be off by [s]
PARTS = ("peaks", "scene", "motion", "events", "numerics", "initial_state", "final_state")  # all but the samples
_AGAIN = "The file was damaged or edited: take it from another copy of the folder, or simulate the run again."


@dataclass(frozen=True, kw_only=True, repr=False)
class Response(Exportable, Summarised):
    """Response of a system to a base motion."""

    time: Array  #: sample instants [s], (n_t,)
    base: BaseResponse  #: motion of the base
    bodies: Mapping[str, BodyResponse]  #: motion of every moving body by name
    points: Mapping[str, PointResponse]  #: motion of every site `point/NAME` by NAME
    mounts: Mapping[str, MountResponse]  #: every mount by name
    #: every pair of geoms that the model declares, by name; what else touched has peaks alone
    contacts: Mapping[str, ContactResponse] = field(default_factory=dict)
    peaks: Peaks  #: peaks over every step, not only over the samples
    scene: Scene  #: what can be drawn
    motion: Entries  #: the base motion as plain values, as `BaseMotion.to_dict` wrote it
    events: tuple[tuple[float, str], ...]  #: instants [s] and texts that name what the motion does
    numerics: Numerics  #: how it was computed
    #: initial_state, final_state: states from which a simulation may start again
    initial_state: State
    final_state: State
    samples: SampledColumns
    path: Path | None = None  #: the Parquet file that holds the samples, None if they are in memory

    def _summary(self) -> tuple[str, dict[str, str]]:
        peaks, last = self.peaks, float(self.time[-1])
        heading = f"Response: {last:.4g} s in {self.time.size} samples, {len(self.bodies)} bodies, {len(self.mounts)} mounts"
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
        """Return whether an instant [s] lies within the run, whose end may be later than its last sample."""
        return instant <= self.final_state.time + _ROUNDING

    def column(self, name: str) -> Array:
        """Return one sampled column such as "bodies/floor/acceleration/z", (n_t,).

        Nothing else of the samples is read or kept, so that of a long response in a file only this column is in memory.
        """
        index = self.samples.names.index(name)
        return self.samples.columns(index, index + 1)[:, 0]

    @property
    def base_rotation(self) -> Array | None:
        """Rotation of the base from its modelled orientation, (n_t, 3, 3); None where it does not rotate."""
        base = next((body for body in self.scene.bodies if body.name == self.scene.base), None)
        if base is None or base.name not in self.bodies:
            return None
        orientation = self._of_base("orientation/w", 4)
        if (orientation == orientation[0]).all():
            return None
        return np.asarray(rotation_matrices(orientation) @ rotation_matrices(base.orientation).T)

    def _of_base(self, first: str, size: int) -> Array:
        """Read columns of the base's body without caching them, (n_t, size)."""
        index = self.samples.names.index(f"bodies/{self.scene.base}/{first}")
        return self.samples.columns(index, index + size)

    def displacement_from_base(self, position: Array, modelled: Array) -> Array:
        """Return the displacement of a point at `position`, (n_t, 3), from as modelled, (3,), in base axes [m], (n_t, 3)."""
        if (turn := self.base_rotation) is None:
            return position - modelled - self.base.displacement
        centre = next(body.position for body in self.scene.bodies if body.name == self.scene.base)
        apart = position - self._of_base("position/x", 3)
        return np.asarray(np.einsum("tji,tj->ti", turn, apart) - (modelled - centre))

    def velocity_from_base(self, position: Array, velocity: Array, swing: Array | float = 0.0) -> Array:
        """Return the velocity of a point at `position` relative to the base, in base axes [m/s], (n_t, 3).

        The point's own is that of its body's centre, `velocity`, plus that by the body's rotation, `swing`, (n_t, 3) each.
        """
        if (turn := self.base_rotation) is None:
            return velocity - self.base.velocity + swing
        arm, moved = position - self._of_base("position/x", 3), self._of_base("velocity/x", 6)
        along = np.cross(moved[:, 3:], arm)
        return np.asarray(np.einsum("tji,tj->ti", turn, velocity + swing - moved[:, :3] - along))

    @property
    def exported(self) -> Exported:
        """The samples as a table for other programs."""
        return exported_samples(self.samples, {"motion": str(self.motion.get("kind", "")), "model": self.scene.name})

    @property
    def plan(self) -> ColumnPlan:
        """Layout of the columns of the samples."""
        mounts = [(name, mount.state_names) for name, mount in self.mounts.items()]
        return ColumnPlan(bodies=list(self.bodies), points=list(self.points), mounts=mounts, contacts=list(self.contacts))

    def save(self, folder: str | Path) -> None:
        """Write `response.parquet` into `folder` (made if missing), atomically; one that is there is replaced."""
        names = self.samples.names
        content = response_metadata(self.plan, {part: getattr(self, part) for part in PARTS})
        write_rows(Path(folder) / FILE, names, self.samples.columns(0, len(names)), content)


def response_of(
    plan: ColumnPlan, samples: SampledColumns, *, events: Iterable[tuple[float, str]], path: Path | None = None, **parts: Any
) -> Response:
    """Build a response from samples in the columns of `plan`, and from its other `PARTS`."""
    return Response(
        time=samples.columns(0, 1)[:, 0], **plan.parts(samples), samples=samples, path=path, **parts,
        events=tuple((float(time), str(text)) for time, text in events),
    )  # fmt: skip


def response_metadata(plan: ColumnPlan, parts: Entries) -> Entries:
    """Return the `PARTS` of a response and its plan as plain values; floats are kept bit by bit."""
    return {
        "format": FORMAT, "peaks": parts["peaks"].to_dict(), "scene": scene_to_dict(parts["scene"]),
        "motion": parts["motion"], "events": [list(event) for event in parts["events"]],
        "numerics": asdict(parts["numerics"]),
        "states": [parts[state].to_plain() for state in ("initial_state", "final_state")], "bodies": list(plan.bodies),
        "points": list(plan.points), "mounts": [[name, list(states)] for name, states in plan.mounts],
        "contacts": list(plan.contacts),
    }  # fmt: skip


@lru_cache(maxsize=8)
def _footer(path: Path, state: tuple[int, ...]) -> "pq.FileMetaData":
    """Read the footer of a Parquet file, which locates its columns, once: that is slow with thousands of columns.

    `state` differs for another file of the same path, which is then read anew.
    """
    import pyarrow.parquet as pq

    return pq.read_metadata(path)


@dataclass(frozen=True)
class FileSamples:
    """Samples in a Parquet file, read column by column at first use."""

    names: list[str]
    path: Path

    def columns(self, first: int, last: int) -> Array:
        """Return columns `first` to `last` (exclusive), (n_t, last - first)."""
        with self._open() as file:
            values, row = np.empty((file.metadata.num_rows, last - first)), 0
            for block in self._blocks(file, first, last):  # read at once, the columns would stand in memory twice
                values[row : row + len(block)] = block
                row += len(block)
        return values

    def blocks(self, first: int, last: int) -> Iterator[Array]:
        with self._open() as file:
            yield from self._blocks(file, first, last)

    def _open(self) -> "pq.ParquetFile":
        import pyarrow.parquet as pq

        try:
            state = self.path.stat()
            footer = _footer(self.path, (state.st_ino, state.st_size, state.st_mtime_ns))
            return pq.ParquetFile(self.path, metadata=footer, page_checksum_verification=True)
        except (OSError, ValueError):
            raise RecordError(f"{self.path}: this file was removed or damaged since it was opened. {_AGAIN}") from None

    def _blocks(self, file: "pq.ParquetFile", first: int, last: int) -> Iterator[Array]:
        """Yield the columns' rows in blocks; RecordError where they are damaged or not finite."""
        if first == last:  # a mount without internal states
            return
        rows, names, row = block_rows(last - first), self.names[first:last], 0
        batches = (  # of one row group after the other: pyarrow keeps what it has read of those that it is given at once
            batch
            for group in range(file.num_row_groups)
            for batch in file.iter_batches(rows, row_groups=[group], columns=names)
        )
        while True:
            try:
                if (batch := next(batches, None)) is None:
                    return
                block = np.column_stack([column.to_numpy(zero_copy_only=False) for column in batch.columns])
            except (OSError, ValueError):  # pyarrow's text names a byte of a page, which helps no user
                raise RecordError(
                    f"{self.path}: the samples are damaged in column {self.names[first]!r} or one of those behind it. {_AGAIN}"
                ) from None
            if not np.isfinite(block).all():
                wrong, column = np.argwhere(~np.isfinite(block))[0]
                name = self.names[first + int(column)]
                raise RecordError(f"{self.path}: column {name!r} is not finite at sample {row + int(wrong)}. {_AGAIN}")
            row += len(block)
            yield block


def load_response(folder: str | Path) -> Response:
    """Read the response that was saved in `folder`; samples are read at first use.

    Args:
        folder: that holds `response.parquet`; or such a file itself, whatever its name.

    Raises:
        RecordError: the folder holds no response, or the file is damaged: names the column or the key of its metadata.
            A damaged page of samples is noticed when it is read.
    """
    path = Path(folder)
    path = path if path.is_file() else path / FILE
    if not path.is_file():
        if not path.parent.is_dir():
            raise RecordError(f"{folder}: there is no such folder.")
        inside = sorted(str(file.parent.relative_to(folder)) for file in path.parent.glob(f"cases/*/{FILE}"))
        runs = f"; the runs of this job are {', '.join(inside[:5])}" if inside else ""
        raise RecordError(f"{folder}: there is no {FILE} here; a run folder holds one{runs}.")
    import pyarrow as pa

    schema, content = read_content(path, kind="a response of wirerope_mj", remedy=_AGAIN, version=FORMAT)
    names = schema.names
    stored = read_metadata(content, names, Place(str(path), error=RecordError, remedy=_AGAIN))
    strange = [field.name for field in schema if field.type != pa.float64()]
    if strange:
        raise RecordError(f"{path}: column {strange[0]!r} must hold float64 numbers. {_AGAIN}")
    initial, final = (State.from_plain(list(state)) for state in stored.states)
    response = response_of(
        stored.plan, FileSamples(names, path), peaks=stored.peaks, motion=stored.motion, scene=stored.scene,
        events=stored.events, numerics=stored.numerics, initial_state=initial, final_state=final, path=path,
    )  # fmt: skip
    if not response.time.size or (np.diff(response.time) <= 0.0).any():
        raise RecordError(f"{path}: column 'time' must hold instants that grow from sample to sample. {_AGAIN}")
    return response
