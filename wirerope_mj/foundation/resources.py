"""Folders of the models and scenarios that ship with the package, in a checkout and in a wheel, and versions of packages."""

from collections.abc import Iterator
from contextlib import contextmanager
from contextvars import ContextVar
from importlib.metadata import PackageNotFoundError, version
from os.path import isdir, isfile  # as `Path.is_file`, but a name that is too long is none
from pathlib import Path

from wirerope_mj.foundation.errors import ModelError

_PACKAGE = Path(__file__).resolve().parents[1]
#: folder of the Python file that is executed, whose models come before those of the current folder
_of_the_file: ContextVar[Path | None] = ContextVar("_of_the_file", default=None)


def _shipped(folder: str) -> Path:
    """Return the top-level `folder` of a checkout (editable installs too), or its copy inside an installed package."""
    checkout = _PACKAGE.parent
    # Without the project file the folder beside the package could be anybody's: site-packages may hold a `models`.
    if (checkout / "pyproject.toml").is_file() and (checkout / folder).is_dir():
        return checkout / folder
    return _PACKAGE / "_data" / folder


def models_folder() -> Path:
    return _shipped("models")


def scenarios_folder() -> Path:
    return _shipped("scenarios")


def catalogue_folder() -> Path:
    return models_folder() / "isolators"


def shipped_models() -> list[str]:
    return sorted(path.stem for path in models_folder().glob("*.xml"))


@contextmanager
def models_beside(file: Path) -> Iterator[None]:
    """Look models up beside a Python file first, while it is executed."""
    before = _of_the_file.set(file.parent)
    try:
        yield
    finally:
        _of_the_file.reset(before)


def _starts(folder: Path | None) -> list[Path]:
    if folder is not None:
        return [folder]
    beside = _of_the_file.get()
    return [Path()] if beside is None else [beside, Path()]


def model_file(model: str | Path, *, folder: Path | None = None) -> Path | None:
    """Return the file of a model from `folder` or among those that ship; None if there is none.

    Without a folder it is looked for beside the Python file that is executed (`models_beside`), then in the current folder.
    `.xml` may be left out. A folder stands for the model in it that has its name, or the only one; ModelError if it holds
    several.
    """
    named, files = Path(model) if str(model).endswith(".xml") else Path(f"{model}.xml"), list[Path]()
    for start in _starts(folder):
        files += [start / model, start / named]
        if str(model) and isdir(start / model):
            held = sorted((start / model).glob("*.xml"))
            held = [file for file in held if file.stem == file.parent.resolve().name] or held
            if len(held) > 1:
                raise ModelError(f"{model} is a folder with several models: name one of {', '.join(map(str, held))}.")
            files += held
    return next((file for file in (*files, models_folder() / named) if isfile(file)), None)


def model_source(model: str | Path, *, folder: Path | None = None, asker: str) -> str | Path:
    """Return an MJCF text as it is, or the path of a model file from `folder`, or among those that ship.

    `.xml` may be left out; messages begin with `asker`. ModelError: it is no path or text, or there is no such file; names
    what was tried.
    """
    if not isinstance(model, str | Path):
        raise ModelError(
            f"{asker}: `model` must be a path, the name of a shipped model or MJCF text, got a {type(model).__name__}."
        )
    if isinstance(model, str) and model.lstrip().startswith("<"):
        return model
    file = model_file(model, folder=folder)
    if file is None:
        places = " or ".join(dict.fromkeys(str(start.resolve()) for start in _starts(folder)))
        raise ModelError(
            f"{asker}: there is no model {str(model)!r} in {places} and none that ships with the "
            f"package: {', '.join(shipped_models())}."
        )
    return file


def version_of(package: str) -> str:
    """Return the version of a package, or "of a checkout": it is on the path, but was not installed."""
    try:
        return version(package)
    except PackageNotFoundError:
        return "of a checkout"
