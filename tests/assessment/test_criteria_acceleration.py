"""Accelerations against limits: which are judged, by what, and what a filter leaves."""

from dataclasses import replace

import numpy as np
import pytest
from house import deck, mjcf
from made_up_floor import floor_response

import wirerope_mj as wr
from wirerope_mj.assessment.criteria import Criterion, Verdict, acceleration_verdicts, judge, verdict_lines
from wirerope_mj.foundation.payload_limits import PayloadLimit

G = wr.STANDARD_GRAVITY


def by_name(verdicts):
    return {(v.subject, v.criterion): v for v in verdicts}


def limit(name, *values):
    return PayloadLimit(kind="acceleration", name=name, values=values)


@pytest.fixture(scope="module")
def floor():
    return floor_response()


@pytest.mark.quick
def test_without_a_limit_nothing_is_judged(floor):
    found = acceleration_verdicts(floor)
    assert [v.subject for v in found] == ["floor", "rack_0", "rack_1", "rack_top"]  # the base is what shakes
    for verdict in found:
        assert verdict.verdict == "not judged"
        assert verdict.value > 0.0
        assert "no limit" in verdict.note


def test_a_criterion_of_the_payload_that_nobody_knows_has_its_sentence(floor):
    fast = Verdict(criterion=Criterion("velocity"), subject="rack_0", value=3.0, limit=2.0, unit="m/s", time=0.1)
    assert "Exceeded: rack_0 velocity 3.00 m/s, limit 2 m/s (150 %) at 100.0 ms." in verdict_lines(floor, [*judge(floor), fast])


def test_one_value_judges_the_size_of_the_vector(floor):
    peak = floor.peaks.bodies["rack_0"].acceleration
    for allowed, word in ((1.001 * peak.value, "within"), (0.999 * peak.value, "exceeded")):
        verdict = by_name(acceleration_verdicts(floor, [limit("rack_0", allowed)]))["rack_0", "acceleration"]
        assert verdict.verdict == word
        assert verdict.value == peak.value
        assert verdict.time == peak.time
        assert verdict.margin == pytest.approx(allowed / peak.value - 1.0)


@pytest.mark.quick
def test_three_values_judge_the_components_and_zero_judges_nothing(floor):
    peak = floor.peaks.points["rack_top"].acceleration
    largest = np.maximum(-peak.minimum, peak.maximum)
    found = by_name(acceleration_verdicts(floor, [limit("rack_top", 0.9 * largest[0], 0.0, 1.1 * largest[2])]))
    along = [found["rack_top", f"acceleration along {axis}"] for axis in "xyz"]
    assert [v.verdict for v in along] == ["exceeded", "not judged", "within"]
    np.testing.assert_array_equal([v.value for v in along], largest)
    for axis, verdict in enumerate(along):
        when = peak.minimum_time if -peak.minimum[axis] > peak.maximum[axis] else peak.maximum_time
        assert verdict.time == when[axis]


@pytest.mark.quick
def test_the_limits_of_the_model_are_taken_by_themselves(floor):
    scene = replace(
        floor.scene, limits=(limit("floor", 1.0), PayloadLimit(kind="clearance", name="rack_top", values=(1, 1, 1)))
    )
    found = by_name(judge(replace(floor, scene=scene)))
    assert found["floor", "acceleration"].verdict == "exceeded"
    assert found["rack_top", "rattle space along +z"].verdict == "within"


def test_a_limit_of_nothing_is_an_error(floor):
    with pytest.raises(ValueError, match="'deck', which has no acceleration here. There are: floor, rack_0, rack_1, rack_top"):
        acceleration_verdicts(floor, [limit("deck", 10.0)])


@pytest.mark.quick
def test_limits_written_in_the_model_judge_its_run(tmp_path):
    """A free box (no gravity, no mount moves it) that a shock leaves alone is within; what it rides on is not asked."""
    sites = '<site name="p" pos="0 0 -.1"/><site name="point/lid" pos="0 0 .1"/>'
    joint = '<joint type="slide" axis="0 0 1"/>'
    world = deck({"b": 'pos="0 0 .2"'}, slides="z") + (
        f'<body name="box" pos="0 0 .3">{joint}<geom size=".1" mass="9"/>{sites}</body>'
    )
    custom = '<numeric name="limit/acceleration/box" data="0 0 30"/>'
    custom += '<numeric name="limit/clearance/lid" data="0 0 0 0 .03 .05"/>'
    spring = wr.Isolator(name="S", axial=wr.KelvinVoigt(k=9000.0, c=30.0))
    system = wr.load_system(mjcf(world, [("m1", "p", "b", "s")], custom=custom), isolators={"s": spring})
    shock = wr.HalfSine(peak=20.0 * G, duration=0.011, direction="z", start=0.01)
    response = wr.simulate(system, shock, duration=0.5, timestep=5e-4)
    response.save(tmp_path)
    for run in (response, wr.load_response(tmp_path)):
        found = by_name(judge(run))
        # V w = 1.374 m/s times 31.6 rad/s, and the same over w: an impulse on a spring, damped by 5 %
        assert found["box", "acceleration along z"].value == pytest.approx(1.374 * 31.6 * 0.93, rel=0.03)
        assert found["box", "acceleration along z"].verdict == "exceeded"
        assert found["lid", "rattle space along -z"].value == pytest.approx(1.374 / 31.6 * 0.93, rel=0.03)
        assert found["lid", "rattle space along -z"].verdict == "exceeded"  # the base moves up, the box stays behind
        assert found["lid", "rattle space along +z"].verdict == "within"
        assert found["lid", "rattle space along +x"].verdict == "not judged"
