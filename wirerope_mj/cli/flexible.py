"""`wirerope flexible`: the modes of a deck or of equipment from a finite-element program, checked, as a part for models."""

from pathlib import Path

from wirerope_mj.cli.options import Flag, Force


def flexible(
    files: list[Path], *, units: str, out: Path, points: Path | None = None, mass_kg: float | None = None, damping: float = 2.0,
    highest_hz: float | None = None, residual: Flag = False,
    force: Force = False,
) -> int:  # fmt: skip
    """Read the modes of a deck or of equipment, check them, and write them as a part that models bend by.

    OP4 files (.op4), or OP2 files of matrices (.op2), hold K and M of a Craig-Bampton reduction: 6 or 3 coordinates of each
    row of the table of points, then modes of unit modal mass; points that a column "held" says yes of are fixed to the base.
    Universal files (.unv, dataset 55) and Nastran's punch text (.pch), listing (.f06) and OP2 files of modes hold eigenvectors
    of unit modal mass at nodes, which a column "node" names where points are called otherwise. CSV tables are modes with mode,
    frequency_Hz, damping, participation_x, participation_y, participation_z, and shapes with point, mode, x, y, z; the former
    beside eigenvectors says the participations of a deck.

    A deck's modes are those with its edge held, and its participations Phi^T M r; equipment has free-free modes without the
    six rigid ones, and no participation. Residual vectors of the mounts' points and of a motion of the base are modes like
    others; --residual makes them from what --highest-hz leaves out. wirerope shock MODEL --deck PART puts a model on the part.

    Args:
        files: OP4 or OP2 files of matrices; eigenvectors and perhaps a table of modes; table of modes, then of shapes; or a
            folder of the tables.
        units: of length, mass and time in the finite-element model: mm,t,s or m,kg,s.
        out: folder of the part.
        points: table of points, in the axes of the body that bends; columns x_m, y_m, z_m are metres in any units. Or bulk
            text (.bdf, .dat, .nas) whose grid points are the points of the eigenvectors.
        mass_kg: of the whole part, of which the modes should bring along 90 %; matrices say it.
        damping: damping ratio of modes without one [%].
        highest_hz: leave out modes above this frequency, which ask for small steps.
        residual: keep the static compliance of the modes that are left out, as a few residual vectors.
    """
    from wirerope_mj.content.decks import flexible_content
    from wirerope_mj.engine.flexible import import_part, save_flexible
    from wirerope_mj.engine.flexible.files import units_in
    from wirerope_mj.foundation.arguments import between, positive
    from wirerope_mj.foundation.plain_text import plain
    from wirerope_mj.views.terminal import print_headline, show

    if residual and highest_hz is None:
        raise ValueError("--residual keeps what --highest-hz leaves out; say --highest-hz, too.")
    mass = None if mass_kg is None else between("--mass-kg", mass_kg, 1e-3, 1e9)
    part, own_mass = import_part(files, points, units_in(units), damping=0.01 * damping)
    whole = part
    if highest_hz is not None:
        part = part.below(positive("--highest-hz", highest_hz, unit="Hz"), residual=residual)
    save_flexible(part, out, force=force)
    content = flexible_content(out.name, part, mass=own_mass if mass is None else mass, whole=whole)
    show(content)
    print_headline(content.verdict)
    print(plain(f"  written to {out}/"))
    return 0
