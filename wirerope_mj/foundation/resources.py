"""Folders of the models and scenarios that ship with the package, in a checkout and in an installed wheel."""

from pathlib import Path

from wirerope_mj.foundation.errors import ModelError

_PACKAGE = Path(__file__).resolve().parents[1]


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


def model_source(model: str | Path, *, folder: Path | None = None, asker: str) -> str | Path:
    """Return an MJCF text as it is, or the path of a model file.

    Args:
        model: MJCF text, or a path; a relative one starts at `folder`, then at the models that ship with the package, and
            `.xml` may be left out.
        folder: None for the current one.
        asker: beginning of messages.

    Raises:
        ModelError: there is no such file; names the paths that were tried.
    """
    if isinstance(model, str) and model.lstrip().startswith("<"):
        return model
    wanted = Path(model) if str(model).endswith(".xml") else Path(f"{model}.xml")
    candidates = [(folder or Path()) / wanted, models_folder() / wanted]
    for path in candidates:
        if path.is_file():
            return path
    shipped = ", ".join(sorted(path.name for path in models_folder().glob("*.xml")))
    raise ModelError(
        f"{asker}: there is no model {str(model)!r}; looked for "
        f"{' and '.join(str(path) for path in dict.fromkeys(candidates))}. The package ships {shipped}."
    )
