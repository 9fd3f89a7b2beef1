"""Files that an MJCF model names, and checks that they lie in its folder and are no devices."""

from collections.abc import Iterator, Mapping
from pathlib import Path
from xml.etree import ElementTree

from wirerope_mj.foundation.errors import ModelError, RecordError, why_unread
from wirerope_mj.foundation.regular_files import file_inside, is_inside, regular

_FOLDERS = ("assetdir", "meshdir", "texturedir")  # attributes of a `compiler` element that say where files are


def named_files(model: Path) -> Iterator[tuple[str, Path]]:
    """Yield the name and path of each file that a model names: includes, meshes, textures, attached models.

    Files that these name in turn follow, if they lie below the model's folder. ModelError if one is not well-formed XML.
    """
    for tree, folders in model_trees(model):
        for name, source, _ in _sources(tree, folders):
            yield name, source


def check_inside(folder: Path, stated: Mapping[str, str]) -> Path:
    """Return the model file of a folder if all files that it names lie in the folder, too; nothing is loaded.

    `stated` is what the folder says of its model, as `model_table` returned it.

    Raises:
        RecordError: a file is missing, or lies outside the folder.
        ModelError: a file is not well-formed XML.
    """
    for name in stated.values():
        file_inside(folder, name, "model file")
    model = folder / stated["file"]
    texts = [text for tree, _ in model_trees(model) for text in tree.iter("text") if "isolator/" in text.get("name", "")]
    names = [text.get("data", "") for text in texts]
    isolators = [(name, model.parent / (name if name.endswith(".toml") else f"{name}.toml")) for name in names]
    for name, path in (*named_files(model), *isolators):
        if not is_inside(path, folder):
            raise RecordError(
                f"{folder}: {model.name} names {name!r}, which lies outside this folder and is not read; a folder holds all "
                "that it needs. Simulate the scenario again, and the files are copied."
            )
    return model


def check_regular(model: Path) -> None:
    """Raise ModelError if a model or a file that it includes is a pipe or a device, for which MuJoCo would wait."""
    try:
        for _ in named_files(model):
            pass
    except ModelError as error:
        if isinstance(error.__cause__, OSError):
            raise  # MuJoCo says itself what else is wrong


def model_trees(model: Path) -> Iterator[tuple[ElementTree.Element, tuple[Path, ...]]]:
    """Yield the XML elements of a model file and of the files it includes, each with the folders that are searched."""
    todo: list[tuple[Path, tuple[Path, ...]]] = [(model, ())]
    visited = set()
    while todo:
        file, searched = todo.pop(0)
        if file.resolve() in visited or not is_inside(file, model.parent):
            continue  # a file may include itself, which MuJoCo refuses
        visited.add(file.resolve())
        _exists(file)
        try:
            tree = ElementTree.fromstring(file.read_text(encoding="utf-8", errors="replace"))
        except ElementTree.ParseError as error:
            line, column = error.position
            raise ModelError(
                f"{file}, line {line}, column {column + 1}: this is not well-formed XML, so that the files the model needs "
                "cannot be found. Write & as &amp; and < as &lt;, close every element, and give no attribute twice."
            ) from None
        stated = [compiler.get(key, "") for compiler in tree.iter("compiler") for key in _FOLDERS]
        bases = (file.parent, model.parent)
        folders = (*bases, *searched, *(base / name for name in stated for base in reversed(bases)))
        yield tree, folders
        todo += [(source, folders) for _, source, is_model in _sources(tree, folders) if is_model]


def _sources(tree: ElementTree.Element, folders: tuple[Path, ...]) -> Iterator[tuple[str, Path, bool]]:
    """Yield name and path of every file that elements name, and whether it is a model itself."""
    for element in tree.iter():
        for name in [value for key, value in element.attrib.items() if key.startswith("file")]:
            source = next((folder / name for folder in folders if _exists(folder / name)), None)
            if source is not None:  # else it is no file that MuJoCo needs, or it will say so
                yield name, source, element.tag == "include" or source.suffix == ".xml"


def _exists(file: Path) -> bool:
    """Tell whether a file exists; ModelError if it is a pipe or a device, for which MuJoCo would wait."""
    try:
        return regular(file).is_file()
    except OSError as error:
        raise ModelError(f"{file}: the model cannot be read: {why_unread(error)}") from error
