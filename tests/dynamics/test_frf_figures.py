"""What is read off branches and sweeps: the curve between points, ticks, differences and jumps, on made-up branches."""

from dataclasses import dataclass, field
from types import SimpleNamespace

import numpy as np
import pytest
from hypothesis import example, given
from hypothesis import strategies as st

from wirerope_mj.dynamics.frequency_response.summary import along_branch, along_resonance, compare, curve_of
from wirerope_mj.dynamics.periodic import Jump
from wirerope_mj.foundation.ticks import linear_ticks, log_ticks

pytestmark = pytest.mark.quick


@dataclass
class MadeUp:
    """The parts of a branch that are looked at: folds at 11.95 Hz and 11.375 Hz, unstable in between."""

    frequency: np.ndarray
    amplitude: np.ndarray
    stable: np.ndarray
    folds: list = field(default_factory=list)
    jumps: list = field(default_factory=list)

    @property
    def peak(self):
        return int(np.argmax(self.amplitude))


def folded(points=61):
    """Return a branch like that of a hardening mount, by a closed form."""
    course = np.linspace(0.0, 1.0, points)
    frequency = 8.0 + 80.0 * (course**3 / 3.0 - 0.575 * course**2 + 0.3 * course)  # turns at 0.4 and 0.75 of the course
    amplitude = 2.0 + 30.0 * np.exp(-(((course - 0.35) / 0.12) ** 2))
    return MadeUp(frequency=frequency, amplitude=amplitude, stable=(course <= 0.4) | (course >= 0.75))


def test_the_curve_goes_through_its_points_and_follows_the_folds():
    branch, fine = folded(), folded(60 * 400 + 1)
    curve = curve_of(branch)
    np.testing.assert_allclose(curve.frequency[::16], branch.frequency, rtol=1e-12)
    np.testing.assert_allclose(curve.amplitude[::16], branch.amplitude, rtol=1e-12)
    assert len(curve.runs) == 3
    rising = fine.frequency[:9600]  # of the closed form up to its first turn, at 0.4 of the course
    run = curve.runs[0]
    expected = np.interp(curve.frequency[run], rising, fine.amplitude[:9600])
    # Cubic pieces over a sixtieth of the branch, whose bell is a tenth of it wide; at the turn itself any error in frequency
    # is one of its root in amplitude.
    inside = curve.frequency[run] < 0.99 * rising.max()
    np.testing.assert_allclose(curve.amplitude[run][inside], expected[inside], rtol=5e-3)


def test_points_that_coincide_are_one():
    branch = folded()
    twice = MadeUp(*(np.insert(part, 20, part[20]) for part in (branch.frequency, branch.amplitude, branch.stable)))
    np.testing.assert_allclose(curve_of(twice).amplitude, curve_of(branch).amplitude, rtol=1e-12)
    assert curve_of(twice).point[-1] == 61


def test_a_curve_has_as_many_amplitudes_as_motions_at_a_frequency():
    curve = curve_of(folded())
    turn = curve.frequency[curve.runs[0]].max()
    back = curve.frequency[curve.runs[1]].min()
    inside, outside = 0.5 * (turn + back), 1.05 * turn
    found = curve.amplitudes_at(np.array([inside, outside]))
    assert [int(np.isfinite(amplitude[0])) for amplitude, _ in found] == [1, 1, 1]
    assert [bool(stable[0]) for _, stable in found] == [True, False, True]
    assert sum(np.isfinite(amplitude[1]) for amplitude, _ in found) == (1 if outside < curve.frequency[-1] else 0)


def test_a_sweep_is_compared_with_the_stable_motions_and_its_jump_is_found():
    branch = folded(401)
    curve = curve_of(branch)
    first = curve.runs[0]
    turn = float(curve.frequency[first].max())
    last = curve.runs[2]
    rising = np.linspace(8.05, 12.4, 400)
    above = np.interp(rising, curve.frequency[first], curve.amplitude[first])
    below = np.interp(rising, curve.frequency[last], curve.amplitude[last])
    jumped_at = 1.004 * turn
    amplitude = 1.002 * np.where(rising < jumped_at, above, below)
    branch.folds = [SimpleNamespace(frequency=turn)]
    branch.jumps = [Jump(parameter=turn, rising=True, amplitude=30.0, landing=2.0)]
    found = compare(SimpleNamespace(frequency=rising, amplitude=amplitude), branch, curve)
    assert found.median == pytest.approx(0.002, rel=1e-6)
    assert found.largest == pytest.approx(0.002, rel=1e-6)
    (jump,) = found.jumps
    assert jump.fold == turn
    assert jump.frequency == pytest.approx(jumped_at, abs=rising[1] - rising[0])
    falling = compare(SimpleNamespace(frequency=rising[::-1], amplitude=amplitude[::-1]), branch, curve)
    assert falling.jumps == ()  # this fold is no place where a falling sweep jumps


def test_motions_along_the_resonance_stand_on_both_sides_of_the_highest():
    branch = folded()
    points = along_resonance(branch)
    assert branch.peak in points
    assert len(points) == 5
    shares = branch.amplitude[points] / branch.amplitude.max()
    assert (np.diff(shares[:3]) > 0).all()
    assert (np.diff(shares[2:]) < 0).all()


@pytest.mark.parametrize("points", [1, 2, 3, 61, 500])
def test_a_film_has_the_same_number_of_motions_whatever_the_branch(points):
    whole = folded(500)
    branch = MadeUp(whole.frequency[:points], whole.amplitude[:points], whole.stable[:points])
    chosen = along_branch(branch, curve_of(branch), 60)
    assert chosen.size == 60
    assert (np.diff(chosen) >= 0).all()
    assert {0, branch.peak, points - 1} <= set(chosen.tolist())


@given(low=st.floats(1e-3, 1e3), ratio=st.floats(1.02, 1e4))
def test_ticks_are_inside_the_range_rise_and_are_neither_few_nor_many(low, ratio):
    ticks = log_ticks(low, low * ratio)
    assert 2 <= ticks.size <= 13
    assert (np.diff(ticks) > 0).all()
    assert ticks[0] >= low * (1 - 1e-6)
    assert ticks[-1] <= low * ratio * (1 + 1e-6)


@given(low=st.floats(1e-3, 1e4), ratio=st.floats(1.02, 1e4), most=st.integers(4, 18))
@example(low=100.0, ratio=9.0, most=3)
@example(low=5.0, ratio=200.0, most=3)
@example(low=150.0, ratio=6.7, most=4)  # were 200, 400, 600, 800, one into the other
@example(low=701.0, ratio=2.125, most=4)  # were 800, 1000, 1200, 1400, the last two closer than four fit
@example(low=1.013, ratio=2.78, most=4)  # were 1.5, 2, 2.5
@example(low=2.153e-3, ratio=4.53, most=4)  # were 0.004, 0.006, 0.008
@example(low=8.2, ratio=5.2, most=4)  # were 20, 40, without 10
def test_labels_of_a_logarithmic_axis_name_every_decade_and_stand_apart(low, ratio, most):
    high = low * ratio
    ticks = log_ticks(low, high, most=most)
    decades = [10.0**n for n in range(-3, 9) if low <= 10.0**n <= high]
    assert all(np.isclose(ticks, decade, rtol=1e-9).any() for decade in decades)
    assert ticks.size >= 2
    if ratio > 2.0:  # in a narrower range two round numbers may have to do, wherever they are
        assert np.diff(np.log(ticks)).min() >= 0.9 * np.log(ratio) / most * (1.0 - 1e-9)


def test_of_more_decades_than_fit_every_third_is_named():
    np.testing.assert_allclose(log_ticks(1e-6, 1e4, most=3), [1e-6, 1e-3, 1.0, 1e3])


def test_ticks_of_a_narrow_range_are_round_numbers():
    np.testing.assert_allclose(log_ticks(34.0, 39.0), [34, 35, 36, 37, 38, 39], rtol=1e-12)
    np.testing.assert_allclose(linear_ticks(-1.0, 1.0), [-1, -0.5, 0, 0.5, 1], atol=1e-12)
