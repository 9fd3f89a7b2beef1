"""Runs the command in a process of its own, or here and takes the one message of what must be refused."""

import os
import subprocess
import sys

from wirerope_mj.cli import main

WIREROPE = [sys.executable, "-c", "import sys; from wirerope_mj.cli import main; sys.exit(main())"]

JOB = """
name = "Table"
model = "shock_table"
[[case]]
name = "Down"
half-sine = "5 g 11 ms -z"
[simulate]
duration = 0.1
"""  # a job of one short case


def wirerope(*arguments, cwd) -> subprocess.CompletedProcess:
    environment = {**os.environ, "COLUMNS": "120", "NO_COLOR": "1"}
    return subprocess.run(
        [*WIREROPE, *arguments], cwd=cwd, env=environment, capture_output=True, text=True, timeout=120, check=False
    )


def refused(capsys, *arguments) -> str:
    """Return the one message of a command that must be refused."""
    assert main([str(argument) for argument in arguments]) == 2
    printed = capsys.readouterr()
    assert "Traceback" not in printed.err
    assert printed.err.count("\n") == 1
    assert printed.out == ""
    return printed.err
