"""A peak is its numbers: what is made of values, of a list and for another timeline; and the peak of a base block by block."""

import copy
import pickle

import numpy as np
import pytest

from wirerope_mj.engine.response.peaks import Peak
from wirerope_mj.engine.simulation.stages import RunningPeak

pytestmark = pytest.mark.quick

VALUES = {
    "value": 5.0,
    "time": 0.25,
    "vector": np.array([3.0, 0.0, -4.0]),
    "minimum": np.array([-1.0, -2.0, -4.0]),
    "minimum_time": np.array([0.1, 0.2, 0.25]),
    "maximum": np.array([3.0, 2.0, 1.0]),
    "maximum_time": np.array([0.25, 0.4, 0.5]),
}
INSTANTS = ("time", "minimum_time", "maximum_time")


def as_plain(peak):
    return {name: np.asarray(getattr(peak, name)).tolist() for name in VALUES}


def test_a_peak_has_the_values_that_it_was_made_of():
    peak = Peak(**VALUES)
    expected = {name: np.asarray(value).tolist() for name, value in VALUES.items()}
    assert as_plain(peak) == expected
    assert (type(peak.value), type(peak.time)) == (float, float)
    for again in (Peak.from_list(peak.to_list()), pickle.loads(pickle.dumps(peak)), copy.deepcopy(peak)):
        assert as_plain(again) == expected
    assert len(peak.to_list()) == Peak.SIZE
    assert repr(peak).startswith("Peak(value=5.0, time=0.25, vector=array([ 3.,  0., -4.])")


def test_a_later_peak_differs_in_its_instants_alone():
    peak = Peak(**VALUES)
    later = peak.later(0.5)
    for name, value in VALUES.items():
        assert np.asarray(getattr(later, name)).tolist() == (value + 0.5 * (name in INSTANTS) * np.ones_like(value)).tolist()
    assert as_plain(peak) == as_plain(Peak(**VALUES))


def parabola(times):
    """Return a vector whose x is a parabola with its top, 2, at 0.3 s, and whose z is half of x turned round."""
    x = 2.0 - (times - 0.3) ** 2
    return np.column_stack([x, np.zeros_like(x), -0.5 * x])


def test_the_running_peak_is_refined_between_instants_and_keeps_the_larger_block():
    running = RunningPeak()
    running.add(times := np.linspace(0.0, 0.55, 12), parabola(times))
    running.add(times := np.linspace(1.0, 2.0, 12), 0.1 * parabola(times))
    first = running.peak
    np.testing.assert_allclose(first.maximum[0], 2.0, rtol=1e-14)  # rounding of a parabola through three of its points
    running.add(times := 0.02 + np.linspace(2.0, 2.55, 12), 1.5 * parabola(times - 2.0))
    peak = running.peak
    np.testing.assert_allclose([peak.maximum[0], peak.maximum_time[0]], [3.0, 2.3], rtol=1e-13)
    np.testing.assert_allclose([peak.minimum[2], peak.minimum_time[2]], [-1.5, 2.3], rtol=1e-13)
    assert peak.value > first.value
    assert (peak.maximum[1], peak.maximum_time[1]) == (0.0, 0.0)  # nothing moves there


def test_instants_that_stand_twice_are_one_for_the_parabola():
    times = np.array([0.0, 0.1, 0.1, 0.2, 0.2, 0.3])
    values = 1.0 - (times - 0.12) ** 2
    running = RunningPeak()
    running.add(times, np.column_stack([values, 0.0 * values, 0.0 * values]))
    assert running.peak.maximum[0] == pytest.approx(1.0, rel=1e-14)  # rounding; unrefined it is 1 - 4e-4
    assert running.peak.maximum_time[0] == pytest.approx(0.12, rel=1e-12)


def test_no_parabola_is_drawn_across_a_corner():
    """The two limits of a jump stand 2e-10 s apart: the larger is the peak as it is."""
    times = np.array([0.0, 0.1, 0.2 - 1e-10, 0.2 + 1e-10, 0.3, 0.4])
    values = np.array([1.0, 3.0, 5.0, 0.5, 0.4, 0.3])
    running = RunningPeak()
    running.add(times, np.column_stack([0.0 * values, values, 0.0 * values]))
    assert (running.peak.maximum[1], running.peak.maximum_time[1]) == (5.0, 0.2 - 1e-10)
