"""Results of studies and searches from their folders."""

from pathlib import Path

from wirerope_mj.foundation.errors import RecordError
from wirerope_mj.studies.definition import StudyDefinition
from wirerope_mj.studies.folder import TABLE, read_table
from wirerope_mj.studies.inputs_file import read_inputs
from wirerope_mj.studies.result import StudyResult
from wirerope_mj.studies.search.result import SearchResult


def read_result(folder: Path, study_class: type[StudyDefinition]) -> StudyResult:
    """Return the result in a folder; its `study` will be of this class.

    Raises:
        RecordError: the folder is not that of a study, or is damaged.
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
