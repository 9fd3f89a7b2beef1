"""The scenario as it stands in a run's folder, checked where it is read, and how it is judged."""

from collections.abc import Sequence
from dataclasses import dataclass, field, replace
from pathlib import Path
from typing import Annotated, Any, Literal

from wirerope_mj.engine.response.checked import check_motion
from wirerope_mj.engine.system import System
from wirerope_mj.engine.system.declared import is_subject, limit_subjects
from wirerope_mj.foundation.arrays import Entries
from wirerope_mj.foundation.errors import ModelError, RecordError
from wirerope_mj.foundation.payload_limits import PayloadLimit, limits_by_patterns
from wirerope_mj.foundation.structure import Place, Positive, bounds, keys_of, structure
from wirerope_mj.foundation.toml_file import read_toml
from wirerope_mj.runs.folder import FORMAT, SCENARIO


def judged_by(system: System, *, combined_travel: bool, limits: Sequence[PayloadLimit]) -> System:
    """Return the system with a scenario's limits in place of its model's for the same subjects.

    A name may hold * and ?; a limit on a subject by its own name counts before one by such a pattern. ModelError if a limit
    names no body of the payload and no point, or one thing is limited twice.
    """
    known = subjects_of(system) if limits else {}
    limits = limits_by_patterns(limits, known) if limits else ()
    for number, limit in enumerate(limits):
        if not is_subject(limit.name, limit.kind, known):
            raise ModelError(
                f"limit {limit.kind}/{limit.name}: there is no body of the payload and no point {limit.name!r} that has "
                f"this. There are {', '.join(known[limit.kind]) or 'none'}."
            )
        if any((other.kind, other.name) == (limit.kind, limit.name) for other in limits[:number]):
            raise ModelError(f"limit {limit.kind}/{limit.name}: it is given twice.")
    named = {(limit.kind, limit.name) for limit in limits}
    kept = [limit for limit in system.limits if (limit.kind, limit.name) not in named]
    return replace(system, limits=(*kept, *limits), combined_travel=system.combined_travel and combined_travel)


def judge_table(*, combined_travel: bool, limits: Sequence[PayloadLimit]) -> Entries:
    """Return the table `judge` of a run's scenario.toml; empty if the model alone decides."""
    content: Entries = {} if combined_travel else {"combined_travel": False}
    if limits:
        content["limits"] = {f"{limit.kind}/{limit.name}": list(limit.values) for limit in limits}
    return content


def read_judge_table(content: Entries) -> Entries:
    """Return the arguments of `judged_by` that `judge_table` stored; ValueError names the key that is not what it must be."""
    judge = structure(JudgeTable, content, Place("judge", error=ValueError))
    return {"combined_travel": judge.combined_travel, "limits": judge.payload_limits}


def subjects_of(system: System) -> dict[str, list[str]]:
    return limit_subjects(system.model, system.model.body(system.base).id if system.base else 0)


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
        """The limits; ValueError if one is none."""
        found = []
        for key, values in self.limits.items():
            kind, _, name = key.partition("/")
            try:
                found.append(PayloadLimit(kind=kind, name=name, values=values))
            except ValueError as error:
                raise ValueError(f"`limits` `{key}`: {error}") from None
        return tuple(found)

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
    """Return the scenario of a run as it stands in its folder, with everything there and of the right type.

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
