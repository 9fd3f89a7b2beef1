"""A job: load cases of one installation, their limits and the document that they make, read from one TOML file."""

import re
from collections.abc import Iterator
from dataclasses import asdict, dataclass, field, fields, replace
from pathlib import Path
from typing import Annotated, Literal

from wirerope_mj.content.blocks import Document
from wirerope_mj.content.job import REPORTED
from wirerope_mj.engine.flexible import deck_of
from wirerope_mj.engine.from_tables.layout import NAME, Layout
from wirerope_mj.engine.from_tables.sheet import PURE, TEXT, Row, read_sheet
from wirerope_mj.engine.simulation.simulate import check_arguments, check_direction, duration_of
from wirerope_mj.engine.system import System, load_system, with_rotation
from wirerope_mj.engine.system.on_deck import deck_text
from wirerope_mj.foundation.arrays import Entries
from wirerope_mj.foundation.errors import ModelError, RecordError, WireRopeError
from wirerope_mj.foundation.faults import Faults, each, reworded
from wirerope_mj.foundation.payload_limits import PayloadLimit, limit_from_text
from wirerope_mj.foundation.plain_text import quoted
from wirerope_mj.foundation.regular_files import regular
from wirerope_mj.foundation.resources import model_source
from wirerope_mj.foundation.schema import example
from wirerope_mj.foundation.structure import Among, Key, Place, structure
from wirerope_mj.foundation.summary import Summarised
from wirerope_mj.foundation.toml_file import read_toml
from wirerope_mj.motions.registry import SPOKEN_MOTIONS
from wirerope_mj.mounts.isolator import isolators_at
from wirerope_mj.runs.new_model import build_model, is_folder_of_tables, tables_in
from wirerope_mj.runs.said_motion import PLAYED, listed_phrases, said_motion, with_dwells_found
from wirerope_mj.runs.scenario import Scenario
from wirerope_mj.runs.scenario_file import judged_by

KIND = "file of a job"
QUESTION = "Does the equipment keep its limits, and do the mounts keep theirs, under every load case?"

Texts = str | tuple[str, ...]


@dataclass(frozen=True, kw_only=True)
class Simulated:
    """How cases are simulated."""

    duration: Annotated[float | None, example(0.5)] = None  #: length [s]
    initial: Annotated[Literal["settled", "relaxed", "unloaded"] | None, example("settled")] = None  #: state that it begins in
    sample_rate: Annotated[float | None, example(2000.0)] = None  #: samples a second [Hz]
    accuracy: Annotated[float | None, example(1e-4)] = None  #: of peaks, by which the step is chosen
    timestep: Annotated[float | None, example(1e-4)] = None  #: step [s], in place of an accuracy


@dataclass(frozen=True, kw_only=True)
class Played(Simulated):
    """How a measured record is played, and how its case is simulated."""

    note: Annotated[str, example("Specification 4711, clause 5.1")] = ""  #: such as a clause of a standard
    channels: Annotated[Texts | None, example("A1=z")] = None  #: those to use, NAME=DIRECTION, or one with a direction
    direction: Annotated[str | None, example("z")] = None  #: of a record of one channel
    scale: Annotated[float | None, example(1.5)] = None  #: factor on it
    baseline: Annotated[str | None, example("mean")] = None  #: what is taken off
    start: Annotated[float | None, example(0.05)] = None  #: instant at which it begins [s]
    highpass: Annotated[float | None, example(1.0)] = None  #: frequency below which nothing is kept [Hz]
    resample: Annotated[float | None, example(1000.0)] = None  #: samples a second [Hz]
    gaps: Annotated[str | None, example("fill")] = None  #: "refuse" or "fill"
    unit: Annotated[str | None, example("g")] = None  #: of its samples
    rotation: Annotated[str | None, example("base")] = None  #: axes of columns that turn the base: "base" or "world"
    fade: Annotated[float | None, example(1.0)] = None  #: length of a smooth rise and fall [s]
    #: place of its sensors from the base's own origin [m], where the base turns
    sensors_at: Annotated[tuple[float, float, float] | None, example([0.0, 0.0, 0.3])] = None
    columns: Annotated[str | None, example("time [s], z [g]")] = None  #: of a text of numbers alone
    #: time from row to row of a text of numbers alone without a time [s]
    interval: Annotated[float | None, example(0.005)] = None


@dataclass(frozen=True, kw_only=True)
class Case(Played):
    """A load case of a job: its name and the motions of the base, which are added."""

    name: Annotated[str, example("vertical shock")] = ""  #: it names its folder, too
    #: in the words of the option of `wirerope shock`, one or several that are added
    phrases: Annotated[dict[str, Texts], Among(SPOKEN_MOTIONS)] = field(default_factory=dict)
    levels: Annotated[Texts, example("levels.toml")] = ()  #: files of levels
    record: Annotated[str | None, example("record.csv")] = None  #: a measured record

    @property
    def stated(self) -> Entries:
        """Settings of the motion that the case states, in the order of a run's folder."""
        phrases = {kind: self.phrases[kind] for kind in SPOKEN_MOTIONS if kind in self.phrases}
        rest = {name: getattr(self, name) for name in ("levels", "record", "channels", "direction", *PLAYED)}
        return phrases | {name: value for name, value in rest.items() if value not in (None, ())}


@dataclass(frozen=True, kw_only=True)
class Records(Played):
    """A case for each record that a pattern finds."""

    files: Annotated[str, example("records/*.csv")] = ""  #: pattern below the folder of the job, such as "records/*.csv"


@dataclass(frozen=True, kw_only=True)
class JobFile:
    """A job: load cases of one installation, their limits, and the document that they make."""

    #: path of a model or of a folder with the tables of one, relative to the file, or the name of one that ships
    model: Annotated[str, example("shock_table")] = ""
    name: Annotated[str | None, example("Camera on four mounts")] = None  #: title of the document
    question: str = QUESTION  #: what it answers
    report: Texts = REPORTED[:7]  #: what each case shows
    combined_travel: bool = True  #: whether the travels along all axes are judged together, by the in-house rule
    deck: Annotated[str | None, example("10 Hz 800 kg 4 %")] = None  #: a flexible deck under all mounts, as `--deck`
    temperature: Annotated[str | None, example("-20 degC")] = None  #: of the isolators, whose files state factors for it
    sheet: Annotated[str | None, example("cases.csv")] = None  #: CSV or XLSX file with a case in each row
    cases: Annotated[tuple[Case, ...], Key("case")] = ()
    records: Records | None = None
    simulate: Simulated = Simulated()  #: for all cases that do not say it themselves
    limits: Annotated[dict[str, str], example({"acceleration/carriage": "15 g"})] = field(
        default_factory=dict
    )  #: as `--limit`: "acceleration/rack" = "15 g"
    document: Document | None = None

    def __post_init__(self) -> None:
        if not self.model:
            raise ValueError('`model` is missing: the path of a model or the name of one that ships, model = "cabinet".')
        for name in _texts(self.report):
            if name not in REPORTED:
                raise ValueError(f"`report` may hold {', '.join(REPORTED)}, got {quoted(name)}.")


_SIMULATE = tuple(item.name for item in fields(Simulated))
# Columns of a sheet of cases besides their names.
_IN_SHEETS = {"duration": "time", "start": "time", "interval": "time", "scale": PURE} | dict.fromkeys(
    [
        "note", *SPOKEN_MOTIONS, "levels", "record", "channels", "direction", "baseline", "gaps", "unit", "columns", "rotation",
        "initial",
    ], TEXT,
)  # fmt: skip


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
    system: System = field(repr=False)  #: its model, with the job's limits
    layout: Layout | None = field(repr=False)  #: of a model that is a folder of tables

    def _summary(self) -> tuple[str, dict[str, str]]:
        return f"Job {self.name}", {case.name: case.scenario.motion.description for case in self.cases}


def load_job(path: str | Path) -> Job:
    """Load a job: model, load cases, limits, what is reported, and the document's data.

    Raises:
        ModelError: the file, its model, a limit or a case is not what it must be; names the table and the key.
        RecordError: a file that it names cannot be read.
    """
    path = Path(path)
    content = structure(JobFile, read_toml(path, KIND), Place(path))
    limits: list[PayloadLimit] = []
    system: System | None = None
    said: dict[str, tuple[Case, Entries]] = {}  # cases with what their scenarios say, by the names of their folders
    with Faults() as faults:  # each of these is checked, whatever is wrong with another
        with faults.apart():
            limits += each(lambda stated: _limit(path, *stated), content.limits.items())
        with faults.apart():
            document = content.document and _with_files(content.document, Place(path, ("document",)))
        with faults.apart():
            system, layout = _model_of(content, path)
        with faults.apart():
            try:
                judged = system and judged_by(system, combined_travel=content.combined_travel, limits=limits)
            except WireRopeError as error:
                raise type(error)(f"{path}: {error}") from None
        for place, folder, case in _cases(path, content):
            with faults.apart():
                slug = re.sub(r"\W+", "-", case.name).strip("-").lower()
                if not slug:
                    raise place.fault('`name` is missing: it names the case and its folder, name = "vertical shock".')
                if slug in said:
                    raise place.fault(f"{quoted(case.name)} is given twice; names of cases must differ by a letter or a digit.")
                every = {name: getattr(content.simulate, name) for name in _SIMULATE if getattr(case, name) is None}
                said[slug] = case, {}  # also of a case that is wrong the name is taken
                said[slug] = case, _scenario(place, replace(case, **every), folder, system)
        if not (said or faults.errors):
            raise ModelError(
                f'{path}: there is no load case; one is [[case]] with a name and a motion, such as half-sine = "15 g 11 ms z", '
                "or comes from a `sheet` or from [records]."
            )
    assert system is not None
    assert judged is not None
    stated = content.temperature is None and content.deck is None and layout is None  # by files that the model names
    shared: Entries = {
        "question": content.question, "model": system.path or system.mjcf, "limits": limits,
        "combined_travel": content.combined_travel, "isolators": None if stated else system.isolators,
    }  # fmt: skip
    cases = tuple(
        LoadCase(name=case.name, folder=slug, note=case.note, scenario=Scenario(name=case.name, **shared, **entries))
        for slug, (case, entries) in said.items()
    )
    return Job(
        name=content.name or path.stem, question=content.question, cases=cases, report=_texts(content.report),
        document=document, path=path, system=judged, layout=layout,
    )  # fmt: skip


def _limit(path: Path, key: str, value: str) -> PayloadLimit:
    try:
        return limit_from_text(f"{key} = {value}")
    except ValueError as error:
        raise Place(path, ("limits",)).fault(f'{error} Here it is "acceleration/rack" = "15 g".') from None


def _model_of(content: JobFile, path: Path) -> tuple[System, Layout | None]:
    """Return the model of a job, and its layout if tables say it."""
    folder, layout = path.resolve().parent, None
    if is_folder_of_tables(folder / content.model):  # whose messages name its files
        built = build_model(NAME, tables_in(folder / content.model))
        system, layout = built.system, built.layout
    try:
        if layout is None:
            system = load_system(model_source(content.model, folder=folder, asker=str(path)))
        if content.temperature is not None:
            try:
                devices = isolators_at(content.temperature, system.isolators)
            except ValueError as error:
                raise ModelError(f"`temperature`: {error}") from None
            system = load_system(system.path or system.mjcf, isolators=devices)
        if content.deck is not None:
            try:
                deck = deck_of(content.deck)
            except ValueError as error:
                raise ModelError(f"`deck`: {error}") from None
            system = load_system(deck_text(system, deck), isolators=system.isolators)
    except WireRopeError as error:
        kind = type(error)
        raise error if str(error).startswith(str(path)) else reworded(error, lambda text: kind(f"{path}: {text}")) from None
    return system, layout


def _cases(path: Path, content: JobFile) -> Iterator[tuple[Place, Path, Case]]:
    """Yield location, folder of files, and table of each case: from the file, its sheet, its directory of records."""
    for number, case in enumerate(content.cases):
        yield Place(path, ("case", number)), path.parent, case
    if content.sheet is not None:
        sheet = path.parent / content.sheet
        rows = read_sheet(sheet, kind="sheet of load cases", needed={"name": TEXT}, further=_IN_SHEETS)
        yield from ((Place(row.location), sheet.parent, case) for row, case in zip(rows, each(_case_of, rows), strict=True))
    if content.records is not None:
        place, pattern = Place(path, ("records",)), content.records.files
        if not pattern or Path(pattern).is_absolute():
            raise place.fault('`files` must be a pattern below the folder of the job, such as "records/*.csv".')
        files = sorted(path.parent.glob(pattern))
        if not files:
            text = f"no file matches `files` = {pattern!r} in {path.resolve().parent}."
            raise replace(place, error=RecordError).fault(text)
        shared = {name: value for name, value in vars(content.records).items() if name != "files"}
        for file in files:
            yield place, path.parent, Case(name=file.stem, record=str(file.relative_to(path.parent)), **shared)


def _case_of(row: Row) -> Case:
    """Read the case in a row of a sheet."""
    stated = {name: kind for name, kind in _IN_SHEETS.items() if row.has(name)}
    cells = {name: row.text(name) if kind == TEXT else row.number(name) for name, kind in stated.items()}
    return structure(Case, {"name": row.text("name")} | cells, Place(row.location))


def _scenario(place: Place, case: Case, folder: Path, system: System | None) -> Entries:
    """Return motion, simulation and options of a case's scenario; without a system only what needs none is checked."""
    phrases = [
        (kind, phrase)
        for kind in SPOKEN_MOTIONS for text in _texts(case.phrases.get(kind, ())) for phrase in listed_phrases(text)
    ]  # fmt: skip
    levels = [folder / file for file in _texts(case.levels)]
    record = folder / case.record if case.record is not None else None
    where = replace(place, error=ModelError)
    if not (phrases or levels or record):
        raise where.fault(
            f'{quoted(case.name)}: it says no motion: one of {", ".join(SPOKEN_MOTIONS)}, such as half-sine = "15 g 11 ms z", '
            "`levels` or `record`."
        )
    if case.accuracy is not None and case.timestep is not None:
        raise where.fault(f"{quoted(case.name)}: `accuracy` and `timestep` exclude each other: give one.")
    stated = case.stated
    played = {name: stated[name] for name in PLAYED if name in stated}
    if played and record is None:
        raise where.fault(f"{quoted(case.name)}: `{next(iter(played))}` belongs to a `record`.")
    channels = _texts(case.channels) if case.channels is not None else None
    try:
        phrases = with_dwells_found(phrases, system, folder=folder) if system is not None else phrases
        motion = said_motion(
            phrases, levels=levels, record=record, channels=channels, direction=case.direction, played=played,
            duration=case.duration, folder=folder,
        )  # fmt: skip
        duration = case.duration
        if system is not None:
            duration = duration_of(motion, case.duration, system)
            check_direction(with_rotation(system) if motion.rotates else system, motion)
        check_arguments(accuracy=case.accuracy, timestep=case.timestep, sample_rate=case.sample_rate)
    except (WireRopeError, ValueError) as error:
        where = replace(place, error=type(error) if isinstance(error, WireRopeError) else ModelError)
        raise reworded(error, lambda text: where.fault(f"{quoted(case.name)}: {text}")) from None
    stated |= {kind: tuple(text for other_kind, text in phrases if other_kind == kind) for kind, _ in phrases}
    lists = (*SPOKEN_MOTIONS, "levels", "channels")
    options = {name: "; ".join(_texts(value)) if name in lists else value for name, value in stated.items()}
    simulate = {name: getattr(case, name) for name in _SIMULATE if getattr(case, name) is not None}
    return {"motion": motion, "options": options, "simulate": simulate | {"duration": duration}}


def _texts(value: Texts) -> tuple[str, ...]:
    return (value,) if isinstance(value, str) else value


_PICTURES = {b"\x89PNG\r\n\x1a\n": ".png", b"\xff\xd8\xff": ".jpg"}


def read_document(table: Entries, path: Path) -> Document:
    """Read the data of a document; logo and template lie relative to the file at `path`.

    ModelError if a key is unknown or of another kind, the logo is no PNG or JPEG, or there is no template; names it.
    """
    place = Place(path, ("document",))
    return _with_files(structure(Document, table, place), place)


def _with_files(document: Document, place: Place) -> Document:
    """Return a document after checking its files; the error names `place`."""
    try:
        files_of(document)
    except ValueError as error:
        raise place.fault(str(error)) from None
    return document


def files_of(document: Document) -> dict[str, str]:
    """Name the copies of a document's files by their keys; ValueError if one is not there, or the logo no PNG or JPEG."""
    names = {}
    for key, file in (("logo", document.logo), ("template", document.template)):
        if file is None:
            continue
        try:
            with regular(file).open("rb") as opened:
                begins = opened.read(8)
        except OSError:
            raise ValueError(f"there is no file {str(file)!r} for `{key}`.") from None
        pictures = (ending for mark, ending in _PICTURES.items() if begins.startswith(mark))
        ending = ".typ" if key == "template" else next(pictures, "")
        if not ending:
            raise ValueError(f"`logo` must be a PNG or JPEG file, and {file} is neither.")
        names[key] = f"{key}{ending}"
    return names


def document_table(document: Document) -> Entries:
    """Return the table of a document for `read_document`, with its files named as their copies beside the table's file."""
    files = files_of(document)
    lines = [item.name for item in fields(Document) if item.name not in ("logo", "template", "history", "texts")]
    table: Entries = {name: getattr(document, name) for name in lines if getattr(document, name)} | files
    table |= {"history": [asdict(one) for one in document.history]} if document.history else {}
    texts = {name: text for name, text in asdict(document.texts).items() if text}
    return table | ({"text": texts} if texts else {})
