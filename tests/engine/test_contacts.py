"""Contacts over every step: first touch, force, depth and verdict of stops, against MuJoCo's own contact list."""

import json

import mujoco
import numpy as np
import pyarrow.parquet as pq
import pytest
from commands import wirerope
from free_bodies import floor_on_stops
from house import deck, mjcf, quiet, sdof

import wirerope_mj as wr
from wirerope_mj.assessment.criteria import CLEAR, STRUCK, TOUCHING, contact_verdicts
from wirerope_mj.engine.control import installed
from wirerope_mj.engine.control.install import STATE
from wirerope_mj.engine.response.histories import SENSITIVE
from wirerope_mj.engine.simulation.run import OTHERS
from wirerope_mj.foundation.resources import models_folder, scenarios_folder

pytestmark = pytest.mark.filterwarnings("ignore:the given step of")  # what is asked here holds at coarse steps

G = wr.STANDARD_GRAVITY
STEP = 5e-4


def shock(level):
    return wr.HalfSine(peak=level * G, duration=0.011, direction="z", start=0.05)


@pytest.fixture(scope="module")
def table():
    return wr.load_system(models_folder() / "shock_table_contacts.xml")


@pytest.fixture(scope="module")
def struck(table):
    with pytest.warns(wr.AccuracyWarning, match="4 of 4 contact pairs were struck, first stop_1 on pad_1 at 0.06"):
        return wr.simulate(table, shock(60.0), duration=0.12, timestep=STEP)


def box_on_deck(cone, dimension):
    """A box that falls onto the deck beside its mount: four contact points of one undeclared pair."""
    world = deck({"d": 'pos="0 0 .1"'}, inside='<geom name="plate" type="box" size="1 1 .01" contype="1" conaffinity="1"/>')
    contact = f'condim="{dimension}" solref="-40000 -300" solimp=".001 .001 .001" friction=".4"'
    world += (
        '<body name="box" pos="0 0 .2"><freejoint/><geom name="crate" type="box" size=".1 .1 .1" mass="20" contype="1" '
        f'conaffinity="1" pos="0 0 -.06" {contact}/><site name="p" pos="0 0 -.1"/></body>'
    )
    text = mjcf(world, [("m", "p", "d", "a")], gravity=G, other=f'<option cone="{cone}"/>')
    law = wr.KelvinVoigt(k=2e3, c=10.0)
    return wr.load_system(text, isolators={"a": wr.Isolator(name="a", roll=law, shear=law, axial=law)})


def by_hand(system, initial, n_steps):
    """Return instants, normal forces and depths of all contacts together at the start of every step, from MuJoCo itself."""
    model = system.model.__copy__()
    data, wrench, rows = mujoco.MjData(model), np.zeros(6), []
    model.opt.timestep = STEP
    mujoco.mj_setState(model, data, initial.values, STATE)
    with installed(model, data):
        for number in range(n_steps + 1):
            data.time = number * STEP
            mujoco.mj_forward(model, data)
            force = depth = 0.0
            for contact in range(data.ncon):
                mujoco.mj_contactForce(model, data, contact, wrench)
                force, depth = force + wrench[0], max(depth, -data.contact[contact].dist)
            rows.append((number * STEP, force, depth))
            mujoco.mj_step(model, data)
    return np.array(rows)


@pytest.mark.parametrize("callback", ["native", "python"])
@pytest.mark.parametrize(("cone", "dimension"), [("pyramidal", 1), ("pyramidal", 3), ("elliptic", 3), ("pyramidal", 4)])
def test_forces_and_depths_are_those_of_mujoco(cone, dimension, callback):
    system = box_on_deck(cone, dimension)
    with pytest.warns(wr.AccuracyWarning, match="first crate on plate"):
        r = wr.simulate(system, quiet(), duration=0.3, timestep=STEP, initial="unloaded", callback=callback)
    (contact,) = r.peaks.contacts.values()
    time, force, depth = by_hand(system, r.initial_state, 600).T
    touching = depth > 0.0
    # The same steps; rounding alone differs, as the run sets the time of every piece anew: chaos of 600 steps from 1e-16.
    assert contact.force == pytest.approx(force.max(), rel=1e-6)
    assert contact.force_time == pytest.approx(time[force.argmax()], abs=1e-9)
    assert contact.penetration == pytest.approx(depth.max(), rel=1e-6)
    assert contact.first_touch == pytest.approx(time[touching][0], abs=1e-9)
    assert contact.touches == np.count_nonzero(np.diff(touching.astype(int)) == 1)
    together = np.count_nonzero(touching[1:] & touching[:-1])
    assert contact.duration == pytest.approx(together * STEP, abs=1e-9)
    assert (contact.geoms, contact.bodies) == (("crate", "plate"), ("box", "deck"))


@pytest.mark.slow
@pytest.mark.parametrize("callback", ["native", "python"])
def test_a_strike_takes_up_the_energy_that_the_motion_loses(callback):
    world = deck({"d": 'pos="0 0 .1"'}, inside='<geom name="plate" type="box" size="1 1 .05"/>')
    ball = '<geom name="bump" type="sphere" size=".05" mass="20"/><site name="p" pos="0 0 -.2"/>'
    world += f'<body name="ball" pos="0 0 .3"><freejoint/>{ball}</body>'
    pair = '<contact><pair geom1="bump" geom2="plate" condim="1" solref="-40000 -150" solimp=".001 .001 .001"/></contact>'
    law = wr.KelvinVoigt(k=1e-6, c=0.0)  # as good as no spring
    isolator = wr.Isolator(name="a", roll=law, shear=law, axial=law)
    system = wr.load_system(mjcf(world, [("m", "p", "d", "a")], gravity=G, other=pair), isolators={"a": isolator})
    lost = {}
    for step in (1e-4, 1.25e-5):
        with pytest.warns(wr.AccuracyWarning):
            r = wr.simulate(
                system, quiet(), duration=0.35, timestep=step, initial="unloaded", callback=callback, sample_rate=5000.0
            )
        ball, (name,) = r.bodies["ball"], r.contacts
        energy = 20.0 * (0.5 * (ball.velocity**2).sum(axis=1) + G * ball.position[:, 2])
        lost[step] = float(energy[0] - energy[-1])
        assert r.peaks.contacts[name].touches == 1
        assert lost[step] > 5.0
        # The damping begins with its full power m b v^2 somewhere within a step: half a step of it is not known.
        power = 20.0 * 150.0 * 2.0 * G * 0.2
        assert r.peaks.contacts[name].energy == pytest.approx(lost[step], abs=0.5 * step * power)
        # All that touches the ball is the plate: its force is m (a + g), and its gap is its height above it.
        pressed = 20.0 * (ball.acceleration[:, 2] + G)
        np.testing.assert_allclose(r.contacts[name].force, pressed, rtol=1e-6, atol=1e-5)
        np.testing.assert_allclose(r.contacts[name].gap, ball.position[:, 2] - 0.05 - 0.05, atol=1e-12)
    assert lost[1e-4] == pytest.approx(lost[1.25e-5], rel=2e-3)


def test_histories_of_contacts_come_back_from_a_streamed_file_and_have_their_peaks(table, struck, tmp_path):
    with pytest.warns(wr.AccuracyWarning):
        streamed = wr.simulate(table, shock(60.0), duration=0.12, timestep=STEP, out=tmp_path)
    assert list(streamed.contacts) == list(table.assembly.contacts) == list(struck.contacts)
    for name, pair in struck.contacts.items():
        np.testing.assert_array_equal(streamed.contacts[name].force, pair.force)
        np.testing.assert_array_equal(streamed.contacts[name].gap, pair.gap)
        peak = struck.peaks.contacts[name]
        assert pair.force.max() <= peak.force <= 1.02 * pair.force.max()  # samples at 1 kHz, steps at 2 kHz
        assert -pair.gap.min() == pytest.approx(peak.penetration, rel=1e-2)
        assert ((pair.force > 0.0) <= (pair.gap < 0.0)).all()


def test_a_gap_is_there_when_the_kernel_computes_the_run(table):
    r = wr.simulate(table, shock(10.0), duration=0.12, timestep=STEP)
    assert r.numerics.engine == "kernel"
    by_mujoco = wr.simulate(table, shock(10.0), duration=0.12, timestep=STEP, engine="mujoco")
    for name, pair in r.contacts.items():
        assert not pair.force.any()
        assert pair.gap.min() > 0.0
        np.testing.assert_allclose(pair.gap, by_mujoco.contacts[name].gap, atol=1e-9)


def test_stops_that_carry_from_the_start_are_not_struck():
    r = wr.simulate(floor_on_stops(), quiet(), duration=0.1, timestep=STEP)  # without a warning
    assert [(c.from_start, c.touches, c.first_touch, c.struck) for c in r.peaks.contacts.values()] == [
        (True, 1, 0.0, False)
    ] * 4
    carried = sum(contact.force for contact in r.peaks.contacts.values()) - sum(m.force[0, 2] for m in r.mounts.values())
    assert carried == pytest.approx(400.0 * G, rel=1e-5)  # to which the contact solver iterates
    assert {row.verdict for row in contact_verdicts(r)} == {TOUCHING}


def test_every_declared_stop_has_a_verdict_struck_or_not(table, struck):
    assert {row.subject: row.verdict for row in contact_verdicts(struck)} == {
        f"stop_{n} on pad_{n}": STRUCK for n in (1, 2, 3, 4)
    }
    gentle = wr.simulate(table, shock(20.0), duration=0.12, timestep=STEP)  # without a warning
    assert {row.verdict for row in contact_verdicts(gentle)} == {CLEAR}
    assert gentle.peaks.struck == []
    assert all(contact.first_touch is None for contact in gentle.peaks.contacts.values())


def test_pairs_beyond_the_memory_are_told_together_and_nothing_is_called_untouched(monkeypatch):
    monkeypatch.setattr("wirerope_mj.engine.system.tables.contact_capacity", lambda model: 2)
    system = wr.load_system(models_folder() / "shock_table_contacts.xml")
    with pytest.warns(wr.AccuracyWarning):
        r = wr.simulate(system, shock(60.0), duration=0.12, timestep=STEP)
    assert list(r.peaks.contacts) == ["stop_1 on pad_1", OTHERS]
    assert r.peaks.contacts[OTHERS].force > r.peaks.contacts["stop_1 on pad_1"].force  # of three stops together


def test_a_model_in_which_nothing_may_touch_remembers_nothing():
    system = sdof(wr.KelvinVoigt(k=2e4, c=20.0))
    assert system.assembly.tables.user.n_contacts == 0
    assert wr.simulate(system, shock(5.0), duration=0.1, timestep=STEP).peaks.contacts == {}


def test_contacts_come_back_from_the_file_and_older_files_have_none(struck, tmp_path):
    struck.save(tmp_path)
    assert wr.load_response(tmp_path).peaks.contacts == struck.peaks.contacts
    path = tmp_path / "response.parquet"
    data = pq.read_table(path)
    content = json.loads(pq.read_metadata(path).metadata[b"wirerope_mj"])
    del content["peaks"]["contacts"], content["numerics"]["limited_by"]  # as older versions wrote it
    pq.write_table(data.replace_schema_metadata({b"wirerope_mj": json.dumps(content).encode()}), path)
    old = wr.load_response(tmp_path)
    assert old.peaks.contacts is None
    assert old.numerics.limited_by == ""
    assert old.peaks.same_as(struck.peaks)
    assert contact_verdicts(old) == ()


@pytest.mark.slow
def test_the_command_says_struck_stops_in_every_output(tmp_path):
    scenario = (scenarios_folder() / "shock_table.py").read_text().replace("shock_table.xml", "shock_table_contacts.xml")
    (tmp_path / "on_contacts.py").write_text(scenario)
    done = wirerope(
        "run",
        "on_contacts.py",
        "--duration",
        "0.12",
        "--level-g",
        "60",
        "--timestep",
        "5e-4",
        "--out",
        "here",
        "--all",
        cwd=tmp_path,
    )
    warned = done.stderr.splitlines()
    assert len(warned) == 2
    assert "the given step of 0.5 ms is too long" in warned[1]
    assert "4 of 4 contact pairs were struck" in warned[0]
    assert "accelerations are uncertain from there on" in warned[0]
    summary = json.loads((tmp_path / "here" / "summary.json").read_text(encoding="utf-8"))
    first = summary["contacts"][0]
    assert (first["name"], first["verdict"], first["touches"]) == ("stop_1 on pad_1", "struck", 1)
    row = next(line.split() for line in done.stdout.splitlines() if line.startswith("stop_1 on pad_1"))
    told = f"{first['first_touch_s']:.4f}", f"{1e-3 * first['peak_force_N']:.2f}", f"{1e3 * first['penetration_m']:.2f}"
    assert set(told) <= set(row)
    assert row[-1] == "struck"
    page = (tmp_path / "here" / "report.html").read_text(encoding="utf-8")
    assert "Stops and contacts" in page
    assert page.count("stop_1 on pad_1") >= 2  # in its section and among all verdicts


def nearly_undamped(stiffness, damping):
    """Return the shock table whose stops, pairs of geoms, have a stiffness and a damping per kilogram of payload."""
    text = (models_folder() / "shock_table_contacts.xml").read_text(encoding="utf-8")
    isolator = wr.load_isolator("enidine_wr12_400")
    stops = text.replace("-20000 -35", f"-{stiffness:g} -{damping:g}")
    return wr.load_system(stops, isolators={"wr12_400": isolator})


def test_a_step_at_which_stiff_stops_fail_is_never_the_one_that_is_taken():
    # steps down to 0.25 ms fail and the next agree badly: the search took 0.25 ms, and the run failed
    sine = wr.Sine(frequency=8.0, acceleration=29.0 * G, direction="z")
    with pytest.warns(wr.AccuracyWarning):
        r = wr.simulate(nearly_undamped(2e5, 0.5), sine, duration=0.3, accuracy=1e-2)
    assert r.timestep < 2e-4


@pytest.mark.slow
def test_struck_geoms_that_finer_steps_do_not_agree_on_are_sensitive_with_their_spread():
    system = nearly_undamped(2e7, 0.0)
    sine = wr.Sine(frequency=12.0, acceleration=15.0 * G, direction="z")
    with pytest.warns(wr.AccuracyWarning) as caught:
        r = wr.simulate(system, sine, duration=1.0, accuracy=1e-2)
    assert r.numerics.limited_by == SENSITIVE
    assert any("the answer is sensitive to what the system hits" in str(one.message) for one in caught)
    peaks = [r.peaks.bodies["block"].acceleration.value]
    with pytest.warns(wr.AccuracyWarning, match="were struck"):
        peaks += [
            wr.simulate(system, sine, duration=1.0, timestep=r.timestep / parts).peaks.bodies["block"].acceleration.value
            for parts in (2, 3)
        ]
    assert np.ptp(peaks) / peaks[-1] <= r.estimated_error
