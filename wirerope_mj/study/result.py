"""What a study has found: its table, and the folder it stands in."""

from dataclasses import dataclass
from functools import cached_property
from pathlib import Path
from typing import TYPE_CHECKING

import pyarrow as pa
import pyarrow.parquet as pq

if TYPE_CHECKING:
    from wirerope_mj.study.study import Study

TABLE = "variants.parquet"


@dataclass(frozen=True)
class StudyResult:
    """The result of a study.

    Columns of the table: `variant` (int64), inputs (one for every sampled number, by its name in `vary`, or with the
    mount's own name in place of the pattern where each has its own: "mount/m01/axial/alpha"), measures (float64, SI, NaN where
    not judged), `status` ("done" or "failed"), `message`.

    Attributes:
        folder: where it stands.
        study: what was asked.
        message: one sentence on how it went.
    """

    folder: Path
    study: "Study"
    message: str

    @cached_property
    def table(self) -> pa.Table:
        """The table, one row for every variant."""
        return pq.read_table(self.folder / TABLE)

    @property
    def failed(self) -> dict[int, str]:
        """Messages of the variants that failed, by number."""
        rows = self.table.select(["variant", "status", "message"]).to_pylist()
        return {row["variant"]: row["message"] for row in rows if row["status"] == "failed"}


def load_study(folder: str | Path) -> StudyResult:
    """Return the result of a study from its folder alone."""
    raise NotImplementedError
