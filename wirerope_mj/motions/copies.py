"""Copies of the files that base motions were read from, so that a folder holds all it needs."""

import shutil
from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import Any

from wirerope_mj.foundation.regular_files import file_inside
from wirerope_mj.motions.motion import BaseMotion


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


def check_records(motion: Mapping[str, Any], folder: Path) -> None:
    """Raise RecordError if a motion that `folder` holds, as `to_dict` stored it, names a record that is not in the folder."""
    if "path" in motion:
        file_inside(folder, motion["path"], "record")
    for part in (*motion.get("terms", []), *([motion["motion"]] if "motion" in motion else [])):
        check_records(part, folder)
