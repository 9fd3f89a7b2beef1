"""Random vibration judged: a linear oscillator on white noise (Miles), and what the settling and the length do."""

import math

import numpy as np
import pytest
from house import sdof
from scipy.signal import lfilter

import wirerope_mj as wr
from wirerope_mj.assessment.criteria import judge_random, random_verdicts
from wirerope_mj.cli import main
from wirerope_mj.foundation.payload_limits import PayloadLimit
from wirerope_mj.motions import motion_from_dict
from wirerope_mj.runs.write import read_summary

RATE, F, Q, DENSITY = 1000.0, 20.0, 10.0, 0.5
MILES = math.sqrt(0.5 * math.pi * F * Q * DENSITY)  # 12.5 m/s^2


def oscillator(seconds, *, seed=3, base=None):
    """Return time and absolute acceleration of an oscillator on a base, by default of a one-sided white density, from rest."""
    size = int(seconds * RATE)
    x = math.sqrt(0.5 * RATE * DENSITY) * np.random.default_rng(seed).normal(size=size) if base is None else base
    w, z = 2.0 * np.pi * F, 0.5 / Q
    wd = w * np.sqrt(1.0 - z * z)
    e, k = np.exp(-z * w / RATE), wd / RATE
    c, s = e * np.cos(k), e * np.sin(k) / k
    return np.arange(size) / RATE, lfilter([1.0 - s, 2.0 * (s - c), e * e - s], [1.0, -2.0 * c, e * e], x)


def test_an_oscillator_is_judged_by_three_times_the_rms_of_miles():
    time, y = oscillator(300.0)
    # 2 % above and below what Miles says for sure: four standard errors 1/(2 sqrt(2 pi zeta f T)) = 1.2 %
    for limit, word in ((3.0 * MILES * 1.06, "within"), (3.0 * MILES * 0.94, "exceeded")):
        rms, three, largest = random_verdicts(time, y, subject="rack", discard=2.0, limit=limit, rms_limit=limit / 3.0)
        assert rms.value == pytest.approx(MILES, rel=0.05)
        assert three.value == 3.0 * rms.value
        assert rms.verdict == three.verdict == word
        assert largest.criterion == "largest acceleration"
        assert largest.verdict == "exceeded"  # five minutes reach 4.4 sigma


def test_the_certainty_is_stated_and_shrinks_with_the_root_of_the_length():
    found = {}
    for seconds in (52.0, 202.0):
        rms, _, _ = random_verdicts(*oscillator(seconds), subject="rack", discard=2.0, resolution=0.5)
        assert f"{seconds - 2.0:g} s of a bandwidth of" in rms.note
        found[seconds] = float(rms.note.split()[2])
    exact = 100.0 * 0.5 / math.sqrt(math.pi / Q * F * 50.0)  # B = 2 pi zeta f = pi f / Q: 2.8 %
    assert found[52.0] == pytest.approx(exact, rel=0.2)  # two digits, and half a hertz of blur on a peak of 2 Hz
    assert found[202.0] == pytest.approx(0.5 * exact, rel=0.2)


@pytest.mark.parametrize("amplitudes", ["fixed", "random"])
def test_the_error_that_is_said_is_the_scatter_from_seed_to_seed(amplitudes):
    """Fixed amplitudes leave sqrt(1 - t/T) of a Gaussian's scatter: 24 of 30 s, less than half."""
    psd = [(5.0, DENSITY), (100.0, DENSITY)]
    found, stated = [], []
    for seed in range(40):
        motion = wr.RandomVibration(psd=psd, duration=30.0, seed=seed, direction="z", rise=2.0, fall=2.0, amplitudes=amplitudes)
        time = np.arange(30_000) / RATE
        _, y = oscillator(30.0, base=motion.acceleration(time)[:, 2])
        rms, _, _ = random_verdicts(
            time, y, subject="rack", discard=4.0, end=28.0, fixed_over=30.0 if amplitudes == "fixed" else None
        )
        found.append(rms.value)
        stated.append(float(rms.note.split()[2]))
    # The scatter of 40 values is known to 11 %: three of those; the bandwidth's tenth counts half.
    assert np.std(found) / np.mean(found) == pytest.approx(0.01 * np.mean(stated), rel=0.4)
    assert ("in Gaussian vibration" in rms.note) == (amplitudes == "fixed")


def test_the_largest_value_is_compared_with_what_a_gaussian_reaches():
    """N = 2 f T half waves: sqrt(2 ln N) + 0.577 / sqrt(2 ln N) sigma; the scatter about it is pi / sqrt(12 ln N)."""
    time, y = oscillator(300.0)
    _, _, largest = random_verdicts(time, y, subject="rack", discard=2.0)
    sigmas, expected = float(largest.note.split()[0]), float(largest.note.split("reach ")[1].split(";")[0])
    c = math.sqrt(2.0 * math.log(2.0 * F * 298.0))
    assert expected == pytest.approx(c + 0.5772 / c, rel=0.03)  # the mean frequency of the response is above 20 Hz
    assert sigmas == pytest.approx(expected, abs=3.0 * math.pi / math.sqrt(6.0) / c)
    assert y[round(largest.time * RATE)] == pytest.approx(math.copysign(largest.value, y[round(largest.time * RATE)]), rel=0.02)
    assert largest.verdict == "not judged"


def test_what_is_before_the_settling_does_not_count():
    time, y = oscillator(60.0)
    loud = np.where(time < 10.0, 50.0 * y, y)
    found = random_verdicts(time, loud, subject="rack", discard=10.0)
    same = random_verdicts(time[10000:], y[10000:], subject="rack", discard=0.0)
    assert [v.value for v in found] == pytest.approx([v.value for v in same])
    assert found[2].time == pytest.approx(same[2].time)


def test_a_run_is_judged_along_the_axes_in_which_it_moves():
    system = sdof(wr.KelvinVoigt(k=4000.0, c=20.0), mass=3.5)
    response = wr.simulate(
        system, wr.Sine(frequency=4.0, acceleration=5.0, direction="z"), duration=3.0, timestep=1e-3, sample_rate=500.0
    )
    found = judge_random(response, discard=1.0, limits=[PayloadLimit(kind="acceleration", name="mass", values=(0, 0, 90.0))])
    assert [(v.subject, v.criterion) for v in found] == [
        ("mass", f"{what} acceleration along z") for what in ("rms", "3-sigma", "largest")
    ]
    assert [v.limit for v in found] == [None, 90.0, 90.0]
    later = response.time >= 1.0
    assert found[0].value == pytest.approx(response.bodies["mass"].acceleration[later, 2].std(), rel=1e-12)


def test_the_fall_of_the_vibration_and_what_follows_do_not_count():
    time, y = oscillator(40.0)
    quiet = np.where(time > 30.0, 0.1 * y, y)
    found = random_verdicts(time, quiet, subject="rack", discard=5.0, end=30.0)
    same = random_verdicts(time[:30001], y[:30001], subject="rack", discard=5.0)
    assert [v.value for v in found] == [v.value for v in same]
    assert random_verdicts(time, quiet, subject="rack", discard=5.0)[0].value < 0.9 * found[0].value
    with pytest.raises(ValueError, match=r"`end` must lie after the first instants, got -1\.0"):
        random_verdicts(time, y, subject="rack", discard=0.0, end=-1.0)


@pytest.mark.parametrize("changed", [False, True])
def test_a_run_is_judged_where_the_base_is_steady_and_the_response_has_settled(changed):
    """12 Hz with 8 %: the amplitudes decay with 6 1/s, three decay times are 0.5 s."""
    stiffness = 3.5 * (2.0 * np.pi * 12.0) ** 2
    system = sdof(wr.KelvinVoigt(k=stiffness, c=2.0 * 0.08 * math.sqrt(3.5 * stiffness)), mass=3.5)
    vibration = wr.RandomVibration(psd=[(5.0, 1.0), (100.0, 1.0)], duration=10.0, seed=2, direction="z", rise=2.0)
    motion = wr.Scaled(motion=vibration, factor=0.5) if changed else vibration
    response = wr.simulate(system, motion, duration=12.0, timestep=1e-3, sample_rate=500.0)
    rms = judge_random(response)[0]
    first, falls = vibration.steady
    history = response.bodies["mass"].acceleration[:, 2]
    settled = (response.time > first + 0.5) & (response.time < falls)
    # The width of the peak is found within some 20 %, so that 0.1 s of 6.5 s more or less count.
    assert rms.value == pytest.approx(history[settled].std(), rel=0.01)
    assert float(rms.note.split("(")[1].split(" s")[0]) == pytest.approx(falls - first - 0.5, abs=0.15)
    assert history[response.time > first].std() < 0.95 * rms.value  # what it would be with fall and rest
    assert judge_random(response, discard=3.0)[0].value == pytest.approx(
        history[(response.time >= 3.0) & (response.time <= falls)].std(), rel=1e-9
    )


def test_where_more_than_random_vibration_moves_the_base_the_beginning_is_asked_for():
    system = sdof(wr.KelvinVoigt(k=4000.0, c=20.0), mass=3.5)
    sine = wr.Sine(frequency=4.0, acceleration=5.0, direction="z")
    response = wr.simulate(system, sine, duration=0.5, timestep=1e-3, sample_rate=500.0)
    with pytest.raises(ValueError, match="`discard` must be given: the base of this run does not vibrate at random alone"):
        judge_random(response)


def test_too_short_a_record_is_refused():
    with pytest.raises(ValueError, match="too short for a density"):
        random_verdicts(*oscillator(1.0), subject="rack", discard=0.999)
    with pytest.raises(ValueError, match="one history"):
        random_verdicts([0.0, 1.0] * 0 + list(range(100)), np.ones((100, 2)), subject="rack", discard=0.0)


@pytest.mark.slow
def test_a_run_of_random_vibration_says_rms_and_three_sigma_everywhere(tmp_path, capsys):
    assert main(["run", "cabinet_random", "--duration", "3", "--out", str(tmp_path / "run"), "--all"]) == 0
    printed = capsys.readouterr().out
    assert "3-sigma" in printed
    rows = read_summary(tmp_path / "run")["random"]
    response = wr.load_response(tmp_path / "run")
    expected = [row for row in wr.judge_random(response) if row.criterion.startswith(("rms", "3-sigma"))]
    assert [(row["criterion"], row["subject"], row["value"]) for row in rows] == [
        (row.criterion, row.subject, row.value) for row in expected
    ]
    along_z = next(row for row in rows if row["subject"] == "rack" and row["criterion"] == "rms acceleration along z")
    assert f"{along_z['value'] / wr.STANDARD_GRAVITY:.3f}" in printed
    report = (tmp_path / "run" / "report.html").read_text()
    assert f"{along_z['value'] / wr.STANDARD_GRAVITY:.3f}" in report
    first, last = motion_from_dict(response.motion).steady
    moved = response.base.acceleration[(response.time >= first) & (response.time < last), 2].std() / wr.STANDARD_GRAVITY
    (base,) = (line.split() for line in printed.splitlines() if line.split()[:4] == ["deck", "(base)", "-", "-"])
    assert base[4:] == [f"{moved:.3f}", "-", "-", f"{3.0 * moved:.3f}"]
    assert 0.4 < moved < 0.6  # half a g is asked for, and three seconds scatter
    judged = {row["criterion"] for row in read_summary(tmp_path / "run")["judged"] if row["subject"] == "rack"}
    assert "3-sigma acceleration along z" in judged  # the model limits the rack's acceleration
