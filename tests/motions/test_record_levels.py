"""What a sensor makes of its own zero is named: a level that shifts in the shock, and AC coupling that ends at rest."""

import re
import warnings

import numpy as np
import pytest
import scipy.signal

from wirerope_mj.foundation.errors import RecordWarning
from wirerope_mj.motions import load_record

pytestmark = pytest.mark.quick

G = 9.80665
RATE = 5000.0
CLOCK = np.arange(int(4.0 * RATE)) / RATE


def half_sine(peak, duration, at):
    inside = (at < CLOCK) & (at + duration > CLOCK)
    return np.where(inside, peak * np.sin(np.pi * (CLOCK - at) / duration), 0.0)


def said_of(tmp_path, values, **options):
    """Return the warnings about an acceleration [m/s^2] at 5 kHz."""
    path = tmp_path / "r.csv"
    np.savetxt(path, np.column_stack([CLOCK, values]), delimiter=",", header="time [s],z [m/s^2]", comments="", fmt="%.6g")
    with warnings.catch_warnings():
        warnings.simplefilter("ignore", RecordWarning)
        return load_record(path, **options).warnings


@pytest.mark.parametrize("baseline", ["none", "rest", "mean", "velocity"])
@pytest.mark.parametrize(("before", "after"), [(1.6, 0.55), (0.0, 0.4), (1.0, 0.6), (-0.1, 0.1)])
def test_a_level_that_shifts_in_the_shock_is_named_whatever_baseline(tmp_path, baseline, before, after):
    noise = 0.03 * np.random.default_rng(3).standard_normal(CLOCK.size)
    values = G * (half_sine(50.0, 0.011, 1.5) + np.where(CLOCK < 1.505, before, after) + noise)
    said = said_of(tmp_path, values, baseline=baseline)
    (shift,) = [text for text in said if "level changes" in text]
    # medians of 7500 samples of noise of 0.3 m/s^2 are known to 0.005 m/s^2
    numbers = [float(text) for text in re.search(r"from ([-\d.e]+) to ([-\d.e]+) m/s\^2 at ([\d.]+) s", shift).groups()]
    np.testing.assert_allclose(numbers, [before * G, after * G, 1.505], atol=0.02)
    assert not [text for text in said if "unit" in text and "9.81" in text]


@pytest.mark.parametrize("stages", [1, 2])
@pytest.mark.parametrize("limit", [0.3, 1.0, 3.0, 8.0])
@pytest.mark.parametrize(("peak", "duration"), [(15.0, 0.011), (100.0, 0.006), (8.0, 0.011), (15.0, 0.025), (-10.0, 0.04)])
def test_ac_coupling_is_not_taken_for_a_base_that_ends_at_rest(tmp_path, stages, limit, peak, duration):
    values = G * half_sine(peak, duration, 0.5)
    kept = 1.0 / (1.0 + 2.0 * np.pi * limit / RATE)
    for _ in range(stages):
        values = scipy.signal.lfilter([kept, -kept], [1.0, -kept], values)
    # an undershoot of 1 to 145 % of the peak
    values += 0.002 * np.ptp(values) * np.random.default_rng(1).standard_normal(CLOCK.size)
    (coupling,) = [text for text in said_of(tmp_path, values) if "AC coupling with a lower limit" in text]
    # the foot of the pulse, a tenth of its peak, counts as what follows it
    assert float(re.search(r"about ([\d.]+) Hz", coupling)[1]) == pytest.approx(limit, rel=0.1)


MOTIONS = {
    "half-sine": half_sine(150.0, 0.011, 0.5),
    "braked": half_sine(150.0, 0.011, 0.5) - half_sine(150.0 * 0.011 / 0.3, 0.3, 0.52),
    "braked at once": half_sine(150.0, 0.03, 0.5) - half_sine(150.0 * 0.03 / 0.2, 0.2, 0.53),
    "shaker": half_sine(150.0, 0.011, 0.5) - half_sine(8.25, 0.1, 0.4) - half_sine(8.25, 0.1, 0.511),
    "double": half_sine(600.0, 0.006, 0.5) - half_sine(200.0, 0.018, 0.506),
    "double, nearly alike": half_sine(600.0, 0.011, 0.5) - half_sine(440.0, 0.015, 0.511),
    "ringing": np.where(CLOCK > 0.5, 40.0 * np.exp(-5.0 * (CLOCK - 0.5)) * np.sin(50.0 * (CLOCK - 0.5)), 0.0),
    "swing": 2.0 * np.sin(0.9 * CLOCK) + half_sine(150.0, 0.011, 1.5),
    "offset": half_sine(150.0, 0.011, 0.5) + 3.0,
}


@pytest.mark.parametrize("name", MOTIONS)
def test_motions_that_end_at_rest_by_themselves_are_not_suspected(tmp_path, name):
    values = MOTIONS[name] + 0.05 * np.random.default_rng(5).standard_normal(CLOCK.size)
    assert not [text for text in said_of(tmp_path, values) if "AC coupl" in text or "level changes" in text]
