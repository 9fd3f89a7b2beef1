"""A command that compiles starts one process beside it, which ends with it; a library starts none."""

import os
import subprocess
import sys
import time

import pytest

from wirerope_mj.foundation import processes

pytestmark = pytest.mark.quick

COMMAND = """
import sys
from wirerope_mj.foundation import jit, processes
processes.BESIDE = [sys.executable, "-c", "import os, time; print(os.getpid(), file=open('beside', 'a')); time.sleep(60)"]
processes.processors = lambda: {processors}
{before}
for n in (1, 2):
    jit.njit(eval("lambda x: x + %d" % n))(1.0)
import time, pathlib
end = time.monotonic() + 5.0
while {waits} and not pathlib.Path("beside").exists() and time.monotonic() < end:
    time.sleep(0.05)
"""


def beside(folder, *, before="processes.allow_one_beside()", processors=2, waits=True, cache="cache"):
    """Run two kernels that are not at hand, and return the numbers of the processes that stood beside them."""
    code = COMMAND.format(before=before, processors=processors, waits=waits)
    environment = processes.environment_of_children() | {"NUMBA_CACHE_DIR": str(folder / cache)}
    subprocess.run([sys.executable, "-c", code], cwd=folder, env=environment, check=True, timeout=60)
    note = folder / "beside"
    return note.read_text().split() if note.exists() else []


def test_the_first_kernel_that_a_command_compiles_starts_one_process_which_ends_with_it(tmp_path):
    (number,) = beside(tmp_path)
    end = time.monotonic() + 10.0
    while os.path.exists(f"/proc/{number}") and time.monotonic() < end:
        time.sleep(0.05)
    assert not os.path.exists(f"/proc/{number}")


@pytest.mark.slow
def test_a_library_starts_none_and_so_does_a_command_with_one_processor(tmp_path):
    assert beside(tmp_path, before="", waits=False) == []
    assert beside(tmp_path, processors=1, waits=False) == []


def test_none_is_started_where_compiled_kernels_are_not_kept(tmp_path):
    (tmp_path / "file").touch()
    assert beside(tmp_path, cache="file/cache", waits=False) == []
