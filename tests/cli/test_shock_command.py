"""`wirerope shock`: a measured record becomes a run that can be shown, replayed and judged like any other."""

import json
import tomllib
from pathlib import Path

import numpy as np
import pytest
from uff_files import history

import wirerope_mj as wr
from wirerope_mj.cli import main
from wirerope_mj.motions import HalfSine

G = 9.80665
TIME = np.arange(400) / 2000.0
PULSE = HalfSine(peak=10 * G, duration=0.011, direction="z", start=0.05).acceleration(TIME)[:, 2]
QUICK = ["--duration", "0.1"]


@pytest.fixture
def record(tmp_path, monkeypatch):
    """Writes a pulse [g] into columns of these names, and returns the file's name in the current folder."""
    monkeypatch.chdir(tmp_path)

    def write(*names, name="deck.csv", values=PULSE / G):
        head = ",".join(["time [s]", *(f"{column} [g]" for column in names)])
        table = np.column_stack([TIME, *[values] * len(names)])
        np.savetxt(name, table, delimiter=",", header=head, comments="", fmt="%.9g")
        return name

    return write


@pytest.fixture
def asked(monkeypatch):
    """Makes the command hand over its scenario in place of simulating it, and returns how to run it."""
    scenarios = []
    monkeypatch.setattr("wirerope_mj.runs.write_run", lambda made, folder, **_: scenarios.append(made))
    monkeypatch.setattr("wirerope_mj.cli.tables.print_written", lambda *_, **__: None)

    def run(*arguments):
        assert main(["shock", *arguments]) == 0
        return scenarios[-1]

    return run


@pytest.mark.slow
def test_a_shipped_model_and_a_record_make_a_run_that_replays_bit_for_bit(record, capsys, tmp_path):
    arguments = ["--baseline", "highpass", "--highpass", "3", "--resample", "4000", "--scale", "0.5", "--start", "0.02"]
    assert main(["shock", "shock_table", "--record", record("ch7"), "--direction", "z", *arguments, *QUICK]) == 0
    out = capsys.readouterr()
    assert "block" in out.out
    assert "record deck.csv" in out.out
    assert out.err == ""
    (folder,) = (tmp_path / "runs").iterdir()
    assert folder.name.startswith("shock-shock_table-deck-")
    assert (folder / "inputs" / "deck.csv").read_bytes() == (tmp_path / "deck.csv").read_bytes()
    assert (folder / "record_baseline.png").stat().st_size > 10_000
    assert (folder / "run.rrd").is_file()
    motion = tomllib.loads((folder / "scenario.toml").read_text())["motion"]
    kept = {"highpass": 3.0, "resample": 4000.0, "scale": 0.5, "start": 0.02, "channels": {"ch7": "z"}}
    assert kept.items() <= motion.items()

    (tmp_path / "deck.csv").unlink()  # nothing outside the folder is read again
    assert main(["replay", str(folder)]) == 0
    assert "bit-identical" in capsys.readouterr().out


@pytest.mark.parametrize(
    ("direction", "expected"),
    [("x", [1, 0, 0]), ("-z", [0, 0, -1]), ("0,1,1", [0, np.sqrt(0.5), np.sqrt(0.5)])],
)
def test_a_record_of_one_channel_is_turned(record, asked, direction, expected):
    # whatever its column is called: here z is turned
    made = asked("shock_table", "--record", record("z"), f"--direction={direction}")
    np.testing.assert_allclose(made.motion.samples, np.outer(PULSE, expected), atol=1e-7)  # nine printed digits


def test_channels_say_where_each_one_goes(record, asked):
    file = record("a", "b", "c")
    two = asked("shock_table", "--record", file, "--channels", "a=x", "c=-z").motion
    np.testing.assert_allclose(two.samples, np.outer(PULSE, [1, 0, -1]), atol=1e-7)
    one = asked("shock_table", "--record", file, "--channels", "b", "--direction", "y").motion
    np.testing.assert_allclose(one.samples, np.outer(PULSE, [0, 1, 0]), atol=1e-7)


@pytest.mark.slow
def test_a_universal_file_moves_the_base_on_its_axes(record, capsys, tmp_path):
    axes = [history(3, "x", PULSE, step=5e-4, unit="m/s^2"), history(3, "-z", PULSE, step=5e-4, unit="m/s^2")]
    (tmp_path / "deck.unv").write_bytes(b"".join(axes))
    record("unused")
    assert main(["shock", "shock_table", "--record", "deck.unv", "--out", "r", *QUICK]) == 0
    base = wr.load_response("r").base.acceleration
    np.testing.assert_array_equal(base[:, 0], -base[:, 2])
    assert main(["replay", "r"]) == 0
    assert "bit-identical" in capsys.readouterr().out


def test_gravity_and_gaps_are_mended_by_the_options_that_the_messages_name(record, asked, capsys, tmp_path):
    file = record("z", values=PULSE / G + 1.0)
    rows = (tmp_path / file).read_text().splitlines()
    rows[11] = rows[11].partition(",")[0] + ","
    (tmp_path / file).write_text("\n".join(rows))
    assert main(["shock", "shock_table", "--record", file, *QUICK]) == 2
    assert 'deck.csv, line 12: an empty cell in column "z"; have such samples filled' in capsys.readouterr().err
    made = asked("shock_table", "--record", file, "--gaps", "fill")
    assert "(--baseline rest) takes it off" in capsys.readouterr().err
    made = asked("shock_table", "--record", file, "--gaps", "fill", "--baseline", "rest")
    np.testing.assert_allclose(made.motion.samples[:, 2], PULSE, atol=1e-7)  # nine printed digits
    (said,) = capsys.readouterr().err.splitlines()
    assert said.endswith('1 sample missing in column "z" (at 0.005 s) filled with straight lines.')


def test_the_run_goes_on_for_ten_periods_of_the_slowest_mode(record, asked):
    made = asked("sdof_shaker", "--record", record("z"))
    system = wr.load_system(made.model_source())
    stiffness = sum(mount.isolator.axial.initial_stiffness for mount in system.mounts.values())
    period = 2 * np.pi * np.sqrt(float(system.model.body("mass").mass[0]) / stiffness)
    assert made.simulate["duration"] == pytest.approx(np.ceil(10 * (TIME[-1] + 10 * period)) / 10, abs=1e-9)
    assert asked("sdof_shaker", "--record", "deck.csv", "--duration", "3").simulate["duration"] == 3.0


def test_doubts_are_one_line_each_on_standard_error(record, asked, capsys):
    asked("shock_table", "--record", record("z", values=PULSE / G + 1.0))
    lines = capsys.readouterr().err.splitlines()
    assert all(line.startswith("wirerope: warning: ") for line in lines)
    assert [line for line in lines if "as if gravity were in it" in line]


@pytest.mark.parametrize(
    ("options", "message"),
    [
        (["--record", "gone.csv"], "gone.csv: no such file"),
        (
            ["--record", "deck.csv", "--channels", "a", "--direction", "up"],
            "`direction` must be x, y, z, -x, -y, -z or a vector",
        ),
        (
            ["--record", "deck.csv", "--direction", "z"],
            "turns a record of one channel, and here are a, b. Say where each",
        ),
        (["--record", "deck.csv", "--channels", "a"], "`channels` are NAME=DIRECTION, for instance ch3=z, got 'a'"),
        (["--record", "deck.csv", "--channels", "q=z"], 'there is no column "q"; the columns are a, b'),
        (["--record", "deck.csv"], "(--channels a=z)"),
        (["--record", "still.csv"], "still.csv: all of its samples are zero, so that the base would not move"),
        (["--record", "z.csv", "--start", "-1"], "the record end at -0.8005 s, before the simulation begins at 0 s"),
        (
            ["--record", "z.csv", "--start", "0.1"],
            "`duration` 0.1 ends the simulation before the record begins, at 0.1 s",
        ),
        (
            ["--record", "deck.csv", "--channels", "a=z", "--baseline", "highpass"],
            "needs its cutoff [Hz], for instance highpass=1.0 (--highpass 1)",
        ),
        (["--record", "deck.csv", "--channels", "a=z", "--scale", "0"], "`scale` must not be zero"),
        ([], "--record"),
    ],
)
def test_bad_input_is_one_message_and_exit_code_2(record, capsys, options, message):
    record("a", "b")
    record("z", name="z.csv")
    record("z", name="still.csv", values=0.0 * TIME)
    assert main(["shock", "shock_table", *options, *QUICK]) == 2
    error = capsys.readouterr().err
    assert message in error
    assert "Traceback" not in error


def test_an_unknown_model_names_those_that_ship(record, capsys):
    assert main(["shock", "no_such_model", "--record", record("z")]) == 2
    assert "shock_table" in capsys.readouterr().err


def test_a_run_is_replaced_only_by_force(record, capsys, tmp_path):
    (tmp_path / "r").mkdir()
    (tmp_path / "r" / "scenario.toml").write_text("")
    (tmp_path / "r" / "summary.json").write_text("")
    assert main(["shock", "shock_table", "--record", record("z"), "--out", "r", *QUICK]) == 2
    assert "Replace it with --force" in capsys.readouterr().err


def test_motions_of_several_options_are_added_and_named(asked):
    made = asked("cabinet", "--half-sine", "15 g 11 ms z", "--half-sine", "8 g 11 ms x", "--velocity-step", "1 m/s y", *QUICK)
    assert made.name == "shock-cabinet-half-sine-velocity-step"
    assert made.options["half-sine"] == "15 g 11 ms z; 8 g 11 ms x"
    assert made.motion.acceleration([0.0055])[0] / G == pytest.approx([8.0, 0.0, 15.0])
    assert made.motion.velocity([0.05])[0, 1] == pytest.approx(1.0)


def test_a_record_and_a_pulse_are_played_together(asked, record):
    made = asked("cabinet", "--half-sine", "15 g 11 ms x", "--record", record("z"), *QUICK)
    assert made.motion.acceleration([0.0055])[0, 0] == pytest.approx(15 * G)
    assert made.motion.acceleration([0.0555])[0, 2] == pytest.approx(10 * G, rel=1e-3)


@pytest.mark.slow
def test_a_limit_of_the_command_is_judged_stored_and_replayed(tmp_path, monkeypatch, capsys):
    monkeypatch.chdir(tmp_path)
    pulse = ["--half-sine", "15 g 11 ms z at 20 ms", "--duration", "0.2"]
    assert main(["shock", "cabinet", *pulse, "--limit", "acceleration/rack = 1 g", "--out", "run"]) == 0
    assert "FAIL: rack " in capsys.readouterr().out
    summary = json.loads((tmp_path / "run" / "summary.json").read_text())
    row = next(row for row in summary["judged"] if (row["criterion"], row["subject"]) == ("acceleration", "rack"))
    assert row["verdict"] == "exceeded"
    assert row["limit"] == pytest.approx(G)
    assert tomllib.loads((tmp_path / "run" / "scenario.toml").read_text())["judge"]["limits"] == {"acceleration/rack": [G]}
    assert wr.replay(tmp_path / "run").identical
    capsys.readouterr()
    assert main(["run", "cabinet_shock", "--duration", "0.1", "--limit", "acceleration/rack = 1 g", "--out", "other"]) == 0
    assert "FAIL: rack " in capsys.readouterr().out


@pytest.mark.parametrize(
    ("arguments", "said"),
    [
        ([], "say how the base moves"),
        (["--half-sine", "15 g z"], "a time must stand there"),
        (["--half-sine", "15 g 11 ms z", "--direction", "x"], "`--direction` belongs to `--record`"),
        (["--half-sine", "15 g 11 ms z", "--limit", "acceleration/rack = 15"], "is written like"),
        (["--half-sine", "15 g 11 ms z", "--limit", "acceleration/nothing = 15 g", *QUICK], "no point 'nothing'"),
        (["--levels", "missing.toml"], "missing.toml"),
        (["--half-sine", "15 g 11 ms z at 5 s", "--duration", "1"], "before anything begins, at 5 s"),
    ],
)
def test_what_cannot_be_played_is_one_message_and_nothing_is_written(arguments, said, tmp_path, monkeypatch, capsys):
    monkeypatch.chdir(tmp_path)
    assert main(["shock", "cabinet", *arguments]) == 2
    assert said in capsys.readouterr().err
    assert list(tmp_path.rglob("*")) == [] or list(tmp_path.iterdir()) == [tmp_path / "runs"]


def test_levels_are_listed_and_written_to_be_filled_in(tmp_path, monkeypatch, capsys):
    monkeypatch.chdir(tmp_path)
    assert main(["levels"]) == 0
    assert "BV 043" in capsys.readouterr().out
    assert main(["levels", "bv_043"]) == 0
    assert "?" in (tmp_path / "bv_043.toml").read_text()
    assert main(["levels", "bv_043"]) == 2
    assert main(["levels", "bv_044"]) == 2
    assert main(["shock", "cabinet", "--levels", "bv_043.toml"]) == 2
    assert "still open" in capsys.readouterr().err


def test_a_sweep_ends_the_run_and_a_pulse_is_followed_by_its_ring_down(asked):
    sweep = asked("cabinet", "--sweep", "0.5 g 5 to 20 Hz 50 oct/min z")
    assert sweep.simulate["duration"] == sweep.motion.end == pytest.approx(2.4)
    pulse = asked("cabinet", "--half-sine", "15 g 11 ms z at 50 ms")
    assert 0.061 + 5.0 / 11.3 < pulse.simulate["duration"] < 0.061 + 15.0 / 11.3  # ten periods of some 11 Hz


@pytest.mark.slow
def test_a_run_on_a_deck_that_bends_says_so_replays_and_becomes_a_study(tmp_path, monkeypatch, capsys):
    monkeypatch.chdir(tmp_path)
    deck = ["--deck", "18 Hz 100 kg 4 %"]
    assert main(["shock", "shock_table", "--half-sine", "15 g 11 ms z", *deck, "--duration", "0.2", "--out", "run"]) == 0
    assert "deck_panel" in capsys.readouterr().out
    page = Path("run/report.html").read_text(encoding="utf-8")
    assert "18 Hz 100 kg 4 %" in page
    assert "was not looked at" not in page
    assert main(["replay", "run"]) == 0
    vary = ["--vary", "joint/deck_panel/frequency = Uniform(12, 25)", "--variants", "4", "--workers", "1"]
    assert main(["study", "run", *vary, "--out", "study"]) == 0
    levels = ["--vary", "motion/level = Uniform(0.5, 1)", "--variants", "2"]
    assert main(["study", "shock_table", *deck, *levels, "--workers", "1", "--out", "of"]) == 0


@pytest.mark.parametrize("command", ["shock", "modes", "statics", "frf"])
def test_a_deck_that_is_none_is_one_message(command, tmp_path, monkeypatch, capsys):
    monkeypatch.chdir(tmp_path)
    motion = ["--half-sine", "15 g 11 ms z"] if command == "shock" else []
    assert main([command, "shock_table", *motion, "--deck", "10 Hz 800"]) == 2
    error = capsys.readouterr().err
    assert 'Expected is a phrase such as "10 Hz 800 kg 4 %"' in error
    assert error.count("\n") == 1
    assert not list(tmp_path.iterdir())


def test_a_motion_is_listed_in_one_text_or_written_again(tmp_path):
    """The same run, bit by bit, in both ways, and in a job."""
    phrases = ["5 g 11 ms z", "3 g 6 ms z at 20 ms"]
    common = ["shock", "shock_table", "--duration", "0.06", "--timestep", "5e-4"]
    again = [word for phrase in phrases for word in ("--half-sine", phrase)]
    assert main([*common, *again, "--out", str(tmp_path / "again")]) == 0
    assert main([*common, "--half-sine", "; ".join(phrases), "--out", str(tmp_path / "listed")]) == 0
    again, listed = ((tmp_path / name / "response.parquet").read_bytes() for name in ("again", "listed"))
    assert again == listed
    job = tmp_path / "job.toml"
    texts = "".join(f'[[case]]\nname = "{name}"\nhalf-sine = {value}\n' for name, value in (
        ("list", str(phrases).replace("'", '"')), ("text", f'"{"; ".join(phrases)}"'),
    ))  # fmt: skip
    job.write_text(f'model = "shock_table"\n{texts}', encoding="utf-8")
    one, other = (case.scenario.motion for case in wr.load_job(job).cases)
    assert one == other


@pytest.mark.parametrize(
    "words",
    [("--scale", "2"), ("--baseline", "rest"), ("--start", "0.1"), ("--unit", "g"), ("--fade", "0.1"), ("--gaps", "fill")],
)
def test_options_of_a_record_are_refused_without_one(words, tmp_path, capsys):
    command = ["shock", "shock_table", "--half-sine", "15 g 11 ms z", "--out", str(tmp_path / "run")]
    assert main([*command, *words]) == 2
    assert f"`{words[0]}` belongs to `--record`, which is not given." in capsys.readouterr().err
    assert not list(tmp_path.iterdir())
