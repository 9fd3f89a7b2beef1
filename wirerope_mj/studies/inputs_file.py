"""The inputs of a study in `study.toml`, their digest by which its folder is known, and versions that its numbers depend on."""

import hashlib
import inspect
import re
from dataclasses import dataclass, field
from functools import cache
from pathlib import Path
from typing import Any, Literal, get_args

import pyarrow as pa
import tomli_w

from wirerope_mj.engine.response.checked import check_motion
from wirerope_mj.engine.system.model_files import model_table, write_model
from wirerope_mj.foundation.arguments import one_of
from wirerope_mj.foundation.arrays import Entries
from wirerope_mj.foundation.errors import RecordError
from wirerope_mj.foundation.plain_text import quoted
from wirerope_mj.foundation.resources import version_of
from wirerope_mj.foundation.structure import Place, keys_of, structure
from wirerope_mj.foundation.toml_file import flat_entries, read_toml
from wirerope_mj.motions.registry import copy_records
from wirerope_mj.studies.definition import StudyDefinition
from wirerope_mj.studies.vary.distributions import Distribution, distribution_to_dict

_PACKAGES = ("wirerope-mj", "mujoco", "numpy", "scipy", "numba")  # Packages on which the last bit of a number may depend
_SHOWS = ("cli", "views", "runs")  # Wings that show what is there, and compute no row


@cache
def versions() -> dict[str, str]:
    """Return the versions of the packages that compute by name, and as "code" a digest of this package's own files.

    The digest tells a checkout that was changed from one that was not, which have the same version.
    """
    package, digest = Path(__file__).parents[1], hashlib.sha256()
    for path in sorted(package.rglob("*.py")):
        relative = path.relative_to(package)
        if relative.parts[0] not in _SHOWS:
            digest.update(f"{relative.as_posix()}\n".encode() + path.read_bytes())
    return {**{name: version_of(name) for name in _PACKAGES}, "code": digest.hexdigest()[:16]}


STUDY = "study.toml"
PEAKS, RESPONSES = "peaks", "responses"  # Kept of each variant: the measures of its peaks, or its whole response, too
KEPT = (PEAKS, RESPONSES)
FIRST = 1  # The format in which "body/NAME/centre/x" and "mount/NAME/position/x" were shifts
_SHIFT = re.compile(r"^(body/.+/centre|mount/.+/position)(?=/[xyz]$)")
FORMAT = 2  # Of these files; those of format 1 are read, too, but such a study does not resume
_TEXTS = ("id", "name", "question")  # Keys that may differ between two folders of the same study
_FILES = "files."  # Start of the keys of digests of model and records
_KINDS: dict[str, type] = {kind.__name__: kind for kind in get_args(Distribution)}
_REMEDY = "Take the file from another copy of the folder."


@dataclass(frozen=True, kw_only=True)
class StudyModel:
    """The model of a study, by its files in the folder."""

    file: str
    changes: str | None = None  #: what a variant differs by
    path: str | None = None

    def __post_init__(self) -> None:
        for key, value in vars(self).items():
            if value is not None and "\0" in value:
                raise ValueError(f"`{key}` must be the path of a file, got {quoted(value)}.")


@dataclass(frozen=True, kw_only=True)
class StudySimulate:
    """How the variants of a study are simulated; the study itself checks the values."""

    duration: Any
    timestep: Any
    sample_rate: Any
    initial: Any


@dataclass(frozen=True, kw_only=True)
class Sampling:
    """How the inputs of a study are sampled."""

    method: str
    variants: int
    seed: int


@dataclass(frozen=True, kw_only=True)
class StudyInputs:
    """The inputs of a study."""

    format: Literal[1, 2]
    id: str  #: a digest of all other keys but the next two
    name: str
    question: str
    model: StudyModel
    simulate: StudySimulate
    sampling: Sampling
    vary: tuple[Entries, ...]  #: `name`, `kind` of the distribution and its parameters
    motions: tuple[Entries, ...]  #: of the base
    versions: Entries  #: of the packages that compute
    files: Entries = field(default_factory=dict)  #: digests of model and records; the first format has none

    def __post_init__(self) -> None:
        for number, table in enumerate(self.vary):
            name = f"vary.{number}"
            if not isinstance(table.get("name"), str):
                raise ValueError(f"`{name}` must be a table with the `name` of what varies, got {quoted(table)}.")
            one_of(f"{name}.kind", table.get("kind"), _KINDS)
            given = {key: value for key, value in table.items() if key not in ("name", "kind", "choices")}
            choices = table.get("choices", [])
            if not isinstance(choices, list):
                raise ValueError(f"`{name}.choices` must be a list, got {quoted(choices)}.")
            for flag in ("relative", "each"):
                if not isinstance(given.get(flag, False), bool):
                    raise ValueError(f"`{name}.{flag}` must be true or false, got {quoted(given[flag])}.")
            try:
                inspect.signature(_KINDS[table["kind"]]).bind(*choices, **given)
            except TypeError as error:
                raise ValueError(f"`{name}`: {str(error).replace('an unexpected keyword', 'an unknown')}.") from None
        for number, motion in enumerate(self.motions):
            check_motion(f"motions.{number}", motion)


def read_inputs(folder: Path) -> Entries:
    """Read `study.toml` of a study, with today's names of its inputs.

    RecordError if there is no study, or it is damaged.
    """
    path = folder / STUDY
    if not path.is_file():
        raise RecordError(f"{folder}: this is not a study; there is no {STUDY} here.")
    content = read_toml(path, "file of a study", RecordError, _REMEDY)
    if "format" in content and content["format"] not in (FIRST, FORMAT):
        raise RecordError(f"{path}: `format` is {content['format']!r}, not {FORMAT}; use the version that wrote it.")
    if "id" in content and content["id"] != identity(content):  # a digest of all other keys: they are what was written
        raise RecordError(f"{path}: this file was changed after it had been written; its study cannot go on.")
    known = {key: value for key, value in content.items() if key in keys_of(StudyInputs)}
    structure(StudyInputs, known, Place(path, error=RecordError, remedy=_REMEDY))
    # Today's names; the format stays, which says how the table is written.
    return {**content, "vary": [{**quantity, "name": todays_name(quantity["name"], content)} for quantity in content["vary"]]}


def write_inputs(study: StudyDefinition, folder: Path, keep: str, search: Entries | None) -> Entries:
    """Write model and records into `folder` and return the content of `study.toml`."""
    model = write_model(study.base, folder / "model")
    names = copy_records(study.motions, folder)
    files = sorted(path for path in folder.rglob("*") if path.is_file())
    work = study.work
    content: Entries = {
        "format": FORMAT, "name": study.name, "question": study.question.strip(),
        "model": model_table(study.base, model),
        "simulate": {
            "duration": work.duration, "timestep": work.timestep, "sample_rate": work.sample_rate,
            "initial": work.initial,
        },
        "sampling": {"method": study.sampling, "variants": study.size, "seed": study.seed},
        "vary": [{"name": name, **distribution_to_dict(value)} for name, value in study.vary.items()],
        "motions": [motion.to_dict(files=names) for motion in study.motions],
        "versions": versions(),
        "files": {str(path.relative_to(folder)): hashlib.sha256(path.read_bytes()).hexdigest() for path in files},
    }  # fmt: skip
    if keep != PEAKS:
        content["keep"] = keep
    if search is not None:
        content["search"] = search
    return {"id": identity(content), **content}


def identity(content: Entries) -> str:
    """Return the id of a study: a digest of every input that a number may depend on."""
    inputs = {key: value for key, value in content.items() if key not in _TEXTS}
    return hashlib.sha256(tomli_w.dumps(inputs).encode()).hexdigest()[:16]


def check_same(folder: Path, content: Entries, *, computed: bool) -> None:
    """Raise RecordError if the folder holds another study than that of `content`; `computed`: it is complete."""
    stored = read_inputs(folder)
    if stored["id"] == content["id"]:
        return
    if stored["format"] != FORMAT:
        raise RecordError(
            f"{folder}: an earlier version wrote this study, in which `centre` and `position` were the names of shifts. It can "
            "be read (`wirerope study-report`, `load_study`), but does not go on; nothing in it was touched. Choose another "
            "folder, or begin it anew with --force (`force=True`)."
        )
    old, new = flat_entries(stored), flat_entries(content)
    differing = [key for key in {**old, **new} if key not in _TEXTS and old.get(key) != new.get(key)]
    if computed:  # whoever computed it
        differing = [key for key in differing if not key.startswith("versions.")]
    if not differing:
        return
    key = min(differing, key=lambda name: (name == "keep", name.startswith("versions."), not name.startswith(_FILES)))
    raise RecordError(f"{folder}: {_difference(key, old, new)}")


def _difference(key: str, old: Entries, new: Entries) -> str:
    """Describe the difference between a study in a folder and the one to be resumed."""
    if key == "keep":
        kept = old.get(key, PEAKS)
        return f"this study keeps {kept}; go on with it with --keep {kept} (`keep={kept!r}`), or choose another folder."
    ways = "Nothing in it was touched. Choose another folder, or begin it anew with --force (`force=True`)."
    if key == "versions.code":
        return f"the code of wirerope-mj has changed since this study began, and one table would hold rows of both. {ways}"
    if key.startswith("versions."):
        name = key.removeprefix("versions.")
        return (
            f"this study began with {name} {old.get(key, 'absent')} and would go on with {new.get(key, 'absent')}: one table "
            f"would hold rows of both. {ways}"
        )
    if key.startswith(_FILES):
        name, change = key.removeprefix(_FILES), "has changed" if key in old and key in new else "is not in both"
        return f"this is the folder of another study: {name} {change}. {ways}"
    return (
        f"this is the folder of another study ({key} is {old.get(key, 'absent')!r} there and "
        f"{new.get(key, 'absent')!r} here); nothing in it was touched. Choose another folder, or replace it with --force "
        "(`force=True`)."
    )


def todays_name(name: str, content: Entries) -> str:
    """Return today's name of an input: of format 1 "body/floor/centre/x" is "body/floor/centre_shift/x"."""
    return _SHIFT.sub(r"\1_shift", name) if content["format"] == FIRST else name


def todays_table(table: pa.Table, content: Entries) -> pa.Table:
    """Return the table of a study's folder with today's names."""
    return table.rename_columns([todays_name(name, content) for name in table.column_names])
