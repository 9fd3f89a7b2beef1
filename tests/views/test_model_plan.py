"""Plans of models from tables: what they name, and every dimension, can be read."""

import re
from dataclasses import replace
from itertools import combinations
from xml.etree import ElementTree

import pytest
from fontTools.ttLib import TTFont

from wirerope_mj.engine.from_tables import read_layout
from wirerope_mj.foundation.resources import models_folder
from wirerope_mj.runs.new_model import tables_in
from wirerope_mj.views.plots.letters import BROUGHT
from wirerope_mj.views.plots.model_plan import plan_svg

SVG = "{http://www.w3.org/2000/svg}"


@pytest.fixture(scope="module")
def genset():
    return read_layout("genset", tables_in(models_folder() / "templates" / "genset"))


@pytest.fixture(scope="module")
def width_of():
    """Width of a text in units of its height, by the font that it is drawn with."""
    with TTFont(BROUGHT[0], lazy=True) as font:
        letters, advances, em = font.getBestCmap(), font["hmtx"], font["head"].unitsPerEm
        yield lambda text: sum(advances[letters[ord(letter)]][0] for letter in text) / em


def overlap(box, other):
    return box[0] < other[2] and other[0] < box[2] and box[1] < other[3] and other[1] < box[3]


def views_of(layout):
    return [
        view for view in ElementTree.fromstring(plan_svg(layout)[0]).findall(SVG + "g") if view.find(SVG + "g") is not None
    ][:3]


@pytest.mark.quick
def test_no_name_lies_over_a_mark_or_another_name(genset, width_of):
    """In the plan of the template "engine" lay over a mount and "terminal_box" over a stop."""
    for view in views_of(genset):
        (inner,) = view.findall(SVG + "g")
        boxes = {}
        for text in inner.findall(f"{SVG}text[@class='name']"):
            x, y, size = (float(text.get(key)) for key in ("x", "y", "font-size"))
            boxes[text.text] = (x, y - 0.75 * size, x + size * width_of(text.text), y)
        assert {"engine", "terminal_box"} <= set(boxes)
        marks = [(float(mark.get("cx")), float(mark.get("cy"))) for mark in inner.findall(SVG + "circle")]
        marks += [(float(m.get("x")) + 3.0, float(m.get("y")) + 3.0) for m in inner.findall(f"{SVG}rect[@height='6']")]
        assert len(marks) >= len(genset.mounts) + len(genset.stops)
        for (name, box), (other, beside) in combinations(boxes.items(), 2):
            assert not overlap(box, beside), (name, other)
        for name, box in boxes.items():
            assert not any(overlap(box, (x - 3.0, y - 3.0, x + 3.0, y + 3.0)) for x, y in marks), name


def test_dimensions_between_close_mounts_stand_below_each_other(genset, width_of):
    close = [replace(mount, position=mount.position + (0.012 * n, 0.0, 0.0)) for n, mount in enumerate(genset.mounts)]
    layout = replace(genset, mounts=tuple(close))
    for view in views_of(layout):
        (inner,) = view.findall(SVG + "g")
        for chain in inner.findall(SVG + "g"):
            boxes = []
            for text in chain.findall(SVG + "text"):
                x, y, half = float(text.get("x")), float(text.get("y")), 4.5 * width_of(text.text)
                boxes.append((x - half, y - 7.0, x + half, y))
            assert not any(overlap(box, other) for box, other in combinations(boxes, 2))
            places = [float(place) for place in re.findall(r"M([\d.]+) 3l6-6", chain.find(SVG + "path").get("d"))]
            assert len(boxes) == len(places) - 1
