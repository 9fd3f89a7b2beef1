"""A write that fails, is cut short or is the last: `faults.py` injects many into every command, here a few into two."""

import os
import shutil
import subprocess
import sys
from pathlib import Path

import pytest

pytestmark = [
    pytest.mark.slow,
    pytest.mark.skipif(sys.platform != "linux" or not shutil.which("gcc"), reason="needs Linux's loader and a compiler"),
]


@pytest.mark.parametrize("name", ["study", "export h5"])
def test_a_command_that_meets_faults_leaves_the_old_or_the_new(name, tmp_path):
    command = [sys.executable, str(Path(__file__).parents[1] / "faults.py"), name, "--times", "5", "--seed", "1"]
    done = subprocess.run(command, env={**os.environ, "TMPDIR": str(tmp_path)}, capture_output=True, text=True, timeout=600)
    assert done.returncode == 0, done.stdout + done.stderr
    assert "in all 5 faults, 0 wrong" in done.stdout
