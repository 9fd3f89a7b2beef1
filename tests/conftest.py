"""What tests of several wings stand on: an empty folder to stand in."""

import os

import pytest

# Commands that tests start read compiled modules, which the first of them writes: a start takes half the time.
os.environ.pop("PYTHONDONTWRITEBYTECODE", None)


@pytest.fixture
def here(tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    return tmp_path
