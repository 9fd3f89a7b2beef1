"""What a study has found: its table, and the folder it stands in."""

from collections.abc import Sequence
from copy import copy
from dataclasses import dataclass, field
from functools import cached_property
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np
import pyarrow as pa
import pyarrow.compute as pc

from wirerope_mj.engine.response import Response
from wirerope_mj.engine.system.model_files import read_changes
from wirerope_mj.engine.system.named_files import check_inside
from wirerope_mj.foundation.errors import RecordError
from wirerope_mj.foundation.summary import Summarised
from wirerope_mj.motions.copies import check_records
from wirerope_mj.motions.restore import motion_from_dict
from wirerope_mj.studies.engines.compute import FAILED
from wirerope_mj.studies.folder import TABLE, dead, done, parts, read_inputs, read_schema, read_table
from wirerope_mj.studies.inputs.distributions import distribution_from_dict
from wirerope_mj.studies.old_names import todays_table
from wirerope_mj.studies.responses import RESPONSES, kept_numbers, kept_response, whole_number
from wirerope_mj.studies.results.findings import (
    Chance,
    chance_of,
    checked_measure,
    measure_of,
    quantiles,
    values_of,
    worst,
)
from wirerope_mj.studies.results.indices import drawn

if TYPE_CHECKING:
    from wirerope_mj.studies.study import Study

NOT_COMPUTED = (
    "Some were not computed, since their processes died or found no memory, threads or files: go on with --resume "
    "(`resume=True`)."
)


@dataclass(frozen=True, kw_only=True, repr=False)
class StudyResult(Summarised):
    """The result of a study.

    Columns of the table: `variant` (int64), inputs (one for every sampled number, by its name in `vary`, or with the
    mount's own name in place of the pattern where each has its own: "mount/m01/axial/alpha"), measures (float64, SI, NaN where
    not judged or failed), `status` ("done" or "failed"), `message`.

    Attributes:
        folder: where it stands.
        inputs: content of its `study.toml`.
        variants: number of variants of the study.
        complete: whether all of them are in the table.
    """

    folder: Path
    inputs: dict[str, Any] = field(repr=False)
    variants: int
    complete: bool

    def _summary(self) -> tuple[str, dict[str, str]]:
        name = self.inputs.get("name", "study")
        state = "complete" if self.complete else "not complete"
        return f"{type(self).__name__} of {name}: {self.variants} variants, {state}", {
            "folder": str(self.folder),
            "message": self.message,
        }

    @cached_property
    def table(self) -> pa.Table:
        """The table, one row for every variant; of a study that is not complete those that are done."""
        if self.complete:
            return todays_table(read_table(self.folder), self.inputs)
        numbers = sorted(done(self.folder))
        if not numbers:
            raise RecordError(f"{self.folder}: no variant of this study is done yet.")
        return todays_table(pa.concat_tables(parts(self.folder, numbers)), self.inputs)

    def narrowed(self, columns: Sequence[str]) -> "StudyResult":
        """Return the result of a study that is complete with those of `columns` alone that its table has; no others are read.

        The table of a million variants takes gigabytes of memory, one column of it 8 MB.
        """
        there = set(read_schema(self.folder).names)
        other = copy(self)
        vars(other)["table"] = read_table(self.folder, [name for name in columns if name in there])
        return other

    @cached_property
    def failed(self) -> dict[int, str]:
        """Messages of the variants that failed, by number."""
        rows = self.table.select(["variant", "status", "message"])
        rows = rows.filter(pc.equal(rows["status"], FAILED))
        return dict(zip(rows["variant"].to_pylist(), rows["message"].to_pylist(), strict=True))

    @cached_property
    def message(self) -> str:
        """One sentence on how it went."""
        if not self.complete:
            return f"{self.folder}: not complete; go on with it with --resume (`resume=True`)."
        failed = self.failed
        if not failed:
            return f"{self.variants} variants, none failed.{self.missing}"
        first = min(failed)
        return f"{self.variants} variants, {len(failed)} failed; variant {first}: {failed[first]}{self.missing}"

    @property
    def missing(self) -> str:
        """Sentences on what a run that is complete lacks; empty if nothing."""
        found = ""
        if dead(self.folder):
            found += f" {NOT_COMPUTED}"
        if self.inputs.get("keep") == RESPONSES:
            wanted = set(self.table["variant"].to_pylist()) - set(self.failed)
            if gone := len(wanted - kept_numbers(self.folder)):
                found += (
                    f" Of the responses that were kept {gone} are gone; they are simulated when they are asked for."
                )
        return found

    def worst(self, measure: str = "travel", count: int = 10) -> pa.Table:
        """Return the rows of the variants with the largest values of a measure, the largest first.

        Of a study for Sobol's indices only variants that were drawn for themselves; the others repeat them but for one factor.

        Raises:
            ValueError: there is no such measure, or it has no value in any variant.
        """
        table = drawn(self)
        places = {number: place for place, number in enumerate(table["variant"].to_pylist())}
        return table.take([places[number] for number in worst(table, checked_measure(table, measure), count)])

    def quantiles(self, measure: str, shares: Sequence[float] = (0.5, 0.9, 0.95, 0.99)) -> list[float]:
        """Return quantiles of a measure, SI; NaN where fewer than five variants lie beyond: nobody knows them.

        Of a study for Sobol's indices, those of the variants that do not depend on each other. Of values that are listed they
        are no probabilities.

        Raises:
            ValueError: there is no such measure, or a share is not between 0 and 1.
        """
        if not all(0.0 <= share <= 1.0 for share in shares):
            raise ValueError(f"`shares` must be from 0 to 1, got {list(shares)}.")
        table = drawn(self)
        return quantiles(values_of(table, checked_measure(table, measure)), shares)

    def chance(self, measure: str = "travel", limit: float | None = None) -> Chance:
        """Return how often a measure is beyond a limit, with bounds of the probability and the number of variants that failed.

        Args:
            measure: column of the table.
            limit: SI; None: 1 for shares of what is rated or stated.

        Raises:
            ValueError: there is no such measure, it has no limit of its own and none is given, or the limit is not a finite
                number.
        """
        table = drawn(self)
        own = measure_of(checked_measure(table, measure)).limit
        limit = own if limit is None else limit
        if limit is None:
            raise ValueError(f"`limit` must be given for {measure!r}: it is no share of anything rated.")
        if isinstance(limit, bool) or not isinstance(limit, int | float | np.number) or not np.isfinite(limit):
            raise ValueError(f"`limit` must be a finite number, got {limit!r}.")
        return chance_of(table, measure, limit)

    def response(self, variant: int) -> Response:
        """Return the whole response of a variant: read if it was kept (`keep="responses"`), else simulated now.

        Both are the same, bit for bit, where the study's versions are installed.
        """
        variant = whole_number(variant)
        kept = kept_response(self.folder, variant)
        return self.study.response(variant) if kept is None else kept

    @cached_property
    def study(self) -> "Study":
        """The study itself, made from the folder alone."""
        from wirerope_mj.studies.study import Study  # which returns results

        content, folder = self.inputs, self.folder
        model = check_inside(folder, content["model"])
        for motion in content["motions"]:
            check_records(motion, folder)
        vary = {one["name"]: {key: value for key, value in one.items() if key != "name"} for one in content["vary"]}
        return Study(
            model=model,
            changes=read_changes(folder / content["model"]["changes"]) if "changes" in content["model"] else (),
            motions=[motion_from_dict(motion, folder=folder) for motion in content["motions"]],
            vary={name: distribution_from_dict(value) for name, value in vary.items()},
            variants=content["sampling"]["variants"],
            sampling=content["sampling"]["method"],
            seed=content["sampling"]["seed"],
            name=content["name"],
            question=content["question"],
            **content["simulate"],
        )


def load_study(folder: str | Path) -> StudyResult:
    """Return the result of a study from its folder alone; of one that was interrupted, what is done of it.

    Raises:
        RecordError: the folder is not that of a study, or is damaged.
    """
    folder = Path(folder)
    content = read_inputs(folder)
    complete = (folder / TABLE).is_file()
    if "search" in content:
        from wirerope_mj.studies.search.result import SearchResult  # which is a result, too

        designs = read_table(folder, ["variant"]).num_rows if complete else 0
        return SearchResult(folder=folder, inputs=content, variants=designs, complete=complete)
    variants = int(content["sampling"]["variants"])
    if complete and (rows := read_table(folder, ["variant"]).num_rows) != variants:
        raise RecordError(
            f"{folder / TABLE}: the study has {variants} variants, and this table {rows} rows: it was changed, or is that of "
            "another study. Put a copy in its place, or compute the study again with --force (`force=True`)."
        )
    return StudyResult(folder=folder, inputs=content, variants=variants, complete=complete)
