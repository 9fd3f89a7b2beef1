"""Motions of a TOML file: the levels of a specification, each said in a phrase, and added."""

from pathlib import Path
from typing import Any

from wirerope_mj.foundation.arguments import nonzero
from wirerope_mj.foundation.errors import ModelError
from wirerope_mj.foundation.resources import scenarios_folder
from wirerope_mj.foundation.toml_file import read_toml
from wirerope_mj.motions.motion import BaseMotion
from wirerope_mj.motions.scaled import Scaled
from wirerope_mj.motions.spoken import SPOKEN_MOTIONS, motion_from_phrase


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
    content = read_toml(path, "file of levels")
    unknown = [key for key in content if key not in ("standard", "motion")]
    if unknown:
        raise ModelError(f"{path}: `{unknown[0]}` is unknown; known: standard, motion.")
    if not isinstance(content.get("standard", ""), str):
        raise ModelError(f"{path}: `standard` must be a text, got {content['standard']!r}.")
    tables = content.get("motion", [])
    if not isinstance(tables, list) or not tables or not all(isinstance(table, dict) for table in tables):
        raise ModelError(f'{path}: there is no table [[motion]]; one says for instance half-sine = "15 g 11 ms z".')
    motions = [_motion(path, number, table) for number, table in enumerate(tables, start=1)]
    return sum(motions[1:], start=motions[0])


def _motion(path: Path, number: int, table: dict[str, Any]) -> BaseMotion:
    location = f"{path}, motion {number}"
    kinds = [key for key in table if key != "factor"]
    if len(kinds) != 1 or kinds[0] not in SPOKEN_MOTIONS:
        raise ModelError(
            f"{location}: it says one of {', '.join(SPOKEN_MOTIONS)}, and maybe `factor`; got {', '.join(table) or 'nothing'}."
        )
    phrase = table[kinds[0]]
    if not isinstance(phrase, str):
        raise ModelError(
            f'{location}: `{kinds[0]}` must be a text such as "{SPOKEN_MOTIONS[kinds[0]].example}", got {phrase!r}.'
        )
    try:
        motion = motion_from_phrase(kinds[0], phrase, folder=path.parent)
        return Scaled(motion, nonzero("factor", table["factor"])) if "factor" in table else motion
    except ValueError as error:
        raise ModelError(f"{location}: {error}") from None
