"""The folder of a study: every input resolved in `study.toml`, the parts that are done, and the table that they make."""

import hashlib
import json
import shutil
import tempfile
import tomllib
from collections.abc import Callable, Iterator, Sequence
from contextlib import contextmanager
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np
import pyarrow as pa
import pyarrow.parquet as pq
import tomli_w

from wirerope_mj.engine.system.model_files import model_table, write_model
from wirerope_mj.foundation.atomic_files import (
    atomic_file,
    atomic_folder,
    check_folder,
    full_disk_named,
    worked_on_alone,
)
from wirerope_mj.foundation.errors import DiskFullError, RecordError
from wirerope_mj.foundation.half_written import clear_half_written
from wirerope_mj.foundation.toml_file import toml_content
from wirerope_mj.motions.copies import copy_records
from wirerope_mj.studies.engines.compute import Part
from wirerope_mj.studies.inputs.distributions import distribution_to_dict
from wirerope_mj.studies.old_names import FIRST, todays_inputs
from wirerope_mj.studies.responses import PEAKS, RESPONSES, write_response
from wirerope_mj.studies.versions import versions

if TYPE_CHECKING:
    from wirerope_mj.studies.study import Study

STUDY, TABLE, SUMMARY, PARTS = "study.toml", "variants.parquet", "summary.json", "parts"

MARKS = (STUDY,)
"""By these files a folder is known as that of a study."""

FORMAT = 2
"""Of these files; those of format 1 are read, too, but such a study does not go on."""

_WORDS = ("id", "name", "question")
"""What may differ between two folders of the same study."""

_FILES = "files."
"""Begins what is said of model and records, by their digests."""

_DIED = ".died"
"""Stands in the name of a part whose process died: its rows are in the table, and the chunk is computed again on resume."""

ROW_GROUP = 64
"""Parts that are joined in one row group of the table: some 2000 variants, a few MB."""


def prepare(
    study: "Study", folder: Path, *, keep: str, resume: bool, force: bool, search: dict[str, Any] | None = None
) -> str:
    """Make `folder` that of `study`: a new one, or the one of this very study that `resume` goes on with; return its id.

    Without a single part that is done there is nothing to go on with, and nothing to lose. A table with rows of chunks whose
    process died is taken away again, but none of its parts. `search` is what a search adds to `study.toml`.

    Raises:
        RecordError: something else stands there, or a study that is neither resumed nor replaced, or on which another process
            works.
    """
    clear_half_written(folder.resolve().parent)
    if not (folder / STUDY).is_file():
        check_folder(folder, force=force, kind="study", marks=MARKS)
        return _begin(study, folder, keep, search, force=force)
    with worked_on_alone(folder, kind="study"):  # nobody else, before anything is taken away
        if resume or not (_begun(folder) or force):
            with tempfile.TemporaryDirectory() as place:
                _check_same(folder, _write_inputs(study, Path(place), keep, search))
            if dead(folder):
                for name in (SUMMARY, TABLE):
                    (folder / name).unlink(missing_ok=True)
            return str(read_inputs(folder)["id"])
        if force:
            return _begin(study, folder, keep, search, force=force)
        raise RecordError(
            f"{folder}: there is a study already. Go on with it with --resume (`resume=True`), replace it with --force "
            "(`force=True`), or choose another folder."
        )


def _begin(study: "Study", folder: Path, keep: str, search: dict[str, Any] | None, *, force: bool) -> str:
    """Make a new folder of a study, in which nothing is done yet, and return its id."""
    with atomic_folder(folder, force=force, kind="study", marks=MARKS) as beside:
        content = _write_inputs(study, beside, keep, search)
        (beside / STUDY).write_text(tomli_w.dumps(content), encoding="utf-8")
        (beside / PARTS).mkdir()
    return str(content["id"])


@contextmanager
def computed_alone(folder: Path, identity: str) -> Iterator[None]:
    """Hold the folder of the study of that id while the block computes; on a full disk keep what is done, if anything is.

    Raises:
        RecordError: another process works on it, or has put another study there since `prepare`.
        DiskFullError: there is no space left.
    """
    with worked_on_alone(folder, kind="study"):
        if read_inputs(folder)["id"] != identity:
            raise RecordError(f"{folder}: another process has put another study here just now. Choose another folder.")
        try:
            with full_disk_named(folder):
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
    return bool(done(folder) or (folder / TABLE).is_file())


def read_inputs(folder: Path) -> dict[str, Any]:
    """Return the content of a study's `study.toml`, inputs by the names that they have today.

    Raises:
        RecordError: there is no study, or it is damaged.
    """
    path = folder / STUDY
    if not path.is_file():
        raise RecordError(f"{folder}: this is not a study; there is no {STUDY} here.")
    try:
        content = toml_content(path)
    except (OSError, UnicodeDecodeError, tomllib.TOMLDecodeError):
        raise RecordError(f"{path}: this is not the file of a study, nor TOML. Take it from another copy.") from None
    if "format" in content and content["format"] not in (FIRST, FORMAT):
        raise RecordError(f"{path}: `format` is {content['format']!r}, not {FORMAT}; use the version that wrote it.")
    for key in ("format", *_WORDS):
        if key not in content or (key in _WORDS and not isinstance(content[key], str)):
            raise RecordError(f"{path}: this is not the file of a study: `{key}` is missing or no string.")
    if content["id"] != _identity(content):  # a digest of all other keys: they are what was written
        raise RecordError(f"{path}: this file was changed after it had been written; its study cannot go on.")
    return todays_inputs(content)


def done(folder: Path) -> set[int]:
    """Return the numbers of the chunks whose parts stand in the folder; those whose process died are not done."""
    return {int(path.stem) for path in (folder / PARTS).glob("*.parquet") if path.stem.isdigit()}


def dead(folder: Path) -> set[int]:
    """Return the numbers of the chunks whose process died and that have not been computed since."""
    return {int(path.name.split(".")[0]) for path in (folder / PARTS).glob(f"[0-9]*{_DIED}.parquet")} - done(folder)


def write_part(folder: Path, part: Part) -> None:
    """Write the part of one chunk, each file whole or not at all; what is done stands there when all of it does."""
    for variant, content in part.responses.items():
        write_response(folder, variant, content)
    with atomic_file(part_path(folder, part.number, _DIED if part.died else ""), clear=False) as beside:
        pq.write_table(part.table, beside)
    if not part.died:
        part_path(folder, part.number, _DIED).unlink(missing_ok=True)


def parts(folder: Path, numbers: list[int]) -> Iterator[pa.Table]:
    """Yield the rows of some chunks, several together."""
    for first in range(0, len(numbers), ROW_GROUP):
        paths = [
            (part_path(folder, number), part_path(folder, number, _DIED))
            for number in numbers[first : first + ROW_GROUP]
        ]
        tables = [read_part(path if path.is_file() else dead) for path, dead in paths]
        yield pa.concat_tables(tables).combine_chunks()


def read_part(path: Path) -> pa.Table:
    """Return the rows of one chunk; RecordError if its file is damaged."""
    try:
        return pq.read_table(path)
    except (OSError, pa.ArrowException):
        raise RecordError(
            f"{path}: this part of the study is damaged. Remove it, and go on with --resume (`resume=True`): its variants are "
            "computed again."
        ) from None


def read_table(folder: Path, columns: Sequence[str] | None = None) -> pa.Table:
    """Return the table of a study that is complete, or some columns of it; RecordError if its file is damaged or changed."""
    with _table_file(folder) as path:
        table = pq.read_table(path, columns=columns)
    _check_table(folder / TABLE, table, [name for name in _ALWAYS if columns is None or name in columns])
    return table


def _check_table(path: Path, table: pa.Table, names: Sequence[str]) -> None:
    """Raise RecordError unless the columns of these names are what studies write, and the variants are numbered in order."""
    for name in names:
        if name not in table.column_names or table[name].type != _ALWAYS[name] or table[name].null_count:
            raise RecordError(
                f"{path}: column {name!r} must hold {_ALWAYS[name]} in every row; the table was changed. {_COPY}"
            )
    if "variant" in names and not np.array_equal(table["variant"].to_numpy(), np.arange(table.num_rows)):
        raise RecordError(f"{path}: column 'variant' must number the rows from 0 on; the table was changed. {_COPY}")


_ALWAYS = {"variant": pa.int64(), "status": pa.string(), "message": pa.string()}
"""Columns of every study's table, and their types."""

_COPY = "Put a copy in its place, or compute the study again with --force (`force=True`)."


def read_schema(folder: Path) -> pa.Schema:
    """Return names and types of the columns of a study's table; RecordError if its file is damaged."""
    with _table_file(folder) as path:
        return pq.read_schema(path)


@contextmanager
def _table_file(folder: Path) -> Iterator[Path]:
    """Lend the path of the table, and say what can be done if it is damaged."""
    try:
        yield folder / TABLE
    except (OSError, pa.ArrowException):
        remedy = (
            "Remove it, and go on with --resume (`resume=True`): the parts that made it are there."
            if (folder / PARTS).is_dir()
            else f"The parts that made it are gone: {_COPY[0].lower()}{_COPY[1:]}"
        )
        raise RecordError(f"{folder / TABLE}: this table is damaged. {remedy}") from None


def finish(folder: Path, chunks: int, summary: Callable[[], dict[str, Any]]) -> None:
    """Write the table from all parts, and the summary, if they are not there, and remove the parts.

    They stay where a process died, so that the study can go on. `summary` is asked once the table is there.
    """
    if not (folder / TABLE).is_file():
        with atomic_file(folder / TABLE) as beside:
            _write_table(beside, parts(folder, list(range(chunks))))
    if not (folder / SUMMARY).is_file():
        text = json.dumps(summary(), indent=2, allow_nan=False) + "\n"
        with atomic_file(folder / SUMMARY) as beside:
            beside.write_text(text, encoding="utf-8")
    if not dead(folder):
        shutil.rmtree(folder / PARTS, ignore_errors=True)
    for place in (folder, folder / RESPONSES):  # of a process that was killed while it wrote
        clear_half_written(place)


def _write_table(path: Path, tables: Iterator[pa.Table]) -> None:
    first = next(tables)
    with pq.ParquetWriter(path, first.schema) as writer:
        writer.write_table(first)
        for table in tables:
            writer.write_table(table)


def part_path(folder: Path, number: int, ending: str = "") -> Path:
    """Return where the part of a chunk stands."""
    return folder / PARTS / f"{number:06d}{ending}.parquet"


def _write_inputs(study: "Study", folder: Path, keep: str, search: dict[str, Any] | None) -> dict[str, Any]:
    """Write model and records into `folder` and return what `study.toml` says."""
    model = write_model(study.base, folder / "model")
    names = copy_records(study.motions, folder)
    files = sorted(path for path in folder.rglob("*") if path.is_file())
    work = study.work
    content: dict[str, Any] = {
        "format": FORMAT,
        "name": study.name,
        "question": study.question.strip(),
        "model": model_table(study.base, model),
        "simulate": {
            "duration": work.duration,
            "timestep": work.timestep,
            "sample_rate": work.sample_rate,
            "initial": work.initial,
        },
        "sampling": {"method": study.sampling, "variants": study.size, "seed": study.seed},
        "vary": [{"name": name, **distribution_to_dict(value)} for name, value in study.vary.items()],
        "motions": [motion.to_dict(files=names) for motion in study.motions],
        "versions": versions(),
        "files": {str(path.relative_to(folder)): hashlib.sha256(path.read_bytes()).hexdigest() for path in files},
    }
    if keep != PEAKS:
        content["keep"] = keep
    if search is not None:
        content["search"] = search
    return {"id": _identity(content), **content}


def _identity(content: dict[str, Any]) -> str:
    """Return what tells this study from all others: a digest of every input that a number may depend on."""
    inputs = {key: value for key, value in content.items() if key not in _WORDS}
    return hashlib.sha256(tomli_w.dumps(inputs).encode()).hexdigest()[:16]


def _check_same(folder: Path, content: dict[str, Any]) -> None:
    """Raise RecordError if another study than that of `content` stands in the folder."""
    there = read_inputs(folder)
    if there["id"] == content["id"]:
        return
    if there["format"] != FORMAT:
        raise RecordError(
            f"{folder}: an earlier version wrote this study, in which `centre` and `position` were the names of shifts. It can "
            "be read (`wirerope study-report`, `load_study`), but does not go on; nothing in it was touched. Choose another "
            "folder, or begin it anew with --force (`force=True`)."
        )
    old, new = _flat(there), _flat(content)
    other = [key for key in {**old, **new} if key not in _WORDS and old.get(key) != new.get(key)]
    if (folder / TABLE).is_file() and not dead(folder):  # nothing is computed any more, whoever computed it
        other = [key for key in other if not key.startswith("versions.")]
    if not other:
        return
    key = min(other, key=lambda name: (name == "keep", name.startswith("versions."), not name.startswith(_FILES)))
    raise RecordError(f"{folder}: {_difference(key, old, new)}")


def _difference(key: str, old: dict[str, Any], new: dict[str, Any]) -> str:
    """Return in words what tells a study that stands in a folder from the one that was to go on."""
    if key == "keep":
        kept = old.get(key, PEAKS)
        return f"this study keeps {kept}; go on with it with --keep {kept} (`keep={kept!r}`), or choose another folder."
    ways = "Nothing in it was touched. Choose another folder, or begin it anew with --force (`force=True`)."
    if key == "versions.code":
        return (
            f"the code of wirerope-mj has changed since this study began, and one table would hold rows of both. {ways}"
        )
    if key.startswith("versions."):
        name = key.removeprefix("versions.")
        return (
            f"this study began with {name} {old.get(key, 'absent')} and would go on with {new.get(key, 'absent')}: one table "
            f"would hold rows of both. {ways}"
        )
    if key.startswith(_FILES):
        name, word = key.removeprefix(_FILES), "has changed" if key in old and key in new else "is not in both"
        return f"this is the folder of another study: {name} {word}. {ways}"
    return (
        f"this is the folder of another study ({key} is {old.get(key, 'absent')!r} there and "
        f"{new.get(key, 'absent')!r} here); nothing in it was touched. Choose another folder, or replace it with --force "
        "(`force=True`)."
    )


def _flat(content: Any, place: str = "") -> dict[str, Any]:
    """Return the values of nested tables and lists by their places, "simulate.duration"."""
    if not isinstance(content, dict | list):
        return {place: content}
    items = content.items() if isinstance(content, dict) else enumerate(content)
    return {k: v for key, value in items for k, v in _flat(value, f"{place}.{key}" if place else str(key)).items()}
