"""The answer of a run in one sentence: the same string wherever a run is shown."""

import json
import re
import shutil

import pytest
from commands import wirerope
from recordings import column, entities

from wirerope_mj.assessment.criteria import CLEAR, STRUCK, TOUCHING, Criterion, Verdict, headline
from wirerope_mj.content.verdicts import headline as verdicts_headline
from wirerope_mj.foundation.errors import RecordError
from wirerope_mj.runs.summary import read_summary

HALF = "most critical m1, 50 % of rated travel in roll"


def row(value=1.0, limit=2.0, **changes):
    return Verdict(criterion=Criterion("travel", sense="roll"), subject="m1", value=value, limit=limit, unit="m", **changes)


@pytest.mark.slow
def test_terminal_summary_report_recording_and_comparison_say_the_same_sentence(tmp_path):
    done = wirerope("run", "shock_table", "--level-g", "60", "--duration", "0.2", "--out", "here", cwd=tmp_path)
    sentence = json.loads((tmp_path / "here" / "summary.json").read_text(encoding="utf-8"))["headline"]
    assert re.match(r"FAIL: \d+ of \d+ checks exceeded; worst \w+, \d+ % of .*\.$", sentence)
    assert sentence in [line.strip() for line in done.stdout.splitlines()]
    page = (tmp_path / "here" / "report.html").read_text(encoding="utf-8")
    assert re.findall(r'<p id="headline" class="verdict exceeded">(.*?)</p>', page) == [sentence]
    (text,) = column(entities(tmp_path / "here" / "run.rrd")["/peaks"], "TextDocument:text").to_pylist()
    assert text[0].startswith(f"**{sentence}**\n")
    shutil.copytree(tmp_path / "here", tmp_path / "there")
    compared = wirerope("compare", "here", "there", cwd=tmp_path).stdout
    assert f"here: {sentence}" in " ".join(compared.split())


@pytest.mark.slow
def test_every_verdict_that_the_headline_counts_stands_in_the_summary(tmp_path):
    wirerope(
        "run",
        "shock_table",
        "--duration",
        "0.4",
        "--level-g",
        "60",
        "--timestep",
        "5e-4",
        "--out",
        "here",
        cwd=tmp_path,
    )
    summary = json.loads((tmp_path / "here" / "summary.json").read_text(encoding="utf-8"))
    told = [row["verdict"] for row in summary["judged"]]
    over, judged = told.count("exceeded"), told.count("exceeded") + told.count("within")
    struck, pairs = told.count("struck"), sum(row["criterion"] == "stop" for row in summary["judged"])
    rest = len(told) - judged - pairs
    assert summary["headline"].startswith(f"FAIL: {over} of {judged} checks exceeded; worst ")
    assert summary["headline"].endswith(f"; {struck} of {pairs} stops struck; {rest} values have no limit.")
    assert struck == pairs == 4


@pytest.mark.quick
@pytest.mark.parametrize(
    ("rows", "said"),
    [
        ([], "NOT JUDGED: no limit is stated for anything in this run."),
        ([row()], f"PASS: the only check is within limits; {HALF}."),
        ([row(), row(3.0)], "FAIL: 1 of 2 checks exceeded; worst m1, 150 % of rated travel in roll."),
        ([row(limit=None)], "NOT JUDGED: no limit is stated for anything in this run."),
        (
            [row(), row(limit=None)],
            f"PASS: the only check is within limits; {HALF}; 1 value has no limit.",
        ),
        (
            [row(limit=None, contact=STRUCK)],
            "NOT JUDGED: no limit is stated for anything in this run; 1 of 1 contact pair struck.",
        ),
        (
            [row(), row(), *(row(limit=None, contact=word) for word in (STRUCK, TOUCHING, CLEAR))],
            f"PASS: all 2 checks are within limits; {HALF}; 1 of 3 contact pairs struck.",
        ),
        (
            [row(), row(limit=None, contact=CLEAR)],
            f"PASS: the only check is within limits; {HALF}.",
        ),
    ],
)
def test_the_sentence_counts_what_is_exceeded_struck_and_not_judged(rows, said):
    assert headline(rows) == said


@pytest.mark.quick
def test_what_passes_is_not_set_as_what_fails():
    struck = row(limit=None, contact=STRUCK)
    assert [verdicts_headline(rows).tone for rows in ([row()], [row(), struck], [row(3.0), struck], [struck])] == [
        "within", "near", "exceeded", "near",
    ]  # fmt: skip


@pytest.mark.quick
@pytest.mark.parametrize(
    ("content", "said"),
    [
        (b'{"headline": }', r"summary\.json, line 1, column 14: .*nor JSON"),
        (b"[1, 2]", r"summary\.json: this is not the summary of a run"),
        (b"\xff\xfe", r"summary\.json: .*nor JSON in UTF-8"),
        (b"[" * 20_000, r"summary\.json: .*nor JSON in UTF-8"),
    ],
)
def test_a_damaged_summary_is_named_with_what_to_do(tmp_path, content, said):
    (tmp_path / "summary.json").write_bytes(content)
    with pytest.raises(RecordError, match=f"{said}.* Take the file from another copy") as caught:
        read_summary(tmp_path)
    assert "Error" not in str(caught.value)  # neither JSON's words nor the interpreter's
