"""Tables as Parquet files: columns, and all else as JSON in the file's own metadata; written atomically.

pyarrow is imported where it is used: it takes longer to import than most commands run.
"""

import json
import os
from collections.abc import Mapping, Sequence
from contextlib import suppress
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np

from wirerope_mj.foundation.arrays import Array
from wirerope_mj.foundation.atomic_files import atomic_file
from wirerope_mj.foundation.errors import RecordError
from wirerope_mj.foundation.regular_files import regular

if TYPE_CHECKING:
    import pyarrow as pa

# Key of the JSON text in a file's metadata.
_KEY = b"wirerope_mj"


class TableWriter:
    """Writes blocks of float64 rows to a temporary adjacent file; `close` attaches the metadata and renames it."""

    def __init__(self, path: Path, names: Sequence[str]) -> None:
        import pyarrow as pa
        import pyarrow.parquet as pq

        path.parent.mkdir(parents=True, exist_ok=True)
        self.path = path
        self._temporary = path.with_name(path.name + ".part")
        self._schema = pa.schema([pa.field(name, pa.float64(), nullable=False) for name in names])
        # Byte-stream split makes smooth float64 columns compressible; dictionaries would not.
        self._writer = pq.ParquetWriter(
            self._temporary, self._schema, compression="zstd", use_dictionary=False, use_byte_stream_split=True,
            write_page_checksum=True,
        )  # fmt: skip

    def write(self, rows: Array) -> None:
        """Append rows, (n, n_columns)."""
        import pyarrow as pa

        # Not by `pa.array`, which imports pandas where that is installed.
        columns = [
            pa.Array.from_buffers(pa.float64(), len(rows), [None, pa.py_buffer(np.ascontiguousarray(column, dtype=np.float64))])
            for column in rows.T
        ]
        self._writer.write_table(pa.Table.from_arrays(columns, schema=self._schema))

    def close(self, content: Mapping[str, object]) -> None:
        """Finish the file with its metadata."""
        self._writer.add_key_value_metadata({_KEY: json.dumps(content).encode()})
        self._writer.close()
        os.replace(self._temporary, self.path)

    def discard(self) -> None:
        with suppress(OSError):  # what cannot be written on a full disk cannot be finished either
            self._writer.close()
        self._temporary.unlink(missing_ok=True)


def write_rows(path: Path, names: Sequence[str], rows: Array, content: Mapping[str, object]) -> None:
    """Write float64 rows, (n, n_columns), and their metadata; an existing file is replaced."""
    writer = TableWriter(path, names)
    try:
        writer.write(rows)
        writer.close(content)
    except BaseException:
        writer.discard()
        raise


def write_columns(path: Path, columns: Mapping[str, object], content: Mapping[str, object] | None = None) -> None:
    """Write columns of any type, and metadata if there is any; an existing file is replaced."""
    import pyarrow as pa
    import pyarrow.parquet as pq

    table = pa.table(dict(columns))
    if content is not None:
        table = table.replace_schema_metadata({_KEY: json.dumps(content).encode()})
    with atomic_file(path) as temporary:
        pq.write_table(table, temporary, compression="zstd")


def read_table(path: Path, *, kind: str, remedy: str) -> "pa.Table":
    """Read the columns of a file as a `pyarrow.Table`.

    Raises:
        RecordError: it is not a whole Parquet file; `kind` is what messages call it, with its article, `remedy` what to do.
    """
    import pyarrow as pa
    import pyarrow.parquet as pq

    try:
        return pq.read_table(regular(path))
    except (OSError, ValueError, pa.ArrowException):  # pyarrow's text names a byte, which helps no user
        raise _unreadable(path, kind, remedy) from None


def read_content(path: Path, *, kind: str, remedy: str, version: int | None = None) -> tuple["pa.Schema", Any]:
    """Read the `pyarrow.Schema` and the metadata of a file; its `format` must be `version` if that is given.

    Raises:
        RecordError: it is not a whole Parquet file, has no readable metadata, or another format; as for `read_table`.
    """
    import pyarrow as pa
    import pyarrow.parquet as pq

    try:
        file = pq.read_metadata(regular(path))
        schema, content = file.schema.to_arrow_schema(), json.loads((file.metadata or {})[_KEY])
    except (OSError, ValueError, KeyError, RecursionError, pa.ArrowException):
        raise _unreadable(path, kind, remedy) from None
    if version is not None and isinstance(content, dict) and content.get("format") != version:
        raise RecordError(f"{path}: `format` is {content.get('format')!r}, not {version}; use the version that wrote it.")
    return schema, content


def _unreadable(path: Path, kind: str, remedy: str) -> RecordError:
    return RecordError(f"{path}: this is not {kind}, or it is damaged. {remedy}")
