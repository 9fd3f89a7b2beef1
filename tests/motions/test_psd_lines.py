"""Power spectral densities given by points: levels, exact integrals, and the published shapes."""

import math

import numpy as np
import pytest
from scipy.integrate import quad

import wirerope_mj as wr
from wirerope_mj.motions import RandomVibration, motion_from_dict, psd_from_g, psd_level, psd_rms
from wirerope_mj.motions.psd_lines import psd_points, psd_power
from wirerope_mj.motions.spectra import vibration_response_spectrum

G = 9.80665
MINIMUM_INTEGRITY = [(20, 0.04), (1000, 0.04), (2000, 0.01)]  # MIL-STD-810H 514.8: -6 dB/octave from 1000 to 2000 Hz
NAVMAT = [(20, 0.01), (80, 0.04), (350, 0.04), (2000, 0.007)]  # NAVMAT P-9492


@pytest.mark.parametrize(("shape", "rms"), [(MINIMUM_INTEGRITY, 7.69), (NAVMAT, 6.06)], ids=["810H", "NAVMAT"])
def test_published_shapes_have_their_published_rms(shape, rms):
    assert psd_rms(shape) == pytest.approx(rms, abs=0.005)  # g, as printed
    assert psd_rms(psd_from_g(shape)) == pytest.approx(G * psd_rms(shape), rel=1e-14)


@pytest.mark.parametrize("slope", [-3.0, -1.0, -1.0 + 1e-9, 0.0, 2.5])
def test_the_integral_is_exact_for_every_slope(slope):
    shape = [(10.0, 2.0), (90.0, 2.0 * 9.0**slope)]
    low, high = psd_power(shape, [30.0, 70.0])
    numerical, _ = quad(lambda f: 2.0 * (f / 10.0) ** slope, 30.0, 70.0, epsabs=0, epsrel=1e-13)
    # The slope itself is only known to 1e-16/ln 9 from the points; the quadrature was asked for 1e-13.
    assert high - low == pytest.approx(numerical, rel=1e-12)


STEP = [(10, 0.01), (100, 0.01), (100, 0.001), (500, 0.001)]


def test_two_points_of_one_frequency_are_a_step():
    assert psd_rms(STEP) == pytest.approx(math.sqrt(0.01 * 90.0 + 0.001 * 400.0), rel=1e-14)  # 1.1402 g
    np.testing.assert_allclose(psd_level(STEP, [99.9, 100.0, 100.1]), [0.01, 0.001, 0.001], rtol=1e-12)
    np.testing.assert_allclose(psd_power(STEP, [100.0, 200.0]), [0.9, 1.0], rtol=1e-14)
    motion = RandomVibration(psd=psd_from_g(STEP), duration=10.0, seed=1, direction="z")
    assert motion.rms == pytest.approx(G * psd_rms(STEP), rel=1e-14)
    assert motion_from_dict(motion.to_dict()) == motion
    # Of an oscillator far from the step by the density that it sees alone: Miles' formula, for 60 Hz within 2 %.
    (seen,) = vibration_response_spectrum(STEP, [60.0], q=50.0).acceleration
    assert seen == pytest.approx(math.sqrt(0.5 * math.pi * 60.0 * 50.0 * 0.01), rel=0.02)


@pytest.mark.parametrize(
    ("points", "words"),
    [
        ([(10, 1.0), (10, 2.0), (20, 2.0)], "must increase, got 10 Hz after 10 Hz, as point 2"),
        ([(10, 1.0), (20, 1.0), (20, 2.0)], "must go on behind the step at 20 Hz"),
        ([(10, 1.0), (20, 1.0), (20, 2.0), (20, 3.0), (30, 3.0)], "must increase, got 20 Hz after 20 Hz, as point 4"),
    ],
)
def test_a_step_stands_between_two_bands_and_has_two_levels(points, words):
    with pytest.raises(ValueError, match=words):
        psd_rms(points)


def test_levels_are_straight_on_logarithmic_axes_and_zero_outside():
    levels = psd_level(MINIMUM_INTEGRITY, [19.9, 20.0, 500.0, 1000.0, math.sqrt(2) * 1000.0, 2000.0, 2000.1])
    np.testing.assert_allclose(levels, [0.0, 0.04, 0.04, 0.04, 0.02, 0.01, 0.0], rtol=1e-13)
    total = psd_power(MINIMUM_INTEGRITY, [0.0, 20.0, 1000.0, 2000.0, 9999.0])
    # 0.04 * 980, and 0.04 * 1000^2 (1/1000 - 1/2000) = 20 for the slope -2
    np.testing.assert_allclose(total, [0.0, 0.0, 39.2, 59.2, 59.2], rtol=1e-13)


@pytest.mark.parametrize(
    ("points", "message"),
    [
        ([(20, 0.04), (10, 0.04)], "frequencies of `psd` must increase, got 10 Hz after 20 Hz, as point 2"),
        ([(20, 0.04), (20, 0.01)], "frequencies of `psd` must increase"),
        ([(20, 0.04), (30, 0.0)], "`psd`, point 2: `level` must be > 0, got 0.0"),
        ([(20, -0.04), (30, 1.0)], "`psd`, point 1: `level` must be > 0, got -0.04"),
        ([(0, 0.04), (30, 1.0)], "`psd`, point 1: `frequency` must be > 0, got 0.0"),
        ([(20, math.nan), (30, 1.0)], "`psd`, point 1: `level` must be a finite number, got nan"),
        ([(20, 0.04)], "`psd` must have at least 2 points, got 1"),
        ([20, 0.04], "`psd` must be pairs of frequency .* got 20 as point 1"),
        ([(20, 0.04, 1), (30, 1)], "`psd` must be pairs"),
    ],
)
def test_points_that_are_no_density_are_refused(points, message):
    with pytest.raises(ValueError, match=message):
        psd_rms(points)


BANDS = "from [Hz], to [Hz], psd [g^2/Hz], slope [dB/oct]\n"


def test_bands_with_slopes_are_what_a_specification_prints(tmp_path):
    """NAVMAT P-9492: +3 dB/octave to 80 Hz, 0.04 g^2/Hz, -3 dB/octave from 350 Hz; it states 6.06 g rms."""
    (tmp_path / "p.csv").write_text(BANDS + "20,80,,3\n80,350,0.04,\n350,2000,,-3\n")
    points = psd_points(tmp_path / "p.csv")
    exponent = 3.0 / (10.0 * np.log10(2.0))
    expected = [(20.0, 0.04 * 0.25**exponent), (80.0, 0.04), (350.0, 0.04), (2000.0, 0.04 * (350.0 / 2000.0) ** exponent)]
    np.testing.assert_allclose(points, [(f, level * G**2) for f, level in expected], rtol=1e-12)
    assert round(psd_rms(points) / G, 2) == 6.06
    (tmp_path / "p.csv").write_text(BANDS + "10,20,0.01,\n20,40,0.02,\n40,80,,-6\n")  # a step, and a slope from before
    points = psd_points(tmp_path / "p.csv")
    assert [frequency for frequency, _ in points] == [10.0, 20.0, 20.0, 40.0, 80.0]
    assert points[-1][1] / points[-2][1] == pytest.approx(10.0**-0.6, rel=1e-12)


@pytest.mark.parametrize(
    ("rows", "message"),
    [
        ("20,80,,3\n80,200,,-3\n", "line 1: no band has a level; one with a slope goes on from it"),
        ("20,80,0.04,\n100,200,,-3\n", "line 3: the band must begin at 80 Hz, where the one before ends, .* got 100 to 200 Hz"),
        ("0,80,0.04,\n", "line 2: the band must begin above 0 Hz and end above its begin, got 0 to 80 Hz"),
        ("20,80,0.04,3\n", "line 2: a band has either a level > 0 or a slope, the other cell is empty"),
        (
            "10,40,0.01,\n40,80,,3\n80,200,0.04,\n",
            "from 40 Hz ends 3 dB below the level from 80 Hz on; 6.02 dB/octave",
        ),
        ("20,80,,\n", "line 2: a band has either a level > 0 or a slope"),
        ("20,80,-1,\n", "line 2: a band has either a level > 0"),
    ],
)
def test_bands_that_say_too_much_or_too_little_are_named(tmp_path, rows, message):
    (tmp_path / "p.csv").write_text(BANDS + rows)
    with pytest.raises(wr.RecordError, match=message):
        psd_points(tmp_path / "p.csv")
