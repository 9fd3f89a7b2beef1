"""`wirerope frf`: tables on the screen, a folder with what they rest on; one message for bad input."""

import json
import re
import shutil
import tomllib

import numpy as np
import pyarrow.parquet as pq
import pytest

import wirerope_mj as wr
from wirerope_mj.cli import main
from wirerope_mj.dynamics.frequency_response import ResponseOptions, frequency_response
from wirerope_mj.dynamics.frequency_response import result as response_module
from wirerope_mj.dynamics.periodic import periodic_orbit
from wirerope_mj.foundation import errors as wr_errors
from wirerope_mj.foundation.errors import ConvergenceError
from wirerope_mj.foundation.resources import models_folder

MODEL = str(models_folder() / "sdof_shaker.xml")
NARROW = ("--start", "34", "--stop", "39", "--largest-step", "0.04")


@pytest.fixture(scope="module")
def both(tmp_path_factory):
    """Return exit code, text on the screen and folder of two levels with branches and sweeps."""
    folder = tmp_path_factory.mktemp("frf") / "result"
    return folder, ("frf", MODEL, "--acceleration", "5", "2", "--method", "both", "--rate", "3", "--all", *NARROW)


@pytest.fixture(scope="module")
def written(both):
    import contextlib
    import io

    folder, arguments = both
    screen = io.StringIO()
    with contextlib.redirect_stdout(screen):
        code = main([*arguments, "--out", str(folder)])
    return code, re.sub(r"[ \n]+", " ", screen.getvalue()), folder


def test_every_level_is_shown_with_its_resonance_and_what_the_sweeps_say(written):
    code, out, folder = written
    assert code == 0
    assert "Base along z, acceleration of mass along z, 34 to 39 Hz (given)." in out
    assert out.index("Level 2 m/s²") < out.index("Level 5 m/s²")
    assert out.count("resonance peak") == 2
    assert out.count("all motions are stable") == 2
    assert out.count("peak of the sweep down") == 2
    assert f"written to {folder}/" in out


def test_the_resonance_falls_and_its_transmissibility_too_when_the_level_rises(written):
    levels = json.loads((written[2] / "frequency_response.json").read_text())["levels"]
    weak, strong = (level["continuation"]["peaks"][0] for level in levels)
    # A softening isolator: dry friction damps small motions less, relative to their stiffness (thesis fig. 3.21).
    assert strong["frequency"] < weak["frequency"]
    assert strong["transmissibility"] < weak["transmissibility"]
    assert strong["amplitude"] > weak["amplitude"]
    assert not strong["at_edge"]


def test_a_sweep_agrees_with_the_branch_as_far_as_its_rate_lets_it(written):
    levels = json.loads((written[2] / "frequency_response.json").read_text())["levels"]
    for level in levels:
        for way in ("sweep_up", "sweep_down"):
            # 3 octaves/min lag by 3 ln 2 / 60 times a decay of some 0.05 s: 0.2 % in frequency, Q times that on the flank.
            assert level[way]["largest"] < 0.05
            assert level[way]["median"] < 0.02


def test_tables_hold_every_point_of_the_branches_and_every_cycle_of_the_sweeps(written):
    folder = written[2]
    points = pq.read_table(folder / "branches.parquet").to_pydict()
    assert set(points["level"]) == {0, 1}
    ratio = np.array(points["amplitude"]) / np.array(points["acceleration"])
    np.testing.assert_array_equal(ratio, points["transmissibility"])
    assert all(points["stable"])
    modulus = np.hypot(points["multiplier_1/re"], points["multiplier_1/im"])
    assert (modulus < 1.0).all()
    assert set(points["bifurcation"]) == {""}
    sweeps = pq.read_table(folder / "sweeps.parquet").to_pydict()
    assert set(sweeps["way"]) == {"up", "down"}
    np.testing.assert_array_equal(sweeps["amplitude"], sweeps["bodies/mass/acceleration/z"])


def test_one_table_and_one_headline_stand_on_screen_page_and_in_the_file(written):
    _, out, folder = written
    content = json.loads((folder / "frequency_response.json").read_text())
    page = (folder / "report.html").read_text(encoding="utf-8")
    assert f" {content['headline']} " in out
    assert content["headline"] in page
    rows = content["tables"]["peaks"]["rows"]
    assert [row[1] for row in rows] == 2 * ["resonance peak", "peak of the sweep up", "peak of the sweep down"]
    peaks = [level["continuation"]["peaks"][0] for level in content["levels"]]
    assert [row[2:5] for row in rows[::3]] == [
        [peak["frequency"], peak["amplitude"], peak["transmissibility"]] for peak in peaks
    ]
    for _, name, frequency, amplitude, *_ in rows:
        assert f" {name} {frequency:.5g} {amplitude:.4g} " in out
        assert f">{frequency:.5g}</td>" in page
    assert 'data-id="amplitude"' in page
    assert page.count("<svg") == 4
    assert {row[2] for row in content["tables"]["orbits"]["rows"]} == {"stable"}


def test_pictures_show_amplitudes_transmissibilities_and_loops(written):
    for name in ("frequency_response", "transmissibility", "loops"):
        assert (written[2] / f"{name}.png").read_bytes().startswith(b"\x89PNG")


def test_the_recording_lies_where_show_looks_for_it(written):
    from wirerope_mj.views.recording.viewer import find_recording

    assert find_recording(written[2]) == written[2] / "run.rrd"


def test_settings_say_every_input_and_the_model_loads_from_the_folder(written):
    folder = written[2]
    settings = tomllib.loads((folder / "settings.toml").read_text())
    assert settings["question"]["accelerations"] == [2.0, 5.0]
    assert settings["question"]["payload"] == "mass"
    assert settings["sweep"]["rate"] == 3.0
    assert settings["versions"]["mujoco"]
    assert wr.load_system(folder / settings["model"]["file"]).payloads == ["mass"]


def test_a_result_is_replaced_only_by_force(written, both, capsys):
    folder = written[2]
    assert main(["frf", MODEL, "--out", str(folder)]) == 2
    assert "there is a frequency response already" in capsys.readouterr().err


@pytest.mark.parametrize(
    ("arguments", "words"),
    [
        (("--start", "40", "--stop", "20"), "`stop` must be above `start`, got 40 to 20 Hz"),
        (("--start", "-1"), "`start` must be > 0, got -1.0"),
        (("--stop", "0"), "`stop` must be > 0, got 0.0"),
        (("--stop", "9e15"), "`start` and `stop` must lie between 0.39"),
        (("--start", "1e-9"), "Take a narrower range."),
        (("--payload", "deck"), "`payload` must be one of 'mass', got 'deck'"),
        (("--direction", "up"), "`--direction` must be x, y, z, -x, -y, -z or a vector such as 1,1,0, got 'up'"),
        (("--direction", "x"), "x"),
        (("--response-direction", "1,0"), "`--response-direction` must be x, y, z, -x, -y, -z or a vector"),
        (
            ("--largest-step", "1e-6"),
            "`smallest_step` must be below `largest_step`, and that below 1, got 1e-05 and 1e-06",
        ),
        (("--rate", "0"), "`rate` must be > 0"),
        (("--periods", "0"), "`periods` must be an integer >= 1, got 0"),
        (("--acceleration", "1", "1"), "`acceleration` must be one or several different levels"),
        (("--acceleration", "1", "--acceleration-g", "0.1"), "not both"),
        (("--acceleration", "0"), "`acceleration` must be > 0"),
    ],
)
def test_bad_input_is_one_message_and_nothing_is_left_behind(tmp_path, capsys, monkeypatch, arguments, words):
    monkeypatch.chdir(tmp_path)
    assert main(["frf", MODEL, *arguments]) == 2
    error = capsys.readouterr().err
    assert error.startswith("wirerope: ")
    assert error.count("\n") == 1
    assert words in error
    assert not list(tmp_path.iterdir())


def test_an_unknown_model_says_which_ship(tmp_path, capsys, monkeypatch):
    monkeypatch.chdir(tmp_path)
    assert main(["frf", "no_model"]) == 2
    message = capsys.readouterr().err
    assert "no_model: the model cannot be read: there is no such file" in message
    assert "ships with the package: cabinet" in message


@pytest.fixture
def short_of_travel(tmp_path, monkeypatch):
    """Make a model whose mount is rated for 0.7 mm of travel, and go to its folder."""
    (tmp_path / "isolators").mkdir()
    for name in ("sdof_shaker.xml", "isolators/sdof_36hz.toml"):
        shutil.copyfile(models_folder() / name, tmp_path / name)
    with (tmp_path / "isolators" / "sdof_36hz.toml").open("a") as file:
        file.write("\n[limits]\ntravel = { compression = 0.0007, tension = 0.0007 }\n")
    monkeypatch.chdir(tmp_path)
    return tmp_path


def test_a_branch_that_leaves_the_rated_travel_ends_there_and_exits_1(short_of_travel, capsys):
    arguments = ("--acceleration", "5", "--start", "30", "--stop", "36", "--largest-step", "0.03", "--out", "r")
    assert main(["frf", "sdof_shaker.xml", *arguments]) == 1
    out = re.sub(r"[ \n]+", " ", capsys.readouterr().out)
    (reached,) = re.findall(r"RATED TRAVEL at 5 m/s² from 3[\d.]+ Hz on: mount 'm1' reaches ([\d.]+) mm in compression", out)
    assert (
        0.7 < float(reached) < 0.7 * 1.01
    )  # a step of 0.1 % of the frequency where the travel grows by less than ten times it
    assert "rated for 0.7 mm; motions beyond are not followed" in out
    assert "highest within rated travel" in out
    assert "ENDED EARLY" not in out
    summary = json.loads((short_of_travel / "r" / "frequency_response.json").read_text())
    assert not summary["levels"][0]["continuation"]["complete"]


def test_a_level_that_leaves_the_rated_travel_at_the_start_is_one_message(short_of_travel, capsys):
    before = sorted(short_of_travel.iterdir())
    assert main(["frf", "sdof_shaker.xml", "--acceleration", "5", "--start", "36", "--stop", "37"]) == 2
    error = capsys.readouterr().err
    assert error.startswith("wirerope: level 5 m/s^2: at 36 Hz and 5 m/s^2 mount 'm1' reaches")
    assert error.count("\n") == 1
    assert sorted(short_of_travel.iterdir()) == before


def test_no_periodic_motion_at_the_start_is_one_message(tmp_path, capsys, monkeypatch):
    def lost(*_, **__):
        raise wr_errors.ConvergenceError("no motion of period 1 / (20 Hz) was found: the residual stays at 0.3")

    monkeypatch.setattr("wirerope_mj.dynamics.frequency_response.result.follow_branch", lost)
    monkeypatch.chdir(tmp_path)
    assert main(["frf", MODEL, "--start", "20", "--stop", "30"]) == 2
    assert "wirerope: level 1 m/s^2: no motion of period" in capsys.readouterr().err
    assert not list(tmp_path.iterdir())


def test_a_command_goes_on_from_the_points_that_were_kept(tmp_path, capsys, monkeypatch):
    monkeypatch.chdir(tmp_path)
    arguments = ("--start", "36", "--stop", "38", "--largest-step", "0.04", "--keep", "points", "--force", "--out", "r")
    assert main(["frf", MODEL, *arguments]) == 0
    first = pq.read_table("r/branches.parquet").to_pydict()
    assert main(["frf", MODEL, *arguments]) == 0
    again = pq.read_table("r/branches.parquet").to_pydict()
    assert again == first
    capsys.readouterr()
    assert main(["frf", MODEL, *arguments, "--smallest-step", "2e-5"]) == 2
    assert "holds another branch" in capsys.readouterr().err


def test_sweeps_alone_have_envelopes_and_no_recording(tmp_path, capsys, monkeypatch):
    monkeypatch.chdir(tmp_path)
    arguments = ("--method", "sweep", "--rate", "20", "--start", "30", "--stop", "36", "--out", "r")
    assert main(["frf", MODEL, *arguments]) == 0
    out = re.sub(r"[ \n]+", " ", capsys.readouterr().out)
    assert "peak of the sweep up" in out
    assert "continuation" not in out
    names = {path.name for path in (tmp_path / "r").iterdir() if path.is_file()}
    pictures = {"frequency_response.png", "transmissibility.png", "report.html"}
    assert names == {"sweeps.parquet", "settings.toml", "frequency_response.json", *pictures}


@pytest.mark.slow
def test_a_hardening_mount_folds_and_sweeps_jump_there(tmp_path, monkeypatch):
    (tmp_path / "isolators").mkdir()
    shutil.copyfile(models_folder() / "sdof_shaker.xml", tmp_path / "hard.xml")
    law = wr.SymmetricBoucWen(alpha=4e4, beta=2000.0, gamma=0.0, n=1, k1=114100.0, k2=0.0, k3=2e10)
    provenance = wr.Provenance(kind="illustrative", source="made up for this test")
    wr.Isolator(name="hard", axial=law, provenance=provenance).save(tmp_path / "isolators" / "sdof_36hz.toml")
    monkeypatch.chdir(tmp_path)
    arguments = ("--acceleration", "6", "--start", "32", "--stop", "44", "--method", "both", "--rate", "4")
    assert main(["frf", "hard.xml", *arguments, "--out", "r"]) == 0
    (level,) = json.loads((tmp_path / "r" / "frequency_response.json").read_text())["levels"]
    upper, lower = level["continuation"]["bifurcations"]
    assert [upper["kind"], lower["kind"]] == ["fold", "fold"]
    assert upper["frequency"] > lower["frequency"]
    assert [(e["unstable_before"], e["unstable_after"]) for e in (upper, lower)] == [(0, 1), (1, 0)]
    points = pq.read_table("r/branches.parquet").to_pydict()
    unstable = np.flatnonzero(~np.array(points["stable"]))
    folds = [i for i, words in enumerate(points["bifurcation"]) if words.startswith("fold")]
    # A fold itself stands at the edge of stability: either way is right there.
    assert set(range(folds[0] + 1, folds[1])) <= set(unstable) <= set(range(folds[0], folds[1] + 1))
    rising, falling = level["continuation"]["jumps"]
    assert (rising["rising"], falling["rising"]) == (True, False)
    assert rising["landing"] < rising["amplitude"] < 1.01 * level["continuation"]["peaks"][0]["amplitude"]
    assert falling["landing"] > falling["amplitude"]
    for way, fold in (("sweep_up", upper), ("sweep_down", lower)):
        ((at, jumped),) = level[way]["jumps"]
        assert at == pytest.approx(fold["frequency"], rel=1e-9)
        past = (jumped / at - 1.0) * (1.0 if way == "sweep_up" else -1.0)
        assert 0.0 < past < 0.03  # at 4 octaves/min; the steepest change comes some cycles after the branch has ended


@pytest.mark.parametrize("found", [True, False])
def test_another_start_is_named_only_where_it_was_tried(monkeypatch, found):
    """Where a level has no periodic motion at its start, what the message advises has been computed."""
    tried = []

    def none(*_, **__):
        raise ConvergenceError("no motion was found.")

    def orbit(*arguments, frequency, **options):
        tried.append(frequency)
        return periodic_orbit(*arguments, frequency=frequency, **options) if found else none()

    monkeypatch.setattr(response_module, "follow_branch", none)
    monkeypatch.setattr(response_module, "periodic_orbit", orbit)
    options = ResponseOptions(accelerations=(1.0,), start=10.0, stop=20.0)
    with pytest.raises(ConvergenceError) as error:
        frequency_response(wr.load_system("sdof_shaker"), options)
    if found:
        assert tried == [10.2]
        assert str(error.value).endswith("At 10.2 Hz there is a periodic motion, found here: --start 10.2 begins with it.")
    else:
        assert tried == [10.2, 11.0, 13.0]
        assert str(error.value).endswith("None was found at 10.2 and 11 and 13 Hz either.")
