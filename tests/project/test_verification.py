"""The external checks stay within their bounds, and a case that was not run is never passed off as one that was."""

from dataclasses import replace
from itertools import product

import pytest

from verification.case import Case, Comparison, NotRunError, series, single_values
from verification.cases import CASES
from verification.page import KINDS, write_page
from verification.runner import FAILED, NOT_RUN, OUTSIDE, WITHIN, Result, run_case
from wirerope_mj.foundation.resources import models_folder

PAGE = models_folder().parent / "docs" / "verification.md"


def case(**changes):
    made_up = Case(
        name="made-up", title="Title", compares="One value.", source="nobody", date="2026-11", bound=0.1,
        reason="made up", run=lambda: single_values({"a": (2.0, 2.1)}, "N"),
    )  # fmt: skip
    return replace(made_up, **changes)


LONG = {
    "two-bodies-inclined-mounts",
    "miles",
    "diagonal-enidine",
    "iftomm-a05-lagrange",
    "iftomm-a05-published",
    "rack-850-kg",
    "transmissibility-linear",
    "noel-schoukens-multisine",
}


def selected(chosen):
    slow = chosen.name in LONG or "openseespy" in chosen.needs
    return pytest.param(chosen, id=chosen.name, marks=[pytest.mark.slow] if slow else [])


@pytest.mark.parametrize("chosen", [selected(chosen) for chosen in CASES])
def test_case_is_within_its_bound(chosen):
    result = run_case(chosen)
    if result.status == NOT_RUN:
        pytest.skip(result.note)
    expected = {WITHIN, OUTSIDE} if chosen.known else {WITHIN}
    assert result.status in expected, f"{result.note} {result.comparison}"


def test_there_are_enough_cases_with_names_of_their_own():
    names = [chosen.name for chosen in CASES]
    assert len(names) >= 25
    assert len(set(names)) == len(names)
    for chosen in CASES:
        assert chosen.bound > 0.0
        assert chosen.kind in KINDS
        assert not chosen.known or chosen.kind == "plausibility"
        assert all((chosen.title, chosen.compares, chosen.source, chosen.date, chosen.reason))


def test_the_bound_decides():
    assert run_case(case()).status == WITHIN  # 5 %
    assert run_case(case(bound=0.04)).status == OUTSIDE
    known = run_case(case(bound=0.04, known="the file is wrong"))
    assert (known.status, known.note) == (OUTSIDE, "the file is wrong")
    unknown = case(run=lambda: Comparison(reference=1.0, ours=float("nan"), error=float("nan")))
    assert run_case(unknown).status == OUTSIDE


def test_a_missing_package_is_named_and_is_no_pass():
    result = run_case(case(needs=("a_package_that_nobody_has",)))
    assert (result.status, result.comparison) == (NOT_RUN, None)
    assert result.note == "needs a_package_that_nobody_has"

    def refuse():
        raise NotRunError("it cannot be loaded")

    assert run_case(case(run=refuse)).status == NOT_RUN


def test_an_exception_is_a_failure_of_its_case_alone():
    def divide():
        return 1 / 0

    result = run_case(case(run=divide))
    assert result.status == FAILED
    assert "ZeroDivisionError" in result.note


def test_errors_are_those_of_the_definitions():
    found = series([1.0, -4.0, 2.0], [1.0, -4.0, 2.2], "m")
    assert found.error == pytest.approx(0.05)
    assert (found.reference, found.ours, found.values) == (-4.0, -4.0, 3)
    two = single_values({"a": (2.0, 2.1), "b": (10.0, 9.0)}, "N")
    assert two.error == pytest.approx(0.1)
    assert (two.reference, two.ours, len(two.details)) == (10.0, 9.0, 2)
    with pytest.raises(ValueError, match="3 and 2 values"):
        series([1.0, 2.0, 3.0], [1.0, 2.0], "m")


def test_the_page_says_what_was_not_run(tmp_path):
    path = tmp_path / "page.md"
    write_page([run_case(case()), Result(case=case(name="other"), status=NOT_RUN, note="needs openseespy")], path)
    text = path.read_text(encoding="utf-8")
    assert "2 cases: 1 within, 1 not run" in text
    assert "| not run: needs openseespy |" in text


@pytest.mark.skipif(not PAGE.is_file(), reason="the page stands in a checkout only")
def test_the_page_sets_the_rack_beside_ours_in_both_senses_coupled_and_not():
    section = PAGE.read_text(encoding="utf-8").partition("### rack-850-kg\n")[2].partition("\n### ")[0]
    for axis, (quantity, unit), sense, how in product(
        "XYZ", (("travel", "mm"), ("acceleration", "g")), "+-", ("coupled", "each axis alone")
    ):
        assert f"| {quantity} along {axis}, deck along {sense}{axis}, {how} [{unit}] |" in section
    for how in ("coupled", "each axis alone"):
        assert f"| static deflection, {how} [mm] |" in section
        assert all(f"| mode along {axis}, {how} [Hz] |" in section for axis in "XYZ")


@pytest.mark.skipif(not PAGE.is_file(), reason="the page stands in a checkout only")
def test_the_page_in_the_documents_holds_every_case_and_its_bound():
    text = PAGE.read_text(encoding="utf-8")
    for chosen in CASES:
        assert f"### {chosen.name}\n" in text
        assert f"- Bound: {chosen.bound:.1e}: {chosen.reason}\n" in text
        assert f"- Source: {chosen.source}\n" in text
