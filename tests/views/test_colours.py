"""The table of colours: read by everybody, on both grounds."""

import itertools

import pytest

from wirerope_mj.content.selection import numbered
from wirerope_mj.views.colours import DARK, LIGHT, Colours, hexadecimal, used_colour
from wirerope_mj.views.recording.drawn_runs import COLORS

coloraide = pytest.importorskip("coloraide")
pytestmark = pytest.mark.quick

FILTERS = (None, "protan", "deutan", "tritan")


def color(rgb, kind=None):
    plain = coloraide.Color("srgb", [part / 255.0 for part in rgb])
    return plain.filter(kind) if kind else plain


def apart(one, other) -> float:
    """Return the least CIEDE2000 difference, for who sees all colours and for who lacks one kind of cones."""
    return min(color(one, kind).delta_e(color(other, kind), method="2000") for kind in FILTERS)


@pytest.mark.parametrize("ground", [DARK, LIGHT], ids=["dark", "light"])
def test_texts_in_every_colour_can_be_read(ground: Colours):
    for rgb in (*ground.series, ground.limit, ground.base, ground.others):
        assert color(rgb).contrast(color(ground.ground), method="wcag21") >= 4.5, rgb


@pytest.mark.parametrize("ground", [DARK, LIGHT], ids=["dark", "light"])
def test_neighbours_are_told_apart_whatever_cones_are_missing(ground: Colours):
    for one, other in itertools.pairwise((*ground.series, ground.limit)):
        assert apart(one, other) >= 8.0, (one, other)
    # Only a few are drawn together: the first three of them, with the limit and the grey of the others.
    for one, other in itertools.combinations((*ground.series[:3], ground.limit, ground.others), 2):
        assert apart(one, other) >= 8.0, (one, other)


def test_runs_over_each_other_are_told_apart():
    for one, other in itertools.pairwise(COLORS):
        assert apart(one, other) >= 8.0, (one, other)


def test_a_name_has_one_colour_and_those_of_one_group_differ():
    numbers = numbered([["a", "b", "c"], ["c", "d", "e"], ["a", "f", "g"], ["h", "a", "b"]])
    assert [numbers[name] for name in "abc"] == [0, 1, 2]
    for group in ("abc", "cde", "afg", "hab"):
        assert len({numbers[name] for name in group}) == 3


def test_utilisations_are_blue_up_to_their_limit_and_red_beyond():
    colours = [used_colour(value) for value in (0.0, 0.5, 1.0, 1.001, 7.0)]
    assert len(set(colours)) == 4
    assert colours[2] == hexadecimal(LIGHT.series[0])
    assert colours[3] == colours[4] == hexadecimal(LIGHT.limit)
