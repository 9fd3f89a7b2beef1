"""Nastran's binary files and bulk text as pyyeti reads them: matrices, eigenvectors, places of grid points."""

import warnings
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path

import numpy as np

from wirerope_mj.foundation.arrays import Array
from wirerope_mj.foundation.errors import RecordError, why_unread
from wirerope_mj.foundation.plain_text import short
from wirerope_mj.foundation.regular_files import regular

MATRICES, BINARY, BULK = (".op4", ".op2"), ".op2", (".bdf", ".dat", ".nas", ".blk", ".bulk")
EXTERNAL = (".asm", ".pch", ".pun", ".punch")  # in which an external superelement's grid points are written as bulk text
_SHAPES = ("OUGV1", "OUG1", "BOPHIG")  # tables of an OP2 file that may hold eigenvectors


def read_named_matrices(path: Path) -> dict[str, Array]:
    """Read the matrices of an OP4 or OP2 file by their names in small letters."""
    kind = path.suffix.lower()
    with _read_by_pyyeti(path, f"{kind[1:].upper()} file, or it is damaged. Write it again (OUTPUT{kind[-1]})") as name:
        from pyyeti.nastran import op2, op4

        return dict(op2.rdmats(name, lower=True) if kind == BINARY else op4.read(name))


def read_binary_shapes(path: Path) -> tuple[Array, dict[int, Array]] | None:
    """Read frequencies [Hz] and shapes by grid point, (m, 3), of an OP2 file's real modes; None if it has no such table."""
    with _read_by_pyyeti(path, "OP2 file, or it is damaged. Write it again (PARAM,POST,-1)") as name:
        from pyyeti.nastran import op2

        with op2.OP2(name) as file:
            tables = [table for table in _SHAPES for _ in file.dbdct.get(table, ())]
            if not tables:
                return None
            if len(tables) > 1:
                raise RecordError(f"{path}: it has {len(tables)} tables of shapes ({', '.join(tables)}); write one subcase.")
            record = file.rdop2oug(tables[0])
        if record is None:
            raise RecordError(f"{path}: {tables[0]} holds no real modes sorted by modes; write those of SOL 103, SORT1.")
        values, degrees = record.to_numpy(dtype=np.float64), np.array(record.index.to_list())
        firsts = np.flatnonzero(degrees[:, 1] == 1)  # of grid points; a scalar point has degree 0 alone
        shapes = {int(degrees[first, 0]): values[first : first + 3].T for first in firsts}
        return np.array([frequency for _, frequency in record.columns], dtype=np.float64), shapes


def read_grids(path: Path) -> dict[int, Array]:
    """Read the places of the grid points of bulk text in the basic system, in the file's units, (3,) by number."""
    with _read_by_pyyeti(path, "bulk text with GRID entries. Write those of the points") as name:
        from pyyeti.nastran import bulk

        cards = bulk.rdcards(name, "grid", return_var="list") or []
        if words := [(card[0], word) for card in cards for word in card[:6] if isinstance(word, str) and word]:
            raise RecordError(f"{path}: GRID {words[0][0]} holds {short(words[0][1])!r} where a number is expected.")
        table = bulk.bulk2uset(name)[0]
        numbers, rows = table.index.get_level_values(0)[::6], table[["x", "y", "z"]].to_numpy().reshape(-1, 6, 3)
        if (turned := np.flatnonzero(rows[:, 1, 0])).size:
            raise RecordError(
                f"{path}: displacements of grid point {numbers[turned[0]]} are in coordinate system "
                f"{rows[turned[0], 1, 0]:.0f}, those of {turned.size} points not in the basic one. Write modes with CD 0."
            )
        return {int(grid): row[0] for grid, row in zip(numbers, rows, strict=True)}


@contextmanager
def _read_by_pyyeti(path: Path, expected: str) -> Iterator[str]:
    """Yield the path for pyyeti to read in the block; its warnings are ignored, its errors become RecordError."""
    try:
        with warnings.catch_warnings():
            warnings.simplefilter("ignore")
            yield str(regular(path))
    except RecordError:
        raise
    except ModuleNotFoundError:
        raise RecordError(f'{path}: files of Nastran are read by pyyeti: pip install "wirerope-mj[fe]".') from None
    except OSError as error:
        raise RecordError(f"{path}: the file cannot be read: {why_unread(error)}") from None
    except Exception:
        raise RecordError(f"{path}: this is no {expected}.") from None
