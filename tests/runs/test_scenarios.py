from pathlib import Path

import numpy as np
import pytest

import wirerope_mj as wr
from wirerope_mj.engine.simulation import simulate
from wirerope_mj.engine.system import load_system
from wirerope_mj.foundation.errors import ModelError
from wirerope_mj.motions import HalfSine
from wirerope_mj.runs.scenario import Scenario, load_function, load_scenario, shipped_scenarios

pytestmark = pytest.mark.quick

SHORT = 0.12  # [s]: the shocks strike at 0.05 s and have passed by then


def motion() -> HalfSine:
    return HalfSine(peak=10.0, duration=0.01, direction="z")


def write(folder: Path, text: str) -> Path:
    path = folder / "mine.py"
    path.write_text(text, encoding="utf-8")
    return path


def test_the_package_ships_the_scenarios_of_its_models():
    assert set(shipped_scenarios()) >= {
        "floating_floor_shock", "floating_floor_sweep", "sdof_sweep", "shock_table", "cabinet_shock",
    }  # fmt: skip


@pytest.mark.parametrize("name", sorted(shipped_scenarios()))
def test_every_shipped_scenario_runs_short_and_moves_its_payload(name):
    scenario = load_scenario(name).make(duration=SHORT)
    response = simulate(load_system(scenario.model_source()), scenario.motion, **scenario.simulate)
    values = response.samples.columns(0, len(response.samples.names))
    assert np.isfinite(values).all()
    moved = [peaks.acceleration.value for body, peaks in response.peaks.bodies.items() if body != response.scene.base]
    assert min(moved) > 0.05  # [m/s^2]; the weakest is the start of a sweep at 0.2 g = 2 m/s^2


@pytest.mark.parametrize("name", sorted(shipped_scenarios()))
def test_every_scenario_is_short_and_asks_its_question_first(name):
    scenario = load_scenario(name)
    assert scenario.question.endswith("?")
    assert len(scenario.path.read_text(encoding="utf-8").splitlines()) <= 60
    assert {"duration", "level_g", "callback"} <= set(scenario.defaults)
    assert scenario.make(callback="python").simulate["callback"] == "python"


def test_the_main_job_strikes_along_three_axes_with_9_g():
    scenario = load_scenario("floating_floor_shock").make()
    peak = scenario.motion.acceleration([0.0555])[0]  # middle of the pulse of 11 ms that starts at 0.05 s
    np.testing.assert_allclose(peak, np.full(3, 9 * 9.80665), rtol=1e-12)  # sin(pi/2) but for rounding
    assert scenario.simulate["duration"] == 2.0


def test_options_reach_the_motion_and_are_remembered():
    scenario = load_scenario("cabinet_shock").make(level_g=7.0, direction="x")
    assert scenario.options["level_g"] == 7.0
    assert scenario.options["pulse_ms"] == 11.0
    assert "7 g" in scenario.motion.description
    np.testing.assert_array_equal(scenario.motion.directions, [[1.0, 0.0, 0.0]])


def test_shock_table_takes_a_sudden_velocity_instead_of_the_pulse():
    scenario = load_scenario("shock_table").make(velocity=2.0)
    assert isinstance(scenario.motion, wr.VelocityStep)


@pytest.mark.parametrize(
    ("shape", "motion"),
    [("half-sine", wr.DoubleHalfSine), ("triangle", wr.DoubleTriangle)],
    ids=["half-sine", "triangle"],
)
def test_the_design_spectrum_becomes_the_double_pulse_asked_for(shape, motion):
    pulse = load_scenario("floating_floor_double_pulse").make(shape=shape, level_g=50.0, velocity=2.0).motion
    assert isinstance(pulse, motion)
    assert pulse.peak == pytest.approx(0.6 * 50 * 9.80665)
    assert pulse.peak_velocity == pytest.approx(0.75 * 2.0)
    assert pulse.final_displacement == pytest.approx(1.05 * 0.035)


def test_a_design_spectrum_that_no_pulse_can_meet_is_one_message():
    with pytest.raises(ModelError, match="`velocity` must be below .* where the other two branches meet"):
        load_scenario("floating_floor_double_pulse").make(displacement_mm=4.0)


def test_the_random_vibration_of_the_rack_has_the_rms_asked_for():
    motion = load_scenario("cabinet_random").make(level_g=0.7, seed=5).motion
    assert motion.rms == pytest.approx(0.7 * 9.80665, rel=1e-12)
    assert (motion.seed, motion.duration) == (5, 30.0)
    assert [frequency for frequency, _ in motion.psd] == [5.0, 50.0, 200.0]
    assert motion.psd[1][1] / motion.psd[2][1] == pytest.approx(16.0)  # two octaves at 6 dB, each a factor 4


def test_a_whole_sweep_is_simulated_unless_a_duration_is_given():
    scenario = load_scenario("sdof_sweep").make()
    assert scenario.simulate["duration"] == pytest.approx(120.0, rel=1e-12)  # four octaves at two per minute, rounding


def test_unknown_scenario_names_what_exists():
    with pytest.raises(ModelError, match="no scenario 'nosuch'.*floating_floor_shock.*shock_table"):
        load_scenario("nosuch")


def test_unknown_option_names_what_exists():
    with pytest.raises(ModelError, match="no option 'level'.*level_g"):
        load_scenario("shock_table").make(level=3.0)


def test_an_error_in_a_scenario_file_names_file_and_line(tmp_path):
    path = write(tmp_path, "def scenario(*, a: float = 1.0):\n    return a / 0.0\n")
    with pytest.raises(ModelError, match=r"mine\.py, line 2: `return a / 0\.0` ends with ZeroDivisionError"):
        load_scenario(path).make()


def test_a_scenario_file_that_cannot_be_read_as_python_says_where(tmp_path):
    with pytest.raises(ModelError, match=r"mine\.py, line 2: `def scenario\(:` is not Python"):
        load_scenario(write(tmp_path, "a = 1\ndef scenario(:\n"))


@pytest.mark.parametrize(
    ("text", "message"),
    [
        ("a = 1\n", "no function `scenario`"),
        ("def scenario(a): ...\n", "`a` of `scenario` must be a keyword-only argument with a default"),
        ("def scenario(*, a): ...\n", "`a` of `scenario` must be a keyword-only argument with a default"),
    ],
)
def test_a_file_without_a_proper_scenario_is_refused(tmp_path, text, message):
    with pytest.raises(ModelError, match=message):
        load_scenario(write(tmp_path, text))


def test_a_function_must_return_a_scenario(tmp_path):
    with pytest.raises(ModelError, match="must return a wirerope_mj.Scenario, got 3"):
        load_scenario(write(tmp_path, "def scenario():\n    return 3\n")).make()


def test_a_relative_model_is_looked_up_beside_the_scenario_before_the_package(tmp_path):
    (tmp_path / "shock_table.xml").write_text("<mujoco/>", encoding="utf-8")
    beside = Scenario("?", "shock_table", motion(), {"duration": 1.0}, folder=tmp_path)
    assert beside.model_source() == tmp_path / "shock_table.xml"
    shipped = Scenario("?", "cabinet.xml", motion(), {"duration": 1.0}, folder=tmp_path)
    assert shipped.model_source().name == "cabinet.xml"


def test_unknown_model_names_what_exists():
    with pytest.raises(ModelError, match="no model 'nosuch'.*floating_floor"):
        Scenario("?", "nosuch", motion(), {"duration": 1.0}).model_source()


@pytest.mark.parametrize("options", [{"level_g": "20"}, {"level_g": [20.0]}, {"level_g": True}, {"direction": 3}])
def test_an_option_of_another_kind_than_its_default_is_named(options):
    name = next(iter(options))
    with pytest.raises(wr.ModelError, match=rf"cabinet_shock\.py: option `{name}` must be .*, got "):
        load_scenario("cabinet_shock").make(**options)


@pytest.mark.parametrize(
    ("content", "said"),
    [
        (None, "there is no such file"),
        (b"\x89PNG\0\0", "this is not text; a scenario is a Python file"),
        (b'a = "\xe4"\n', "line 1: .* is not text in UTF-8. Save it in UTF-8"),
    ],
)
def test_a_file_that_is_no_python_text_is_named(tmp_path, content, said):
    path = tmp_path / "mine.py"
    if content is not None:
        path.write_bytes(content)
    with pytest.raises(ModelError, match=rf"mine\.py.*{said}"):
        load_function(path, "scenario")
