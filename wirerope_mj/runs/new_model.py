"""A model's folder from tables: MJCF, isolators, the tables themselves, and a dimensioned drawing."""

import math
import shutil
from collections import Counter
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace
from os.path import isdir  # a path that is too long, or holds NUL, is none
from pathlib import Path
from typing import cast

from wirerope_mj.content.numbers import listed
from wirerope_mj.engine.flexible import Deck
from wirerope_mj.engine.from_tables import Layout, StopLaw, mjcf_of, read_layout
from wirerope_mj.engine.statics import equilibrium
from wirerope_mj.engine.system import System, load_system
from wirerope_mj.engine.system.on_deck import deck_text
from wirerope_mj.foundation.atomic_files import atomic_folder, check_folder
from wirerope_mj.foundation.errors import ConvergenceError, ModelError, RecordError
from wirerope_mj.foundation.resources import models_folder
from wirerope_mj.foundation.xlsx_rows import sheet_names
from wirerope_mj.mounts.isolator import BOTTOM, Isolator, Provenance, bottom_stop
from wirerope_mj.mounts.laws import Stop
from wirerope_mj.mounts.vendor_parts import load_isolator

KIND = "folder of a model"
_MODELS = {
    "cabinet": "cabinet.xml", "floor": "floating_floor.xml", "two-stage": "templates/two_stage.xml",
    "medium-weight-machine": "templates/medium_weight_machine.xml",
}  # fmt: skip
TABLES = ("mounts", "masses", "stops", "points", "forces", "envelope")


def is_folder_of_tables(folder: Path) -> bool:
    """Tell whether a folder holds the tables of a model, and no model that was made of them."""
    return isdir(folder) and not any(folder.glob("*.xml")) and any(folder.glob("mounts.*"))


def tables_in(source: Path) -> dict[str, Path]:
    """Return the tables of a model in a folder, files named after `TABLES`, or in a workbook, whose sheets are.

    RecordError if the workbook cannot be read, or there is no table of mounts or of masses.
    """
    if source.is_dir():
        files = sorted(file for file in source.iterdir() if file.suffix.lower() in (".csv", ".xlsx", ".xlsm", ".txt", ".urdf"))
        tables = {file.stem.lower(): file for file in files if file.stem.lower() in TABLES}
    else:
        tables = {name: source for name in sheet_names(source) if name in TABLES}
    if missing := [kind for kind in TABLES[:2] if kind not in tables]:
        raise RecordError(
            f"{source}: there is no table {' and none '.join(missing)}. A folder holds mounts.csv, a workbook a sheet mounts; "
            f"the tables are {', '.join(TABLES)}, and the first two are needed."
        )
    return tables


@dataclass(frozen=True, kw_only=True, eq=False)
class BuiltModel:
    """A model that was made from tables."""

    layout: Layout  # what the tables say, gaps of installed stops included
    system: System  # the loaded model

    @property
    def mjcf(self) -> str:
        return self.system.mjcf

    @property
    def isolators(self) -> Mapping[str, Isolator]:
        """Isolators by their names in the model, stops and brackets included."""
        return self.system.isolators


def build_model(
    name: str, tables: Mapping[str, Path], *, model: str = "", products: str = "", deck: Deck | None = None,
    bottoming: bool = True,
) -> BuiltModel:  # fmt: skip
    """Build the model of a payload called `name` from tables, as `new_model` takes them, without writing anything.

    RecordError if a table is wrong; ModelError if an isolator or the model is wrong.
    """
    layout = read_layout(name, tables, products=products)
    if bottoming:
        devices = {mount.device: load_isolator(layout.isolators[mount.isolator]) for mount in layout.mounts}
        ends = {device: bottom_stop(isolator) for device, isolator in devices.items()}
        layout = replace(layout, bottoms={device: stop for device, stop in ends.items() if stop is not None})
    stops = {f"bottom_{mount.name}": mount.name for mount in layout.mounts if mount.device in layout.bottoms}
    written = {stop.isolator for stop in layout.stops if stop.law is not None}  # files of stops, with the model
    written |= {f"{BOTTOM}{device}" for device in layout.bottoms}
    for placed in (*layout.mounts, *layout.stops):
        if placed.name in stops:
            raise RecordError(
                f'{placed.location}: the stop where mount "{stops[placed.name]}" goes solid is called "{placed.name}". Give '
                "this one another name, or leave the stops where mounts go solid out (--no-bottoming)."
            )
        if placed.law is None and placed.isolator in written:
            raise RecordError(
                f'{placed.location}, column "isolator": "{placed.isolator}" is the name of a file that is written for a stop '
                "of this model. Rename the isolator's file."
            )
    return model_of(layout, model=model, deck=deck)


def model_of(layout: Layout, *, model: str = "", deck: Deck | None = None) -> BuiltModel:
    """Load the model of a layout; stops with gaps as installed are set from its equilibrium."""
    text = mjcf_of(layout, model or layout.name)
    system = load_system(text, isolators=_isolators_of(layout))
    if any(stop.law is not None and stop.law.rest is not None for stop in layout.stops):
        try:
            loads = equilibrium(system).mounts
        except ConvergenceError as error:
            raise RecordError(f"gaps as installed need a position at rest, and there is none: {error}") from None
        stops = []
        for stop in layout.stops:
            if stop.law is not None and stop.law.rest is not None:
                roll, shear, axial = (loads[stop.name].deflection.round(6) + 0.0).tolist()  # of -0.0 it makes 0
                stop = replace(stop, law=replace(stop.law, rest=(roll, shear, axial)))
            stops.append(stop)
        layout = replace(layout, stops=tuple(stops))
        system = load_system(text, isolators=_isolators_of(layout))
    if deck is not None:
        system = load_system(deck_text(system, deck), isolators=system.isolators)
    return BuiltModel(layout=layout, system=system)


def new_model(
    folder: Path, tables: Mapping[str, Path], *, name: str | None = None, products: str = "",
    deck: Deck | None = None, bottoming: bool = True, formats: Sequence[str] = ("png",), force: bool = False,
) -> Layout:  # fmt: skip
    """Write the folder of a model from tables and return what they say.

    It holds MODEL.xml, MODEL being its last part, the isolators as used, the tables, and MODEL_plan in each of the
    `formats`: "png", "pdf", "svg". The model has been loaded before the folder stands. Tables are CSV files or workbooks,
    by their names in `TABLES`, as `read_layout` reads them; `name` is the payload's, by default the model's;
    `products` is the notation of products of inertia, as `read_layout` has it; a `deck` is what the
    mounts stand on in place of a rigid one. With `bottoming` a stop stands at each mount where its isolator goes solid, as far
    as that is known, see `wirerope_mj.mounts.isolator.device.bottom_stop`.

    RecordError if a table is wrong, or the folder cannot be written; ModelError if an isolator or the model is wrong;
    nothing is written then.
    """
    called = folder.resolve().name
    check_folder(folder, force=force, kind=KIND, marks=marks(called))
    built = build_model(name or called, tables, model=called, products=products, deck=deck, bottoming=bottoming)
    with atomic_folder(folder, force=force, kind=KIND, marks=marks(called)) as temporary:
        (temporary / "isolators").mkdir()
        for isolator, device in built.isolators.items():
            device.save(temporary / "isolators" / f"{isolator}.toml")
        model = temporary / f"{called}.xml"
        model.write_text(built.mjcf, encoding="utf-8")
        load_system(model)
        (temporary / "tables").mkdir()
        used = Counter(tables.values())
        for kind, table in tables.items():
            copy = table.name if used[table] > 1 else f"{kind}{table.suffix.lower()}"
            shutil.copyfile(table, temporary / "tables" / copy)
        for ending in formats:
            from wirerope_mj.views.plots.model_plan import save_plan

            save_plan(built.layout, temporary / f"{called}_plan.{ending}")
    return built.layout


def from_template(
    folder: Path, template: str, *, deck: Deck | None = None, bottoming: bool = True, formats: Sequence[str] = ("png",),
    force: bool = False,
) -> Layout | None:  # fmt: skip
    """Write the folder of a model to be edited: with "genset" tables and their model, else a template's commented model.

    Returns:
        The layout where the template is one of tables, else None.
    """
    if template == "genset":
        tables = tables_in(models_folder() / "templates" / "genset")
        return new_model(folder, tables, deck=deck, bottoming=bottoming, formats=formats, force=force)
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
        system = load_system(target)
        if deck is not None:
            target.write_text(deck_text(system, deck), encoding="utf-8")
            load_system(target)
    return None


def marks(name: str) -> tuple[str, ...]:
    return (f"{name}.xml",)


def _isolators_of(layout: Layout) -> dict[str, Isolator]:
    """Load the isolators of a layout by their names in the model: mounts, stops, and ends of travel."""
    devices = {name: load_isolator(file) for name, file in layout.isolators.items()}
    isolators = devices | {f"{BOTTOM}{bottoming}": stop for bottoming, stop in layout.bottoms.items()}
    for mount in layout.mounts:
        if mount.bracket is not None:
            isolators[mount.device] = replace(devices[mount.isolator], bracket=mount.bracket)
    for unused in devices.keys() - {placed.device for placed in (*layout.mounts, *layout.stops)}:  # all stand on brackets
        del isolators[unused]
    for stop in layout.stops:
        if stop.law is not None:
            try:
                isolators[stop.isolator] = _stop_isolator(stop.law)
            except (ModelError, ValueError) as error:
                raise RecordError(f"{stop.location}: stop {stop.name!r}: {error}") from None
    return isolators


_OPEN = 1.0  # Gap of stops that have not been installed yet [m]: no mount travels as far


def _stop_isolator(law: StopLaw) -> Isolator:
    """Make the isolator of a stop of the table; open while its gaps count from an unknown position at rest."""
    assumed = ["stiffness and damping are those of the table"]
    rest: tuple[float | None, ...] = (None,) * 3 if law.rest is None else law.rest
    unknown = law.rest is not None and math.isnan(law.rest[2])
    if unknown:
        rest = (None,) * 3
    gaps = [gap for gap in (law.gap, law.gap_up, law.gap_across) if gap is not None]
    name = f"Stop, {law.stiffness / 1e6:g} MN/m behind {' / '.join(f'{1e3 * gap:g}' for gap in dict.fromkeys(gaps))} mm"
    if law.gap_across is not None:
        name = f"All-round {name[0].lower()}{name[1:]}"
        assumed.append("across it are two pairs of faces, square to each other")
    if law.rest is not None:
        name += " installed"
        assumed.append("gaps are as installed, at rest under the weight on the first loading, on a rigid deck")

    def acting(gap_below: float | None, gap_above: float | None, rest: float | None) -> Stop | None:
        if gap_below is None and gap_above is None:
            return None
        ends = [gap if gap is None or not unknown else _OPEN for gap in (gap_below, gap_above)]
        return Stop(gap_below=ends[0], gap_above=ends[1], rest=rest, k=law.stiffness, c=law.damping, rounding=law.rounding)

    ways = ((law.gap_across, law.gap_across), (law.gap_across, law.gap_across), (law.gap, law.gap_up))
    roll, shear, axial = (acting(*way, of) for way, of in zip(ways, rest, strict=True))
    stated = Provenance(kind="illustrative", source="table of stops", assumed=tuple(assumed))
    return Isolator(name=name, roll=roll, shear=shear, axial=axial, provenance=stated)


def gaps_text(layout: Layout) -> str:
    """Describe the origin of the gaps of stops, and where mounts go solid; "" without stops."""
    laws = {stop.name: stop.law for stop in layout.stops if stop.law is not None}
    installed = {name: law.rest for name, law in laws.items() if law.rest is not None}
    parts = []
    rises = {stop.name: float(stop.axes[2, 2]) for stop in layout.stops}
    for upright, way in ((True, "gone down by"), (False, "moved along each stop's direction by")):
        moves = {
            name: 1e3 * (-rest[2] if upright else rest[2])
            for name, rest in installed.items() if (rises[name] > 1.0 - 1e-9) == upright
        }  # fmt: skip
        if moves:
            low, high = f"{min(moves.values()):.3g}", f"{max(moves.values()):.3g}"
            far = f"{low} mm" if low == high else f"{low} to {high} mm"
            parts.append(f"gaps of {listed(list(moves))} count at rest, as installed, where the payload has {way} {far}")
    if as_modelled := [name for name in laws if name not in installed]:
        counts = f"gaps of {listed(as_modelled)} count from the unloaded geometry"
        parts.append(f'{counts} (gap_at "installed" in the table of stops counts them at rest)')
    ends = {device: cast(Stop, stop.axial) for device, stop in layout.bottoms.items()}
    for device, stop in ends.items():
        names = listed([f"bottom_{mount.name}" for mount in layout.mounts if mount.device == device])
        straight = f" and is a straight rope at {1e3 * stop.gap_above:.3g} mm of tension (assumed)" if stop.gap_above else ""
        where = layout.bottoms[device].provenance.source.partition(": ")[2]
        solid = f"isolator {device} goes solid at {1e3 * (stop.gap_below or 0.0):.3g} mm of compression ({where}){straight}"
        parts.append(f"{solid}: stops {names} act there with {1e-6 * (stop.k or 0.0):.3g} MN/m (assumed)")
    unknown = [mount.name for mount in layout.mounts if mount.device not in layout.bottoms]
    parts += [f"where {listed(unknown)} {'goes' if len(unknown) == 1 else 'go'} solid is not known"] if ends and unknown else []
    text = "; ".join(parts)
    return text and f"{text[0].upper()}{text[1:]}."
