"""Copies of the files that base motions were read from, so that a folder holds all it needs."""

import shutil
from collections.abc import Sequence
from pathlib import Path

from wirerope_mj.excitation.motion import BaseMotion


def copy_records(motions: Sequence[BaseMotion], folder: Path) -> dict[Path, str]:
    """Copies the files of some motions to `folder`/inputs and returns what to call them, relative to `folder`."""
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
