"""Pictures of an isolator's loops."""

import numpy as np
import pytest

from wirerope_mj.isolator import find_isolator, load_isolator
from wirerope_mj.plots.loops import loops_figure, save_loops


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


@pytest.mark.parametrize(("name", "panels"), [("rubber_horizontal", 1), ("sdof_36hz", 1), ("socitec_cb1390_20", 2)])
def test_every_kind_of_isolator_has_a_picture(tmp_path, name, panels):
    isolator = load_isolator(find_isolator(name))
    assert len(loops_figure(isolator).axes) == panels
    save_loops(isolator, tmp_path / "loops.png")
    assert (tmp_path / "loops.png").read_bytes().startswith(b"\x89PNG")
