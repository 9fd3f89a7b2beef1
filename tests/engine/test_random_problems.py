"""A few of the problems of `python -m verification.random_problems`, whose campaign draws two hundred."""

import pytest

from verification.drawn_problems import draw
from verification.random_problems import compare


@pytest.mark.slow  # the reference takes ten seconds a problem, and as long to be compiled
@pytest.mark.parametrize(("seed", "stopped"), [(4, False), (6, True), (9, True), (99, True), (155, False)])
def test_drawn_problems_are_computed_to_the_accuracy_asked(seed, stopped):
    result = compare(draw(seed, stopped=stopped))
    assert result.kept == "kept", f"{result.error:.1e} at {result.where}, the reference itself {result.reference:.1e}"
    assert result.struck == stopped
