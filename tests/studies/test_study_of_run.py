"""Studies of runs: the scenario is that of the run's folder."""

import numpy as np
import pytest
from house import sdof_text

import wirerope_mj as wr
from wirerope_mj.cli import main
from wirerope_mj.foundation.payload_limits import limit_from_text

LEVELS = ["--vary", "motion/level = Uniform(0.5, 1.5)", "--variants", "8", "--workers", "1"]
LIMITS = ("acceleration/mass = 0.5 g", "clearance/mass = 30 30 20 mm")


@pytest.fixture(scope="module")
def run(tmp_path_factory):
    """Return the folder of a run with limits of its own."""
    scenario = wr.Scenario(
        question="Does it stand?",
        model=sdof_text(),
        isolators={"a": wr.Isolator(name="a", axial=wr.BoucWen(alpha=2e4, beta=30.0, gamma=10.0, n=1.0, k=5e3))},
        motion=wr.HalfSine(peak=60.0, duration=0.011, direction="z"),
        simulate={"duration": 0.1, "timestep": 5e-4, "sample_rate": 500.0},
        limits=[limit_from_text(text) for text in LIMITS],
    )
    folder = tmp_path_factory.mktemp("runs") / "shock"
    wr.run_scenario(scenario, folder)
    return folder


def test_a_variant_that_differs_in_nothing_has_the_peaks_of_the_run(run, tmp_path):
    study = wr.study_of(run, vary={"motion/level": wr.Choice(1.0, 1.1)}, sampling="grid")
    table = study.run(tmp_path / "study", workers=1).table
    peaks = wr.load_response(run).peaks
    assert study.name == "shock"
    assert table["acceleration/mass"][0].as_py() == peaks.bodies["mass"].acceleration.value
    assert table["force/m1"][0].as_py() == peaks.mounts["m1"].force.value


def test_a_step_chosen_for_an_accuracy_is_chosen_again(tmp_path):
    assert main(["run", "shock_table", "--duration", "0.05", "--accuracy", "1e-3", "--out", str(tmp_path / "run")]) == 0
    study = wr.study_of(tmp_path / "run", vary={"motion/level": wr.Uniform(0.5, 1.5)})
    assert (study.timestep, study.accuracy) == (None, 1e-3)


def test_the_command_makes_a_study_of_a_run_and_judges_its_limits(run, tmp_path, capsys):
    folder = tmp_path / "study"
    assert main(["study", str(run), *LEVELS, "--out", str(folder)]) == 0
    printed = capsys.readouterr()
    values = np.asarray(wr.load_study(folder).table["acceleration/mass"])
    beyond = int((values > 0.5 * wr.STANDARD_GRAVITY).sum())
    assert f"Beyond acceleration/mass = 0.5 g: {beyond} of 8 variants" in printed.out
    assert "a study does not judge clearance/mass = 0.03 0.03 0.02 m" in printed.err


def test_a_limit_that_is_given_stands_in_place_of_the_run_s(run, tmp_path, capsys):
    assert main(["study", str(run), *LEVELS, "--limit", "acceleration/mass=1 g", "--out", str(tmp_path / "study")]) == 0
    out = capsys.readouterr().out
    assert "Beyond acceleration/mass=1 g" in out
    assert "0.5 g" not in out


def test_without_vary_what_can_vary_is_listed(run, capsys):
    assert main(["study", str(run)]) == 2
    err = capsys.readouterr().err
    assert "nothing varies yet. In shock can vary:" in err
    assert "mount/NAME/turn/AXIS" in err


def test_other_folders_and_the_file_of_a_run_are_answered_with_the_way(run, tmp_path, capsys):
    assert main(["study", str(run / "scenario.toml")]) == 2
    assert f"name the folder of the run instead: wirerope study {run}" in capsys.readouterr().err
    assert main(["study", str(tmp_path)]) == 2
    assert "this folder is no run" in capsys.readouterr().err
    (tmp_path / "study.toml").touch()
    assert main(["study", str(tmp_path)]) == 2
    assert f"`wirerope study-report {tmp_path}` makes its report" in capsys.readouterr().err
