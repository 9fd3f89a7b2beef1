"""Decks and equipment that bend: a panel of one mode, and parts by their modes, in a model of any."""

from collections.abc import Sequence
from pathlib import Path

from wirerope_mj.engine.flexible.craig_bampton import part_of_matrices
from wirerope_mj.engine.flexible.eigenvectors import PRINTED, PUNCH, UNIVERSAL, part_of_eigenvectors, read_eigenvectors
from wirerope_mj.engine.flexible.files import MODES, POINTS, SHAPES, Units, load_flexible, read_flexible, save_flexible
from wirerope_mj.engine.flexible.nastran import BINARY, MATRICES
from wirerope_mj.engine.flexible.panel import Panel, panel_of_phrase
from wirerope_mj.engine.flexible.part import FlexiblePart
from wirerope_mj.foundation.arrays import Array

Deck = Panel | FlexiblePart


def import_part(
    files: Sequence[Path], points: Path | None, units: Units, *, damping: float
) -> tuple[FlexiblePart, Array | None]:
    """Read a flexible part from finite-element files, and the mass of all its modes along x, y, z [kg] where they state it.

    The files are OP4 or OP2 files of Craig-Bampton matrices; or a universal, punch, f06 or OP2 file of eigenvectors, perhaps
    with a table of modes; or tables of modes and shapes; or a folder of tables, whose table of points counts unless `points`,
    a table or bulk text, is given.
    `damping` is the ratio where they state none.

    Raises:
        ValueError: the files are not one of these.
        RecordError: one of them is damaged or does not fit the others.
    """
    endings = [file.suffix.lower() for file in files]
    if len(files) == 1 and files[0].is_dir():
        return read_flexible(files[0] / MODES, files[0] / SHAPES, points or files[0] / POINTS, units), None
    if points is not None and 1 <= len(files) <= 2 and endings[0] in (*UNIVERSAL, *PUNCH, *PRINTED, BINARY):
        modes = files[1] if len(files) == 2 else None
        if (eigenvectors := read_eigenvectors(files[0])) is not None:
            return part_of_eigenvectors(eigenvectors, files[0], points, units, damping=damping, modes=modes), None
    if points is not None and files and all(ending in MATRICES for ending in endings):
        return part_of_matrices(files, points, units, damping=damping)
    if points is not None and len(files) == 2:
        return read_flexible(files[0], files[1], points, units), None
    raise ValueError(
        "a part is read with `--points FILE` from OP4 or OP2 files, a universal, punch or f06 file and perhaps a table of "
        f"modes, or a table of modes and a table of shapes, in this order; or from a folder with {MODES}, {SHAPES} and "
        f"{POINTS}; got {len(files)} names."
    )


def deck_of(text: str) -> Deck:
    """Read a deck: the folder of a flexible part, or a phrase such as "10 Hz 800 kg 4 %"."""
    return load_flexible(text) if Path(text).is_dir() else panel_of_phrase(text)
