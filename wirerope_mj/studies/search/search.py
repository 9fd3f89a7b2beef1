"""A search: designs of one system, made better generation by generation, for the least of some measures within limits."""

from contextlib import closing
from pathlib import Path
from typing import Any

from wirerope_mj.engine.simulation.progress import share_bar
from wirerope_mj.foundation.arguments import one_of
from wirerope_mj.studies.definition import StudyDefinition
from wirerope_mj.studies.folder import TABLE, computed_alone, finish, prepare
from wirerope_mj.studies.loading import read_result
from wirerope_mj.studies.responses import KEPT
from wirerope_mj.studies.results.summary_file import head
from wirerope_mj.studies.run import checked_engine
from wirerope_mj.studies.search.definition import SearchDefinition
from wirerope_mj.studies.search.evolution import check_installed
from wirerope_mj.studies.search.result import GENERATION, SearchResult
from wirerope_mj.studies.search.run import Evolving


class Search(SearchDefinition):
    """Designs with the least of some measures within limits, found by an evolution of many generations.

    What a designer may choose varies as in a `Study`, as Uniform or Choice; the variants of this study, sampled as it says,
    are the first generation, after designs that are given. Each later one is made by the optimiser (pymoo's NSGA-II)
    from the best so far, and computed as variants are: by the same engines, with the same bits.

    All arguments are attributes, and further:

    Attributes:
        study: what varies, and how a design is simulated.
        first: the designs of the first generation, by column; those of `start` first.
    """

    def run(
        self,
        folder: str | Path,
        *,
        keep: str = "peaks",
        engine: str = "local",
        workers: int | None = None,
        address: str | None = None,
        resume: bool = False,
        force: bool = False,
        progress: bool = False,
    ) -> SearchResult:
        """Evolve all generations and return the result, which stands in `folder`; arguments are those of `Study.run`.

        The folder is that of a study whose variants are the designs, no design twice. A search that was killed goes on: the
        optimiser begins again, and is given what the finished parts hold.

        Raises:
            ValueError: an argument is out of range, or the optimiser is not installed.
            ModelError: a design of the first generation cannot be.
            RecordError: the folder is not that of this search.
            SimulationError: the cluster cannot be reached.
        """
        folder, study = Path(folder), self.study
        run = checked_engine(engine, workers=workers, address=address)
        one_of("keep", keep, KEPT)
        added = {"optimiser": check_installed(), **self.to_dict()}
        identity = prepare(study, folder, keep=keep, resume=resume, force=force, search=added)
        with computed_alone(folder, identity):
            parts = 0
            if not (folder / TABLE).is_file():
                with share_bar(
                    "search", "designs/s", total=self.generations, parts="generations", enabled=progress
                ) as update:
                    evolving = Evolving(self, folder, keep, run, {"workers": workers, "address": address}, update)
                    with closing(evolving):  # so that no process goes on if this one is interrupted
                        evolving.evolve()
                parts = evolving.parts
            finish(folder, parts, lambda: _summary(_loaded(folder, study)))
        return _loaded(folder, study)


def _loaded(folder: Path, study: StudyDefinition) -> SearchResult:
    result = read_result(folder, type(study))
    assert isinstance(result, SearchResult)
    return result


def _summary(result: SearchResult) -> dict[str, Any]:
    """Return the front of a search, SI, and its knee; percentiles of designs that an evolution has chosen mean nothing."""
    names = ["variant", GENERATION, *result.shown]
    return {
        **head(result),
        "minimised": list(result.minimise),
        "limits": result.limits,
        "within_limits": int(result.feasible.sum()),
        "front": result.front.select(names).to_pylist(),
        "knee": result.knee,
    }
