"""What is wrong or implausible in files, all of it at once: what commands refuse, and what they warn of.

Nothing is judged here: each file is read as the commands read it, and what they say is collected.
"""

import re
import warnings
from collections.abc import Callable, Iterable, Iterator
from dataclasses import dataclass
from functools import partial
from pathlib import Path

from wirerope_mj.assessment.criteria import EXCEEDED, rest_travel_verdicts, rested_verdicts, static_load_verdicts
from wirerope_mj.assessment.criteria.summary import pressed_lines, rested_lines
from wirerope_mj.assessment.criteria.verdict import STATIC_LOAD, TRAVEL, against_limit, by_use
from wirerope_mj.assessment.durability.mission import read_mission
from wirerope_mj.content.numbers import listed
from wirerope_mj.content.statics import RESTED_REMEDY
from wirerope_mj.engine.from_tables.layout import NAME
from wirerope_mj.engine.from_tables.read import read_table
from wirerope_mj.engine.simulation.run import missing_modes
from wirerope_mj.engine.simulation.simulate import duration_of
from wirerope_mj.engine.statics import model_warnings, static_table
from wirerope_mj.engine.system import System, load_system
from wirerope_mj.foundation.errors import (
    AccuracyWarning,
    ModelError,
    ModelWarning,
    RecordWarning,
    StudyWarning,
    WireRopeError,
    error_text,
)
from wirerope_mj.foundation.faults import texts_of
from wirerope_mj.foundation.resources import model_file
from wirerope_mj.foundation.structure import Place
from wirerope_mj.foundation.table_files import read_header
from wirerope_mj.foundation.toml_file import read_toml
from wirerope_mj.foundation.units import ACCELERATION_UNITS
from wirerope_mj.motions import BaseMotion, load_measured, load_record
from wirerope_mj.motions.psd_lines import doubt_of_rms, force_rows, psd_points, psd_rms, spectrum_points, table_lines
from wirerope_mj.motions.records.measured import parse_channel, quantity_of
from wirerope_mj.motions.records.table import moves_a_base
from wirerope_mj.motions.records.uff import is_uff, uff_channels
from wirerope_mj.motions.registry import motion_of_levels
from wirerope_mj.mounts.identification.records import read_tests, rig_warnings
from wirerope_mj.mounts.isolator import read_law
from wirerope_mj.mounts.isolator.implausible import isolator_warnings
from wirerope_mj.mounts.isolator.tables import read_curve
from wirerope_mj.mounts.vendor_parts import load_isolator
from wirerope_mj.mounts.vendor_parts.sheet_fit import fit_datasheet
from wirerope_mj.mounts.vendor_parts.short_sheet import read_short_sheet
from wirerope_mj.runs.file_kinds import KINDS, has_unit, kind_of
from wirerope_mj.runs.folder import warn_of_alterations
from wirerope_mj.runs.job_doubts import job_doubts
from wirerope_mj.runs.job_file import load_job
from wirerope_mj.runs.measured import read_map
from wirerope_mj.runs.new_model import TABLES, build_model, is_folder_of_tables, tables_in
from wirerope_mj.runs.room import in_thin_air, overlapping
from wirerope_mj.runs.scenario import Scenario, load_scenario
from wirerope_mj.runs.scenario_file import is_run, scenario_content, stored_scenario, system_of
from wirerope_mj.runs.study import load_study_file
from wirerope_mj.studies.search.search import Search

_OURS = (ModelWarning, RecordWarning, AccuracyWarning, StudyWarning)
_LOCATION = re.compile(r"(.+?)(?:, ((?:sheet|lines?|row) [^:]+))?: (.+)", re.DOTALL)  # as messages begin
UNKNOWN = "unknown"  # kind of a file whose kind cannot be told
_READ = (".toml", ".xml", ".csv", ".xlsx")  # endings of files of a folder that are named if they cannot be read
_KNOWN = "; ".join(f"{kind} ({sign})" for kind, sign in KINDS.items())

Texts = Iterator[str]  # what is implausible, a sentence each; what is refused is raised


@dataclass(frozen=True, kw_only=True)
class Finding:
    """What is wrong or implausible at one place of a file."""

    file: str  #: in which it stands
    where: str  #: line, row or sheet in it; "" where it is about the file as a whole
    text: str  #: what is wrong, of which element, and the remedy
    refused: bool  #: whether commands refuse the file for it; else they take it and warn

    def __str__(self) -> str:
        return f"{', '.join(filter(None, (self.file, self.where)))}: {self.text}"


@dataclass(frozen=True, kw_only=True)
class CheckedFile:
    """A file or folder that was checked: its kind, "" where it cannot be read at all, and what was found in it."""

    path: Path
    kind: str
    findings: tuple[Finding, ...]


def check(*paths: str | Path) -> tuple[Finding, ...]:
    """Collect what is wrong or implausible in files and folders, of any kind that commands take.

    What a command would refuse, and what it would warn of, by file, line and element, with the remedy; a fault in one
    file hides none in another. Python files of scenarios and studies are executed, as `wirerope run` does.

    Args:
        paths: files, folders of tables or of runs, folders with such files in them, and names of shipped models.
    """
    return tuple(dict.fromkeys(finding for checked in checked_files(paths) for finding in checked.findings))


def checked_files(paths: Iterable[str | Path]) -> Iterator[CheckedFile]:
    """Yield each file that was checked, one after the other; in folders, those whose kind can be told."""
    for path in map(Path, paths):
        yield from _in_folder(path) if path.is_dir() else [_checked(path)]


def _in_folder(folder: Path) -> Iterator[CheckedFile]:
    """Check the files in a folder and in those below it; a run, and tables of a model, count as one file."""
    if is_run(folder):
        yield _checked(folder, "run")
        return
    tables = is_folder_of_tables(folder) and any(folder.glob("masses.*"))
    if tables:
        yield _checked(folder, "folder of tables")
    for path in sorted(folder.glob("[!._]*")):
        if path.is_dir():
            yield from _in_folder(path)
        elif not (tables and path.stem.lower() in TABLES):
            checked = _checked(path)
            if checked.kind not in ("", UNKNOWN) or (not checked.kind and path.suffix.lower() in _READ):
                yield checked


def _checked(path: Path, kind: str = "") -> CheckedFile:
    """Read a file as a command does, and collect its errors and warnings; its kind is found out unless it is given."""
    said: list[tuple[str, bool]] = []
    with warnings.catch_warnings(record=True) as caught:
        warnings.simplefilter("always")
        try:
            file = path if path.exists() else model_file(path) or path
            if not file.exists():
                raise ModelError(f"{path}: there is no such file, nor a model of that name that ships.")
            kind = kind or kind_of(file) or UNKNOWN
            if kind == UNKNOWN:
                raise ModelError(f"{path}: of what kind this file is cannot be told. There are {_KNOWN}.")
            texts = _READERS[kind](file)
            for text in texts if isinstance(texts, Iterator) else ():
                said.append((text, False))  # what was said before a refusal counts as well
        except (WireRopeError, ValueError, OSError) as error:
            said += [(text, True) for text in (error_text(error), *texts_of(error)[1:])]
    said += [(str(one.message), False) for one in caught if issubclass(one.category, _OURS)]
    findings = tuple(dict.fromkeys(_finding(path, text, refused) for text, refused in said))
    return CheckedFile(path=path, kind=kind, findings=findings)


def _finding(path: Path, text: str, refused: bool) -> Finding:
    """Split a message into file, place and what it says."""
    located = _LOCATION.fullmatch(text)
    file = Path(located[1]) if located else path
    if located is None or not (file == path or file.exists()):
        return Finding(file=str(path), where="", text=text, refused=refused)
    here = path.parent.resolve()  # from which others are called as this one is, whoever made their names absolute
    if file != path and file.resolve().is_relative_to(here):
        file = path.parent / file.resolve().relative_to(here)
    return Finding(file=str(file), where=located[2] or "", text=located[3], refused=refused)


def _of_system(system: System, motions: Iterable[BaseMotion] = ()) -> Texts:
    """Yield what is implausible in a model, and at its rest; ConvergenceError where it has no equilibrium."""
    falls = any(motion.up is not None for motion in motions)
    yield from model_warnings(system, turned=falls)
    for pair in overlapping(system):
        yield f"mounts {' and '.join(pair)} stand in each other, as boxes of their height and width: check their positions."
    for motion in motions:
        yield from missing_modes(system, motion)
    if falls or not system.model.opt.gravity.any():
        return
    table = static_table(system)
    for history, reason in table.missing.items():
        yield f"{history}: {reason}"
    isolators = {name: mount.isolator for name, mount in system.mounts.items()}
    rest = rested_verdicts(table), rest_travel_verdicts(isolators, table, system.bottoms)
    verdicts = [row for row in (*static_load_verdicts(table), *rest[0], *rest[1]) if row.verdict == EXCEEDED]
    yield from (*(f"{line} {RESTED_REMEDY}" for line in rested_lines(verdicts)), *pressed_lines(verdicts))
    for kind in (STATIC_LOAD, TRAVEL):
        used = by_use(row for row in verdicts if row.criterion.kind == kind)
        for worst in list(used.values())[:1]:
            more = f"; also beyond it: {listed(list(used)[1:])}" if used.keys() - {worst.subject} else ""
            yield f"mount {against_limit(worst)}{more}. Take isolators that are rated for it, or more of them."


def _tables(source: Path) -> Texts:
    built = build_model(NAME, tables_in(source))
    yield from _of_system(built.system)
    yield from in_thin_air(built.system, built.layout)


def _scenario(scenario: Scenario) -> Texts:
    scenario = scenario.on_its_floor()
    system = system_of(scenario)
    yield from _of_motion(scenario.motion, scenario.simulate.get("duration"), system)
    yield from _of_system(system, [scenario.motion])


def _of_motion(motion: BaseMotion, duration: float | None, system: System) -> Texts:
    """Yield what is implausible about a motion, and about the simulated time [s] if one is stated."""
    for part in motion.parts:
        if part.doubt:
            yield f"{part.description}: {part.doubt}"
    try:
        duration_of(motion, duration, system)
    except ValueError as error:
        if duration is not None:
            yield str(error)


def _study(path: Path) -> Texts:
    """Yield what is implausible in a study or search; all variants, or those of the first generation, are checked, too."""
    study = load_study_file(path).make()
    every = study.study if isinstance(study, Search) else study
    for motion in every.motions:
        yield from _of_motion(motion, every.duration, every.base)
    yield from _of_system(every.base)
    study.table()


def _run(folder: Path) -> Texts:
    warn_of_alterations(folder)
    return _scenario(stored_scenario(folder).make())


def _job(path: Path) -> Texts:
    job = load_job(path)
    yield from _of_system(job.system, [case.scenario.motion for case in job.cases])
    yield from in_thin_air(job.system, job.layout)
    yield from job_doubts(job.cases)


def _isolator(path: Path) -> Texts:
    yield from isolator_warnings(load_isolator(path))


def _datasheet(path: Path) -> Texts:
    if read_short_sheet(path) is None:
        yield from isolator_warnings(fit_datasheet(path))


def _mission(path: Path) -> None:
    for stage in read_mission(path).stages:
        scenario_content(stage.run)


def _cyclic_test(path: Path) -> Texts:
    yield from rig_warnings(read_tests([path]))[0]


def _record(path: Path) -> Texts:
    """Check that a record can be read, as a base motion (columns x, y, z; in UFF one node), or else as measured responses.

    Yield a note if no column states a unit. In UFF "#" numbers the channels of a node that have one direction.
    """
    if is_uff(path):
        names = uff_channels(path)
        one_node = len({name.partition(":")[0] for name in names}) == 1 and not any("#" in name for name in names)
        played, subjects = one_node, dict.fromkeys(names, "point")
    else:
        header = read_header(path, kind="record", example='"time [s], z [g]"')
        known = {name: unit or "" for name, unit in zip(header.names, header.units, strict=True)}
        subjects = {name: "point" for name, unit in known.items() if quantity_of(unit, mount=False)}
        subjects |= {name: "mount" for name, unit in known.items() if quantity_of(unit, mount=True) == "force"}
        played = moves_a_base(header) and has_unit(header, ACCELERATION_UNITS)
    if played:
        load_record(path)
    elif subjects:
        axes = {"point": "z", "mount": "axial"}
        load_measured(path, channels={name: f"{of}/{n} {axes[of]}" for n, (name, of) in enumerate(subjects.items())})
    else:
        yield "no column states a unit, so that its values were not checked: write it behind the name, as in z [g]."


def _density(path: Path) -> Texts:
    if doubt := doubt_of_rms(psd_rms(psd_points(path))):
        yield doubt


def _map(path: Path) -> None:
    for column, phrase in read_map([str(path)])["channels"].items():
        parse_channel(column, phrase)


# What reads each kind: what it raises is refused; what it warns of, or yields as sentences, is implausible.
_READERS: dict[str, Callable[[Path], object]] = {
    "model": lambda path: _of_system(load_system(path)), "scenario": lambda path: _scenario(load_scenario(path).make()),
    "study": _study, "isolator": _isolator, "datasheet": _datasheet,
    "law": lambda path: read_law(read_toml(path, "law file"), Place(path)), "levels": motion_of_levels, "job": _job,
    "life": _mission, "map": _map, "density": _density, "spectrum": spectrum_points, "amplitudes": table_lines,
    "curve": read_curve, "forces over time": force_rows, "cyclic test": _cyclic_test, "record": _record, "run": _run,
    "folder of tables": _tables, **{kind: partial(read_table, kind) for kind in TABLES},
}  # fmt: skip
