"""A job: load cases of one installation, their limits and the document that they make, read from one TOML file."""

import re
from collections.abc import Iterator
from dataclasses import asdict, dataclass, fields
from datetime import date
from difflib import get_close_matches
from pathlib import Path

from wirerope_mj.content.blocks import TEXTS, Document, Revision
from wirerope_mj.content.job import REPORTED
from wirerope_mj.engine.from_tables.sheet import PURE, TEXT, read_sheet
from wirerope_mj.engine.simulation.simulate import check_arguments, check_direction, duration_of
from wirerope_mj.engine.system import System, load_system
from wirerope_mj.foundation.arrays import Entries
from wirerope_mj.foundation.errors import ModelError, RecordError, WireRopeError
from wirerope_mj.foundation.payload_limits import PayloadLimit, limit_from_text
from wirerope_mj.foundation.plain_text import quoted, short
from wirerope_mj.foundation.regular_files import regular
from wirerope_mj.foundation.resources import model_source
from wirerope_mj.foundation.summary import Summarised
from wirerope_mj.foundation.toml_file import read_toml
from wirerope_mj.motions.spoken import SPOKEN_MOTIONS
from wirerope_mj.runs.said_motion import PLAYED, said_motion, with_dwells_found
from wirerope_mj.runs.scenario import Scenario
from wirerope_mj.runs.scenario_file import judged_by

KIND = "file of a job"
QUESTION = "Does the equipment keep its limits, and do the mounts keep theirs, under every load case?"

_SIMULATE: Entries = {"duration": float, "initial": str, "sample_rate": float, "accuracy": float, "timestep": float}
_RECORD: Entries = {"channels": list, "direction": str} | dict.fromkeys(PLAYED, float) | {
    "baseline": str, "gaps": str, "unit": str,
}  # fmt: skip
_CASE: Entries = {
    "name": str, "note": str, **dict.fromkeys(SPOKEN_MOTIONS, list), "levels": list, "record": str, **_RECORD, **_SIMULATE,
}  # fmt: skip
_JOB: Entries = {
    "name": str, "question": str, "model": str, "report": list, "combined_travel": bool, "sheet": str, "case": list,
    "records": dict, "simulate": dict, "limits": dict, "document": dict,
}  # fmt: skip
# Columns of a sheet of cases besides their names.
_IN_SHEETS = {"duration": "time", "start": "time"} | {
    name: PURE if kind is float else TEXT
    for name, kind in _CASE.items()
    if name not in ("name", "duration", "start", "sample_rate", "highpass", "resample", "accuracy", "timestep")
}


@dataclass(frozen=True, kw_only=True)
class LoadCase:
    """A load case."""

    name: str  # as it is called everywhere
    folder: str  # name of its run's folder
    note: str  # what it is from, such as a clause of a standard
    scenario: Scenario  # what is simulated


@dataclass(frozen=True, kw_only=True, repr=False)
class Job(Summarised):
    """Load cases of one installation and what is written of them."""

    name: str  #: its title
    question: str  #: what the job answers
    cases: tuple[LoadCase, ...]  #: in the order of the file
    report: tuple[str, ...]  #: what each case shows, names of `content.job.REPORTED`
    document: Document | None  #: data of the document; None for a plain report
    path: Path  #: of the file

    def _summary(self) -> tuple[str, dict[str, str]]:
        return f"Job {self.name}", {case.name: case.scenario.motion.description for case in self.cases}


def load_job(path: str | Path) -> Job:
    """Load a job: model, load cases, limits, what is reported, and the document's data.

    Raises:
        ModelError: the file, its model, a limit or a case is not what it must be; names the table and the key.
        RecordError: a file that it names cannot be read.
    """
    path = Path(path)
    content = read_toml(path, KIND)
    checked(content, _JOB, f"{path}")
    if "model" not in content:
        raise ModelError(f'{path}: `model` is missing: the path of a model or the name of one that ships, model = "cabinet".')
    source = model_source(content["model"], folder=path.resolve().parent, asker=str(path))
    limits = tuple(_limits(path, content.get("limits", {})))
    combined = content.get("combined_travel", True)
    try:
        system = judged_by(load_system(source), combined_travel=combined, limits=limits)
    except WireRopeError as error:
        raise type(error)(f"{path}: {error}") from None
    every = content.get("simulate", {})
    checked(every, _SIMULATE, f"{path}, [simulate]")
    question = content.get("question", QUESTION)
    cases: list[LoadCase] = []
    for where, folder, table in _tables(path, content):
        checked(table, _CASE, where)
        name = table.get("name", "")
        slug = re.sub(r"\W+", "-", name).strip("-").lower()
        if not slug:
            raise ModelError(f'{where}: `name` is missing: it names the case and its folder, name = "vertical shock".')
        if any(other.folder == slug for other in cases):
            raise ModelError(f"{where}: {quoted(name)} is given twice; names of cases must differ by a letter or a digit.")
        said = _scenario(f"{where} {quoted(name)}", every | table, folder, system)
        made = Scenario(question=question, model=source, name=name, limits=limits, combined_travel=combined, **said)
        cases.append(LoadCase(name=name, folder=slug, note=table.get("note", ""), scenario=made))
    if not cases:
        raise ModelError(
            f'{path}: there is no load case; one is [[case]] with a name and a motion, such as half-sine = "15 g 11 ms z", or '
            "comes from a `sheet` or from [records]."
        )
    return Job(
        name=content.get("name", path.stem), question=question, cases=tuple(cases), report=_report(path, content),
        document=read_document(content["document"], path) if "document" in content else None, path=path,
    )  # fmt: skip


def _limits(path: Path, table: Entries) -> Iterator[PayloadLimit]:
    for key, value in table.items():
        if not isinstance(value, str):
            raise ModelError(f'{path}, [limits]: `{short(key)}` must be a text such as "15 g", got {quoted(value)}.')
        try:
            yield limit_from_text(f"{key} = {value}")
        except ValueError as error:
            raise ModelError(f'{path}, [limits]: {error} Here it is "acceleration/rack" = "15 g".') from None


def _report(path: Path, content: Entries) -> tuple[str, ...]:
    names = tuple(_texts(content.get("report", list(REPORTED[:7]))))
    for name in names:
        if name not in REPORTED:
            raise ModelError(f"{path}: `report` may hold {', '.join(REPORTED)}, got {quoted(name)}.")
    return names


def _tables(path: Path, content: Entries) -> Iterator[tuple[str, Path, Entries]]:
    """Yield place, folder of its files, and table of each case: of the file, of its sheet, of its directory of records."""
    folder = path.parent
    for number, table in enumerate(content.get("case", []), start=1):
        if not isinstance(table, dict):
            raise ModelError(f"{path}: cases are tables [[case]], got {quoted(table)}.")
        yield f"{path}, case {number}", folder, table
    if "sheet" in content:
        sheet = folder / content["sheet"]
        for row in read_sheet(sheet, kind="sheet of load cases", needed={"name": TEXT}, further=_IN_SHEETS):
            given = {name: kind for name, kind in _IN_SHEETS.items() if row.has(name)}
            cells = {name: row.text(name) if kind == TEXT else row.number(name) for name, kind in given.items()}
            yield row.location, sheet.parent, {"name": row.text("name")} | cells
    if "records" in content:
        yield from _records(path, content["records"])


def _records(path: Path, table: Entries) -> Iterator[tuple[str, Path, Entries]]:
    """Yield a case for each record that a pattern finds."""
    where = f"{path}, [records]"
    checked(table, {"files": str, "note": str, **_RECORD, **_SIMULATE}, where)
    pattern = table.get("files", "")
    if not pattern or Path(pattern).is_absolute():
        raise ModelError(f'{where}: `files` must be a pattern below the folder of the job, such as "records/*.csv".')
    found = sorted(path.parent.glob(pattern))
    if not found:
        raise RecordError(f"{where}: no file matches `files` = {pattern!r} in {path.resolve().parent}.")
    shared = {key: value for key, value in table.items() if key != "files"}
    for file in found:
        yield where, path.parent, {"name": file.stem, "record": str(file.relative_to(path.parent)), **shared}


def _scenario(where: str, table: Entries, folder: Path, system: System) -> Entries:
    """Return motion, simulation and options of a case's scenario."""
    phrases = [(kind, text) for kind in SPOKEN_MOTIONS for text in _texts(table.get(kind, []))]
    levels = [folder / file for file in _texts(table.get("levels", []))]
    record = folder / table["record"] if "record" in table else None
    if not (phrases or levels or record):
        raise ModelError(
            f'{where}: it says no motion: one of {", ".join(SPOKEN_MOTIONS)}, such as half-sine = "15 g 11 ms z", `levels` or '
            "`record`."
        )
    if "accuracy" in table and "timestep" in table:
        raise ModelError(f"{where}: `accuracy` and `timestep` exclude each other: give one.")
    played = {name: table[name] for name in PLAYED if name in table}
    if played and record is None:
        raise ModelError(f"{where}: `{next(iter(played))}` belongs to a `record`.")
    channels = _texts(table["channels"]) if "channels" in table else None
    try:
        phrases = with_dwells_found(phrases, system, folder=folder)
        motion = said_motion(
            phrases, levels=levels, record=record, channels=channels, direction=table.get("direction"), played=played,
            duration=table.get("duration"), folder=folder,
        )  # fmt: skip
        duration = duration_of(motion, table.get("duration"), system)
        check_direction(system, motion)
        check_arguments(**{name: table.get(name) for name in ("accuracy", "timestep", "sample_rate")})
    except (WireRopeError, ValueError) as error:
        kind = type(error) if isinstance(error, WireRopeError) else ModelError
        raise kind(f"{where}: {error}") from None
    table |= {kind: [text for one, text in phrases if one == kind] for kind, _ in phrases}
    options = {
        name: "; ".join(_texts(table[name])) if _CASE[name] is list else table[name]
        for name in _CASE
        if name in table and name not in ("name", "note", *_SIMULATE)
    }
    simulate = {name: table[name] for name in _SIMULATE if name in table}
    return {"motion": motion, "options": options, "simulate": simulate | {"duration": duration}}


def _texts(value: str | list[str]) -> list[str]:
    return [value] if isinstance(value, str) else value


_LINES = tuple(one.name for one in fields(Document) if one.name not in ("logo", "history", "texts"))
_PICTURES = {b"\x89PNG\r\n\x1a\n": ".png", b"\xff\xd8\xff": ".jpg"}
_SAID = {
    str: "a text", float: "a number", bool: "true or false", list: "a text or a list of texts", dict: "a table",
    date: "a date or a text",
}  # fmt: skip


def checked(table: Entries, known: Entries, where: str) -> None:
    """Raise ModelError unless a table has known keys with values of their kinds; a list is one of texts, or of tables."""
    for key, value in table.items():
        if key not in known:
            near = get_close_matches(key, known, n=1)
            meant = f" Did you mean `{near[0]}`?" if near else ""
            raise ModelError(f"{where}: `{short(key)}` is unknown; known: {', '.join(known)}.{meant}")
        kind = known[key]
        right = {
            float: isinstance(value, int | float) and not isinstance(value, bool),
            list: isinstance(value, str) or (isinstance(value, list) and all(isinstance(one, str | dict) for one in value)),
            date: isinstance(value, str | date),
        }.get(kind, isinstance(value, kind))
        if not right:
            raise ModelError(f"{where}: `{key}` must be {_SAID[kind]}, got {quoted(value)}.")


def read_document(table: Entries, path: Path) -> Document:
    """Read the data of a document; a logo lies relative to the file at `path`.

    ModelError if a key is unknown or of another kind, or the logo is no PNG or JPEG; names it.
    """
    where = f"{path}, [document]"
    kinds = dict.fromkeys(_LINES, str) | {"date": date}
    checked(table, kinds | {"logo": str, "history": list, "text": dict}, where)
    checked(table.get("text", {}), dict.fromkeys(TEXTS, str), f"{where}, text")
    revisions = []
    for number, row in enumerate(table.get("history", []), start=1):
        if not isinstance(row, dict):
            raise ModelError(f"{where}: `history` must be tables [[document.history]], got {quoted(row)}.")
        known = {one.name: date if one.name == "date" else str for one in fields(Revision)}
        checked(row, known, f"{where}, history {number}")
        if "revision" not in row:
            raise ModelError(f"{where}, history {number}: `revision` is missing.")
        revisions.append(Revision(**{name: str(value) for name, value in row.items()}))
    logo = path.parent / table["logo"] if "logo" in table else None
    if logo is not None:
        logo_ending(logo, where)
    lines = {name: str(table[name]) for name in _LINES if name in table}
    return Document(**lines, logo=logo, history=tuple(revisions), texts=dict(table.get("text", {})))


def logo_ending(logo: Path, where: str) -> str:
    """Return ".png" or ".jpg" by what a picture's file begins with; ModelError if it is neither."""
    try:
        with regular(logo).open("rb") as file:
            begins = file.read(8)
    except OSError:
        raise ModelError(f"{where}: there is no file {str(logo)!r} for `logo`.") from None
    ending = next((ending for mark, ending in _PICTURES.items() if begins.startswith(mark)), "")
    if not ending:
        raise ModelError(f"{where}: `logo` must be a PNG or JPEG file, and {logo} is neither.")
    return ending


def document_table(document: Document, logo: str) -> Entries:
    """Return the table of a document as `read_document` reads it; `logo` is the name of the logo's copy."""
    table: Entries = {name: getattr(document, name) for name in _LINES if getattr(document, name)}
    table |= {"logo": logo} if logo else {}
    table |= {"history": [asdict(one) for one in document.history]} if document.history else {}
    return table | ({"text": dict(document.texts)} if document.texts else {})
