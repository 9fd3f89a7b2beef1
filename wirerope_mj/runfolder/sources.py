"""What a run is computed from: scenario, system and motion, read from its folder alone."""

import tomllib
from collections.abc import Mapping
from pathlib import Path
from typing import Any

from wirerope_mj.errors import RecordError
from wirerope_mj.excitation.copies import check_records
from wirerope_mj.excitation.motion import BaseMotion
from wirerope_mj.excitation.restore import motion_from_dict
from wirerope_mj.runfolder.folder import FORMAT, SCENARIO
from wirerope_mj.system import Changes, System, load_system
from wirerope_mj.system.model_files import missing_isolators, read_changes
from wirerope_mj.system.named_files import check_inside
from wirerope_mj.system.varied import with_changes


def scenario_content(folder: Path) -> dict[str, Any]:
    """Return the scenario of a run as it stands in its folder.

    Raises:
        RecordError: the folder is not a run, or its scenario is damaged.
    """
    path = folder / SCENARIO
    if not path.is_file():
        raise RecordError(f"{folder}: this is not a run; there is no {SCENARIO} here.")
    try:
        content = tomllib.loads(path.read_text(encoding="utf-8"))
        if content["format"] != FORMAT:
            raise RecordError(f"{path}: format {content['format']} is not {FORMAT}; use the version that wrote it.")
        for table, key in (
            ("model", "file"),
            ("simulate", "duration"),
            ("simulate", "sample_rate"),
            ("motion", "kind"),
        ):
            content[table][key]
    except (OSError, UnicodeDecodeError, tomllib.TOMLDecodeError, KeyError, TypeError) as error:
        raise RecordError(f"{path}: this is not the scenario of a run ({type(error).__name__}: {error}).") from None
    return content


def system_and_motion(folder: Path, content: dict[str, Any]) -> tuple[System, BaseMotion]:
    """Return system and motion of a run.

    Args:
        folder: of the run.
        content: what `scenario_content` returned.

    Raises:
        RecordError: one of their files is not in the folder.
    """
    model = check_inside(folder, content["model"])
    motion = {key: value for key, value in content["motion"].items() if key != "description"}
    check_records(motion, folder)
    system = load_system(model)
    missing = missing_isolators(system, model.parent)
    if missing:  # the catalogue stepped in, which may have changed since
        raise RecordError(f"{folder}: the isolator file {missing[0]!r} is missing in {model.parent.name}/.")
    return with_changes(system, _changes(folder, content["model"])), motion_from_dict(motion, folder=folder)


def _changes(folder: Path, model: Mapping[str, Any]) -> tuple[Changes, ...]:
    """Return what the variant that was simulated differs by from the model in the folder."""
    return read_changes(folder / model["changes"]) if "changes" in model else ()
