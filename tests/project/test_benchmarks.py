"""Benchmarks are not timed in tests, but they must still find what they measure."""

import runpy
import sys

import pytest

from wirerope_mj.foundation.resources import models_folder

FOLDER = models_folder().parent / "benchmarks"


@pytest.mark.skipif(not FOLDER.is_dir(), reason="benchmarks stand in a checkout only")
@pytest.mark.parametrize("name", sorted(path.name for path in FOLDER.glob("*.py")))
def test_benchmark_finds_what_it_measures(name, monkeypatch):
    monkeypatch.setattr(sys, "path", [str(FOLDER), *sys.path])
    assert runpy.run_path(str(FOLDER / name), run_name="imported")
