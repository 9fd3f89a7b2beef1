"""Limits on the load of a mount and on the force of its stops, and every kind of limit read back from a run's file."""

import pytest
from house import sdof

import wirerope_mj as wr
from wirerope_mj.assessment.criteria import judge
from wirerope_mj.cli import main
from wirerope_mj.foundation.payload_limits import KINDS, limit_from_text
from wirerope_mj.runs.scenario_file import judged_by

TEXTS = {
    "acceleration": ("acceleration/rack = 15 g", "acceleration/rack_top = 0 0 15 g"),
    "clearance": ("clearance/rack_top = 30 30 20 mm", "clearance/rack_top to rack_base_front = 30 30 20 mm"),
    "load": ("load/m* = 50 kN", "load/s1 = 8000 lbf"),
    "force": ("force/c1 = 10 kN",),
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


@pytest.mark.quick
@pytest.mark.parametrize(("text", "fault"), [
    ("load/m9 = 5 kN", "there is no mount 'm9'"), ("force/m01 = 5 kN", "there is no mount with a stop 'm01'"),
    ("load/m01 = 5 5 5 kN", "must be one number"), ("load/m01 = 5 mm", "is no unit of load"),
    ("load/rack = 5 kN", "there is no mount 'rack'"),
])  # fmt: skip
def test_what_has_no_such_force_is_refused(text, fault):
    with pytest.raises((ValueError, wr.ModelError), match=fault):
        judged_by(wr.load_system("cabinet"), combined_travel=True, limits=[limit_from_text(text)])


@pytest.mark.slow
def test_a_command_says_which_load_is_exceeded(tmp_path, capsys):
    words = ["shock", "shock_table", "--half-sine", "30 g 11 ms z", "--limit", "load/m1 = 10 N", "--out", str(tmp_path / "run")]
    assert main(words) == 0
    assert "Exceeded: load of m1" in " ".join(capsys.readouterr().out.split())
    assert main(["report", str(tmp_path / "run")]) == 0
