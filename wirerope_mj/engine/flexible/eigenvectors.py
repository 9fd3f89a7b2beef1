"""Eigenvectors of a finite-element program at its nodes, from universal files (dataset 55), Nastran's text and OP2 files."""

import math
import re
from collections.abc import Mapping
from dataclasses import dataclass
from pathlib import Path

import numpy as np

from wirerope_mj.engine.flexible.files import MODE_COLUMNS, Units, numbers_of, read_points, read_rows
from wirerope_mj.engine.flexible.nastran import BINARY, read_binary_shapes
from wirerope_mj.engine.flexible.part import NEAR, FlexiblePart
from wirerope_mj.foundation.arrays import Array
from wirerope_mj.foundation.errors import RecordError, why_unread
from wirerope_mj.foundation.plain_text import short
from wirerope_mj.foundation.regular_files import regular

UNIVERSAL, PUNCH, PRINTED = (".unv", ".uff", ".uf"), (".pch", ".pun", ".punch"), (".f06",)
RIGID = 0.05  # frequency below which a mode of a deck or a machine is a rigid-body motion and its rounding [Hz]
_NORMAL, _COMPLEX, _DISPLACEMENT = 2, (3, 7), 8  # analyses and kind of data of dataset 55
_BANNER = "R E A L   E I G E N V E C T O R   N O ."  # of a page of printed eigenvectors
_COORDINATES = (15, 2411)  # datasets of nodes
_SAME = 1e-3  # of a frequency, by which two files of one analysis may differ
_UNIT = 1e-5  # of 1, by which the largest component of a mode that is scaled to it may differ


@dataclass(frozen=True, kw_only=True, eq=False)
class Eigenvectors:
    """Real modes as a file has them, in its own units: shapes by node (m, 3), modal mass and damping 0 where none is stated."""

    frequencies: Array
    modal_mass: Array
    damping: Array
    shapes: Mapping[int, Array]
    places: Mapping[int, Array]  # of nodes, where the file has them


def read_eigenvectors(path: Path) -> Eigenvectors | None:
    """Read the real modes of a universal, punch, f06 or OP2 file; None for an OP2 file without modes."""
    if path.suffix.lower() == BINARY:
        if (tables := read_binary_shapes(path)) is None:
            return None
        eigenvectors = _without_modal_mass(*tables)
    else:
        eigenvectors = _universal(path) if path.suffix.lower() in UNIVERSAL else _nastran_text(path)
    low = np.flatnonzero(eigenvectors.frequencies < RIGID) + 1
    if low.size:
        raise RecordError(
            f"{path}: mode {', '.join(map(str, low[:6]))} is below {RIGID:g} Hz: rigid-body motions are the body's own. Have "
            "the program write elastic modes alone (EIGRL with V1 = 0.1), of a deck with its edge held."
        )
    largest = np.max([np.abs(shape).max(axis=1) for shape in eigenvectors.shapes.values()], axis=0)
    if not eigenvectors.modal_mass.any() and largest.size > 1 and (np.abs(largest - 1.0) < _UNIT).all():
        raise RecordError(
            f"{path}: the largest component of every mode is 1: these modes are not mass-normalised. Have the program write "
            "them with unit modal mass (NORM = MASS)."
        )
    return eigenvectors


def part_of_eigenvectors(
    eigenvectors: Eigenvectors, path: Path, points: Path, units: Units, *, damping: float, modes: Path | None
) -> FlexiblePart:
    """Build a part from eigenvectors, read from `path`, at the nodes that a table of points names.

    The table has point, x, y, z, and the node of each where it is not called as its point, or is bulk text; `modes` is a table
    with damping and participation of a deck, None of equipment, `damping` the ratio where neither file states one, `units`
    those of all files.

    Raises:
        RecordError: a node is missing or elsewhere, or the table of modes is another analysis'.
    """
    scale = np.sqrt(np.where(eigenvectors.modal_mass > 0.0, eigenvectors.modal_mass, 1.0) * units.mass)
    places, shapes = {}, {}
    for name, (where, row, place) in read_points(points, units, eigenvectors.shapes).items():
        text = row.get("node") or name
        if not text.isdigit() or int(text) not in eigenvectors.shapes:
            nodes = sorted(eigenvectors.shapes)
            raise RecordError(
                f"{where}: {path.name} has no shapes of node {short(text)!r} for point {name!r}; it has {len(nodes)} nodes "
                f'from {nodes[0]} to {nodes[-1]}. Name them in a column "node".'
            )
        node = int(text)
        if node in eigenvectors.places and np.linalg.norm(eigenvectors.places[node] * units.length - place) > NEAR:
            position = ", ".join(f"{c * units.length:.4g}" for c in eigenvectors.places[node])
            raise RecordError(
                f"{where}: point {name!r} is elsewhere than its node {node}, which {path.name} has at ({position}) m. Check "
                "the units and the axes of both."
            )
        places[name], shapes[name] = place, eigenvectors.shapes[node] / scale[:, np.newaxis]
    ratios, participation = np.where(eigenvectors.damping > 0.0, eigenvectors.damping, damping), np.zeros((0, 3))
    if modes is not None:
        rows = read_rows(modes, (MODE_COLUMNS,))
        table = np.array([numbers_of(where, row, MODE_COLUMNS[1:]) for where, row in rows])
        if len(table) != len(scale) or not np.allclose(table[:, 0], eigenvectors.frequencies, rtol=_SAME):
            raise RecordError(
                f"{modes}: expected the {len(scale)} modes of {path.name} from {eigenvectors.frequencies[0]:.6g} to "
                f"{eigenvectors.frequencies[-1]:.6g} Hz, got {len(table)} from {table[0, 0]:.6g} to {table[-1, 0]:.6g} Hz."
            )
        ratios, participation = table[:, 1], table[:, 2:] * math.sqrt(units.mass)
    try:
        return FlexiblePart(
            frequencies=eigenvectors.frequencies, damping=ratios, participation=participation, shapes=shapes, points=places
        )
    except ValueError as error:
        raise RecordError(f"{modes or path}: {error}") from None


def _universal(path: Path) -> Eigenvectors:
    """Read datasets 55 of normal modes, and 15 or 2411 of nodes."""
    import pyuff  # here, because few parts are universal files

    try:
        marks = re.findall(rb"^ {4}-1[ \t]*\r?(?:\n|\Z)(?=(.{0,6}))", regular(path).read_bytes(), flags=re.MULTILINE)
        file = pyuff.UFF(str(path))
        kinds = [int(kind) for kind in file.get_set_types()]
        sets = [file.read_sets(n) for n, kind in enumerate(kinds) if kind in (55, *_COORDINATES)]
    except OSError as error:
        raise RecordError(f"{path}: the file cannot be read: {why_unread(error)}") from None
    except Exception:  # the reader knows no other class, and does not say what it met
        raise RecordError(f"{path}: this universal file cannot be read, it has a damaged dataset. Write it again.") from None
    if len(marks) % 2 or not all(kind.strip().isdigit() for kind in marks[::2]):
        raise RecordError(
            f"{path}: a line -1, which begins or ends a dataset, or the number of a dataset below it is lost or doubled. "
            "Write the file again."
        )
    data = [dataset for dataset in sets if dataset["type"] == 55]
    if any(int(dataset["analysis_type"]) in _COMPLEX or np.iscomplexobj(dataset["r1"]) for dataset in data):
        raise RecordError(
            f"{path}: its modes are complex; expected are the real normal modes of the undamped structure. Write those, and "
            "say the damping with --damping."
        )
    data = [dataset for dataset in data if int(dataset["analysis_type"]) == _NORMAL]
    if not data:
        raise RecordError(
            f"{path}: this universal file holds no normal modes (dataset 55, analysis 2); its datasets are "
            f"{', '.join(map(str, kinds)) or 'none'}."
        )
    numbers = [int(dataset["mode_n"]) for dataset in data]
    nodes = [int(node) for node in data[0]["node_nums"]]
    for number, dataset in zip(numbers, data, strict=True):
        if int(dataset["spec_data_type"]) != _DISPLACEMENT:
            raise RecordError(f"{path}: mode {number} is no displacement (data type 8) but type {dataset['spec_data_type']}.")
        if numbers.count(number) > 1:
            raise RecordError(f"{path}: mode {number} stands there twice.")
        if list(map(int, dataset["node_nums"])) != nodes:
            raise RecordError(f"{path}: mode {number} is at other nodes than mode {numbers[0]}; write all at the same ones.")
    for dataset in sets:  # each lists every node once, with three numbers: a lost line shifts all that follow
        shapes, listed = dataset["type"] == 55, [*map(int, dataset["node_nums"])]
        sizes = {np.size(dataset.get(name, ())) for name in (("r1", "r2", "r3") if shapes else "xyz")}
        if sizes != {len(listed)} or len(set(listed)) != len(listed):
            title = f"mode {int(dataset['mode_n'])}" if shapes else f"dataset {dataset['type']}"
            raise RecordError(
                f"{path}: {title} is damaged: {len(listed)} nodes, {len(set(listed))} different ones, {max(sizes)} rows of "
                "numbers. A line is lost or doubled; write the file again."
            )
    values = np.array([[dataset["r1"], dataset["r2"], dataset["r3"]] for dataset in data])  # (m, 3, n)
    places = {
        int(node): np.array([dataset[axis][n] for axis in "xyz"])
        for dataset in sets if dataset["type"] in _COORDINATES for n, node in enumerate(dataset["node_nums"])
    }  # fmt: skip
    frequencies, modal_mass, damping = (
        np.array([float(dataset[key] or 0.0) for dataset in data]) for key in ("freq", "modal_m", "modal_damp_vis")
    )
    if not (np.isfinite(values).all() and np.isfinite([frequencies, modal_mass, damping]).all()):
        raise RecordError(f"{path}: its modes hold numbers that are not finite. Write the file again.")
    return Eigenvectors(
        frequencies=frequencies, modal_mass=modal_mass, damping=damping, places=places,
        shapes={node: values[:, :, n] for n, node in enumerate(nodes)},
    )  # fmt: skip


def _without_modal_mass(frequencies: Array, shapes: Mapping[int, Array]) -> Eigenvectors:
    zero = np.zeros(len(frequencies))
    return Eigenvectors(frequencies=frequencies, modal_mass=zero, damping=zero, places={}, shapes=shapes)


def _nastran_text(path: Path) -> Eigenvectors:
    """Read eigenvectors as Nastran punches or prints them: an eigenvalue, then each grid point with T1, T2, T3."""
    try:
        lines = regular(path).read_text(encoding="utf-8", errors="replace").splitlines()
    except OSError as error:
        raise RecordError(f"{path}: the file cannot be read: {why_unread(error)}") from None
    printed, inside, square, last = path.suffix.lower() in PRINTED, False, math.nan, 0
    eigenvalues: list[float] = []
    shapes: list[dict[int, list[float]]] = []
    for number, line in enumerate(lines, 1):
        where, text = f"{path}, line {number}", line if printed else line[:72]
        if text.startswith(("$REAL-IMAGINARY", "$MAGNITUDE")) or (printed and "C O M P L E X   E I G E N V E C T O R" in text):
            raise RecordError(f"{where}: these modes are complex; write the real ones of SOL 103.")
        if text.startswith("$POINT ID") or (printed and "POINT-ID =" in text):
            raise RecordError(f"{where}: this output is sorted by points (SORT2); write it by modes, SORT1.")
        try:
            if text.lstrip(" $").startswith("EIGENVALUE ="):
                square = float(text.partition("=")[2].split()[0])
            if text.startswith("$EIGENVALUE") or (printed and _BANNER in text):
                mode, inside = int(text.split()[-1]) if printed else last + 1, True
                if mode != last:  # else its table goes on on this page
                    eigenvalues.append(square)
                    shapes.append({})
                last = mode
            elif printed and text.startswith("1"):
                inside = False  # on a new page, perhaps of another table
            elif inside and (cells := text.split())[1:2] == ["G"]:
                columns = cells[2:] if printed else [text[column : column + 18] for column in (18, 36, 54)]
                node, row = int(cells[0]), [float(cell) for cell in columns]
                if node in shapes[-1]:
                    raise RecordError(f"{where}: grid point {node} stands twice in one mode.")
                if len(row) != (6 if printed else 3):
                    raise ValueError
                shapes[-1][node] = row[:3]
        except (ValueError, IndexError):
            raise RecordError(
                f"{where}: expected are a grid point and its {'six numbers' if printed else 'three numbers of 18 characters'}, "
                f"got {short(text.strip())!r}."
            ) from None
    if not shapes:
        raise RecordError(
            f"{path}: it holds no real eigenvectors; write the modes of SOL 103, DISPLACEMENT(SORT1, REAL, PUNCH) = ALL, or "
            "PRINT instead of PUNCH in an f06 file."
        )
    nodes = set(shapes[0])
    incomplete = next((n for n, shape in enumerate(shapes, 1) if set(shape) != nodes or not shape), 0)
    if incomplete:
        raise RecordError(f"{path}: mode {incomplete} is at other grid points than the first, or at none: is the file whole?")
    squares = np.array(eigenvalues)
    if not np.isfinite(squares).all() or not np.isfinite([*map(list, map(dict.values, shapes))]).all():
        raise RecordError(f"{path}: its modes hold numbers that are not finite. Write them again.")
    return _without_modal_mass(
        np.sqrt(np.maximum(squares, 0.0)) / (2.0 * math.pi),
        {node: np.array([shape[node] for shape in shapes]) for node in sorted(nodes)},
    )
