"""The house: imports point downwards from wing to wing and from room to room; few of them touch an engine or a picture."""

import ast
import re
import sys
from functools import cache
from graphlib import CycleError, TopologicalSorter
from pathlib import Path

import pytest

import wirerope_mj
from wirerope_mj.cli.app import COMMANDS
from wirerope_mj.foundation.resources import scenarios_folder

pytestmark = pytest.mark.quick

PACKAGE = Path(wirerope_mj.__file__).parent
HOUSE = {
    "foundation": (),
    "mounts": (
        ("laws",),
        ("test_rig", "rope_loop"),
        ("isolator",),
        ("identification",),
        ("vendor_parts",),
        ("estimate",),
    ),
    "motions": (("spectra",), ("records",)),
    "engine": (
        ("response", "control"),
        ("flexible",),
        ("system", "from_tables"),
        ("kernel",),
        ("statics",),
        ("simulation",),
    ),
    "dynamics": (("single_mass", "sweep", "periodic"), ("modes", "frequency_response")),
    "assessment": (("criteria",), ("correlation", "durability")),
    "studies": (("vary",), ("engines",), ("results",), ("search", "calibration")),
    "content": (),
    "views": (("plots",), ("recording",), ("report", "document"), ("share",), ("board",)),
    "runs": (("board",),),
    "cli": (),
}
"""Wings from the bottom to the top, each with its floors of rooms: a room uses those below it, and none beside it.

A file that stands in the wing itself, beside its rooms, may be used by all of them.
"""

WINGS = list(HOUSE)
FLOORS = {wing: {room: n for n, rooms in enumerate(floors) for room in rooms} for wing, floors in HOUSE.items()}

OWNERS = {
    "rerun": {"views/recording"},
    "matplotlib": {"views"},
    "mujoco": {
        "engine/system", "engine/from_tables", "engine/control", "engine/kernel", "engine/statics", "engine/simulation",
        "dynamics/modes", "dynamics/sweep", "dynamics/periodic",
    },
    "jinja2": {"views/report", "views/board"},
    "starlette": {"views/board"},
    "uvicorn": {"views/board"},
    "typst": {"views"},
    "imageio_ffmpeg": {"views"},
    "docx": {"views/document"},
    "msgspec": {"foundation"},
    "pyuff": {"motions/records", "engine/flexible"},
    "pyyeti": {"engine/flexible"},
    "pymoo": {"studies/search"},
    "emcee": {"studies/calibration"},
}  # fmt: skip


def module_of(path):
    """Return the dotted name of a file below the package: `mounts.laws.law`, `mounts.laws` for an `__init__.py`."""
    parts = path.relative_to(PACKAGE).with_suffix("").parts
    return ".".join(parts[:-1] if parts[-1] == "__init__" else parts)


FILES = {module_of(path): path for path in sorted(PACKAGE.rglob("*.py")) if "_data" not in path.parts}
MODULES = sorted(FILES.keys() - {""})  # without the public API, which imports all rooms


@cache
def contents(path):
    """Return the full names of all that a file imports anywhere in it, also inside functions, and its texts."""
    names, texts = set(), set()
    for node in ast.walk(ast.parse(path.read_text(encoding="utf-8"))):
        if isinstance(node, ast.Import):
            names |= {alias.name for alias in node.names}
        elif isinstance(node, ast.ImportFrom):
            assert node.level == 0, f"{path}: imports are absolute"
            names |= {f"{node.module}.{alias.name}" for alias in node.names}
        elif isinstance(node, ast.Constant) and isinstance(node.value, str):
            texts.add(node.value)
    return names, texts


def imported(path):
    return contents(path)[0]


@cache
def used(module):
    """Return the modules of this package that a module imports."""
    names = {name.removeprefix("wirerope_mj.") for name in imported(FILES[module]) if name.startswith("wirerope_mj.")}
    return {name if name in FILES else name.rpartition(".")[0] for name in names}


def room_of(module):
    """Return wing and room of a module; "" for a file that stands in the wing itself."""
    wing, *rest = module.split(".")
    return wing, rest[0] if rest and rest[0] in FLOORS[wing] else ""


def test_every_folder_is_a_wing_or_a_room():
    beside = {"__pycache__", "_data", "_kernels", "py.typed", "schemas"}
    assert {entry.name for entry in PACKAGE.iterdir()} - beside == {"__init__.py", "__init__.pyi", *HOUSE}
    for wing in WINGS:
        folders = {entry.name for entry in (PACKAGE / wing).iterdir() if entry.is_dir()} - {"__pycache__"}
        assert folders == FLOORS[wing].keys(), f"give the rooms of {wing} an order"


@pytest.mark.parametrize("module", MODULES)
def test_imports_point_down(module):
    wing, room = room_of(module)
    for target in used(module):
        assert target, f"{module} imports the public API, which imports it"
        other, there = room_of(target)
        assert WINGS.index(other) <= WINGS.index(wing), f"{module} imports {target}, which stands above it"
        if other == wing and room and there and there != room:
            assert FLOORS[wing][there] < FLOORS[wing][room], f"{module} imports {target}, which stands beside or above it"


def test_no_imports_run_in_a_circle():
    # A package's `__init__.py` only hands on what its files hold: whoever imports it, imports those.
    try:
        TopologicalSorter({module: used(module) - {module} for module in MODULES}).prepare()
    except CycleError as error:
        pytest.fail(" -> ".join(error.args[1]))


@pytest.mark.parametrize("library", OWNERS)
def test_only_its_rooms_import(library):
    users = {m for m in MODULES if any(name.split(".")[0] == library for name in imported(FILES[m]))}
    assert {"/".join(filter(None, room_of(module))) for module in users} <= OWNERS[library], users


def test_laws_and_motions_know_nothing_of_engine_files_or_pictures():
    allowed = {"numpy", "scipy", "numba", "wirerope_mj", "pyuff"}  # the last reads universal files of records
    for module in MODULES:
        if room_of(module) == ("mounts", "laws") or module.startswith("motions"):
            assert {name.split(".")[0] for name in imported(FILES[module])} - sys.stdlib_module_names <= allowed


def test_commands_and_scenarios_hold_no_solver_code():
    for path in [FILES[module] for module in MODULES if module.startswith("cli")] + [*scenarios_folder().glob("*.py")]:
        assert not {"mujoco", "scipy", "numba"} & {name.split(".")[0] for name in imported(path)}, path
    for path in scenarios_folder().glob("*.py"):
        assert not {"matplotlib", "rerun"} & {name.split(".")[0] for name in imported(path)}, path
        inner = {name for name in imported(path) if name.startswith("wirerope_mj.")}
        assert not inner, f"{path}: scenarios use the public API, not {inner}"


def test_a_file_holds_one_idea():
    """Four hundred lines are where a file must have been split; nothing is called after what it is not about."""
    for module, path in FILES.items():
        lines = path.read_text(encoding="utf-8").count("\n")
        assert lines < 400, f"{path} has {lines} lines"
        assert not {"utils", "util", "helpers", "common", "misc", "manager"} & set(module.split("."))


def test_a_module_binds_a_constant_once():
    """A second value under one name would silently be that of the first one's users, too."""
    for path in FILES.values():
        names = []
        for node in ast.parse(path.read_text(encoding="utf-8")).body:
            if isinstance(node, ast.Assign | ast.AnnAssign):
                parts = node.targets if isinstance(node, ast.Assign) else [node.target]
                names += [name.id for part in parts for name in ast.walk(part) if isinstance(name, ast.Name)]
        assert len(set(names)) == len(names), f"{path} binds {[name for name in names if names.count(name) > 1]}"


def test_every_module_is_used_by_another():
    """A file that only tests use is dead; the public API, a command, or a name in a text (a child process) are uses."""
    named, texts = set(), set()
    for path in [*FILES.values(), PACKAGE.parent / "hatch_build.py"]:
        named |= imported(path)
        texts |= contents(path)[1]
    for stub in PACKAGE.rglob("*.pyi"):  # what a package hands on when it is first asked for
        package = ".".join(stub.parent.relative_to(PACKAGE.parent).parts)
        named |= {f"{package}.{module}" for module in re.findall(r"^from \.(\S+) import", stub.read_text(), re.MULTILINE)}
    named |= {name[:end] for name in named for end, character in enumerate(name) if character == "."}
    texts |= {text.partition(":")[0] for text in texts if text.startswith("wirerope_mj.")}
    commands = {f"cli.{place.partition(':')[0]}" for place in COMMANDS.values()}
    for module in MODULES:
        whole, stem = f"wirerope_mj.{module}", f"{module.rpartition('.')[2]}.py"
        is_room = FILES[module].name == "__init__.py"
        used_by = whole in named or whole in texts or stem in texts
        assert used_by or is_room or module in commands, f"nothing uses {module}"


def test_files_of_tests_have_names_of_their_own():
    """pytest imports them by their names alone: of two that are called alike in different folders it collects one."""
    files = Path(__file__).parents[1].rglob("test_*.py")
    names = [file.name for file in files]
    assert sorted(names) == sorted(set(names))


def test_the_map_names_what_exists():
    page = (PACKAGE.parent / "docs" / "architecture.md").read_text(encoding="utf-8")
    named = set(re.findall(r"`((?:wirerope_mj|tests|models|scenarios)/[\w/.]*)`", page))
    assert len(named) > 20
    assert not [name for name in named if not (PACKAGE.parent / name).exists()]
    beside = set(re.findall(r"`(\w+\.(?:py|js|jinja))`", page))  # files beside one that is named with its folder
    root = PACKAGE.parent
    assert beside <= {path.name for path in (*PACKAGE.rglob("*"), *(root / "tests").rglob("*"), *root.glob("*"))}
    for wing, floors in HOUSE.items():
        assert f"| `{wing}` |" in page
        assert all(f"`{room}`" in page for rooms in floors for room in rooms)
