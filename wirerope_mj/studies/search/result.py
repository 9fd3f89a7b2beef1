"""The result of a search: the table of all its designs, and the front of those that nothing beats."""

from dataclasses import dataclass
from functools import cached_property
from pathlib import Path

import numpy as np
import pyarrow as pa

from wirerope_mj.engine.response.scene import Scene
from wirerope_mj.engine.simulation.recorder import scene_of
from wirerope_mj.foundation.arrays import Booleans
from wirerope_mj.foundation.errors import RecordError
from wirerope_mj.studies.definition import StudyDefinition
from wirerope_mj.studies.ended import why_early
from wirerope_mj.studies.folder import TABLE, read_table
from wirerope_mj.studies.inputs_file import read_inputs
from wirerope_mj.studies.result import StudyResult
from wirerope_mj.studies.results.measure import measure_of
from wirerope_mj.studies.search.evolution import feasible, front, nearest, nearest_first
from wirerope_mj.studies.vary.quantity import acts

GENERATION = "generation"  # Column of the table: in which generation a design was first made
_LINE = 1e-9  # Distance from the line between the front's ends that is rounding


@dataclass(frozen=True, kw_only=True, repr=False)
class SearchResult(StudyResult):
    """The result of a search: that of a study whose variants are all designs, in the order in which they were made.

    The table has one more column, `generation`, from 0.
    """

    @property
    def minimise(self) -> tuple[str, ...]:
        """The measures that were to be small."""
        return tuple(self.inputs["search"]["minimise"])

    @property
    def limits(self) -> dict[str, float]:
        """Largest value of measures, SI."""
        return {one["measure"]: one["largest"] for one in self.inputs["search"]["limits"]}

    @property
    def start(self) -> int:
        """Number of the designs that were given: variants 0, 1, ..."""
        return len(self.inputs["search"]["start"])

    @cached_property
    def study(self) -> StudyDefinition:
        """The study whose variants are the designs, made from the folder alone."""
        return super().study.of(self.table)

    @cached_property
    def feasible(self) -> Booleans:
        """Mask of the designs that were simulated and keep the limits, (n,)."""
        return feasible(self.table, self.minimise, self.limits)

    @cached_property
    def front(self) -> pa.Table:
        """The rows of the designs that no other one within the limits beats, by the first of what was minimised."""
        rows = front(self.table, self.minimise, self.limits)
        return self.table.take(pa.array(rows, type=pa.int64()))

    @cached_property
    def message(self) -> str:
        """One sentence on how it went."""
        if not self.complete:
            return f"{self.folder}: not complete; go on with it with --resume (`resume=True`)."
        table = self.table
        generations = int(np.asarray(table[GENERATION]).max()) + 1
        text = f"{self.variants} designs in {generations} generations, {len(self.failed)} failed, "
        if self.feasible.any():
            front = self.front.num_rows
            return f"{text}{self.feasible.sum()} within the limits, {front} of them on the front.{self.missing}"
        return f"{text}none within the limits. {self._nearest()}{self.missing}"

    def scene(self, variant: int) -> Scene:
        """Return the modelled geometry of a design, to be drawn."""
        return scene_of(self.study.system(variant))

    def absent(self, variant: int) -> list[str]:
        """Return the mounts that a design has not: those that are not fitted."""
        mounts = self.study.system(variant).mounts
        return [name for name, mount in mounts.items() if not acts(mount.isolator)]

    @cached_property
    def knee(self) -> int | None:
        """Number of the front's design that is farthest below the line between its ends, each measure relative to its range.

        Beyond it, either way, little is gained for much. None where fewer than two measures are minimised or three designs
        are on the front, and where none lies below the line: such a front has no knee.
        """
        if len(self.minimise) != 2 or self.front.num_rows < 3:
            return None
        x, y = (np.asarray(self.front[name]) for name in self.minimise)
        distance = (x - x[0]) / np.ptp(x) + (y - y[-1]) / np.ptp(y)  # the ends have 1
        row = int(np.argmin(distance))
        return int(self.front["variant"][row].as_py()) if distance[row] < 1.0 - _LINE else None

    @cached_property
    def chosen(self) -> list[int]:
        """Numbers of the designs in the order in which they are worth a look: of the front its knee, its ends, those between.

        Without a front they are all that can be judged, the nearest to the limits first.
        """
        if not self.front.num_rows:
            rows = nearest_first(self.table, self.minimise, self.limits)
            return [int(self.table["variant"][row].as_py()) for row in rows]
        front = [int(number) for number in self.front["variant"].to_pylist()]
        spread = [front[round(fraction * (len(front) - 1))] for fraction in (0.0, 1.0, 0.5, 0.25, 0.75)]
        return list(dict.fromkeys([*([] if self.knee is None else [self.knee]), *spread, *front]))

    @property
    def shown(self) -> tuple[str, ...]:
        """The measures that are displayed of a design: what was minimised, what is limited, and the number of mounts."""
        return tuple(dict.fromkeys([*self.minimise, *self.limits, "mounts"]))

    def remark(self, variant: int) -> str:
        """Return "given", "knee", both or nothing."""
        return ", ".join(["given"] * (variant < self.start) + ["knee"] * (variant == self.knee))

    def _nearest(self) -> str:
        """Return as text the design that is nearest to the limits."""
        closest = nearest(self.table, self.minimise, self.limits)
        if closest is None:
            first = min(self.failed, default=None)
            why = why_early(self.table) or (
                "nothing is rated or stated by which the designs would be judged" if first is None else self.failed[first]
            )
            return f"None has values of all that is minimised or limited: {why.rstrip('.')}."
        row, name, over = closest
        measure, value = measure_of(name), self.table[name][row].as_py()
        number, percent = self.table["variant"][row].as_py(), 100.0 * over
        above = f"{percent:.2g} %" if percent < 99.5 else f"{percent:.0f} %"
        return (
            f"The nearest is design {number}: {measure.text} is {measure.factor * value:.4g} {measure.unit}, "
            f"{above} above its limit of {measure.factor * self.limits[name]:.4g} {measure.unit}."
        )


def read_result(folder: Path, study_class: type[StudyDefinition]) -> StudyResult:
    """Return the result in a folder; its `study` will be of this class.

    RecordError if the folder is not that of a study, or is damaged.
    """
    content = read_inputs(folder)
    complete = (folder / TABLE).is_file()
    rows = read_table(folder, ["variant"]).num_rows if complete else 0
    if "search" in content:
        return SearchResult(folder=folder, inputs=content, variants=rows, complete=complete, study_class=study_class)
    variants = int(content["sampling"]["variants"])
    if complete and rows != variants:
        raise RecordError(
            f"{folder / TABLE}: the study has {variants} variants, and this table {rows} rows: it was changed, or is that of "
            "another study. Put a copy in its place, or compute the study again with --force (`force=True`)."
        )
    return StudyResult(folder=folder, inputs=content, variants=variants, complete=complete, study_class=study_class)
