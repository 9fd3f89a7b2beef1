"""The scenario stored in a run's folder: its system, motion and limits, and the check of its response."""

import warnings
from collections.abc import Sequence
from dataclasses import dataclass, field, replace
from pathlib import Path
from typing import Annotated, Any, Literal

import numpy as np

from wirerope_mj.assessment.criteria import Verdict, judge
from wirerope_mj.content.judged_run import JudgedRun, judged_run
from wirerope_mj.content.model import model_facts
from wirerope_mj.engine.response import Response, load_response
from wirerope_mj.engine.response.checked import check_motion
from wirerope_mj.engine.response.histories import same_columns
from wirerope_mj.engine.response.response import FILE
from wirerope_mj.engine.simulation.recorder import column_plan
from wirerope_mj.engine.statics import limit_doubts
from wirerope_mj.engine.system import System, load_system
from wirerope_mj.engine.system.declared import is_subject, limit_subjects
from wirerope_mj.engine.system.model_files import missing_isolators, read_changes
from wirerope_mj.engine.system.named_files import check_inside
from wirerope_mj.engine.system.varied import with_changes
from wirerope_mj.foundation.arrays import Entries
from wirerope_mj.foundation.errors import ModelError, ModelWarning, RecordError
from wirerope_mj.foundation.payload_limits import KINDS, ON_STOPS, PayloadLimit, limits_by_patterns
from wirerope_mj.foundation.structure import Place, Positive, bounds, keys_of, structure
from wirerope_mj.foundation.toml_file import flat_entries, read_toml
from wirerope_mj.motions.motion import BaseMotion
from wirerope_mj.motions.registry import check_records, motion_from_dict
from wirerope_mj.runs.folder import FORMAT, SCENARIO, digest_of
from wirerope_mj.runs.scenario import Scenario, ScenarioFile


def system_of(scenario: Scenario) -> System:
    """Load the model of a scenario with its changes and limits."""
    system = with_changes(load_system(scenario.model_source(), isolators=scenario.isolators), scenario.changes)
    return judged_by(system, combined_travel=scenario.combined_travel, limits=scenario.limits)


def judged_by(system: System, *, combined_travel: bool, limits: Sequence[PayloadLimit]) -> System:
    """Return the system with a scenario's limits, which replace the model's for the same subjects.

    A name may hold * and ?; a limit on a subject by its own name counts before one by such a pattern. `combined_travel` False
    leaves out the check of the travels of a mount together, which the model may leave out, too. ModelError if a limit names no
    body of the payload, no point and no mount, or one thing is limited twice.
    """
    known = subjects_of(system) if limits else {}
    limits = limits_by_patterns(limits, known) if limits else ()
    for number, limit in enumerate(limits):
        if not is_subject(limit.name, limit.kind, known):
            raise ModelError(
                f"limit {limit.kind}/{limit.name}: there is no {KINDS[limit.kind].subject} {limit.name!r} that has this. "
                f"There are {', '.join(known[limit.kind]) or 'none'}."
            )
        if any((earlier.kind, earlier.name) == (limit.kind, limit.name) for earlier in limits[:number]):
            raise ModelError(f"limit {limit.kind}/{limit.name}: it is given twice.")
    for doubt in limit_doubts(system, limits):
        warnings.warn(doubt, ModelWarning, stacklevel=2)
    named = {(limit.kind, limit.name) for limit in limits}
    kept = [limit for limit in system.limits if (limit.kind, limit.name) not in named]
    return replace(system, limits=(*kept, *limits), combined_travel=system.combined_travel and combined_travel)


def judge_table(*, combined_travel: bool, limits: Sequence[PayloadLimit]) -> Entries:
    """Return the table `judge` for a run's scenario.toml; empty if only the model's limits hold."""
    content: Entries = {} if combined_travel else {"combined_travel": False}
    if limits:
        content["limits"] = {f"{limit.kind}/{limit.name}": list(limit.values) for limit in limits}
    return content


def read_judge_table(content: Entries) -> Entries:
    """Return the arguments of `judged_by` that `judge_table` stored; ValueError names an invalid key."""
    judge = structure(JudgeTable, content, Place("judge", error=ValueError))
    return {"combined_travel": judge.combined_travel, "limits": judge.payload_limits}


def subjects_of(system: System) -> dict[str, list[str]]:
    """Name the bodies, points and mounts that a limit of each kind may be on."""
    stops = [name for name, mount in system.mounts.items() if mount.isolator.stops]
    known = limit_subjects(system.model, system.model.body(system.base).id if system.base else 0)
    return known | dict.fromkeys(ON_STOPS, stops)


_REMEDY = "Put it right, or take the file from another copy of the folder."
Seconds = Annotated[float, bounds("s", gt=0.0)]


@dataclass(frozen=True, kw_only=True)
class ModelTable:
    """The model of a run."""

    file: str  #: its file in the folder
    changes: str | None = None  #: file of what a variant differs by


@dataclass(frozen=True, kw_only=True)
class SimulateTable:
    """How a run was simulated."""

    duration: Seconds
    initial: Literal["settled", "relaxed", "unloaded"]
    timestep: Seconds
    sample_rate: Annotated[float, bounds("Hz", gt=0.0)]
    callback: Literal["native", "python"]
    engine: Literal["mujoco", "kernel"] | None = None
    accuracy: Positive | None = None  #: by which the step was chosen
    corners: tuple[float, ...] = ()  #: instants at which the motion is not smooth [s]


@dataclass(frozen=True, kw_only=True)
class JudgeTable:
    """How a run is judged."""

    combined_travel: bool = True  #: whether the travels along all axes are judged together
    limits: dict[str, tuple[float, ...]] = field(default_factory=dict)  #: KIND/NAME = [values], in place of the model's

    @property
    def payload_limits(self) -> tuple[PayloadLimit, ...]:
        """Parsed limits; ValueError if one is invalid."""
        limits = []
        for key, values in self.limits.items():
            kind, _, name = key.partition("/")
            try:
                limits.append(PayloadLimit(kind=kind, name=name, values=values))
            except ValueError as error:
                raise ValueError(f"`limits` `{key}`: {error}") from None
        return tuple(limits)

    def __post_init__(self) -> None:
        _ = self.payload_limits


@dataclass(frozen=True, kw_only=True)
class StoredScenario:
    """The scenario of a run, as it stands in its folder."""

    format: int
    name: str  #: of the scenario
    question: str
    written: Any = None  #: when it was simulated
    options: Entries  #: of the scenario, as given
    model: ModelTable
    simulate: SimulateTable
    motion: Entries  #: `kind`, `description` and its parameters
    judge: JudgeTable = JudgeTable()
    versions: dict[str, str]  #: of the packages that computed it

    def __post_init__(self) -> None:
        if not isinstance(self.motion.get("description"), str):
            raise ValueError("`motion` has no text `description`.")
        check_motion("motion", self.motion)


def scenario_content(folder: Path) -> Entries:
    """Read the scenario of a run from its folder, complete and with correct types.

    RecordError if the folder is not a run, or its scenario is damaged; names the key.
    """
    path = folder / SCENARIO
    if not path.is_file():
        raise RecordError(f"{folder}: this is not a run; there is no {SCENARIO} here.")
    content = read_toml(path, "scenario of a run", RecordError, _REMEDY)
    if "format" in content and content["format"] != FORMAT:
        raise RecordError(f"{path}: `format` is {content['format']!r}, not {FORMAT}; use the version that wrote it.")
    known = {key: value for key, value in content.items() if key in keys_of(StoredScenario)}
    structure(StoredScenario, known, Place(path, error=RecordError, remedy=_REMEDY))
    return content


_TABLES = ("options", "simulate", "versions")
_CHARACTERS = 8  # of a file's digest: enough to see that two files differ


def run_inputs(folder: str | Path) -> dict[str, str]:
    """Return scenario, options, motion, simulation, versions and the digests of the model's files; {} without a scenario.

    RecordError if the scenario or a file of the model cannot be read; names it.
    """
    path = Path(folder) / SCENARIO
    if not path.is_file():  # a response that was saved alone
        return {}
    content = scenario_content(path.parent)
    inputs = {"scenario": content["name"], "motion": content["motion"]["description"]}
    for table in _TABLES:
        prefix = "version of " if table == "versions" else ""
        for key, value in content[table].items():
            inputs[f"{prefix}{key}"] = f"{value:.6g}" if isinstance(value, float) else str(value)
    for file in sorted(path.parent.glob("model/**/*")):
        if file.is_file():
            inputs[f"{file.relative_to(path.parent)}"] = f"digest {digest_of(file)[:_CHARACTERS]}"
    return inputs


def run_facts(folder: Path) -> dict[str, str]:
    """Describe the model of a run in texts by subject: isolators, laws, masses; RecordError or ModelError if it is damaged."""
    return model_facts(system_and_motion(folder, scenario_content(folder))[0])


def run_verdicts(folder: str | Path, response: Response) -> tuple[Verdict, ...]:
    """Judge the response in a folder as `wirerope run` does, or by its scene's limits if the folder is no run.

    RecordError if scenario, motion or model cannot be read, or are not those of the response; names which.
    """
    folder = Path(folder)
    return judged_folder(folder, response).verdicts if is_run(folder) else tuple(judge(response))


def judged_folder(folder: Path, response: Response | None = None) -> JudgedRun:
    """Judge the run in a folder, whose response may have been read already; nothing outside the folder is read.

    RecordError if the folder is not a run, or its files are damaged or not of one run; ModelError if the model or an
    isolator in it is not what it must be.
    """
    content = scenario_content(folder)
    system, motion = system_and_motion(folder, content)
    response = response or load_response(folder)
    check_one_run(folder, content, system, response)
    return judged_run(system, motion, response, content)


_OF_TWO_RUNS = "One of the two was changed or belongs to another run: take them from one copy of the folder."


def system_and_motion(folder: Path, content: Entries) -> tuple[System, BaseMotion]:
    """Return system and motion of a run, whose `content` is what `scenario_content` returned.

    RecordError if one of their files is not in the folder, or the motion's parameters are not what they must be; ModelError
    if the model or an isolator is not.
    """
    model = check_inside(folder, content["model"])
    motion = {key: value for key, value in content["motion"].items() if key != "description"}
    check_records(motion, folder)
    system = load_system(model)
    missing = missing_isolators(system, model.parent)
    if missing:  # the catalogue stepped in, which may have changed since
        where = f"{folder}: the isolator file {missing[0]!r} is missing in {model.parent.name}/"
        raise RecordError(f"{where}. Take it from another copy of the folder.")
    changes = content["model"].get("changes")  # by which the variant that was simulated differs from the model
    system = with_changes(system, read_changes(folder / changes) if changes else ())
    system = judged_by(system, **read_judge_table(content.get("judge", {})))
    try:
        return system, motion_from_dict(motion, folder=folder)
    except (ModelError, ValueError) as error:
        remedy = "Put it right, or take the file from another copy of the folder."
        raise RecordError(f"{folder / SCENARIO}: `motion`: {error} {remedy}") from None


def check_one_run(folder: Path, content: Entries, system: System, response: Response) -> None:
    """Raise RecordError unless the response in a run's folder belongs to the scenario and the model beside it.

    Compared is what both hold: the motion, the sampling, the step, and the names of bodies, points and mounts.
    """
    simulate, numerics = content["simulate"], response.numerics
    samples = np.floor((simulate["duration"] + 1e-10) * simulate["sample_rate"]) + 1.0  # as simulations sample
    if response.time.size != samples:
        raise RecordError(
            f"{folder / SCENARIO}: `simulate.duration` and `simulate.sample_rate` make {samples:.0f} samples, and {FILE} holds "
            f"{response.time.size}. {_OF_TWO_RUNS}"
        )
    motion, played = flat_entries(content["motion"]), flat_entries(response.motion)
    named = [
        name for name in sorted({*motion, *played}) if not {*name.split(".")} & {"path", "description"}
    ]  # records lie elsewhere
    pairs = [
        *((f"simulate.{key}", simulate[key], getattr(numerics, key)) for key in ("timestep", "callback")),
        *((f"motion.{name}", motion.get(name), played.get(name)) for name in named),
        *((f"simulate.{key}", simulate[key], getattr(numerics, key)) for key in ("engine", "accuracy") if key in simulate),
    ]  # fmt: skip
    for name, stated, computed in pairs:
        if stated != computed:
            raise RecordError(
                f"{folder / SCENARIO}: `{name}` is {stated}, and {FILE} was computed with {computed}. {_OF_TWO_RUNS}"
            )
    if not same_columns(response.samples.names, column_plan(system).names):
        subject = f"the bodies, points and mounts of {content['model']['file']}"
        raise RecordError(f"{folder}: {subject} are not those of {FILE}. {_OF_TWO_RUNS}")


_RESOLVED = ("engine",)  # What a run's folder says of its simulation that nobody asked for: the engine that was chosen


def is_run(path: str | Path) -> bool:
    return (Path(path) / SCENARIO).is_file()


def stored_scenario(folder: str | Path) -> ScenarioFile:
    """Return the scenario of a run, which has no options; nothing outside the folder is read.

    Its step is chosen again for the accuracy of the run, if that was how it was chosen. It is called as the folder is.
    RecordError if the folder is not a run, or its files are damaged; ModelError if the model or an isolator in it is not
    what it must be.
    """
    folder = Path(folder)
    content = scenario_content(folder)
    system, motion = system_and_motion(folder, content)
    left_out = (*_RESOLVED, *(["timestep"] if "accuracy" in content["simulate"] else []))
    simulate = {key: value for key, value in content["simulate"].items() if key not in left_out}
    model = check_inside(folder, content["model"]).resolve()

    def scenario() -> Scenario:
        return Scenario(
            question=content["question"], model=model, motion=motion, simulate=simulate, changes=system.changes,
            **read_judge_table(content.get("judge", {})),
        )  # fmt: skip

    scenario.__doc__ = content["question"]
    return ScenarioFile(name=folder.resolve().name, path=(folder / SCENARIO).resolve(), function=scenario)
