"""The isolators that shipped before friction had two scales: one law on each axis, and files that must keep their answers."""

from pathlib import Path

import wirerope_mj as wr

FOLDER = Path(__file__).parent / "data" / "one_scale"
FILES = {path.stem: path for path in sorted(FOLDER.glob("*.toml"))}
SHEETS = {path.stem: path for path in sorted((FOLDER / "datasheets").glob("*.toml"))}


FLOOR = FOLDER / "floating_floor.xml"
"""The floating floor as it shipped with them: its two racks stood farther out, forward and to port."""


def one_scale(*names):
    """Return isolators by the names that the models give them, such as "wr12_400"."""
    return {name: wr.load_isolator(next(path for stem, path in FILES.items() if stem.endswith(name))) for name in names}


def one_scale_floor():
    """Return the floating floor as it shipped, on its isolators of one scale."""
    return wr.load_system(FLOOR, isolators=one_scale("wr16_400", "wr12_400"))
