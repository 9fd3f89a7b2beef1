"""A response as one Parquet file: float64 samples, and everything else in the file's own metadata."""

import base64
import json
import os
from collections.abc import Callable, Iterable, Iterator
from contextlib import suppress
from dataclasses import asdict, dataclass
from pathlib import Path
from typing import Any

import numpy as np

from wirerope_mj.engine.response.checked import check_content
from wirerope_mj.engine.response.columns import ColumnPlan
from wirerope_mj.engine.response.peaks import Peaks
from wirerope_mj.engine.response.response import BLOCK_ROWS, Numerics, Response
from wirerope_mj.engine.response.scene import Scene, scene_from_dict, scene_to_dict
from wirerope_mj.foundation.arrays import Array
from wirerope_mj.foundation.errors import RecordError
from wirerope_mj.foundation.state import State

FILE = "response.parquet"
_KEY = b"wirerope_mj"
FORMAT = 1
_AGAIN = "The file was damaged or edited: take it from another copy of the folder, or simulate the run again."


@dataclass(frozen=True)
class FileSamples:
    """Samples in a Parquet file, read column by column when they are asked for."""

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
        """Yield these columns some rows after the other."""
        with self._open() as file:
            yield from self._blocks(file, first, last)

    def _open(self) -> Any:
        import pyarrow.parquet as pq

        try:
            return pq.ParquetFile(self.path, page_checksum_verification=True)
        except (OSError, ValueError):
            raise RecordError(f"{self.path}: this file was removed or damaged since it was opened. {_AGAIN}") from None

    def _blocks(self, file: Any, first: int, last: int) -> Iterator[Array]:
        if first == last:  # a mount without internal states
            return
        batches, row = file.iter_batches(BLOCK_ROWS, columns=self.names[first:last]), 0
        while (block := self._block(batches, first)) is not None:
            if not np.isfinite(block).all():
                wrong, column = np.argwhere(~np.isfinite(block))[0]
                name = self.names[first + int(column)]
                raise RecordError(f"{self.path}: column {name!r} is not finite at sample {row + int(wrong)}. {_AGAIN}")
            row += len(block)
            yield block

    def _block(self, batches: Iterator[Any], first: int) -> Array | None:
        """Return the next rows, or None at the end."""
        try:
            batch = next(batches, None)
            return batch and np.column_stack([column.to_numpy(zero_copy_only=False) for column in batch.columns])
        except (OSError, ValueError):  # pyarrow's words say what byte of a page, and of no use to a user
            raise RecordError(
                f"{self.path}: the samples are damaged in column {self.names[first]!r} or one of those behind it. {_AGAIN}"
            ) from None


class SampleWriter:
    """Writes blocks of samples beside their place; `close` attaches the metadata and puts the file there."""

    def __init__(self, path: Path, names: list[str]) -> None:
        import pyarrow as pa
        import pyarrow.parquet as pq

        path.parent.mkdir(parents=True, exist_ok=True)
        self.path, self.names = path, names
        self._beside = path.with_name(path.name + ".part")
        self._schema = pa.schema([pa.field(name, pa.float64(), nullable=False) for name in names])
        # Byte-stream split makes smooth float64 columns compressible; dictionaries would not.
        self._writer = pq.ParquetWriter(
            self._beside, self._schema, compression="zstd", use_dictionary=False, use_byte_stream_split=True,
            write_page_checksum=True,
        )  # fmt: skip

    def write(self, values: Array) -> None:
        """Append samples, (n, n_columns)."""
        import pyarrow as pa

        columns = [pa.array(np.ascontiguousarray(column)) for column in values.T]
        self._writer.write_table(pa.Table.from_arrays(columns, schema=self._schema))

    def close(self, metadata: dict[str, Any]) -> None:
        """Finish the file."""
        self._writer.add_key_value_metadata({_KEY: json.dumps(metadata).encode()})
        self._writer.close()
        os.replace(self._beside, self.path)

    def discard(self) -> None:
        """Leave nothing behind."""
        with suppress(OSError):  # what cannot be written on a full disk cannot be finished either
            self._writer.close()
        self._beside.unlink(missing_ok=True)


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
        "states": [_encode(initial_state), _encode(final_state)],
        "bodies": list(plan.bodies),
        "points": list(plan.points),
        "mounts": [[name, list(states)] for name, states in plan.mounts],
    }


def save_response(response: Response, folder: Path) -> None:
    """Write `response` into `folder`, whole or not at all."""
    plan = ColumnPlan(
        bodies=list(response.bodies),
        points=list(response.points),
        mounts=[(name, mount.state_names) for name, mount in response.mounts.items()],
    )
    writer = SampleWriter(folder / FILE, list(response.samples.names))
    try:
        writer.write(response.samples.columns(0, len(response.samples.names)))
        parts = ("peaks", "scene", "motion", "events", "numerics", "initial_state", "final_state")
        writer.close(response_metadata(plan=plan, **{part: getattr(response, part) for part in parts}))
    except BaseException:
        writer.discard()
        raise


def load_response(folder: str | Path) -> Response:
    """Return the response that was saved in `folder`; samples are read when they are asked for.

    Args:
        folder: where `response.parquet` stands; or such a file itself, whatever its name.

    Raises:
        RecordError: the folder holds no response, or the file is damaged: names the column or the key of its metadata. What a
            damaged page of samples holds is found when it is read.
    """
    path = Path(folder)
    path = path if path.is_file() else path / FILE
    if not path.is_file():
        raise RecordError(f"{folder}: there is no {FILE} here; a run folder holds one.")
    names, content = _read(path)
    response = build_response(
        names=names, column_reader=lambda names: FileSamples(names, path), content=content, path=path
    )
    if not response.time.size or (np.diff(response.time) <= 0.0).any():
        raise RecordError(f"{path}: column 'time' must hold instants that grow from sample to sample. {_AGAIN}")
    return response


def _read(path: Path) -> tuple[list[str], dict[str, Any]]:
    """Return the names of the columns and the metadata of a file, both checked; RecordError if they cannot be a response's."""
    import pyarrow as pa
    import pyarrow.parquet as pq

    try:
        file = pq.read_metadata(path)
        schema = file.schema.to_arrow_schema()
    except (OSError, ValueError):
        raise RecordError(
            f"{path}: this is not a response of wirerope_mj, nor a whole Parquet file. {_AGAIN}"
        ) from None
    try:
        content = json.loads((file.metadata or {})[_KEY])
    except (KeyError, ValueError, RecursionError):
        raise RecordError(
            f"{path}: this is not a response of wirerope_mj: there is no readable metadata {_KEY.decode()!r}. {_AGAIN}"
        ) from None
    if isinstance(content, dict) and content.get("format") != FORMAT:
        raise RecordError(
            f"{path}: `format` is {content.get('format')!r}, not {FORMAT}; use the version that wrote it."
        )
    try:
        check_content(content, schema.names)
    except ValueError as error:
        raise RecordError(f"{path}: {error} {_AGAIN}") from None
    strange = [field.name for field in schema if field.type != pa.float64()]
    if strange:
        raise RecordError(f"{path}: column {strange[0]!r} must hold float64 numbers. {_AGAIN}")
    return schema.names, content


def build_response(
    *, names: list[str], column_reader: Callable[[list[str]], Any], content: dict[str, Any], path: Path | None
) -> Response:
    """Return the response of samples and their metadata."""
    samples = column_reader(names)
    plan = ColumnPlan(
        bodies=content["bodies"],
        points=content["points"],
        mounts=[(name, tuple(states)) for name, states in content["mounts"]],
    )
    base, bodies, points, mounts = plan.parts(samples)
    initial, final = (_decode(state) for state in content["states"])
    return Response(
        time=samples.columns(0, 1)[:, 0],
        base=base,
        bodies=bodies,
        points=points,
        mounts=mounts,
        peaks=Peaks.from_dict(content["peaks"]),
        scene=scene_from_dict(content["scene"]),
        motion=content["motion"],
        events=tuple((float(time), str(text)) for time, text in content["events"]),
        numerics=Numerics(**content["numerics"]),
        initial_state=initial,
        final_state=final,
        samples=samples,
        path=path,
    )


def _encode(state: State) -> list[Any]:
    return [state.time, base64.b64encode(state.values.astype("<f8").tobytes()).decode()]


def _decode(content: list[Any]) -> State:
    values = np.frombuffer(base64.b64decode(content[1]), dtype="<f8").astype(np.float64)
    return State(values=values, time=float(content[0]))
