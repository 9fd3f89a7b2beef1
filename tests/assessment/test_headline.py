"""The answer of a run in one sentence: the same string wherever a run is shown."""

import json
import re
import shutil

import pytest
from commands import wirerope
from recordings import column, entities

from wirerope_mj.assessment.criteria import CLEAR, STRUCK, TOUCHING, Criterion, Verdict, headline
from wirerope_mj.assessment.criteria.verdict import Amplification, against_limit, by_use
from wirerope_mj.content.job import job_headline
from wirerope_mj.content.verdicts import headline as verdicts_headline
from wirerope_mj.content.verdicts import verdict_bars
from wirerope_mj.foundation.errors import RecordError
from wirerope_mj.mounts.isolator.travel import HANGS
from wirerope_mj.runs.write import read_summary

HALF = "most critical m1 travel in roll 1000 mm, limit 2000 mm (50 %)"


def row(value=1.0, limit=2.0, **changes):
    return Verdict(criterion=Criterion("travel", sense="roll"), subject="m1", value=value, limit=limit, unit="m", **changes)


@pytest.mark.slow
def test_terminal_summary_report_recording_and_comparison_say_the_same_sentence(tmp_path):
    done = wirerope("run", "shock_table", "--level-g", "60", "--duration", "0.2", "--out", "here", cwd=tmp_path)
    sentence = json.loads((tmp_path / "here" / "summary.json").read_text(encoding="utf-8"))["headline"]
    assert re.match(r"FAIL: \w+ .*limit .* \(\d+ %\) at [\d.]+ ms; \d+ of \d+ checks exceeded; .*\.$", sentence)
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
    assert f"; {over} of {judged} checks exceeded; " in summary["headline"]
    assert summary["headline"].endswith(f"; {struck} of {pairs} stops struck; {rest} values have no limit.")
    assert struck == pairs == 4


@pytest.mark.quick
@pytest.mark.parametrize(
    ("rows", "said"),
    [
        ([], "NOT JUDGED: no limit is stated for anything in this run."),
        ([row()], f"PASS: {HALF}; the only check is within limits."),
        ([row(), row(3.0)], "FAIL: m1 travel in roll 3000 mm, limit 2000 mm (150 %); 1 of 2 checks exceeded."),
        ([row(limit=None)], "NOT JUDGED: no limit is stated for anything in this run."),
        (
            [row(), row(limit=None)],
            f"PASS: {HALF}; the only check is within limits; 1 value has no limit.",
        ),
        (
            [row(limit=None, contact=STRUCK)],
            "NOT JUDGED: no limit is stated for anything in this run; 1 of 1 contact pair struck.",
        ),
        (
            [row(), row(), *(row(limit=None, contact=word) for word in (STRUCK, TOUCHING, CLEAR))],
            f"PASS: {HALF}; all 2 checks are within limits; 1 of 3 contact pairs struck.",
        ),
        (
            [row(), row(limit=None, contact=CLEAR)],
            f"PASS: {HALF}; the only check is within limits.",
        ),
    ],
)
def test_the_sentence_counts_what_is_exceeded_struck_and_not_judged(rows, said):
    assert headline(rows) == said


def payload(value=9.0, limit=None, kind="acceleration", note="no limit is stated", base=None):
    found = None if base is None else Amplification(measure="peak", value=value, base=base)
    note = note if limit is None else ""
    return Verdict(
        criterion=Criterion(kind), subject="rack", value=value, limit=limit, unit="m/s^2", note=note, amplification=found
    )


UNLIMITED = "payload not judged: no limit stated; 1 value has no limit"
GROWING = "the motion still grows when the run ends at 1 s: run longer"
OF_RATTLE = payload(limit=20.0, kind="rattle space")


@pytest.mark.quick
@pytest.mark.parametrize(
    ("rows", "begin", "end", "tone"),
    [
        ([row(), payload()], "PASS of the mounts: ", UNLIMITED, "unjudged"),
        ([row(), payload(base=10.0)], "PASS of the mounts: ", UNLIMITED, "unjudged"),
        ([row(3.0), payload()], "FAIL: ", UNLIMITED, "exceeded"),
        (
            [row(), payload(limit=10.0)], "PASS: most critical rack 0.918 g, limit 1.02 g (90 %)",
            "all 2 checks are within limits", "within",
        ),
        (
            [row(limit=None), payload(limit=10.0)], "PASS of the payload: ",
            "mounts not judged: nothing is rated; 1 value has no limit", "unjudged",
        ),
        (
            [row(), payload(), OF_RATTLE], "PASS of the mounts and rattle space: ",
            f"acceleration of the {UNLIMITED}", "unjudged",
        ),
        (
            [row(), payload(note=GROWING)], "PASS of the mounts: ",
            "payload not judged; 1 value is not judged; 1 of them still grows when the run ends: run longer", "unjudged",
        ),
        ([row(), payload(limit=10.0, base=6.0)], "PASS: ", "amplification 1.5 at rack (peak 0.918 g, base 0.612 g)", "within"),
    ],
)  # fmt: skip
def test_a_pass_is_of_what_was_judged_and_amplification_is_said(rows, begin, end, tone):
    said = verdicts_headline(rows)
    assert said.text.startswith(begin)
    assert said.text.endswith(f"; {end}.")
    assert said.tone == tone
    assert ("amplification" in said.values) is ("amplification" in said.text)
    answers = {"first": tuple(rows), "second": tuple(rows)}
    of_job = job_headline(answers)
    assert of_job.tone == tone
    for words in ("payload not judged", "mounts not judged", "amplification 1.5 at rack"):
        assert (words in of_job.text) is (words in said.text), words
    if begin.startswith("PASS"):
        assert of_job.text.startswith(begin)


@pytest.mark.quick
def test_the_most_critical_of_every_subject_is_in_one_order():
    other = Verdict(
        criterion=Criterion("static load in compression", sense="virgin"), subject="m2", value=3.0, limit=4.0, unit="N"
    )
    assert [(name, one.utilisation) for name, one in by_use([row(0.2), other, row(), payload(), row(limit=None)]).items()] == [
        ("m2", 0.75), ("m1", 0.5),
    ]  # fmt: skip


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


@pytest.mark.quick
def test_a_pass_of_some_mounts_says_of_how_many():
    unrated = Verdict(criterion=Criterion("travel", sense="roll"), subject="r1", value=1.0, limit=None, unit="m")
    assert verdicts_headline([row(), unrated]).text.startswith("PASS of 1 of 2 mounts: most critical m1 ")


@pytest.mark.quick
def test_a_mount_that_hangs_is_not_among_those_that_pass():
    hung = Verdict(criterion=Criterion("static load in compression"), subject="m1", value=0.0, limit=None, unit="N", note=HANGS)
    said = verdicts_headline([row(), hung, payload(limit=10.0)])
    assert (said.text.partition(":")[0], said.tone) == ("PASS of 0 of 1 mounts and payload", "unjudged")
    said = verdicts_headline([row(limit=None), hung, payload(limit=10.0)])
    assert "mounts not judged: they hang, and ratings hold for compression" in said.text


@pytest.mark.quick
@pytest.mark.parametrize(("value", "tone"), [(1.0, "within"), (1.9, "near"), (2.1, "exceeded")])
def test_a_headline_has_the_colour_of_the_bar_below_it(value, tone):
    bars = verdict_bars("criterion", [("travel", "m1", row(value))])
    answers = verdicts_headline([row(value)]), job_headline({"first": [row(value)]})
    assert [*(answer.tone for answer in answers), bars.rows[0][2].tone] == [tone] * 3


@pytest.mark.quick
def test_a_mount_that_goes_solid_is_no_stop_that_is_struck():
    bottoming = Verdict(criterion=Criterion("bottoming"), subject="m1", value=0.04, limit=None, unit="m")
    solid, stop = (
        Verdict(criterion=Criterion("stop"), subject=name, value=9.0, limit=None, unit="N", contact=contact)
        for name, contact in (("bottom_m1", STRUCK), ("s1", CLEAR))
    )
    rows = [row(), bottoming, solid, stop]
    assert "1 of 1 mount bottomed" in headline(rows)
    assert "struck" not in headline(rows)
    assert "mounts bottomed in drop" in job_headline({"drop": rows}).text


@pytest.mark.quick
@pytest.mark.parametrize(
    ("value", "limit", "text"),
    [(1010.0, 900.0, "1.01 kN, limit 0.9 kN"), (300.0, 500.0, "300 N, limit 500 N"), (8460.0, 1.0, "8.46 kN, limit 0.001 kN")],
)
def test_a_force_and_its_limit_are_said_in_one_unit(value, limit, text):
    load = Verdict(criterion=Criterion("load"), subject="m1", value=value, limit=limit, unit="N")
    assert text in against_limit(load)
    value_text, limit_text = text.split(", limit ")
    assert verdict_bars("criterion", [("load", "m1", load)]).rows[0][-1] == f"{value_text.split()[0]} of {limit_text}"


@pytest.mark.quick
@pytest.mark.parametrize(
    ("value", "text"), [(0.882, "(88 %)"), (0.997, "(99.7 %)"), (1.0, "(100 %)"), (1.0003, "(100.03 %)"), (1.196, "(120 %)")]
)
def test_what_exceeds_its_limit_is_not_said_to_use_100_per_cent_of_it(value, text):
    assert text in against_limit(row(value, 1.0))
