"""A response as one Parquet file: float64 samples, and everything else in the file's own metadata."""

import base64
import json
import os
from collections.abc import Callable, Iterable, Iterator
from dataclasses import asdict, dataclass
from pathlib import Path
from typing import Any

import numpy as np
import numpy.typing as npt

from wirerope_mj.errors import RecordError
from wirerope_mj.response.columns import ColumnPlan
from wirerope_mj.response.peaks import Peaks
from wirerope_mj.response.response import BLOCK_ROWS, Numerics, Response
from wirerope_mj.response.scene import Scene, scene_from_dict, scene_to_dict
from wirerope_mj.state import State

Array = npt.NDArray[np.float64]
FILE = "response.parquet"
_KEY = b"wirerope_mj"
FORMAT = 1


@dataclass(frozen=True)
class FileSamples:
    """Samples in a Parquet file, read column by column when they are asked for."""

    names: list[str]
    path: Path

    def columns(self, first: int, last: int) -> Array:
        """Return columns `first` to `last` (exclusive), (n_t, last - first)."""
        import pyarrow.parquet as pq

        with pq.ParquetFile(self.path) as file:
            values, row = np.empty((file.metadata.num_rows, last - first)), 0
            for block in self._blocks(file, first, last):  # read at once, the columns would stand in memory twice
                values[row : row + len(block)] = block
                row += len(block)
        return values

    def blocks(self, first: int, last: int) -> Iterator[Array]:
        """Yield these columns some rows after the other."""
        import pyarrow.parquet as pq

        with pq.ParquetFile(self.path) as file:
            yield from self._blocks(file, first, last)

    def _blocks(self, file: Any, first: int, last: int) -> Iterator[Array]:
        if first == last:  # a mount without internal states
            return
        for batch in file.iter_batches(BLOCK_ROWS, columns=self.names[first:last]):
            yield np.column_stack([column.to_numpy() for column in batch.columns])


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
            self._beside, self._schema, compression="zstd", use_dictionary=False, use_byte_stream_split=True
        )

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
        RecordError: the folder holds no response, or the file is damaged.
    """
    path = Path(folder)
    path = path if path.is_file() else path / FILE
    if not path.is_file():
        raise RecordError(f"{folder}: there is no {FILE} here; a run folder holds one.")
    try:
        import pyarrow.parquet as pq

        file = pq.read_metadata(path)
        content = json.loads((file.metadata or {})[_KEY])
        if content["format"] != FORMAT:
            raise RecordError(f"{path}: format {content['format']} is not {FORMAT}; use the version that wrote it.")
        return build_response(
            names=list(file.schema.names),
            column_reader=lambda names: FileSamples(names, path),
            content=content,
            path=path,
        )
    except (OSError, KeyError, ValueError, TypeError) as error:
        raise RecordError(
            f"{path}: this is not a response of wirerope_mj ({error.__class__.__name__}: {error})."
        ) from None


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
