"""Tests that a run is compared with: their files and maps in its folder, the page and the recording over each other."""

import shutil
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Literal

import tomli_w

from wirerope_mj.assessment.correlation import Correlation, correlate
from wirerope_mj.content.correlation import correlation_content
from wirerope_mj.content.judged_run import RunResult
from wirerope_mj.engine.response import load_response
from wirerope_mj.foundation.arrays import Entries
from wirerope_mj.foundation.atomic_files import atomic_file
from wirerope_mj.foundation.errors import RecordError
from wirerope_mj.foundation.regular_files import file_inside
from wirerope_mj.foundation.structure import Place, Positive, structure
from wirerope_mj.foundation.toml_file import read_toml
from wirerope_mj.motions import Measured, load_measured
from wirerope_mj.runs.folder import digest_of, update_checksums, warn_of_alterations
from wirerope_mj.runs.scenario_file import is_run, run_verdicts
from wirerope_mj.views.report import report_html

FOLDER = "measured"


@dataclass(frozen=True, kw_only=True)
class ColumnMap:
    """Map of a measurement: the meaning of the columns of a test's file."""

    channels: dict[str, str]  #: COLUMN = "PHRASE", such as A1 = "point/rack_top z g"
    start: float | None = None  #: instant of the run at which the first sample was taken [s]
    clock: Positive | None = None  #: seconds of the run in one of the file's clock
    baseline: Literal["none", "rest", "mean"] | None = None
    gaps: Literal["refuse", "fill"] | None = None
    file: str | None = None  #: in a run's folder: the test's file beside it
    name: str | None = None  #: what the test is called there

    @property
    def arguments(self) -> Entries:
        return {key: value for key, value in vars(self).items() if value is not None and key not in ("file", "name")}


def _column_map(path: Path) -> ColumnMap:
    return structure(ColumnMap, read_toml(path, "map of a measurement", RecordError), Place(path, error=RecordError))


def read_map(items: Sequence[str]) -> Entries:
    """Read the meaning of a measurement's columns, `COLUMN=PHRASE` or a TOML file, for `load_measured`.

    ValueError if an item is neither, or a column is given twice; RecordError if the file is no `ColumnMap`.
    """
    channels: dict[str, str] = {}
    options: Entries = {}
    for item in items:
        column, sign, phrase = item.partition("=")
        if sign:
            arguments: Entries = {"channels": {column.strip(): phrase.strip()}}
        elif item.endswith(".toml"):
            arguments = _column_map(Path(item)).arguments
        else:
            raise ValueError(f'`--map` must be COLUMN=PHRASE, such as "A1=point/rack_top z g", or a TOML file, got {item!r}.')
        for name, phrase in arguments["channels"].items():
            if name in channels:
                raise ValueError(f"`--map` must say once what a column is, got {name!r} twice.")
            channels[name] = phrase
        options |= {key: value for key, value in arguments.items() if key != "channels"}
    return {"channels": channels, **options}


def store_test(folder: Path, test: Measured, *, force: bool = False) -> None:
    """Copy the file of a test and its map into a run's folder, with their checksums.

    RecordError if another test of that name stands there, and `force` is not given.
    """
    target = folder / FOLDER / f"{test.name}{test.path.suffix}"
    if target.exists() and not force and digest_of(target) != digest_of(test.path):
        raise RecordError(
            f"{target}: another test of this name was compared with this run. Replace it with --force, or call this one by "
            "another name (--names)."
        )
    target.parent.mkdir(exist_ok=True)
    if target.resolve() != test.path.resolve():
        with atomic_file(target) as beside:
            shutil.copyfile(test.path, beside)
    content = {
        "file": target.name, "name": test.name, "start": test.start, "clock": test.clock, "baseline": test.baseline,
        "gaps": test.gaps, "channels": dict(test.phrases),
    }  # fmt: skip
    description = target.parent / f"{test.name}.toml"
    with atomic_file(description) as beside:
        beside.write_text(tomli_w.dumps(content), encoding="utf-8")
    update_checksums(folder, [target, description])


def tests_of(folder: Path) -> tuple[Measured, ...]:
    """Read the tests in a run's folder, in the order of their names; nothing outside it is read.

    RecordError if a map or a file is damaged.
    """
    tests = []
    for path in sorted((folder / FOLDER).glob("*.toml")):
        column_map = _column_map(path)
        file = file_inside(path.parent, column_map.file, "measurement")
        tests.append(load_measured(file, name=column_map.name or path.stem, **column_map.arguments))
    return tuple(tests)


def write_correlation(
    folder: Path, files: Mapping[str, Path], options: Entries, page: Path, *, force: bool
) -> tuple[Correlation, ...]:
    """Compare a run with tests, store their files in its folder, and write a page and a recording beside it.

    Args:
        folder: of the run.
        files: of the tests by their names.
        options: as `load_measured` takes them, channels included.
        page: to write, .html.
        force: whether other tests of the same names are replaced.

    Raises:
        RecordError: the folder is no run, a test cannot be read, or it was measured at what the run does not have.
    """
    if not is_run(folder):
        raise RecordError(f"{folder}: this is no run. Tests are compared with the folder that `wirerope run` or `shock` wrote.")
    warn_of_alterations(folder)
    response = load_response(folder)
    measured = [load_measured(file, name=name, **options) for name, file in files.items()]
    tests = tuple(correlate(response, test) for test in measured)
    for test in measured:
        store_test(folder, test, force=force)
    content = correlation_content(folder.resolve().name, tests)
    page.parent.mkdir(parents=True, exist_ok=True)
    with atomic_file(page) as beside:
        beside.write_text(report_html(content), encoding="utf-8")
    from wirerope_mj.views.recording.record import record_run  # late: rerun takes long to import

    recording = page.with_suffix(".rrd")
    run = RunResult(response=response, verdicts=run_verdicts(folder, response))
    record_run(run, recording, title=content.title, scenario_text=content.verdict.text, tests=tests)
    update_checksums(folder, [page, recording])
    return tests
