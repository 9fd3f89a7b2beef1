"""Studies from files with a function, from scenarios of which something varies, and of every load case of a job."""

from collections.abc import Mapping
from contextlib import nullcontext
from functools import partial
from pathlib import Path

from wirerope_mj.content.blocks import Content
from wirerope_mj.content.study import job_study_content
from wirerope_mj.engine.system import load_system
from wirerope_mj.engine.system.varied import with_changes
from wirerope_mj.foundation.arrays import Entries
from wirerope_mj.foundation.atomic_files import atomic_folder, write_json
from wirerope_mj.foundation.errors import ModelError
from wirerope_mj.foundation.payload_limits import KINDS, PayloadLimit, limits_by_patterns
from wirerope_mj.foundation.resources import scenarios_folder
from wirerope_mj.foundation.units import STANDARD_GRAVITY
from wirerope_mj.runs.job_file import Job
from wirerope_mj.runs.page import write_page
from wirerope_mj.runs.scenario import OptionFile, Scenario, load_scenario
from wirerope_mj.runs.scenario_file import is_run, stored_scenario, subjects_of
from wirerope_mj.runs.study import CONTENT
from wirerope_mj.studies.folder import check_whole
from wirerope_mj.studies.measures import measure_names, payload_points
from wirerope_mj.studies.results.study_summary import summary_of
from wirerope_mj.studies.results.varied import limit_of_text, write_stated
from wirerope_mj.studies.search.search import Search
from wirerope_mj.studies.study import Study, load_study
from wirerope_mj.studies.vary.distributions import Distribution
from wirerope_mj.studies.vary.vary_option import EXAMPLE, available_lines, signatures

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
        made, _ = self.made(options)
        if not isinstance(made, Study | Search):
            raise ModelError(f"{self.path}: `study` must return a wirerope_mj.Study or a wirerope_mj.Search, got {made!r}.")
        made.name = self.name if made.name == "study" else made.name
        made.question = made.question or (self.function.__doc__ or "").split("\nArgs:")[0].strip()
        return made


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
    """Return the study of a scenario; model, motion, duration, step and initial state are those of the scenario.

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
    if other := [key for key in simulate if key not in _CARRIED]:
        text = f"a study cannot take over `{other[0]}` of its simulation; it takes {', '.join(_CARRIED)}."
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
    """Return what can vary in a scenario and how it is said, as lines."""
    system = with_changes(load_system(scenario.model_source(), isolators=scenario.isolators), scenario.changes)
    lines = "\n".join(f"  {line}" for line in available_lines(system, scenario.motion))
    return (
        f'In {scenario.name} can vary:\n{lines}\nSay it as --vary "{EXAMPLE}", once for each quantity; NAME may hold * and ?. '
        f"Distributions: {', '.join(signatures())}. A value replaces what the model says, a shift is added to it, a factor "
        "(`relative`) multiplies it; with `each` every mount or body has its own."
    )


def limits_of(scenario: Scenario) -> tuple[list[str], list[str]]:
    """Return the scenario's limits that a study can judge, as `--limit` takes them, and those that it cannot.

    A study has the norm of an acceleration in its table, and how far points move each way; it has no acceleration along an
    axis, and no clearance of a body's corners or between two points.
    """
    system = load_system(scenario.model_source(), isolators=scenario.isolators)
    points, known = payload_points(system), subjects_of(system)
    can: list[str] = []
    cannot: list[str] = []
    for one in limits_by_patterns(scenario.limits, known):
        if one.kind == "acceleration" and set(one.judged) == {""}:
            can.append(_text(one))
        elif one.kind == "clearance" and one.name in points:
            can += [f"displacement/{one.name}/{side} = {value:.12g} m" for side, value in one.ways.items()]
        else:
            cannot.append(_text(one))
    return can, cannot


def _text(limit: PayloadLimit) -> str:
    accelerates = limit.kind == "acceleration"
    values = " ".join(f"{value / (STANDARD_GRAVITY if accelerates else 1.0):.12g}" for value in limit.values)
    return f"{limit.kind}/{limit.name} = {values} {'g' if accelerates else KINDS[limit.kind].unit}"


def study_job(job: Job, folder: str | Path, *, vary: Mapping[str, Distribution], how: Entries, drawn: Entries) -> Content:
    """Compute the same variants under every load case, write them and what they say into a folder, and return that.

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
