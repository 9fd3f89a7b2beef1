"""Base motions from stored parameters and from files of levels, and copies of the files that they were read from."""

import inspect
import shutil
from collections.abc import Sequence
from dataclasses import dataclass, field
from pathlib import Path
from typing import Annotated

from wirerope_mj.foundation.arguments import nonzero
from wirerope_mj.foundation.arrays import Entries
from wirerope_mj.foundation.errors import ModelError
from wirerope_mj.foundation.regular_files import file_inside
from wirerope_mj.foundation.resources import scenarios_folder
from wirerope_mj.foundation.structure import Among, Key, Place, structure
from wirerope_mj.foundation.toml_file import read_toml
from wirerope_mj.motions.motion import BaseMotion
from wirerope_mj.motions.registry import BY_KIND, SPOKEN_MOTIONS
from wirerope_mj.motions.scaled import Scaled
from wirerope_mj.motions.spoken import motion_from_phrase


def motion_from_dict(stored: Entries, *, folder: str | Path | None = None) -> BaseMotion:
    """Make the motion that `BaseMotion.to_dict` stored; its numbers are the same to the last bit.

    Relative paths of records start in `folder`, the current one by default.

    Raises:
        ModelError: the kind of motion is unknown, or a parameter is missing or unknown.
        RecordError: the file of a record is missing or not a record.
        ValueError: A parameter is out of its range.
    """
    parameters = dict(stored)
    kind = parameters.pop("kind", None)
    if kind not in BY_KIND:
        raise ModelError(f"Unknown kind of motion {kind!r}; known kinds: {', '.join(BY_KIND)}.")
    make = BY_KIND[kind].maker()
    known = inspect.signature(make).parameters
    unknown = [name for name in parameters if name not in known]
    missing = [name for name, item in known.items() if item.default is item.empty and name not in parameters]
    for names, fault in ((unknown, "unknown"), (missing, "missing")):
        if names:
            raise ModelError(f"Motion {kind!r}: {fault} {', '.join(names)}; its parameters are {', '.join(known)}.")
    if "path" in parameters and folder is not None:
        parameters["path"] = Path(folder) / parameters["path"]
    if "motion" in parameters:
        parameters["motion"] = motion_from_dict(parameters["motion"], folder=folder)
    if "terms" in parameters:
        parameters["terms"] = tuple(motion_from_dict(term, folder=folder) for term in parameters["terms"])
    return make(**parameters)


def copy_records(motions: Sequence[BaseMotion], folder: Path) -> dict[Path, str]:
    """Copy the files of some motions to `folder`/inputs and return their names there, relative to `folder`."""
    names: dict[Path, str] = {}
    for path in dict.fromkeys(path for motion in motions for path in motion.files):
        name, number = f"inputs/{path.name}", 1
        while name in names.values():
            number += 1
            name = f"inputs/{path.stem}-{number}{path.suffix}"
        (folder / "inputs").mkdir(exist_ok=True)
        shutil.copyfile(path, folder / name)
        names[path] = name
    return names


def check_records(motion: Entries, folder: Path) -> None:
    """Raise RecordError if a motion that `folder` holds, as `to_dict` stored it, names a record that is not in the folder."""
    if "path" in motion:
        file_inside(folder, motion["path"], "record")
    for part in (*motion.get("terms", []), *([motion["motion"]] if "motion" in motion else [])):
        check_records(part, folder)


@dataclass(frozen=True, kw_only=True)
class Level:
    """A motion of a file of levels."""

    phrase: Annotated[dict[str, str], Among(SPOKEN_MOTIONS)] = field(default_factory=dict)  #: in the words of its kind
    factor: float | None = None  #: on it

    def __post_init__(self) -> None:
        if len(self.phrase) != 1:
            raise ValueError(f"it says one of {', '.join(SPOKEN_MOTIONS)}; got {', '.join(self.phrase) or 'nothing'}.")


@dataclass(frozen=True, kw_only=True)
class Levels:
    """A file of levels: motions of a test, all of which are added."""

    motions: Annotated[tuple[Level, ...], Key("motion")] = ()
    standard: str = ""  #: what the levels are from

    def __post_init__(self) -> None:
        if not self.motions:
            raise ValueError('there is no table [[motion]]; one says for instance half-sine = "15 g 11 ms z".')


def level_templates() -> dict[str, Path]:
    """Return the files of levels that ship with the package, to be filled in, by name."""
    return {path.stem: path for path in sorted((scenarios_folder() / "levels").glob("*.toml"))}


def motion_of_levels(path: Path) -> BaseMotion:
    """Return the sum of the motions of a file of levels.

    The file has `standard`, a text, and tables `[[motion]]`, each of which says one motion, `half-sine = "15 g 11 ms z"`, and
    maybe `factor`. A file that a phrase names lies beside it.

    Raises:
        ModelError: the file cannot be read, a key is unknown, or a level is still open; names the file and the motion.
        RecordError: a file that it names cannot be read.
    """
    place = Place(path)
    levels = structure(Levels, read_toml(path, "file of levels"), place)
    motions: list[BaseMotion] = []
    for number, level in enumerate(levels.motions):
        ((kind, phrase),) = level.phrase.items()
        try:
            motion = motion_from_phrase(kind, phrase, folder=path.parent)
            motions.append(motion if level.factor is None else Scaled(motion, nonzero("factor", level.factor)))
        except ValueError as error:
            raise place.at("motion", number).fault(str(error)) from None
    return sum(motions[1:], start=motions[0])
