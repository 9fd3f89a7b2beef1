"""A copy of a system's model that loads by itself, with the changes of a variant."""

import re
import shutil
import tomllib
from html import unescape
from pathlib import Path, PurePosixPath
from xml.sax.saxutils import quoteattr

import mujoco
import tomli_w

from wirerope_mj.engine.system import Changes, System
from wirerope_mj.engine.system.named_files import named_files
from wirerope_mj.foundation.arrays import Entries
from wirerope_mj.foundation.errors import ModelError, RecordError
from wirerope_mj.foundation.toml_file import toml_content
from wirerope_mj.mounts.isolator import Isolator

CHANGES = "changes.toml"  # file of what a variant differs by from the model in the same folder
_TEXT = re.compile(r"""<text\b(?:[^>"']|"[^"]*"|'[^']*')*>""")
# a `text` element as it is written, and its attributes with their quotes
_ATTRIBUTE = re.compile(r"""\b(name|data)\s*=\s*("[^"]*"|'[^']*')""")


def write_model(system: System, folder: Path) -> Path:
    """Write the MJCF of `system` and all it refers to into `folder`, and return the path of the copied model.

    Isolators are written as the system holds them, under the relative names that the model's texts give. A text that
    points out of the model's folder is pointed at the copy. Files that the MJCF names (`include`, meshes, textures,
    height fields, models to attach) are copied if they lie beside or below the model file. Of a variant the model is copied as
    written, and its changes are written beside it, as `model_table` says.

    Raises:
        ModelError: a file of the model lies outside its folder.
    """
    target = folder / (system.path.name if system.path else f"{system.name}.xml")
    folder.mkdir(parents=True, exist_ok=True)
    text, files = system.mjcf, _isolator_files(system)
    for name, (data, file) in files.items():
        text = text if data == file else _with_file(text, name, file)
    target.write_text(text, encoding="utf-8")
    if system.path is not None:  # what an MJCF file names, and what included or attached files name in turn
        root = system.path.parent.resolve()
        for name, source in named_files(system.path):
            if not source.resolve().is_relative_to(root):
                raise ModelError(f"{system.path}: {name!r} lies outside the model's folder; a run must hold all it needs.")
            copy = folder / source.resolve().relative_to(root)
            copy.parent.mkdir(parents=True, exist_ok=True)
            shutil.copyfile(source, copy)
    for name, (_, file) in files.items():
        path = folder / _with_ending(file)
        path.parent.mkdir(parents=True, exist_ok=True)
        _isolator_of(system, name).save(path)
    if system.changes:
        content: Entries = {"changes": [changes.to_dict() for changes in system.changes]}
        (folder / CHANGES).write_text(tomli_w.dumps(content), encoding="utf-8")
    return target


def write_whole(system: System, folder: Path) -> Path:
    """Write a variant's model and its files into `folder`, its changes in the MJCF itself, to six digits; returns its path."""
    target = write_model(system, folder)
    if not system.changes:
        return target
    (folder / CHANGES).unlink()
    spec, model = mujoco.MjSpec.from_file(str(target)), system.model
    for name in {name for change in system.changes for name in (*change.masses, *change.centres)}:
        body, compiled = spec.body(name), model.body(name)
        body.explicitinertial, body.mass = True, float(compiled.mass[0])
        body.ipos, body.iquat, body.inertia = compiled.ipos, compiled.iquat, compiled.inertia
    for name in {name for change in system.changes for name in (*change.positions, *change.turns)}:
        for site in (system.mounts[name].payload_site, system.mounts[name].base_site):
            spec.site(site).alt.type = mujoco.mjtOrientation.mjORIENTATION_QUAT
            spec.site(site).pos, spec.site(site).quat = model.site(site).pos, model.site(site).quat
    for name in {name for change in system.changes for name in change.tunings}:
        joint, compiled = spec.joint(name), model.joint(name)
        joint.stiffness, joint.damping = compiled.stiffness, compiled.damping
    texts: dict[str, Isolator] = {}
    for name in {name: None for change in system.changes for name in change.isolators}:
        isolator = system.mounts[name].written
        key = next((key for key, text in texts.items() if text == isolator), f"{system.mounts[name].isolator_name}-{name}")
        if key not in texts:
            texts[key] = isolator
            isolator.save(folder / "isolators" / f"{key}.toml")
            spec.add_text(name=f"isolator/{key}", data=f"isolators/{key}.toml")
        next(element for element in spec.tuples if element.name.replace("mount/", "", 1) == name).objname[2] = f"isolator/{key}"
    spec.compile()
    target.write_text(spec.to_xml(), encoding="utf-8")
    return target


def model_table(system: System, model: Path) -> dict[str, str]:
    """Name the files that `write_model` wrote below a folder: the model, and the changes of a variant."""
    folder = model.parent.name
    return {"file": f"{folder}/{model.name}"} | ({"changes": f"{folder}/{CHANGES}"} if system.changes else {})


def read_changes(path: Path) -> tuple[Changes, ...]:
    """Return the changes that `write_model` wrote beside a model; RecordError if the file does not hold any."""
    try:
        return tuple(Changes.from_dict(content) for content in toml_content(path)["changes"])
    except (OSError, UnicodeDecodeError, tomllib.TOMLDecodeError, KeyError, TypeError, ValueError, ModelError):
        raise RecordError(
            f"{path}: this file was written beside the model and says what the variant differs by; it cannot be read, or was "
            f"changed since. Copy the whole folder again."
        ) from None


def missing_isolators(system: System, folder: Path) -> list[str]:
    """Return the isolator files that the model's texts name and that are not in `folder`."""
    return [file for _, file in _isolator_texts(system) if not (folder / _with_ending(file)).is_file()]


def _isolator_texts(system: System) -> list[tuple[str, str]]:
    """Return name and content of every text of the model that names an isolator in use."""
    model, texts = system.model, []
    for number in range(model.ntext):
        start = model.name_textadr[number]
        name = model.names[start : model.names.index(b"\0", start)].decode()
        data = model.text_data[model.text_adr[number] :][: model.text_size[number]].split(b"\0")[0].decode()
        if "isolator/" in name and name.split("isolator/", 1)[-1] in system.isolators:
            texts.append((name, data))
    return texts


def _isolator_files(system: System) -> dict[str, tuple[str, str]]:
    """Return, by name of the MJCF text element, the isolator file that it names and where its copy lies in the folder."""
    files: dict[str, tuple[str, str]] = {}
    taken: dict[str, Isolator] = {}
    for name, data in _isolator_texts(system):
        isolator = _isolator_of(system, name)
        path = PurePosixPath(data)
        inside = not path.is_absolute() and ".." not in path.parts
        file = data if inside else f"isolators/{path.name}"
        number = 1
        while taken.setdefault(file, isolator) != isolator:  # two devices in memory behind one file name
            number += 1
            file = f"isolators/{path.stem}-{number}.toml"
        files[name] = (data, file)
    return files


def _isolator_of(system: System, text_name: str) -> Isolator:
    key = text_name.split("isolator/", 1)[-1]
    changed = {mount for changes in system.changes for mount in changes.isolators}  # those stand with the changes
    written = [mount for mount in system.mounts.values() if mount.isolator_name == key and mount.name not in changed]
    if any(mount.written != system.isolators[key] for mount in written):
        raise ModelError(f"two different isolators are both called {key!r} in this model; a run must tell them apart.")
    return system.isolators[key]


def _with_ending(file: str) -> str:
    return file if file.endswith(".toml") else f"{file}.toml"


def _with_file(text: str, name: str, file: str) -> str:
    """Return the MJCF with its custom text element `name` set to the path `file`."""
    stated = [{part[1]: unescape(part[2][1:-1]) for part in _ATTRIBUTE.finditer(match[0])} for match in _TEXT.finditer(text)]
    matches = [match for match, words in zip(_TEXT.finditer(text), stated, strict=True) if words.get("name") == name]
    if len(matches) != 1:
        raise ModelError(
            f"the text {name!r} names an isolator file outside the model's folder and does not stand in the model file "
            "itself, so that no copy of the model can point at its own file. Place the isolator beside the model."
        )
    element = _ATTRIBUTE.sub(lambda match: f"data={quoteattr(file)}" if match[1] == "data" else match[0], matches[0][0])
    return f"{text[: matches[0].start()]}{element}{text[matches[0].end() :]}"
