import os
import re
import shlex
import signal
import subprocess
import sys
import time
from pathlib import Path

import pytest
from commands import WIREROPE, refused, wirerope
from kills import interruptible

from wirerope_mj.cli import main
from wirerope_mj.foundation.errors import RecordError


def test_the_main_job_prints_every_peak_against_its_limit_and_replays(tmp_path):
    done = wirerope("run", "floating_floor_shock", "--duration", "0.15", "--out", "here", "--all", cwd=tmp_path)
    assert (done.returncode, done.stderr) == (0, "")
    lines = done.stdout.splitlines()
    for name in ("deck (base)", "floor", "crew_1_head (point)", *[f"m{n:02d}" for n in range(1, 17)], "h1", "r4"):
        assert any(line.split(" ")[:2] != [] and line.strip().startswith(name) for line in lines), name
    assert max(len(line.rstrip()) for line in lines if line.strip().startswith("m01")) <= 120
    assert "not judged" in done.stdout
    assert "estimated error" in done.stdout
    assert "here/" in done.stdout
    again = wirerope("replay", "here", cwd=tmp_path)
    assert again.returncode == 0
    assert "bit-identical" in again.stdout


@pytest.mark.slow
def test_an_interrupted_run_leaves_nothing_and_exits_130(tmp_path):
    command = [*WIREROPE, "run", "floating_floor_sweep", "--out", "deep/sweep"]
    with interruptible(command, cwd=tmp_path) as process:
        while not list(tmp_path.glob("deep/.sweep.*.part/response.parquet.part")):  # the simulation is under way
            assert process.poll() is None, process.communicate()[1]
            time.sleep(0.05)
        process.send_signal(signal.SIGINT)
        out, err = process.communicate(timeout=120)
    assert process.returncode == 130
    assert err == "wirerope: interrupted; no half-written result was left behind.\n"
    assert out == ""
    assert list(tmp_path.iterdir()) == []


def test_runs_go_to_a_folder_named_after_scenario_and_time(tmp_path, monkeypatch, capsys):
    monkeypatch.chdir(tmp_path)
    assert main(["run", "shock_table", "--duration", "0.05", "--level-g", "5"]) == 0
    (folder,) = (tmp_path / "runs").iterdir()
    assert folder.name.startswith("shock_table-20")
    assert "half-sine 5 g" in capsys.readouterr().out


def test_an_existing_run_needs_force(tmp_path, capsys):
    arguments = ["run", "shock_table", "--duration", "0.05", "--out", str(tmp_path / "run")]
    assert main(arguments) == 0
    capsys.readouterr()
    assert "--force" in refused(capsys, *arguments)
    assert main([*arguments, "--force"]) == 0


def test_a_sweep_says_at_which_frequency_its_peaks_lie(tmp_path, capsys):
    assert main(["run", "sdof_sweep", "--duration", "0.2", "--out", str(tmp_path / "run"), "--all"]) == 0
    assert "[Hz]" in capsys.readouterr().out


@pytest.mark.parametrize(
    ("arguments", "message"),
    [
        (["run", "nosuch"], "no scenario 'nosuch'.*floating_floor_shock"),
        (["run", "shock_table", "--level", "3"], "Unknown option: --level.*--level-g"),
        (["run", "shock_table", "--level-g", "high"], "--level-g.*high"),
        (["run", "shock_table", "--direction", "up", "--out", "RUN"], "`direction` must be.*'up'"),
        (["run", "shock_table", "--duration", "-1", "--out", "RUN"], "`duration` must be > 0, got -1"),
        (["run", "shock_table", "--callback", "magic", "--out", "RUN"], "`callback` must be.*'magic'"),
        (["run", "sdof_sweep", "--level-g", "2", "--out", "RUN"], "`level_g` must be.*2"),
        (["run", "--out", "RUN"], "the scenario comes first"),
        (["replay", "RUN"], "this is not a run"),
        (["show", "RUN"], "there is no such recording"),
        (["isolators", "nosuch"], "no isolator 'nosuch'.*enidine_wr16_400"),
        (["isolators", "enidine_wr16_400", "--out", "loops.docx"], "must end with .png"),
        (["isolators", "enidine_wr16_400", "--out", "RUN/loops.png"], "there is no folder"),
        (["isolators", "--out", "loops.png"], "name it"),
        (["isolators", "fit", "nosuch.toml", "out.toml"], "nosuch.toml"),
        (["walk"], "Unknown command.*walk.*run"),
    ],
)
def test_bad_input_gets_one_message_and_leaves_nothing(tmp_path, monkeypatch, capsys, arguments, message):
    monkeypatch.chdir(tmp_path)
    printed = refused(capsys, *arguments)
    assert re.search(message, printed), printed
    assert list(tmp_path.iterdir()) == []


def test_an_output_folder_that_is_not_a_run_is_refused(tmp_path, capsys):
    (tmp_path / "notes.txt").touch()
    assert "is not a run" in refused(capsys, "run", "shock_table", "--out", tmp_path, "--force")
    assert [path.name for path in tmp_path.iterdir()] == ["notes.txt"]


def test_replay_of_a_changed_run_exits_1_and_says_where(tmp_path, capsys):
    folder = tmp_path / "run"
    main(["run", "shock_table", "--duration", "0.1", "--out", str(folder)])
    model = folder / "model" / "shock_table.xml"
    text = model.read_text(encoding="utf-8")
    changed = text.replace('gravity="0 0 -9.80665"', 'gravity="0 0 -9.7"')
    assert changed != text
    model.write_text(changed, encoding="utf-8")
    capsys.readouterr()
    assert main(["replay", str(folder)]) == 1
    assert "largest difference" in capsys.readouterr().out


def test_isolators_lists_the_catalogue_and_draws_one(tmp_path, capsys):
    assert main(["isolators"]) == 0
    assert "enidine_wr16_400" in capsys.readouterr().out
    picture = tmp_path / "loops.png"
    assert main(["isolators", "enidine_wr16_400", "--out", str(picture)]) == 0
    out = capsys.readouterr().out
    assert "alpha" in out
    assert "damping" in out
    assert "[%]" in out
    assert picture.read_bytes().startswith(b"\x89PNG")


@pytest.mark.parametrize(
    ("command", "words"),
    [
        ("run", ["SCENARIO [OPTIONS]", "--timestep", "--limit", "--out", "a run that is there is replaced only"]),
        (
            "study",
            ["STUDY-OR-SCENARIO [OPTIONS]", "--vary", "--limit", "--by", "--sampling", "--variants", "--workers", "--out"],
        ),
        ("replay", ["Compared are all stored numbers"]),
        ("export", ["mounts/*/force/*"]),
    ],
)  # fmt: skip
def test_help_of_a_command_says_all_before_a_file_is_named(command, words, capsys):
    assert main([command, "--help"]) == 0
    out = " ".join(capsys.readouterr().out.replace("│", "").split())
    assert out.startswith("Usage: wirerope ")
    for word in words:
        assert word in out
    if command in ("run", "study"):
        assert re.search(r"--help also shows the options of that (scenario|study)\.$", out)


def test_help_of_a_scenario_shows_its_options(capsys):
    assert main(["run", "shock_table", "--help"]) == 0
    out = capsys.readouterr().out
    assert "--pulse-ms" in out
    assert "--force" in out
    assert main(["run", "--list"]) == 0
    assert "cabinet_shock" in capsys.readouterr().out


def test_show_hands_the_folder_to_the_viewer(monkeypatch):
    seen = []
    monkeypatch.setattr("wirerope_mj.views.recording.show", lambda folder: seen.append((folder, "window")))
    monkeypatch.setattr("wirerope_mj.views.share.server.show_in_browser", lambda folder: seen.append((folder, "browser")))
    assert main(["show", "somewhere"]) == main(["show", "somewhere", "--web"]) == 0
    assert seen == [(Path("somewhere"), "window"), (Path("somewhere"), "browser")]


def test_show_without_a_run_is_an_error_of_the_recording(tmp_path):
    from wirerope_mj.views.recording import show

    with pytest.raises(RecordError, match="no such recording"):
        show(tmp_path)


@pytest.mark.slow
def test_a_reader_that_has_seen_enough_is_no_error(tmp_path):
    command = shlex.join([*WIREROPE, "isolators"])
    done = subprocess.run(
        ["bash", "-c", f"set -o pipefail; {command} | head -1"],
        cwd=tmp_path,
        capture_output=True,
        text=True,
        check=False,
    )
    assert done.returncode == 0
    assert done.stderr == ""


@pytest.mark.parametrize("closed", ["stdout", "stderr", "both"])
def test_a_closed_stream_is_no_error(closed, tmp_path):
    """`wirerope levels >&-`: what would be printed has no reader, and no file takes the place of the stream."""
    redirected = {"stdout": ">&-", "stderr": "2>&-", "both": ">&- 2>&-"}[closed]
    code = "import sys; from wirerope_mj.cli import main; sys.exit(main())"
    done = subprocess.run(
        f'"{sys.executable}" -c "{code}" levels {redirected}',
        shell=True, cwd=tmp_path, capture_output=True, text=True, timeout=120,
    )  # fmt: skip
    assert done.returncode == 0
    assert done.stderr == ""


@pytest.mark.slow
@pytest.mark.skipif(not os.path.exists("/dev/full"), reason="there is no device that is always full")
@pytest.mark.parametrize(("redirected", "code", "told"), [
    (">/dev/full", 2, "wirerope: standard output: No space left on device; what was printed is not complete.\n"),
    ("| true", 0, ""),
    ("2>/dev/full >/dev/null", 0, ""),
])  # fmt: skip
def test_a_run_whose_output_nobody_takes_is_written_all_the_same(redirected, code, told, tmp_path):
    command = shlex.join([*WIREROPE, "run", "shock_table", "--duration", "0.05", "--level-g", "5", "--out", "run"])
    done = subprocess.run(
        ["bash", "-c", f"set -o pipefail; {command} {redirected}"], cwd=tmp_path, capture_output=True, text=True, timeout=120
    )
    assert (done.returncode, done.stderr) == (code, told)
    assert (tmp_path / "run" / "checksums.txt").is_file()
    assert [path.name for path in tmp_path.iterdir()] == ["run"]


@pytest.mark.parametrize("megabytes", [250, 600, 2000])  # where libraries failed to load, ended the process, or waited for ever
def test_too_little_address_space_is_one_message(megabytes, tmp_path):
    resource = pytest.importorskip("resource", reason="Windows has no such limit")
    size = megabytes * 2**20
    done = subprocess.run(
        [*WIREROPE, "export", "run", "o.h5"], cwd=tmp_path, capture_output=True, text=True, timeout=120,
        preexec_fn=lambda: resource.setrlimit(resource.RLIMIT_AS, (size, size)),
    )  # fmt: skip
    assert done.returncode == 2
    assert done.stderr.count("\n") == 1
    assert f"limited to {megabytes} MB (ulimit -v)" in done.stderr
