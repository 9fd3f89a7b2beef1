"""A part from the Craig-Bampton matrices of a finite-element program: boundary coordinates, then fixed-interface modes."""

from collections.abc import Sequence
from pathlib import Path

import numpy as np
import scipy

from wirerope_mj.engine.flexible.eigenvectors import RIGID
from wirerope_mj.engine.flexible.files import Units, read_points
from wirerope_mj.engine.flexible.nastran import read_named_matrices
from wirerope_mj.engine.flexible.part import FlexiblePart
from wirerope_mj.foundation.arrays import Array
from wirerope_mj.foundation.errors import RecordError

_NULL = 1e-12  # of a matrix' largest entry, below which a row holds nothing
_ROUND = 1e-5  # of the largest entry, by which single precision and reduction leave what should be zero


def read_matrices(paths: Sequence[Path], n_points: int) -> tuple[Array, Array, int]:
    """Read stiffness and mass matrix of Craig and Bampton's form in the files' units; returns also coordinates per point.

    Rows of the boundary points, 3 or 6 each, stand before those of the modes. RecordError unless both matrices are there,
    whole and in that form.
    """
    matrices: dict[str, Array] = {}
    for path in paths:
        matrices |= read_named_matrices(path)
    where, pair = ", ".join(map(str, paths)), []
    for letter, quantity in (("k", "stiffness"), ("m", "mass")):
        names = [name for name in matrices if name.startswith(letter)]
        # beside KXX and MXX an external superelement's file has recovery matrices, placeholders, and structural damping K4XX
        whole = [key for key in names if 1 < len(matrices[key]) == matrices[key].size ** 0.5 and not key.startswith("k4")]
        names = whole or names
        if len(names) != 1:
            raise RecordError(
                f"{where}: expected one {quantity} matrix, with a name that begins with {letter.upper()}, got {len(names)}; "
                f"the matrices are {', '.join(matrices) or 'none'}. Write both by DMAP (OUTPUT4 or OUTPUT2), or eigenvectors."
            )
        matrix = np.asarray(matrices[names[0]])
        if np.iscomplexobj(matrix) or matrix.ndim != 2 or matrix.shape[0] != matrix.shape[1]:
            raise RecordError(f"{where}: {names[0].upper()} must be real and square, got {matrix.shape} of {matrix.dtype}.")
        size = float(np.abs(matrix).max(initial=0.0))
        if not np.isfinite(size) or size == 0.0:
            raise RecordError(f"{where}: {names[0].upper()} holds no finite numbers but 0, or others.")
        if float(np.abs(matrix - matrix.T).max()) > _ROUND * size:
            raise RecordError(f"{where}: {names[0].upper()} is not symmetric; write the whole matrix, not one triangle.")
        pair.append(0.5 * (matrix + matrix.T))
    stiffness, mass = pair
    if stiffness.shape != mass.shape:
        raise RecordError(f"{where}: K has {len(stiffness)} rows and M {len(mass)}; both are of one reduction.")
    for width in (6, 3):
        n = width * n_points
        if n <= len(stiffness) and np.abs(stiffness[:n, n:]).max(initial=0.0) <= _ROUND * np.abs(stiffness[:n, :n]).max():
            break
    else:
        raise RecordError(
            f"{where}: {len(stiffness)} rows are not those of {n_points} boundary points with 6 or 3 coordinates each, then "
            "modes, with none of K between both. List every boundary point in the table of points, in the matrices' order."
        )
    modal, springs = mass[n:, n:], stiffness[n:, n:]
    if np.abs(springs - np.diag(np.diag(springs))).max(initial=0.0) > _ROUND * np.abs(springs).max(initial=0.0):
        raise RecordError(f"{where}: behind the boundary K is not diagonal: these coordinates are no modes.")
    if np.abs(modal - np.eye(len(modal))).max(initial=0.0) > _ROUND:
        raise RecordError(
            f"{where}: behind the boundary M is not 1 (largest {np.abs(modal).max():.4g}): the modes are not mass-normalised "
            "or not orthogonal. Reduce with unit modal mass (NORM = MASS)."
        )
    return stiffness, mass, width


def part_of_matrices(paths: Sequence[Path], points: Path, units: Units, *, damping: float) -> tuple[FlexiblePart, Array]:
    """Build a flexible part from Craig-Bampton matrices, and return with it the mass that can move along x, y, z [kg].

    Points whose column "held" says yes are fixed to the base; the modes are those of all else, K phi = omega^2 M phi, and

        Gamma = phi^T (M r),   r = 1 along an axis at every boundary point, 0 of the modes

    of a unit motion of the base. Without a held point the part is free, and its rigid-body modes are left out.

    Raises:
        RecordError: as `read_matrices`, or the matrices resist rigid-body motions.
    """
    table = read_points(points, units)
    stiffness, mass, width = read_matrices(paths, len(table))
    where, size = ", ".join(map(str, paths)), len(mass)
    rigid, held = np.zeros((size, 6)), np.zeros(size, dtype=bool)
    for number, (location, row, place) in enumerate(table.values()):
        first = width * number
        rigid[first : first + 3, :3] = np.eye(3)
        rigid[first : first + 3, 3:] = np.cross(np.eye(3), place / units.length).T
        rigid[first + 3 : first + width, 3:] = np.eye(3)[: width - 3]
        if (word := row.get("held", "").lower()) not in ("", "yes", "no"):
            raise RecordError(f'{location}: column "held" says yes or nothing, got {word!r}.')
        held[first : first + width] = word == "yes"
    stiff, heavy = np.abs(stiffness).max(axis=1), np.abs(mass).max(axis=1)
    # a force per length from a rigid motion, against those of the same motion's single coordinates
    resists = np.abs(stiffness @ rigid).max(axis=0)
    against = (np.abs(stiffness) @ np.abs(rigid)).max(axis=0)
    if (resists > _ROUND * against).any():
        axes = ("x", "y", "z", "a turn about x", "a turn about y", "a turn about z")
        axis = axes[int(np.argmax(resists / (against + 1e-300)))]
        raise RecordError(
            f"{where}: K resists a rigid motion along {axis}: the part is grounded inside, or order, places or units of "
            "the points are not those of the matrices."
        )
    free = ~held & ((stiff > _NULL * stiff.max()) | (heavy > _NULL * heavy.max()))
    kept = np.ix_(free, free)
    try:
        squares, vectors = scipy.linalg.eigh(stiffness[kept], mass[kept])
    except np.linalg.LinAlgError:
        raise RecordError(
            f"{where}: M is not positive: no body has this mass. Is it complete, and in the order of K?"
        ) from None
    frequencies = np.sqrt(np.maximum(squares, 0.0)) / (2.0 * np.pi)
    elastic = frequencies >= RIGID
    if held.any() and not elastic.all():
        raise RecordError(
            f"{where}: {int((~elastic).sum())} modes are below {RIGID:g} Hz though points are held: the part can move as a "
            'rigid body. Mark every point that is fixed to the base in the column "held".'
        )
    carried = mass @ rigid[:, :3]
    moving = np.linalg.norm(vectors.T @ carried[free], axis=0) ** 2 * units.mass  # that of all modes
    loose = [name for n, name in enumerate(table) if not held[width * n]]
    shapes = np.zeros((size, int(elastic.sum())))
    shapes[free] = vectors[:, elastic]
    try:
        part = FlexiblePart(
            frequencies=frequencies[elastic], damping=np.array(damping),
            participation=shapes.T @ carried * np.sqrt(units.mass) * float(held.any()),
            points={name: place for name, (_, row, place) in table.items() if name in loose},
            shapes={
                name: shapes[width * n : width * n + 3].T / np.sqrt(units.mass) for n, name in enumerate(table) if name in loose
            },
        )  # fmt: skip
    except ValueError as error:
        raise RecordError(f"{where}: {error}") from None
    return part, moving
