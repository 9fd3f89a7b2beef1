"""Isolator files on disk: found by name or path, and loaded."""

from os.path import exists, isfile  # as those of `Path`, but a name that is too long is none
from pathlib import Path

from wirerope_mj.foundation.errors import ModelError
from wirerope_mj.foundation.plain_text import short
from wirerope_mj.foundation.resources import catalogue_folder
from wirerope_mj.foundation.toml_file import read_toml
from wirerope_mj.mounts.isolator.device import Isolator


def load_isolator(path: str | Path) -> Isolator:
    """Return the isolator in a file, or that of a name in the catalogue: "enidine_wr16_400".

    Raises:
        ModelError: the file is missing, is not TOML, or breaks a rule; the message names file, axis, key and rule.
    """
    path = Path(path) if Path(path).suffix or exists(path) else find_isolator(path)
    return Isolator.from_dict(read_toml(path, "isolator file"), where=str(path), folder=Path(path).parent)


def find_isolator(name: str | Path, beside: str | Path | None = None) -> Path:
    """Return the path of the isolator file called `name`.

    It is looked up as it stands under the folder `beside` (that of the model file; the current folder by default), then
    by its last part in the catalogue that ships with the package. The ending `.toml` may be left out.

    Raises:
        ModelError: no such file; lists the isolators that exist.
    """
    catalogue = catalogue_folder()
    wanted = Path(f"{name}" if f"{name}".endswith(".toml") else f"{name}.toml")
    candidates = [Path(beside or ".") / wanted, catalogue / wanted.name]
    for candidate in candidates:
        if isfile(candidate):
            return candidate
    looked = " and ".join(dict.fromkeys(str(candidate) for candidate in candidates))
    existing = ", ".join(sorted(path.stem for path in catalogue.glob("*.toml"))) or "nothing"
    raise ModelError(f"there is no isolator {short(str(name))!r}: looked for {looked}. The catalogue holds {existing}.")
