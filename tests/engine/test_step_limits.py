"""What limits a step, and that refining ends where it does not pay."""

import warnings
from dataclasses import replace
from types import SimpleNamespace

import numpy as np
import pytest

import wirerope_mj as wr
from wirerope_mj.cli import main
from wirerope_mj.engine.response.histories import SENSITIVE
from wirerope_mj.engine.simulation import timestep as module
from wirerope_mj.engine.simulation.timestep import (
    ACCURACY,
    CONTACTS,
    CORNERS,
    GIVEN,
    SAMPLES,
    STABILITY,
    choose_timestep,
)
from wirerope_mj.foundation.resources import models_folder
from wirerope_mj.runs.scenario import Scenario, load_scenario

pytestmark = pytest.mark.quick

G = wr.STANDARD_GRAVITY


@pytest.fixture(scope="module")
def table():
    return wr.load_system(models_folder() / "shock_table_contacts.xml")


def pulse_record(path):
    """Write a half-sine of 1 g, sampled at 4 kHz."""
    time = np.arange(400) / 4000.0
    values = np.where((time > 0.02) & (time < 0.04), np.sin(np.pi * (time - 0.02) / 0.02), 0.0)
    np.savetxt(path, np.column_stack([time, values]), delimiter=",", header="time [s],z [g]", comments="", fmt="%.9g")


def choice(system, errors, monkeypatch, accuracy=1e-4):
    """Return what is chosen from 1 ms on if the pilots touch and differ by `errors`, halving by halving, and the pilots."""
    tried = []

    def pilot(*arguments):
        tried.append(arguments[-1])
        run = SimpleNamespace(steps=round(0.2 / arguments[-1]))
        return SimpleNamespace(touches=True, hits=False, run=run, rows=np.zeros(0))

    monkeypatch.setattr(module._Pilots, "_run_pilot", pilot)
    differences = iter(errors)
    monkeypatch.setattr(module, "_difference", lambda *_: next(differences) / module.RICHARDSON)
    start = wr.equilibrium(system).state
    motion = wr.HalfSine(peak=G, duration=0.011, direction="z", start=0.01)
    chosen = choose_timestep(system, motion, start, duration=0.2, sample_rate=1000.0, accuracy=accuracy)
    return chosen, tried


# Differences as they were measured: a block that just reaches its stops under a record (the step fell to a sixteenth, and
# the error stayed above what was asked), one that strikes them, and one whose errors do fall as they should.
@pytest.mark.parametrize(
    ("errors", "halvings", "error", "pilots"),
    [
        ([3.0e-2, 3.2e-3, 9.6e-4, 3.4e-3, 2.4e-4], 2, 9.6e-4, 4),
        ([7.3e-3, 1.2e-3, 5.8e-4, 3.1e-4, 4.6e-4], 2, 5.8e-4, 4),
        (
            [3.4e-3, 5.2e-3, 8.0e-3, 4.0e-3, 2.0e-3],
            0,
            8.0e-3,
            4,
        ),  # the best, but what finer ones differ by is its error
        ([1.9e-2, 3.1e-3, 1.5e-3, 2.3e-3, 3.9e-4], 2, 2.3e-3, 5),  # 1.5e-3 could still have become 1e-3
        ([1.3e-3, 6.0e-4, 3.1e-4, 1.2e-4, 6.8e-5], 4, 6.8e-5, 6),  # within reach: to the end
        ([np.inf, np.inf, np.inf, 3.0e-2, 3.2e-3, 9.6e-4], 5, 9.6e-4, 7),  # the first three fail: they teach nothing
    ],
)
def test_refining_in_contact_ends_where_the_accuracy_is_out_of_reach(table, monkeypatch, errors, halvings, error, pilots):
    chosen, tried = choice(table, errors, monkeypatch)
    assert chosen.timestep == pytest.approx(tried[0] / 2**halvings, rel=1e-12)
    assert chosen.error == pytest.approx(error, rel=1e-12)
    assert len(tried) == pilots
    grows = error > 0.5 * errors[0]
    assert chosen.limited_by == (ACCURACY if error <= 1e-4 else SENSITIVE if grows else CONTACTS)


@pytest.mark.parametrize(
    ("difference", "before", "coarse", "fine"),
    [
        (3.0, np.nan, 6.0, 3.0),  # order 1 until a second difference is known
        (3.0, np.inf, 6.0, 3.0),
        (3.0, 6.0, 6.0, 3.0),  # seen: order 1
        (3.0, 2.0, 6.0, 3.0),  # it grows
        (2.0, 5.0, 2.0 + 2.0 / 1.5, 2.0 / 1.5),
        (3.0, 12.0, 4.5, 1.5),  # order 2, of which no more than order 1.6 is believed
        (1.0, 48.0, 5.0, 4.0),  # faster than order 2, by luck: 48 leaves 4 two halvings later
        (0.0, 12.0, 0.0, 0.0),
    ],
)
def test_errors_follow_how_a_difference_fell(difference, before, coarse, fine):
    assert module._errors(difference, before) == pytest.approx((coarse, fine), rel=1e-12)


def test_what_is_reached_and_what_was_asked_is_a_warning(table):
    with pytest.warns(wr.AccuracyWarning) as caught:
        r = wr.simulate(
            table, wr.HalfSine(peak=60 * G, duration=0.011, direction="z", start=0.05), duration=0.12, accuracy=1e-5
        )
    assert r.estimated_error > 1e-5
    said = [str(warning.message) for warning in caught]
    assert len(said) == 2
    assert f"{r.estimated_error:.1e} of the peaks, is above the accuracy asked for, 1.0e-05" in said[1]
    assert f"limited by {CONTACTS}" in said[1]
    assert "a larger `accuracy`" in said[1]
    assert "a smaller `timestep`" in said[1]
    assert r.numerics.limited_by == CONTACTS


def test_every_step_says_what_limits_it(table, tmp_path):
    motion = wr.HalfSine(peak=5 * G, duration=0.011, direction="z", start=0.05)
    limited = lambda **options: wr.simulate(table, motion, duration=0.1, **options).numerics.limited_by  # noqa: E731
    assert limited(timestep=1e-3) == GIVEN
    assert limited(accuracy=1e-2) == SAMPLES
    assert limited(accuracy=1e-2, sample_rate=50.0) in (STABILITY, ACCURACY)
    assert limited(accuracy=1e-7) == ACCURACY
    pulse_record(tmp_path / "deck.csv")
    record = wr.load_record(tmp_path / "deck.csv")
    assert wr.simulate(table, record, duration=0.1, accuracy=1e-2).numerics.limited_by == CORNERS


@pytest.fixture
def made(monkeypatch):
    """Scenarios that the commands hand over in place of simulating them."""
    found: list[Scenario] = []
    monkeypatch.setattr("wirerope_mj.runs.write_run", lambda scenario, folder, **_: found.append(scenario))
    monkeypatch.setattr("wirerope_mj.cli.tables.print_written", lambda *_, **__: None)
    return found


@pytest.fixture
def commands(tmp_path):
    """Arguments of `wirerope run` and `wirerope shock`."""
    pulse_record(tmp_path / "deck.csv")
    return [
        ["run", "shock_table"],
        ["shock", "shock_table", "--record", str(tmp_path / "deck.csv"), "--duration", "0.1"],
    ]


def test_run_and_shock_take_an_accuracy_or_a_step(made, commands):
    for command in commands:
        assert main([*command, "--accuracy", "1e-3"]) == 0
        assert main([*command, "--timestep", "2e-4"]) == 0
        by_accuracy, by_step = made[-2:]
        assert by_accuracy.simulate["accuracy"] == 1e-3
        assert "timestep" not in by_accuracy.simulate
        assert by_step.simulate["timestep"] == 2e-4
        assert "accuracy" not in by_step.simulate
        assert by_step.simulate["duration"] == by_accuracy.simulate["duration"]


def test_a_step_of_the_scenario_gives_way_to_the_accuracy_asked_for(made, tmp_path):
    text = load_scenario("shock_table").path.read_text(encoding="utf-8")
    (tmp_path / "stepped.py").write_text(text.replace("simulate={", 'simulate={"timestep": 1e-4, '), encoding="utf-8")
    assert main(["run", str(tmp_path / "stepped.py"), "--accuracy", "1e-3"]) == 0
    assert "timestep" not in made[-1].simulate
    assert main(["run", str(tmp_path / "stepped.py")]) == 0
    assert made[-1].simulate["timestep"] == 1e-4


@pytest.mark.parametrize(
    ("options", "message"),
    [
        (["--accuracy", "1e-3", "--timestep", "1e-4"], "`--accuracy` and `--timestep` exclude each other"),
        (["--accuracy", "0"], "`--accuracy` is a fraction of the peaks, above 0 and below 1, got 0."),
        (["--accuracy", "2"], "`--accuracy` is a fraction of the peaks, above 0 and below 1, got 2."),
        (["--accuracy", "nan"], "above 0 and below 1, got nan."),
        (["--timestep", "-1"], "`--timestep` must be > 0 [s], got -1.0."),
        (["--timestep", "inf"], "`--timestep` must be a finite number"),
    ],
)
def test_what_is_no_accuracy_and_no_step_is_refused(made, commands, capsys, options, message):
    for command in commands:
        assert main([*command, *options]) == 2
        said = capsys.readouterr().err
        assert message in said
        assert said.count("\n") == 1
    assert made == []


def test_what_never_ends_is_refused_with_the_number_of_steps(table):
    motion = wr.HalfSine(peak=10.0, duration=0.011, direction="z")
    with pytest.raises(wr.SimulationError, match=r"`timestep` of 1e-12 s makes 5\.0e\+10 steps of 0\.05 s"):
        wr.simulate(table, motion, duration=0.05, timestep=1e-12)
    with pytest.raises(ValueError, match=r"`accuracy` must be at least 1e-15, got 1e-300"):
        wr.simulate(table, motion, duration=0.05, accuracy=1e-300)


def test_a_given_step_longer_than_the_sample_interval_does_not_limit(table):
    motion = wr.HalfSine(peak=10.0, duration=0.011, direction="z")
    response = wr.simulate(table, motion, duration=0.05, timestep=2e-3, sample_rate=1000.0)
    assert response.numerics.limited_by == "the sample interval"
    assert response.timestep == pytest.approx(1e-3, rel=1e-9)


@pytest.mark.parametrize(("timestep", "asked"), [(5e-4, True), (1e-4, False)])
def test_a_given_step_in_which_friction_yields_is_held_against_half_of_it(timestep, asked):
    """At 0.5 ms the friction of 0.1 mm of this mount yields within a step: accelerations are off by 1 %, at 0.1 ms by 1e-6."""
    system = wr.load_system("shock_table")
    motion = wr.HalfSine(peak=10.0 * G, duration=0.011, direction="x")
    fine = wr.simulate(system, motion, duration=0.3, sample_rate=2000.0, timestep=5e-5)
    assert np.isnan(fine.numerics.error_estimate)  # nothing yields in such a step
    with warnings.catch_warnings(record=True) as caught:
        warnings.simplefilter("always")
        run = wr.simulate(system, motion, duration=0.3, sample_rate=2000.0, timestep=timestep)
    block, true = run.bodies["block"].acceleration, fine.bodies["block"].acceleration
    error = np.abs(block - true).max() / np.abs(true).max()
    warned = [str(one.message) for one in caught if issubclass(one.category, wr.AccuracyWarning)]
    assert bool(warned) == asked == (error > 1e-3)
    if asked:
        assert error < run.numerics.error_estimate < 5.0 * error
        assert f"half of it differs by {run.numerics.error_estimate:.1e} of the peaks" in warned[0]


def said_of_a_given_step(compute):
    with warnings.catch_warnings(record=True) as caught:
        warnings.simplefilter("always")
        compute()
    return [str(one.message) for one in caught if "the given step of" in str(one.message)]


@pytest.mark.parametrize(("timestep", "times"), [(5e-4, 1), (1e-4, 0)])
def test_batches_and_studies_say_once_that_a_given_step_is_too_long_for_friction(timestep, times, tmp_path):
    motion = wr.HalfSine(peak=10.0 * G, duration=0.011, direction="x")
    asked = {"duration": 0.1, "timestep": timestep, "sample_rate": 2000.0}
    system = wr.load_system("shock_table")
    said = said_of_a_given_step(lambda: wr.simulate_batch([system] * 3, motion, **asked))
    study = wr.Study(model="shock_table", motion=motion, vary={"motion/level": wr.Uniform(0.9, 1.1)}, variants=4, **asked)
    told = said_of_a_given_step(lambda: study.run(tmp_path / "study", workers=1))
    assert len(said) == len(told) == times
    if times:
        assert 1e-3 < float(said[0].split("differs by ")[1].split(" of")[0]) < 0.1


def test_a_given_step_in_which_friction_yields_behind_brackets_is_found_too():
    """Brackets of a thousand times the mount's stiffness change next to nothing: not whether a step is too long either."""
    steel = replace(wr.load_isolator("enidine_wr12_400"), bracket=wr.Bracket(roll=2e8, shear=2e8, axial=2e8))
    motion = wr.HalfSine(peak=10.0 * G, duration=0.011, direction="x")
    found = []
    for isolators in ({}, {"wr12_400": steel}):
        system = wr.load_system("shock_table", isolators=isolators)
        with warnings.catch_warnings(record=True) as caught:
            warnings.simplefilter("always")
            run = wr.simulate(system, motion, duration=0.1, sample_rate=2000.0, timestep=5e-4)
        found.append((run.numerics.error_estimate, sum("the given step of" in str(one.message) for one in caught)))
    assert found[0][1] == found[1][1] == 1
    assert found[1][0] == pytest.approx(found[0][0], rel=0.05)  # a thousandth softer, and errors at reversals are not smooth


@pytest.mark.parametrize(("timestep", "times"), [(1e-3, 1), (5e-5, 0)])
def test_a_sweep_says_that_a_given_step_is_too_long_for_friction(timestep, times):
    system = wr.load_system("shock_table")
    asked = {"direction": "x", "payload": "block", "acceleration": 6.0, "settled": 0.1, "timestep": timestep}
    said = said_of_a_given_step(lambda: wr.stepped_sine(system, frequencies=[5.0], **asked))
    assert len(said) == times


@pytest.mark.parametrize(("length", "follows"), [(0.2, False), (60.0, True)])
def test_the_time_of_the_run_is_estimated_where_pilots_are_windows_of_it(length, follows):
    system = wr.load_system("shock_table")
    motion = wr.Sine(frequency=8.0, acceleration=1.0, direction="z", duration=length)
    said = []
    choose_timestep(
        system, motion, wr.equilibrium(system).state, duration=length, sample_rate=1000.0, accuracy=1e-4,
        progress=lambda fraction, run: said.append((fraction, run)),
    )  # fmt: skip
    assert all(0.0 < fraction <= 1.0 and (run > 0.0) == follows for fraction, run in said)
    assert said


def test_halvings_leave_a_quarter_of_an_error_each():
    found = [module._halvings(error, 1e-4) for error in (0.0, 9e-5, 3.9e-4, 4.1e-4, np.inf)]
    assert found == [0, 0, 1, 2, module.HALVINGS]
