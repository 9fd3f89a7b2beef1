"""The inputs of a study in `study.toml`, and the digest of them by which a folder is known as that of this study."""

import hashlib
import tomllib
from pathlib import Path
from typing import Any

import tomli_w

from wirerope_mj.engine.system.model_files import model_table, write_model
from wirerope_mj.foundation.errors import RecordError
from wirerope_mj.foundation.toml_file import toml_content
from wirerope_mj.motions.restore import copy_records
from wirerope_mj.studies.checked_inputs import check_inputs
from wirerope_mj.studies.definition import StudyDefinition
from wirerope_mj.studies.inputs.distributions import distribution_to_dict
from wirerope_mj.studies.old_names import FIRST, todays_inputs
from wirerope_mj.studies.responses import PEAKS
from wirerope_mj.studies.versions import versions

STUDY = "study.toml"

FORMAT = 2
"""Of these files; those of format 1 are read, too, but such a study does not resume."""

_TEXTS = ("id", "name", "question")
"""Keys that may differ between two folders of the same study."""

_FILES = "files."
"""Start of the keys of digests of model and records."""


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
    for key in ("format", *_TEXTS):
        if key not in content or (key in _TEXTS and not isinstance(content[key], str)):
            raise RecordError(f"{path}: this is not the file of a study: `{key}` is missing or no string.")
    if content["id"] != identity(content):  # a digest of all other keys: they are what was written
        raise RecordError(f"{path}: this file was changed after it had been written; its study cannot go on.")
    try:
        check_inputs(content)
    except ValueError as error:
        raise RecordError(f"{path}: this is not the file of a study as it was written: {error}") from None
    return todays_inputs(content)


def write_inputs(study: StudyDefinition, folder: Path, keep: str, search: dict[str, Any] | None) -> dict[str, Any]:
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
    return {"id": identity(content), **content}


def identity(content: dict[str, Any]) -> str:
    """Return the id of a study: a digest of every input that a number may depend on."""
    inputs = {key: value for key, value in content.items() if key not in _TEXTS}
    return hashlib.sha256(tomli_w.dumps(inputs).encode()).hexdigest()[:16]


def check_same(folder: Path, content: dict[str, Any], *, computed: bool) -> None:
    """Raise RecordError if another study than that of `content` stands in the folder; `computed`: nothing of it is missing."""
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
    other = [key for key in {**old, **new} if key not in _TEXTS and old.get(key) != new.get(key)]
    if computed:  # whoever computed it
        other = [key for key in other if not key.startswith("versions.")]
    if not other:
        return
    key = min(other, key=lambda name: (name == "keep", name.startswith("versions."), not name.startswith(_FILES)))
    raise RecordError(f"{folder}: {_difference(key, old, new)}")


def _difference(key: str, old: dict[str, Any], new: dict[str, Any]) -> str:
    """Return as text the difference between a study that stands in a folder and the one that was to resume."""
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
        name, change = key.removeprefix(_FILES), "has changed" if key in old and key in new else "is not in both"
        return f"this is the folder of another study: {name} {change}. {ways}"
    return (
        f"this is the folder of another study ({key} is {old.get(key, 'absent')!r} there and "
        f"{new.get(key, 'absent')!r} here); nothing in it was touched. Choose another folder, or replace it with --force "
        "(`force=True`)."
    )


def _flat(content: Any, path: str = "") -> dict[str, Any]:
    """Return the values of nested tables and lists by their paths, "simulate.duration"."""
    if not isinstance(content, dict | list):
        return {path: content}
    items = content.items() if isinstance(content, dict) else enumerate(content)
    return {k: v for key, value in items for k, v in _flat(value, f"{path}.{key}" if path else str(key)).items()}
