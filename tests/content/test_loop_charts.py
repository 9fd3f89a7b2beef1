"""Charts of an isolator's loops and of cyclic tests, and the pictures that are written of them."""

import numpy as np
import pytest

from wirerope_mj.content.blocks import LIMIT
from wirerope_mj.content.cyclic_tests import isolator_chart, loops_chart
from wirerope_mj.mounts.laws import BoucWen
from wirerope_mj.mounts.test_rig import cyclic_test
from wirerope_mj.mounts.vendor_parts import find_isolator, load_isolator
from wirerope_mj.views.pictures import save_pictures
from wirerope_mj.views.plots.svg_chart import chart_svg

pytestmark = pytest.mark.quick


def test_panel_holds_loops_in_millimetres_and_kilonewtons_with_the_rated_points():
    isolator = load_isolator(find_isolator("enidine_wr16_400"))
    ((roll_and_shear, axial),) = isolator_chart(isolator).rows
    assert roll_and_shear.title == "roll and shear"
    assert axial.xlabel == "deflection [mm], tension positive"
    assert axial.ylabel == "force [kN]"
    largest = axial.curves[-1]
    assert np.abs(largest.x).max() == pytest.approx(43.2)
    (mark,) = [curve for curve in axial.curves if curve.kind == LIMIT]
    # The vendor's shock stiffness 278 N/mm at 43.2 mm is 12.01 kN.
    assert mark.x[0] == pytest.approx(-43.2)
    assert mark.y[0] == pytest.approx(-12.0096, rel=1e-5)
    (load,) = [curve for curve in axial.curves if curve.name.startswith("rated load")]
    assert load.y[0] == pytest.approx(-1e-3 * isolator.limits.static_load)


@pytest.mark.parametrize(
    ("name", "panels"), [("rubber_horizontal", 1), ("sdof_36hz", 1), ("enidine_wr12_400", 2), ("socitec_cb1390_20", 3)]
)
def test_every_kind_of_isolator_has_a_picture(tmp_path, name, panels):
    chart = isolator_chart(load_isolator(find_isolator(name)))
    assert len(chart.rows[0]) == panels
    save_pictures([chart], tmp_path / "loops.png", title=name)
    assert (tmp_path / "loops.png").read_bytes().startswith(b"\x89PNG")


def test_cyclic_tests_are_drawn_as_they_were_run_in_units_of_their_size(tmp_path):
    strong, weak = (BoucWen(alpha=alpha, beta=800.0, gamma=200.0, n=1) for alpha in (1e7, 1e4))
    tests = {"axial, 2 Hz": cyclic_test(strong, [2e-3, 1e-3]), "shear": cyclic_test(weak, [1e-3], operating_point=5e-3)}
    chart = loops_chart(tests)
    ((axial, shear),) = chart.rows
    assert axial.title == "axial, 2 Hz"
    assert axial.xlabel == "deflection [mm], tension positive"
    assert (axial.ylabel, shear.ylabel) == ("force [kN]", "force [N]")
    first, second = axial.curves
    assert np.abs(first.x).max() == pytest.approx(1.0)  # small before large, whatever the order of the test
    assert first.opacity < second.opacity == 1.0
    assert np.abs(second.y).max() == pytest.approx(tests["axial, 2 Hz"][0].force.max() / 1e3)
    assert shear.curves[0].x.min() == pytest.approx(4.0)
    assert shear.curves[0].y.max() == pytest.approx(tests["shear"][0].force.max())
    save_pictures([chart], tmp_path / "loops.svg", title="two")
    assert "<svg" in (tmp_path / "loops.svg").read_text(encoding="utf-8")


def test_legend_names_a_few_of_many_loops_with_the_smallest_and_the_largest():
    tests = {"axial": cyclic_test(BoucWen(alpha=1e6, beta=800.0, gamma=200.0, n=1), np.linspace(1e-3, 2.0, 20), cycles=1)}
    chart = loops_chart(tests)
    names = [curve.name for curve in chart.rows[0][0].curves if curve.name]
    assert len(names) == 8
    assert names[0].startswith("±1 mm")
    assert names[-1].startswith("±2000 mm")
    assert chart_svg(chart).count("ζ") == 2 * 8  # each in the legend and at its curve; none is named ""


def test_a_picture_that_cannot_be_written_leaves_nothing(tmp_path):
    chart = isolator_chart(load_isolator(find_isolator("sdof_36hz")))
    with pytest.raises(ValueError, match="docx"):
        save_pictures([chart], tmp_path / "loops.docx")
    assert list(tmp_path.iterdir()) == []
