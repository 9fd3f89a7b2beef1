"""The result of a study: its table, and the folder it stands in."""

import math
from collections.abc import Sequence
from dataclasses import dataclass, field, replace
from functools import cached_property, partial
from pathlib import Path

import numpy as np
import pyarrow as pa
import pyarrow.compute as pc

from wirerope_mj.engine.response import Response
from wirerope_mj.foundation.arguments import finite, integer
from wirerope_mj.foundation.arrays import Entries
from wirerope_mj.foundation.errors import ModelError, RecordError
from wirerope_mj.foundation.exports import Exportable, Exported
from wirerope_mj.foundation.summary import Summarised
from wirerope_mj.studies.definition import StudyDefinition
from wirerope_mj.studies.engines.compute import FAILED, nominal
from wirerope_mj.studies.folder import dead_chunks, finished_chunks, kept_numbers, kept_response, parts
from wirerope_mj.studies.inputs_file import RESPONSES, STUDY, todays_name, todays_table
from wirerope_mj.studies.results.measure import (
    ALL,
    Exceedance,
    checked_measure,
    exceedance_of,
    measure_of,
    quantiles,
    rows_of,
    unit_of,
    values_of,
    worst,
)
from wirerope_mj.studies.stored_table import StoredTable, read_table
from wirerope_mj.studies.vary.sampling import LISTED, OF_INDICES, factors

NOT_COMPUTED = (
    "Some were not computed, since their processes died or found no memory, threads or files: go on with --resume "
    "(`resume=True`)."
)


@dataclass(frozen=True, kw_only=True, repr=False)
class StudyResult(Exportable, Summarised):
    """The result of a study.

    Columns of the table: `variant` (int64), inputs (one for every sampled number, by its name in `vary`, or with the
    mount's own name in place of the pattern where each has its own: "mount/m01/axial/alpha"), measures (float64, SI, NaN where
    not judged or failed), `status` ("done" or "failed"), `message`.
    """

    folder: Path  #: of the study
    inputs: Entries = field(repr=False)  #: content of its `study.toml`
    variants: int  #: number of variants of the study
    complete: bool  #: whether all of them are in the table
    study_class: type[StudyDefinition] = field(default=StudyDefinition, repr=False)  #: of `study`

    def _summary(self) -> tuple[str, dict[str, str]]:
        name = self.inputs.get("name", "study")
        state = "complete" if self.complete else "not complete"
        lines = {"folder": str(self.folder), "message": self.message}
        return f"{type(self).__name__} of {name}: {self.variants} variants, {state}", lines

    @cached_property
    def table(self) -> pa.Table:
        """Table with one row for every variant; of an incomplete study, for the finished ones."""
        if self.complete:
            return todays_table(read_table(self.folder), self.inputs)
        numbers = sorted(finished_chunks(self.folder))
        if not numbers:
            raise RecordError(f"{self.folder}: no variant of this study is done yet.")
        return todays_table(pa.concat_tables(parts(self.folder, numbers)), self.inputs)

    @cached_property
    def columns(self) -> pa.Table | StoredTable:
        """The table, of which only those columns and rows are read that are asked for, unless it is in memory already."""
        if not self.complete or "table" in vars(self):
            return self.table
        return StoredTable(self.folder, partial(todays_name, content=self.inputs))

    @cached_property
    def nominal(self) -> dict[str, float]:
        """Measures of the nominal system, with nothing varied and under the first of the motions; none if it fails."""
        measures = nominal(self.study.work)
        if isinstance(measures, str):
            return {}
        accelerations = [value for name, value in measures.items() if name.startswith(ALL[:-1])]
        return dict(measures) | ({ALL: max(accelerations)} if accelerations else {})

    @cached_property
    def step_error(self) -> float:
        """Largest change of the nominal system's peaks with half the time step, over the largest of a kind; NaN if it fails."""
        work = self.study.work
        finer = nominal(replace(work, timestep=0.5 * work.timestep))
        if isinstance(finer, str) or not self.nominal:
            return math.nan
        errors = [0.0]
        for kind in ("acceleration/", "deflection/", "force/"):
            pairs = [(value, finer[name]) for name, value in self.nominal.items() if name.startswith(kind) and name in finer]
            largest = max((abs(fine) for _, fine in pairs), default=0.0)
            errors += [abs(value - fine) / largest for value, fine in pairs if largest > 0.0]
        return max(errors)

    @property
    def exported(self) -> Exported:
        """The table to be written for other programs, in SI units."""
        columns = self.columns
        names = columns.column_names
        return Exported(
            names=names, units=[unit_of(name) for name in names], about={"study": str(self.inputs.get("name", "study"))},
            column=lambda number: columns[names[number]].to_numpy(),
            blocks=lambda: (
                [column.to_numpy() for column in block.columns]
                for block in (columns.blocks() if isinstance(columns, StoredTable) else [columns])
            ),
            grouped=False,  # "acceleration" and "acceleration/rack"
        )  # fmt: skip

    @cached_property
    def failed(self) -> dict[int, str]:
        """Messages of the variants that failed, by number."""
        mask = pc.equal(self.columns["status"], FAILED)
        variants, messages = (self.columns[name].filter(mask).to_pylist() for name in ("variant", "message"))
        return dict(zip(variants, messages, strict=True))

    @cached_property
    def message(self) -> str:
        """One sentence on how the study ended."""
        if not self.complete:
            return f"{self.folder}: not complete; go on with it with --resume (`resume=True`)."
        failed = self.failed
        if not failed:
            return f"{self.variants} variants, none failed.{self.missing}"
        first = min(failed)
        return f"{self.variants} variants, {len(failed)} failed; variant {first}: {failed[first]}{self.missing}"

    @property
    def missing(self) -> str:
        """Sentences on what a complete run lacks; empty if nothing."""
        text = f" {NOT_COMPUTED}" if dead_chunks(self.folder) else ""
        if self.inputs.get("keep") == RESPONSES:
            wanted = set(self.columns["variant"].to_pylist()) - set(self.failed)
            if gone := len(wanted - kept_numbers(self.folder)):
                text += f" Of the responses that were kept {gone} are gone; they are simulated when they are asked for."
        return text

    @cached_property
    def independent(self) -> pa.Table | StoredTable:
        """Rows of independent variants: all of a study, but of one for Sobol's indices only those of the samples A and B."""
        if self.study.sampling != OF_INDICES:
            return self.columns
        of_row = len(factors(self.study.quantities)) + 2
        return self.columns.filter(pa.array(np.asarray(self.columns["variant"]) % of_row < 2))

    @property
    def is_sampled(self) -> bool:
        """True if the variants were sampled at random, so that ratios of them are probabilities."""
        return self.study.sampling not in LISTED

    def worst(self, measure: str = "travel", count: int = 10) -> pa.Table:
        """Return the rows of the variants with the largest values of a measure, the largest first.

        Of a study for Sobol's indices only independent variants; the others repeat them but for one factor.

        Raises:
            ValueError: there is no such measure, or it has no value in any variant.
        """
        table = self.independent
        return rows_of(table, worst(table, checked_measure(table, measure), count))

    def quantiles(self, measure: str, probabilities: Sequence[float] = (0.5, 0.9, 0.95, 0.99)) -> list[float]:
        """Return quantiles of a measure, SI; NaN where fewer than five variants lie beyond, too few to tell.

        Of a study for Sobol's indices, those of the variants that do not depend on each other. Of values that are listed they
        are no probabilities.

        Raises:
            ValueError: there is no such measure, or a probability is not between 0 and 1.
        """
        if not all(0.0 <= probability <= 1.0 for probability in probabilities):
            raise ValueError(f"`probabilities` must be from 0 to 1, got {list(probabilities)}.")
        table = self.independent
        return quantiles(values_of(table, checked_measure(table, measure)), probabilities)

    def exceedance(self, measure: str = "travel", limit: float | None = None) -> Exceedance:
        """Return how often a measure exceeds a limit, with bounds of the probability and the number of variants that failed.

        Args:
            measure: column of the table.
            limit: SI; None: 1 for utilisations of what is rated or stated.

        Raises:
            ValueError: there is no such measure, it has no limit of its own and none is given, or the limit is not a finite
                number.
        """
        table = self.independent
        stated_limit = measure_of(checked_measure(table, measure)).limit
        limit = stated_limit if limit is None else finite("limit", limit)
        if limit is None:
            raise ValueError(f"`limit` must be given for {measure!r}: it is no utilisation of anything rated.")
        return exceedance_of(table, measure, limit)

    def response(self, variant: int) -> Response:
        """Return the whole response of a variant: read if it was kept (`keep="responses"`), else simulated now.

        Both are the same, bit for bit, where the study's versions are installed.
        """
        variant = integer("variant", variant, least=0)
        kept = kept_response(self.folder, variant)
        return self.study.response(variant) if kept is None else kept

    @cached_property
    def study(self) -> StudyDefinition:
        """The study itself, made from the folder alone."""
        try:
            return self.study_class.restored(self.folder, self.inputs)
        except (ValueError, ModelError) as error:
            raise RecordError(f"{self.folder / STUDY}: no study can be made of it: {error}") from None
