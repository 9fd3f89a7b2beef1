"""The rooms of the house: imports point downwards, and only the rooms meant for it touch an engine or a picture library."""

import ast
import sys
from pathlib import Path

import pytest

import wirerope_mj
from wirerope_mj.resources import scenarios_folder

PACKAGE = Path(wirerope_mj.__file__).parent
LAYERS = (
    (
        "errors", "units", "resources", "state", "jit", "half_written", "whole", "limits", "option_file", "plain_text",
        "inside", "toml_file",
    ),
    ("laws", "excitation", "spectra"),
    ("isolator", "bench", "oscillator", "rope_loop"),
    ("identification",),
    ("system", "control"),
    ("statics",),
    ("simulation", "response"),
    ("modes", "sweep", "periodic", "criteria", "verdicts"),
    ("study", "frf", "selection", "scenario", "estimate"),
    ("plots", "recording", "report"),
    ("runfolder",),
    ("cli",),
)  # fmt: skip
LEVEL = {room: level for level, rooms in enumerate(LAYERS) for room in rooms}
ENGINE_ROOMS = {"system", "control", "statics", "simulation", "modes", "sweep", "periodic"}
OWNERS = {
    "rerun": {"recording"},
    "matplotlib": {"plots"},
    "mujoco": ENGINE_ROOMS,
    "jinja2": {"report"},
    "weasyprint": {"report"},
    "pyuff": {"excitation"},
    "pymoo": {"study"},
}


def files():
    """Return every file of the package but its front door, as paths relative to the package."""
    return sorted(
        p.relative_to(PACKAGE) for p in PACKAGE.rglob("*.py") if p != PACKAGE / "__init__.py" and "_data" not in p.parts
    )


def room_of(file):
    return file.parts[0].removesuffix(".py")


ROOMS = sorted({room_of(file) for file in files()})


def imported(path):
    """Return the full names of all modules that a file imports anywhere in it, also inside functions."""
    names = set()
    for node in ast.walk(ast.parse(path.read_text(encoding="utf-8"))):
        if isinstance(node, ast.Import):
            names |= {alias.name for alias in node.names}
        elif isinstance(node, ast.ImportFrom):
            assert node.level == 0, f"{path}: imports are absolute"
            names.add(node.module)
            if node.module == "wirerope_mj":  # from wirerope_mj import laws
                names |= {f"wirerope_mj.{alias.name}" for alias in node.names}
    return names


def imports_of(room):
    """Return (file, imported name) of all imports in a room."""
    return [(str(file), name) for file in files() if room_of(file) == room for name in sorted(imported(PACKAGE / file))]


def test_every_room_has_its_place():
    assert set(ROOMS) <= set(LEVEL), f"give {set(ROOMS) - set(LEVEL)} a place in the house"


@pytest.mark.parametrize("room", ROOMS)
def test_imports_point_down(room):
    wrong = []
    for file, name in imports_of(room):
        if name.split(".")[0] != "wirerope_mj":
            continue
        target = name.split(".")[1] if "." in name else ""
        # The front door imports all rooms: from inside it would be a circle.
        if not target or LEVEL.get(target, len(LAYERS)) > LEVEL[room]:
            wrong.append(f"{file} imports {name}")
    assert not wrong, wrong


@pytest.mark.parametrize("library", OWNERS)
def test_only_its_rooms_import(library):
    users = {file for room in ROOMS for file, name in imports_of(room) if name.split(".")[0] == library}
    assert {room_of(Path(file)) for file in users} <= OWNERS[library], users


def test_laws_and_motions_know_nothing_of_engine_files_or_pictures():
    allowed = {"numpy", "scipy", "numba", "wirerope_mj", "pyuff"}  # the last reads universal files of records
    for room in ("laws", "excitation"):
        tops = {name.split(".")[0] for _, name in imports_of(room)}
        assert tops - sys.stdlib_module_names <= allowed


def test_commands_and_scenarios_hold_no_solver_code():
    shipped = [(path.name, name) for path in scenarios_folder().glob("*.py") for name in imported(path)]
    for file, name in imports_of("cli") + shipped:
        assert name.split(".")[0] not in {"mujoco", "scipy", "numba"}, f"{file} imports {name}"
    for file, name in shipped:
        assert name.split(".")[0] not in {"matplotlib", "rerun"}, f"{file} imports {name}"
        assert not name.startswith("wirerope_mj."), f"{file} imports {name}: scenarios use the front door"


def test_a_file_holds_one_idea():
    """Four hundred lines are where a file must have been split; nothing is called after what it is not about."""
    for file in files():
        lines = (PACKAGE / file).read_text(encoding="utf-8").count("\n")
        assert lines < 400, f"{file} has {lines} lines"
        assert not {"utils", "util", "helpers", "common", "misc", "manager"} & {
            part.removesuffix(".py") for part in file.parts
        }
