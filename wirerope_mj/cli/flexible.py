"""`wirerope flexible`: the modes of a deck or of equipment from a finite-element program, checked, as a part for models."""

from pathlib import Path
from typing import Annotated

from cyclopts import Parameter


def flexible(
    files: list[Path],
    *,
    units: str,
    out: Path,
    points: Path | None = None,
    mass_kg: float | None = None,
    force: Annotated[bool, Parameter(negative=())] = False,
) -> int:
    """Read the modes of a deck or of equipment from tables, check them, and write them as a part that models bend by.

    The tables are CSV: modes with mode, frequency_Hz, damping, participation_x, participation_y, participation_z; shapes with
    point, mode, x, y, z, normalised to unit modal mass; points with point, x, y, z. A deck's modes are those with its edge
    held, and its participations Phi^T M r; equipment has free-free modes without the six rigid ones, and no participation.
    Residual vectors of the mounts' points and of a motion of the base are modes like others.

    wirerope shock MODEL --deck PART puts a model on the part.

    Args:
        files: table of modes, then table of shapes; or a folder with modes.csv, shapes.csv and points.csv.
        units: of length, mass and time in the finite-element model: mm,t,s or m,kg,s.
        out: folder of the part.
        points: table of points, in the axes of the body that bends; columns x_m, y_m, z_m are metres in any units.
        mass_kg: of the whole part, of which the modes should bring along 90 %.
        force: replace a part that is there.
    """
    from wirerope_mj.content.flexible import flexible_content
    from wirerope_mj.engine.flexible import save_flexible
    from wirerope_mj.engine.flexible.files import MODES, POINTS, SHAPES, read_flexible, units_in
    from wirerope_mj.foundation.arguments import positive
    from wirerope_mj.foundation.plain_text import plain
    from wirerope_mj.views.terminal import print_headline, show

    scale = units_in(units)
    mass = None if mass_kg is None else positive("--mass-kg", mass_kg, unit="kg")
    if len(files) == 1 and files[0].is_dir():
        modes, shapes, where = files[0] / MODES, files[0] / SHAPES, points or files[0] / POINTS
    elif len(files) == 2 and points is not None:
        (modes, shapes), where = files, points
    else:
        raise ValueError(
            "a part is read from a table of modes and a table of shapes, in this order, with `--points FILE`, or from a folder "
            f"with {MODES}, {SHAPES} and {POINTS}; got {len(files)} names."
        )
    part = read_flexible(modes, shapes, where, scale)
    save_flexible(part, out, force=force)
    content = flexible_content(out.name, part, mass=mass)
    show(content)
    print_headline(content.verdict)
    print(plain(f"  written to {out}/"))
    return 0
