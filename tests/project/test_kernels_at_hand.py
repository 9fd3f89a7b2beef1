"""What ships compiled is all that Python calls: `use_all_kernels` leaves none out."""

import ast
import importlib
import os
import subprocess
import sys
from pathlib import Path

import pytest
from numba.core.dispatcher import Dispatcher

import wirerope_mj
from wirerope_mj.cli import main

PACKAGE = Path(wirerope_mj.__file__).parent
APART = {"engine.control.install", "foundation.lanes", "mounts.laws.registry"}
"""The callback in Python, of which nothing ships; and tables of kernels for kernels."""

CALLBACKS = {"_control": "control", "_act_dyn": "act_dyn", "_sensor": "sensor"}
"""Kernels that C functions around them call, and those."""

USE = """
from pathlib import Path
import numba
from wirerope_mj.foundation.kernel_files import LOADED
from wirerope_mj.runs.kernels import use_all_kernels
use_all_kernels()
print(*sorted({path.name.split("-")[0] for path in LOADED}))
of_this_build = (str(Path(numba.__file__).parent).encode(), b"array_expr_0x")
print(*sorted({path.name for path in LOADED if any(text in path.read_bytes() for text in of_this_build)}))
"""
"""Kernels at hand; and those that name a folder or an address, so that two builds of a wheel would differ."""


def names_outside_kernels(node, kernel=False):
    """Yield the names that functions use which are not kernels, and modules."""
    for child in ast.iter_child_nodes(node):
        if isinstance(child, ast.FunctionDef):
            decorated = any(isinstance(one, ast.Name) and one.id in ("njit", "inlined") for one in child.decorator_list)
            yield from names_outside_kernels(child, kernel or decorated)
        else:
            if isinstance(child, ast.Name) and not kernel:
                yield child.id
            yield from names_outside_kernels(child, kernel)


def called_from_python():
    found = set()
    for path in PACKAGE.rglob("*.py"):
        name = ".".join(path.relative_to(PACKAGE).with_suffix("").parts)
        if "_data" in path.parts or path.name == "__init__.py" or name in APART:
            continue
        module = importlib.import_module(f"wirerope_mj.{name}")
        for used in names_outside_kernels(ast.parse(path.read_text(encoding="utf-8"))):
            kernel = getattr(module, used, None)
            if isinstance(kernel, Dispatcher):
                found.add(CALLBACKS.get(kernel.py_func.__name__, kernel.py_func.__name__))
    return found


@pytest.mark.slow
def test_every_kernel_that_python_calls_is_compiled_beforehand(capsys):
    assert main(["compile"]) == 0
    assert "All kernels are compiled" in capsys.readouterr().out
    # In a new process, which compiles nothing, so that what is loaded is what Python calls.
    done = subprocess.run([sys.executable, "-c", USE], env=os.environ, capture_output=True, text=True, check=True)
    assert done.stderr == ""
    at_hand, of_one_build = done.stdout.splitlines()
    assert set(at_hand.split()) == called_from_python()
    assert of_one_build == ""
