"""Tables on a terminal that is narrower than they are."""

import re

import pytest

from wirerope_mj.foundation.tables import Column, Table
from wirerope_mj.views.terminal import WIDTH, print_table

COLUMNS = [Column("variant", align="left"), *(Column(f"displacement/\ntop/{number}", "", 3) for number in range(12))]


@pytest.mark.parametrize("width", [80, WIDTH])
def test_columns_for_which_a_line_is_too_short_stand_below(capsys, monkeypatch, width):
    """None is cut: with fewer characters "65.6" would be "6"."""
    monkeypatch.setattr("wirerope_mj.views.terminal.WIDTH", width)
    values = [[10.0 * row + column + 10.5 for column in range(12)] for row in range(3)]
    print_table(Table(title="Worst variants", columns=COLUMNS, rows=[(f"v{row}", *own) for row, own in enumerate(values)]))
    lines = capsys.readouterr().out.splitlines()
    assert max(map(len, lines)) <= width
    for row, own in enumerate(values):
        parts = [re.findall(r"\S+", line)[1:] for line in lines if line.startswith(f"v{row}")]
        assert len(parts) > 1
        assert [float(number) for part in parts for number in part] == own
