"""Pictures of an isolator's loops."""

import numpy as np
import pytest

from wirerope_mj.mounts.laws import BoucWen
from wirerope_mj.mounts.test_rig import cyclic_test
from wirerope_mj.mounts.vendor_parts import find_isolator, load_isolator
from wirerope_mj.views.plots.loops import cyclic_tests_figure, loops_figure, save_cyclic_tests, save_loops

pytestmark = pytest.mark.quick


def test_panel_holds_loops_in_millimetres_and_kilonewtons_with_the_rated_points():
    isolator = load_isolator(find_isolator("enidine_wr16_400"))
    roll_and_shear, axial = loops_figure(isolator).axes
    assert roll_and_shear.get_title() == "roll and shear"
    assert axial.get_xlabel() == "deflection [mm], tension positive"
    assert axial.get_ylabel() == "force [kN]"
    largest = axial.get_lines()[2]
    assert np.abs(largest.get_xdata()).max() == pytest.approx(43.2)
    marks = [line for line in axial.get_lines() if line.get_marker() == "o" and len(line.get_xdata()) == 1]
    # The vendor's shock stiffness 278 N/mm at 43.2 mm is 12.01 kN.
    assert marks[0].get_xdata()[0] == pytest.approx(-43.2)
    assert marks[0].get_ydata()[0] == pytest.approx(-12.0096, rel=1e-5)


@pytest.mark.parametrize(
    ("name", "panels"), [("rubber_horizontal", 1), ("sdof_36hz", 1), ("enidine_wr12_400", 2), ("socitec_cb1390_20", 3)]
)
def test_every_kind_of_isolator_has_a_picture(tmp_path, name, panels):
    isolator = load_isolator(find_isolator(name))
    assert len(loops_figure(isolator).axes) == panels
    save_loops(isolator, tmp_path / "loops.png")
    assert (tmp_path / "loops.png").read_bytes().startswith(b"\x89PNG")


def test_cyclic_tests_are_drawn_as_they_were_run_in_units_of_their_size(tmp_path):
    strong, weak = (BoucWen(alpha=alpha, beta=800.0, gamma=200.0, n=1) for alpha in (1e6, 1e4))
    tests = {"axial, 2 Hz": cyclic_test(strong, [2e-3, 1e-3]), "shear": cyclic_test(weak, [1e-3], operating_point=5e-3)}
    axial, shear = cyclic_tests_figure(tests, title="two").axes
    assert axial.get_title() == "axial, 2 Hz"
    assert axial.get_xlabel() == "deflection [mm], tension positive"
    assert (axial.get_ylabel(), shear.get_ylabel()) == ("force [kN]", "force [N]")
    first, second = axial.get_lines()[:2]
    assert np.abs(first.get_xdata()).max() == pytest.approx(1.0)  # small before large, whatever the order of the test
    assert np.abs(second.get_ydata()).max() == pytest.approx(tests["axial, 2 Hz"][0].force.max() / 1e3)
    assert shear.get_lines()[0].get_xdata().min() == pytest.approx(4.0)
    assert shear.get_lines()[0].get_ydata().max() == pytest.approx(tests["shear"][0].force.max())
    save_cyclic_tests(tests, tmp_path / "loops.svg", title="two")
    assert "<svg" in (tmp_path / "loops.svg").read_text(encoding="utf-8")


def test_legend_names_a_few_of_many_loops_with_the_smallest_and_the_largest():
    tests = {
        "axial": cyclic_test(BoucWen(alpha=1e6, beta=800.0, gamma=200.0, n=1), np.linspace(1e-3, 2.0, 20), cycles=1)
    }
    (panel,) = cyclic_tests_figure(tests, title="many").axes
    words = [text.get_text() for text in panel.get_legend().get_texts()]
    assert len(words) == 8
    assert words[0].startswith("±1 mm")
    assert words[-1].startswith("±2000 mm")


def test_a_picture_that_cannot_be_written_leaves_nothing(tmp_path):
    isolator = load_isolator(find_isolator("sdof_36hz"))
    with pytest.raises(ValueError, match="docx"):
        save_loops(isolator, tmp_path / "loops.docx")
    assert list(tmp_path.iterdir()) == []
