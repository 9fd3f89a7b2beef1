"""Laws in parallel keep on every path what each of them keeps, and are the sum of them."""

from dataclasses import replace

import numpy as np
from examples_drawn import examples
from hypothesis import given
from laws_for_tests import STRATEGIES, parallel_laws, passive, path_through, smooth_path, turning_points

few = examples(40)
drawn = parallel_laws()


def traced(law, points, *, per_segment=8):
    x, time, rate = smooth_path(points, per_segment=per_segment)
    return law.trace(x, time=time, rate=rate)


@given(law=drawn, points=turning_points)
@few
def test_laws_in_parallel_are_their_sum(law, points):
    whole, parts = traced(law, points), [traced(one, points) for one in law.components]
    for name in ("force", "work", "hysteretic_state"):
        total = sum(getattr(part, name) for part in parts)
        size = max(sum(np.abs(getattr(part, name)).max() for part in parts), 1e-3)
        # Closed forms in one order; those that are integrated take steps of their own, to 1e-8 each.
        np.testing.assert_allclose(getattr(whole, name), total, rtol=0, atol=1e-7 * size)
    assert whole.internal_states.shape[1] == len(law.state_names) == sum(one.n_states for one in law.components)


@given(law=drawn.filter(passive), points=turning_points)
@few
def test_no_path_from_the_unloaded_state_gains_work(law, points):
    work = traced(law, points, per_segment=12).work
    # What is below zero by more than the integration's error would be made from nothing.
    assert work.min() >= -1e-8 * max(1.0, np.abs(work).max())


@given(law=drawn, points=turning_points)
@few
def test_a_path_step_by_step_is_the_path_at_once(law, points):
    x, time, rate = smooth_path(points, per_segment=5)
    loop, states = law.trace(x, time=time, rate=rate), np.zeros(law.n_states)
    for i in range(x.size - 1):
        two = slice(i, i + 2)
        step = law.trace(x[two], time=time[two], rate=rate[two], initial_states=states)
        states = step.internal_states[-1]
        assert step.force[-1] == loop.force[i + 1]  # the same operations on the same numbers
    np.testing.assert_array_equal(states, loop.internal_states[-1])


@given(
    law=drawn.filter(lambda law: law.rate_independent) | STRATEGIES["stop"].map(lambda law: replace(law, c=0.0)),
    points=turning_points,
)
@few
def test_a_path_does_not_depend_on_how_finely_it_is_sampled(law, points):
    fine, coarse = law.trace(path_through(points, per_segment=7)), law.trace([0.0, *points])
    for name in ("force", "work"):
        some, few_ones = getattr(fine, name), getattr(coarse, name)
        # A stop of a broken exponent that leaves its touch has a root at the segment's end: eight points sum it to 2e-7.
        np.testing.assert_allclose(some[::7], few_ones, rtol=0, atol=1e-6 * max(np.abs(few_ones).max(), 1e-3))
