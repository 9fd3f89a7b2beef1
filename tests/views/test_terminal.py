"""Tables on a terminal that is narrower than they are."""

import itertools
import math
import re

import pytest
from rich.text import Text

from wirerope_mj.content.verdicts import bars_table
from wirerope_mj.foundation.tables import Column, Table
from wirerope_mj.views.terminal import WIDTH, in_lines, print_table

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


USED = [
    ("acceleration along z", "rack_top_front_left", 1.24, "12.4 of 10.0 g"),
    ("travel in compression", "m01", 1.0, "43.2 of 43.2 mm"),
    ("static load in compression, virgin", "m16", 0.5, "1.43 of 2.87 kN"), ("bottoming", "m01", 7.0, "0.300 of 0.0430 mm"),
]  # fmt: skip


@pytest.mark.parametrize("width", [60, 80, WIDTH, 200])
def test_bars_reach_their_tick_at_the_limit_and_no_word_breaks(capsys, monkeypatch, width):
    monkeypatch.setattr("wirerope_mj.views.terminal.WIDTH", width)
    print_table(bars_table("criterion", USED))
    out = capsys.readouterr().out
    assert max(map(len, out.splitlines())) <= width
    for words in USED:
        for text in (words[0], words[1], words[3]):
            assert all(word in out.split() for word in text.split()), text
    bars = re.findall(r"([█▏▎▍▌▋▊▉ ]*)│([█▏▎▍▌▋▊▉]*) *(\d+) %", out)
    assert [number for *_, number in bars] == ["124", "100", "50", "700"]
    below, beyond = [len(bar.strip()) for bar, *_ in bars], [len(bar) for _, bar, _ in bars]
    assert below[0] == below[1] == below[3]
    assert below[2] == math.ceil(below[0] / 2)
    assert beyond[1] == beyond[2] == 0 < beyond[0] <= beyond[3]


@pytest.mark.parametrize("width", range(30, 120))
def test_lines_break_between_words_and_never_before_a_unit(width):
    said = "FAIL: rack 10.2 g, limit 10 g (102 %) at 27.9 ms; 1 of 53 checks; a-hyphened-file.toml 35 values, 1.5 m/s and 3 °C."
    lines = in_lines(Text(said), width).plain.split("\n")
    assert max(map(len, lines)) <= width
    assert " ".join(lines).split() == said.split()
    assert not [
        line for line, after in itertools.pairwise(lines) if line[-1].isdigit() and after[0].isalpha() | (after[0] in "%°")
    ]
    assert in_lines(Text("荷重 10.2 g"), 6).plain == "荷重 10.2 g"  # counted in cells where it is printed
