"""Limits on the load of a mount, on force, closing speed and gap of its stops; every kind is read back from a run's file."""

from dataclasses import replace

import numpy as np
import pytest
from house import sdof
from scipy.integrate import solve_ivp

import wirerope_mj as wr
from wirerope_mj.assessment.criteria import judge
from wirerope_mj.assessment.criteria.ended import utilisation_over_time
from wirerope_mj.assessment.criteria.loads import area_forces, foundation_force
from wirerope_mj.cli import main
from wirerope_mj.foundation.payload_limits import KINDS, limit_from_text
from wirerope_mj.runs.scenario_file import judged_by
from wirerope_mj.runs.selection import equipment
from wirerope_mj.studies.measures import measures

TEXTS = {
    "acceleration": ("acceleration/rack = 15 g", "acceleration/rack_top = 0 0 15 g"),
    "clearance": ("clearance/rack_top = 30 30 20 mm", "clearance/rack_top to rack_base_front = 30 30 20 mm"),
    "load": ("load/m* = 50 kN", "load/s1 = 8000 lbf"),
    "force": ("force/c1 = 10 kN",),
    "closing": ("closing/c1 = 500 mm/s",),
    "gap": ("gap/c1 = 80 %", "stops = none"),
}


@pytest.mark.quick
@pytest.mark.parametrize("kind", KINDS)
def test_a_run_with_limits_of_a_kind_is_read_back(tmp_path, kind):
    system = wr.load_system("cabinet")
    stops = [name for name, mount in system.mounts.items() if mount.isolator.stops]
    limits = [limit_from_text(text.replace("c1", stops[0])) for text in TEXTS[kind]]
    limited = judged_by(system, combined_travel=True, limits=limits)
    response = wr.simulate(limited, wr.HalfSine(peak=30.0, duration=0.011, direction="z"), duration=0.05, accuracy=1e-3)
    response.save(tmp_path)
    read = wr.load_response(tmp_path)
    assert read.scene.limits == response.scene.limits
    assert {limit.kind for limit in read.scene.limits} >= {kind}
    assert [row.to_dict() for row in judge(read)] == [row.to_dict() for row in judge(response)]


@pytest.mark.quick
def test_loads_and_forces_of_stops_are_judged_by_their_peaks():
    law = wr.Parallel(laws=(wr.KelvinVoigt(k=4e4, c=40.0), wr.Stop(gap_below=0.004, k=5e5, loss=0.3, reversal=2e-4)))
    system = sdof(law, gravity=9.80665)
    limits = [limit_from_text("load/m1 = 1 kN"), limit_from_text("force/m1 = 0.1 kN")]
    response = wr.simulate(
        judged_by(system, combined_travel=True, limits=limits),
        wr.HalfSine(peak=300.0, duration=0.006, direction="z"),
        duration=0.5,
    )
    rows = {str(row.criterion): row for row in judge(response)}
    load, force = rows["load"], rows["stop force"]
    (contact,) = response.peaks.contacts.values()
    assert (load.value, load.limit) == (response.peaks.mounts["m1"].force.value, 1000.0)
    assert (force.value, force.limit, force.time) == (contact.force, 100.0, contact.force_time)
    assert force.verdict == "exceeded"
    assert contact.force > 100.0


@pytest.mark.slow
@pytest.mark.quick
@pytest.mark.parametrize("direction", [(0.0, 0.0, 1.0), (0.0, 0.0, -1.0)], ids=["up", "down"])
def test_the_load_of_a_foot_is_that_of_the_mount_and_of_the_stop_in_it(direction):
    shock = wr.HalfSine(peak=900.0, duration=0.011, direction=direction)
    systems, _ = equipment(None, {"shock": shock}, box={"mass": 420.0, "size": (0.6, 0.6, 0.6)}, mounts=["4"])
    limited = judged_by(systems["4"], combined_travel=True, limits=[limit_from_text("load/below_1 = 1 kN")])
    response = wr.simulate(limited, shock, duration=0.3, sample_rate=1e5)
    together = response.mounts["below_1"].force + response.mounts["bottom_below_1"].force
    largest = float(np.linalg.norm(together, axis=1).max())
    own = response.peaks.mounts["below_1"].force.value
    (load,) = (row for row in judge(response) if str(row.criterion) == "load")
    assert largest > 1.5 * own  # the stop was struck
    # never below; above by what rope and stop do not reach at one instant
    assert largest * (1.0 - 1e-3) <= load.value <= 1.05 * largest
    assert "bottom_below_1, which stands in it" in load.note
    measured = measures(limited, response.peaks, None)
    assert measured["load/below_1"] == pytest.approx(load.value, rel=1e-12)  # of a study
    assert measured["force/below_1"] == own
    assert utilisation_over_time(response, load).max() == pytest.approx(largest / 1000.0, rel=1e-12)
    names = ["below_1", "bottom_below_1"]
    cornered = replace(response, scene=replace(response.scene, areas={"corner": ("below_1",)}))
    area = next(one for one in area_forces(cornered) if one.name == "corner")
    assert max(area.down, area.up) == pytest.approx(np.abs(foundation_force(response, names)[:, 2]).max(), rel=1e-12)
    assert area.mounts == 1


@pytest.mark.quick
@pytest.mark.parametrize("engine", ["kernel", "mujoco"])
def test_closing_speed_and_travel_to_a_stop_are_those_of_an_own_integration(engine):
    """A mass of 3.5 kg falls from rest, unloaded, by gravity onto a stop 5 mm below and rebounds."""
    k, c, stop, gap, mass, g = 1e4, 5.0, 5e5, 0.005, 3.5, 9.80665
    law = wr.Parallel(laws=(wr.KelvinVoigt(k=k, c=c), wr.Stop(gap_below=gap, k=stop, rounding=1e-4)))
    limits = [limit_from_text(text) for text in ("closing/m1 = 0.1 m/s", "stops = none")]
    system = judged_by(sdof(law, gravity=g), combined_travel=True, limits=limits)
    still = wr.HalfSine(peak=1e-9, duration=0.01, direction="z")
    response = wr.simulate(system, still, duration=0.2, initial="unloaded", timestep=2e-5, engine=engine)

    def reach(_, y):
        return y[0] + gap

    reach.terminal, reach.direction = True, -1.0
    fall = solve_ivp(
        lambda _, y: [y[1], -g - (k * y[0] + c * y[1]) / mass], (0.0, 0.2), [0.0, 0.0], events=reach, rtol=1e-11, atol=1e-14
    )
    touch, (_, speed) = fall.t_events[0][0], fall.y_events[0][0]
    (contact,) = response.peaks.contacts.values()
    # the spring slows the mass down at 5 m/s^2 at the touch; what is linear within a step of 20 us misses 1e-9 m/s
    assert contact.closing_speed == pytest.approx(-speed, rel=1e-6)
    assert contact.closing_time == pytest.approx(touch, abs=1e-8)
    rows = {str(row.criterion): row for row in judge(response)}
    closing, used = rows["closing speed"], rows["stop gap"]
    assert (closing.value, closing.limit, closing.verdict) == (contact.closing_speed, 0.1, "exceeded")
    assert (used.value, used.limit, used.verdict) == (-response.peaks.mounts["m1"].deflection.minimum[2], gap, "exceeded")
    wider = replace(law, laws=(law.laws[0], replace(law.laws[1], gap_below=0.05)))
    open_stop = wr.simulate(
        judged_by(sdof(wider, gravity=g), combined_travel=True, limits=limits),
        still,
        duration=1.0,
        initial="unloaded",
        timestep=1e-4,
    )
    rows = {str(row.criterion): row for row in judge(open_stop)}
    assert (rows["closing speed"].value, rows["closing speed"].verdict) == (0.0, "within")
    assert 0.0 < rows["stop gap"].utilisation < 1.0


@pytest.mark.quick
def test_a_stop_of_two_sides_is_judged_on_both():
    law = wr.Parallel(laws=(wr.KelvinVoigt(k=4e4, c=40.0), wr.Stop(gap_below=0.02, gap_above=0.001, k=5e5, rounding=1e-4)))
    system = judged_by(sdof(law), combined_travel=True, limits=[limit_from_text("gap/* = 50 %")])
    response = wr.simulate(system, wr.HalfSine(peak=300.0, duration=0.006, direction="z"), duration=0.5)
    rows = {str(row.criterion): row for row in judge(response)}
    deflection = response.peaks.mounts["m1"].deflection
    assert (rows["stop gap, below"].value, rows["stop gap, below"].limit) == (-deflection.minimum[2], 0.01)
    assert (rows["stop gap, above"].value, rows["stop gap, above"].limit) == (deflection.maximum[2], 0.0005)


@pytest.mark.slow
@pytest.mark.quick
def test_what_rests_on_a_stop_from_the_start_is_said_and_no_strike():
    law = wr.Parallel(laws=(wr.KelvinVoigt(k=4e4, c=40.0), wr.Stop(gap_below=0.0, k=5e5, rounding=1e-4)))

    def gap(peak, gravity):
        system = judged_by(sdof(law, gravity=gravity), combined_travel=True, limits=[limit_from_text("stops = none")])
        response = wr.simulate(system, wr.HalfSine(peak=peak, duration=0.006, direction="z"), duration=1.0)
        (stop,) = response.peaks.contacts.values()
        return {row.criterion.kind: row for row in judge(response)}["stop gap"], stop

    rests, stop = gap(1.0, 9.80665)
    assert (rests.verdict, stop.touches, stop.struck) == ("not judged", 1, False)
    assert rests.note.endswith("the payload rests on it from the start of the run, which is no strike")
    hit, stop = gap(300.0, 9.80665)
    assert stop.from_start
    assert stop.struck
    assert hit.verdict == "exceeded"
    assert hit.limit > 1e-5  # as deep as it is pressed at rest
    assert "for its gap of 0 where it rests is taken" in hit.note
    assert hit.note.endswith(f"a limit on force/{hit.subject} says more")
    # so faint that the stop gives way by less than 1e-9 m: nothing that a figure may be made of
    faint, stop = gap(1e-9, 0.0)
    assert (stop.touches, stop.force, stop.first_touch) == (0, 0.0, None)
    assert (faint.verdict, faint.note.endswith("and it is not struck")) == ("not judged", True)


@pytest.mark.quick
@pytest.mark.parametrize(("text", "fault"), [
    ("load/m9 = 5 kN", "there is no mount 'm9'"), ("force/m01 = 5 kN", "there is no mount with a stop 'm01'"),
    ("load/m01 = 5 5 5 kN", "must be one number"), ("load/m01 = 5 mm", "is no unit of load"),
    ("load/rack = 5 kN", "there is no mount 'rack'"), ("stops = 3", "a limit is written like"),
    ("stops/m01 = none", "there is no mount with a stop 'm01'"), ("gap/s1 = 120 %", "from 0.001 to 1"),
    ("closing/s1 = 5 mm", "is no unit of closing"),
])  # fmt: skip
def test_what_has_no_such_force_is_refused(text, fault):
    with pytest.raises((ValueError, wr.ModelError), match=fault):
        judged_by(wr.load_system("cabinet"), combined_travel=True, limits=[limit_from_text(text)])


@pytest.mark.slow
def test_a_command_says_which_load_is_exceeded(tmp_path, capsys):
    words = ["shock", "shock_table", "--half-sine", "30 g 11 ms z", "--limit", "load/m1 = 10 N", "--out", str(tmp_path / "run")]
    assert main(words) == 0
    assert "FAIL: m1 load" in " ".join(capsys.readouterr().out.split())
    assert main(["report", str(tmp_path / "run")]) == 0
