"""ISO 2631-1: weightings against the standard's tables, histories against SciPy's analogue filters, doses in closed form."""

import math

import numpy as np
import pytest
import scipy

from wirerope_mj.assessment.comfort import WEIGHTINGS, exposure, weighted

pytestmark = pytest.mark.quick

# ISO 2631-1, tables 3 and 4: factors at the nominal frequencies of third-octave bands [Hz]
TABLES = {
    "Wk": {
        0.5: 0.418,
        1.0: 0.482,
        2.0: 0.531,
        4.0: 0.967,
        6.3: 1.054,
        8.0: 1.036,
        16.0: 0.768,
        31.5: 0.405,
        80.0: 0.132,
    },
    "Wd": {0.5: 0.853, 1.0: 1.011, 2.0: 0.890, 4.0: 0.512, 8.0: 0.253, 16.0: 0.125, 31.5: 0.0632},
    "Wf": {0.1: 0.695, 0.125: 0.895, 0.16: 1.006, 0.2: 0.992, 0.25: 0.854, 0.315: 0.619, 0.4: 0.384, 0.5: 0.224},
}


@pytest.mark.parametrize(("name", "frequency", "factor"), [(n, f, w) for n, row in TABLES.items() for f, w in row.items()])
def test_weightings_are_those_of_the_tables(name, frequency, factor):
    assert abs(WEIGHTINGS[name].gain(frequency)) == pytest.approx(factor, abs=8e-4)  # three digits


@pytest.mark.parametrize(
    ("name", "omega", "factor"),
    [("Wk", 100.0, 0.7718), ("Wd", 100.0, 0.1261), ("Wm", 100.0, 0.3362), ("Wf", 2.5, 0.3888)],
)
def test_weightings_at_the_reference_frequency_of_iso_8041(name, omega, factor):
    assert abs(WEIGHTINGS[name].gain(omega / (2.0 * math.pi))) == pytest.approx(factor, abs=6e-5)


def analogue(weighting):
    """Return the filter as polynomials of s, built from its factors by SciPy."""
    two_pi, root = 2.0 * math.pi, math.sqrt(2.0)
    low, high, f3, f4 = (two_pi * f for f in (weighting.low, weighting.high, weighting.f3, weighting.f4))
    factors = [([1.0, 0.0, 0.0], [1.0, root * low, low**2]), ([high**2], [1.0, root * high, high**2])]
    top = [1.0] if math.isinf(f3) else [1.0 / f3, 1.0]
    factors.append((top, [1.0 / f4**2, 1.0 / (weighting.q4 * f4), 1.0]))
    if weighting.step:
        w5, q5, w6, q6 = weighting.step[0] * two_pi, weighting.step[1], weighting.step[2] * two_pi, weighting.step[3]
        factors.append(([1.0, w5 / q5, w5**2], [1.0, w6 / q6, w6**2]))
    numerator, denominator = [1.0], [1.0]
    for up, down in factors:
        numerator, denominator = np.polymul(numerator, up), np.polymul(denominator, down)
    return scipy.signal.TransferFunction(numerator, denominator)


@pytest.mark.parametrize("name", ["Wk", "Wd", "Wf"])
def test_a_pulse_is_weighted_as_by_an_analogue_filter(name):
    rate = 2000.0
    time = np.arange(int(12.0 * rate)) / rate
    pulse = 5.0 * np.where(time < 0.5, np.sin(2.0 * np.pi * time) ** 2, 0.0)
    _, expected, _ = scipy.signal.lsim(analogue(WEIGHTINGS[name]), pulse, time)
    found = weighted(pulse[:, None], rate, name)[:, 0]
    assert np.abs(found - expected).max() < 2e-4 * np.abs(expected).max()  # what has not rung out within the padding


def test_doses_of_a_sine():
    """A sine of amplitude A for T: rms A/sqrt2, running rms alike, crest sqrt2, dose (3/8 T)^(1/4) A, MSDV rms sqrt T."""
    rate, length, amplitude, frequency = 500.0, 60.0, 0.8, 10.0  # the filters have rung out after the first 5 s
    time = np.arange(int((length + 5.0) * rate) + 1) / rate
    history = amplitude * np.sin(2.0 * np.pi * frequency * time)
    found = exposure(time, np.stack([history, 0.0 * history, 2.0 * history], axis=1), discard=5.0)
    for axis, (name, size) in enumerate((("Wd", 1.0), ("Wd", 0.0), ("Wk", 2.0))):
        steady = size * amplitude * abs(WEIGHTINGS[name].gain(frequency))
        assert found.rms[axis] == pytest.approx(steady / math.sqrt(2.0), rel=1e-4)
        assert found.dose[axis] == pytest.approx((3.0 / 8.0 * length) ** 0.25 * steady, rel=1e-4)
        assert found.running[axis] == pytest.approx(found.rms[axis], rel=1e-3)
    assert found.crest[0] == pytest.approx(math.sqrt(2.0), rel=1e-3)
    assert math.isnan(found.crest[1])
    swell = np.sin(2.0 * np.pi * 0.2 * time)
    sick = exposure(time, np.stack([0.0 * swell, 0.0 * swell, swell], axis=1), discard=20.0)
    expected = abs(WEIGHTINGS["Wf"].gain(0.2)) / math.sqrt(2.0) * math.sqrt(45.0)
    assert sick.sickness == pytest.approx(expected, rel=2e-3)
    assert sick.duration == pytest.approx(45.0, abs=0.003)


def test_what_is_left_out_must_leave_something():
    time = np.linspace(0.0, 1.0, 101)
    with pytest.raises(ValueError, match="must leave something of the 1 s, got 2 s"):
        exposure(time, np.zeros((101, 3)), discard=2.0)
    with pytest.raises(ValueError, match="must leave something"):
        exposure(time, np.zeros((101, 3)), discard=1e308)
