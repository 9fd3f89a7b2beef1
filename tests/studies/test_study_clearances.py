"""Clearances of points are judged in studies as in runs, and of what is not judged the command says so."""

import numpy as np
import pytest
from house import deck, mjcf

import wirerope_mj as wr
from wirerope_mj.assessment.criteria import acceleration_verdicts, judge, rattle_verdicts
from wirerope_mj.cli import main
from wirerope_mj.foundation.payload_limits import limit_from_text
from wirerope_mj.studies.measures import measures

G = wr.STANDARD_GRAVITY
SPRING = {"s": wr.Isolator(name="S", axial=wr.KelvinVoigt(k=9000.0, c=30.0))}
CLEARANCE = '<numeric name="limit/clearance/lid" data="0 0 0 0 .03 .05"/>'


def box_text(custom="", *, point="lid", geom='<geom size=".1" mass="9"/>', guide='<joint type="slide" axis="0 0 1"/>'):
    sites = f'<site name="p" pos="0 0 -.1"/><site name="point/{point}" pos="0 0 .1"/>'
    world = deck({"b": 'pos="0 0 .2"'}, slides="z") + f'<body name="box" pos="0 0 .3">{guide}{geom}{sites}</body>'
    return mjcf(world, [("m1", "p", "b", "s")], custom=custom)


def shock(g=12.0):
    return wr.HalfSine(peak=g * G, duration=0.011, direction="z", start=0.01)


def study(text, **more):
    vary = {"motion/level": wr.Choice(0.5, 1.0, 1.5)}
    return wr.Study(
        model=text, motion=shock(), isolators=SPRING, vary=vary, sampling="grid", duration=0.2, timestep=5e-4, **more
    )


def test_a_study_uses_as_much_of_a_clearance_as_the_run_of_each_variant(tmp_path):
    table = study(box_text(CLEARANCE)).run(tmp_path / "study", workers=1).table
    system = wr.load_system(box_text(CLEARANCE), isolators=SPRING)
    used = []
    for row, level in enumerate((0.5, 1.0, 1.5)):
        response = wr.simulate(system, shock(12.0 * level), duration=0.2, timestep=5e-4)
        rattle = {verdict.criterion[-2:]: verdict for verdict in rattle_verdicts(response) if verdict.subject == "lid"}
        used.append(max(rattle[side].utilisation for side in ("-z", "+z")))
        for side in ("-z", "+z"):
            assert table[f"displacement/lid/{side}"][row].as_py() == pytest.approx(rattle[side].value, rel=1e-9)
        alone = measures(system, response.peaks, None)
        assert alone["clearance"] == pytest.approx(used[-1], rel=1e-12)
        assert alone["displacement/lid/-z"] == pytest.approx(rattle["-z"].value, rel=1e-12)
    np.testing.assert_allclose(table["clearance"], used, rtol=1e-9)
    assert used[0] < 1.0 < used[2]  # and not "0 %"


def test_the_probability_is_that_of_the_clearance(tmp_path):
    result = study(box_text(CLEARANCE)).run(tmp_path / "study", workers=1)
    used = np.asarray(result.table["clearance"])
    found = result.exceedance("clearance")
    assert (found.count, found.n) == (int((used > 1.0).sum()), 3)
    assert 0 < found.count < 3


def test_the_clearances_of_a_run_are_judged_in_its_study(tmp_path, capsys):
    limits = ("clearance/lid = 30 30 20 mm", "clearance/box = 1 1 1 mm")
    scenario = wr.Scenario(
        question="Does it fit?", model=box_text(), isolators=SPRING, motion=shock(),
        simulate={"duration": 0.2, "timestep": 5e-4}, limits=[limit_from_text(text) for text in limits],
    )  # fmt: skip
    wr.run_scenario(scenario, tmp_path / "run")
    vary = ["--vary", "motion/level = Uniform(0.2, 1.5)", "--variants", "8", "--workers", "1"]
    assert main(["study", str(tmp_path / "run"), *vary, "--out", str(tmp_path / "study")]) == 0
    printed = capsys.readouterr()
    table = wr.load_study(tmp_path / "study").table
    beyond = int((np.asarray(table["displacement/lid/-z"]) > 0.02).sum())
    assert 0 < beyond < 8
    assert f"Beyond displacement/lid/-z = 0.02 m: {beyond} of 8 variants" in printed.out
    assert "a study does not judge clearance/box = 0.001 0.001 0.001 m: write it into the model" in printed.err


ROCKS = '<joint type="slide" axis="0 0 1"/><joint type="hinge" axis="0 1 0" stiffness="300"/>'
OFF_CENTRE = '<geom size=".1" mass="9" pos=".04 0 0"/><site name="point/rim" pos=".1 0 0"/>'


@pytest.mark.parametrize("limited", ["box", "lid to rim", "both"])
def test_corners_and_pairs_are_judged_in_a_study_as_in_the_run_of_each_variant(limited, tmp_path):
    """`both` names a body and a point of it: whichever goes farther counts."""
    custom = f'<numeric name="limit/clearance/{limited}" data=".02 .02 .03"/>'
    text = box_text(custom, guide=ROCKS, geom=OFF_CENTRE).replace('"box"', '"both"' if limited == "both" else '"box"')
    text = text.replace("point/lid", "point/both") if limited == "both" else text
    table = study(text).run(tmp_path / "study", workers=1).table
    system = wr.load_system(text, isolators=SPRING)
    for row, level in enumerate((0.5, 1.0, 1.5)):
        response = wr.simulate(system, shock(12.0 * level), duration=0.2, timestep=5e-4)
        used = [one.utilisation for one in rattle_verdicts(response) if one.utilisation is not None]
        assert len(used) == 6
        assert table["clearance"][row].as_py() == pytest.approx(max(used), rel=1e-9)
        places = [one.value for one in acceleration_verdicts(response) if one.subject == limited]
        if places:
            assert table[f"acceleration/{limited}"][row].as_py() == pytest.approx(max(places), rel=1e-9)


def test_what_samples_are_too_few_for_is_not_judged_and_what_is_exceeded_is():
    custom = '<numeric name="limit/clearance/box" data="0 0 {room}"/>'
    judged = {}
    for room in (0.05, 0.001):
        text = box_text(custom.format(room=room))
        coarse = study(text, sample_rate=20.0).response(1)
        judged[room] = measures(wr.load_system(text, isolators=SPRING), coarse.peaks, None, coarse)["clearance"]
    assert np.isnan(judged[0.05])
    assert judged[0.001] > 1.0


def test_one_limit_on_a_body_and_a_point_of_its_name_is_exceeded_once():
    """The point stands on a box that rocks, and bears more than its centre of mass: it is what counts, and once."""
    custom = '<numeric name="limit/acceleration/box" data="15"/><numeric name="limit/clearance/box" data=".01 .01 .01"/>'
    guide = '<joint type="slide" axis="0 0 1"/><joint type="hinge" axis="0 1 0" stiffness="300"/>'
    text = box_text(custom, point="box", guide=guide, geom='<geom size=".1" mass="9" pos=".04 0 0"/>')
    system = wr.load_system(text, isolators=SPRING)
    response = wr.simulate(system, shock(), duration=0.2, timestep=5e-4)
    places = response.peaks.bodies["box"].acceleration.value, response.peaks.points["box"].acceleration.value
    assert places[0] != places[1]
    (verdict,) = acceleration_verdicts(response)
    assert (verdict.subject, verdict.value, verdict.verdict) == ("box", max(places), "exceeded")
    named = [(row.criterion, row.subject) for row in judge(response)]
    assert len(set(named)) == len(named)
    assert measures(system, response.peaks, None)["fragility"] == pytest.approx(max(places) / 15.0, rel=1e-12)


def test_of_a_body_and_a_point_of_one_name_a_study_takes_what_bears_more(tmp_path):
    text = box_text(point="box", guide=ROCKS, geom='<geom size=".1" mass="9" pos=".04 0 0"/>')
    table = study(text).run(tmp_path / "study", workers=1).table  # side by side
    alone = study(text).run(tmp_path / "alone", workers=1, keep="responses")
    for row in range(3):
        peaks = alone.response(row).peaks
        places = peaks.bodies["box"].acceleration.value, peaks.points["box"].acceleration.value
        assert places[0] != places[1]
        for column in (table["acceleration/box"], alone.table["acceleration/box"]):
            assert column[row].as_py() == pytest.approx(max(places), rel=1e-9)
