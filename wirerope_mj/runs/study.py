"""Studies: of files with a function, of scenarios and of cases of a job; their report, and their worst variants as runs."""

from collections.abc import Mapping
from contextlib import nullcontext
from functools import partial
from pathlib import Path

from wirerope_mj.content.blocks import Chart, Content, SceneView
from wirerope_mj.content.search import front_table, search_content
from wirerope_mj.content.study import job_study_content, measures_table, study_content, worst_table
from wirerope_mj.engine.response import load_response
from wirerope_mj.engine.system import load_system
from wirerope_mj.engine.system.varied import with_changes
from wirerope_mj.foundation.arrays import Entries
from wirerope_mj.foundation.atomic_files import atomic_folder, write_json
from wirerope_mj.foundation.errors import ModelError, RecordError
from wirerope_mj.foundation.payload_limits import KINDS, ON_MOUNTS, PayloadLimit, limits_by_patterns
from wirerope_mj.foundation.resources import models_beside, scenarios_folder
from wirerope_mj.foundation.units import STANDARD_GRAVITY
from wirerope_mj.runs.job_file import Job
from wirerope_mj.runs.page import write_page
from wirerope_mj.runs.scenario import OptionFile, Scenario, load_scenario
from wirerope_mj.runs.scenario_file import is_run, stored_scenario, subjects_of
from wirerope_mj.runs.write import run_scenario
from wirerope_mj.studies.folder import check_whole
from wirerope_mj.studies.measures import measure_names, payload_points
from wirerope_mj.studies.result import StudyResult
from wirerope_mj.studies.results.measure import input_names, worst
from wirerope_mj.studies.results.study_summary import summary_of
from wirerope_mj.studies.results.varied import limit_of_text, write_stated
from wirerope_mj.studies.search.result import SearchResult
from wirerope_mj.studies.search.search import Search
from wirerope_mj.studies.study import Study, load_study
from wirerope_mj.studies.vary.distributions import Distribution
from wirerope_mj.studies.vary.vary_option import EXAMPLE, available_lines, signatures
from wirerope_mj.views.pictures import save_pictures

VARIANTS = 256  # Variants unless it is said how many: a power of two, of which Sobol points are balanced
_COUNTED = ("sobol", "latin-hypercube", "random")  # Samplings of which any number of variants is a study
# Arguments of a scenario's simulation that a study takes over.
_CARRIED = ("duration", "timestep", "accuracy", "sample_rate", "initial")


class StudyFile(OptionFile):
    """A file with one function `study(*, ...) -> Study`, or `-> Search`, whose keyword arguments are the options."""

    def make(self, **options: object) -> Study | Search:
        """Return the study of some options; the others have their defaults.

        ModelError if an option is unknown, or the function does not return a Study, or fails; says in which line.
        """
        with models_beside(self.path):
            study, _ = self.made(options)
        if not isinstance(study, Study | Search):
            raise ModelError(f"{self.path}: `study` must return a wirerope_mj.Study or a wirerope_mj.Search, got {study!r}.")
        study.name = self.name if study.name == "study" else study.name
        study.question = study.question or (self.function.__doc__ or "").split("\nArgs:")[0].strip()
        return study


def shipped_studies() -> dict[str, Path]:
    return {path.stem: path for path in sorted((scenarios_folder() / "studies").glob("*.py"))}


def load_study_file(name_or_path: str | Path) -> StudyFile:
    """Return the study file at a path, or the shipped one of that name.

    ModelError if there is no such study, or the file has no function `study` with keyword options only.
    """
    return StudyFile.load(name_or_path, shipped_studies(), "study")


def study_of(
    scenario: Scenario | str | Path, *, vary: Mapping[str, Distribution], variants: int | None = None, sampling: str = "sobol",
    seed: int = 1, timestep: float | None = None, accuracy: float | None = None, options: Mapping[str, object] | None = None,
    name: str | None = None,
) -> Study:  # fmt: skip
    """Make the study of a scenario, with its model, motion, duration, step and initial state.

    Args:
        scenario: the scenario, or the name of one that ships with the package, or the path of a scenario file, or the folder
            of a run.
        vary: what varies, as `Study` takes it.
        variants: how many; None: 256, or those of a grid.
        sampling: as `Study` takes it, and so `seed`.
        seed: of the sampling.
        timestep: largest step [s] instead of the scenario's.
        accuracy: error of the peaks for which the step is chosen, instead of the scenario's.
        options: of the scenario file, by name.
        name: what the study is called; the scenario's name unless it is given.

    Raises:
        ValueError: an argument is out of range.
        ModelError: the scenario asks for what a study has not, or a name stands for nothing in its model.
        RecordError: the folder of the run is damaged.
    """
    if not isinstance(scenario, Scenario):
        file = stored_scenario(scenario) if is_run(scenario) else load_scenario(scenario)
        scenario = file.make(**(options or {}))
    elif options:
        raise ValueError("`options` are for a scenario file; this scenario is made already.")
    scenario = scenario.on_its_floor()
    simulate: Entries = {"initial": scenario.motion.initial} | dict(scenario.simulate)
    asks = f"scenario {scenario.name!r}"
    if (callback := simulate.pop("callback", "native")) != "native":
        text = f"{asks} asks for the {callback!r} callback, and variants are simulated with the native one"
        raise ModelError(f"{text}; leave it out.")
    if (engine := simulate.pop("engine", "auto")) != "auto":
        raise ModelError(f"{asks} asks for the engine {engine!r}, and of variants each has its own; leave it out.")
    if unsupported := [key for key in simulate if key not in _CARRIED]:
        text = f"a study cannot take over `{unsupported[0]}` of its simulation; it takes {', '.join(_CARRIED)}."
        raise ModelError(f"{asks}: {text}")
    if "duration" not in simulate:
        raise ModelError(f"{asks}: `simulate` must say the duration [s].")
    if timestep is not None or accuracy is not None:
        simulate |= {"timestep": timestep, "accuracy": simulate.get("accuracy", 1e-4) if accuracy is None else accuracy}
    return Study(
        model=scenario.model, motion=scenario.motion, isolators=scenario.isolators, changes=scenario.changes,
        folder=scenario.folder, name=name or scenario.name, question=scenario.question, vary=vary,
        variants=VARIANTS if variants is None and sampling in _COUNTED else variants, sampling=sampling, seed=seed, **simulate,
    )  # fmt: skip


def what_can_vary(scenario: Scenario) -> str:
    """List the quantities of a scenario that a study can vary, a line each, and how `--vary` is written."""
    system = with_changes(load_system(scenario.model_source(), isolators=scenario.isolators), scenario.changes)
    lines = "\n".join(f"  {line}" for line in available_lines(system, scenario.motion))
    return (
        f'In {scenario.name} can vary:\n{lines}\nSay it as --vary "{EXAMPLE}", once for each quantity; NAME may hold * and ?. '
        f"Distributions: {', '.join(signatures())}. A value replaces what the model says, a shift is added to it, a factor "
        "(`relative`) multiplies it; with `each` every mount or body has its own."
    )


def limits_of(scenario: Scenario) -> tuple[list[str], list[str]]:
    """Return the scenario's limits that a study can judge, as texts for `--limit`, and the limits that it cannot.

    A study has the norm of an acceleration in its table, and how far points move each way; it has no acceleration along an
    axis, no clearance of a body's corners or between two points, and no force, whoever limits it.
    """
    system = load_system(scenario.model_source(), isolators=scenario.isolators)
    points, known = payload_points(system), subjects_of(system)
    can: list[str] = []
    cannot: list[str] = []
    stated = limits_by_patterns(scenario.limits, known)
    named = {(limit.kind, limit.name) for limit in stated}
    forces = [limit for limit in system.limits if limit.kind in ON_MOUNTS and (limit.kind, limit.name) not in named]
    for limit in (*stated, *forces):
        if limit.kind == "acceleration" and set(limit.judged) == {""}:
            can.append(_text(limit))
        elif limit.kind == "clearance" and limit.name in points:
            can += [f"displacement/{limit.name}/{side} = {value:.12g} m" for side, value in limit.ways.items()]
        else:
            cannot.append(_text(limit))
    return can, cannot


def _text(limit: PayloadLimit) -> str:
    """Write a limit as the option `--limit` takes it: "acceleration/rack = 15 g"."""
    unit, size = {"acceleration": ("g", STANDARD_GRAVITY), "gap": ("%", 0.01)}.get(limit.kind, (KINDS[limit.kind].unit, 1.0))
    return f"{limit.kind}/{limit.name} = {' '.join(f'{value / size:.12g}' for value in limit.values)} {unit}"


def study_job(job: Job, folder: str | Path, *, vary: Mapping[str, Distribution], how: Entries, drawn: Entries) -> Content:
    """Compute the same variants under every load case, and write them with their joint content into a folder.

    Each case is a study of its own in the folder of its name, judged by the job's limits on accelerations and on clearances
    of points; variant k is the same system in all of them, so that the probability that any limit of any case is exceeded
    can be told. `how` are other arguments of `Study.run`, `drawn` number of variants, sampling and seed as `study_of` takes
    them, and raises.
    """
    folder = Path(folder)
    # Cases of two answers never stand together: a finished study of a job is replaced as a whole.
    replaces = how.get("force") and not how.get("resume") and (folder / CONTENT).is_file()
    whole = partial(atomic_folder, force=True, kind="study of a job", marks=(CONTENT,)) if replaces else nullcontext[Path]
    with whole(folder) as place:
        for case in job.cases:
            study = study_of(case.scenario, vary=vary, name=case.name, **drawn)
            limits = [limit_of_text(text, measure_names(study.base)) for text in limits_of(case.scenario)[0]]
            study.run(place / case.folder, when_done=partial(write_stated, limits=limits), **how)
            if replaces:
                check_whole(place / case.folder, folder)
        cases = {case.name: summary_of(load_study(place / case.folder)) for case in job.cases}
        content = job_study_content(job.name, job.question, cases)
        write_json(place / CONTENT, content.to_dict("answer", "cases"))
        write_page(content, [place / "report.html"])
    return content


MOST_OPENED = 6  # Variants in one comparison: more cannot be distinguished
_ROWS = 12  # of a table in the viewer


def checked_count(count: int) -> int:
    """Return the number of worst variants to be written; ValueError if it is out of range."""
    if not 0 <= count <= MOST_OPENED:
        raise ValueError(f"`--open-worst` must be from 0 to {MOST_OPENED}, got {count}: each becomes a run of its own.")
    return count


def result_content(result: StudyResult, by: str | None = None) -> Content:
    """Compose the content of a complete study or search; `by` is the measure shown first, see `summary_of`."""
    if not isinstance(result, SearchResult):
        return study_content(summary_of(result, by))
    if by is not None:
        raise ValueError("`by` is for studies: the designs of a search are ordered by what it minimises.")
    return search_content(result)


CONTENT = "content.json"  # What a study or a search says, in its folder; the summary is complete before it


def write_content(content: Content, folder: Path) -> None:
    """Write the content of a study or a search into its folder.

    Statements and tables stand in content.json under their ids, each chart is a picture by its id, scenes are placements.png.
    """
    write_json(folder / CONTENT, content.to_dict("answer", "results", "inputs", "worst"))
    blocks = list(content.blocks())
    for chart in blocks:
        if isinstance(chart, Chart):
            save_pictures([chart], folder / f"{chart.id}.png", title=content.title)
    scenes = [block for block in blocks if isinstance(block, SceneView)]
    if scenes:
        save_pictures(scenes, folder / "placements.png", title=content.title)


def write_study_report(
    folder: str | Path, *, by: str | None = None, out: str | Path | None = None, pdf: bool = False, force: bool = False
) -> list[Path]:
    """Write the report of a study, from its folder alone, and return the files, the page first; arguments as `page_files`.

    `by` is the measure that is looked at most; by default the most critical one. RecordError if the folder is not a study that
    is complete, or a file is there and must not be replaced; ValueError for another measure; WireRopeError if a PDF cannot
    be made.
    """
    from wirerope_mj.runs.page import page_files, write_page

    folder = Path(folder)
    files = page_files(folder, out, pdf=pdf, force=force)
    result = load_study(folder)
    if not result.complete:
        raise RecordError(result.message)
    write_page(result_content(result, by), files)
    return files


def write_worst(result: StudyResult, by: str | None, count: int) -> list[Path]:
    """Write the worst variants, or the best designs of a search, as runs, and return the paths that can be opened.

    A run replaces one that is there. The worst have the largest values of the measure `by`, or of that which is looked at
    most; of a search they are its front's: the knee, the ends, those between; without a front those that are nearest to the
    limits.

    Each run is that of the variant alone, with its changes beside the model as written. Two or more are laid over each
    other in one recording, too, which is returned first.
    """
    from wirerope_mj.views.recording import record_overlay
    from wirerope_mj.views.recording.viewer import OVERLAY, WORST

    folders = {}
    checked_count(count)
    by = by or (result.minimise[0] if isinstance(result, SearchResult) else summary_of(result).by)
    best = result.chosen[:count] if isinstance(result, SearchResult) else []
    for number in best or worst(result.independent, by, count):
        folder = result.folder / WORST / f"variant-{number:06d}"
        run_scenario(_scenario(result, number), folder, force=True)
        folders[f"variant {number}"] = folder
    if not folders:
        raise RecordError(f"{result.folder}: no variant has a value of {by!r}.")
    together = result.folder / WORST / OVERLAY
    if len(folders) < 2:
        together.unlink(missing_ok=True)  # of others that were written before
        return list(folders.values())
    responses = {name: load_response(folder) for name, folder in folders.items()}
    inputs = {}
    for name in folders:
        row = result.study.row(int(name.split()[1]))
        values = {key: row[key] for key in input_names(result.columns)}
        inputs[name] = {label: f"{value:.5g}" if isinstance(value, float) else str(value) for label, value in values.items()}
    if isinstance(result, SearchResult):
        tables = [front_table(result, _ROWS)] if result.front.num_rows else []
    else:
        summary = summary_of(result, by)
        tables = [measures_table(summary), worst_table(summary)]
    return [record_overlay(responses, together, inputs=inputs, tables=tables), *folders.values()]


def _scenario(result: StudyResult, number: int) -> Scenario:
    """Return the scenario of one variant, from the study's folder; its options are the variant's inputs."""
    study, work = result.study, result.study.work
    simulate = {"duration": work.duration, "timestep": work.timestep, "sample_rate": work.sample_rate, "initial": work.initial}
    if len(study.motions) > 1:  # steps of all variants end at the corners of all motions
        simulate["corners"] = work.corners.tolist()
    row = study.row(number)
    return Scenario(
        question=f"{study.question}\n\nThis is variant {number} of the study {study.name}, which has {study.size}.",
        model=result.folder / result.inputs["model"]["file"], motion=study.motion(number), simulate=simulate,
        name=f"{study.name}-{number:06d}", options={name: row[name] for name in input_names(result.columns)},
        changes=study.system(number).changes,
    )  # fmt: skip
