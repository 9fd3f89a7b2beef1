"""Isolators at a temperature: factors of the data sheet on stiffness and damping, from the file to the run."""

from dataclasses import replace

import numpy as np
import pytest
from house import sdof_text

import wirerope_mj as wr
from wirerope_mj.cli import main
from wirerope_mj.engine.system.model_files import write_model
from wirerope_mj.foundation.errors import ModelError
from wirerope_mj.foundation.resources import catalogue_folder
from wirerope_mj.mounts.isolator import isolators_at
from wirerope_mj.mounts.vendor_parts.sheet_fit import fit_datasheet

STATED = {"celsius": (-40.0, 20.0, 70.0), "stiffness": (1.6, 1.0, 0.9), "damping": (1.3, 1.0, 0.8)}
ROPE = wr.BoucWen(alpha=2e4, beta=30.0, gamma=10.0, n=1.0, k=5e3)


def device(law=ROPE, **changes):
    return wr.Isolator(name="a", axial=law, temperature=wr.Temperature(**STATED | changes))


@pytest.mark.quick
@pytest.mark.parametrize(("at", "expected"), [
    (None, (1.0, 1.0)), (20.0, (1.0, 1.0)), (-40.0, (1.6, 1.3)), (-10.0, (1.3, 1.15)), (45.0, (0.95, 0.9)),
])  # fmt: skip
def test_factors_are_straight_between_the_stated_temperatures(at, expected):
    assert wr.Temperature(**STATED, at=at).factors == pytest.approx(expected, rel=1e-14)
    assert wr.Temperature(**STATED | {"damping": ()}, at=at).factors == pytest.approx((expected[0], 1.0), rel=1e-14)


@pytest.mark.quick
def test_forces_and_their_loss_have_the_factors():
    path = 0.01 * np.sin(np.linspace(0.0, 12.0, 2000))
    acting = device(at=-40.0).conditioned.axial
    virgin, cold = ROPE.trace(path), acting.trace(path)
    expected = 1.6 * (5e3 * path + 1.3 * virgin.hysteretic_state)
    np.testing.assert_allclose(cold.force, expected, rtol=0.0, atol=1e-9 * np.abs(expected).max())
    damped = wr.KelvinVoigt(k=1000.0, c=20.0)
    assert device(damped, at=-40.0).conditioned.axial == wr.KelvinVoigt(k=1.6 * 1000.0, c=1.3 * (1.6 * 20.0))
    for at in (None, 20.0):
        assert device(at=at).conditioned.axial == ROPE
    both = replace(device(at=-40.0), stiffening=wr.Stiffening(after_50=0.2, cycles=50.0), bracket=wr.Bracket(axial=1e9))
    assert both.conditioned.temperature is None
    assert both.conditioned.stiffening is None


@pytest.mark.quick
@pytest.mark.parametrize(("changes", "fault"), [
    ({"celsius": (20.0,)}, "two or more rising"), ({"celsius": (20.0, -40.0, 70.0)}, "two or more rising"),
    ({"stiffness": (1.0, 2.0)}, "`stiffness` must have a factor for each of the 3"), ({"at": -41.0}, "-40 to 70 degC"),
    ({"damping": (1.0,)}, "`damping` must have a factor for each of the 3"), ({"stiffness": (0.0, 1.0, 1.0)}, "stiffness"),
])  # fmt: skip
def test_what_no_sheet_states_is_refused(changes, fault):
    with pytest.raises(ValueError, match=fault):
        wr.Temperature(**STATED | changes)


@pytest.mark.quick
def test_isolators_without_factors_are_named_with_the_remedy():
    plain, stop = wr.Isolator(name="CB1500", axial=ROPE), wr.Isolator(name="bump", axial=wr.Stop(gap_below=0.01, k=1e6))
    with pytest.raises(ValueError, match=r"no factors over temperature are stated for CB1500\. .*\[temperature\] with celsius"):
        isolators_at("-20 degC", {"a": device(), "b": plain, "s": stop})
    with pytest.raises(ValueError, match=r"a: \[temperature\] `at` must be within the -40 to 70 degC that are stated, got 90"):
        isolators_at("90 degC", {"a": device()})
    made = isolators_at("-10 °C", {"a": device(), "s": stop})
    assert made == {"a": device(at=-10.0), "s": stop}


def test_a_data_sheet_hands_its_factors_to_the_isolator_and_files_come_back(tmp_path):
    sheet = next((catalogue_folder() / "datasheets").glob("enidine_wr16_400.toml")).read_text(encoding="utf-8")
    file = tmp_path / "sheet.toml"
    file.write_text(f"{sheet}\n[temperature]\ncelsius = [-40, 20, 70]\nstiffness = [1.6, 1.0, 0.9]\n", encoding="utf-8")
    made = fit_datasheet(file)
    assert made.temperature == wr.Temperature(**STATED | {"damping": ()})
    made.save(tmp_path / "iso.toml")
    assert wr.load_isolator(tmp_path / "iso.toml") == made
    text = (tmp_path / "iso.toml").read_text(encoding="utf-8")
    (tmp_path / "iso.toml").write_text(text.replace("stiffness = [", "stiffnes = ["), encoding="utf-8")
    with pytest.raises(ModelError, match=r"iso\.toml, line \d+: \[temperature\] `stiffnes` is unknown"):
        wr.load_isolator(tmp_path / "iso.toml")


def test_the_command_runs_at_a_temperature_and_its_folder_keeps_it(tmp_path, capsys):
    write_model(wr.load_system(sdof_text(), isolators={"a": device()}), tmp_path)
    words = ["shock", str(tmp_path / "model.xml"), "--half-sine", "5 g 11 ms z", "--duration", "0.05", "--timestep", "1e-3"]
    assert main([*words, "--temperature", "-40 degC", "--out", str(tmp_path / "cold")]) == 0
    capsys.readouterr()
    cold = wr.load_response(tmp_path / "cold")
    system = wr.load_system(sdof_text(), isolators={"a": device(at=-40.0)})
    pulse = wr.HalfSine(peak=5.0 * wr.STANDARD_GRAVITY, duration=0.011, direction="z")
    again = wr.simulate(system, pulse, duration=0.05, timestep=1e-3)
    assert cold.peaks.mounts["m1"].force.value == again.peaks.mounts["m1"].force.value
    assert "at = -40.0" in (tmp_path / "cold" / "model" / "a.toml").read_text(encoding="utf-8")
    assert main(["replay", str(tmp_path / "cold")]) == 0
    for text, fault in (("-50 degC", "-40 to 70 degC"), ("20 K", "no unit of temperature")):
        assert main([*words, "--temperature", text, "--out", str(tmp_path / "other")]) == 2
        assert fault in capsys.readouterr().err


@pytest.mark.slow
def test_a_job_runs_at_a_temperature_and_keeps_what_has_not_changed(tmp_path, capsys):
    write_model(wr.load_system(sdof_text(), isolators={"a": device()}), tmp_path)
    case = '[[case]]\nname = "shock"\nhalf-sine = "5 g 11 ms z"\nduration = 0.05\ntimestep = 1e-3\n'
    job = tmp_path / "job.toml"
    peaks = []
    for text, computed in (("-40 degC", "computed 1"), ("-40 degC", "computed 0"), ("70 degC", "computed 1")):
        job.write_text(f'model = "model.xml"\ntemperature = "{text}"\n{case}', encoding="utf-8")
        assert wr.load_job(job).cases[0].scenario.isolators["a"].temperature.at == float(text.split()[0])
        assert main(["cases", str(job), "--out", str(tmp_path / "out")]) == 0
        assert computed in capsys.readouterr().out
        peaks.append(wr.load_response(tmp_path / "out" / "cases" / "shock").peaks.mounts["m1"].force.value)
    assert peaks[0] == peaks[1] != peaks[2]
    job.write_text(f'model = "model.xml"\ntemperature = "99 degC"\n{case}', encoding="utf-8")
    with pytest.raises(ModelError, match=r"job\.toml: `temperature`: a: .*-40 to 70 degC that are stated, got 99 degC"):
        wr.load_job(job)
