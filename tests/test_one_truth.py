"""Terminal, summary.json, report and recording of every shipped scenario give the same verdicts."""

import html
import json
import os
import re
import subprocess
import sys
from pathlib import Path

import pytest
from rerun.chunk import RrdReader
from wirerope_mj.content.verdict_table import full_table

from wirerope_mj.assessment.criteria import COMBINED, NOT_JUDGED, Verdict
from wirerope_mj.mounts.isolator.travel import RATINGS
from wirerope_mj.runs.scenario import shipped_scenarios

pytestmark = pytest.mark.slow

SHORT = {"floating_floor_sweep": ["--rate", "120"], "sdof_sweep": ["--rate", "60"]}
"""Options with which the long ones last seconds."""


@pytest.fixture(scope="module", params=sorted(shipped_scenarios()))
def run(request, tmp_path_factory):
    folder = tmp_path_factory.mktemp("run") / "out"
    command = [
        Path(sys.executable).with_name("wirerope"),
        "run",
        request.param,
        "--out",
        folder,
        *SHORT.get(request.param, []),
    ]
    done = subprocess.run(command, capture_output=True, text=True, check=True, env={**os.environ, "COLUMNS": "200"})
    return folder, done.stdout


def verdicts_of(folder) -> list[Verdict]:
    judged = json.loads((folder / "summary.json").read_text(encoding="utf-8"))["judged"]
    words = {"struck", "touching from the start", "not touched"}
    return [
        Verdict(
            criterion=row["criterion"],
            subject=row["subject"],
            value=float("nan") if row["value"] is None else row["value"],
            limit=row["limit"],
            unit=row["unit"],
            time=row["time_s"],
            note=row["note"],
            contact=row["verdict"] if row["verdict"] in words else "",
        )
        for row in judged
    ]


def shown_rows(verdicts) -> list[list[str]]:
    """Return criterion, verdict, subject, value, limit and unit of every verdict as text, in order."""
    return sorted(plain(text for text, _ in marks)[:6] for marks in full_table(verdicts).marks())


def plain(cells) -> list[str]:
    """Return texts without what HTML and Markdown put around them, and without signs for nothing."""
    return [
        re.sub(r"\\(.)", r"\1", cell).replace("**", "").strip().replace("−", "-").replace("–", "") for cell in cells
    ]


def text_in(folder, path) -> str:
    for chunk in RrdReader(str(folder / "run.rrd")).stream():
        if str(chunk.entity_path) == path:
            batch = chunk.to_record_batch()
            return batch["TextDocument:text"].flatten()[0].as_py()
    raise AssertionError(path)


def test_summary_and_report_give_the_same_set(run):
    folder, _ = run
    page = (folder / "report.html").read_text(encoding="utf-8")
    table = page[page.rindex('<p class="caption">Every figure against its limit') :].split("</section>")[
        0
    ]  # and what is folded
    rows = [
        [html.unescape(re.sub("<[^>]*>", "", cell)).strip() for cell in re.findall(r"<td[^>]*>(.*?)</td>", row, re.S)]
        for row in table.split("<tr>")
        if "<td" in row
    ]
    assert sorted(plain(row)[:6] for row in rows) == shown_rows(verdicts_of(folder))


def test_summary_and_recording_give_the_same_set(run):
    folder, _ = run
    rows = markdown_rows(text_in(folder, "/verdicts"))
    assert sorted(row[:6] for row in rows[2:]) == shown_rows(verdicts_of(folder))


def markdown_rows(text) -> list[list[str]]:
    return [plain(line[2:-2].split(" | ")) for line in text.splitlines() if line.startswith("| ")]


def test_terminal_gives_the_same_use_of_every_rated_travel(run):
    folder, printed = run
    verdicts = {(row.criterion, row.subject): row for row in verdicts_of(folder)}
    if "Peaks of the mounts" not in printed:
        assert not any(criterion.startswith("travel") for criterion, _ in verdicts)
        return
    table = printed.split("Peaks of the mounts")[1].split("─\n")[1].split("\n\n")[0]
    names = {subject for criterion, subject in verdicts if criterion == COMBINED}
    ratings = [r for r in RATINGS if any(verdicts[f"travel in {r}", name].utilisation is not None for name in names)]
    seen = set()
    for line in table.splitlines():
        name, *cells = line.split()
        expected = [verdicts[f"travel in {rating}", name].utilisation for rating in ratings]
        expected += [verdicts[COMBINED, name].utilisation] if ratings else []
        texts = ["-" if used is None else f"{100.0 * used:.0f}" for used in expected]
        words = cells[7:]
        assert words[: len(texts)] == texts, line
        over = any(used is not None and used > 1.0 for used in expected)
        judged = any(used is not None for used in expected[:-1])
        assert " ".join(words[len(texts) :]) == ("exceeded" if over else "within" if judged else NOT_JUDGED), line
        seen.add(name)
    assert seen == names


def test_all_give_the_same_headline(run):
    folder, printed = run
    sentence = json.loads((folder / "summary.json").read_text(encoding="utf-8"))["headline"]
    assert sentence in [line.strip() for line in printed.splitlines()]
    assert html.escape(sentence) in (folder / "report.html").read_text(encoding="utf-8")
    assert text_in(folder, "/verdict").startswith(f"**{sentence}**")


def test_peaks_are_the_same_to_the_last_digit_shown(run):
    folder, printed = run
    summary = json.loads((folder / "summary.json").read_text(encoding="utf-8"))
    recorded = {row[0]: row[1] for row in markdown_rows(text_in(folder, "/peaks"))}
    page = (folder / "report.html").read_text(encoding="utf-8")
    for row in summary["accelerations"]:
        name, kind, value = row["name"], row["kind"], f"{row['peak_g']:.2f}"
        assert recorded[{"base": f"{name} (base)", "point": f"point {name}"}.get(kind, name)] == value
        label = name if kind == "body" else f"{name} ({kind})"
        (line,) = [line for line in printed.splitlines() if line.startswith(f"{label}  ")][:1]
        assert line.removeprefix(label).split()[0] == value
        assert re.search(rf">{name}</t[hd]>\s*<td[^>]*>{kind}</td>\s*<td[^>]*>{value}</td>", page)
