"""Cycles and damage: the example of ASTM E1049, sines, Miles, Rayleigh's amplitudes against counted cycles, and the command."""

import math

import numpy as np
import pytest
import scipy
from scipy.signal import lfilter

import wirerope_mj as wr
from wirerope_mj.assessment.durability.mission import mission_damage, read_mission
from wirerope_mj.cli import main

pytestmark = pytest.mark.filterwarnings("ignore:the given step of")  # what is asked here holds at coarse steps


@pytest.mark.quick
def test_the_example_of_the_standard():
    # ASTM E1049-85, figure 6: ranges 3 to 9 and how often each is counted.
    cycles = wr.rainflow_cycles([-2, 1, -3, 5, -1, 3, -4, 4, -2])
    counted = {size: float(cycles.counts[cycles.ranges == size].sum()) for size in np.unique(cycles.ranges)}
    assert counted == {3: 0.5, 4: 1.5, 6: 0.5, 8: 1.0, 9: 0.5}


@pytest.mark.quick
def test_a_sine_is_its_cycles_and_their_amplitude():
    time = np.linspace(0.0, 10.0, 10_001)
    cycles = wr.rainflow_cycles(3.0 + 2.0 * np.cos(2 * np.pi * time))
    assert cycles.total == 10.0
    assert cycles.ranges.max() == pytest.approx(4.0, rel=1e-6)
    assert cycles.damage(5.0) == pytest.approx(10.0 * 2.0**5, rel=1e-9)


@pytest.mark.quick
@pytest.mark.parametrize("history", [[0, 5], [0, 1, 5], [5, 1, 0], [2, 2, 7, 7], [7, 2, 2]])
def test_a_history_that_goes_one_way_is_half_a_cycle(history):
    cycles = wr.rainflow_cycles(history)
    assert (cycles.ranges, cycles.counts) == ([5.0], [0.5])
    assert cycles.means == [0.5 * (history[0] + history[-1])]
    assert cycles.damage(4.0) == 0.5 * 2.5**4


@pytest.mark.quick
def test_what_repeats_or_stands_still_adds_no_cycles():
    plain = wr.rainflow_cycles([0, 1, 0, 1, 0])
    slow = wr.rainflow_cycles(np.repeat([0.0, 0.5, 1.0, 0.5, 0.0, 0.5, 1.0, 1.0, 0.0], 3))
    assert plain.damage(3.0) == slow.damage(3.0)
    assert wr.rainflow_cycles([1.0, 1.0, 1.0]).total == 0.0
    for wrong in ([1.0], [[1.0, 2.0]], [1.0, math.nan]):
        with pytest.raises(ValueError, match="history"):
            wr.rainflow_cycles(wrong)
    with pytest.raises(ValueError, match="exponent"):
        plain.damage(0.0)


@pytest.mark.quick
@pytest.mark.parametrize("q", [5.0, 10.0, 50.0])
def test_a_wide_density_gives_what_miles_and_the_white_noise_integral_give(q):
    level, natural = 0.5, 40.0
    found = wr.vibration_response_spectrum([(1e-4, level), (1e6, level)], [natural], q=q)
    zeta = 0.5 / q
    exact = math.sqrt(math.pi * natural * level * (1 + 4 * zeta**2) / (4 * zeta))
    assert found.acceleration[0] == pytest.approx(exact, rel=1e-6)
    assert found.acceleration[0] == pytest.approx(math.sqrt(0.5 * math.pi * natural * q * level), rel=0.03)  # Miles
    deflection = math.sqrt(level / (8 * zeta * (2 * math.pi * natural) ** 3))  # of one-sided white noise, per Hz
    assert found.deflection[0] == pytest.approx(deflection, rel=1e-4)


@pytest.mark.quick
def test_far_below_its_frequency_an_oscillator_follows_the_base():
    psd = [(5.0, 0.01), (50.0, 0.01), (200.0, 0.000625)]
    found = wr.vibration_response_spectrum(psd, [50_000.0], q=10)
    assert found.acceleration[0] == pytest.approx(wr.motions.psd_rms(psd), rel=1e-4)


def test_the_damage_of_the_spectrum_is_that_of_counted_cycles():
    """A narrow-band response of white noise: its pseudo-velocity, counted by rainflow, and Rayleigh's closed form."""
    rate, natural, q, level, seconds = 2000.0, 20.0, 50.0, 0.5, 2000.0
    noise = np.sqrt(0.5 * rate * level) * np.random.default_rng(4).normal(size=int(seconds * rate))
    w, z = 2 * np.pi * natural, 0.5 / q
    wd, e = w * np.sqrt(1 - z * z), np.exp(-z * w / rate)
    # deflection of an oscillator under impulses a dt, by its impulse response
    response = lfilter([0.0, -e * np.sin(wd / rate) / (wd * rate)], [1.0, -2 * e * np.cos(wd / rate), e * e], noise)
    counted = wr.rainflow_cycles(w * response[int(20 * rate) :]).damage(4.0) / (seconds - 20.0)
    spectrum = wr.vibration_response_spectrum([(1e-3, level), (1000.0, level)], [natural], q=q)
    assert spectrum.pseudo_velocity[0] == pytest.approx(w * np.std(response), rel=0.03)  # 2000 s of a band of 0.6 Hz
    for method in ("dirlik", "narrow-band"):
        damage = spectrum.fatigue_damage(4.0, 1.0, method=method)[0]
        assert damage == pytest.approx(counted, rel=0.12)  # the fourth power of that
    with pytest.raises(ValueError, match="method"):
        spectrum.fatigue_damage(4.0, 1.0, method="guess")


FLIFE = {  # damage by Dirlik and narrow-band, FLife 2.3, of 1 (m/s^2)^2/Hz from 5 to 2000 Hz in an hour, Q = 10, b = 8
    2: (1.221252e-07, 1.393940e-07),
    30: (1.481551e00, 1.234692e00),
    901: (4.272599e-05, 4.610207e-05),
}


@pytest.mark.quick
@pytest.mark.parametrize("natural", FLIFE)
def test_damage_below_within_and_above_a_band_is_that_of_another_program(natural):
    spectrum = wr.vibration_response_spectrum([(5.0, 1.0), (2000.0, 1.0)], [natural], q=10)
    found = [spectrum.fatigue_damage(8.0, 3600.0, method=method)[0] for method in ("dirlik", "narrow-band")]
    assert found == pytest.approx(FLIFE[natural], rel=1e-4)  # its integrals are sums over steps of 10 mHz


@pytest.mark.quick
def test_spectra_of_nothing_are_refused():
    with pytest.raises(ValueError, match="at least 2"):
        wr.vibration_response_spectrum([(5, 1.0)], [10.0])
    with pytest.raises(ValueError, match="frequencies"):
        wr.vibration_response_spectrum([(5, 1.0), (50, 1.0)], [-1.0])


def test_the_command_counts_every_mount_and_axis_of_a_run(tmp_path, capsys):
    pulse = wr.HalfSine(peak=150.0, duration=0.011, direction="z", start=0.01)
    response = wr.simulate(wr.load_system("cabinet"), pulse, duration=0.3, timestep=5e-4)
    response.save(tmp_path / "run")
    assert main(["durability", str(tmp_path / "run"), "--exponent", "5", "--rows", "3"]) == 0
    printed = capsys.readouterr().out
    counted = wr.mount_cycles(response)
    assert len(counted) == 30  # ten mounts, three axes; six stops are left out
    worst = max(counted, key=lambda one: one.cycles.damage(5.0))
    assert f"{worst.mount} " in printed
    assert f"{1e3 * worst.cycles.ranges.max():.3g}" in printed
    assert "30 mounts and axes counted" in printed
    assert f"Most damaged: {worst.mount} {worst.axis}. Its life is not known" in printed
    assert main(["durability", str(tmp_path / "run"), "--exponent", "0"]) == 2
    assert main(["durability", str(tmp_path / "nothing"), "--exponent", "5"]) == 2


def shaken(seconds=60.0, rate=2000.0):
    """Return instants and a random acceleration of 5 to 80 Hz, sampled densely [m/s^2]."""
    time = np.arange(int(seconds * rate)) / rate
    rng = np.random.default_rng(4)
    frequencies = np.arange(5.0, 80.0, 0.5) + rng.uniform(0.0, 0.4, 150)
    phases = rng.uniform(0.0, 2.0 * np.pi, frequencies.size)
    return time, np.sum([np.sin(2 * np.pi * f * time + p) for f, p in zip(frequencies, phases, strict=True)], axis=0)


@pytest.mark.quick
def test_a_damage_spectrum_follows_the_deflections_that_scipy_solves():
    time, acceleration = shaken(2.0)
    acceleration[0] = 30.0  # a record that begins with a value: the base begins to move there
    for natural, q in ((3.0, 10.0), (25.0, 5.0), (199.0, 50.0)):
        w = 2.0 * np.pi * natural
        system = scipy.signal.StateSpace([[0, 1], [-w * w, -w / q]], [[0], [-1]], [[1, 0]], [[0]])
        _, deflection, _ = scipy.signal.lsim(system, acceleration, time, interp=True)
        expected = wr.rainflow_cycles(w * deflection).damage(4.0)
        found = wr.fatigue_damage_spectrum(time, acceleration, exponent=4.0, frequencies=[natural], q=q)
        assert found.damage[0] == pytest.approx(expected, rel=1e-9)


@pytest.mark.slow
def test_a_damage_spectrum_of_a_history_is_that_of_pyyeti():
    with np.printoptions():  # which pyyeti sets for the whole process
        fdepsd = pytest.importorskip("pyyeti.fdepsd")
    time, acceleration = shaken()
    frequencies = np.array([4.0, 10.0, 25.0, 50.0, 100.0])
    theirs = fdepsd.fdepsd(
        acceleration, 2000.0, frequencies, 10.0, resp="pvelo", detrend=False, winends=None, hpfilter=None, nbins=4000,
        rolloff=None, parallel="no",
    )  # fmt: skip
    ours = wr.fatigue_damage_spectrum(time, acceleration, exponent=4.0, frequencies=frequencies)
    np.testing.assert_allclose(ours.damage, theirs.di_sig["b=4"].to_numpy(), rtol=1e-2)


def test_a_damage_spectrum_of_random_vibration_is_that_of_its_density():
    density = [(5.0, 1.0), (100.0, 1.0)]
    vibration = wr.RandomVibration(psd=density, duration=400.0, seed=5, direction="z")
    time = np.arange(0.0, 400.0, 1e-3)
    measured = wr.fatigue_damage_spectrum(
        time, vibration.acceleration(time)[:, 2], exponent=4.0, frequencies=[10.0, 40.0, 80.0]
    )
    expected = wr.vibration_response_spectrum(density, [10.0, 40.0, 80.0]).fatigue_damage(4.0, 400.0)
    # One history: 1e4 cycles with Q = 10 know a fourth power of amplitudes to some 10 %.
    np.testing.assert_allclose(measured.damage, expected, rtol=0.15)


def test_a_service_life_is_the_sum_of_its_stages(tmp_path, capsys):
    system = wr.load_system("cabinet")
    pulse = wr.HalfSine(peak=150.0, duration=0.011, direction="z", start=0.01)
    wr.simulate(system, pulse, duration=0.36, timestep=5e-4).save(tmp_path / "hard")
    sweep = wr.Sweep(start=8.0, stop=16.0, rate=120.0, acceleration=1.0, direction="z")  # an octave in half a second
    wr.simulate(system, sweep, duration=0.8, timestep=5e-4).save(tmp_path / "soft")
    life = 'exponent = 4.0\nconstant = 1e-3\n[[stage]]\nrun = "hard"\nrepetitions = 20\n[[stage]]\nrun = "soft"\nhours = 2\n'
    (tmp_path / "life.toml").write_text(life)
    hard, soft = (wr.mount_cycles(wr.load_response(tmp_path / name)) for name in ("hard", "soft"))
    damages = {(d.mount, d.axis): d for d in mission_damage(read_mission(tmp_path / "life.toml"))}
    for one, other in zip(hard, soft, strict=True):
        expected = 20.0 * one.cycles.damage(4.0, 1e-3), 7200.0 / 0.5 * other.cycles.damage(4.0, 1e-3)
        assert damages[one.mount, one.axis].stages == pytest.approx(expected, rel=1e-12)
    assert main(["durability", str(tmp_path / "life.toml"), "--rows", "1"]) == 0
    printed = " ".join(capsys.readouterr().out.split())
    worst = max(damages.values(), key=lambda one: one.total)
    assert f"{worst.mount} {worst.axis}" in printed
    most = f"Most damaged: {worst.mount} {worst.axis}: damage {worst.total:.3g} in one such life"
    assert f"{most}; it lasts {1.0 / worst.total:.3g} such lives." in printed
    assert "20 x hard + 2 h of soft" in printed


def test_hours_are_of_what_goes_on_and_not_of_shocks(tmp_path):
    """The damage of an hour does not depend on how long a run rings on; an hour of shocks is refused."""
    system = wr.load_system("cabinet")
    pulse = wr.HalfSine(peak=150.0, duration=0.011, direction="z", start=0.01)
    wr.simulate(system, pulse, duration=0.36, timestep=5e-4).save(tmp_path / "shock")
    life = 'exponent = 4.0\nconstant = 1e-3\n[[stage]]\nrun = "{}"\nhours = 2\n'
    (tmp_path / "life.toml").write_text(life.format("shock"))
    with pytest.raises(wr.RecordError, match="a half-sine is over once it has happened.*`repetitions`"):
        mission_damage(read_mission(tmp_path / "life.toml"))
    time = np.arange(0.0, 2.0, 1e-3)
    rows = np.column_stack([time, 2.0 * np.sin(2 * np.pi * 9.0 * time) * np.sin(np.pi * time / 2.0)])
    np.savetxt(tmp_path / "road.csv", rows, delimiter=",", header="time [s],z [m/s^2]", comments="")
    record = wr.load_record(tmp_path / "road.csv", baseline="velocity")
    found = []
    for duration in (2.6, 5.0):
        # After the first loading friction lets go of the sag while the road lasts, which happens once and not every hour: it
        # adds 4.14e-8 in 2.6 s and 5.06e-8 in 5 s to these 2.52e-9, with steps of 0.5 and of 0.1 ms alike.
        response = wr.simulate(system, record, duration=duration, timestep=5e-4, initial="relaxed")
        response.save(tmp_path / f"road-{duration}")
        (tmp_path / "life.toml").write_text(life.format(f"road-{duration}"))
        found.append(mission_damage(read_mission(tmp_path / "life.toml"))[0].total)
    assert found[0] == pytest.approx(found[1], rel=0.01)


@pytest.mark.parametrize(
    ("text", "said"),
    [
        ("exponent = 4", "there must be a table"),
        ('exponent = 4\n[[stage]]\nrun = "a"', "either `repetitions` or `hours`"),
        ('exponent = 4\n[[stage]]\nrun = "a"\nhours = 1\nrepetitions = 2', "either `repetitions` or `hours`"),
        ('[[stage]]\nrun = "a"\nhours = 1', "`exponent` is missing; needed: exponent"),
        ('exponent = 4\n[[stage]]\nrun = "a"\nhours = -1', "`hours`"),
        ('exponent = 4\nlife = 2\n[[stage]]\nrun = "a"\nhours = 1', "line 2: `life` is unknown; known: stage, exponent"),
        ("exponent = ", "not valid TOML"),
        ('exponent = 4\n[[stage]]\nrun = "nothing"\nhours = 1', "there is no such folder"),
    ],
)
def test_a_service_life_that_cannot_be_is_one_message(text, said, tmp_path, capsys):
    (tmp_path / "life.toml").write_text(text)
    assert main(["durability", str(tmp_path / "life.toml")]) == 2
    assert said in " ".join(capsys.readouterr().err.split())
