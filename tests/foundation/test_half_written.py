"""What killed processes leave, and two processes that write one place."""

import os
import signal
import subprocess
import sys

import pytest

from wirerope_mj.foundation import half_written
from wirerope_mj.foundation.atomic_files import atomic_file, atomic_folder
from wirerope_mj.foundation.errors import RecordError
from wirerope_mj.foundation.half_written import clear_half_written, hidden_file, hidden_folder

pytestmark = pytest.mark.skipif(sys.platform == "win32", reason="Windows has no such locks")

WRITER = """
import pathlib, sys
from wirerope_mj.foundation.atomic_files import atomic_folder, atomic_file

place = pathlib.Path(sys.argv[1])
with (
    atomic_file(place / "table.csv") as file,
    atomic_folder(place / "run-20240101", force=True, kind="run", marks=("mark",)) as folder,
):
    file.write_text("half")
    (folder / "mark").write_text(sys.argv[2])
    print("here", flush=True)
    sys.stdin.read()
"""


@pytest.fixture
def writer(tmp_path):
    """A process that writes a file and a folder, and waits in the middle of both."""
    process = subprocess.Popen(
        [sys.executable, "-c", WRITER, tmp_path, "first"], stdin=subprocess.PIPE, stdout=subprocess.PIPE, text=True
    )
    assert process.stdout.readline() == "here\n"
    yield process
    process.kill()
    process.communicate()


def kill(process):
    process.send_signal(signal.SIGKILL)
    process.wait(timeout=120.0)


def names(folder):
    return sorted(path.name for path in folder.iterdir())


def write_file(place):
    with atomic_file(place / "other.txt") as beside:
        beside.write_text("whole")


def write_folder(place):
    with atomic_folder(place / "run-20240102", force=False, kind="run", marks=("mark",)) as beside:
        (beside / "mark").write_text("whole")


@pytest.mark.parametrize(("write", "name"), [(write_file, "other.txt"), (write_folder, "run-20240102")])
def test_whoever_writes_next_beside_what_a_killed_process_left_removes_it(tmp_path, writer, write, name):
    kill(writer)
    assert len(names(tmp_path)) == 2
    write(tmp_path)
    assert names(tmp_path) == [name]


def test_what_a_living_process_writes_is_left_to_it(tmp_path, writer):
    before = names(tmp_path)
    write_file(tmp_path)
    assert names(tmp_path) == sorted([*before, "other.txt"])
    writer.communicate()  # goes on, and ends
    assert names(tmp_path) == ["other.txt", "run-20240101", "table.csv"]


def test_what_has_not_the_mark_of_the_project_is_never_removed(tmp_path):
    others = [".run.abcdefgh.part", ".run.part", ".table.abcdefgh.part.csv", "run.wirerope.part", ".wirerope.part.d"]
    for number, other in enumerate(others):
        (tmp_path / other).mkdir() if number < 2 else (tmp_path / other).write_text("somebody's")
    clear_half_written(tmp_path)
    assert names(tmp_path) == sorted(others)


def test_a_hidden_file_that_another_process_cleared_before_it_was_locked_is_made_anew(tmp_path, monkeypatch):
    made, make = [], half_written.tempfile.mkstemp

    def cleared(**how):
        made.append(make(**how))
        if len(made) == 1:
            clear_half_written(tmp_path)
        return made[-1]

    monkeypatch.setattr(half_written.tempfile, "mkstemp", cleared)
    with hidden_file(tmp_path / "a.txt") as hidden:
        assert len(made) == 2
        assert names(tmp_path) == [hidden.name]
    assert names(tmp_path) == []


def test_a_hidden_folder_that_another_process_cleared_before_it_was_locked_is_made_anew(tmp_path, monkeypatch):
    opened, ordinary = [], os.open

    def cleared(path, *flags, **how):
        opened.append(path)
        if len(opened) == 1:
            os.rmdir(path)
        return ordinary(path, *flags, **how)

    monkeypatch.setattr(half_written.os, "open", cleared)
    with hidden_folder(tmp_path / "run") as hidden:
        assert len(opened) == 2
        assert hidden.is_dir()
    assert names(tmp_path) == []


@pytest.mark.slow
@pytest.mark.parametrize("force", [False, True])
def test_of_two_writers_of_one_folder_the_second_is_told_so_before_it_works(tmp_path, writer, force):
    second = atomic_folder(tmp_path / "run-20240101", force=force, kind="run", marks=("mark",))
    with pytest.raises(RecordError, match=r"run-20240101: another process is writing this run\. Nothing in it was"):
        second.__enter__()
    writer.communicate()
    assert (tmp_path / "run-20240101" / "mark").read_text() == "first"
    assert names(tmp_path) == ["run-20240101", "table.csv"]


def test_a_folder_is_written_anew_while_another_process_still_removes_the_one_before(tmp_path, monkeypatch):
    folder, aside = tmp_path / "run", []

    def write(text):
        with atomic_folder(folder, force=True, kind="run", marks=("mark",)) as beside:
            (beside / "mark").write_text(text)

    def late(path, **_):  # the second writer comes before the first has removed what it replaced
        aside.append(path)
        with monkeypatch.context() as patch:
            patch.setattr("shutil.rmtree", ordinary)
            if len(aside) == 1:
                write("third")
        ordinary(path, ignore_errors=True)

    write("first")
    ordinary = half_written.shutil.rmtree
    monkeypatch.setattr("shutil.rmtree", late)
    write("second")
    assert (folder / "mark").read_text() == "third"
    assert names(tmp_path) == ["run"]


def test_a_pipe_of_a_hidden_name_makes_nobody_wait(tmp_path):
    os.mkfifo(tmp_path / ".run.wirerope.part")
    with hidden_folder(tmp_path / "run") as hidden:
        assert hidden.is_dir()
    assert names(tmp_path) == [".run.wirerope.part"]
