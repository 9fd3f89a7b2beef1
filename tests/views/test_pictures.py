"""Pictures in files: the drawings of a page, one below the other."""

import re
import struct

import numpy as np
import pytest

from wirerope_mj.content.blocks import WIDTH, Chart, Curve, Panel
from wirerope_mj.views.pictures import save_pictures
from wirerope_mj.views.plots.svg_chart import chart_svg

pytestmark = pytest.mark.quick

X = np.linspace(0.0, 1.0, 50)


def chart(name="force", height=120.0):
    return Chart(rows=[[Panel(curves=[Curve(x=X, y=X**2, name=name, kind=0)], ylabel="y", xlabel="x")]], height=height)


def size_of(path):
    content = path.read_bytes()
    assert content.startswith(b"\x89PNG")
    return struct.unpack(">II", content[16:24])


def test_charts_stand_below_each_other_as_they_stand_in_a_page(tmp_path):
    one, two = chart("first"), chart("second <b> $x$", height=200.0)
    save_pictures([one, two], tmp_path / "two.svg", title="A title & more")
    text = (tmp_path / "two.svg").read_text(encoding="utf-8")
    assert "A title &amp; more" in text
    tops = [float(y) for y in re.findall(r'<svg x="0.0" y="([\d.]+)"', text)]
    heights = [float(re.search(rf'viewBox="0 0 {WIDTH:g} ([\d.]+)"', chart_svg(each))[1]) for each in (one, two)]
    assert tops[1] == pytest.approx(tops[0] + heights[0], abs=0.1)
    for each in (one, two):
        assert chart_svg(each).split(">", 1)[1] in text


def test_a_picture_is_as_high_as_what_it_holds_and_shows_it(tmp_path):
    save_pictures([chart()], tmp_path / "one.png")
    save_pictures([chart(), chart()], tmp_path / "two.png")
    (width, one), (_, two) = size_of(tmp_path / "one.png"), size_of(tmp_path / "two.png")
    assert width == round(1.6 * WIDTH)
    assert two == pytest.approx(2 * one, abs=0.02 * two)
    save_pictures([chart(name="")], tmp_path / "unnamed.png")
    assert (tmp_path / "one.png").read_bytes() != (tmp_path / "unnamed.png").read_bytes()


def test_letters_are_drawn_where_a_machine_has_none(tmp_path):
    """Names of axes are letters alone: a picture without them has other bytes."""
    save_pictures([chart("a")], tmp_path / "a.png")
    save_pictures([chart("m")], tmp_path / "m.png")
    assert (tmp_path / "a.png").read_bytes() != (tmp_path / "m.png").read_bytes()


def test_a_single_dot_is_drawn(tmp_path):
    """In another colour a picture of it has other bytes."""
    for kind in (0, 1):
        curve = Curve(x=X[:1], y=X[:1], name="", kind=kind, marks=True)
        save_pictures([Chart(rows=[[Panel(curves=[curve], ylabel="y")]])], tmp_path / f"{kind}.png")
    assert (tmp_path / "0.png").read_bytes() != (tmp_path / "1.png").read_bytes()


@pytest.mark.parametrize("name", ["picture.docx", "picture"])
def test_another_kind_of_file_is_refused_and_leaves_nothing(tmp_path, name):
    with pytest.raises(ValueError, match=r"must end with \.png, \.svg or \.pdf"):
        save_pictures([chart()], tmp_path / name)
    assert list(tmp_path.iterdir()) == []
