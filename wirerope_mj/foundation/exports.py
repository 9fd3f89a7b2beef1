"""Tables written for other programs: CSV, HDF5, MATLAB and pandas; h5py and pandas are imported where they are asked for."""

import re
from collections.abc import Callable, Iterator, Mapping, Sequence
from contextlib import ExitStack
from dataclasses import dataclass, replace
from difflib import get_close_matches
from fnmatch import fnmatchcase
from importlib import import_module
from pathlib import Path
from types import ModuleType
from typing import TYPE_CHECKING

import numpy as np
import scipy

from wirerope_mj.foundation.arrays import AnyArray
from wirerope_mj.foundation.atomic_files import atomic_file, check_writable
from wirerope_mj.foundation.errors import RecordError
from wirerope_mj.foundation.interrupts import interrupts_held
from wirerope_mj.foundation.plain_text import no_formula
from wirerope_mj.foundation.unfailing_files import UnfailingFile

if TYPE_CHECKING:
    import pandas

# Endings of files, and what is written into them.
ENDINGS = {".csv": "csv", ".h5": "hdf5", ".hdf5": "hdf5", ".mat": "mat"}
# Letters of a name that MATLAB reads.
_LONGEST = 63


@dataclass(frozen=True, kw_only=True)
class Exported:
    """A table to be written for other programs: columns with names and units, as a whole or in blocks of rows."""

    names: Sequence[str]  # of the columns, parts of a name apart by "/"
    units: Sequence[str]  # of each column; "" for none
    column: Callable[[int], AnyArray]  # returns one column by its position, (n,), numbers or texts
    # yields all columns some rows after the other, so that a long table is never in memory as a whole
    blocks: Callable[[], Iterator[Sequence[AnyArray]]]
    about: Mapping[str, str]  # texts that are kept with it where the format has room
    # whether "/" makes groups in HDF5; else "." stands for it there, as where a name is also that of a group
    grouped: bool = True

    @property
    def headings(self) -> list[str]:
        """Names with their units, as `acceleration/rack [m/s^2]`."""
        return [f"{name} [{unit}]" if unit else name for name, unit in zip(self.names, self.units, strict=True)]


def picked(table: Exported, patterns: Sequence[str]) -> Exported:
    """Keep the columns whose names a pattern with * and ? matches, and the first, which gives the order.

    Raises:
        ValueError: a pattern matches none.
    """
    kept = [0]
    for pattern in patterns:
        numbers = [n for n, name in enumerate(table.names) if fnmatchcase(name, pattern)]
        if not numbers:
            near = get_close_matches(pattern, table.names, n=3, cutoff=0.3)
            raise ValueError(f"no column matches {pattern!r}; there are {', '.join(near or table.names[1:4])} and others.")
        kept += numbers
    kept = sorted(set(kept))
    return replace(
        table, names=[table.names[n] for n in kept], units=[table.units[n] for n in kept],
        column=lambda number: table.column(kept[number]), blocks=lambda: ([block[n] for n in kept] for block in table.blocks()),
    )  # fmt: skip


class Exportable:
    """Base of results that are tables: written for other programs in the format that a file's ending or a method names."""

    @property
    def exported(self) -> Exported:
        """The table to be written for other programs, in SI units."""
        raise NotImplementedError

    def export(self, path: str | Path, *, force: bool = False) -> Path:
        """Write the table to a file whose ending says how, .csv, .h5 or .hdf5, .mat, and return its path.

        Names and units of the columns stand in the header (CSV), with every dataset (HDF5), or in the variables `variables`,
        `names` and `units` (MATLAB). Long tables are read and written some rows or columns after the other, but for MATLAB.

        Raises:
            ValueError: the ending is none of these.
            RecordError: the file cannot be written, or is there and `force` is not given, or h5py is missing for HDF5.
        """
        return write_export(self.exported, path, force=force)

    def to_csv(self, path: str | Path, *, force: bool = False) -> Path:
        """Write the table as CSV, whatever the ending, as `export` does."""
        return write_export(self.exported, path, force=force, kind="csv")

    def to_hdf5(self, path: str | Path, *, force: bool = False) -> Path:
        """Write the table as HDF5, whatever the ending, as `export` does."""
        return write_export(self.exported, path, force=force, kind="hdf5")

    def to_mat(self, path: str | Path, *, force: bool = False) -> Path:
        """Write the table as a MATLAB file, whatever the ending, as `export` does."""
        return write_export(self.exported, path, force=force, kind="mat")

    def to_dataframe(self) -> "pandas.DataFrame":
        """Return the table as a pandas DataFrame, units in the names of its columns; RecordError without pandas."""
        table = self.exported
        return _needed("pandas").DataFrame({heading: table.column(number) for number, heading in enumerate(table.headings)})


def write_export(table: Exported, path: str | Path, *, force: bool = False, kind: str = "") -> Path:
    """Write a table as `kind`, "csv", "hdf5" or "mat", or as the file's ending says, .csv, .h5, .hdf5, .mat; return its path.

    Raises:
        ValueError: the ending is none of these.
        RecordError: the file cannot be written, or is there and `force` is not given, or a package that it needs is missing.
    """
    target = Path(path)
    kind = kind or ENDINGS.get(target.suffix.lower(), "")
    if not kind:
        raise ValueError(
            f"{target}: the ending says what is written, one of {', '.join(ENDINGS)}, of a run .xlsx and .png, too."
        )
    check_writable(target, force=force)
    with atomic_file(target) as temporary:
        {"csv": _write_csv, "hdf5": _write_hdf5, "mat": _write_mat}[kind](table, temporary)
    return target


def _write_csv(table: Exported, path: Path) -> None:
    """Write numbers in full precision below a header of names with units; spreadsheets compute none of the texts."""
    import pyarrow as pa
    import pyarrow.csv as pc

    writer = None
    for block in table.blocks():
        typed = [
            [no_formula(cell) if isinstance(cell, str) else cell for cell in column] if column.dtype.kind in "OUT" else column
            for column in block
        ]
        batch = pa.table([pa.array(column) for column in typed], names=[no_formula(name) for name in table.headings])
        if writer is None:
            writer = pc.CSVWriter(path, batch.schema)
        writer.write_table(batch)
    if writer is not None:
        writer.close()


def _write_hdf5(table: Exported, path: Path) -> None:
    """Write a dataset for every column, with the column's name, and its unit as an attribute."""
    h5py = _needed("h5py")
    # HDF5 ends the process if a write fails, as on a full disk, and loses an interrupt that meets it while it writes.
    with UnfailingFile(path, "w+b") as target, target.failures_raised(), ExitStack() as stack:
        with interrupts_held():
            file = h5py.File(target, "w")
            file.attrs.update(table.about)
        stack.callback(interrupts_held()(file.close))
        for number, (name, unit) in enumerate(zip(table.names, table.units, strict=True)):
            values = table.column(number)
            name = name if table.grouped else name.replace("/", ".")
            if values.dtype.kind in "OUT":
                values = np.array([str(value) for value in values], dtype=object)
                with interrupts_held():
                    file.create_dataset(name, data=values, dtype=h5py.string_dtype())
            else:
                with interrupts_held():
                    file.create_dataset(name, data=values).attrs["unit"] = unit


def _write_mat(table: Exported, path: Path) -> None:
    """Write a variable for every column; MATLAB's names hold letters and digits only: `names` and `units` say what each is."""
    names = _matlab_names(table.names)
    values: dict[str, object] = {name: table.column(number)[:, np.newaxis] for number, name in enumerate(names)}
    for extra, texts in (("variables", names), ("names", table.names), ("units", table.units)):
        values[extra] = np.array([*texts, ""], dtype=object)[:-1]
    values["about"] = dict(table.about)
    scipy.io.savemat(path, values, long_field_names=True, do_compression=True)


def _matlab_names(names: Sequence[str]) -> list[str]:
    """Return names that MATLAB accepts, each different."""
    taken: dict[str, None] = dict.fromkeys(("variables", "names", "units", "about"))
    result = []
    for name in names:
        plain = re.sub(r"\W", "_", name.replace("/", "_"), flags=re.ASCII)
        plain = (plain if plain[:1].isalpha() else f"x_{plain}")[:_LONGEST]
        number, unique = 1, plain
        while unique in taken:
            number += 1
            unique = f"{plain[: _LONGEST - 1 - len(str(number))]}_{number}"
        taken[unique] = None
        result.append(unique)
    return result


def _needed(package: str) -> ModuleType:
    """Import a package that may not be installed; RecordError says how to install it."""
    try:
        return import_module(package)
    except ModuleNotFoundError:
        raise RecordError(
            f"this needs {package}, which is not installed: pip install 'wirerope-mj[export]', or write CSV or MAT."
        ) from None
