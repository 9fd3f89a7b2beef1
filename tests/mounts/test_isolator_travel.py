"""How far deflections go in each way that an isolator is rated for."""

import numpy as np
import pytest

from wirerope_mj.mounts.isolator import AXES, Travel
from wirerope_mj.mounts.isolator.travel import (
    RATINGS,
    SIDES,
    largest_utilisation,
    travel_in,
    travel_reached,
    travel_utilisation,
)

# roll, shear, axial: pressed by 30 mm at most, pulled by 10 mm
LOWEST, HIGHEST = np.array([-0.002, -0.004, -0.030]), np.array([0.005, 0.001, 0.010])


def test_axial_has_two_ways_and_the_other_axes_count_both_as_one():
    assert travel_reached(LOWEST, HIGHEST) == {"compression": 0.030, "tension": 0.010, "shear": 0.004, "roll": 0.005}


def test_a_mount_that_never_leaves_compression_reaches_no_tension():
    reached = travel_reached(np.array([0.0, 0.0, -0.03]), np.array([0.0, 0.0, -0.01]))
    assert (reached["tension"], reached["compression"]) == (0.0, 0.03)
    assert not any(np.signbit(value) for value in reached.values())  # zeros of one kind, as tables are compared by bits


def test_the_farthest_of_many_instants_is_what_the_extremes_reach():
    deflection = np.random.default_rng(7).normal(size=(200, 5, 3))
    reached = travel_reached(deflection.min(axis=0), deflection.max(axis=0))
    for rating in RATINGS:
        np.testing.assert_array_equal(reached[rating], travel_in(rating, deflection).max(axis=0))


def test_utilisations_are_of_the_stated_ratings_only():
    rated = Travel(compression=0.04, shear=0.002).stated
    used = travel_utilisation(travel_reached(LOWEST, HIGHEST), rated)
    assert used == pytest.approx({"compression": 0.75, "shear": 2.0}, rel=1e-15)  # one division
    assert travel_utilisation(travel_reached(LOWEST, HIGHEST), Travel().stated) == {}


def test_the_largest_utilisation_of_each_mount_is_that_of_its_ratings():
    ratings = [Travel(compression=0.04, shear=0.002), Travel(roll=0.01), Travel()]
    reached = np.array([[0.03, 0.01, 0.004, 0.005]] * 3)
    rated = np.array([[travel.stated.get(rating, np.nan) for rating in RATINGS] for travel in ratings])
    used = largest_utilisation(reached, rated)
    each = [travel_utilisation(dict(zip(RATINGS, row, strict=True)), t.stated) for row, t in zip(reached, ratings, strict=True)]
    np.testing.assert_array_equal(used, [max(one.values(), default=np.nan) for one in each])
    assert np.isnan(used).tolist() == [False, False, True]
    # In tension alone, of which nothing is rated, only what is exceeded counts; in compression it is judged.
    hung, pressed = [0.0, 0.01, 0.001, 0.0], [0.01, 0.0, 0.001, 0.0]
    leaning = [0.0, 0.001, 0.0015, 0.0]  # farther in shear
    every = np.array([rated[0], [0.04, np.nan, 5e-4, np.nan], rated[0], rated[0]])
    used = largest_utilisation(np.array([hung, hung, pressed, leaning]), every)
    np.testing.assert_array_equal(used, [np.nan, 2.0, 0.5, 0.75])


def test_every_rating_is_a_side_of_one_axis_and_a_field_of_travel():
    assert tuple(SIDES) == AXES
    assert {rating for sides in SIDES.values() for rating in sides} == set(RATINGS)
    assert tuple(Travel(compression=1.0, tension=1.0, shear=1.0, roll=1.0).stated) == tuple(RATINGS)
    for rating, (axis, way) in RATINGS.items():
        sides = SIDES[AXES[axis]]
        assert [side == rating for side in sides] == [way <= 0.0, way >= 0.0]
