"""Words and numbers of a report: verdicts, values and tables."""

import math
from dataclasses import replace

import pytest

from wirerope_mj.assessment.criteria import Verdict
from wirerope_mj.assessment.criteria.loads import contact_text
from wirerope_mj.content.numbers import fixed, listed, number, shown, shown_unit, title_of
from wirerope_mj.content.verdicts import full_table, headline, unjudged, worst_table
from wirerope_mj.engine.response import ContactPeak
from wirerope_mj.foundation.tables import Column, Mark, Table
from wirerope_mj.foundation.units import duration_text

pytestmark = pytest.mark.quick


def verdict(**changes):
    return Verdict(**{"criterion": "travel in roll", "subject": "m1", "value": 0.02, "limit": 0.04, "unit": "m"} | changes)


@pytest.mark.parametrize(
    ("duration", "text"),
    [
        (0.0, "0 ms"),
        (5e-5, "0.05 ms"),
        (0.011, "11 ms"),
        (0.9994, "999 ms"),
        (0.9996, "1 s"),
        (1.64, "1.64 s"),
        (3600.0, "3600 s"),
    ],
)
def test_a_duration_is_read_in_seconds_from_one_second_on(duration, text):
    assert duration_text(duration) == text
    touched = ContactPeak(geoms=("a", "b"), bodies=("c", "d"), touches=1, first_touch=0.1, duration=duration)
    assert f", {text} in all" in contact_text(touched)


def test_the_answer_counts_the_exceeded_and_names_the_worst():
    rows = [
        verdict(),
        verdict(subject="m2", value=0.05),
        verdict(criterion="acceleration", limit=None, note="nobody knows"),
    ]
    assert unjudged(rows) == ("acceleration of m1: nobody knows.",)
    found = headline(rows)
    assert found.text == "FAIL: m2 travel in roll 50.0 mm, limit 40 mm (125 %); 1 of 2 checks exceeded; 1 value has no limit."
    assert (found.tone, found.values["utilisation"]) == ("exceeded", 1.25)


def test_the_worst_of_what_is_not_judged_is_the_largest():
    rows = [
        verdict(limit=None),
        verdict(subject="m2", value=0.05, limit=None),
        verdict(subject="m3", value=math.nan, limit=None),
        verdict(criterion="acceleration", subject="floor", value=1.0, limit=2.0),
        verdict(criterion="acceleration", subject="rack", value=5.0, limit=None),
    ]
    told = {row[0]: row[2] for row in worst_table(rows).rows}
    assert told == {"travel in roll": "m2", "acceleration": "floor"}  # what is judged comes before what is not


@pytest.mark.parametrize("value", [0.0, math.nan])
def test_a_sum_of_shares_of_which_none_is_rated_is_no_figure(value):
    row = verdict(criterion="travel combined", unit="", value=value, limit=None, time=0.0, note="no travel is rated")
    (shown_row,) = full_table([row]).marks()
    assert [shown_row[number][0] for number in (3, 7)] == ["–", "-"]
    assert worst_table([row]).rows[0][3] == "–"
    bound = replace(row, value=0.3, time=0.012)  # of those axes that are rated
    assert [text for text, _ in full_table([bound]).marks()[0][3:8:4]] == ["0.300", "0.0120"]


def test_nothing_judged_is_never_passed():
    rows = [verdict(limit=None), verdict(value=math.nan)]
    assert headline(rows).tone == "unjudged"
    assert "within" not in headline(rows).text
    passed = headline([verdict()])
    assert passed.text == "PASS: most critical m1 travel in roll 20.0 mm, limit 40 mm (50 %); the only check is within limits."
    assert passed.tone == "within"


def test_figures_are_shown_in_the_units_of_the_trade():
    assert (shown(0.0432, "m"), shown(2869.0, "N"), shown(98.0665, "m/s^2")) == ("43.2", "2.87", "10.0")
    assert (shown_unit("m/s^2"), shown_unit("N"), shown_unit("m/s")) == ("g", "kN", "m/s")
    assert (number(-0.001234), number(123456.0), number(0.0), number(math.nan)) == ("−0.00123", "123456", "0", "–")
    assert fixed(-0.001, 2) == "0.00"
    assert title_of("shock-box-clean_3ax") == "Shock box clean 3ax"
    assert title_of("wr16-400 of 2026-11-21") == "Wr16-400 of 2026-11-21"
    assert listed(list("abcdefgh")) == "a, b, c, d, e and 3 more"


def test_a_table_has_a_cell_for_every_heading():
    with pytest.raises(ValueError, match="`rows` must have 2 cells each"):
        Table(title="", columns=(Column("a"), Column("b")), rows=(("1",),))
    with pytest.raises(ValueError, match="`tone` must be one of"):
        Mark("1", "loud")


def test_a_column_shows_si_values_in_its_unit():
    rows = [(0.0123456, -1.5), (Mark(-1e-9, "quiet"), None), ("text", math.inf)]
    table = Table(title="", columns=(Column("a", "mm", "z.1f"), Column("b")), rows=rows)
    assert table.columns[0].title() == "a [mm]"
    assert table.marks(absent="–", minus="−") == [
        [("12.3", ""), ("−1.50", "")],
        [("0.0", "quiet"), ("–", "")],
        [("text", ""), ("–", "")],
    ]
