"""The table of a complete study is read by columns and rows: never whole, where a command asks for it."""

import numpy as np
import pyarrow as pa
import pytest
from table_study import rows, table_study

from wirerope_mj.cli import main
from wirerope_mj.content import study_charts
from wirerope_mj.studies import folder as study_folder
from wirerope_mj.studies import result as results
from wirerope_mj.studies.stored_table import StoredTable
from wirerope_mj.studies.study import load_study
from wirerope_mj.studies.vary import sampling

pytestmark = pytest.mark.filterwarnings("ignore:the given step of")  # what is asked here holds at coarse steps


@pytest.fixture(scope="module")
def done(tmp_path_factory):
    """A study whose table has eight row groups."""
    with pytest.MonkeyPatch.context() as patch:
        patch.setattr(study_folder, "ROW_GROUP", 100)
        return table_study().run(tmp_path_factory.mktemp("stored") / "study", workers=1)


def test_columns_and_rows_are_those_of_the_whole_table(done):
    stored, table = StoredTable(done.folder, str), done.table
    assert (stored.num_rows, stored.column_names, stored.schema) == (40, table.column_names, table.schema)
    for name in table.column_names:
        assert rows(pa.table({name: stored[name].to_pylist()})) == rows(table.select([name]))
    wanted = [39, 0, 17, 17, 3]
    assert rows(stored.take(wanted)) == rows(table.take(wanted))
    assert stored.take([]).num_rows == 0
    assert len(list(stored.blocks())) > 4
    assert rows(pa.concat_tables(stored.blocks())) == rows(table)
    mask = np.arange(40) % 3 == 1
    assert rows(stored.filter(mask).take([2, 0])) == rows(table.filter(mask).take([2, 0]))
    assert stored.filter(mask)["variant"].to_pylist() == list(range(1, 40, 3))
    assert rows(pa.concat_tables(stored.filter(mask).blocks())) == rows(table.filter(mask))


def test_a_command_never_reads_the_whole_table_of_a_study_nor_draws_it_twice(tmp_path, monkeypatch, capsys):
    def whole(*_):
        raise AssertionError("the whole table was read")

    drawn, ordinary = [], sampling._sampled
    monkeypatch.setattr(results, "read_table", whole)
    monkeypatch.setattr(sampling, "_sampled", lambda *how: drawn.append(how) or ordinary(*how))
    folder, vary = (
        tmp_path / "study",
        ["mount/m1/axial/alpha = Normal(1, 0.1, relative=True)", "motion/level = Uniform(0.5, 1.5)"],
    )
    command = [
        "study",
        "shock_table",
        "--duration",
        "0.05",
        "--variants",
        "16",
        "--workers",
        "1",
        "--limit",
        "acceleration = 20 g",
    ]
    assert main([*command, *(word for text in vary for word in ("--vary", text)), "--out", str(folder), "--all"]) == 0
    assert len(drawn) == 1
    assert main(["study-report", str(folder)]) == 0
    assert "16 variants, none failed" in capsys.readouterr().out
    result = load_study(folder)
    assert result.worst("acceleration", 2).num_rows == 2
    assert len(list(result.exported.blocks())) == 1
    assert len(drawn) == 1


def test_parts_are_joined_as_they_are_read(done, tmp_path, monkeypatch):
    """So that no more than one row group is in memory."""
    study, events = table_study(), []
    folder = tmp_path / "study"
    study_folder.prepare(study, folder, keep="peaks", resume=False)
    for number in range(8):
        table = done.table.slice(5 * number, 5)
        study_folder.write_part(folder, study_folder.Part(number=number, table=table))
    read, write = study_folder.read_part, study_folder.pq.ParquetWriter.write_table
    monkeypatch.setattr(study_folder, "ROW_GROUP", 100)
    monkeypatch.setattr(study_folder, "read_part", lambda path: events.append("read") or read(path))
    monkeypatch.setattr(
        study_folder.pq.ParquetWriter, "write_table", lambda writer, table: events.append("write") or write(writer, table)
    )
    study_folder.finish(folder, 8, dict)
    assert events == ["read", "write"] * 8
    assert rows(load_study(folder).table) == rows(done.table)


def test_charts_of_many_variants_draw_some_of_them(done, monkeypatch):
    from wirerope_mj.studies.results.study_summary import summary_of

    every = {chart.id: chart for chart in study_charts.study_charts(summary_of(done))}
    monkeypatch.setattr(study_charts, "MOST_STEPS", 8)
    monkeypatch.setattr(study_charts, "MOST_DOTS", 8)
    some = {chart.id: chart for chart in study_charts.study_charts(summary_of(done))}
    (all_steps,), (steps,) = (charts["distribution"].rows[0][0].curves for charts in (every, some))
    assert (all_steps.x.size, steps.x.size) == (80, 16)
    assert (steps.x[0], steps.x[-1], steps.y[-1]) == (all_steps.x[0], all_steps.x[-1], 100.0)
    upper = dict(zip(all_steps.x[1::2], all_steps.y[1::2], strict=True))  # what stays below each value, itself included
    assert all(upper[x] == y for x, y in zip(steps.x[1::2], steps.y[1::2], strict=True))
    dots = [curve for panel in some["scatter"].rows[0] for curve in panel.curves if curve.marks]
    assert {curve.x.size for curve in dots} == {8}
    assert "8 variants, chosen at random" in some["scatter"].caption
    assert "every variant" in every["scatter"].caption
