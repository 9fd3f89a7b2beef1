"""Random vibration: the density, the rms and the distribution that were asked for, from rest to rest."""

import math

import numpy as np
import pytest
import scipy
from scipy.interpolate import BSpline
from scipy.signal import cont2discrete, csd, lfilter, lsim, welch
from scipy.stats import chi2

from wirerope_mj.motions import RandomVibration, motion_from_dict, psd_from_g, psd_level, psd_rms
from wirerope_mj.motions.envelope import random_phases
from wirerope_mj.motions.piecewise import UniformSpline

G = 9.80665
SHAPE = ((20.0, 0.5), (60.0, 2.0), (120.0, 2.0), (200.0, 0.3))
LENGTH = 120.0
RATE = 8 * 8 * 200.0  # eight samples between knots, so that the images of the spline's segments are not folded back
SAMPLES = 2048 * 8  # of a segment: lines of 0.78 Hz
MOTION = RandomVibration(psd=SHAPE, duration=LENGTH, seed=1, direction="z", rise=1.0, fall=1.0)


def stationary(motion=MOTION):
    first, last = motion.steady
    return motion.acceleration(np.arange(math.ceil(first * RATE), math.floor(last * RATE)) / RATE)[:, 2]


@pytest.fixture(scope="module")
def history():
    return stationary()


def test_the_density_is_that_asked_for_within_the_statistical_error(history):
    frequency, density = welch(history, RATE, nperseg=SAMPLES, noverlap=0)
    segments = history.size // SAMPLES
    # Two lines (the window's own width) from the ends of the band, where the window looks past them.
    inside = (frequency > 20.0 + 2.5 * RATE / SAMPLES) & (frequency < 200.0 - 2.5 * RATE / SAMPLES)
    ratio = density[inside] / psd_level(SHAPE, frequency[inside])
    error = 1 / math.sqrt(segments)  # standard error of an estimate from so many independent segments
    assert segments > 80
    assert np.abs(ratio - 1).max() < 4.5 * error  # about 220 lines: one in 600 such tests would exceed this by chance
    # Lines a window apart are independent: about 2/3 of their number for Hann. A wrong factor of the interpolation, up
    # to 5 % in amplitude at the upper end, would show in the upper half alone.
    for half in np.array_split(ratio, 2):
        assert half.mean() == pytest.approx(1.0, abs=4 * error / math.sqrt(2 / 3 * half.size))


@pytest.mark.parametrize("rate", [5e3, 8e3, 9.7e3, 10e3, 16e3])
def test_it_is_the_sum_of_its_lines_at_any_sampling_also_at_the_knots(rate):
    motion = RandomVibration(psd=((20.0, 1.0), (2000.0, 1.0)), duration=1.0, seed=3, direction="z")
    first, last = motion.steady
    time = np.arange(math.ceil(first * rate), math.floor(last * rate)) / rate
    period = scipy.fft.next_fast_len(16_001, real=True) / 16_000.0  # of 16 000 intervals and one knot more
    lines = np.arange(round(20.0 * period), round(2000.0 * period) + 1)
    amplitude = np.sqrt(2.0 * np.diff(np.clip((np.arange(lines[0], lines[-1] + 2) - 0.5) / period, 20.0, 2000.0)))
    angle = 2 * np.pi * time[:, np.newaxis] * lines / period + random_phases(3, lines.size)
    exact = -np.cos(angle) @ amplitude
    read = motion.acceleration(time)[:, 2]
    # Images of a line at the highest frequency are 1/7^4 + 1/9^4 of it or less.
    assert np.abs(read - exact).max() < 1e-3 * np.abs(exact).max()
    assert read.std() == pytest.approx(exact.std(), rel=1e-3)
    densities = [welch(values, rate, nperseg=512) for values in (read, exact)]
    top = (densities[0][0] > 1800.0) & (densities[0][0] < 2000.0)
    assert densities[0][1][top] == pytest.approx(densities[1][1][top], rel=3e-3)


def test_motions_that_were_stored_without_a_spline_keep_theirs():
    stored = {name: value for name, value in MOTION.to_dict().items() if name != "spline"}
    old = motion_from_dict(stored)
    assert MOTION.to_dict()["spline"] == "quintic"
    assert old.to_dict()["spline"] == "cubic"
    inside = MOTION.corners[1000:2000]
    middles = 0.5 * (inside[1:] + inside[:-1])
    straight, curved = (
        np.abs(np.interp(middles, inside, motion.acceleration(inside)[:, 2]) - motion.acceleration(middles)[:, 2]).max()
        for motion in (old, MOTION)
    )
    assert straight < 1e-6 * MOTION.rms < 1e-2 * MOTION.rms < curved


def test_nothing_is_outside_the_band_but_the_images_of_the_segments(history):
    frequency, density = welch(history, RATE, nperseg=SAMPLES)
    total = np.sum(density)
    below, above = frequency < 17.0, (frequency > 203.0)
    assert density[below].sum() < 1e-5 * total  # what the Hann window lets through four lines away
    # Images, from 1600 - 200 Hz on, are (1/7)^8 of the power at the highest frequency; the window lets through more.
    assert density[above].sum() < 1e-5 * total


def test_the_rms_is_the_root_of_the_integral(history):
    assert MOTION.rms == psd_rms(SHAPE)
    # The period of the noise is rms exactly; of it the rises take 2 in 120 s. Statistical error of that remainder: 1/(2
    # sqrt(B T)) = 0.4 % for B = 130 Hz and the whole length would be an upper limit.
    assert history.std() == pytest.approx(MOTION.rms, rel=4e-3)
    assert abs(history.mean()) < 1e-3 * MOTION.rms


def test_the_values_are_gaussian(history):
    scaled = history / history.std()
    independent = 2 * 130 * LENGTH  # values, twice bandwidth times length
    assert np.mean(scaled**3) == pytest.approx(0.0, abs=4 * math.sqrt(15 / independent))
    assert np.mean(scaled**4) == pytest.approx(3.0, abs=4 * math.sqrt(96 / independent))
    assert np.mean(np.abs(scaled) > 3) == pytest.approx(0.0027, abs=4 * math.sqrt(0.0027 / independent))


def test_the_base_is_at_rest_before_and_after_and_does_not_drift():
    outside = [-1.0, 0.0, LENGTH, LENGTH + 100.0]
    for function in (MOTION.acceleration, MOTION.velocity, MOTION.displacement):
        np.testing.assert_array_equal(function(outside), np.zeros((4, 3)))
    time = np.linspace(0.0, LENGTH, 240_001)
    # The largest of 120 s of Gaussian noise is below six rms values; rms of v and x from the density over w^2 and w^4.
    omega = 2 * np.pi * np.geomspace(20.0, 200.0, 20_001)
    levels = psd_level(SHAPE, omega / (2 * np.pi))
    for function, power in ((MOTION.velocity, 2), (MOTION.displacement, 4)):
        rms = math.sqrt(np.trapezoid(levels / omega**power, omega / (2 * np.pi)))
        values = function(time)[:, 2]
        assert np.abs(values).max() < 6 * rms
        middle = values[(time > 1.0) & (time < LENGTH - 1.0)]
        assert middle.std() == pytest.approx(rms, rel=0.02)  # half the bandwidth of the acceleration, so 4 x 0.4 %
        assert abs(middle.mean()) < 0.01 * rms


def test_rise_and_fall_are_smooth():
    motion = RandomVibration(psd=SHAPE, duration=10.0, seed=4, direction="x", rise=2.0, fall=3.0)
    time = np.linspace(0.0, 10.0, 20_001)
    values = np.abs(motion.acceleration(time)[:, 0])
    assert values[time < 0.1].max() < 0.01 * motion.rms  # s^3 10 = 0.00125 of up to five rms
    assert values[time > 9.9].max() < 0.01 * motion.rms
    assert values[(time > 0.9) & (time < 1.1)].max() < 0.7 * 5 * motion.rms
    assert motion.steady == (2.0, 7.0)


def test_the_seed_chooses_the_motion_and_nothing_else():
    again = RandomVibration(psd=SHAPE, duration=LENGTH, seed=1, direction="z", rise=1.0, fall=1.0)
    time = np.linspace(10.0, 11.0, 1001)
    assert again.displacement(time).tobytes() == MOTION.displacement(time).tobytes()
    assert motion_from_dict(MOTION.to_dict()).acceleration(time).tobytes() == MOTION.acceleration(time).tobytes()
    other = RandomVibration(psd=SHAPE, duration=LENGTH, seed=2, direction="z", rise=1.0, fall=1.0)
    assert np.abs(other.acceleration(time) - MOTION.acceleration(time)).max() > MOTION.rms


def test_the_stream_of_phases_is_fixed():
    # The first numbers of PCG64 with seed 0, published with NumPy's own stream tests: random() gives raw >> 11 over 2^53.
    expected = 2 * np.pi * np.array([0.6369616873214543, 0.2697867137638703, 0.04097352393619469])
    np.testing.assert_allclose(random_phases(0, 3), expected, rtol=1e-15)


def test_axes_with_seeds_of_their_own_are_independent(history):
    other = stationary(RandomVibration(psd=SHAPE, duration=LENGTH, seed=2, direction="z", rise=1.0, fall=1.0))
    frequency, cross = csd(history, other, RATE, nperseg=SAMPLES, noverlap=0)
    inside = (frequency > 24.0) & (frequency < 196.0)
    coherence = np.abs(cross[inside]) ** 2 / psd_level(SHAPE, frequency[inside]) ** 2
    segments = history.size // SAMPLES
    # Of independent signals it is exponentially distributed about 1/segments; one in e^12 = 160 000 exceeds 12 times that,
    # and the mean over 220 lines is within 4/sqrt(220) of it.
    assert coherence.max() < 12 / segments
    assert coherence.mean() == pytest.approx(1 / segments, rel=4 / math.sqrt(2 / 3 * 220))


@pytest.mark.slow
def test_an_oscillator_answers_as_miles_says():
    flat = RandomVibration(psd=[(8.0, 1.0), (480.0, 1.0)], duration=LENGTH, seed=6, direction="z", rise=1.0, fall=1.0)
    frequency, q = 60.0, 10.0
    omega, time = 2 * math.pi * frequency, np.arange(0.0, LENGTH, 1.0 / (32 * 480.0))
    oscillator = ([omega / q, omega**2], [1.0, omega / q, omega**2])  # base to absolute acceleration
    _, answer, _ = lsim(oscillator, flat.acceleration(time)[:, 2], time)  # on straight lines, 256 in a period of it
    full, falls = flat.steady
    steady = answer[(time > full + 1.0) & (time < falls)]  # a second is 38 time constants Q/(pi f)
    # Miles: rms^2 = (pi/2) f Q S, and (1 + 1/Q^2) times that with the force of the damper. The band of noise misses what
    # lies below 8 and above 480 Hz: 0.1 and 0.2 %. A resonance of bandwidth (pi/2) f/Q = 9.4 Hz over 118 s has a
    # statistical error of 1/(2 sqrt(B T)) = 1.5 %.
    assert steady.std() == pytest.approx(math.sqrt(math.pi / 2 * frequency * q * (1 + 1 / q**2)), rel=4 * 0.015)


SEEDS = 48
FLAT = [(20.0, 1.0), (200.0, 1.0)]


@pytest.fixture(scope="module", params=["fixed", "random"])
def answers(request):
    """Mean squares of base and of a 60 Hz oscillator over 16 of 20 s, (SEEDS, 2), of motions with either amplitudes."""
    omega, damping, squares = 2 * math.pi * 60.0, 0.05, []
    for seed in range(SEEDS):
        motion = RandomVibration(
            psd=FLAT, duration=20.0, seed=seed, direction="z", rise=1.0, fall=1.0, amplitudes=request.param
        )
        time = np.arange(0.0, 20.0, 1.0 / (32 * 200.0))
        base = motion.acceleration(time)[:, 2]
        oscillator = ([2 * damping * omega, omega**2], [1.0, 2 * damping * omega, omega**2])
        top, bottom, _ = cont2discrete(oscillator, time[1], method="foh")  # straight lines, 107 in a period of it
        answer = lfilter(np.squeeze(top), bottom, base)
        # A second after the rise is 19 time constants 1/(damping omega): the rise is forgotten.
        steady = (time >= 2.0) & (time < 18.0)
        squares.append([np.mean(base[steady] ** 2), np.mean(answer[steady] ** 2)])
    return request.param, np.array(squares)


def test_responses_scatter_from_seed_to_seed_as_the_amplitudes_say(answers):
    """Var of a mean square over t: sum_ij P_i P_j sinc^2((i - j) t/T) = int S^2 df / t; without i = j it is 1 - t/T of that.

    Fixed amplitudes have no variance of their own, which is i = j. S is the density of base or answer; of mean squares the
    relative scatter is twice that of rms values.
    """
    amplitudes, squares = answers
    frequency = np.linspace(20.0, 200.0, 18_001)
    ratio = frequency / 60.0
    gain = (1 + (0.1 * ratio) ** 2) / ((1 - ratio**2) ** 2 + (0.1 * ratio) ** 2)  # of acceleration, squared
    share = 1.0 if amplitudes == "random" else 1 - 16.0 / 20.0
    for values, density in ((squares[:, 0], np.ones_like(gain)), (squares[:, 1], gain)):
        power = np.trapezoid(density, frequency)
        scatter = math.sqrt(share * np.trapezoid(density**2, frequency) / 16.0) / power
        # A scatter of n seeds is chi-square of n - 1 degrees: one in 10 000 leaves this range, 0.65 to 1.41, at either end.
        low, high = np.sqrt(chi2.ppf([1e-4, 1 - 1e-4], SEEDS - 1) / (SEEDS - 1))
        assert low < values.std(ddof=1) / power / scatter < high
        # The mean of all seeds is the density's, within four of its standard errors (and 1e-3 for the images).
        assert values.mean() / power == pytest.approx(1.0, abs=4 * scatter / math.sqrt(SEEDS) + 1e-3)


def test_random_amplitudes_are_stored_and_keep_the_phases_of_their_seed():
    fixed, random = (
        RandomVibration(psd=FLAT, duration=5.0, seed=3, direction="x", amplitudes=kind) for kind in ("fixed", "random")
    )
    time = np.linspace(0.0, 5.0, 1001)
    rebuilt = motion_from_dict(random.to_dict())
    assert rebuilt.acceleration(time).tobytes() == random.acceleration(time).tobytes()
    before = {name: value for name, value in fixed.to_dict().items() if name != "amplitudes"}  # stored by an earlier version
    assert motion_from_dict(before).acceleration(time).tobytes() == fixed.acceleration(time).tobytes()
    # Correlation of lines of equal phases, amplitudes 1 and A: E A = sqrt(pi)/2 for Rayleigh's distribution of mean square
    # 1, over some 900 lines.
    alike = np.corrcoef(fixed.acceleration(time)[:, 0], random.acceleration(time)[:, 0])[0, 1]
    assert alike == pytest.approx(math.sqrt(math.pi) / 2, abs=4 / math.sqrt(900))
    assert "seed 3, random amplitudes along x" in random.description
    assert "amplitudes" not in fixed.description


def test_axes_add():
    x = RandomVibration(psd=SHAPE, duration=5.0, seed=1, direction="x")
    z = RandomVibration(psd=SHAPE, duration=5.0, seed=2, direction="z")
    time = np.linspace(0.0, 5.0, 501)
    np.testing.assert_array_equal((x + z).acceleration(time), x.acceleration(time) + z.acceleration(time))
    np.testing.assert_array_equal((x + z).directions, [[1, 0, 0], [0, 0, 1]])


@pytest.mark.parametrize("degree", [3, 5])
@pytest.mark.parametrize("order", [0, 1, 2])
def test_the_spline_is_the_b_spline(degree, order):
    coefficients = np.pad([1.0, -2.0, 0.5, 3.0], 3)
    knots = 2.0 + 0.5 * (np.arange(coefficients.size + 3 * degree + 1) - (3 * degree + 1) / 2)
    reference = BSpline(knots, np.pad(coefficients, degree), degree)
    reference = reference.derivative(order) if order else reference
    time = 2.0 + 0.5 * np.linspace(0.0, coefficients.size - 1.0, 91)
    spline = UniformSpline(2.0, 0.5, coefficients, degree=degree)
    np.testing.assert_allclose(spline.derivative(time, order), reference(time), atol=1e-13)
    outside = spline.derivative(np.array([1.0, 2.0, 6.5, 9.0]), order)
    np.testing.assert_array_equal(outside, np.zeros(4))


def test_ten_minutes_to_two_thousand_hertz_keep_one_number_a_knot():
    motion = RandomVibration(psd=psd_from_g([(20, 0.04), (1000, 0.04), (2000, 0.01)]), duration=600.0, seed=1, direction="z")
    knots = 600 * 2000 * 8 + 1
    assert motion.corners.size == knots
    assert motion._curve._c.size == knots + 4


@pytest.mark.parametrize(
    ("change", "message"),
    [
        ({"psd": [(20, 1.0), (10, 1.0)]}, "frequencies of `psd` must increase"),
        ({"psd": [(20, 1.0), (40, -1.0)]}, "`psd`, point 2: `level` must be > 0, got -1.0"),
        ({"duration": 0.0}, "`duration` must be > 0"),
        ({"duration": 0.09}, r"`duration` must leave room for rise and fall, 0.05 s and 0.05 s, got 0.09"),
        ({"rise": 0.01}, r"`rise` must be at least one period of the lowest frequency, 0.05 s.*got 0.01"),
        ({"fall": -1.0}, "`fall` must be > 0, got -1.0"),
        ({"seed": -1}, "`seed` must be an integer >= 0, got -1"),
        ({"seed": 1.5}, "`seed` must be an integer >= 0, got 1.5"),
        ({"seed": True}, "`seed` must be an integer >= 0, got True"),
        ({"amplitudes": "gauss"}, "`amplitudes` must be one of 'fixed', 'random', got 'gauss'"),
    ],
)
def test_arguments_out_of_range_are_refused(change, message):
    with pytest.raises(ValueError, match=message):
        RandomVibration(**{"psd": SHAPE, "duration": 10.0, "seed": 0, "direction": "z", **change})


def test_descriptions_and_events_are_for_people():
    motion = RandomVibration(psd=psd_from_g([(20, 0.04), (1000, 0.04), (2000, 0.01)]), duration=60.0, seed=3, direction="z")
    assert motion.description == "random 20 to 2000 Hz, 7.694 g rms, 60 s, seed 3 along z"
    assert [time for time, _ in motion.events] == [0.0, 0.5, 59.5, 60.0]  # ten periods of 20 Hz
    assert motion.shortest_time == 1 / 2000
