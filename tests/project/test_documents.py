"""The blocks of Python in the documents run as they stand, and all that users of Python meet is described."""

import inspect
import re
import runpy
import shlex
from pathlib import Path

import numpy as np
import pytest

import wirerope_mj as wr
from wirerope_mj.cli import main
from wirerope_mj.motions import BaseMotion
from wirerope_mj.studies.measures import measure_names
from wirerope_mj.studies.results.measure import kinds_of
from wirerope_mj.studies.vary.quantities import KINDS

ROOT = Path(__file__).parents[2]


def blocks(name, heading=""):
    """Return the blocks of Python behind a heading of a document, joined."""
    text = (ROOT / name).read_text(encoding="utf-8")
    assert heading in text
    return "\n".join(re.findall(r"```python\n(.*?)```", text[text.index(heading) :], flags=re.DOTALL))


@pytest.mark.parametrize("name", sorted(wr.__all__))
def test_public_names_have_docstrings(name):
    public = getattr(wr, name)
    members = dir(public) if inspect.isclass(public) else []
    described = {f"{name}.{key}": getattr(public, key) for key in members if key in vars(public) and not key.startswith("_")}
    described[name] = public
    callable_or_property = {key: one for key, one in described.items() if callable(one) or isinstance(one, property)}
    assert not [key for key, one in callable_or_property.items() if not inspect.getdoc(one)]


@pytest.mark.slow
def test_identification_runs_from_a_record_to_an_isolator(tmp_path, monkeypatch, capsys):
    monkeypatch.chdir(tmp_path)
    names = {}
    exec(compile(blocks("docs/identification.md"), "identification.md", "exec"), names)
    fit, device = names["fit"], names["device"]
    for name, value in (("z_max", 800.0), ("x_y", 2e-3), ("sigma", 0.7), ("n", 1.4), ("k", 5e4)):
        p = fit.parameters[name]
        assert abs(p.value - value) < 3.0 * p.standard_error, name
    assert names["table"].best.law == "bouc-wen"
    assert names["both"].parameters["sigma"].standard_error < 0.5 * names["tips"].parameters["sigma"].standard_error
    assert names["pair"].spread.parameters
    for law, known in zip(names["small"].law.laws, names["rope"].laws, strict=True):
        assert law.normalised.z_max == pytest.approx(known.normalised.z_max, rel=0.02)
    assert names["isolator"].axial.normalised.z_max == pytest.approx(device.normalised.z_max, rel=0.02)
    assert "not fitted" not in capsys.readouterr().out


@pytest.mark.slow
def test_a_calibration_by_loops_runs_from_its_page():
    names = {}
    exec(compile(blocks("docs/calibrate.md"), "calibrate.md", "exec"), names)
    k, alpha = names["found"].values
    law, truth = names["law"], names["truth"]
    assert k == pytest.approx(truth.k / law.k, rel=1e-3)
    assert alpha == pytest.approx(truth.alpha / law.alpha, rel=2e-3)


def test_own_law_runs_from_its_page(capsys):
    names = {}
    exec(compile(blocks("docs/own_law.md"), "own_law.md", "exec"), names)
    law, peak = names["law"], names["response"].peaks.mounts["m1"].deflection
    assert law.trace([0.0, peak.value]).force[-1] > law.alpha * 1e-3  # it is the law that carried the shock
    assert "laws that a program brings along" in capsys.readouterr().out


def test_readme_identifies_a_law(monkeypatch, capsys):
    monkeypatch.chdir(ROOT)
    exec(compile(blocks("README.md", "From cyclic tests to an isolator"), "README.md", "exec"), {})
    assert "AsymmetricBoucWen(alpha=" in capsys.readouterr().out


@pytest.mark.slow
def test_frequency_response_runs_from_python(capsys):
    names = {}
    exec(compile(blocks("docs/frequency_response.md"), "frequency_response.md", "exec"), names)
    assert names["orbit"].stable
    assert names["branch"].complete
    assert names["level"].complete
    assert (np.diff(names["line"].frequency) < 0.0).all()  # softening: the higher level resonates lower
    assert "superharmonic 3" in capsys.readouterr().out


@pytest.mark.slow
def test_motions_run_from_python(capsys):
    names = {}
    exec(compile(blocks("docs/motions.md"), "motions.md", "exec"), names)
    assert names["match"].largest_mismatch <= 0.02
    # The rigid plateau of AC156, 1.2 S_DS, is held up to the end of the target: within the 10 % that the text says.
    time, plateau = np.arange(0.0, 11.0, 1 / 6000), np.geomspace(33.3, 100.0, 60)  # 60 samples in the shortest period
    match, envelope = names["match"], names["envelope"].acceleration(time)[:, 0]
    found = wr.shock_response_spectrum(time, match.motion.acceleration(time)[:, 0], plateau, q=10).maximax
    np.testing.assert_allclose(found, 12.0, rtol=0.1)
    reached = wr.shock_response_spectrum(time, envelope, match.frequencies, q=10).maximax
    assert (reached / match.target).min() > 1 - 1e-3  # finer sampling than the search's own changes that little
    assert len({motion.seed for motion in names["draws"]}) == len(names["draws"])
    assert names["random"].directions.shape == (2, 3)
    for name in ("naval", "table", "deck", "random", "ship"):
        assert np.isfinite(names[name].displacement([0.0, 1.0])).all()
    assert "from the target" in capsys.readouterr().out


def test_the_table_of_motions_names_every_motion():
    listed = set(re.findall(r"`(\w+)", (ROOT / "docs/motions.md").read_text(encoding="utf-8")))
    motions = {name for name in dir(wr) if isinstance(getattr(wr, name), type) and issubclass(getattr(wr, name), BaseMotion)}
    assert motions <= listed


@pytest.mark.slow
def test_a_shock_is_judged_from_python(capsys):
    names = {}
    exec(compile(blocks("docs/shock.md"), "shock.md", "exec"), names)
    words = {verdict.criterion: verdict.verdict for verdict in wr.judge(names["response"])}
    assert words["travel in compression"] == words["static load in compression"] == "within"
    assert words["acceleration"] == words["travel in tension"] == "not judged"
    assert names["verdict"].verdict == "not judged"  # the last of the random ones: nobody limits it
    steady = (names["shaking"].time >= 3.0) & (names["shaking"].time <= 18.0)  # two seconds of rise, two of fall
    by_hand = names["history"][steady].std()
    rms = [v.value for v in wr.judge_random(names["shaking"]) if v.criterion == "rms acceleration along z"]
    assert rms == pytest.approx([by_hand] * 2, rel=0.01)  # block and its top; settled a little sooner or later
    stretch = {"subject": "block", "discard": names["full"] + 1.0, "end": names["falls"]}
    given = wr.random_verdicts(names["shaking"].time, names["history"], **stretch)[0]
    assert given.value == pytest.approx(by_hand, rel=1e-9)
    assert "standard error" in capsys.readouterr().out


@pytest.mark.slow
def test_studies_run_into_a_folder(tmp_path, monkeypatch, capsys):
    monkeypatch.chdir(tmp_path)
    names = {}
    exec(compile(blocks("docs/studies.md"), "studies.md", "exec"), names)
    assert names["result"].table.num_rows == 32
    assert not names["result"].failed
    assert "acceleration" in capsys.readouterr().out


def test_the_page_of_studies_lists_every_measure():
    page = (ROOT / "docs" / "studies.md").read_text(encoding="utf-8")
    table = page[page.index("## Measures") : page.index("## From a scenario")]
    for kind in kinds_of(measure_names(wr.load_system("cabinet"))).split(", "):
        assert f"`{kind}`" in table, kind


def test_the_page_and_the_class_name_everything_that_can_vary():
    page = (ROOT / "docs" / "studies.md").read_text(encoding="utf-8")
    said = [re.sub(r"/[xyz]$", "", form) for kind in KINDS for form in kind.form.split(", ")]
    for form in said:
        assert f"`{form}" in page, form
        assert form in wr.Study.__doc__, form


def test_the_page_of_commands_shows_options_that_stand_before_a_file_is_named(tmp_path):
    runpy.run_path(str(ROOT / "docs" / "site_pages.py"))["write_commands"](tmp_path / "commands.md")
    page = (tmp_path / "commands.md").read_text(encoding="utf-8")
    study = page[page.index("## wirerope study\n") : page.index("## wirerope show\n")]
    for words in ("Usage: wirerope study STUDY-OR-SCENARIO [OPTIONS]", "--vary", "--limit", "also shows the options"):
        assert words in study


@pytest.mark.slow
@pytest.mark.parametrize("name", ["README.md", "docs/index.md"])
def test_a_first_page_shows_what_its_command_prints_today(name, here, capsys):
    page = (ROOT / name).read_text(encoding="utf-8")
    command = re.search(r"wirerope ((?:run|shock) .*)", page)[1]
    assert main(shlex.split(command)) == 0
    printed = [line.rstrip() for line in capsys.readouterr().out.strip("\n").splitlines()]
    shown = page.partition("```text\n")[2].partition("\n```")[0].splitlines()

    def stated(lines):  # without the seconds that it took, and the room beside commands of another length
        return [re.sub(r" +", " ", re.sub(r"[\d.]+ s in all", "", line)) for line in lines]

    assert stated(shown) == stated(printed)


def test_the_numbers_of_the_front_stand_on_the_page_of_checks():
    front, checks = ((ROOT / "docs" / name).read_text(encoding="utf-8") for name in ("index.md", "verification.md"))
    counted = re.search(r"(\d+) cases: (\d+) within, (\d+) outside", checks)
    assert f"[{counted[2]} of {counted[1]}](verification.md#results)" in front
    assert f"other {counted[3]} say why" in front
    transient = checks[checks.index("### opensees-transient") :]
    assert f"[{re.search(r'within, error (.*)', transient)[1]}](verification.md#opensees-transient)" in front
    building = checks[checks.index("### measured-building") :]
    deflection, acceleration = (
        float(re.search(rf"{quantity}, mean error \| 0 \| ([\d.]+)", building)[1])
        for quantity in ("peak deflection", "peak mean acceleration")
    )
    assert f"[{100.0 * deflection:.1f} %](verification.md#measured-building)" in front
    assert f"acceleration it is {100.0 * acceleration:.0f} %" in front
