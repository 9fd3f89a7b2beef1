"""`wirerope new` and `schemas`: a model from tables or a template, schemas for editors."""

import sys
from pathlib import Path
from typing import Literal

from wirerope_mj.cli.options import Deck, Flag, Force


def new(
    folder: Path,
    *,
    mounts: Path | None = None,
    masses: Path | None = None,
    stops: Path | None = None,
    points: Path | None = None,
    forces: Path | None = None,
    envelope: Path | None = None,
    tables: Path | None = None,
    name: str | None = None,
    template: Literal["cabinet", "floor", "genset", "medium-weight-machine", "two-stage"] | None = None,
    deck: Deck = None,
    products: Literal["tensor", "positive"] | None = None,
    bottoming: bool = True,
    pdf: Flag = False,
    blank: Flag = False,
    force: Force = False,
) -> int:
    """Make a model from tables of mounts, masses, stops and points, or from a template: model, plan, statics.

    Writes FOLDER/NAME.xml, the isolators it uses, the tables, and a dimensioned plan; NAME is the folder's last part. Nothing
    is written where a table is wrong. Exits 1, as `wirerope statics` does, where the model has no equilibrium.

    wirerope new tables --blank, edit the tables in it or delete those of stops and points, wirerope new camera --tables tables

    Args:
        folder: folder to write, such as genset.
        mounts: table (CSV or XLSX): name, x, y, z [mm], isolator, and direction_x, direction_y, direction_z, or inclination
            and azimuth [deg].
        masses: table: name, mass [kg], x, y, z [mm] of the centre of mass, ixx, iyy, izz, ixy, ixz, iyz [kg m^2] about it
            or size_x, size_y, size_z [mm] of a box filled evenly; frequency [Hz], damping [%] and along (x, y, z) of a
            subassembly that rings on its own; rows of totals are left out; a list that a CAD program exports (CSV, XLSX), its
            SolidWorks text (.txt) of one part or several; or a robot's links (.urdf), every joint at 0.
        stops: table: name, x, y, z [mm], gap [mm], stiffness [MN/m], damping [kN s/m], or isolator; a direction as of mounts;
            acts: down, up, up-down or all-round, then perhaps gap_up, gap_across [mm]; gap_at: unloaded or installed.
        points: table: name, x, y, z [mm] of points on the payload to observe.
        forces: table: name, x, y, z [mm] of points at which forces may act, such as a crankshaft's unbalance.
        envelope: table: boxes around the equipment that clearances hold for and that are drawn: name, size_x, size_y, size_z
            [mm], and centre_x, centre_y, centre_z or corner_x, corner_y, corner_z [mm], the lowest along each axis.
        tables: workbook with sheets of these names, or folder with files of these names, in place of one option for each.
        name: of the equipment; the model's by default.
        template: start from a model of the house, without tables; that of genset is made of tables to edit.
        products: sign of the products of inertia: tensor (ixy = -sum x y dm), or positive (+sum x y dm); by default as a text
            of SolidWorks says it, of its columns Lxy positive, of every other table tensor.
        bottoming: put a stop at each mount where its isolator goes solid, and where its rope is straight, as far as known.
        pdf: write the plan as PDF, too.
        blank: write tables of mounts, masses, stops and points into FOLDER to fill in, with every column and its meaning, and
            no model.
    """
    from wirerope_mj.cli.statics import MISSING, statics
    from wirerope_mj.engine.flexible import deck_of
    from wirerope_mj.foundation.errors import ConvergenceError
    from wirerope_mj.foundation.plain_text import plain
    from wirerope_mj.runs.new_model import TABLES, from_template, gaps_text, new_model, tables_in

    if blank:
        given = (mounts, masses, stops, points, forces, envelope, tables, name, template, deck, products, pdf or None)
        if any(option is not None for option in given):
            raise ValueError("`--blank` writes tables to fill in, which goes with `--force` alone.")
        return _write_blank_tables(folder, force=force)
    single = dict(zip(TABLES, (mounts, masses, stops, points, forces, envelope), strict=True))
    found = tables_in(tables) if tables is not None else {}
    found |= {kind: table for kind, table in single.items() if table is not None}
    bends = deck_of(deck) if deck else None
    formats = ("png", "pdf") if pdf else ("png",)
    if template is not None:
        if found or name is not None:
            option = "tables" if tables is not None else next(iter(found), "name")
            raise ValueError(f"`--template` comes with tables of its own: leave out `--{option}`, or `--template`.")
        layout = from_template(folder, template, deck=bends, bottoming=bottoming, formats=formats, force=force)
    elif "mounts" not in found or "masses" not in found:
        raise ValueError(
            "a model is made from `--mounts FILE` and `--masses FILE`, from `--tables` with both, or from `--template "
            "cabinet`, `floor`, `genset`, `medium-weight-machine` or `two-stage`."
        )
    else:
        sign = products or ""
        layout = new_model(
            folder, found, name=name, products=sign, deck=bends, bottoming=bottoming, formats=formats, force=force
        )
    model = folder / f"{folder.resolve().name}.xml"
    print(plain(f"written: {model}" + (f", and its plan {folder.resolve().name}_plan.png" if layout else "")))
    try:
        code = statics(str(model))
    except ConvergenceError as error:  # the model stands, as its tables say it: its mounts are too few or too soft
        print(plain(f"wirerope: {error}"), file=sys.stderr)
        code = MISSING
    if layout is not None and (text := gaps_text(layout)):
        print(plain(f"  {text}"))
    return code


def _write_blank_tables(folder: Path, *, force: bool) -> int:
    """Write a table to fill in of each kind; RecordError, and none is written, if one is there and `force` is not given."""
    from wirerope_mj.cli.isolators import say_written
    from wirerope_mj.engine.from_tables.forms import blank_table
    from wirerope_mj.engine.from_tables.read import COLUMNS
    from wirerope_mj.foundation.atomic_files import atomic_file, check_writable

    folder.mkdir(exist_ok=True)
    for kind in COLUMNS:
        check_writable(folder / f"{kind}.csv", force=force)
    for kind in COLUMNS:
        with atomic_file(folder / f"{kind}.csv") as temporary:
            temporary.write_text(blank_table(kind), encoding="utf-8")
        say_written(folder / f"{kind}.csv")
    return 0


def schemas(folder: Path, *, force: Force = False) -> int:
    """Write JSON Schemas of all TOML files, by which editors complete and check their keys.

    A file names its own in its first line, `#:schema schemas/isolator.json`, as Taplo and the editors that use it read it.

    Args:
        folder: folder to write them to, such as schemas.
    """
    from wirerope_mj.runs.schemas import write_schemas

    for path in write_schemas(folder, force=force):
        print(f"written: {path}")
    return 0
