"""The isolators that shipped before friction had two scales: one law on each axis, and files that must keep their answers."""

from pathlib import Path

import wirerope_mj as wr

FOLDER = Path(__file__).parent / "data" / "one_scale"
FILES = {path.stem: path for path in sorted(FOLDER.glob("*.toml"))}
SHEETS = {path.stem: path for path in sorted((FOLDER / "datasheets").glob("*.toml"))}


def one_scale(*names):
    """Return isolators by the names that the models give them, such as "wr12_400"."""
    return {name: wr.load_isolator(next(path for stem, path in FILES.items() if stem.endswith(name))) for name in names}
