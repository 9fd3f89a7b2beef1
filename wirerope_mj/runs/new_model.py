"""A model's folder from tables: MJCF, isolators, the tables themselves, and a dimensioned drawing."""

import shutil
from collections import Counter
from collections.abc import Mapping, Sequence
from dataclasses import replace
from pathlib import Path

from wirerope_mj.engine.flexible import Deck
from wirerope_mj.engine.from_tables import Layout, mjcf_of, read_layout
from wirerope_mj.engine.system import load_system
from wirerope_mj.engine.system.on_deck import deck_text
from wirerope_mj.foundation.atomic_files import atomic_folder, check_folder
from wirerope_mj.foundation.errors import ModelError, RecordError
from wirerope_mj.foundation.resources import models_folder
from wirerope_mj.foundation.xlsx_rows import sheet_names
from wirerope_mj.mounts.isolator import Isolator, Provenance
from wirerope_mj.mounts.laws import Stop
from wirerope_mj.mounts.vendor_parts import load_isolator

KIND = "folder of a model"
_MODELS = {
    "cabinet": "cabinet.xml", "floor": "floating_floor.xml", "two-stage": "templates/two_stage.xml",
    "medium-weight-machine": "templates/medium_weight_machine.xml",
}  # fmt: skip
TABLES = ("mounts", "masses", "stops", "points", "forces", "envelope")


def tables_in(source: Path) -> dict[str, Path]:
    """Return the tables of a model in a folder, files named after `TABLES`, or in a workbook, whose sheets are.

    RecordError if the workbook cannot be read, or there is no table of mounts or of masses.
    """
    if source.is_dir():
        files = sorted(file for file in source.iterdir() if file.suffix.lower() in (".csv", ".xlsx", ".xlsm", ".txt"))
        found = {file.stem.lower(): file for file in files if file.stem.lower() in TABLES}
    else:
        found = {name: source for name in sheet_names(source) if name in TABLES}
    if missing := [kind for kind in TABLES[:2] if kind not in found]:
        raise RecordError(
            f"{source}: there is no table {' and none '.join(missing)}. A folder holds mounts.csv, a workbook a sheet mounts; "
            f"the tables are {', '.join(TABLES)}, and the first two are needed."
        )
    return found


def new_model(
    folder: Path, tables: Mapping[str, Path], *, name: str | None = None, products: str = "",
    deck: Deck | None = None, formats: Sequence[str] = ("png",), force: bool = False,
) -> Layout:  # fmt: skip
    """Write the folder of a model from tables and return what they say.

    It holds MODEL.xml, MODEL being its last part, the isolators as used, the tables, and MODEL_plan in each of the
    `formats`: "png", "pdf", "svg". The model has been loaded before the folder stands. Tables are CSV files or workbooks,
    by their names in `TABLES`, as `read_layout` reads them; `name` is the payload's, by default the model's;
    `products` is the notation of products of inertia, as `read_layout` has it; a `deck` is what the
    mounts stand on in place of a rigid one.

    RecordError if a table is wrong, or the folder cannot be written; ModelError if an isolator or the model is wrong;
    nothing is written then.
    """
    called = folder.resolve().name
    check_folder(folder, force=force, kind=KIND, marks=marks(called))
    layout = read_layout(name or called, tables, products=products)
    with atomic_folder(folder, force=force, kind=KIND, marks=marks(called)) as temporary:
        _write_isolators(layout, temporary / "isolators", tables.get("stops"))
        model = temporary / f"{called}.xml"
        model.write_text(mjcf_of(layout, called), encoding="utf-8")
        _loaded(model, deck)
        (temporary / "tables").mkdir()
        used = Counter(tables.values())
        for kind, table in tables.items():
            copy = table.name if used[table] > 1 else f"{kind}{table.suffix.lower()}"
            shutil.copyfile(table, temporary / "tables" / copy)
        for ending in formats:
            from wirerope_mj.views.plots.model_plan import save_plan

            save_plan(layout, temporary / f"{called}_plan.{ending}")
    return layout


def from_template(
    folder: Path, template: str, *, deck: Deck | None = None, formats: Sequence[str] = ("png",), force: bool = False
) -> Layout | None:
    """Write the folder of a model that one edits: tables and model of "genset", the commented model of the others.

    Returns:
        The layout where the template is one of tables, else None.
    """
    if template == "genset":
        tables = tables_in(models_folder() / "templates" / "genset")
        return new_model(folder, tables, deck=deck, formats=formats, force=force)
    from xml.etree import ElementTree as ET

    source = models_folder() / _MODELS[template]
    name = folder.resolve().name
    with atomic_folder(folder, force=force, kind=KIND, marks=marks(name)) as temporary:
        target = temporary / f"{name}.xml"
        shutil.copyfile(source, target)
        (temporary / "isolators").mkdir()
        for text in ET.parse(source).iter("text"):
            if (isolator := text.get("data", "")).startswith("isolators/"):
                shutil.copyfile(models_folder() / isolator, temporary / isolator)
        _loaded(target, deck)
    return None


def _loaded(model: Path, deck: Deck | None) -> None:
    """Load a model that was written, and put it on a deck that bends if there is one."""
    system = load_system(model)
    if deck is not None:
        model.write_text(deck_text(system, deck), encoding="utf-8")
        load_system(model)


def marks(name: str) -> tuple[str, ...]:
    return (f"{name}.xml",)


def _write_isolators(layout: Layout, folder: Path, stops: Path | None) -> None:
    folder.mkdir()
    for name, file in layout.isolators.items():
        load_isolator(file).save(folder / f"{name}.toml")
    for mount in layout.mounts:
        if mount.bracket is not None:
            device = load_isolator(layout.isolators[mount.isolator])
            replace(device, bracket=mount.bracket).save(folder / f"{mount.device}.toml")
    for stop in layout.stops:
        if (law := stop.law) is not None:
            assumed = ("stiffness and damping are those of the table",)
            stated = Provenance(kind="illustrative", source="table of stops", assumed=assumed)
            name = f"Stop, {law.stiffness / 1e6:g} MN/m behind {1e3 * law.gap:g} mm"
            try:
                axial = Stop(gap_below=law.gap, k=law.stiffness, c=law.damping, rounding=law.rounding)
                Isolator(name=name, axial=axial, provenance=stated).save(folder / f"{stop.isolator}.toml")
            except (ModelError, ValueError) as error:
                raise RecordError(f"{stops}: stop {stop.name!r}: {error}") from None
