"""A command ends after an interrupt, whatever it waits for, and leaves nothing; moments in which it must not be disturbed."""

import os
import signal
import subprocess
import sys

import pytest
from kills import hidden, interruptible, wait_until_ended

from wirerope_mj.foundation.interrupts import interrupts_held

pytestmark = pytest.mark.skipif(sys.platform == "win32", reason="Windows has neither these signals nor pipes for them")

# What a process does that a command may do, in a library or in its own code, when the signal comes.
STUCK = {
    "lost in a library": "while True:\n        try:\n            print('here', flush=True)\n            time.sleep(60)\n"
    "        except BaseException:\n            pass",
    "lost in a finalizer": "class Lost:\n        def __del__(self):\n            print('here', flush=True)\n"
    "            time.sleep(60)\n    Lost()\n    time.sleep(60)",
    "waits": "lock = threading.Lock()\n    lock.acquire()\n    try:\n        print('here', flush=True)\n"
    "        lock.acquire()\n    finally:\n        lock.acquire()",
    "computes": "while True:\n        try:\n            print('here', flush=True)\n"
    "            hashlib.pbkdf2_hmac('sha256', b'', b'', 2**31 - 1)\n"
    "        except BaseException:\n            pass",  # the signal came before it began
}
PROCESS = """
import hashlib, pathlib, sys, threading, time
from wirerope_mj.foundation import interrupts
from wirerope_mj.foundation.atomic_files import atomic_file, atomic_folder
from wirerope_mj.foundation.processes import process_beside

interrupts.end_soon_after_interrupts()
interrupts.resumed_by(lambda: "the same command goes on.")
with (
    atomic_file(pathlib.Path("table.csv")) as file,
    atomic_folder(pathlib.Path("run"), force=True, kind="run", marks=("mark",)) as folder,
    process_beside([sys.executable, "-c", "import time; time.sleep(600)"], stdin=-3) as process,
):
    (folder / "mark").write_text("new")
    print(process.pid, flush=True)
    WORK
"""


@pytest.mark.parametrize(("number", "code"), [(signal.SIGINT, 130), (signal.SIGTERM, 143)])
@pytest.mark.parametrize("stuck", STUCK)
def test_an_interrupt_ends_what_waits_for_ever_and_leaves_what_was_there(stuck, number, code, tmp_path):
    (tmp_path / "run").mkdir()
    (tmp_path / "run" / "mark").write_text("old")
    with interruptible([sys.executable, "-c", PROCESS.replace("WORK", STUCK[stuck])], cwd=tmp_path) as process:
        beside = int(process.stdout.readline())
        assert process.stdout.readline() == "here\n"
        process.send_signal(number)
        _, told = process.communicate(timeout=120)  # a second, however busy the machine; not ten minutes
    assert process.returncode == code
    said = ["interrupted; no half-written result was left behind.", "the same command goes on."]
    assert told == "".join(f"wirerope: {line}\n" for line in said)
    assert hidden(tmp_path) == []
    assert (tmp_path / "run" / "mark").read_text() == "old"
    assert not (tmp_path / "table.csv").exists()
    wait_until_ended(beside)


def test_an_interrupt_that_is_put_off_comes_after_the_block():
    done, before = [], signal.getsignal(signal.SIGINT)

    def work():
        with interrupts_held():
            signal.raise_signal(signal.SIGINT)
            with interrupts_held():
                signal.raise_signal(signal.SIGINT)
            done.append("block")
        done.append("after")

    signal.signal(signal.SIGINT, signal.default_int_handler)  # as where these tests run in the background
    try:
        with pytest.raises(KeyboardInterrupt):
            work()
    finally:
        signal.signal(signal.SIGINT, before)
    assert done == ["block"]


# Every call of the system by which a hidden file or folder is made or removed is followed by an interrupt.
DISTURBED = """
import os, pathlib, signal, sys
from wirerope_mj.foundation.atomic_files import atomic_file, atomic_folder

place, number = pathlib.Path(sys.argv[1]), int(sys.argv[2])
count = 0

def disturb(event, arguments):
    global count
    if event in ("open", "os.mkdir", "os.rename", "os.remove", "os.rmdir", "os.chmod") and str(place) in str(arguments[0]):
        count += 1
        if count == number:
            signal.raise_signal(signal.SIGINT)

sys.addaudithook(disturb)
try:
    with atomic_folder(place / "run", force=True, kind="run", marks=("mark",)) as folder, atomic_file(place / "a.txt") as file:
        (folder / "mark").write_text("new")
        file.write_text("new")
except KeyboardInterrupt:
    pass
print(count < number)
"""


def test_an_interrupt_at_any_call_of_the_system_leaves_the_old_or_the_new_and_nothing_else(tmp_path):
    number = 0
    for number in range(1, 100):
        place = tmp_path / str(number)
        (place / "run").mkdir(parents=True)
        (place / "run" / "mark").write_text("old")
        command = [sys.executable, "-c", DISTURBED, str(place), str(number)]
        with interruptible(command) as process:
            said, told = process.communicate(timeout=120)
        assert told == ""
        assert hidden(place) == []
        assert (place / "run" / "mark").read_text() in ("old", "new")
        assert {path.name for path in place.iterdir()} <= {"run", "a.txt"}
        if said == "True\n":
            break
    assert number > 10  # a file and a folder, each made, locked, written, renamed and removed


LIBRARY = """
import contextlib, sys, tempfile, threading
from wirerope_mj.cli import app as program
from wirerope_mj.foundation.interrupts import end

def forget(first):
    with contextlib.suppress(FileNotFoundError):
        while True:
            tempfile.NamedTemporaryFile(delete=False).close()
            first.set()

def library(*words, **settings):
    tempfile.NamedTemporaryFile(delete=False).close()
    if sys.argv[1:]:
        threading.Thread(target=forget, args=(first := threading.Event(),), daemon=True).start()
        first.wait()
        end(15)

program.app, program._add = library, lambda name: None
sys.exit(program.main())
"""


@pytest.mark.parametrize(("words", "code"), [([], 0), (["--end"], 143)])
def test_temporary_files_that_libraries_forget_go_with_the_command(words, code, tmp_path):
    command = [sys.executable, "-c", LIBRARY, *words]
    ended = subprocess.run(command, env={**os.environ, "TMPDIR": str(tmp_path)}, capture_output=True, text=True)
    assert (ended.returncode, ended.stderr) == (code, "")
    assert list(tmp_path.iterdir()) == []
