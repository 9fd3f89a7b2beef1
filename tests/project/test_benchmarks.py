"""Benchmarks are not timed in tests, and campaigns run by hand: both must still find what they measure and try."""

import ast
import importlib
import runpy
import sys
from pathlib import Path

import pytest

from wirerope_mj.foundation.resources import models_folder

FOLDER = models_folder().parent / "benchmarks"


@pytest.mark.skipif(not FOLDER.is_dir(), reason="benchmarks stand in a checkout only")
@pytest.mark.parametrize("name", sorted(path.name for path in FOLDER.glob("*.py")))
def test_benchmark_finds_what_it_measures(name, monkeypatch):
    monkeypatch.setattr(sys, "path", [str(FOLDER), *sys.path])
    assert runpy.run_path(str(FOLDER / name), run_name="imported")


@pytest.mark.quick
def test_every_script_finds_what_it_imports():
    root = Path(__file__).parents[2]
    scripts = [path for folder in ("tests", "docs", "verification", "packaging") for path in (root / folder).rglob("*.py")]
    lost = []
    for path in scripts:
        for node in ast.walk(ast.parse(path.read_text(encoding="utf-8"))):
            if isinstance(node, ast.ImportFrom) and (node.module or "").split(".")[0] == "wirerope_mj":
                module = importlib.import_module(node.module)
                names = [name.name for name in node.names if not hasattr(module, name.name)]
                lost += [f"{path.name}: {node.module}.{name}" for name in names if not exists(f"{node.module}.{name}")]
    assert lost == []
    assert len(scripts) > 100


def exists(module):
    try:
        return importlib.import_module(module)
    except ModuleNotFoundError:
        return None
