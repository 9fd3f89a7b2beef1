"""Double pulses from a three-branch design spectrum: the kinematics of naval practice, to the last digit given."""

import math

import numpy as np
import pytest

from wirerope_mj.motions import DesignSpectrum, DoubleHalfSine, DoubleTriangle
from wirerope_mj.motions.spectra import shock_response_spectrum

pytestmark = pytest.mark.quick

G = 9.80665
SPECTRUM = DesignSpectrum(displacement=0.050, velocity=3.0, acceleration=100 * G)
PULSES = [SPECTRUM.double_half_sine(direction="z"), SPECTRUM.double_triangle(direction="z")]


@pytest.mark.parametrize(
    ("r2", "instants", "a4"),
    [
        # Computed independently for this spectrum with the factors 0.6, 0.75, 1.05; printed to 1e-4 ms and 1e-4 g.
        (0.4, (3.0591, 7.6479, 24.1517, 48.9074), -11.1216),
        (0.6, (3.0591, 7.6479, 29.3091, 43.7500), -12.7104),
    ],
)
def test_the_double_triangle_has_the_instants_and_the_second_peak_of_the_example(r2, instants, a4):
    pulse = SPECTRUM.double_triangle(direction="z", r2=r2)
    np.testing.assert_allclose(1e3 * np.array(pulse.instants), instants, rtol=0, atol=0.5e-4)
    assert pulse.second_peak / G == pytest.approx(a4, abs=0.5e-4)
    t2, _, t4, _ = pulse.instants
    np.testing.assert_allclose(pulse.acceleration([t2, t4])[:, 2], [60 * G, pulse.second_peak], rtol=1e-12)
    np.testing.assert_allclose(pulse.corners, [0.0, *pulse.instants], rtol=1e-12)


def test_the_double_half_sine_has_the_lengths_and_the_second_peak_of_the_example():
    pulse = SPECTRUM.double_half_sine(direction="z")
    assert 1e3 * pulse.first_duration == pytest.approx(6.0066, abs=0.5e-4)
    assert 1e3 * pulse.second_duration == pytest.approx(40.6600, abs=0.5e-4)
    assert pulse.second_peak / G == pytest.approx(-8.8637, abs=0.5e-4)
    middles = [pulse.first_duration / 2, pulse.middle + pulse.second_duration / 2]
    np.testing.assert_allclose(pulse.acceleration(middles)[:, 2] / G, [60.0, -8.8637], rtol=1e-5)


@pytest.mark.parametrize("pulse", PULSES, ids=lambda pulse: pulse.kind)
def test_the_base_passes_the_velocity_and_ends_at_rest_at_the_displacement(pulse):
    assert pulse.velocity(pulse.middle)[0, 2] == pytest.approx(2.25, rel=1e-14)
    time = np.linspace(0.0, pulse.end, 20_001)
    assert pulse.velocity(time)[:, 2].max() <= 2.25 * (1 + 1e-14)
    assert pulse.velocity(time)[:, 2].min() >= -1e-15
    after = [pulse.end, pulse.end + 10.0]
    # Sums of a few terms of 2.25 m/s: their roundoff is 2e-16 each, over 10 s.
    np.testing.assert_allclose(pulse.velocity(after)[:, 2], 0.0, atol=1e-15)
    np.testing.assert_allclose(pulse.displacement(after)[:, 2], 0.0525, rtol=0, atol=1e-14)
    np.testing.assert_array_equal(pulse.acceleration(after)[:, 2], 0.0)


@pytest.mark.parametrize("pulse", PULSES, ids=lambda pulse: pulse.kind)
def test_the_opposite_pulse_is_the_mirror_image(pulse):
    levels = {"peak": -60 * G, "velocity": -2.25, "displacement": -0.0525}
    time = np.linspace(-0.01, 0.06, 701)
    np.testing.assert_allclose(type(pulse)(**levels, direction="z").displacement(time), -pulse.displacement(time))


@pytest.mark.parametrize(
    ("shape", "factor"),
    [(DoubleHalfSine, math.pi / 4), (DoubleTriangle, 2 * (2 - 0.4) / 3)],
    ids=["half-sine", "triangle"],
)
def test_what_the_message_proposes_is_the_limit_of_what_is_possible(shape, factor):
    a, v, d = 500.0, 2.0, 0.005
    # V t1/2 = pi V^2/(4 a1) for the half-sine, V t3 (2 - r1)/3 = 2 V^2 (2 - r1)/(3 a2) for the triangle
    limits = {"displacement": factor * v**2 / a, "velocity": math.sqrt(a * d / factor), "peak": factor * v**2 / d}
    with pytest.raises(ValueError, match="the second one needs more room") as caught:
        shape(peak=a, velocity=v, displacement=d, direction="x")
    for name, limit in limits.items():
        assert f"`{name}` {'below' if name == 'velocity' else 'above'} {limit:.6g} m" in str(caught.value)
        levels = {"peak": a, "velocity": v, "displacement": d}
        possible, impossible = (0.999, 1.001) if name == "velocity" else (1.001, 0.999)
        shape(**{**levels, name: possible * limit}, direction="x")
        with pytest.raises(ValueError, match="The condition is displacement >"):
            shape(**{**levels, name: impossible * limit}, direction="x")


@pytest.mark.parametrize(
    ("change", "message"),
    [
        ({"velocity": -2.0}, "`peak`, `velocity` and `displacement` must have the same sign.*got 500, -2 and 0.02"),
        ({"displacement": 0.0}, "`displacement` must not be zero"),
        ({"peak": math.nan}, "`peak` must be a finite number"),
        ({"r1": 1.2}, "`r1` must lie between 0 and 1, got 1.2"),
        ({"r2": -0.1}, "`r2` must lie between 0 and 1, got -0.1"),
    ],
)
def test_arguments_out_of_range_are_refused(change, message):
    with pytest.raises(ValueError, match=message):
        DoubleTriangle(**{"peak": 500.0, "velocity": 2.0, "displacement": 0.02, "direction": "x", **change})


def test_the_branches_of_the_design_spectrum_meet_at_its_corners():
    low, high = SPECTRUM.corner_frequencies
    assert low == pytest.approx(3.0 / (2 * math.pi * 0.05), rel=1e-15)
    assert high == pytest.approx(100 * G / (2 * math.pi * 3.0), rel=1e-15)
    levels = SPECTRUM.pseudo_velocity([low / 2, low, math.sqrt(low * high), high, 2 * high])
    np.testing.assert_allclose(levels, [1.5, 3.0, 3.0, 3.0, 1.5], rtol=1e-14)


@pytest.mark.parametrize(("pulse", "reached"), [(PULSES[0], 1.113), (PULSES[1], 0.955)], ids=["half-sine", "triangle"])
def test_the_undamped_spectrum_of_the_pulse_follows_the_branches(pulse, reached):
    low, high = SPECTRUM.corner_frequencies
    frequencies = np.geomspace(low / 30, 10 * high, 200)
    time = np.arange(0.0, pulse.end + 0.01, 1 / (40 * frequencies[-1]))
    spectrum = shock_response_spectrum(time, pulse.acceleration(time)[:, 2], frequencies, q=math.inf)
    ratio = spectrum.pseudo_velocity / SPECTRUM.pseudo_velocity(frequencies)
    # An oscillator that is slow enough stays where it was while the base moves away by 1.05 d0.
    assert ratio[0] == pytest.approx(1.05, rel=0.002)
    between = ratio[(frequencies > low) & (frequencies < high)]
    assert 0.72 < between.min() < between.max() < 1.2  # seen: 0.737 to 1.165
    assert ratio[frequencies > high].max() == pytest.approx(reached, abs=0.002)  # as the docstring says
    # One that is fast enough follows the pulse; at ten times the corner some 15 % of its own oscillation are left.
    assert 0.6 <= ratio[-1] < 0.75


@pytest.mark.parametrize(("ratio", "triangle"), [(3.0, 0.918), (5.454, 0.731), (12.1, 0.699), (40.0, 0.669)])
def test_the_spectra_between_the_corners_stay_in_the_range_that_is_documented(ratio, triangle):
    spectrum = DesignSpectrum(displacement=0.01 * ratio, velocity=1.0, acceleration=100.0)  # f2/f1 = d0 a0 / v0^2
    low, high = spectrum.corner_frequencies
    between, above = np.geomspace(low, high, 40), np.geomspace(high, 8 * high, 40)
    pulses = (
        (spectrum.double_half_sine(direction="z"), (0.69, 1.19), (1.06, 1.19)),
        (spectrum.double_triangle(direction="z"), (0.665, 1.22), (0.94, 1.04)),
        (spectrum.double_triangle(direction="z", r2=0.6), (0.665, 1.265), (0.94, 1.11)),
    )
    for pulse, velocities, accelerations in pulses:
        time = np.linspace(0.0, pulse.duration + 2 / low, 20_001)
        base = pulse.acceleration(time)[:, 2]
        found = shock_response_spectrum(time, base, between, q=1e6).pseudo_velocity
        assert velocities[0] <= found.min()
        assert found.max() <= velocities[1]
        reached = shock_response_spectrum(time, base, above, q=1e6).maximax.max() / spectrum.acceleration
        assert accelerations[0] - 0.005 <= reached <= accelerations[1]  # 40 frequencies may pass by the highest
        if pulse is pulses[1][0]:
            assert found.min() == pytest.approx(triangle, abs=0.01)  # measured; 40 frequencies may pass by the lowest


def test_the_factors_are_parameters():
    pulse = SPECTRUM.double_half_sine(direction="y", factors=(0.5, 0.8, 1.1), start=0.2)
    assert pulse.peak == pytest.approx(50 * G)
    assert pulse.peak_velocity == pytest.approx(2.4)
    assert pulse.final_displacement == pytest.approx(0.055)
    assert pulse.start == 0.2
    with pytest.raises(ValueError, match="`factors` must be three"):
        SPECTRUM.double_triangle(direction="y", factors=(1.0, 1.0))
    with pytest.raises(ValueError, match="`factors` must be > 0, got -1.0"):
        SPECTRUM.double_triangle(direction="y", factors=(1.0, 1.0, -1.0))


def test_a_spectrum_without_a_velocity_branch_is_refused():
    with pytest.raises(ValueError, match=r"`velocity` must be below .* = 7.07107 m/s.* got 8.0"):
        DesignSpectrum(displacement=0.05, velocity=8.0, acceleration=1000.0)
    with pytest.raises(ValueError, match="`displacement` must be > 0, got 0.0"):
        DesignSpectrum(displacement=0.0, velocity=8.0, acceleration=1000.0)
    with pytest.raises(ValueError, match="`frequencies` must be > 0"):
        SPECTRUM.pseudo_velocity([0.0, 1.0])


def test_descriptions_and_events_are_for_people():
    pulse = SPECTRUM.double_half_sine(direction="z", start=0.05)
    assert pulse.description == "double half-sine 60 g, 2.25 m/s, 52.5 mm along z at 0.05 s"
    assert [text for _, text in pulse.events] == [
        "double half-sine begins", "second pulse begins", "double half-sine ends",
    ]  # fmt: skip
    assert pulse.shortest_time == pulse.first_duration
