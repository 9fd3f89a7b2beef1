"""`wirerope run` prints its verdict as soon as it is judged, and then writes the folder."""

import errno
import io
import json
import math
import os
import subprocess
import sys
from dataclasses import replace

import pytest
from made_up_floor import floor_response

from wirerope_mj.cli import main
from wirerope_mj.content import judged_run as judged_module
from wirerope_mj.content.run import doubtful_numerics

SHORT = ["run", "shock_table", "--duration", "0.4", "--out"]


class Terminal(io.StringIO):
    """Standard error that says it is a terminal."""

    def isatty(self) -> bool:
        return True


@pytest.mark.parametrize(
    ("error", "code", "said"),
    [
        (OSError(errno.ENOSPC, "No space left on device"), 2, "there is no space left for it"),
        (PermissionError(errno.EACCES, "Permission denied"), 2, "Permission denied"),
        (KeyboardInterrupt(), 130, "interrupted; no half-written result was left behind."),
    ],
)
def test_the_verdict_is_printed_before_anything_is_written_and_holds_when_writing_fails(
    tmp_path, monkeypatch, capsys, error, code, said
):
    there, printed = [], []

    def fail(*_, **__):
        there.append((tmp_path / "run").exists())
        printed.append(" ".join(capsys.readouterr().out.split()))
        raise error

    monkeypatch.setattr("wirerope_mj.engine.response.Response.save", fail)
    assert main([*SHORT, str(tmp_path / "run")]) == code
    assert there == [False]
    assert "most critical m1 " in printed[0]
    end = capsys.readouterr()
    assert end.out == ""  # nothing says that a folder was written
    assert said in end.err
    assert f"the peaks and verdicts above hold, but the run was not written to {tmp_path / 'run'}." in end.err
    assert not list(tmp_path.iterdir())


def test_a_run_says_its_verdict_first_and_all_of_it_in_twelve_lines(tmp_path, capsys):
    assert main([*SHORT, str(tmp_path / "run")]) == 0
    lines = [line for line in capsys.readouterr().out.splitlines() if line.strip()]
    assert len(lines) <= 12
    summary = json.loads((tmp_path / "run" / "summary.json").read_text(encoding="utf-8"))
    assert lines[0].strip() == summary["headline"]
    assert " → " in lines[1]
    assert lines[-2].split()[:2] == ["wirerope", "show"]


def test_a_folder_with_a_space_is_named_as_a_shell_takes_it(tmp_path, monkeypatch, capsys):
    monkeypatch.chdir(tmp_path)
    assert main([*SHORT, "with space"]) == 0
    assert "wirerope show 'with space'" in capsys.readouterr().out


@pytest.mark.parametrize(
    ("error", "accuracy", "said"),
    [(0.37, math.nan, True), (0.37, 1e-4, True), (9e-5, 1e-4, False), (5e-3, math.nan, False), (math.nan, math.nan, False)],
)
def test_an_error_that_matters_is_among_the_first_lines(error, accuracy, said):
    numerics = replace(floor_response().numerics, error_estimate=error, accuracy=accuracy, limited_by="")
    statement = doubtful_numerics(numerics)
    assert (statement is not None) is said
    assert not said or ("3.7e-01 of the peaks" in statement.text and statement.tone == "unjudged")


def test_an_error_before_the_verdict_says_nothing_of_one(tmp_path, capsys):
    assert main([*SHORT, str(tmp_path / "run"), "--timestep", "1"]) == 2
    assert "above" not in capsys.readouterr().err


def test_a_run_is_judged_once_and_printed_as_its_summary_says_it(tmp_path, monkeypatch, capsys):
    calls = []
    judge = judged_module.judge
    monkeypatch.setattr(judged_module, "judge", lambda *given, **named: calls.append(1) or judge(*given, **named))
    assert main([*SHORT, str(tmp_path / "run"), "--all"]) == 0
    assert len(calls) == 1
    printed = capsys.readouterr()
    assert printed.err == ""  # where nobody looks on there is no progress line
    summary = json.loads((tmp_path / "run" / "summary.json").read_text(encoding="utf-8"))
    assert f"  {summary['headline']}\n" in printed.out
    assert summary["headline"] in (tmp_path / "run" / "report.html").read_text(encoding="utf-8")
    (mount,) = summary["mounts"]
    (row,) = [line.split() for line in printed.out.splitlines() if line.startswith(mount["name"])]
    assert row[1:3] == [f"{1e3 * mount[key]['axial']:.1f}" for key in ("lowest_deflection_m", "highest_deflection_m")]
    assert f"{100 * mount['share_of_travel']['compression']:.0f}" in row
    verdict, folder = printed.out.index("estimated error"), printed.out.index(f"written to {tmp_path / 'run'}/report.html,")
    assert verdict < folder < printed.out.index("s in all")


def test_a_terminal_shows_what_is_being_written_and_keeps_nothing_of_it(tmp_path, monkeypatch):
    terminal = Terminal()
    monkeypatch.setattr(sys, "stderr", terminal)
    monkeypatch.setenv("TERM", "xterm")
    assert main([*SHORT, str(tmp_path / "run")]) == 0
    shown = terminal.getvalue()
    assert shown.index("writing the response") < shown.index("writing the recording, the pictures and the report")
    assert shown.endswith("\x1b[2K")  # the line is erased


@pytest.mark.slow
def test_a_reader_that_leaves_before_the_verdict_does_not_cost_the_folder(tmp_path):
    command = [sys.executable, "-c", "import sys; from wirerope_mj.cli import main; sys.exit(main())", *SHORT, "run"]
    with subprocess.Popen(
        command, cwd=tmp_path, env=dict(os.environ), stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True
    ) as process:
        process.stdout.close()
        assert (process.wait(timeout=120), process.stderr.read()) == (0, "")
    assert (tmp_path / "run" / "checksums.txt").is_file()
