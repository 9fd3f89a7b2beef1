"""A command that compiles starts one process beside it, which ends with it; a library starts none. A copy writes files."""

import subprocess
import sys

import pytest
from kills import wait_until_ended

from wirerope_mj.foundation import processes

pytestmark = pytest.mark.quick

HANG = 120.0
"""Time after which a process hangs [s], less than what stands still below would take."""

COMMAND = """
import sys
from wirerope_mj.foundation import jit, processes
processes.BESIDE = [sys.executable, "-c", "import os, time; print(os.getpid(), file=open('beside', 'a')); time.sleep(3600)"]
processes.processors = lambda: {processors}
{before}
for n in (1, 2):
    jit.njit(eval("lambda x: x + %d" % n))(1.0)
import time, pathlib
note = pathlib.Path("beside")
while {waits} and not (note.exists() and note.read_text()):  # a file is there before what is written into it
    time.sleep(0.05)
"""


def beside(folder, *, before="processes.allow_one_beside()", processors=2, waits=True, cache="cache"):
    """Run two kernels that are not at hand, and return the numbers of the processes that stood beside them."""
    code = COMMAND.format(before=before, processors=processors, waits=waits)
    environment = processes.environment_of_children() | {"NUMBA_CACHE_DIR": str(folder / cache)}
    subprocess.run([sys.executable, "-c", code], cwd=folder, env=environment, check=True, timeout=HANG)
    note = folder / "beside"
    return note.read_text().split() if note.exists() else []


def test_the_first_kernel_that_a_command_compiles_starts_one_process_which_ends_with_it(tmp_path):
    (number,) = beside(tmp_path)
    wait_until_ended(int(number))


@pytest.mark.slow
def test_a_library_starts_none_and_so_does_a_command_with_one_processor(tmp_path):
    assert beside(tmp_path, before="", waits=False) == []
    assert beside(tmp_path, processors=1, waits=False) == []


def test_none_is_started_where_compiled_kernels_are_not_kept(tmp_path):
    (tmp_path / "file").touch()
    assert beside(tmp_path, cache="file/cache", waits=False) == []


COPIED = """
import os, threading, time
from wirerope_mj.foundation import processes
processes.processors = lambda: {processors}
me = os.getpid()
def work():
    print("here" if os.getpid() == me else "copy", file=open("worked", "a"))
    {work}
{before}
with processes.run_beside(work):
    {block}
"""


def worked(folder, *, processors=2, work="", before="", block="pass"):
    """Run work beside a block, and return where it ran, one after the other, and the last line of what was raised."""
    code = COPIED.format(processors=processors, work=work, before=before, block=block)
    done = subprocess.run(
        [sys.executable, "-c", code], cwd=folder, env=processes.environment_of_children(), capture_output=True, text=True,
        timeout=HANG,
    )  # fmt: skip
    note = folder / "worked"
    return note.read_text().split() if note.exists() else [], (done.stderr.splitlines() or [""])[-1]


@pytest.mark.skipif(sys.platform != "linux", reason="a process is copied on Linux alone")
class TestRunBeside:
    def test_work_runs_in_a_copy_while_the_block_does(self, tmp_path):
        waits = "while not os.path.exists('worked'): time.sleep(0.01)"
        assert worked(tmp_path, block=waits) == (["copy"], "")

    def test_what_fails_in_the_copy_runs_again_here_and_says_what_is_wrong(self, tmp_path):
        assert worked(tmp_path, work="raise OSError('full')") == (["copy", "here"], "OSError: full")

    def test_a_block_that_fails_ends_the_copy(self, tmp_path):
        assert worked(tmp_path, work="time.sleep(3600)", block="raise OSError('full')")[1] == "OSError: full"

    @pytest.mark.parametrize("how", [
        {"processors": 1},
        {"before": "ended = threading.Event()\nthreading.Thread(target=ended.wait).start()", "block": "ended.set()"},
    ])  # fmt: skip
    def test_there_is_no_copy_for_one_processor_or_of_several_threads(self, tmp_path, how):
        assert worked(tmp_path, **how) == (["here"], "")
