"""Jobs: load cases that run only when their inputs changed, what governs each limit, and files that are wrong."""

import json
import shutil
import signal
import time
from pathlib import Path
from types import SimpleNamespace

import numpy as np
import pytest
from commands import WIREROPE
from kills import interruptible

import wirerope_mj as wr
from wirerope_mj.cli import main
from wirerope_mj.content.job_comparison import job_comparison_content
from wirerope_mj.content.job_envelope import envelope_blocks
from wirerope_mj.foundation.atomic_files import worked_on_alone
from wirerope_mj.foundation.errors import SimulationError
from wirerope_mj.foundation.half_written import hidden_file
from wirerope_mj.runs import job as job_module
from wirerope_mj.runs.folder import alterations
from wirerope_mj.runs.job import judged_job
from wirerope_mj.runs.job_file import document_table, read_document
from wirerope_mj.runs.scenario_file import run_facts, run_verdicts

CASES = """
name = "Table on one mount"
model = "shock_table"
combined_travel = false
report = ["accelerations", "mounts"]

[simulate]
duration = 0.3
accuracy = 1e-3

[[case]]
name = "Down, mild"
half-sine = "5 g 11 ms -z"
note = "clause 1"

[[case]]
name = "Up and hard"
half-sine = ["20 g 11 ms z"]

[limits]
"acceleration/block" = "8 g"
"""


def written(folder, text=CASES):
    path = folder / "job.toml"
    path.write_text(text, encoding="utf-8")
    return path


@pytest.fixture(scope="module")
def done(tmp_path_factory):
    """A job that was computed once, in this process."""
    folder = tmp_path_factory.mktemp("job")
    return folder, wr.run_job(written(folder), folder / "out", workers=1)


@pytest.fixture
def again(done, tmp_path):
    """A copy of it that a test may change, and how it is computed again: what was computed and why."""
    shutil.copytree(done[0], tmp_path / "job")

    def run(text=CASES, **options):
        path = written(tmp_path / "job", text)
        return dict(wr.run_job(path, tmp_path / "job" / "out", workers=1, **options).computed)

    return run


def test_every_case_is_a_run_of_its_own(done):
    folder, result = done
    assert dict(result.computed) == {"Down, mild": "new", "Up and hard": "new"}
    assert sorted(path.name for path in (folder / "out").iterdir()) == [
        "cases", "job.rrd", "job.toml", "report.html", "summary.json",
    ]  # fmt: skip
    for name in ("down-mild", "up-and-hard"):
        run = folder / "out" / "cases" / name
        assert wr.replay(run).identical
        assert (run / "report.html").is_file()


def test_a_limit_is_governed_by_the_case_whose_own_run_uses_most_of_it(done):
    folder, result = done
    runs = {case.name: folder / "out" / "cases" / case.folder for case in result.job.cases}
    verdicts = {name: run_verdicts(run, wr.load_response(run)) for name, run in runs.items()}
    content = json.loads((folder / "out" / "summary.json").read_text(encoding="utf-8"))["content"]
    rows = content["governing"]["rows"]
    assert {"travel", "acceleration"} <= {row[0].split(" in ")[0].split(" along ")[0] for row in rows}
    for criterion, subject, *_, used, case, _, _ in rows:
        kind = next(row.criterion.kind for row in verdicts["Up and hard"] if str(row.criterion) == criterion)
        every = {
            name: max(row.utilisation or 0.0 for row in own if (row.criterion.kind, row.subject) == (kind, subject))
            for name, own in verdicts.items()
        }
        assert used == max(every.values())
        assert case == "all" and len(set(every.values())) == 1 or every[case] == used
    assert content["headline"]["values"]["utilisation"] == max(row[-4] for row in rows)


def test_the_envelope_says_what_the_base_does_what_the_deck_bears_and_the_room_that_points_need(done):
    folder, _ = done
    content = json.loads((folder / "out" / "summary.json").read_text(encoding="utf-8"))["content"]
    runs = [wr.load_response(folder / "out" / "cases" / case) for case in ("down-mild", "up-and-hard")]
    system = wr.load_system("shock_table")
    weight = 9.80665 * sum(float(system.model.body(name).subtreemass[0]) for name in system.payloads)
    for (name, peak, velocity, _, at_rest, *_), level in zip(content["envelope-base"]["rows"], (5.0, 20.0), strict=True):
        assert peak == pytest.approx(level * 9.80665, rel=1e-3), name  # the top of the pulse stands between two steps
        assert velocity == pytest.approx(2.0 / np.pi * level * 9.80665 * 0.011, rel=1e-6)
        assert at_rest == pytest.approx(weight, rel=1e-3)  # of an equilibrium found to its own tolerance
    ((name, *ways, _),) = content["envelope-room"]["rows"]
    moved = [run.peaks.points[name].relative_displacement for run in runs]
    low, high = np.min([one.minimum for one in moved], axis=0), np.max([one.maximum for one in moved], axis=0)
    assert ways == pytest.approx(np.maximum(np.stack([-low, high], axis=1).ravel(), 0.0))


def test_nothing_runs_twice(again):
    assert again() == {}
    assert again(f'{CASES}\n[document]\nnumber = "D-1"\n') == {}  # what is only written is no input of a simulation


@pytest.mark.parametrize(
    ("change", "expected"),
    [
        (('"5 g 11 ms -z"', '"6 g 11 ms -z"'), {"Down, mild": "changed: motion"}),
        (
            ('"8 g"', '"9 g"'),
            dict.fromkeys(("Down, mild", "Up and hard"), "changed: limits, judged again without simulating"),
        ),
        (("= 0.3", "= 0.31"), {"Down, mild": "changed: numerics", "Up and hard": "changed: numerics"}),
        (('"clause 1"', '"clause 2"'), {}),
        (('"Up and hard"', '"Up"'), {"Up": "new"}),
    ],
)
def test_only_what_a_change_touches_runs_again(again, monkeypatch, change, expected):
    monkeypatch.setattr(job_module, "_write_views", lambda *_, **__: None)
    assert again(CASES.replace(*change)) == expected


@pytest.mark.slow
def test_a_changed_limit_is_judged_as_a_new_run_would_be_without_simulating(again, tmp_path, monkeypatch):
    monkeypatch.setattr(job_module, "_write_views", lambda *_, **__: None)
    runs = tmp_path / "job" / "out" / "cases"
    samples = {run.name: wr.load_response(run).bodies["block"].acceleration for run in runs.iterdir()}

    def never(*_, **__):
        raise AssertionError("it was simulated")

    with monkeypatch.context() as patch:
        patch.setattr(job_module, "write_run", never)
        again(CASES.replace('"8 g"', '"2 g"'))
    judged = {run.name: (run / "summary.json").read_text(encoding="utf-8") for run in runs.iterdir()}
    assert all("FAIL" in text for text in judged.values())
    for run in runs.iterdir():
        np.testing.assert_array_equal(wr.load_response(run).bodies["block"].acceleration, samples[run.name])
    assert all(alterations(run).intact for run in runs.iterdir())
    again(CASES.replace('"8 g"', '"2 g"'), force=True)
    for run in runs.iterdir():
        new, old = (json.loads(text) for text in ((run / "summary.json").read_text(encoding="utf-8"), judged[run.name]))
        for one in (new, old):
            one["numerics"].pop("seconds")
        assert new == old


@pytest.mark.slow
def test_a_document_that_stands_in_the_folder_is_written_anew(again, tmp_path):
    again(docx=True)
    document = tmp_path / "job" / "out" / "report.docx"
    before = document.read_bytes()
    again(CASES.replace("Table on one mount", "Table on a mount"))
    assert document.read_bytes() != before
    assert not (tmp_path / "job" / "out" / "report.pdf").exists()


def test_a_case_whose_files_were_altered_runs_again(again, tmp_path):
    summary = tmp_path / "job" / "out" / "cases" / "down-mild" / "summary.json"
    summary.write_text(summary.read_text(encoding="utf-8").replace("PASS", "FAIL"), encoding="utf-8")
    assert again() == {"Down, mild": "altered"}


@pytest.mark.slow
def test_a_record_is_an_input_by_its_content(tmp_path, monkeypatch):
    monkeypatch.setattr(job_module, "_write_views", lambda *_, **__: None)
    at = np.arange(200) / 1000.0
    for name, peak in (("a", 1.0), ("b", 2.0)):
        rows = np.column_stack([at, peak * np.sin(np.pi * at / 0.011) * (at < 0.011)])
        head = "time [s],z [g]"
        np.savetxt(tmp_path / f"{name}.csv", rows, delimiter=",", header=head, comments="", fmt="%.6g")
    text = 'model = "shock_table"\nsimulate.duration = 0.1\n[records]\nfiles = "*.csv"\ndirection = "z"\nchannels = ["z"]\n'
    path = written(tmp_path, text)
    assert dict(wr.run_job(path, tmp_path / "out", workers=1).computed) == {"a": "new", "b": "new"}
    shutil.copyfile(tmp_path / "a.csv", tmp_path / "b.csv")
    assert dict(wr.run_job(path, tmp_path / "out", workers=1).computed) == {"b": "changed: motion"}


def test_cases_come_from_a_sheet(tmp_path):
    openpyxl = pytest.importorskip("openpyxl")
    book = openpyxl.Workbook()
    book.active.append(["name", "half-sine", "sine", "duration [ms]", "initial", "note"])
    book.active.append(["pulse", "5 g 11 ms z", None, 150, None, "clause 7"])
    book.active.append(["hum", None, "0.5 g 12 Hz 1 s z", None, "unloaded", None])
    book.save(tmp_path / "cases.xlsx")
    job = wr.load_job(written(tmp_path, 'model = "shock_table"\nsheet = "cases.xlsx"\n'))
    assert [(case.name, case.note) for case in job.cases] == [("pulse", "clause 7"), ("hum", "")]
    pulse, hum = (case.scenario for case in job.cases)
    assert isinstance(pulse.motion, wr.HalfSine)
    assert pulse.motion.peak == pytest.approx(5 * wr.STANDARD_GRAVITY, rel=1e-12)
    assert pulse.simulate == {"duration": 0.15}
    assert hum.simulate["initial"] == "unloaded"


@pytest.mark.slow
def test_a_case_that_fails_leaves_the_others_and_the_next_call_goes_on(again, monkeypatch):
    ordinary = job_module.write_run

    def fails(scenario, folder, **options):
        if scenario.name == "Up and hard":
            raise SimulationError("it went away.")
        ordinary(scenario, folder, **options)

    changed = CASES.replace("= 0.3", "= 0.31")
    monkeypatch.setattr(job_module, "write_run", fails)
    with pytest.raises(SimulationError, match=r"1 of 2 load cases .*Up and hard: it went away"):
        again(changed)
    monkeypatch.setattr(job_module, "write_run", ordinary)
    assert again(changed) == {"Up and hard": "changed: numerics"}


@pytest.mark.slow
def test_an_interrupted_job_leaves_nothing_half_written_and_goes_on(tmp_path):
    written(tmp_path)
    command = [*WIREROPE, "cases", "job.toml", "--out", "out"]
    with interruptible(command, cwd=tmp_path) as process:
        while not list((tmp_path / "out" / "cases").glob(".*")) and process.poll() is None:
            time.sleep(0.01)
        process.send_signal(signal.SIGINT)
        said = process.communicate(timeout=120)[1]
    assert process.returncode == 130
    assert "the same command goes on" in said
    assert not [path for path in (tmp_path / "out").rglob(".*")]
    assert sorted(wr.run_job(tmp_path / "job.toml", tmp_path / "out", workers=1).computed.values()) == ["new", "new"]


def test_a_job_that_another_process_begins_in_a_new_folder_is_called_so(tmp_path):
    written(tmp_path)
    (tmp_path / "out").mkdir()
    other = worked_on_alone(tmp_path / "out", kind="job"), hidden_file(tmp_path / "out" / "job.toml")
    with other[0], other[1], pytest.raises(wr.RecordError, match=r"out: another process works on this job"):
        wr.run_job(tmp_path / "job.toml", tmp_path / "out")


@pytest.mark.slow
def test_processes_compute_what_one_does(done, tmp_path):
    folder, _ = done
    result = wr.run_job(folder / "job.toml", tmp_path / "out", workers=2)
    assert len(result.computed) == 2
    for name in ("down-mild", "up-and-hard"):
        one, other = (place / "cases" / name / "response.parquet" for place in (folder / "out", tmp_path / "out"))
        assert one.read_bytes() == other.read_bytes()


@pytest.mark.slow
def test_two_jobs_are_compared_case_by_case(done, tmp_path, capsys):
    folder, _ = done
    text = CASES.replace('"20 g 11 ms z"', '"30 g 11 ms z"').replace('"Down, mild"', '"Down"')
    wr.run_job(written(tmp_path, text), tmp_path / "out", workers=1)
    capsys.readouterr()
    both = [str(folder / "out"), str(tmp_path / "out")]
    assert main(["compare", *both, "--names", "before", "after", "--all", "--out", str(tmp_path / "both")]) == 0
    assert 'data-id="cases"' in (tmp_path / "both" / "report.html").read_text(encoding="utf-8")
    said = " ".join(capsys.readouterr().out.split())
    assert "after uses more of the limits in Up and hard." in said or "after exceeds limits in Up and hard" in said
    assert "Up and hard: half-sine: 20 g 11 ms z -> 30 g 11 ms z" in said
    assert "motion:" not in said  # that the phrase has said
    assert "not in it" in said


MASSES = (
    "name, mass [kg], x [mm], y [mm], z [mm], size_x [mm], size_y [mm], size_z [mm]\nrack, {mass}, 0, 0, 800, 600, 600, 1200\n"
)


@pytest.mark.slow
def test_two_jobs_say_which_mounts_have_another_isolator_and_not_digests(tmp_path, capsys):
    def job(name, isolators, mass):
        folder = tmp_path / name
        folder.mkdir()
        places = [(-300, -300), (300, -300), (-300, 300), (300, 300)]
        rows = [f"b{n}, {x}, {y}, 54, {part}" for n, ((x, y), part) in enumerate(zip(places, isolators, strict=True), 1)]
        (folder / "mounts.csv").write_text("name, x [mm], y [mm], z [mm], isolator\n" + "\n".join(rows), encoding="utf-8")
        (folder / "masses.csv").write_text(MASSES.format(mass=mass), encoding="utf-8")
        assert main(["new", str(folder / "rack"), "--tables", str(folder)]) == 0
        text = 'model = "rack/rack.xml"\n[[case]]\nname = "Down"\nhalf-sine = "5 g 11 ms z"\nduration = 0.1\n'
        wr.run_job(written(folder, text), folder / "out", workers=1)
        return str(folder / "out")

    parts = ["CB1500-20"] * 4
    one, other, heavier = (
        job("one", parts, 400), job("other", [*parts[:2], "CB1500-15", parts[3]], 400), job("heavier", ["CB1500-15"] * 4, 430)
    )  # fmt: skip
    capsys.readouterr()
    assert main(["compare", one, other, "--out", str(tmp_path / "part")]) == 0
    said = " ".join(capsys.readouterr().out.split())
    assert "Down: b3: CB1500-20 -> CB1500-15" in said
    assert "digest" not in said
    assert "alpha" not in said  # the parameters of a part are those of its name
    assert main(["compare", one, heavier, "--out", str(tmp_path / "mass")]) == 0
    said = " ".join(capsys.readouterr().out.split())
    assert "Down: b1, b2, b3, b4: CB1500-20 -> CB1500-15" in said
    assert "mass of rack: 400 kg -> 430 kg" in said


def test_a_law_that_was_edited_is_said_by_its_parameter(done):
    folder = done[0] / "out" / "cases" / "down-mild"
    facts = run_facts(folder)
    (stated,) = [
        key for key in facts if key.endswith("WR12-400: limits.static_load") or key.endswith("400: limits.static_load")
    ]
    edited = facts | {stated: "1"}
    job = judged_job(done[0] / "out")
    models = {name: {case.name: table for case in job.cases} for name, table in (("a", facts), ("b", edited))}
    none = {name: {case.name: {} for case in job.cases} for name in "ab"}
    content = job_comparison_content({"a": job, "b": job}, none, models)
    (statement,) = [block for block in content.blocks() if getattr(block, "id", "") == "inputs"]
    assert statement.items == (f"every case: {stated}: {facts[stated]} -> 1",)


def test_spectra_of_cases_along_different_axes_have_the_envelope_that_their_caption_promises(done):
    """Each axis had one curve, and none was the envelope."""
    run = judged_job(done[0] / "out").runs["Up and hard"]

    def spectra_chart(**axes):
        spectra = {name: SimpleNamespace(shock={axis: run.spectra.shock["z"]}) for name, axis in axes.items()}
        runs = {name: SimpleNamespace(response=run.response, spectra=spectra[name], motion=run.motion) for name in axes}
        runs = {name: SimpleNamespace(**vars(case), verdicts=run.verdicts) for name, case in runs.items()}
        return next(block for block in envelope_blocks(runs) if getattr(block, "id", "") == "envelope-spectra")

    def named(chart):
        return [{curve.name for curve in panel.curves} for panel in chart.rows[0]]

    chart = spectra_chart(down="z", athwartships="y")
    assert named(chart) == [{"athwartships", "envelope"}, {"down", "envelope"}]
    assert "envelope" in chart.caption
    chart = spectra_chart(down="z")
    assert named(chart) == [{"down"}]
    assert "envelope" not in chart.caption


def test_a_job_compared_with_itself_shows_no_table_without_rows(done, tmp_path, capsys):
    out = str(done[0] / "out")
    assert main(["compare", out, out, "--names", "one", "other", "--all", "--out", str(tmp_path / "both")]) == 0
    said = capsys.readouterr().out
    assert "They use the same fraction of every limit." in said
    assert "use different fractions" not in said


def test_a_job_is_replayed_and_reported_from_its_folder_alone(done, tmp_path, capsys):
    shutil.copytree(done[0] / "out", tmp_path / "moved")
    assert main(["replay", str(tmp_path / "moved")]) == 0
    assert capsys.readouterr().out.count("bit-identical") == 2
    assert main(["report", str(tmp_path / "moved"), "--out", str(tmp_path / "page.html")]) == 0
    assert (tmp_path / "page.html").read_bytes() == (tmp_path / "moved" / "report.html").read_bytes()


def test_the_recording_holds_every_case(done):
    from rerun.chunk import RrdReader

    stores = RrdReader(str(done[0] / "out" / "job.rrd")).recordings()
    assert len({entry.recording_id for entry in stores}) == 2
    assert len({entry.application_id for entry in stores}) == 2  # each with a layout of its own


@pytest.mark.parametrize(
    ("text", "message"),
    [
        ("", "job.toml: `model` is missing: the path of a model"),
        ('model = "cupboard"', "cupboard"),
        ('model = "shock_table"', "there is no load case; one is [[case]] with a name and a motion"),
        ('model = "shock_table"\nmodels = "x"', "line 2: `models` is unknown; known: model, name, question"),
        ('model = "shock_table"\n[[case]]\nname = "a"\nhalfsine = "5 g"', "Did you mean `half-sine`?"),
        ('model = "shock_table"\n[[case]]\nhalf-sine = "5 g 11 ms z"', "line 2: [[case]] 1 `name` is missing: it names"),
        ('model = "shock_table"\n[[case]]\nname = "a"', "line 2: [[case]] 1 'a': it says no motion: one of half-sine"),
        ('model = "shock_table"\n[[case]]\nname = "a"\nhalf-sine = "5 g z"', "a time must stand there (s, ms, us, min, h)"),
        ('model = "shock_table"\n[[case]]\nname = "a"\nhalf-sine = 5', "`half-sine` must be a text or a list of texts, got 5"),
        (
            'model = "shock_table"\n[[case]]\nname = "A b"\nsine = "1 g 9 Hz 1 s z"\n'
            '[[case]]\nname = "a, b"\nsine = "1 g 9 Hz 1 s z"',
            "line 5: [[case]] 2 'a, b' is given twice",
        ),
        ('model = "shock_table"\n[[case]]\nname = "a"\nrecord = "gone.csv"', "gone.csv: no such file"),
        ('model = "shock_table"\n[limits]\n"acceleration/block" = 8', "line 3: [limits] `acceleration/block` must be a text"),
        ('model = "shock_table"\n[limits]\n"acceleration/rack" = "8 g"', "there is no body of the payload and no point 'rack'"),
        ('model = "shock_table"\nreport = ["loops"]', "`report` may hold accelerations, mounts"),
        ('model = "shock_table"\nsheet = "gone.xlsx"', "gone.xlsx"),
        ('model = "shock_table"\n[records]\nfiles = "records/*.csv"', "no file matches `files` = 'records/*.csv'"),
        ('model = "shock_table"\n[document]\nrevisions = "B"', "[document] `revisions` is unknown; known: project, number"),
        ('model = "shock_table"\n[document]\nlogo = "job.toml"', "`logo` must be a PNG or JPEG file"),
        ('model = "shock_table"\n[document]\ntemplate = "gone.typ"', "gone.typ' for `template`"),
        ('model = "shock_table"\n[document]\ntext.summary = "x"', "`summary` is unknown; known: scope, assumptions"),
        ("model =", "not valid TOML"),
    ],
)  # fmt: skip
def test_a_wrong_job_is_one_message_and_nothing_is_written(tmp_path, capsys, text, message):
    case = '\n[[case]]\nname = "x"\nhalf-sine = "5 g 11 ms z"\n'
    whole = text + case if "[document]" in text or "report" in text else text
    path = written(tmp_path, whole)
    assert main(["cases", str(path), "--out", str(tmp_path / "out")]) == 2
    (line,) = capsys.readouterr().err.splitlines()
    assert line.startswith("wirerope: ")
    assert message in line
    assert [entry.name for entry in tmp_path.iterdir()] == ["job.toml"]


def test_a_job_holds_copies_of_the_logo_and_the_template_of_its_document(tmp_path):
    (tmp_path / "ours.bin").write_bytes(b"\x89PNG\r\n\x1a\n")
    (tmp_path / "house.typ").write_text("", encoding="utf-8")
    table = {"number": "N1", "logo": "ours.bin", "template": "house.typ"}
    document = read_document(table, tmp_path / "job.toml")
    assert document_table(document) == {"number": "N1", "logo": "logo.png", "template": "template.typ"}


def test_another_folder_is_not_touched(done, tmp_path, capsys):
    (tmp_path / "mine").mkdir()
    (tmp_path / "mine" / "thesis.txt").write_text("years of work", encoding="utf-8")
    assert main(["cases", str(done[0] / "job.toml"), "--out", str(tmp_path / "mine")]) == 2
    assert "this folder exists and is not a job" in capsys.readouterr().err
    assert [path.name for path in Path(tmp_path / "mine").iterdir()] == ["thesis.txt"]


def test_a_file_of_the_users_own_is_not_replaced(tmp_path, capsys):
    path = written(tmp_path)
    assert main(["cases", str(path), "--out", str(tmp_path)]) == 2
    assert "job.toml: this is not what `wirerope cases` writes into its folder, and was not touched" in capsys.readouterr().err
    assert path.read_text(encoding="utf-8") == CASES
    assert [entry.name for entry in tmp_path.iterdir()] == ["job.toml"]
