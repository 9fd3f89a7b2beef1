"""How tests find a browser, and that a machine which must have one does not skip them unseen."""

import os
import re
from pathlib import Path

import pytest
from browsers import DEMANDED, PROGRAMS, browser_program, no_browser

from wirerope_mj.foundation.resources import models_folder

ROOT = models_folder().parent


@pytest.mark.skipif(os.name == "nt", reason="programs are made of scripts, which Windows does not start by their names")
def test_a_browser_is_the_one_that_the_environment_names_or_the_first_on_the_path(tmp_path, monkeypatch):
    monkeypatch.delenv("CHROME", raising=False)
    monkeypatch.setenv("PATH", str(tmp_path))
    assert browser_program() is None
    for name in reversed(PROGRAMS):
        (tmp_path / name).touch(mode=0o755)
        assert Path(browser_program()).name == name
    monkeypatch.setenv("CHROME", "/opt/a browser")
    assert browser_program() == "/opt/a browser"


def test_without_a_browser_tests_are_skipped_and_fail_where_one_is_required(monkeypatch):
    monkeypatch.delenv(DEMANDED, raising=False)
    with pytest.raises(pytest.skip.Exception):
        no_browser("none is installed")
    monkeypatch.setenv(DEMANDED, "required")
    with pytest.raises(pytest.fail.Exception, match="none is installed"):
        no_browser("none is installed")


@pytest.mark.skipif(not (ROOT / ".ci").is_dir(), reason="`.ci/run` stands in a checkout only")
def test_the_test_extra_brings_what_drives_the_browser_and_ci_requires_it():
    extras = (ROOT / "pyproject.toml").read_text(encoding="utf-8")
    assert re.search(r'^test = \[.*"playwright', extras, flags=re.MULTILINE)
    ci = (ROOT / ".ci" / "run").read_text(encoding="utf-8")
    assert f"export {DEMANDED}=required" in ci
    assert "apt-get install -y -qq chromium" in ci
    assert "pytest -v -m browser" in ci
