"""Runs that end before their peaks are over judge nothing; histories that alias, steps that tell nothing and spectra say so."""

import json
import math
import re
import warnings
from dataclasses import replace

import numpy as np
import pytest
from house import sdof

import wirerope_mj as wr
from wirerope_mj.assessment.criteria import headline, judge, judge_random
from wirerope_mj.assessment.criteria.ended import GROWS, too_short
from wirerope_mj.assessment.criteria.summary import mount_peaks
from wirerope_mj.cli import main
from wirerope_mj.engine.response.histories import SENSITIVE
from wirerope_mj.foundation.payload_limits import PayloadLimit
from wirerope_mj.motions.spectra.srs import resolved_frequency

pytestmark = pytest.mark.filterwarnings("ignore:the given step of")  # what is asked here holds at coarse steps

G = wr.STANDARD_GRAVITY
PULSE = wr.HalfSine(peak=15.0 * G, duration=0.011, direction="z")


@pytest.fixture(scope="module")
def cabinet():
    return wr.load_system("cabinet")


def judged(system, motion, duration, limits=None, **options):
    response = wr.simulate(system, motion, duration=duration, **options)
    return response, judge(response, limits)


@pytest.mark.slow
def test_a_run_that_ends_inside_the_answer_is_not_judged_and_longer_ones_agree(cabinet):
    whole_run, reference = judged(cabinet, PULSE, 3.0)
    least = np.ceil(1e3 * (0.011 + 2.0 * whole_run.numerics.slowest_period))  # [ms]
    for duration in (0.005, 0.012, 0.05, 0.1, 0.15, 0.2, 0.3, 0.6, 1.0):
        response, verdicts = judged(cabinet, PULSE, duration)
        for row, whole in zip(verdicts, reference, strict=True):
            if row.utilisation is not None:
                assert row.verdict == whole.verdict
                assert row.utilisation == pytest.approx(whole.utilisation, abs=0.01)
        if 1e3 * duration < least:
            assert f"the run ends at {1e3 * duration:.4g} ms, before its peaks are over" in headline(verdicts)
            assert headline(verdicts).startswith("NOT JUDGED: ")
            assert f"run at least {least:.0f} ms" in headline(verdicts)
            assert all(row.utilisation is None for row in mount_peaks(response))
        else:
            assert headline(verdicts) == headline(reference)


def test_what_is_exceeded_already_is_said(cabinet):
    limit = PayloadLimit(kind="acceleration", name="rack", values=(0.5,))
    _, verdicts = judged(cabinet, PULSE, 0.03, [limit])
    assert re.match(r"FAIL: rack .*; 1 of \d+ checks exceeded; ", headline(verdicts))
    assert "the run ends at 30 ms" in headline(verdicts)


def test_what_creeps_on_under_a_sine_is_not_judged(cabinet):
    """Sag grows by 0.5 % of the travel in the last third of 0.415 s, by 1.5 % until 1.2 s and by 3 % until 4 s."""
    response, verdicts = judged(cabinet, wr.Sine(frequency=35.67, acceleration=0.4541 * G, direction="x"), 0.415, accuracy=1e-3)
    travel = next(row for row in verdicts if row.criterion.kind == "travel" and row.subject == "m01")
    assert travel.time > 0.3
    assert "the motion still grows when the run ends" in travel.note


@pytest.mark.quick
def test_a_sine_without_end_is_judged_when_it_grows_no_more():
    system = sdof(wr.KelvinVoigt(k=3.5 * (2 * math.pi * 10.0) ** 2, c=2 * 0.02 * 3.5 * 2 * math.pi * 10.0))
    resonant = wr.Sine(frequency=10.0, acceleration=1.0, direction="z")
    limits = [PayloadLimit(kind="acceleration", name="mass", values=(100.0,))]
    found = []
    for duration in (0.3, 0.8, 1.5, 3.0, 6.0):
        _, verdicts = judged(system, resonant, duration, limits)
        row = next(row for row in verdicts if row.criterion == "acceleration" and row.subject == "mass")
        found.append(row.utilisation)
        if row.utilisation is None:
            expected = "the run ends at 300 ms, before" if duration == 0.3 else "the motion still grows when the run ends"
            assert expected in row.note
            assert ("still grow" in headline(verdicts)) == (duration != 0.3)
    assert found[:2] == [None, None]
    # 1 / (2 zeta) = 25 m/s^2, absolute: sqrt(1 + 4 zeta^2) of it
    assert found[-1] == pytest.approx(0.25 * math.sqrt(1 + 4 * 0.02**2), rel=1e-3)
    assert all(used == pytest.approx(found[-1], abs=0.01) for used in found if used is not None)


@pytest.mark.quick
def test_sweeps_and_random_vibration_are_judged_when_they_have_been_run_through():
    system = sdof(wr.KelvinVoigt(k=4e4, c=120.0))
    sweep = wr.Sweep(start=5.0, stop=40.0, rate=120.0, acceleration=1.0, direction="z")
    random = wr.RandomVibration(psd=[(5.0, 1.0), (100.0, 1.0)], duration=4.0, rise=0.5, fall=0.5, direction="z", seed=1)
    for motion, whole in ((sweep, sweep.duration), (random, 3.5)):
        for duration in (0.5 * whole, whole, whole + 1.0):
            response = wr.simulate(system, motion, duration=duration, timestep=1e-3)
            assert bool(too_short(response)) == (duration < whole)
    older = replace(response, numerics=replace(response.numerics, motion_end=math.nan, slowest_period=math.nan))
    assert too_short(older) == ""


@pytest.mark.quick
def test_a_motion_faster_than_the_samples_is_warned_of_and_the_files_say_what_they_hold(tmp_path):
    system = sdof(wr.KelvinVoigt(k=4e4, c=120.0))
    fast = wr.Sine(frequency=5000.0, acceleration=5.0 * G, direction="z")
    with pytest.warns(wr.AccuracyWarning, match=r"5000 Hz, and 1000 samples a second tell nothing above 500 Hz"):
        wr.simulate(system, fast, duration=0.02)
    scenario = wr.Scenario(
        question="?", model=system.mjcf, motion=PULSE, simulate={"duration": 0.5}, isolators=system.isolators
    )
    wr.run_scenario(scenario, tmp_path / "run")
    content = json.loads((tmp_path / "run" / "summary.json").read_text(encoding="utf-8"))
    assert content["numerics"]["samples_hold"].startswith("1000 samples a second tell nothing above 500 Hz")
    assert "tell nothing above 500 Hz" in (tmp_path / "run" / "report.html").read_text(encoding="utf-8")


@pytest.mark.quick
@pytest.mark.filterwarnings("ignore:the base moves at up to 100 Hz")
def test_rms_values_of_too_few_samples_are_not_judged():
    system = sdof(wr.KelvinVoigt(k=4e4, c=120.0))
    random = wr.RandomVibration(psd=[(5.0, 1.0), (100.0, 1.0)], duration=8.0, direction="z", seed=1)
    limits = [PayloadLimit(kind="acceleration", name="mass", values=(1000.0,))]
    found = {}
    for rate in (1000.0, 400.0, 50.0):
        response = wr.simulate(system, random, duration=8.0, sample_rate=rate, timestep=5e-4)
        found[rate] = next(row for row in judge_random(response, limits=limits, discard=1.0) if "rms" not in row.criterion)
    assert found[400.0].value == pytest.approx(found[1000.0].value, rel=0.01)
    assert found[50.0].verdict == "not judged"
    assert found[50.0].note.startswith("sampled at 50 Hz, and the vibration reaches up to 100 Hz")


@pytest.mark.quick
def test_no_step_is_taken_for_exact_because_samples_cut_its_double_alike():
    table = wr.load_system("shock_table")
    pulse = wr.HalfSine(peak=150.0, duration=0.011, direction="z", start=0.05)
    response = wr.simulate(table, pulse, duration=1.0, sample_rate=2000.0)
    fine = wr.simulate(table, pulse, duration=1.0, sample_rate=2000.0, timestep=response.timestep / 4)
    true = abs(response.peaks.mounts["m1"].force.value / fine.peaks.mounts["m1"].force.value - 1.0)
    assert 0.0 < true <= response.estimated_error <= 1e-4
    nothing = replace(response.numerics, error_estimate=math.nan)
    assert nothing.error_text == "no error estimated: halving the step changes nothing"
    assert replace(nothing, accuracy=math.nan).error_text == "step given: no error estimated"
    spread = replace(response.numerics, limited_by=SENSITIVE, error_estimate=0.02)
    assert spread.error_text == "sensitive: runs with finer steps differ by up to 2.0e-02 of the peaks"


@pytest.mark.quick
def test_samples_hold_a_spectrum_up_to_where_every_other_one_gives_the_same(tmp_path, capsys):
    spectra = {}
    for rate in (20_000.0, 1000.0, 200.0):
        time = np.arange(0.0, 1.0, 1.0 / rate)
        pulse = np.where(time < 0.011, 100.0 * np.sin(np.pi * time / 0.011), 0.0)
        spectra[rate] = wr.shock_response_spectrum(time, pulse, np.geomspace(2.0, rate / 10.0, 60))
        spectra[rate, "held"] = resolved_frequency(time, pulse, spectra[rate])
    exact = spectra[20_000.0]
    assert spectra[1000.0, "held"] > 20.0 >= 20.0 * (spectra[200.0, "held"] <= 10.0)
    for rate in (1000.0, 200.0):
        own = spectra[rate]
        low = own.frequencies <= spectra[rate, "held"]
        expected = np.interp(own.frequencies[low], exact.frequencies, exact.maximax)
        np.testing.assert_allclose(own.maximax[low], expected, rtol=0.013)  # 1 %, and what the grid's straight lines cost
    system = sdof(wr.KelvinVoigt(k=4e4, c=120.0))
    wr.simulate(system, PULSE, duration=0.5).save(tmp_path / "run")
    assert main(["export", str(tmp_path / "run"), str(tmp_path / "s.csv"), "--spectrum", "mass"]) == 0
    assert "1000 samples a second hold it within 1 % up to " in capsys.readouterr().out


def test_a_run_that_hits_an_undamped_stop_has_an_estimate_that_holds_or_is_called_sensitive():
    """Strong sines against stiff stops: two steps may agree by luck; a third tells."""
    rng = np.random.default_rng(3)
    for _ in range(4):
        frequency = rng.uniform(5.0, 15.0)
        law = wr.Parallel(
            laws=(
                wr.KelvinVoigt(k=3.5 * (2 * math.pi * frequency) ** 2, c=1.0),
                wr.Stop(gap_below=rng.uniform(2e-3, 8e-3), gap_above=rng.uniform(2e-3, 8e-3), k=10 ** rng.uniform(5.0, 6.0)),
            )
        )
        system, motion = sdof(law), wr.Sine(frequency=frequency, acceleration=15.0, direction="z")
        with warnings.catch_warnings(action="ignore"):  # that it is sensitive
            response = wr.simulate(system, motion, duration=0.6)
        assert response.peaks.struck
        spread = [response.peaks.bodies["mass"].acceleration.value]
        spread += [
            wr.simulate(system, motion, duration=0.6, timestep=response.timestep / parts)
            .peaks.bodies["mass"]
            .acceleration.value
            for parts in (2, 3)
        ]
        assert np.ptp(spread) / spread[-1] <= max(response.estimated_error, 1e-12)


@pytest.mark.slow
def test_what_a_strong_shock_passes_on_to_rocking_is_not_judged_before_it_peaks():
    """The floor rocks long after two slowest periods of small amplitudes: at 0.4 s its mounts have not yet sheared most."""
    system = wr.load_system("floating_floor")
    shock = wr.Trapezoid(peak=14.31 * G, duration=0.02088, rise=0.002088, direction="z", start=0.0439)
    short, long = (
        {(row.subject, row.criterion): row for row in judge(wr.simulate(system, shock, duration=d, timestep=5e-4))}
        for d in (0.405, 1.2)
    )
    grown = [key for key, row in short.items() if row.utilisation and long[key].utilisation > row.utilisation + 0.01]
    assert not grown
    assert sum(row.note.startswith(GROWS) for row in short.values()) >= 20
    assert not any(row.note.startswith(GROWS) for row in long.values())
