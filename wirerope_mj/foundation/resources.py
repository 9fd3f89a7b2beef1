"""Where the models and scenarios that ship with the package lie, in a checkout and in an installed wheel."""

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
        asker: what messages begin with.

    Raises:
        ModelError: there is no such file; names where it was looked for.
    """
    if isinstance(model, str) and model.lstrip().startswith("<"):
        return model
    wanted = Path(model) if str(model).endswith(".xml") else Path(f"{model}.xml")
    places = [(folder or Path()) / wanted, models_folder() / wanted]
    for place in places:
        if place.is_file():
            return place
    shipped = ", ".join(sorted(path.name for path in models_folder().glob("*.xml")))
    raise ModelError(
        f"{asker}: there is no model {str(model)!r}; looked for "
        f"{' and '.join(str(place) for place in dict.fromkeys(places))}. The package ships {shipped}."
    )
