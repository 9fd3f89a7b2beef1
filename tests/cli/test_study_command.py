import re

import numpy as np
import pyarrow.parquet as pq
import pytest
from small_study import STUDY_FILE, write_study

import wirerope_mj as wr
from wirerope_mj.cli import main
from wirerope_mj.foundation.errors import ModelError, RecordError
from wirerope_mj.runs.study import load_study_file, shipped_studies, write_study_report, write_worst
from wirerope_mj.studies.results.measure import row_of, worst
from wirerope_mj.studies.vary.quantities import direction

ANGLES = ("motion/azimuth", "motion/elevation")


@pytest.fixture(scope="module")
def done(tmp_path_factory):
    """Return a study's file and the folder that the command has written, with what it printed."""
    place = tmp_path_factory.mktemp("studies")
    file, folder = write_study(place), place / "out"
    assert main(["study", str(file), "--variants", "64", "--workers", "1", "--out", str(folder)]) == 0
    return file, folder


def test_a_study_becomes_one_folder_with_table_and_pictures(done):
    _, folder = done
    files = {path.name for path in folder.iterdir() if path.is_file()}
    assert files >= {"variants.parquet", "study.toml", "summary.json", "distribution.png", "sensitivity.png"}
    assert pq.read_table(folder / "variants.parquet").num_rows == 64


def test_files_that_another_process_writes_just_now_are_not_named(done, capsys):
    file, folder = done
    (folder / ".distribution.1.part.png").touch()
    assert main(["study", str(file), "--variants", "64", "--resume", "--out", str(folder)]) == 0
    assert ".part" not in capsys.readouterr().out


def test_resuming_a_complete_study_prints_it_again_and_computes_nothing(done, capsys):
    file, folder = done
    before = (folder / "variants.parquet").stat().st_mtime_ns
    assert main(["study", str(file), "--variants", "64", "--resume", "--out", str(folder), "--all"]) == 0
    out = capsys.readouterr().out
    assert (folder / "variants.parquet").stat().st_mtime_ns == before
    table = wr.load_study(folder).table
    top = worst(table, "travel", 1)[0]
    beyond = int((np.asarray(table["travel"]) > 1.0).sum())
    assert 0 < beyond < 64
    assert f"beyond 100 % in {beyond} of 64 variants" in out
    assert f"in variant {top}." in out
    assert "Worst variants by travel" in out
    assert "travel combined" not in out  # the mount is rated along its axis alone
    assert "motion/level" in out


def test_a_study_that_is_there_is_not_replaced_unasked(done, capsys):
    file, folder = done
    assert main(["study", str(file), "--variants", "64", "--out", str(folder)]) == 2
    assert "--resume" in capsys.readouterr().err


def test_an_interrupted_study_says_how_it_goes_on(done, capsys, monkeypatch):
    file, folder = done

    def interrupted(*arguments, **options):
        raise KeyboardInterrupt

    monkeypatch.setattr(wr.Study, "run", interrupted)
    assert main(["study", str(file), "--resume", "--out", str(folder)]) == 130
    first, second = capsys.readouterr().err.splitlines()
    assert "interrupted" in first
    assert f"what is done is kept; go on with the same options and --resume --out {folder}" in second


def test_another_study_does_not_go_on_in_the_folder(done, capsys):
    file, folder = done
    assert main(["study", str(file), "--variants", "63", "--resume", "--out", str(folder)]) == 2
    assert "another study" in capsys.readouterr().err


def test_the_worst_variants_become_runs_with_the_peaks_of_the_table(done):
    _, folder = done
    result = wr.load_study(folder)
    recording, *runs = write_worst(result, "travel", 2)
    assert recording.name == "worst.rrd"
    assert recording.stat().st_size > 10_000  # two scenes and their histories
    values = np.asarray(result.table["travel"])
    numbers = [int(run.name.split("-")[1]) for run in runs]
    assert numbers == np.argsort(-values)[:2].tolist()
    for number, run in zip(numbers, runs, strict=True):
        peaks = wr.load_response(run).peaks
        row = row_of(result.table, number)
        assert peaks.bodies["mass"].acceleration.value == row["acceleration/mass"]  # one motion, so the same steps: bit for bit
        assert peaks.mounts["m1"].force.value == row["force/m1"]


def test_options_of_the_study_and_of_the_command_are_listed(done, capsys):
    file, _ = done
    assert main(["study", str(file), "--help"]) == 0
    out = capsys.readouterr().out
    for option in ("--variants", "--peak", "--engine", "--workers", "--resume", "--open-worst", "--by"):
        assert option in out
    assert "How does a mass on one mount do?" in out


def test_a_wrong_measure_is_said_before_anything_is_simulated(done, tmp_path, capsys):
    file, _ = done
    assert main(["study", str(file), "--by", "speed", "--out", str(tmp_path / "no")]) == 2
    assert "there is no measure 'speed'" in capsys.readouterr().err
    assert not (tmp_path / "no").exists()


@pytest.mark.parametrize(
    ("arguments", "message"),
    [
        (["nosuch"], "there is no study 'nosuch'.*floor_tolerances.*with --vary a scenario is one, too: .*shock_table"),
        (["./nosuch.py"], r"\./nosuch\.py: there is no such file\."),
        (["floor_levels", "--vary", "motion/level = Uniform(1, 2)"], "`--vary` is for scenarios"),
        (["floating_floor_shock"], "nothing varies yet. In floating_floor_shock can vary:"),
        (["--out", "x"], "the study comes first"),
        (["floor_levels", "--resume"], "say which one with --out"),
        (["floor_levels", "--open-worst", "99"], "from 0 to 6, got 99"),
        (["floor_directions", "--step-deg", "40"], r"floor_directions\.py, line \d+: `step_deg` must divide 90"),
    ],
)
def test_bad_input_is_one_message_and_exit_code_2(arguments, message, capsys):
    assert main(["study", *arguments]) == 2
    err = capsys.readouterr().err
    assert re.search(message, err)
    assert "Traceback" not in err


def test_shipped_studies_are_listed_with_their_questions(capsys):
    assert main(["study", "--list"]) == 0
    out = capsys.readouterr().out
    for name in ("floor_tolerances", "floor_failed_mount", "floor_levels", "floor_directions"):
        assert name in out


@pytest.mark.parametrize("name", sorted(shipped_studies()))
def test_every_shipped_study_is_short_asks_first_and_can_be_made(name):
    file = load_study_file(name)
    assert file.question.endswith("?")
    assert len(file.path.read_text(encoding="utf-8").splitlines()) <= 60
    study = file.make()
    assert study.name == name
    assert study.question.startswith(file.question)
    assert study.table().num_rows == study.size


def test_directions_cover_the_sphere_and_failures_every_wire_rope_mount():
    table = load_study_file("floor_directions").make(step_deg=30.0).table()
    assert table.num_rows == 12 * 5 + 2  # each pole once, and no seam
    vectors = {tuple(np.round(direction(a, e), 9)) for a, e in zip(*(table[k].to_pylist() for k in ANGLES), strict=True)}
    assert len(vectors) == 62
    for axis in np.vstack([np.eye(3), -np.eye(3)]):
        assert tuple(axis) in vectors
    failed = load_study_file("floor_failed_mount").make().table()
    assert len(set(failed["mount/*/failed"].to_pylist())) == 21  # 16 upright, 4 horizontal, and none


def test_a_file_without_a_study_and_one_that_returns_something_else_are_refused(tmp_path):
    path = tmp_path / "mine.py"
    path.write_text("a = 1\n", encoding="utf-8")
    with pytest.raises(ModelError, match="no function `study` here"):
        load_study_file(path)
    path.write_text("def study(*, a=1):\n    return a\n", encoding="utf-8")
    with pytest.raises(ModelError, match="must return a wirerope_mj.Study or a wirerope_mj.Search, got 1"):
        load_study_file(path).make()


def test_an_option_of_the_command_cannot_be_one_of_the_study(tmp_path, capsys):
    path = tmp_path / "mine.py"
    path.write_text(STUDY_FILE.replace("peak: float", "workers: float"), encoding="utf-8")
    assert main(["study", str(path)]) == 2
    assert "`workers` is an option of the command" in capsys.readouterr().err


def test_travel_along_one_axis_is_told_from_that_of_all_together(tmp_path, capsys):
    command = ["study", "shock_table", "--duration", "0.5", "--timestep", "1e-3", "--out", str(tmp_path / "out")]
    vary = ["--vary", "motion/level = Uniform(0.5, 1.5)", "--variants", "2", "--workers", "1"]
    assert main([*command, *vary]) == 0
    out = capsys.readouterr().out
    assert "Travel (largest utilisation of a rated travel along one axis): beyond 100 % in 1 of 2" in out
    assert "Combined travel (utilisation of all rated travels at once, in-house rule): beyond 100 % in" in out


def test_a_variant_with_nothing_to_stand_on_comes_before_those_within_their_limits(tmp_path, capsys):
    command = ["study", "shock_table", "--duration", "0.4", "--out", str(tmp_path / "out"), "--workers", "1"]
    vary = ["--vary", "mount/m1/failed = Choice('', 'm1')", "--sampling", "grid", "--limit", "acceleration = 100 g"]
    assert main([*command, *vary]) == 0
    assert "1 of 2 variants could not be simulated, 1 is within the limits" in capsys.readouterr().out


def test_the_report_of_a_study_is_one_page_that_needs_nothing_else(done, capsys):
    _, folder = done
    assert main(["study-report", str(folder)]) == 0
    page = (folder / "report.html").read_text(encoding="utf-8")
    assert "A limit is exceeded in" in page
    assert "How does a mass on one mount do?" in page
    assert page.count("<figure") == 3  # distribution, sensitivity, scatter
    assert not re.search(r'(src|href)="(?!data:|#)', page)
    assert "motion/level" in page


def test_a_report_looks_at_the_measure_that_is_asked_for(done, tmp_path):
    _, folder = done
    (page,) = write_study_report(folder, by="force/m1", out=tmp_path / "page.html")
    assert "Worst variants by force, m1" in page.read_text(encoding="utf-8")
    with pytest.raises(RecordError, match="exists already"):
        write_study_report(folder, out=page)


def test_no_report_is_made_of_what_is_not_a_complete_study(done, tmp_path):
    with pytest.raises(RecordError, match="not a study"):
        write_study_report(tmp_path)
