"""What starting costs: the packages that are imported before anything is asked of them."""

import subprocess
import sys
from importlib import import_module
from importlib.metadata import version

import pytest
from cyclopts import App

import wirerope_mj
from wirerope_mj.cli.app import COMMANDS, summary_of

pytestmark = pytest.mark.quick

HEAVY = {
    "dask", "distributed", "jinja2", "matplotlib", "mujoco", "numba", "numpy", "pyarrow", "pymoo", "rerun", "rich", "scipy",
    "typst",
}  # fmt: skip
USE = """
import sys
{code}
loaded = {{name for name in sys.modules if sys.modules[name] is not None}}
parts = {{f"scipy.{{part}}" for part in ("signal", "stats", "optimize", "interpolate")}}
print("LOADED", *sorted(({packages!r} | parts) & loaded))
print("NUMBER", len([name for name in loaded if name.startswith("wirerope_mj")]))
"""


def started(code):
    """Return the heavy packages, and the number of our own modules, that a new process has imported."""
    text = USE.format(code=code, packages=HEAVY)
    done = subprocess.run([sys.executable, "-c", text], capture_output=True, text=True, check=True, timeout=120)
    *_, loaded, number = done.stdout.splitlines()
    return set(loaded.split()[1:]), int(number.split()[1])


def command(*arguments):
    return f"from wirerope_mj.cli import main; main({list(arguments)!r})"


def test_the_front_door_imports_nothing():
    assert started("import wirerope_mj") == (set(), 1)


def test_help_imports_what_prints_it():
    heavy, number = started(command("--help"))
    assert heavy <= {"rich"}
    assert number <= 10


def test_the_catalogue_imports_neither_engine_nor_pictures():
    heavy, _ = started(command("isolators"))
    assert heavy <= {"numpy", "numba", "rich", "scipy"}


def test_a_run_imports_no_pictures_before_it_has_a_verdict():
    heavy, _ = started("import wirerope_mj.cli.run, wirerope_mj.runs")
    assert heavy <= {"numpy", "numba", "rich", "scipy", "mujoco"}


def test_simulating_imports_no_pictures():
    heavy, _ = started(
        "import wirerope_mj as wr\n"
        "wr.simulate(wr.load_system('sdof_shaker'), wr.HalfSine(peak=1.0, duration=0.01, direction='z'), duration=0.01)"
    )
    assert not heavy & {"dask", "distributed", "jinja2", "matplotlib", "rerun", "scipy.stats", "scipy.signal"}


def test_every_name_of_the_front_door_can_be_had():
    assert len(wirerope_mj.__all__) > 100
    for name in wirerope_mj.__all__:
        assert getattr(wirerope_mj, name) is not None
    assert set(wirerope_mj.__all__) <= set(dir(wirerope_mj))


def test_the_version_is_that_of_the_installed_distribution_and_imports_no_wing():
    assert wirerope_mj.__version__ == version("wirerope-mj")
    assert "__version__" in dir(wirerope_mj)
    heavy, _ = started("import wirerope_mj; wirerope_mj.__version__")
    assert heavy == set()


def test_a_name_that_is_not_there_is_missing_as_in_any_module():
    with pytest.raises(AttributeError, match="simulat"):
        wirerope_mj.simulat  # noqa: B018


@pytest.mark.parametrize("name", COMMANDS)
def test_the_list_of_commands_says_of_each_what_it_says_itself(name):
    place, function = COMMANDS[name].split(":")
    target = getattr(import_module(f"wirerope_mj.cli.{place}"), function)
    own = target.default_command.__doc__ if isinstance(target, App) else target.__doc__
    assert own.split("\n")[0] == summary_of(name)
