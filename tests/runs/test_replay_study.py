"""A study simulated again from its folder, its report by the command of all results, and names that were mistyped."""

import re

import pyarrow as pa
import pyarrow.parquet as pq
import pytest

import wirerope_mj as wr
from wirerope_mj.cli import main
from wirerope_mj.studies.folder import TABLE


@pytest.fixture(scope="module")
def folder(tmp_path_factory):
    path = tmp_path_factory.mktemp("study") / "small"
    study = wr.Study(
        model="shock_table", motion=wr.HalfSine(peak=50.0, duration=0.011, direction="z"), duration=0.1, timestep=5e-4,
        vary={"motion/level": wr.Uniform(0.5, 1.5)}, variants=4,
    )  # fmt: skip
    study.run(path, workers=1)
    return path


@pytest.mark.slow
def test_a_study_is_replayed_and_a_changed_number_is_found(folder, capsys):
    assert main(["replay", str(folder)]) == 0
    assert "every variant simulated again: bit-identical; the tables agree" in re.sub(r"\s+", " ", capsys.readouterr().out)
    path = folder / TABLE
    table = pq.read_table(path)
    values = table["acceleration"].to_pylist()
    index = table.column_names.index("acceleration")
    changed = table.set_column(index, "acceleration", pa.array([values[0] + 0.1 * max(values), *values[1:]]))
    pq.write_table(changed.replace_schema_metadata(table.schema.metadata), path)
    assert main(["replay", str(folder)]) == 1
    assert "in acceleration; the tables do not agree" in re.sub(r"\s+", " ", capsys.readouterr().out)
    pq.write_table(table, path)


def test_the_command_that_reports_runs_reports_studies(folder, capsys):
    assert main(["report", str(folder)]) == 0
    assert "report.html" in capsys.readouterr().out
    assert (folder / "report.html").is_file()


@pytest.mark.parametrize(
    ("typed", "meant"), [("cabinet-shok", "cabinet_shock"), ("floating_flor_sweep", "floating_floor_sweep")]
)
def test_a_mistyped_scenario_is_answered_with_the_nearest(capsys, typed, meant):
    assert main(["run", typed]) == 2
    assert f"Did you mean {meant}?" in capsys.readouterr().err
