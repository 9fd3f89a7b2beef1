"""What the drawing of a board says beside its shapes."""

import pytest

from wirerope_mj.views.board.shapes import drawn

pytestmark = pytest.mark.quick


@pytest.mark.parametrize(("apart", "said"), [(30.0, "30 mm"), (0.2, "0.2 mm"), (0.04, ""), (0.0, "")])
def test_centres_are_said_to_be_apart_only_where_they_are(apart, said):
    centres = [
        {"kind": "centre", "mark": mark, "label": f"of {mark}", "position": [x, 0.0, 0.0], "movable": False}
        for mark, x in (("stiffness", 0.0), ("mass", apart))
    ]
    labels = drawn(centres)["views"]["plan"]["labels"]
    assert [label["choices"][-1] for label in labels] == ([said] if said else [])
