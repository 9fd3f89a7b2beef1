"""Many variants side by side: every one is what it is alone, bit for bit."""

import dataclasses
import re

import house
import mujoco
import numpy as np
import pytest

import wirerope_mj as wr
from wirerope_mj.foundation.resources import models_folder

# Variants are compared with each other, at steps that are coarse for friction.
pytestmark = [pytest.mark.quick, pytest.mark.filterwarnings("ignore:the given step of")]

G = wr.STANDARD_GRAVITY
STEPS = {"duration": 0.2, "timestep": 2.5e-4, "sample_rate": 250.0}


def model(name, *, stiffer=1.0):
    """Return a system of the house whose axial forces are multiplied."""
    path = models_folder() / f"{name}.xml"

    def changed(isolator):
        axial = isolator.axial
        return isolator if axial is None or isolator.is_stop else dataclasses.replace(
            isolator, axial=axial.scaled(stiffer)
        )  # fmt: skip

    plain = wr.load_system(path)
    return wr.load_system(path, isolators={name: changed(isolator) for name, isolator in plain.isolators.items()})


def half_sine(level, direction="z", start=0.01):
    return wr.HalfSine(peak=level * G, duration=0.011, direction=direction, start=start)


def all_corners(motions):
    return np.unique(np.concatenate([motion.corners for motion in motions]))


def assert_same(result, response):
    """The batch's result and the response of `simulate` agree in every bit."""
    assert isinstance(result, wr.BatchResult), result
    assert result.peaks.to_dict() == response.peaks.to_dict()
    np.testing.assert_array_equal(result.initial_state.values, response.initial_state.values)
    np.testing.assert_array_equal(result.final_state.values, response.final_state.values)
    assert result.final_state.time == response.final_state.time
    assert result.timestep == response.timestep


def assert_each_as_alone(systems, motions, **keywords):
    results = wr.simulate_batch(systems, motions, **keywords)
    corners = all_corners(motions)
    for system, motion, result in zip(systems, motions, results, strict=True):
        assert_same(result, wr.simulate(system, motion, corners=corners, **keywords))
    return results


def test_floors_on_different_isolators_are_what_they_are_alone():
    systems = [model("floating_floor", stiffer=factor) for factor in (1.0, 0.9, 1.2)]
    results = assert_each_as_alone(systems, [half_sine(10.0)] * 3, **STEPS)
    peaks = [result.peaks.bodies["floor"].acceleration.value for result in results]
    assert len(set(peaks)) == 3


@pytest.mark.filterwarnings("ignore::wirerope_mj.AccuracyWarning")  # stops are struck on purpose
def test_cabinets_that_touch_their_stops_are_what_they_are_alone():
    systems = [model("cabinet", stiffer=factor) for factor in (1.0, 0.8)]
    systems = [systems[0], systems[1], systems[0]]
    motions = [half_sine(40.0, "z"), half_sine(30.0, (1, 0, 1)), half_sine(5.0, "x")]
    # At 2.7 m/s a step of 0.25 ms goes through nine times the 0.08 mm over which the finer friction yields: too far.
    steps = {**STEPS, "timestep": 1e-4}
    assert_each_as_alone(systems, motions, **steps)
    # the first of them must have been in contact for this to say anything
    peaks = wr.simulate(systems[0], motions[0], **steps).peaks
    assert min(mount.deflection.minimum[2] for mount in peaks.mounts.values()) < -0.03556  # rated travel: there the stops are
    assert peaks.struck


@pytest.mark.parametrize("name", ["shock_table", "shock_table_frame"])
def test_velocity_steps_and_pulses_of_several_levels_share_one_grid(name):
    """The frame rides on the table: where its table's velocity jumps, it keeps its momentum, in these variants only."""
    system = wr.load_system(models_folder() / f"{name}.xml")
    motions = [
        wr.VelocityStep(velocity=0.5, direction="z", start=0.0213),
        half_sine(10.0),
        wr.VelocityStep(velocity=1.0, direction="z", start=0.0213),
        half_sine(20.0, start=0.0144) + wr.VelocityStep(velocity=-0.3, direction="z", start=0.05),
        half_sine(5.0, "z"),
    ]
    keywords = {**STEPS, "timestep": 2e-4}
    assert_each_as_alone([system] * len(motions), motions, **keywords)


def test_corners_of_others_leave_a_motion_smooth():
    """Where only another variant's motion has a corner, a step ends, and the parabola through a peak is still drawn."""
    system, motion = house.sdof(wr.KelvinVoigt(k=3.5 * (2.0 * np.pi * 12.0) ** 2, c=20.0)), half_sine(10.0, "z", 0.0)
    fine = wr.simulate(system, motion, duration=0.1, timestep=1e-4).peaks.bodies["mass"].acceleration
    corners = fine.time + np.array([-1.4e-3, -0.4e-3, 0.6e-3])
    keywords = {"duration": 0.1, "timestep": 1e-3, "sample_rate": 10.0}
    cut = wr.simulate(system, motion, corners=corners, **keywords).peaks.bodies["mass"].acceleration
    # A parabola over 2 ms of 12 Hz errs by about (omega h)^4 / 64 = 5e-7; without it the peak is read 0.4 ms beside: 4.5e-4.
    assert cut.value == pytest.approx(fine.value, rel=1e-5)


def test_long_motions_of_every_kind_are_evaluated_alike_in_blocks(monkeypatch):
    """Sums over lines are matrix products, whose rounding depends on how many instants are asked for at once."""
    monkeypatch.setattr("wirerope_mj.engine.simulation.grid.BLOCK", 60)
    monkeypatch.setattr("wirerope_mj.engine.simulation.stages.POINTS", 100)
    system = wr.load_system(models_folder() / "shock_table.xml")
    density = [(5.0, 1.0), (100.0, 1.0)]
    noise = wr.RandomVibration(psd=density, duration=0.5, seed=3, direction="z")
    motions = [
        noise,
        wr.Sweep(start=20.0, stop=40.0, rate=300.0, acceleration=5.0, direction="x"),
        wr.Scaled(noise, 0.5),
        wr.Sine(frequency=13.0, acceleration=3.0, direction="y") + half_sine(3.0, start=0.05),
    ]
    assert_each_as_alone([system] * 4, motions, **STEPS)


def test_a_failing_variant_says_what_it_says_alone_and_stops_no_other():
    system = wr.load_system(models_folder() / "sdof_shaker.xml")
    (name,) = system.payloads
    motions = [half_sine(level, "z") for level in (10.0, 1e7, 20.0)]
    results = wr.simulate_batch(system, motions, **STEPS)
    with pytest.raises(wr.SimulationError) as alone:
        wr.simulate(system, motions[1], corners=all_corners(motions), **STEPS)
    assert isinstance(results[1], wr.BatchFailure)
    assert results[1].message == str(alone.value)
    for place in (0, 2):
        assert_same(results[place], wr.simulate(system, motions[place], corners=all_corners(motions), **STEPS))
    assert results[2].peaks.bodies[name].acceleration.value > results[0].peaks.bodies[name].acceleration.value


def test_a_variant_without_equilibrium_and_one_too_stiff_carry_their_messages():
    law = wr.BoucWen(**house.hysteresis(alpha=2e4, z_max=100.0), k=2e4)
    systems = [
        house.sdof(law, gravity=G),
        house.sdof(dataclasses.replace(law, k=0.0), mass=30.0, gravity=G),
        house.sdof(dataclasses.replace(law, k=1e9), gravity=G),
    ]
    good, fallen, stiff = wr.simulate_batch(systems, half_sine(1.0), **STEPS)
    assert isinstance(good, wr.BatchResult)
    assert isinstance(fallen.error, wr.ConvergenceError)
    assert "m1" in fallen.message
    assert isinstance(stiff.error, wr.SimulationError)
    assert "too large" in stiff.message
    (sideways,) = wr.simulate_batch(systems[0], half_sine(1.0, "x"), **STEPS)
    assert isinstance(sideways.error, wr.ModelError)


def test_results_do_not_depend_on_threads_or_company():
    systems = [model("shock_table", stiffer=factor) for factor in (1.0, 1.1, 1.2, 1.3, 1.4)]
    motions = [half_sine(level) for level in (5.0, 10.0, 15.0, 20.0)] + [half_sine(7.0, start=0.0123)]
    one = wr.simulate_batch(systems, motions, threads=1, **STEPS)
    three = wr.simulate_batch(systems, motions, threads=3, **STEPS)
    corners = all_corners(motions)
    parts = [
        *wr.simulate_batch(systems[:2], motions[:2], corners=corners, **STEPS),
        *wr.simulate_batch(systems[:1:-1], motions[:1:-1], corners=corners, **STEPS)[::-1],
    ]
    for a, b, c in zip(one, three, parts, strict=True):
        assert a.peaks.to_dict() == b.peaks.to_dict() == c.peaks.to_dict()
        np.testing.assert_array_equal(a.final_state.values, b.final_state.values)
        np.testing.assert_array_equal(a.final_state.values, c.final_state.values)


def test_masses_changed_in_a_compiled_model_are_the_variant_s_own():
    """A mass of twice the weight on springs twice as stiff moves alike: numbers of one variant do not leak into another."""
    spring = wr.KelvinVoigt(k=3.5 * (2.0 * np.pi * 10.0) ** 2, c=30.0)
    double = wr.KelvinVoigt(k=2.0 * spring.k, c=2.0 * spring.c)
    systems = [house.sdof(spring), house.sdof(double, mass=7.0), house.sdof(spring, mass=7.0)]
    alike, heavy, soft = (
        result.peaks.bodies["mass"].acceleration.value for result in wr.simulate_batch(systems, half_sine(10.0), **STEPS)
    )
    assert heavy == pytest.approx(alike, rel=1e-12)  # rounding alone
    assert soft < 0.9 * alike


def test_a_batch_goes_on_from_the_states_of_another():
    system = wr.load_system(models_folder() / "shock_table.xml")
    motions = [half_sine(10.0), half_sine(20.0)]
    first = wr.simulate_batch(system, motions, **{**STEPS, "duration": 0.1})
    states = [result.final_state for result in first]
    second = wr.simulate_batch(system, motions, initial=states, **{**STEPS, "duration": 0.1})
    for motion, state, result in zip(motions, states, second, strict=True):
        assert_same(result, wr.simulate(system, motion, initial=state, **{**STEPS, "duration": 0.1}))
    with pytest.raises(ValueError, match="one instant, got 0 s and 0.1 s"):
        wr.simulate_batch(system, motions, initial=["settled", states[1]], **STEPS)


def test_interpreted_callbacks_take_the_variants_one_by_one(monkeypatch):
    system = wr.load_system(models_folder() / "sdof_shaker.xml")
    keywords = {**STEPS, "duration": 0.02, "timestep": 1e-3}
    monkeypatch.setattr("wirerope_mj.engine.control.install.disagreement", lambda model, data: "qvel")
    with pytest.warns(RuntimeWarning, match="slower Python callback"):
        (result,) = wr.simulate_batch(system, half_sine(10.0), engine="mujoco", **keywords)
    assert_same(result, wr.simulate(system, half_sine(10.0), callback="python", **keywords))


def test_base_motion_is_the_peak_of_what_is_fixed_to_the_base():
    system = wr.load_system(models_folder() / "shock_table.xml")
    low, high = wr.simulate_batch(system, [half_sine(10.0), half_sine(30.0)], **STEPS)
    # the closed form's peak, seen through a parabola of half steps: (omega h / 2)^4 / 64 of it
    assert low.peaks.bodies["table"].acceleration.value == pytest.approx(10.0 * G, rel=1e-4)
    assert high.peaks.bodies["table"].acceleration.value == pytest.approx(30.0 * G, rel=1e-4)


def test_systems_of_another_layout_are_named():
    systems = [wr.load_system(models_folder() / f"{name}.xml") for name in ("shock_table", "cabinet")]
    with pytest.raises(wr.ModelError, match=r"`systems\[1\]` has another layout than `systems\[0\]` \(.*\bnv\b.*mounts differ"):
        wr.simulate_batch(systems, half_sine(1.0), **STEPS)


@pytest.mark.filterwarnings("ignore::wirerope_mj.AccuracyWarning")  # stops are struck on purpose
def test_numbers_of_contacts_and_gravity_are_a_variant_s_own():
    """A model whose only difference is a number of its contacts is not taken for the same."""
    system = wr.load_system(models_folder() / "shock_table_contacts.xml")
    twin = wr.load_system(models_folder() / "shock_table_contacts.xml")
    twin.model.pair_solref[:] *= 2.0
    twin.model.opt.gravity[2] *= 0.5
    motions = [half_sine(60.0)] * 2
    results = wr.simulate_batch([system, twin], motions, **STEPS)
    assert_same(results[1], wr.simulate(twin, motions[0], **STEPS))
    assert results[0].peaks.to_dict() != results[1].peaks.to_dict()


@pytest.mark.parametrize(
    ("changes", "message"),
    [
        ({"timestep": 0.0}, "`timestep` must be > 0, got 0.0"),
        ({"duration": -1.0}, "`duration` must be > 0, got -1.0"),
        ({"threads": 0}, "`threads` must be an integer >= 1, got 0"),
        ({"threads": 1.5}, "`threads` must be an integer >= 1, got 1.5"),
        ({"corners": [np.nan]}, "`corners` must be finite instants"),
        ({"initial": "afloat"}, "`initial` must be 'settled', 'relaxed', 'unloaded' or a State, got 'afloat'"),
        ({"initial": ["settled"] * 3}, "must hold one each or equally many, got {'motions': 2, 'initial': 3}"),
    ],
)
def test_arguments_out_of_range_are_named(changes, message):
    system = wr.load_system(models_folder() / "sdof_shaker.xml")
    with pytest.raises(ValueError, match=message.replace("[", r"\[")):
        wr.simulate_batch(system, [half_sine(1.0)] * 2, **{**STEPS, **changes})


def test_no_variants_are_no_results():
    assert wr.simulate_batch([], half_sine(1.0), **STEPS) == []


def test_callbacks_are_gone_after_a_batch():
    system = wr.load_system(models_folder() / "sdof_shaker.xml")
    wr.simulate_batch(system, half_sine(1.0), **{**STEPS, "duration": 0.01})
    assert mujoco.get_mjcb_control() is None


def test_a_variant_that_mujoco_gives_up_stops_no_other(tmp_path):
    """Little memory holds the state of a block in the air, and not its contacts."""
    text = (
        (models_folder() / "shock_table_contacts.xml")
        .read_text(encoding="utf-8")
        .replace("<option", '<size memory="3K"/><option', 1)
    )
    isolators = wr.load_system(models_folder() / "shock_table_contacts.xml").isolators
    system = wr.load_system(text, isolators=isolators)
    good, bad = wr.simulate_batch(system, [half_sine(1.0), half_sine(100.0)], **STEPS)
    assert_same(good, wr.simulate(system, half_sine(1.0), **STEPS))
    assert isinstance(bad.error, wr.SimulationError)
    said = r"model 'shock_table_contacts': MuJoCo gave up: mj_stackAlloc: out of memory.*write <size memory="
    assert re.search(said, bad.message)
    with pytest.raises(wr.SimulationError, match=r"write <size memory="):
        wr.simulate(system, half_sine(100.0), **STEPS)


def test_models_that_sleep_are_what_they_are_alone():
    isolators = {"a": wr.Isolator(name="a", axial=wr.KelvinVoigt(k=2e4, c=20.0))}
    text = house.sdof_text().replace("<mujoco>", '<mujoco><option><flag sleep="enable"/></option>')
    system = wr.load_system(text, isolators=isolators)
    motions = [half_sine(1.0), half_sine(2.0)]
    assert_each_as_alone([system] * 2, motions, **STEPS)


def test_slides_that_do_not_start_at_zero_are_placed_from_where_they_start():
    text = house.sdof_text().replace('name="deck_z"', 'name="deck_z" ref="0.4"')
    spring = wr.KelvinVoigt(k=2e4, c=20.0)
    systems = [wr.load_system(text, isolators={"a": wr.Isolator(name="a", axial=spring)}), house.sdof(spring)]
    # one layout, another place of the same deck: each variant has its own
    assert systems[0].model.qpos0[0] == 0.4
    assert_each_as_alone(systems, [half_sine(1.0), half_sine(2.0)], **STEPS)
