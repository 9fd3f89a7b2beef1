"""The table of a complete study in its folder: read whole, or column by column, of which none stays in memory."""

from collections.abc import Callable, Iterator, Sequence
from contextlib import contextmanager
from copy import copy
from pathlib import Path
from typing import Any

import numpy as np
import pyarrow as pa
import pyarrow.parquet as pq

from wirerope_mj.foundation.arrays import Booleans, Integers
from wirerope_mj.foundation.errors import RecordError

TABLE, PARTS = "variants.parquet", "parts"
# Columns of every study's table, and their types.
_ALWAYS = {"variant": pa.int64(), "status": pa.string(), "message": pa.string()}
_REPEATED = ["status", "message"]  # Of which many rows have the same text: read as numbers of the texts
_COPY = "Put a copy in its place, or compute the study again with --force (`force=True`)."


def read_table(folder: Path, columns: Sequence[str] | None = None) -> pa.Table:
    """Read the table of a complete study, or some columns of it; RecordError if its file is damaged or changed."""
    with _table_file(folder) as path:
        table = pq.read_table(path, columns=columns)
    for name in [name for name in _ALWAYS if columns is None or name in columns]:
        _check(folder, name, table[name] if name in table.column_names else None)
    return table


class StoredTable:
    """The table of a complete study with the interface of a pyarrow Table, read from its file only as far as it is used.

    Of a million variants a column takes 8 MB, and all of them gigabytes. RecordError if the file is damaged or changed.
    """

    def __init__(self, folder: Path, todays_name: Callable[[str], str]) -> None:
        """Open the table in `folder`; `todays_name` renames columns that an older version called otherwise."""
        with _table_file(folder) as path:
            self._metadata = pq.read_metadata(path)
        self._folder, self._rows = folder, np.arange(self._metadata.num_rows)
        self._stored = {todays_name(name): name for name in self._metadata.schema.to_arrow_schema().names}

    @property
    def column_names(self) -> list[str]:
        return list(self._stored)

    @property
    def num_rows(self) -> int:
        return self._rows.size

    @property
    def schema(self) -> pa.Schema:
        stored = self._metadata.schema.to_arrow_schema()
        return pa.schema([(name, stored.field(name_stored).type) for name, name_stored in self._stored.items()])

    def __getitem__(self, name: str) -> pa.ChunkedArray:
        """Read a column; texts are dictionary-encoded."""
        if name in _ALWAYS and name not in self._stored:
            _check(self._folder, name, None)
        with self._file(read_dictionary=[name] if name in _REPEATED else None) as file:
            column = file.read(columns=[self._stored[name]], use_threads=False)[self._stored[name]]
        if name in _ALWAYS:
            _check(self._folder, name, column)
        return column if self.num_rows == self._metadata.num_rows else column.take(pa.array(self._rows))

    def filter(self, mask: Booleans) -> "StoredTable":
        """Return the table of the rows in `mask`, (n,)."""
        filtered = copy(self)
        filtered._rows = self._rows[np.asarray(mask)]
        return filtered

    def take(self, rows: Sequence[int]) -> pa.Table:
        """Read some rows, in this order."""
        stored: Integers = self._rows[np.asarray(rows, dtype=np.int64)]
        rising, places = np.unique(stored, return_inverse=True)
        parts = [
            block.take(pa.array(rising[(first <= rising) & (rising < end)] - first))
            for first, end, block in self._blocks(rising)
        ]
        return pa.concat_tables([self.schema.empty_table(), *parts]).take(pa.array(places))

    def blocks(self) -> Iterator[pa.Table]:
        """Yield the rows in several tables, one for each row group of the file."""
        for first, end, block in self._blocks(self._rows):
            yield block.take(pa.array(self._rows[(first <= self._rows) & (self._rows < end)] - first))

    def _blocks(self, rows: Integers) -> Iterator[tuple[int, int, pa.Table]]:
        """Yield the row groups of the file that hold any of `rows`: number of the first row, of the row behind, and table."""
        sizes = [self._metadata.row_group(number).num_rows for number in range(self._metadata.num_row_groups)]
        ends = np.cumsum(sizes)
        for group in np.unique(np.searchsorted(ends, rows, side="right")).tolist():
            with self._file() as file:
                table = file.read_row_group(group, use_threads=False)
            yield int(ends[group]) - sizes[group], int(ends[group]), table.rename_columns(self.column_names)

    @contextmanager
    def _file(self, **how: Any) -> Iterator[pq.ParquetFile]:
        with _table_file(self._folder) as path, pq.ParquetFile(path, metadata=self._metadata, **how) as file:
            yield file


def _check(folder: Path, name: str, column: pa.ChunkedArray | None) -> None:
    """Raise RecordError unless a column that every study has is what was written."""
    where = f"{folder / TABLE}: column {name!r}"
    kind = None if column is None else column.type.value_type if pa.types.is_dictionary(column.type) else column.type
    if column is None or kind != _ALWAYS[name] or column.null_count:
        raise RecordError(f"{where} must hold {_ALWAYS[name]} in every row; the table was changed. {_COPY}")
    if name == "variant" and not np.array_equal(column.to_numpy(), np.arange(len(column))):
        raise RecordError(f"{where} must number the rows from 0 on; the table was changed. {_COPY}")


@contextmanager
def _table_file(folder: Path) -> Iterator[Path]:
    """Lend the path of the table; an error from reading it becomes a RecordError that says what can be done."""
    try:
        yield folder / TABLE
    except (OSError, pa.ArrowException):
        remedy = (
            "Remove it, and go on with --resume (`resume=True`): the parts that made it are there."
            if (folder / PARTS).is_dir()
            else f"The parts that made it are gone: {_COPY[0].lower()}{_COPY[1:]}"
        )
        raise RecordError(f"{folder / TABLE}: this table is damaged. {remedy}") from None
