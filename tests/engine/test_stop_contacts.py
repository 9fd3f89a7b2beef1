"""Stops among the mounts' laws over every step: when they close, how hard and how deep, against the steps themselves."""

import dataclasses

import numpy as np
import pytest
from house import deck, mjcf, quiet
from one_scale import one_scale
from recordings import entities

import wirerope_mj as wr
from wirerope_mj.assessment.criteria import contact_verdicts, headline, judge, mount_peaks, verdict_lines
from wirerope_mj.content.events import events_of
from wirerope_mj.content.isolator import provenance_statement
from wirerope_mj.content.selection import select
from wirerope_mj.engine.simulation.timestep import ACCURACY
from wirerope_mj.engine.statics import static_table
from wirerope_mj.foundation.resources import models_folder
from wirerope_mj.mounts.laws.registry import evaluate
from wirerope_mj.studies.vary.quantity import without_force
from wirerope_mj.views.recording import record_rerun
from wirerope_mj.views.recording.scene import CLOSED, OPEN

pytestmark = pytest.mark.quick

G = wr.STANDARD_GRAVITY
STEP = 1e-4
BELOW, ABOVE = 0.012, 0.015
LOSSY = {"gap_below": BELOW, "gap_above": ABOVE, "k": 2e6, "rounding": 1e-3, "loss": 0.2, "reversal": 1e-3}
SHOCK = wr.HalfSine(peak=40 * G, duration=0.011, direction="z", start=0.05)


def mass_on_stop(inside=None, beside=None):
    """Return 50 kg on a rope isolator "m1" with a stop "s3" beside it; `inside` and `beside` are what their laws have."""
    world = deck({"b1": 'pos="0 0 .2"', "b3": 'pos=".05 0 .2"'}, slides="z")
    world += (
        '<body name="mass" pos="0 0 .3"><joint type="slide" axis="0 0 1"/><geom type="box" size=".1 .1 .1" mass="50"/>'
        '<site name="p1" pos="0 0 -.1"/><site name="p3" pos=".05 0 -.1"/></body>'
    )
    rope = one_scale("wr12_400")["wr12_400"]
    if inside is not None:
        rope = dataclasses.replace(rope, coupling=None, loop=None, axial=wr.Parallel(laws=[rope.axial, inside]))
    stop = wr.Isolator(name="bumper", axial=wr.Stop(**LOSSY) if beside is None else beside)
    isolators = {"rope": rope, "bumper": stop}
    return wr.load_system(
        mjcf(world, [("m1", "p1", "b1", "rope"), ("s3", "p3", "b3", "bumper")], gravity=G), isolators=isolators
    )


@pytest.fixture(scope="module")
def system():
    return mass_on_stop()


@pytest.fixture(scope="module")
def response(system):
    return wr.simulate(system, SHOCK, duration=0.2, timestep=STEP, sample_rate=1.0 / STEP)


def seen(time, deflection, force):
    """Return what a history at every step says of a stop: touches, first touch, duration, peak force, depth."""
    closed = force != 0.0
    begins = np.flatnonzero(closed & ~np.concatenate([[False], closed[:-1]]))
    together = closed[1:] & closed[:-1]
    depth = np.maximum(-deflection - BELOW, deflection - ABOVE)
    return {
        "touches": begins.size,
        "first_touch": time[begins[0]],
        "duration": np.diff(time)[together].sum(),
        "force": np.abs(force).max(),
        "force_time": time[np.abs(force).argmax()],
        "penetration": depth.max(),
        "penetration_time": time[depth.argmax()],
    }


@pytest.mark.parametrize("callback", ["native", "python"])
def test_a_stop_is_seen_at_every_step(system, response, callback):
    r = response if callback == "native" else wr.simulate(
        system, SHOCK, duration=0.2, timestep=STEP, sample_rate=1.0 / STEP, callback=callback, engine="mujoco"
    )  # fmt: skip
    contact = r.peaks.contacts["s3"]
    assert (contact.struck, contact.from_start, contact.mount, contact.bodies) == (True, False, "s3", ("mass", "deck"))
    assert contact.touches > 1  # both sides are struck
    s3 = r.mounts["s3"]
    for name, value in seen(r.time, s3.deflection[:, 2], s3.force[:, 2]).items():
        # the same numbers of the same steps; times are sums of steps
        assert getattr(contact, name) == pytest.approx(value, rel=1e-9), name


def test_a_batch_sees_what_a_run_sees(system, response):
    (result,) = wr.simulate_batch(system, SHOCK, duration=0.2, timestep=STEP, sample_rate=1.0 / STEP)
    assert result.peaks.contacts == response.peaks.contacts


@pytest.mark.parametrize("callback", ["native", "python"])
def test_a_stop_inside_an_isolator_is_seen(callback):
    bumper = wr.Stop(**LOSSY)
    viscous = wr.Stop(gap_below=BELOW, k=1e6, rounding=2e-3, c=3e3)
    system = mass_on_stop(inside=bumper, beside=wr.Parallel(laws=[viscous, bumper]))
    assert [mount.isolator.is_stop for mount in system.mounts.values()] == [False, True]
    r = wr.simulate(system, SHOCK, duration=0.2, timestep=STEP, sample_rate=1.0 / STEP, callback=callback, engine="mujoco")
    assert list(r.peaks.contacts) == ["m1", "s3 axial 1", "s3 axial 2"]
    inside, second = r.peaks.contacts["m1"], r.peaks.contacts["s3 axial 2"]
    assert inside.mount == "m1"
    # the same stop on the same deflection; the states of their losses at rest are those of two paths of finite accuracy
    assert second.force == pytest.approx(inside.force, rel=1e-6)
    assert dataclasses.replace(inside, mount="s3", force=second.force) == second
    deflection = r.mounts["m1"].deflection[:, 2]
    # What the other law of each does not bear, a stop does; the other's force follows from its recorded state.
    alone = r.mounts["m1"].force[:, 2] - force_of(system.mounts["m1"].isolator.axial.laws[0], r, "m1", "axial.z_1")
    wanted = seen(r.time, deflection, np.where(np.abs(alone) > 1e-6, alone, 0.0))  # rounding of a difference of kN
    for name in ("first_touch", "force", "force_time", "penetration", "penetration_time"):
        assert getattr(inside, name) == pytest.approx(wanted[name], rel=1e-9), name
    damped = r.mounts["s3"].force[:, 2] - force_of(bumper, r, "s3", "axial.w_2")
    assert r.peaks.contacts["s3 axial 1"].force == pytest.approx(np.abs(damped).max(), rel=1e-9)


def force_of(law, response, mount, state):
    """Return what a law of one state, without viscous part, bears along a mount's axis at every sample [N]."""
    mount, p, rate = response.mounts[mount], law.kernel_parameters(), np.empty(1)
    pairs = zip(mount.deflection[:, 2], mount.internal_states[state], strict=True)
    return np.array([evaluate(law.kernel, p, 0, x, 0.0, np.array([z]), 0, rate, 0) for x, z in pairs])


def test_stops_are_saved_and_loaded(response, tmp_path):
    response.save(tmp_path)
    loaded = wr.load_response(tmp_path)
    assert loaded.peaks.same_as(response.peaks)
    assert loaded.peaks.contacts["s3"].mount == "s3"
    assert [mount.name for mount in loaded.scene.mounts if mount.stop] == ["s3"]


def test_what_rests_on_a_stop_is_no_strike():
    system = mass_on_stop(beside=wr.Stop(gap_below=0.0, k=1e6, rounding=1e-3))
    contact = wr.simulate(system, quiet(), duration=0.02, timestep=STEP).peaks.contacts["s3"]
    assert (contact.from_start, contact.struck) == (True, False)
    assert contact.duration == pytest.approx(0.02)


def test_a_stop_that_stays_open_is_listed():
    (verdict,) = contact_verdicts(wr.simulate(mass_on_stop(), quiet(), duration=0.02, timestep=STEP))
    assert (verdict.criterion, verdict.subject, verdict.verdict, verdict.value) == ("stop", "s3", "not touched", 0.0)


def test_words(response):
    contact = response.peaks.contacts["s3"]
    text = f"stop s3 closed at {1e3 * contact.first_touch:.1f} ms, up to {1e-3 * contact.force:.3g} kN"
    assert text in [event.text for event in events_of(response, select(response))]
    assert any(line.startswith("S" + text[1:]) for line in verdict_lines(response, judge(response)))
    assert "1 of 1 stop struck" in headline(judge(response))


def test_a_variant_cannot_have_more_stops_than_its_model():
    law = wr.KelvinVoigt(k=1e5, c=10.0)
    system = mass_on_stop(beside=law)
    assert "s3" not in wr.simulate(system, quiet(), duration=0.01, timestep=STEP).peaks.contacts
    stop = wr.Isolator(name="bumper", axial=wr.Stop(gap_below=0.01, k=1e6))
    with pytest.raises(wr.ModelError, match="have 1 stops, those that the model was compiled with 0"):
        wr.varied(system, isolators={"s3": stop})
    without = wr.varied(
        mass_on_stop(),
        isolators={"s3": wr.Isolator(name="rope", axial=wr.BoucWen(alpha=1e5, beta=1.0, gamma=1.0, n=1.0))},
    )
    assert wr.simulate(without, quiet(), duration=0.01, timestep=STEP).peaks.contacts == {}


def test_tables_and_loops_leave_stops_out(response):
    assert {row.name for row in mount_peaks(response)} == {"m1"}
    assert {row.subject for row in judge(response) if row.criterion != "stop"} & {"s3"} == set()
    assert [ranked for ranked in select(response).ranked.values() if "s3" in ranked] == []


def test_a_rated_stop_is_judged_like_an_isolator():
    rated = wr.Isolator(name="bumper", axial=wr.Stop(**LOSSY), limits=wr.Limits(travel=wr.Travel(compression=0.02)))
    assert not rated.is_stop


def test_the_static_table_lists_stops_that_carry():
    free = static_table(mass_on_stop()).sags["virgin"]
    resting = static_table(mass_on_stop(beside=wr.Stop(gap_below=0.0, k=1e6, rounding=1e-3))).sags["virgin"]
    assert (list(free.listed), list(resting.listed)) == (["m1"], ["m1", "s3"])


def test_the_recording_colours_a_stop_while_it_is_closed(response, tmp_path):
    record_rerun(response, tmp_path / "run.rrd")
    batches = entities(tmp_path / "run.rrd")
    (path,) = [path for path in batches if path.endswith("/stops/s3")]
    rows = [batch for batch in batches[path] if "sim_time" in batch.schema.names]
    colors = [color for batch in rows for (color,) in batch["Cylinders3D:colors"].to_pylist()]
    times = np.concatenate([batch["sim_time"].to_numpy().astype(float) * 1e-9 for batch in rows])
    closed = response.mounts["s3"].force[:, 2] != 0.0
    changes = np.flatnonzero(np.diff(closed.astype(int), prepend=-1))
    np.testing.assert_allclose(times, response.time[changes], atol=1e-9)  # the timeline counts nanoseconds
    assert [color >> 8 for color in colors] == [int.from_bytes(bytes(CLOSED if closed[row] else OPEN)) for row in changes]
    assert len(colors) > 2


def test_a_ball_that_the_model_draws_takes_the_colour(tmp_path):
    """The shipped stops are drawn as balls: a bumper inside one would never be seen."""
    response = wr.simulate(wr.load_system(models_folder() / "shock_table.xml"), quiet(), duration=0.01, timestep=STEP)
    record_rerun(response, tmp_path / "run.rrd")
    batches = entities(tmp_path / "run.rrd")
    (path,) = [path for path in batches if path.endswith("/block/stops/s3")]
    (half_sizes,) = [
        batch["Ellipsoids3D:half_sizes"].to_pylist()[0][0]
        for batch in batches[path]
        if "Ellipsoids3D:half_sizes" in batch.schema.names
    ]
    assert min(half_sizes) > 0.0259  # the ball of the model


def test_the_report_states_where_a_stop_closes_and_how_stiff_it_is():
    device = wr.Isolator(
        name="bumper",
        axial=wr.Stop(gap_below=0.0432, k=24e6),
        roll=wr.Stop(gap_above=0.01, depths=[0.01], forces=[3e3]),
    )
    words = provenance_statement(device).text
    assert "Stop, axial: gap 43.2 mm below, 24000 kN/m beyond it." in words
    assert "Stop, roll: gap 10.0 mm above, points up to 3.00 kN at 10.0 mm beyond it." in words


def test_an_isolator_with_a_stop_can_fail_in_a_study():
    inside = mass_on_stop(inside=wr.Stop(**LOSSY)).mounts["m1"].isolator
    failed = without_force(inside)
    assert failed.axial.n_states == inside.axial.n_states
    assert failed.stops == ()


def test_the_step_of_a_stop_is_chosen_for_the_accuracy_asked_for(system):
    """With contacts a run ends where they let it; a stop's force has no jump, and finer steps bring the accuracy."""
    numerics = wr.simulate(system, SHOCK, duration=0.12, accuracy=1e-5).numerics
    assert numerics.limited_by == ACCURACY
    assert numerics.error_estimate <= 1e-5
