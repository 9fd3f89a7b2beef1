import math

import numpy as np
import pyarrow as pa
import pytest

from wirerope_mj.content.study_statements import exceeding_inputs, inputs_text


def test_a_limit_is_crossed_between_two_variants_whatever_their_order():
    table = pa.table({"motion/level": [30.0, 10.0, 20.0, 15.0]})
    values = np.array([1.6, 0.4, 1.2, math.nan])  # the one that failed is no neighbour
    words = exceeding_inputs(table, ["motion/level"], values, 1.0)
    assert words == ", first at motion/level 17.5 (interpolated between 10 and 20)"  # 10 + 10 (1 - 0.4) / (1.2 - 0.4)


def test_what_is_beyond_from_the_beginning_is_not_interpolated():
    table = pa.table({"motion/level": [1.0, 2.0]})
    assert exceeding_inputs(table, ["motion/level"], np.array([1.5, 2.0]), 1.0) == ", already at motion/level 1"


@pytest.mark.parametrize("values", [[0.1, 0.2], [math.nan, 0.2]])
def test_nothing_is_said_where_no_limit_is_exceeded(values):
    assert exceeding_inputs(pa.table({"motion/level": [1.0, 2.0]}), ["motion/level"], np.array(values), 1.0) == ""


def test_choices_beyond_the_limit_are_named_as_far_as_anyone_reads():
    table = pa.table({"mount/*/failed": ["", *(f"m{number}" for number in range(11))]})
    few = np.where(np.arange(12) < 2, 1.5, 0.5)
    assert exceeding_inputs(table, ["mount/*/failed"], few, 1.0) == " (mount/*/failed: none, m0)"
    assert exceeding_inputs(table, ["mount/*/failed"], np.full(12, 2.0), 1.0).endswith("m6 and 4 more)")


def test_inputs_are_told_where_they_are_few():
    row = {"motion/azimuth": -30.0, "motion/elevation": 60.0, "body/a/mass": 1.0}
    names = list(row)
    assert inputs_text(row, names[:2]) == " (motion/azimuth -30, motion/elevation 60)"
    assert inputs_text(row, names) == ""
