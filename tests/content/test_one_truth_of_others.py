"""Terminal, page and content.json of every shipped study, of identifications and selections say the same under the same ids."""

import html
import json
from pathlib import Path

import numpy as np
import pytest
from finished_runs import tables_of
from shown import cells_of, cells_to_show, missing_rows, printed_by

import wirerope_mj as wr
from wirerope_mj.cli import identify as identify_command
from wirerope_mj.cli import main
from wirerope_mj.content import part_selection
from wirerope_mj.runs.study import CONTENT, result_content, shipped_studies, write_study_report
from wirerope_mj.studies.study import load_study
from wirerope_mj.views import terminal

SHORT = {
    "floor_directions": ["--step-deg", "90", "--duration", "0.25"],
    "floor_failed_mount": ["--direction", "z", "--duration", "0.25"],
    "floor_levels": ["--levels", "4", "--duration", "0.25"],
    "floor_placement": ["--population", "8", "--generations", "2", "--interval", "0.1", "--timestep", "5e-4"],
    "floor_sensitivity": ["--rows", "8", "--duration", "0.25"],
    "floor_specimens": ["--variants", "8"],
    "floor_tolerances": ["--variants", "8", "--duration", "0.25"],
}
"""Options with which they last seconds."""

PRINTED = ("answer", "results", "inputs", "worst")
"""Sections of a study that the terminal prints and content.json holds."""

WORKSHEETS = {
    "words": ["--shock", "15 g 11 ms half-sine", "--travel", "40"],
    "fragile": ["--velocity", "1.0", "--fragility", "25"],
}


@pytest.fixture(scope="module", params=sorted(shipped_studies()))
def study(request, tmp_path_factory):
    folder = tmp_path_factory.mktemp("study") / "out"
    printed = printed_by("study", request.param, *SHORT[request.param], "--workers", "1", "--out", str(folder), "--all")
    write_study_report(folder)
    return folder, printed, result_content(load_study(folder))


@pytest.mark.slow
def test_a_study_says_the_same_on_the_terminal_on_its_page_and_in_its_file(study):
    folder, printed, content = study
    page = (folder / "report.html").read_text(encoding="utf-8")
    written = json.loads((folder / CONTENT).read_text(encoding="utf-8"))
    tables = tables_of(content)
    assert tables
    for name, table in tables.items():
        assert cells_of(page, name) == cells_to_show(table), name
    in_terminal = [block.id for section in content.sections if section.id in PRINTED for block in section.blocks]
    for name in tables.keys() & in_terminal:
        assert not missing_rows(printed, tables[name]), name
        assert written[name] == json.loads(json.dumps(tables[name].to_dict())), name
    assert written == json.loads(json.dumps(content.to_dict(*PRINTED)))
    assert content.verdict.text in [line.strip() for line in printed.splitlines()]
    assert html.escape(content.verdict.text) in page


def said_by(monkeypatch, capsys, place, name, *arguments):
    """Return what a command composes, and what it prints 200 characters wide."""
    seen = []
    compose = getattr(place, name)
    monkeypatch.setattr(place, name, lambda *a, **k: seen.append(compose(*a, **k)) or seen[-1])
    monkeypatch.setattr(terminal, "WIDTH", 200)
    capsys.readouterr()
    assert main([str(argument) for argument in arguments]) == 0
    return seen[-1], capsys.readouterr().out


@pytest.mark.slow
@pytest.mark.parametrize("law", ["bouc-wen", "asymmetric-bouc-wen"])
def test_an_identification_says_the_same_on_the_terminal_and_on_its_page(law, here, monkeypatch, capsys):
    true = wr.AsymmetricBoucWen(
        alpha=2e5, beta=300.0, gamma=100.0, n=1.0, k1=5e4, k2=-2e5 if law != "bouc-wen" else 0.0, k3=1e6, b=1.0, c=20.0
    )
    for amplitude in (2e-3, 5e-3, 1e-2):
        (loop,) = wr.cyclic_test(true, [amplitude])
        noise = np.random.default_rng(1).normal(0.0, 2.0, len(loop.force))
        columns = np.column_stack([1e3 * loop.deflection, loop.force + noise])
        np.savetxt(f"{amplitude}.csv", columns, delimiter=",", header="deflection [mm],force [N]", comments="")
    files = sorted(Path().glob("*.csv"))
    content, printed = said_by(
        monkeypatch, capsys, identify_command, "identification_content",
        "identify", *files, "--law", law, "--axis", "axial", "--out", "fitted.toml", "--accept-unconverged", "--all",
    )  # fmt: skip
    page = Path("fitted-report", "report.html").read_text(encoding="utf-8")
    tables = tables_of(content)
    assert tables
    for name, table in tables.items():
        assert cells_of(page, name) == cells_to_show(table), name
    for section in content.sections:
        if section.id in ("parameters", "loops-and-residuals", "search"):
            for name in tables.keys() & {block.id for block in section.blocks}:
                assert not missing_rows(printed, tables[name]), name
    assert content.verdict.text in [line.strip() for line in printed.splitlines()]
    assert html.escape(content.verdict.text) in page


@pytest.mark.parametrize("shock", WORKSHEETS)
def test_a_worksheet_prints_every_row_and_its_headline(shock, monkeypatch, capsys):
    said_alike(
        *said_by(
            monkeypatch, capsys, part_selection, "selection_content",
            "select", "worksheet", "--mass", "400", "--mounts", "6", *WORKSHEETS[shock],
        )
    )  # fmt: skip


@pytest.mark.slow
def test_a_selection_by_simulation_prints_every_row_and_its_headline(monkeypatch, capsys):
    said_alike(
        *said_by(
            monkeypatch, capsys, part_selection, "catalogue_selection_content",
            "select", "--mass", "400", "--mounts", "6", "--shock", "15 g 11 ms half-sine", "--parts", "CB1500*", "--all",
        )
    )  # fmt: skip


def said_alike(content, printed):
    tables = tables_of(content)
    assert tables
    for name, table in tables.items():
        assert not missing_rows(printed, table), name
    assert content.verdict.text in [line.strip() for line in printed.splitlines()]
