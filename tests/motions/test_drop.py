"""The drop of a case: height to velocity, what lands, weightless fall, gravity of the side on which it comes to rest."""

import math
import re
import tomllib

import numpy as np
import pytest
from house import deck, mjcf, sdof

import wirerope_mj as wr
from wirerope_mj.assessment.criteria.loads import area_forces
from wirerope_mj.cli import main
from wirerope_mj.engine.simulation.simulate import duration_of
from wirerope_mj.engine.statics import model_warnings
from wirerope_mj.foundation.payload_limits import PayloadLimit
from wirerope_mj.motions.registry import motion_from_phrase
from wirerope_mj.runs.job_file import load_job
from wirerope_mj.runs.scenario import Scenario
from wirerope_mj.runs.scenario_file import judged_folder
from wirerope_mj.runs.study import limits_of
from wirerope_mj.studies.vary.vary_option import available_lines

G = wr.STANDARD_GRAVITY
EIGHTH = G / 2 * 0.125**2  # height [m] of which the fall takes 0.125 s, a multiple of all steps below; it strikes no stop


@pytest.mark.quick
@pytest.mark.parametrize(("text", "direction", "lands"), [
    ("300 mm z", (0, 0, 1), "bottom"),
    ("300 mm onto bottom", (0, 0, 1), "bottom"),
    ("onto top 300 mm", (0, 0, -1), "top"),
    ("300 mm onto -x side", (1, 0, 0), "-x"),
    ("300 mm onto +y face", (0, -1, 0), "+y"),
    ("300 mm onto bottom and -x", (1, 0, 1), "bottom -x"),
    ("300 mm onto bottom, +x, -y corner", (-1, 1, 1), "bottom +x -y"),
    ("300 mm onto the Bottom", (0, 0, 1), "bottom"),
    ("300 mm onto bottom,-X edge", (1, 0, 1), "bottom -x"),
    ("300 mm 1,0,3", (1, 0, 3), "bottom -x, up along (1, 0, 3)"),
])  # fmt: skip
def test_the_face_that_lands_says_the_direction(text, direction, lands):
    drop = motion_from_phrase("drop", text)
    np.testing.assert_allclose(drop.up, np.array(direction) / np.linalg.norm(direction), atol=1e-15)
    assert drop.description == f"drop 0.3 m onto {lands}, 2.426 m/s"
    ((instant, jump),) = drop.velocity_jumps
    assert instant == pytest.approx(math.sqrt(0.6 / G))
    np.testing.assert_allclose(jump, math.sqrt(0.6 * G) * drop.up, rtol=1e-14)


@pytest.mark.quick
@pytest.mark.parametrize(("text", "fault"), [
    ("300 mm -z", "may be that of the fall or that of the blow"),
    ("300 mm x", "may be that of the fall or that of the blow"),
    ("300 mm onto edge", '"onto edge" says no face'),
    ("300 mm onto -x edge", '"onto -x edge" says no face'),
    ("300 mm onto bottom top", '"onto bottom top" says no face'),
    ("300 mm onto floor", '"onto floor" says no face'),
    ("300 mm onto bottom bottom", "says no face"),
    ("300 mm onto bottom -x -y -z", "says no face"),
    ("300 mm onto bottom at 50 ms", '"at"'),
    ("onto bottom", "a displacement must stand there"),
    ("300 mm", "a direction must stand there"),
])  # fmt: skip
def test_a_drop_that_may_be_another_is_refused(text, fault):
    with pytest.raises(ValueError, match=fault):
        motion_from_phrase("drop", text)


@pytest.mark.quick
def test_a_table_is_said_with_and_without_programmer():
    assert motion_from_phrase("drop-table", "500 mm rebound 0.2 11 ms z") == wr.ShockTableImpact(
        drop_height=0.5, rebound=0.2, pulse_duration=0.011
    )
    assert motion_from_phrase("drop-table", "500 mm z").velocity_jumps[0][1][2] == pytest.approx(math.sqrt(G))


@pytest.mark.filterwarnings("ignore::wirerope_mj.foundation.errors.AccuracyWarning")  # the same steps, whatever their error
def test_a_drop_from_rest_is_the_step_of_its_velocity():
    system, drop = wr.load_system("cabinet"), wr.Drop(drop_height=EIGHTH)
    step = wr.VelocityStep(velocity=drop.impact_velocity, direction="z")
    exact = {"timestep": 2.0**-14, "sample_rate": 1024.0, "engine": "kernel"}
    fallen = wr.simulate(system, drop, duration=0.125 + 0.125, **exact)
    struck = wr.simulate(system, step, duration=0.125, initial="unloaded", **exact)
    for name, peaks in struck.peaks.mounts.items():
        assert fallen.peaks.mounts[name].deflection.value == pytest.approx(peaks.deflection.value, rel=1e-9)
        assert fallen.peaks.mounts[name].force.value == pytest.approx(peaks.force.value, rel=1e-9)
    deflection = fallen.mounts["m01"].deflection
    np.testing.assert_allclose(deflection[128:], struck.mounts["m01"].deflection, atol=1e-9 * np.abs(deflection).max())
    assert np.abs(deflection[:128]).max() < 1e-11  # nothing swings in the air: roundings of 2048 steps


@pytest.mark.quick
def test_a_linear_mount_bears_the_closed_form():
    """A mass that meets the floor at V on an unloaded spring peaks at sqrt(g^2 + w^2 V^2), and its force m g above that."""
    drop, omega = wr.Drop(drop_height=0.3), math.sqrt(4e4 / 3.5)
    response = wr.simulate(sdof(wr.KelvinVoigt(k=4e4, c=0.0), gravity=G), drop, duration=0.5, accuracy=1e-8)
    peak = math.hypot(G, omega * drop.impact_velocity)
    assert response.peaks.bodies["mass"].acceleration.value == pytest.approx(peak, rel=1e-6)
    assert response.peaks.mounts["m1"].force.value == pytest.approx(3.5 * (peak + G), rel=1e-6)


@pytest.mark.quick
def test_gravity_is_that_of_the_side_that_lands_and_the_level_that_of_the_height():
    system, drop = sdof(wr.KelvinVoigt(k=4e4, c=10.0), gravity=G), wr.Drop(drop_height=0.3, direction=(0, 0, -1))
    with pytest.raises(wr.ModelError, match="with_gravity"):
        wr.simulate(system, drop, duration=0.5)
    with pytest.raises(wr.ModelError, match="with_gravity"):
        wr.simulate(sdof(wr.KelvinVoigt(k=4e4, c=10.0)), wr.Drop(drop_height=0.3), duration=0.5)
    turned = wr.with_gravity(system, up=drop.up)
    upwards = wr.simulate(turned, drop, duration=0.5)
    downwards = wr.simulate(system, wr.Drop(drop_height=0.3), duration=0.5)
    mirrored = upwards.mounts["m1"].deflection + downwards.mounts["m1"].deflection
    assert np.abs(mirrored).max() < 1e-12
    with pytest.raises(ValueError, match="no level but its height"):
        wr.Scaled(drop, 2.0)
    with pytest.raises(ValueError, match="falls once"):
        _ = drop + wr.Drop(drop_height=0.2)
    with pytest.raises(ValueError, match="before the base lands, at 0.2474 s"):
        duration_of(drop, 0.2, turned)
    with pytest.raises(wr.ModelError, match="stands on no deck"):
        wr.simulate(wr.on_deck(wr.load_system("cabinet"), "10 Hz 800 kg 4 %"), wr.Drop(drop_height=0.3), duration=0.5)
    with pytest.raises(wr.ModelError, match="laid out for the gravity"):
        wr.with_gravity(wr.on_deck(wr.load_system("cabinet"), "10 Hz 800 kg 4 %"), up="x")
    with pytest.raises(wr.ModelError, match="it is turned where it is 9.80665"):
        wr.with_gravity(sdof(wr.KelvinVoigt(k=4e4, c=10.0), gravity=1.62), up="x")
    for up in ((0, 0, 0), (math.nan, 0, 1)):
        with pytest.raises(ValueError, match="finite and not zero"):
            wr.with_gravity(system, up=up)
    assert wr.Turned(drop, direction="x").up.tolist() == [1.0, 0.0, 0.0]
    assert (drop + wr.HalfSine(peak=1.0, duration=0.01, direction="z")).initial == "unloaded"


@pytest.mark.slow
def test_a_case_of_a_job_falls_on_its_side_begins_unloaded_and_replays(tmp_path, capsys):
    (tmp_path / "job.toml").write_text(
        'model = "shock_table_frame"\nquestion = "Does it stand its drops?"\n[[case]]\nname = "side"\ndrop = "200 mm onto -x"\n'
        '[[case]]\nname = "held"\ndrop = "200 mm z"\ninitial = "settled"\n',
        encoding="utf-8",
    )
    assert [case.scenario.motion.up.tolist() for case in load_job(tmp_path / "job.toml").cases] == [[1, 0, 0], [0, 0, 1]]
    main(["cases", str(tmp_path / "job.toml"), "--out", str(tmp_path / "job")])
    side, held = (
        tomllib.loads((tmp_path / f"job/cases/{name}/scenario.toml").read_text(encoding="utf-8")) for name in ("side", "held")
    )
    assert (side["simulate"]["initial"], held["simulate"]["initial"]) == ("unloaded", "settled")
    system = wr.load_system(tmp_path / "job/cases/side/model/shock_table_frame.xml")
    assert system.model.opt.gravity.tolist() == [-G, 0.0, 0.0]
    assert "amplification" not in capsys.readouterr().out  # no shock is sharper than a stop at once
    assert main(["replay", str(tmp_path / "job/cases/side")]) == 0


@pytest.mark.slow
def test_a_drop_onto_the_top_is_meant_and_its_loads_are_along_its_gravity(tmp_path, capsys):
    """What is said of a fall: no warning of the gravity that it asks for, no level in studies, its own down, no peak of 1 g."""
    words = ["shock_table_frame", "--drop", "200 mm onto top", "--out", str(tmp_path / "run"), "--accuracy", "1e-3"]
    assert main(["shock", *words, "--all"]) == 0
    out = capsys.readouterr().out
    assert "gravity points upwards" not in out
    assert re.search(r"→ [\d.]+ g at \w+\n", out)  # no fraction of the base's 1 g, which is its fall
    assert "(base, in its fall)" in out
    run = judged_folder(tmp_path / "run")
    (whole, *_) = area_forces(run.response, run.motion.up)
    (other, *_) = area_forces(run.response)
    assert (whole.down, whole.up) == (other.up, other.down)
    assert whole.across == pytest.approx(other.across)
    assert any("gravity points upwards" in text for text in model_warnings(run.system))  # where nothing falls
    assert any("a fall has no level but its height" in line for line in available_lines(run.system, run.motion))
    assert not any("motion/level" in line for line in available_lines(run.system, run.motion))


@pytest.mark.quick
def test_a_force_that_model_and_scenario_limit_is_listed_once():
    text = mjcf(
        deck({"b": 'pos="0 0 .2"'}, slides="z") + '<body name="mass" pos="0 0 .3"><joint type="slide" axis="0 0 1"/>'
        '<geom size=".1" mass="3.5"/><site name="p" pos="0 0 -.1"/></body>',
        [("m1", "p", "b", "a")],
        custom='<numeric name="limit/load/m1" data="4000"/>',
    )
    isolators = {"a": wr.Isolator(name="a", axial=wr.KelvinVoigt(k=4e3, c=20.0))}
    made = Scenario(
        name="s", question="?", model=text, motion=wr.HalfSine(peak=1.0, duration=0.01, direction="z"), isolators=isolators,
        simulate={"duration": 0.1}, limits=[PayloadLimit(kind="load", name="m1", values=(5000.0,))],
    )  # fmt: skip
    assert limits_of(made)[1] == ["load/m1 = 5000 N"]
