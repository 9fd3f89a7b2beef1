"""Terminal, page, recording and summary of every shipped scenario say the same under the same ids."""

import html
import json

import numpy as np
import pytest
from finished_runs import finished_of, tables_of
from recordings import column, entities
from rerun.chunk import RrdReader
from shown import cells_of, cells_to_show, missing_rows, printed_by

from wirerope_mj.assessment.criteria.verdict import by_use
from wirerope_mj.content.blocks import Chart, SceneView, Statement, short
from wirerope_mj.content.first_sheet import panel_over_frequency
from wirerope_mj.content.numbers import number
from wirerope_mj.content.run import run_content
from wirerope_mj.content.selection import main_direction
from wirerope_mj.foundation.units import STANDARD_GRAVITY
from wirerope_mj.runs.scenario import shipped_scenarios
from wirerope_mj.views.markdown import markdown_statement, markdown_table

pytestmark = pytest.mark.slow

SHORT = {
    "cabinet_random": ["--duration", "6"],
    "cabinet_shock": ["--duration", "0.5"],
    "floating_floor_double_pulse": ["--duration", "0.5"],
    "floating_floor_shock": ["--duration", "0.5"],
    "floating_floor_sweep": ["--rate", "120"],
    "sdof_sweep": ["--rate", "60"],
}
"""Options with which the long ones last seconds."""

RECORDED = ("peak-accelerations", "random", "mounts", "contacts", "all-verdicts")
"""Tables that the texts of a recording hold."""


@pytest.fixture(scope="module", params=sorted(shipped_scenarios()))
def run(request, tmp_path_factory):
    folder = tmp_path_factory.mktemp("run") / "out"
    printed = printed_by("run", request.param, "--out", str(folder), "--all", *SHORT.get(request.param, []))
    return folder, printed, run_content(finished_of(folder))


def in_summary(content):
    """Return the ids of what terminal and summary show, which are statements and tables."""
    return [block.id for block in content.blocks("headline", "summary") if not isinstance(block, Chart | SceneView)]


def test_the_page_holds_every_table_to_the_last_cell(run):
    folder, _, content = run
    page = (folder / "report.html").read_text(encoding="utf-8")
    tables = tables_of(content)
    assert {"peak-accelerations", "worst-of-criteria", "all-verdicts", "settings"} <= tables.keys()
    for name, table in tables.items():
        assert cells_of(page, name) == cells_to_show(table), name


def test_the_summary_holds_the_values_of_the_tables_in_si(run):
    folder, _, content = run
    written = json.loads((folder / "summary.json").read_text(encoding="utf-8"))["content"]
    assert written == json.loads(json.dumps(content.to_dict(*content.sections_of("headline", "summary"))))
    assert written["headline"]["text"] == content.verdict.text
    assert set(in_summary(content)) <= written.keys()


def test_the_terminal_prints_the_rows_of_every_summary_table(run):
    _, printed, content = run
    for name, table in tables_of(content).items():
        if name in in_summary(content):
            assert not missing_rows(printed, table), name


def test_the_recording_holds_the_same_tables_and_sentences(run):
    folder, _, content = run
    texts = "\n".join(texts_in(folder))
    tables = tables_of(content)
    for name in RECORDED:
        if name in tables:
            assert markdown_table(tables[name]) in texts, name
    (said,) = [block for block in content.blocks() if isinstance(block, Statement) and block.id == "verdicts"]
    assert markdown_statement(said) in texts


def test_what_a_recording_draws_over_frequency_says_the_numbers_of_the_tables(run):
    folder, _, content = run
    tables, judged = tables_of(content), finished_of(folder)
    panel = panel_over_frequency(judged)
    if "rms" in tables:
        axis = main_direction(judged.response)
        rms = {short(row[0]): f"{number(row[2] / STANDARD_GRAVITY)} g rms" for row in tables["rms"].rows if row[1] == axis}
        assert dict(curve.name.split(", ") for curve in panel.curves) == rms
    elif judged.sweep is not None:
        first, *others = tables["peak-accelerations"].rows
        rows = {"base": first} | {short(row[0].removesuffix(" (point)")): row for row in others}
        for curve in panel.curves:
            _, peak, *_, frequency = rows[curve.name][:7]
            assert curve.peak == (frequency, pytest.approx(peak.content / STANDARD_GRAVITY, rel=1e-12))
    else:
        assert panel is None or "SRS" in panel.ylabel


def test_all_name_the_same_worst(run):
    folder, printed, content = run
    judged = finished_of(folder)
    order = list(by_use(judged.verdicts))
    if not order:
        pytest.skip("nothing is judged")
    assert content.verdict.values["most_critical"] == order[0]
    worst = [block for block in content.blocks() if block.id == "worst-instant"]
    timed = list(by_use(row for row in judged.verdicts if row.time is not None))
    assert all(view.ring is None or view.ring[0] == timed[0] for view in worst)
    critical = next((name for name in order if name in judged.selection.mounts), None)
    if critical is None:
        return
    assert judged.selection.governing == critical
    assert tables_of(content)["mounts"].rows[0][0].removesuffix(" *") == critical
    used = by_use(judged.verdicts)[critical].utilisation
    labels = [
        label
        for path, batches in entities(folder / "run.rrd").items()
        if path.endswith("/worst")
        for label in np.concatenate(column(batches, "Points3D:labels").to_pylist())
    ]
    assert set(labels) == {f"{critical} {100.0 * used:.0f} %"}  # in the scene and in the enlarged one


def texts_in(folder):
    """Return all texts of a run's recording."""
    found = []
    for chunk in RrdReader(str(folder / "run.rrd")).stream():
        batch = chunk.to_record_batch()
        if "TextDocument:text" in batch.schema.names:
            found += batch["TextDocument:text"].flatten().to_pylist()
    return found


def test_all_give_the_same_headline(run):
    folder, printed, content = run
    sentence = content.verdict.text
    assert json.loads((folder / "summary.json").read_text(encoding="utf-8"))["headline"] == sentence
    assert sentence in [line.strip() for line in printed.splitlines()]
    assert html.escape(sentence) in (folder / "report.html").read_text(encoding="utf-8")
    assert any(sentence in text.replace("\\", "") for text in texts_in(folder))
