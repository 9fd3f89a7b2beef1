"""Models by path or by name."""

from pathlib import Path

from wirerope_mj.foundation.errors import ModelError
from wirerope_mj.foundation.resources import models_folder


def model_path(name: str) -> Path:
    """Return the path of a model file, or of a model that ships with the package, by name."""
    wanted = name if name.endswith(".xml") else f"{name}.xml"
    for place in (Path(name), Path(wanted), models_folder() / wanted):
        if place.is_file():
            return place
    shipped = ", ".join(sorted(path.stem for path in models_folder().glob("*.xml")))
    raise ModelError(f"{name}: there is no such model file. The package ships {shipped}.")
