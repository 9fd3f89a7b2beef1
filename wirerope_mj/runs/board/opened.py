"""What a board opens: tables, a job, a model, a template that is copied, or a scenario or run as it is."""

import shutil
from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path

from wirerope_mj.content.job import REPORTED
from wirerope_mj.foundation.errors import ModelError
from wirerope_mj.foundation.resources import model_file, models_folder, shipped_models
from wirerope_mj.foundation.toml_file import read_toml
from wirerope_mj.motions import Measured
from wirerope_mj.runs.board.documents import Documents
from wirerope_mj.runs.board.job_text import blank_job
from wirerope_mj.runs.job_file import KIND, Job, LoadCase
from wirerope_mj.runs.measured import tests_of
from wirerope_mj.runs.new_model import TABLES, is_folder_of_tables
from wirerope_mj.runs.scenario import Scenario, load_scenario, shipped_scenarios
from wirerope_mj.runs.scenario_file import is_run, stored_scenario, system_of

JOB = "job.toml"


@dataclass(frozen=True)
class Opened:
    """What a board shows: files that it edits, or a scenario as it is; tests are those that a run was compared with."""

    documents: Documents
    job: Job | None = None  # of a scenario
    tests: Sequence[Measured] = ()


def opened(what: Path) -> Opened:
    """Open a folder of tables, a job, a model, a scenario or a run.

    ModelError if it is none of them; RecordError if a file is unreadable.
    """
    if is_run(what) or str(what) in shipped_scenarios() or what.suffix == ".py":
        file = stored_scenario(what) if is_run(what) else load_scenario(str(what))
        return Opened(Documents({}, {}), _job_of(file.make()), tests_of(what))
    tables = what if is_folder_of_tables(what) else what / "tables"
    if what.suffix == ".toml":
        stated = str(read_toml(what, KIND).get("model", ""))
        return Opened(_documents(what, what.parent / stated, stated))
    if is_folder_of_tables(tables):
        return Opened(_documents(tables / JOB, tables, "."))
    if (model := model_file(what)) is not None:
        name = what.stem if what.stem in shipped_models() and not what.exists() else str(model.resolve())
        return Opened(_documents(Path(f"{model.stem}.toml"), model, name))
    raise ModelError(
        f"{what}: there is nothing that a board can open: a folder with mounts.csv and masses.csv, a job, a model, a scenario "
        f"or a run. `wirerope new FOLDER --blank` writes tables to fill in; {', '.join(shipped_models())} are models that ship."
    )


def _documents(job: Path, folder: Path, model: str) -> Documents:
    """Read a job, or a blank one, and the tables of its model if `folder` is one of tables."""
    tables = {kind: folder / f"{kind}.csv" for kind in TABLES} if is_folder_of_tables(folder) else {}
    others = [file.name for file in folder.iterdir() if file.stem in TABLES and file.suffix.lower() != ".csv"] if tables else []
    if others:
        raise ModelError(f"{folder}: the board edits tables in CSV; save {', '.join(sorted(others))} as CSV, too.")
    name = folder.resolve().name if tables else folder.stem
    return Documents({"job": job, **tables}, {"job": blank_job(model, name)})


def _job_of(scenario: Scenario) -> Job:
    """Make a job of a scenario alone."""
    scenario = scenario.on_its_floor()
    case = LoadCase(name=scenario.name, folder=scenario.name, note="", scenario=scenario)
    return Job(
        name=scenario.name, question=scenario.question.strip().split("\n", 1)[0], report=REPORTED[:7], document=None,
        cases=(case,), path=Path(), layout=None, system=system_of(scenario),
    )  # fmt: skip


def from_template(name: str, folder: Path) -> Path:
    """Copy the tables of a template into a folder that does not exist yet, and return it."""
    if folder.exists():
        raise ModelError(f"{folder} exists; give another folder, or open this one: wirerope board {folder}")
    shutil.copytree(models_folder() / "templates" / name, folder)
    return folder
