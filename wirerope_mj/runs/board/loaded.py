"""A model and its job as a board has loaded them: loads at rest, frequencies and judged load cases, with their sliders."""

import warnings
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from functools import cached_property

from wirerope_mj.content.judged_run import JudgedRun, judged_run, result_or_absent
from wirerope_mj.dynamics.modes import NaturalFrequencies, natural_frequencies
from wirerope_mj.engine.from_tables.layout import Layout
from wirerope_mj.engine.simulation import simulate
from wirerope_mj.engine.statics import Sag, at_rest
from wirerope_mj.engine.system import System
from wirerope_mj.foundation.errors import Absent, ModelWarning, WireRopeError
from wirerope_mj.runs.board.documents import Documents, Texts
from wirerope_mj.runs.board.table_text import TableText
from wirerope_mj.runs.board.what_if import Slider, sliders_of, variant
from wirerope_mj.runs.job_file import Job, LoadCase, load_job
from wirerope_mj.runs.scenario_file import system_of
from wirerope_mj.runs.write import checked_arguments

_LONGEST = 30.0  # time of computing after which no finer step is tried [s]: what is typed may be absurd


@dataclass(frozen=True, eq=False)
class Loaded:
    """A model and its job, loaded from the texts of their files, with the values of the sliders."""

    texts: Texts
    job: Job
    tables: Mapping[str, TableText]
    values: Mapping[str, float]  # of the sliders
    doubts: Sequence[str] = ()  # warnings about what the texts say

    @property
    def layout(self) -> Layout | None:
        return self.job.layout

    @cached_property
    def sliders(self) -> tuple[Slider, ...]:
        return sliders_of(self.job.system, self.job.cases[0].scenario.motion)

    @property
    def moved(self) -> list[tuple[Slider, float]]:
        """Sliders that are not at their nominal value, with their values."""
        values = self.values
        return [(each, values[each.key]) for each in self.sliders if values.get(each.key, each.nominal) != each.nominal]

    @cached_property
    def system(self) -> System:
        """The model as the sliders change it."""
        return variant(self.job.system, self.job.cases[0].scenario.motion, self.values)[0]

    @cached_property
    def sag(self) -> Sag | Absent:
        return result_or_absent(lambda: at_rest(self.system))

    @cached_property
    def frequencies(self) -> NaturalFrequencies | Absent:
        return result_or_absent(lambda: natural_frequencies(self.system))


def load(documents: Documents, texts: Texts, known: Mapping[str, TableText]) -> Loaded:
    """Load job and tables from texts, but for tables that are in `known` with the same text; WireRopeError names the files."""
    documents.write_copies(texts)
    tables = {kind: table for kind, table in known.items() if table.text == texts.get(kind)}
    try:
        with warnings.catch_warnings(record=True) as caught:
            warnings.simplefilter("always", ModelWarning)
            job = load_job(documents.copy("job"))
        for kind in texts.keys() - tables.keys() - {"job"}:
            tables[kind] = TableText.read(kind, documents.copy(kind))
    except (WireRopeError, ValueError) as error:
        raise type(error)(str(error).replace(f"{documents.copies}/", "")) from None
    doubts = [str(warning.message) for warning in caught if issubclass(warning.category, ModelWarning)]
    return Loaded(dict(texts), job, {kind: tables[kind] for kind in texts if kind != "job"}, {}, doubts)


def judged_case(case: LoadCase, loaded: Loaded, timestep: float | None = None) -> JudgedRun:
    """Simulate and judge a load case in memory as `wirerope cases` does, or with `timestep` [s], without an error estimate."""
    arguments = checked_arguments(case.scenario)
    if timestep is not None:
        arguments = {name: value for name, value in arguments.items() if name != "accuracy"}
        arguments |= {"timestep": timestep, "estimate": False}
    scenario = case.scenario.on_its_floor()
    system = loaded.job.system if scenario is case.scenario else system_of(scenario)
    system, motion = variant(system, scenario.motion, loaded.values)
    with warnings.catch_warnings():
        warnings.simplefilter("ignore")  # the verdict's own text has what the model lacks
        response = simulate(system, motion, **arguments, longest=_LONGEST)
    return judged_run(system, motion, response, {"name": scenario.name, "options": dict(scenario.options)})
