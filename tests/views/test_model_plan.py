"""Plans of models from tables: what they name can be read."""

import pytest

from wirerope_mj.engine.from_tables import read_layout
from wirerope_mj.foundation.resources import models_folder
from wirerope_mj.runs.new_model import tables_in
from wirerope_mj.views.plots.model_plan import _figure


@pytest.mark.quick
def test_no_name_lies_over_a_mark_or_another_name():
    """In the plan of the template "engine" lay over a mount and "terminal_box" over a stop."""
    figure = _figure(read_layout("genset", tables_in(models_folder() / "templates" / "genset")))
    for panel in figure.axes[:1] + figure.axes[2:]:  # without the key
        boxes = {text.get_text(): text.get_window_extent() for text in panel.texts if text.get_text()}
        marks = [(line, at) for line in panel.lines for at in panel.transData.transform(line.get_xydata())]
        for name, box in boxes.items():
            assert not any(box.overlaps(other) for label, other in boxes.items() if label != name), name
            for line, at in marks:
                reach = line.get_markersize() * figure.dpi / 144.0
                assert not (box.x0 < at[0] + reach and box.x1 > at[0] - reach
                            and box.y0 < at[1] + reach and box.y1 > at[1] - reach), name  # fmt: skip
