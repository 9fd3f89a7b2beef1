"""A response read from its Parquet file: float64 samples, and everything else in the file's own metadata."""

from collections.abc import Iterator
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np

from wirerope_mj.engine.response.checked import check_content
from wirerope_mj.engine.response.columns import ColumnPlan
from wirerope_mj.engine.response.histories import Numerics, block_rows
from wirerope_mj.engine.response.peaks import Peaks
from wirerope_mj.engine.response.response import FILE, FORMAT, Response, response_of
from wirerope_mj.engine.response.scene import scene_from_dict
from wirerope_mj.foundation.arrays import Array
from wirerope_mj.foundation.errors import RecordError
from wirerope_mj.foundation.parquet_files import read_content
from wirerope_mj.foundation.state import State

_AGAIN = "The file was damaged or edited: take it from another copy of the folder, or simulate the run again."


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
        rows, names, row = block_rows(last - first), self.names[first:last], 0
        batches = (  # of one row group after the other: pyarrow keeps what it has read of those that it is given at once
            batch
            for group in range(file.num_row_groups)
            for batch in file.iter_batches(rows, row_groups=[group], columns=names)
        )
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
        except (OSError, ValueError):  # pyarrow's text names a byte of a page, which helps no user
            raise RecordError(
                f"{self.path}: the samples are damaged in column {self.names[first]!r} or one of those behind it. {_AGAIN}"
            ) from None


def load_response(folder: str | Path) -> Response:
    """Return the response that was saved in `folder`; samples are read at first use.

    Args:
        folder: that holds `response.parquet`; or such a file itself, whatever its name.

    Raises:
        RecordError: the folder holds no response, or the file is damaged: names the column or the key of its metadata.
            A damaged page of samples is noticed when it is read.
    """
    path = Path(folder)
    path = path if path.is_file() else path / FILE
    if not path.is_file():
        raise RecordError(f"{folder}: there is no {FILE} here; a run folder holds one.")
    names, content = _read(path)
    response = _response(FileSamples(names, path), content, path)
    if not response.time.size or (np.diff(response.time) <= 0.0).any():
        raise RecordError(f"{path}: column 'time' must hold instants that grow from sample to sample. {_AGAIN}")
    return response


def _read(path: Path) -> tuple[list[str], dict[str, Any]]:
    """Return the names of the columns and the metadata of a file, both checked; RecordError if they cannot be a response's."""
    import pyarrow as pa

    schema, content = read_content(path, kind="a response of wirerope_mj", remedy=_AGAIN, version=FORMAT)
    try:
        check_content(content, schema.names)
    except ValueError as error:
        raise RecordError(f"{path}: {error} {_AGAIN}") from None
    strange = [field.name for field in schema if field.type != pa.float64()]
    if strange:
        raise RecordError(f"{path}: column {strange[0]!r} must hold float64 numbers. {_AGAIN}")
    return schema.names, content


def _response(samples: FileSamples, content: dict[str, Any], path: Path) -> Response:
    """Return the response of samples and their metadata."""
    plan = ColumnPlan(
        bodies=content["bodies"],
        points=content["points"],
        mounts=[(name, tuple(states)) for name, states in content["mounts"]],
    )
    initial, final = (State.from_plain(state) for state in content["states"])
    return response_of(
        plan,
        samples,
        peaks=Peaks.from_dict(content["peaks"]),
        scene=scene_from_dict(content["scene"]),
        motion=content["motion"],
        events=content["events"],
        numerics=Numerics(**content["numerics"]),
        initial_state=initial,
        final_state=final,
        path=path,
    )
