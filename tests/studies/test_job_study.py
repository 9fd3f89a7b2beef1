"""A study of a job: one sample of systems under every load case, and how often any limit of any case is exceeded."""

import json

import numpy as np
import pytest
from writing_commands import files

import wirerope_mj as wr
from wirerope_mj.cli import main
from wirerope_mj.runs import study as studies_of_runs
from wirerope_mj.runs.job_file import load_job
from wirerope_mj.runs.study import limits_of, study_job
from wirerope_mj.studies.engines import local
from wirerope_mj.studies.engines.compute import failed_part

JOB = """
name = "Two cases"
model = "shock_table"
[limits]
"acceleration/*" = "3 g"
[[case]]
name = "vertical"
half-sine = "10 g 11 ms z"
duration = 0.4
[[case]]
name = "along"
half-sine = "10 g 11 ms x"
duration = 0.4
"""


def test_a_study_of_a_job_stays_whole_until_the_one_that_replaces_it_is(tmp_path, monkeypatch):
    (tmp_path / "job.toml").write_text(JOB.replace("0.4", "0.1"))
    job, folder = load_job(tmp_path / "job.toml"), tmp_path / "s"

    def compute(peak, **how):
        vary = {"motion/level": wr.Uniform(0.5, peak)}
        return study_job(job, folder, vary=vary, how={"workers": 1, **how}, drawn={"variants": 2, "accuracy": 1e-2})

    compute(1.0)
    before = files(folder)

    def interrupted(scenario):
        if "along" in str(scenario.name):
            raise KeyboardInterrupt
        return limits_of(scenario)

    with monkeypatch.context() as patch:
        patch.setattr(studies_of_runs, "limits_of", interrupted)
        with pytest.raises(KeyboardInterrupt):
            compute(2.0, force=True)
    assert files(folder) == before
    with monkeypatch.context() as patch:
        patch.setattr(local, "compute", lambda work, chunk: failed_part(work, chunk, "its process died"))
        with pytest.raises(wr.SimulationError, match="processes that computed variants died"):
            compute(2.0, force=True)
    assert files(folder) == before
    assert compute(2.0, force=True).to_dict("cases")
    assert wr.load_study(folder / "along").study.vary["motion/level"] == wr.Uniform(0.5, 2.0)


@pytest.mark.slow
def test_the_probability_that_any_case_exceeds_a_limit_is_counted_on_common_variants(here, capsys):
    (here / "job.toml").write_text(JOB)
    options = [
        "--vary",
        "motion/level = Uniform(0.5, 1.5)",
        "--vary",
        "mount/*/stiffness = Normal(1, 0.1, relative)",
        "--variants",
        "16",
    ]
    assert main(["study", "job.toml", *options, "--out", "s", "--workers", "1"]) == 0
    out = capsys.readouterr().out
    tables = [wr.load_study(here / "s" / name).table for name in ("vertical", "along")]
    inputs = [name for name in tables[0].column_names if name.startswith(("motion/", "mount/"))]
    assert len(inputs) >= 2
    for name in inputs:
        assert tables[0][name].equals(tables[1][name])
    beyond = []
    for table in tables:
        named = [name for name in table.column_names if name.startswith("acceleration/")]
        assert named
        over = np.any([np.asarray(table[name]) > 3.0 * wr.STANDARD_GRAVITY for name in named], axis=0)
        for name in ("travel", "combined_travel", "static_load"):
            over |= np.asarray(table[name]) > 1.0
        beyond.append(over)
    every = int(np.count_nonzero(beyond[0] | beyond[1]))
    assert 0 < every < 16
    assert f"exceeded in {every} of 16 variants" in out
    said = json.loads((here / "s" / "content.json").read_text())
    assert said["headline"]["values"]["beyond"] == every
    assert [str(row[1]).split()[0] for row in wr_rows(said["cases"])] == [str(int(one.sum())) for one in beyond] + [str(every)]
    assert (here / "s" / "report.html").is_file()


def wr_rows(table):
    return [[cell["text"] if isinstance(cell, dict) else cell for cell in row] for row in table["rows"]]


def test_a_job_of_which_nothing_varies_lists_what_can(here, capsys):
    (here / "job.toml").write_text(JOB)
    assert main(["study", "job.toml"]) == 2
    assert "nothing varies yet. In" in capsys.readouterr().err
