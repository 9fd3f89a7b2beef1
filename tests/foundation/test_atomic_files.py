"""Files and folders that are written whole or not at all, and places where none can be."""

import ctypes
import errno
import os
import signal
import subprocess
import sys
from contextlib import nullcontext

import pytest

from wirerope_mj.foundation.atomic_files import atomic_file, atomic_folder, check_writable
from wirerope_mj.foundation.errors import DiskFullError, RecordError
from wirerope_mj.foundation.half_written import clear_half_written

WRITER = """
import os, pathlib, shutil, sys
from wirerope_mj.foundation.atomic_files import atomic_folder

folder, stage, rename = pathlib.Path(sys.argv[1]), sys.argv[2], os.rename

def wait(*_, **__):
    print("here", flush=True)
    sys.stdin.read()

if stage == "between":  # no names can be exchanged: the old folder has gone, and the new one is not there yet
    sys.platform = "unknown"
    os.rename = lambda a, b: rename(a, b) if a == folder else wait()
if stage == "removing":
    shutil.rmtree = wait
with atomic_folder(folder, force=True, kind="run", marks=("mark",)) as beside:
    (beside / "mark").write_text("new")
    if stage == "writing":
        wait()
"""


def writer(folder, stage):
    """Return a process that writes `folder` whole and waits at a stage of it."""
    process = subprocess.Popen(
        [sys.executable, "-c", WRITER, folder, stage], stdin=subprocess.PIPE, stdout=subprocess.PIPE, text=True
    )
    assert process.stdout.readline() == "here\n"
    return process


def end(process, number):
    process.send_signal(number)
    process.communicate(timeout=120.0)


@pytest.mark.slow
@pytest.mark.parametrize(("stage", "kept"), [("writing", "old"), ("between", "old"), ("removing", "new")])
def test_what_a_killed_process_left_beside_a_folder_is_put_right(tmp_path, stage, kept):
    folder = tmp_path / "run[1].a"  # letters that mean something in patterns
    folder.mkdir()
    (folder / "mark").write_text("old")
    others = [tmp_path / ".run[1].part", tmp_path / ".run[1].a.notes.part", tmp_path / ".run[1].a.abcdefgh.part"]
    for other in others:
        other.mkdir()
    process = writer(folder, stage)
    before = sorted(tmp_path.iterdir())
    assert len(before) == 5
    clear_half_written(tmp_path)
    if stage != "removing":  # what a process that lives is writing is left to it
        assert sorted(tmp_path.iterdir()) == before
    end(process, signal.SIGKILL)
    clear_half_written(tmp_path)
    assert sorted(tmp_path.iterdir()) == sorted([folder, *others])
    assert (folder / "mark").read_text() == kept


def test_a_folder_that_was_never_finished_is_written_anew_after_a_kill(tmp_path):
    folder = tmp_path / "run"
    end(writer(folder, "writing"), signal.SIGKILL)
    assert [path.name[:5] for path in tmp_path.iterdir()] == [".run."]
    with atomic_folder(folder, force=False, kind="run", marks=("mark",)) as beside:
        (beside / "mark").write_text("new")
    assert [path.name for path in tmp_path.iterdir()] == ["run"]
    assert sorted(path.name for path in folder.iterdir()) == ["mark"]


@pytest.mark.skipif(sys.platform != "linux", reason="names are exchanged on Linux alone")
@pytest.mark.parametrize("full", [True, False])
def test_a_disk_that_is_full_at_the_exchange_leaves_the_old_folder(full, tmp_path, monkeypatch):
    folder = tmp_path / "run"
    folder.mkdir()
    (folder / "mark").write_text("old")

    def refuse(*_):
        raise OSError(errno.ENOSPC, os.strerror(errno.ENOSPC))

    class System:
        renameat2 = staticmethod(lambda *_: ctypes.set_errno(errno.ENOSPC) or -1)

    monkeypatch.setattr("os.rename", refuse)  # neither there nor back
    if full:
        monkeypatch.setattr("ctypes.CDLL", lambda *_, **__: System)

    def write():
        with atomic_folder(folder, force=True, kind="run", marks=("mark",)) as new:
            (new / "mark").write_text("new")

    with pytest.raises(DiskFullError, match="/run: there is no space left") if full else nullcontext():
        write()
    assert [path.name for path in tmp_path.iterdir()] == ["run"]
    assert (folder / "mark").read_text() == ("old" if full else "new")


def test_what_fails_leaves_nothing(tmp_path):
    def fail():
        with atomic_file(tmp_path / "a.txt") as beside:
            beside.write_text("half")
            raise RuntimeError

    with pytest.raises(RuntimeError):
        fail()
    assert not list(tmp_path.iterdir())


def test_a_folder_that_cannot_be_written_is_one_sentence_without_the_hidden_name(tmp_path, monkeypatch):
    def refuse(**_):
        raise PermissionError(13, "Permission denied", ".a.7lt3qll7.part.txt")

    monkeypatch.setattr("tempfile.mkstemp", refuse)
    place = atomic_file(tmp_path / "a.txt")
    with pytest.raises(RecordError, match=r"a\.txt: cannot write here \(Permission denied\)\. Choose another place\.$"):
        place.__enter__()


@pytest.mark.parametrize("named", [(), (".run.wirerope.part/a.csv",), ("a.csv", None, ".run.0123abcd.wirerope.old")])
def test_a_disk_that_is_out_of_order_is_said_of_the_place_that_people_know(named, tmp_path):
    def write():
        with atomic_folder(tmp_path / "run", force=False, kind="run", marks=()) as folder, atomic_file(folder / "a.csv"):
            raise OSError(errno.EIO, os.strerror(errno.EIO), *named)

    with pytest.raises(RecordError, match=r"/run: cannot write here \(Input/output error\)\. Choose another place\.$"):
        write()
    assert list(tmp_path.iterdir()) == []


def test_places_are_refused_before_the_work(tmp_path, monkeypatch):
    check_writable(tmp_path / "a.txt")
    with pytest.raises(RecordError, match="this is a folder"):
        check_writable(tmp_path)
    with pytest.raises(RecordError, match=r"there is no folder '.*new'"):
        check_writable(tmp_path / "new" / "a.txt")
    (tmp_path / "file").write_text("")
    with pytest.raises(RecordError, match=r"there is no folder '.*file'"):
        check_writable(tmp_path / "file" / "a.txt")
    monkeypatch.setattr("os.access", lambda *_: False)
    with pytest.raises(RecordError, match="cannot write here"):
        check_writable(tmp_path / "a.txt")
