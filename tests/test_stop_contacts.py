"""Stops among the mounts' laws over every step: when they close, how hard and how deep, against the steps themselves."""

import dataclasses

import numpy as np
import pytest
from house import deck, mjcf, quiet

import wirerope_mj as wr
from wirerope_mj.criteria import contact_verdicts, judge
from wirerope_mj.isolator.files import find_isolator
from wirerope_mj.laws.kernels import evaluate
from wirerope_mj.recording.events import events_of
from wirerope_mj.recording.selection import select
from wirerope_mj.verdicts import verdict_lines
from wirerope_mj.verdicts.headline import headline

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
    rope = wr.load_isolator(find_isolator("enidine_wr12_400"))
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
    with pytest.warns(wr.AccuracyWarning, match="1 of 1 stops were struck, first s3 at 0.059"):
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


@pytest.mark.filterwarnings("ignore::wirerope_mj.errors.AccuracyWarning")
@pytest.mark.parametrize("callback", ["native", "python"])
def test_a_stop_is_seen_at_every_step(system, response, callback):
    r = response if callback == "native" else wr.simulate(
        system, SHOCK, duration=0.2, timestep=STEP, sample_rate=1.0 / STEP, callback=callback
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


@pytest.mark.filterwarnings("ignore::wirerope_mj.errors.AccuracyWarning")
@pytest.mark.parametrize("callback", ["native", "python"])
def test_a_stop_inside_an_isolator_is_seen(callback):
    bumper = wr.Stop(**LOSSY)
    viscous = wr.Stop(gap_below=BELOW, k=1e6, rounding=2e-3, c=3e3)
    system = mass_on_stop(inside=bumper, beside=wr.Parallel(laws=[viscous, bumper]))
    assert [mount.isolator.is_stop for mount in system.mounts.values()] == [False, True]
    r = wr.simulate(system, SHOCK, duration=0.2, timestep=STEP, sample_rate=1.0 / STEP, callback=callback)
    assert list(r.peaks.contacts) == ["m1", "s3 axial 1", "s3 axial 2"]
    inside, second = r.peaks.contacts["m1"], r.peaks.contacts["s3 axial 2"]
    assert inside.mount == "m1"
    # the same stop on the same deflection; the states of their losses at rest are those of two paths
    assert second.force == pytest.approx(inside.force, rel=1e-7)
    assert dataclasses.replace(inside, mount="s3", force=second.force) == second
    deflection = r.mounts["m1"].deflection[:, 2]
    rope = wr.load_isolator(find_isolator("enidine_wr12_400")).axial
    alone = r.mounts["m1"].force[:, 2] - rope_force(rope, r)
    wanted = seen(r.time, deflection, np.where(np.abs(alone) > 1e-6, alone, 0.0))  # rounding of a difference of kN
    for name in ("first_touch", "force_time", "penetration", "penetration_time"):
        assert getattr(inside, name) == pytest.approx(wanted[name], rel=1e-9), name
    assert inside.force == pytest.approx(wanted["force"], rel=1e-9)
    # what the other one does not bear, the viscous one does; the other's state as above
    damped = r.mounts["s3"].force[:, 2] - alone
    assert r.peaks.contacts["s3 axial 1"].force == pytest.approx(np.abs(damped).max(), rel=1e-7)


def rope_force(law, response):
    """Return what the rope alone bears at every step [N], from its recorded state: Ni's (3.15) to (3.18)."""
    x, z = response.mounts["m1"].deflection[:, 2], response.mounts["m1"].internal_states["axial.z_1"]
    return np.array([law_force(law, *pair) for pair in zip(x, z, strict=True)])


def law_force(law, x, z):
    out = np.empty(1)
    return evaluate(law.kernel, law.kernel_parameters(), 0, x, 0.0, np.array([z]), 0, out, 0)


@pytest.mark.filterwarnings("ignore::wirerope_mj.errors.AccuracyWarning")
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
    text = f"stop s3 closed at {1e3 * contact.first_touch:.1f} ms, {1e-3 * contact.force:.3g} kN"
    assert text in [event.text for event in events_of(response, select(response))]
    assert any(line.startswith("S" + text[1:]) for line in verdict_lines(response))
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
