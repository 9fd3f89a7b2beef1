"""The folder of a study: the parts that are done, the table that they make, and whole responses that are kept on request."""

import shutil
import tempfile
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from itertools import chain
from pathlib import Path

import pyarrow as pa
import pyarrow.compute as pc
import pyarrow.parquet as pq
import tomli_w

from wirerope_mj.engine.response import Response, load_response
from wirerope_mj.foundation.arrays import Entries
from wirerope_mj.foundation.atomic_files import atomic_file, atomic_folder, place_named, worked_on_alone, write_json
from wirerope_mj.foundation.errors import DiskFullError, RecordError, SimulationError
from wirerope_mj.foundation.half_written import clear_half_written
from wirerope_mj.foundation.regular_files import regular
from wirerope_mj.studies.definition import StudyDefinition
from wirerope_mj.studies.engines.compute import DONE, Part
from wirerope_mj.studies.inputs_file import RESPONSES, STUDY, check_same, read_inputs, write_inputs
from wirerope_mj.studies.stored_table import PARTS, TABLE, StoredTable

SUMMARY = "summary.json"
MARKS = (STUDY,)  # By these files a folder is known as that of a study
# Stands in the name of a part whose process died: its rows are in the table, and the chunk is computed again on resume.
_DIED = ".died"
# Numbers, at least, in one row group of the table: 8 MB. So much is held while it is joined, and to read one row of it.
ROW_GROUP = 2**20


@contextmanager
def study_folder(
    study: StudyDefinition, folder: Path, *, keep: str, resume: bool, force: bool, when_done: Callable[[Path], object],
    search: Entries | None = None,
) -> Iterator[Path]:  # fmt: skip
    """Lend the folder to compute `study` in: `folder`, where finished parts are kept, or a hidden one if it replaces a study.

    A study that `force` replaces stays as it is until the block ends well and the new one is whole, which stands in a hidden
    folder until then. `when_done` is called with the folder of the study that is computed, which stays whatever that raises,
    unless something could not be written.
    `search` is what a search adds to `study.toml`. Raises what `prepare` and `computed_alone` do; SimulationError if
    processes of a study that would replace another died, or all its variants failed.
    """
    if resume or not force or not (folder / STUDY).is_file():
        with computed_alone(folder, prepare(study, folder, keep=keep, resume=resume, search=search)):
            yield folder
            when_done(folder)
        return
    failure: Exception | None = None
    with worked_on_alone(folder, kind="study"), atomic_folder(folder, force=True, kind="study", marks=MARKS) as temporary_path:
        _begin(study, temporary_path, keep, search)
        yield temporary_path
        check_whole(temporary_path, folder)
        try:
            with place_named(folder):
                when_done(temporary_path)
        except Exception as error:
            if isinstance(error, OSError) or isinstance(error.__cause__, OSError):
                raise  # what could not be written is missing: it is not whole
            failure = error
    if failure is not None:
        raise failure


def check_whole(new: Path, folder: Path) -> None:
    """Raise SimulationError if the study computed in `new` must not replace the one in `folder`."""
    rows = StoredTable(new, str)
    reason = ""
    if dead_chunks(new):
        reason = "processes that computed variants died."
    elif DONE not in pc.unique(rows["status"]).to_pylist():
        reason = f"every variant failed; variant 0: {rows['message'][0]}"
    if reason:
        raise SimulationError(f"{folder}: {reason} The study that was there is as it was.")


def prepare(study: StudyDefinition, folder: Path, *, keep: str, resume: bool, search: Entries | None = None) -> str:
    """Prepare `folder` for a study, which is new or continues with `resume`, and return the study's id.

    Without a part that is done there is nothing to go on with, and nothing to lose. A table with rows of chunks whose
    process died is taken away again, but none of its parts. RecordError if something else stands there, or a study that is
    not resumed, or that another process works on.
    """
    clear_half_written(folder.resolve().parent)
    if not (folder / STUDY).is_file():
        with atomic_folder(folder, force=False, kind="study", marks=MARKS) as temporary_path:
            return _begin(study, temporary_path, keep, search)
    with worked_on_alone(folder, kind="study"):  # nobody else, before anything is taken away
        if resume or not _begun(folder):
            with tempfile.TemporaryDirectory() as temporary:
                computed = (folder / TABLE).is_file() and not dead_chunks(folder)
                check_same(folder, write_inputs(study, Path(temporary), keep, search), computed=computed)
            if dead_chunks(folder):
                for name in (SUMMARY, TABLE):
                    (folder / name).unlink(missing_ok=True)
            return str(read_inputs(folder)["id"])
        raise RecordError(
            f"{folder}: there is a study already. Go on with it with --resume (`resume=True`), replace it with --force "
            "(`force=True`), or choose another folder."
        )


def _begin(study: StudyDefinition, folder: Path, keep: str, search: Entries | None) -> str:
    """Prepare an empty folder for a study without finished parts, and return its id."""
    content = write_inputs(study, folder, keep, search)
    (folder / STUDY).write_text(tomli_w.dumps(content), encoding="utf-8")
    (folder / PARTS).mkdir()
    return str(content["id"])


@contextmanager
def computed_alone(folder: Path, identity: str) -> Iterator[None]:
    """Lock the folder of the study of that id during the block; on a full disk finished parts are kept.

    RecordError if another process works on it, or has put another study there since `prepare`; DiskFullError if there is no
    space left.
    """
    with worked_on_alone(folder, kind="study"):
        if read_inputs(folder)["id"] != identity:
            raise RecordError(f"{folder}: another process has put another study here just now. Choose another folder.")
        try:
            with place_named(folder):
                yield
        except DiskFullError as error:
            if not _begun(folder):
                shutil.rmtree(folder, ignore_errors=True)
                raise
            raise DiskFullError(
                f"{folder}: there is no space left. What is done is kept: free some space, and go on with --resume "
                "(`resume=True`)."
            ) from error.__cause__


def _begun(folder: Path) -> bool:
    """Tell whether any chunk of a study is finished."""
    return bool(finished_chunks(folder) or (folder / TABLE).is_file())


def finished_chunks(folder: Path) -> set[int]:
    """Return the numbers of the finished chunks; those whose process died are not finished."""
    return {int(path.stem) for path in (folder / PARTS).glob("*.parquet") if path.stem.isdigit()}


def dead_chunks(folder: Path) -> set[int]:
    """Return the numbers of the chunks whose process died and that have not been computed since."""
    return {int(path.name.split(".")[0]) for path in (folder / PARTS).glob(f"[0-9]*{_DIED}.parquet")} - finished_chunks(folder)


def write_part(folder: Path, part: Part) -> None:
    """Write the part of one chunk, each file atomically, the part itself last."""
    for variant, content in part.responses.items():
        path = _response_file(folder, variant)
        path.parent.mkdir(exist_ok=True)
        with atomic_file(path, clear=False) as beside:
            beside.write_bytes(content)
    with atomic_file(part_path(folder, part.number, _DIED if part.died else ""), clear=False) as temporary_path:
        pq.write_table(part.table, temporary_path)
    if not part.died:
        part_path(folder, part.number, _DIED).unlink(missing_ok=True)


def parts(folder: Path, numbers: list[int]) -> Iterator[pa.Table]:
    """Yield the rows of chunks by number, in tables of as many chunks as make `ROW_GROUP` numbers."""
    tables: list[pa.Table] = []
    for number in numbers:
        path = part_path(folder, number)
        tables.append(read_part(path if path.is_file() else part_path(folder, number, _DIED)))
        if sum(table.num_rows * table.num_columns for table in tables) >= ROW_GROUP or number == numbers[-1]:
            yield pa.concat_tables(tables).combine_chunks()
            tables = []


def read_part(path: Path) -> pa.Table:
    """Return the rows of one chunk; RecordError if its file is damaged."""
    try:
        return pq.read_table(regular(path))
    except (OSError, pa.ArrowException):
        raise RecordError(
            f"{path}: this part of the study is damaged. Remove it, and go on with --resume (`resume=True`): its variants are "
            "computed again."
        ) from None


def finish(folder: Path, chunks: int, summary: Callable[[], Entries]) -> None:
    """Write the table from all parts, and the summary, if they do not exist, and remove the parts.

    They stay where a process died, so that the study can go on. `summary` is asked once the table is there.
    """
    if not (folder / TABLE).is_file():
        tables = parts(folder, list(range(chunks)))
        first = next(tables)
        with atomic_file(folder / TABLE) as temporary_path, pq.ParquetWriter(temporary_path, first.schema) as writer:
            for table in chain([first], tables):
                writer.write_table(table)
    if not (folder / SUMMARY).is_file():
        write_json(folder / SUMMARY, summary())
    if not dead_chunks(folder):
        shutil.rmtree(folder / PARTS, ignore_errors=True)
    for path in (folder, folder / RESPONSES):  # of a process that was killed while it wrote
        clear_half_written(path)


def part_path(folder: Path, number: int, ending: str = "") -> Path:
    return folder / PARTS / f"{number:06d}{ending}.parquet"


def kept_response(folder: Path, variant: int) -> Response | None:
    """Return the response of a variant as it was kept in the study's `folder`; None if it was not.

    RecordError if its file is damaged.
    """
    path = _response_file(folder, variant)
    try:
        return load_response(path) if path.is_file() else None
    except RecordError as error:
        raise RecordError(f"{error} It was kept by a study: remove it, and it is simulated when it is asked for.") from None


def kept_numbers(folder: Path) -> set[int]:
    """Return the numbers of the variants whose responses are kept in the study's `folder`."""
    return {int(path.stem) for path in (folder / RESPONSES).glob("*.parquet") if path.stem.isdigit()}


def _response_file(folder: Path, variant: int) -> Path:
    return folder / RESPONSES / f"{variant:06d}.parquet"
