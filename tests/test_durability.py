"""Cycles and damage: the example of ASTM E1049, sines, Miles, Rayleigh's amplitudes against counted cycles, and the command."""

import math

import numpy as np
import pytest
from scipy.signal import lfilter

import wirerope_mj as wr
from wirerope_mj.cli import main


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
    assert cycles.equivalent_amplitude(5.0) == pytest.approx(2.0, rel=1e-9)
    edges, counts = cycles.histogram(4)
    assert edges.size == 5
    assert counts.sum() == cycles.total


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
    assert "30 counted" in printed
    assert main(["durability", str(tmp_path / "run"), "--exponent", "0"]) == 2
    assert main(["durability", str(tmp_path / "nothing"), "--exponent", "5"]) == 2
