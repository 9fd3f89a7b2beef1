"""Where the models and scenarios that ship with the package lie, in a checkout and in an installed wheel."""

from pathlib import Path

_PACKAGE = Path(__file__).resolve().parent


def _shipped(folder: str) -> Path:
    """Return the top-level `folder` of a checkout (editable installs too), or its copy inside an installed package."""
    checkout = _PACKAGE.parent
    # Without the project file the folder beside the package could be anybody's: site-packages may hold a `models`.
    if (checkout / "pyproject.toml").is_file() and (checkout / folder).is_dir():
        return checkout / folder
    return _PACKAGE / "_data" / folder


def models_folder() -> Path:
    """Return the folder of the MJCF models that ship with the package."""
    return _shipped("models")


def scenarios_folder() -> Path:
    """Return the folder of the scenarios that ship with the package."""
    return _shipped("scenarios")


def catalogue_folder() -> Path:
    """Return the folder of the isolator files that ship with the package."""
    return models_folder() / "isolators"
