"""A search: designs of one system, made better generation by generation, for the least of some measures within limits."""

from pathlib import Path

from wirerope_mj.studies.search.definition import SearchDefinition
from wirerope_mj.studies.search.result import SearchResult
from wirerope_mj.studies.search.run import run_search


class Search(SearchDefinition):
    """Designs with the least of some measures within limits, found by an evolution of many generations.

    What a designer may choose varies as in a `Study`, as Uniform or Choice; the variants of this study, sampled as it says,
    are the first generation, after designs that are given. Each later one is made by the optimiser (pymoo's NSGA-II)
    from the best so far, and computed as variants are: by the same engines, with the same bits.

    Attributes:
        study: what varies, and how a design is simulated.
        first: the designs of the first generation, by column; those of `start` first.
        All arguments, too.
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
        return run_search(
            self, Path(folder), keep=keep, engine=engine, workers=workers, address=address, resume=resume, force=force,
            progress=progress,
        )  # fmt: skip
