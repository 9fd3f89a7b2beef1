"""Test spectra and transmissibility limits: where a curve comes nearest to what is allowed."""

import numpy as np
import pytest

import wirerope_mj as wr
from wirerope_mj.assessment.criteria import spectrum_verdict

pytestmark = pytest.mark.quick

D, LEVEL = 0.011, 100.0


@pytest.fixture(scope="module")
def spectrum():
    """Return the spectrum of a half-sine at Q = 10: 1.652 times its peak at f D = 0.82."""
    time = np.arange(1101) * 1e-5
    return wr.shock_response_spectrum(time, LEVEL * np.sin(np.pi * time / D), np.geomspace(10.0, 1000.0, 401))


def test_a_level_test_spectrum_is_judged_at_the_peak(spectrum):
    for level, word in ((166.0, "within"), (164.0, "exceeded")):
        verdict = spectrum_verdict(spectrum, [5.0, 2000.0], [level, level], subject="rack")
        assert verdict.verdict == word
        assert verdict.value == pytest.approx(165.2, rel=1e-3)
        assert verdict.limit == pytest.approx(level)
        assert float(verdict.note.split()[1]) == pytest.approx(0.82 / D, rel=0.02)  # the grid is 1.2 % wide
        assert "Q = 10" in verdict.note


def test_the_worst_frequency_is_that_of_the_largest_ratio(spectrum):
    """A test spectrum that rises with the frequency allows least where it is low: the slow end, PSV = 0.92 dV."""
    verdict = spectrum_verdict(spectrum, [10.0, 100.0, 1000.0], [30.0, 300.0, 300.0], subject="rack")
    share = spectrum.maximax / np.minimum(3.0 * spectrum.frequencies, 300.0)
    assert verdict.utilisation == pytest.approx(share.max())
    assert verdict.limit == pytest.approx(3.0 * spectrum.frequencies[share.argmax()])


def test_only_common_frequencies_are_judged_and_that_is_said(spectrum):
    verdict = spectrum_verdict(spectrum, [200.0, 5000.0], [500.0, 500.0], subject="rack")
    inside = spectrum.frequencies >= 200.0
    assert verdict.value == spectrum.maximax[inside].max()
    assert "of 200 to 5000 Hz" in verdict.note
    with pytest.raises(ValueError, match="2000 to 5000 Hz, does not overlap the spectrum's 10 to 1000 Hz"):
        spectrum_verdict(spectrum, [2000.0, 5000.0], [1.0, 1.0], subject="rack")


def test_of_several_directions_the_largest_counts():
    time = np.arange(1101) * 1e-5
    pulse = LEVEL * np.sin(np.pi * time / D)
    three = wr.shock_response_spectrum(time, np.column_stack([0.5 * pulse, pulse, 0.0 * pulse]), [30.0, 75.0])
    verdict = spectrum_verdict(three, [20.0, 80.0], [200.0, 200.0], subject="rack")
    assert verdict.value == three.maximax[1, 1]


@pytest.mark.parametrize(
    ("frequency", "value", "message"),
    [
        ([10.0, 5.0], [1.0, 1.0], "must have increasing frequencies, got 10, 5"),
        ([10.0, 20.0], [1.0], "as many frequencies as values"),
        ([0.0, 20.0], [1.0, 1.0], "finite frequencies and values > 0"),
    ],
)
def test_a_test_spectrum_must_be_a_curve(spectrum, frequency, value, message):
    with pytest.raises(ValueError, match=message):
        spectrum_verdict(spectrum, frequency, value, subject="rack")
