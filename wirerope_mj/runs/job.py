"""A job computed into one folder: a run for each load case, simulated only if the case's inputs changed.

```text
job.toml           load cases and their folders, what is reported, the document's data
cases/FOLDER/      a run for each load case, as `wirerope run` writes it
summary.json       the answer, the matrix of cases and criteria, what governs each limit
report.html        one page (report.pdf, report.docx)
job.rrd            a recording for each case in one layout, between which the viewer's panel on the left switches
```
"""

import hashlib
import json
import shutil
import tempfile
import warnings
from collections.abc import Callable, Iterator, Mapping
from dataclasses import dataclass, replace
from datetime import UTC, datetime
from functools import partial
from importlib.metadata import version
from pathlib import Path
from time import perf_counter

import tomli_w

from wirerope_mj.content.job import JudgedCase, JudgedJob, job_content, job_headline
from wirerope_mj.engine.system import load_system
from wirerope_mj.engine.system.model_files import write_model
from wirerope_mj.foundation.arrays import Entries
from wirerope_mj.foundation.atomic_files import atomic_file, check_folder, place_named, worked_on_alone, write_json
from wirerope_mj.foundation.errors import RecordError, SimulationError, WireRopeError
from wirerope_mj.foundation.half_written import clear_half_written
from wirerope_mj.foundation.summary import Summarised
from wirerope_mj.foundation.toml_file import read_toml
from wirerope_mj.runs.folder import SUMMARY, alterations, digest_of, warn_of_alterations
from wirerope_mj.runs.job_file import Job, document_table, files_of, load_job, read_document
from wirerope_mj.runs.page import page_files, write_page
from wirerope_mj.runs.scenario import Scenario
from wirerope_mj.runs.scenario_file import is_run, judge_table, judged_folder, scenario_content
from wirerope_mj.runs.write import rejudge_run, write_run

JOB, CASES = "job.toml", "cases"
FORMAT = 1

INPUTS = "inputs"  # Option of a case's run that holds digests of its inputs: was one of them changed since?
_JUDGED_AGAIN = "changed: limits, judged again without simulating"  # why a case is whose samples are still those of its inputs
_CHARACTERS = 12  # of a digest: of a million changes none is missed by chance

# Called with name, computing time [s] and answer of a case that was simulated, and how many cases are left.
Done = Callable[[str, float, str, int], None]


@dataclass(frozen=True, kw_only=True, repr=False)
class JobRun(Summarised):
    """A job that was computed."""

    job: JudgedJob  #: its cases with their verdicts
    #: why each case was computed: "new", "changed: motion", "altered", "asked for"; or only judged again
    computed: Mapping[str, str]
    folder: Path  #: of the job

    @property
    def headline(self) -> str:
        """Answer of the job in one sentence."""
        return job_headline(self.job.verdicts).text

    def _summary(self) -> tuple[str, dict[str, str]]:
        kept = {case.name: "kept" for case in self.job.cases}
        return f"Job {self.job.name}: {self.headline}", kept | dict(self.computed)


def run_job(
    job: Job | str | Path, folder: str | Path, *, force: bool = False, workers: int | None = None, pdf: bool = False,
    docx: bool = False, done: Done = lambda *_: None,
) -> JobRun:  # fmt: skip
    """Simulate the load cases of a job whose inputs changed, each as a run, and write their joint report.

    Args:
        job: what `load_job` returned, or the file of a job.
        folder: of the job: a new one, or that of an earlier version of it, whose runs are kept where their inputs are the same.
        force: whether all cases are simulated again.
        workers: number of processes; None for one per processor.
        pdf: whether the report is written as a PDF, too; one that stands in the folder is written anew.
        docx: the same for a DOCX.
        done: called after each case.

    Raises:
        RecordError: the folder is something else, or another process works on it.
        SimulationError: cases could not be simulated; those that were are kept, and the next call goes on with the others.
        WireRopeError: PDF or DOCX cannot be written here.
    """
    job = job if isinstance(job, Job) else load_job(job)
    folder = Path(folder)
    pdf, docx = pdf or (folder / "report.pdf").exists(), docx or (folder / "report.docx").exists()
    page_files(folder, None, pdf=pdf, docx=docx, force=True)  # what cannot be written is known before anything is computed
    if folder.is_dir() or not folder.exists():
        folder.mkdir(parents=True, exist_ok=True)
    with worked_on_alone(folder, kind="job"), place_named(folder):  # nobody else, who may just have begun in a new folder
        if (folder / JOB).is_file():
            job_table(folder)  # perhaps it is the user's own file of that name, which must not be replaced
        else:
            check_folder(folder, force=False, kind="job", marks=(JOB,))
        for key, name in (files_of(job.document) if job.document else {}).items():
            with atomic_file(folder / name) as beside:
                shutil.copyfile(getattr(job.document, key), beside)
        table = {
            "format": FORMAT, "name": job.name, "question": job.question, "written": datetime.now(UTC).replace(microsecond=0),
            "report": list(job.report),
            "case": [{"name": case.name, "folder": case.folder, "note": case.note} for case in job.cases],
            **({"document": document_table(job.document)} if job.document else {}),
        }  # fmt: skip
        with atomic_file(folder / JOB) as beside:
            beside.write_text(tomli_w.dumps(table, multiline_strings=True), encoding="utf-8")
        with tempfile.TemporaryDirectory() as temporary:  # model and isolators as runs hold them
            first = job.cases[0].scenario
            write_model(load_system(first.model_source(), isolators=first.isolators), Path(temporary))
            files = sorted(path for path in Path(temporary).rglob("*") if path.is_file())
            model = _digest([[file.relative_to(temporary).as_posix(), digest_of(file)] for file in files])
        computed, questions = {}, []
        for case in job.cases:
            motion = case.scenario.motion.to_dict(files={file: digest_of(file) for file in case.scenario.motion.files})
            judge = judge_table(combined_travel=case.scenario.combined_travel, limits=case.scenario.limits)
            values = {"motion": motion, "limits": judge, "numerics": dict(case.scenario.simulate)}
            parts = {"model": model} | {name: _digest(value) for name, value in values.items()}
            said = ", ".join(f"{name} {digest}" for name, digest in parts.items())
            options = {**case.scenario.options, INPUTS: f"{said}, version {version('wirerope-mj')}"}
            completed, run = replace(case.scenario, options=options), folder / CASES / case.folder
            if why := _reason_to_simulate(run, completed, force=force):
                computed[case.name] = why
                questions.append((completed, run, why == _JUDGED_AGAIN))
        try:
            failed = dict(_run_all(questions, workers, done))
        finally:
            clear_half_written((folder / CASES).resolve())  # of processes that were ended in the middle of a case
        if failed:
            names = "; ".join(f"{name}: {text}" for name, text in failed.items())
            raise SimulationError(
                f"{len(failed)} of {len(job.cases)} load cases could not be simulated, the others are kept in {folder}: {names}"
            )
        judged = judged_job(folder)
        _write_views(judged, folder, pdf=pdf, docx=docx)
    return JobRun(job=judged, computed=computed, folder=folder)


def is_job(path: str | Path) -> bool:
    return (Path(path) / JOB).is_file()


def case_folders(folder: Path) -> list[Path]:
    """Return the folders of the runs of a job, in its order; RecordError if one is missing."""
    runs = [folder / CASES / str(table["folder"]) for table in job_table(folder)["case"]]
    for run in runs:
        if not is_run(run):
            raise RecordError(f"{run}: this load case was not simulated; `wirerope cases` goes on with the job.")
    return runs


def judged_job(folder: Path) -> JudgedJob:
    """Judge the runs of a job; nothing outside its folder is read.

    RecordError if a run is missing or damaged, or the folder is not that of a job.
    """
    content = job_table(folder)
    cases = []
    for table, run in zip(content["case"], case_folders(folder), strict=True):
        warn_of_alterations(run)
        cases.append(JudgedCase(name=table["name"], folder=table["folder"], note=table["note"], run=judged_folder(run)))
    document = read_document(content["document"], folder / JOB) if "document" in content else None
    return JudgedJob(
        name=content["name"], question=content["question"], cases=tuple(cases), report=tuple(content["report"]),
        document=document, written=f"{content['written']:%Y-%m-%d %H:%M} UTC",
    )  # fmt: skip


def job_table(folder: Path) -> Entries:
    """Return the content of `job.toml` in a job's folder; RecordError unless it is as it was written."""
    path = folder / JOB
    content = read_toml(path, "job")
    kinds: dict[str, type] = {"name": str, "question": str, "report": list, "written": datetime, "case": list}
    right = content.get("format") == FORMAT and all(isinstance(content.get(key), kind) for key, kind in kinds.items())
    cases = content["case"] if right else ()
    if not cases or not all({"name", "folder", "note"} <= table.keys() for table in cases):
        raise RecordError(
            f"{path}: this is not what `wirerope cases` writes into its folder, and was not touched. Choose another folder, or "
            "take the file from another copy of this one."
        )
    return content


def _digest(value: object) -> str:
    return hashlib.sha256(json.dumps(value, sort_keys=True).encode()).hexdigest()[:_CHARACTERS]


def _reason_to_simulate(run: Path, scenario: Scenario, *, force: bool) -> str:
    """Return the reason why a case must be simulated, "" if its stored run has these inputs."""
    if not is_run(run):
        return "new"
    try:
        altered = alterations(run)
        before = str(scenario_content(run)["options"].get(INPUTS, ""))
    except RecordError:
        return "altered"
    changed = [new.split()[0] for new in str(scenario.options[INPUTS]).split(", ") if new not in before.split(", ")]
    intact = altered is not None and altered.intact
    if changed:
        only_judged = changed == ["limits"] and intact and not force
        return _JUDGED_AGAIN if only_judged else f"changed: {' and '.join(changed)}"
    if not intact:
        return "altered"
    return "asked for" if force else ""


@dataclass(frozen=True)
class _Outcome:
    """Result of one case: the answer or an error, the computing time [s], and warnings."""

    name: str
    seconds: float
    answer: str
    error: str = ""
    warned: tuple[tuple[type[Warning], str], ...] = ()


_Question = tuple[Scenario, Path, bool]  # scenario and folder of a case, and whether its run is only judged again


def _simulate_case(question: _Question) -> _Outcome:
    """Write the run of a case; works in any process."""
    scenario, folder, again = question
    began, answers = perf_counter(), []
    with warnings.catch_warnings(record=True) as caught:
        warnings.simplefilter("always")
        try:
            write = rejudge_run if again else partial(write_run, force=True)
            write(scenario, folder, when_judged=lambda judged: answers.append(judged.headline))
        except (WireRopeError, ValueError, OSError) as error:
            return _Outcome(scenario.name, perf_counter() - began, "", error=str(error))
    warned = tuple((warning.category, str(warning.message)) for warning in caught)
    return _Outcome(scenario.name, perf_counter() - began, answers[0], warned=warned)


def _run_all(questions: list[_Question], workers: int | None, done: Done) -> Iterator[tuple[str, str]]:
    """Simulate cases side by side; yields name and error of those that fail."""
    from wirerope_mj.studies.engines.local import in_processes  # late: with it comes all that studies need

    if len(questions) == 1:
        workers = 1

    def lost(question: _Question, reason: str) -> _Outcome:
        return _Outcome(question[0].name, 0.0, "", error=f"its process {reason} each time; perhaps it ran out of memory.")

    for number, outcome in enumerate(in_processes(_simulate_case, questions, lost=lost, workers=workers), start=1):
        for category, text in outcome.warned:
            warnings.warn(f"{outcome.name}: {text}", category, stacklevel=2)
        if outcome.error:
            yield outcome.name, outcome.error
        else:
            done(outcome.name, outcome.seconds, outcome.answer, len(questions) - number)


def _write_views(judged: JudgedJob, folder: Path, *, pdf: bool, docx: bool) -> None:
    """Write the joint views of all cases: summary, page, documents and recording."""
    from wirerope_mj.views.recording.record import record_cases  # late: rerun takes long to import
    from wirerope_mj.views.recording.viewer import JOINED

    content = job_content(judged)
    said = content.to_dict("limits", "load-cases", "required-spectra", "envelope")
    write_json(folder / SUMMARY, {"format": FORMAT, "name": judged.name, "content": said})
    write_page(content, page_files(folder, None, pdf=pdf, docx=docx, force=True))
    notes = {case.name: case.note for case in judged.cases}
    record_cases({case.name: case.run for case in judged.cases}, folder / JOINED, notes=notes)
