"""Pipes and devices where a file is asked for: one message, at once."""

import os
import sys
from contextlib import redirect_stderr, redirect_stdout
from io import StringIO

import pytest

from wirerope_mj.cli import main

pytestmark = [
    pytest.mark.skipif(sys.platform == "win32", reason="Windows has neither pipes nor devices among its files"),
    pytest.mark.quick,
]

READERS = {
    "record": ["shock", "shock_table", "--record", "FILE", "--out", "run"],
    "history table": ["shock", "shock_table", "--psd", "FILE z", "--out", "run"],
    "model": ["statics", "FILE"],
    "isolator": ["loops", "FILE"],
    "cyclic test": ["laws", "FILE"],
    "table of mounts": ["new", "folder", "--mounts", "FILE", "--masses", "FILE"],
    "mission": ["durability", "FILE", "--exponent", "5"],
    "scenario": ["run", "FILE"],
    "study": ["study", "FILE"],
    "levels": ["shock", "shock_table", "--levels", "FILE", "--out", "run"],
    "data sheet": ["isolators", "fit", "FILE", "out.toml"],
    "recording": ["show", "FILE"],
    "run": ["replay", "FILE"],
}
ENDINGS = {
    "model": ".xml",
    "isolator": ".toml",
    "mission": ".toml",
    "scenario": ".py",
    "study": ".py",
    "levels": ".toml",
}


@pytest.mark.parametrize("reader", READERS)
@pytest.mark.parametrize("kind", ["pipe", "device"])
def test_what_is_no_regular_file_is_refused_at_once(reader, kind, tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    path = tmp_path / f"file{ENDINGS.get(reader, '.csv')}"
    if kind == "pipe":
        os.mkfifo(path)
    else:
        path.symlink_to("/dev/zero")
    said = StringIO()
    with redirect_stderr(said), redirect_stdout(StringIO()):
        code = main([word.replace("FILE", str(path)) for word in READERS[reader]])
    assert code == 2
    lines = said.getvalue().strip().splitlines()
    assert len(lines) == sum("FILE" in word for word in READERS[reader]), said.getvalue()
    assert path.name in said.getvalue()
    assert sorted(path.name for path in tmp_path.iterdir()) == [path.name]


@pytest.mark.parametrize("what", ["include", "mesh"])
def test_a_model_that_names_a_pipe_is_refused(what, tmp_path):
    os.mkfifo(tmp_path / "pipe.xml")
    os.mkfifo(tmp_path / "pipe.obj")
    named = {"include": '<include file="pipe.xml"/>', "mesh": '<asset><mesh name="m" file="pipe.obj"/></asset>'}
    (tmp_path / "model.xml").write_text(f"<mujoco>{named[what]}</mujoco>")
    with redirect_stderr(StringIO()) as said:
        assert main(["statics", str(tmp_path / "model.xml")]) == 2
    assert "not a regular file" in said.getvalue()
