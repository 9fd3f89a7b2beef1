"""`wirerope report`: the files it writes, what it refuses, and the PDF beside the page."""

import shutil
import sys
from pathlib import Path

import pytest
from shown import pages_of

import wirerope_mj as wr
from wirerope_mj.cli import main
from wirerope_mj.content.blocks import Content, Section, Statement
from wirerope_mj.foundation.errors import ConvergenceError, RecordError, WireRopeError
from wirerope_mj.foundation.tables import Column, Table
from wirerope_mj.runs.report import write_report
from wirerope_mj.runs.scenario import load_scenario
from wirerope_mj.views.document import write_pdf


@pytest.fixture(scope="module")
def table(tmp_path_factory):
    """Return the folder of a short run of one mount that travels too far."""
    folder = tmp_path_factory.mktemp("runs") / "table"
    wr.run_scenario(load_scenario("shock_table").make(duration=0.15, level_g=60.0), folder)
    return folder


@pytest.fixture
def quick(monkeypatch):
    """Pages without pictures, where only files and messages are looked at."""
    monkeypatch.setattr("wirerope_mj.views.report.report_html", lambda _: "<!DOCTYPE html><title>quick</title><p>page</p>")


def test_the_command_writes_page_and_says_where(table, tmp_path, capsys, quick):
    out = tmp_path / "hand over" / "Deck 3.html"
    assert main(["report", str(table), "--out", str(out)]) == 2
    assert "there is no folder" in capsys.readouterr().err
    out.parent.mkdir()
    assert main(["report", str(table), "--out", str(out)]) == 0
    assert f"written: {out}" in capsys.readouterr().out
    assert [path.name for path in out.parent.iterdir()] == [out.name]


def test_the_folders_own_report_is_made_anew(table):
    before = (table / "report.html").read_bytes()
    assert write_report(table) == [table / "report.html"]
    assert (table / "report.html").read_bytes() == before


def test_a_file_that_is_there_is_replaced_only_with_force(table, tmp_path, capsys, quick):
    out = tmp_path / "mine.html"
    out.write_text("years of work", encoding="utf-8")
    assert main(["report", str(table), "--out", str(out)]) == 2
    assert "this exists already. Replace it with --force" in capsys.readouterr().err
    assert out.read_text(encoding="utf-8") == "years of work"
    assert main(["report", str(table), "--out", str(out), "--force"]) == 0
    assert "<!DOCTYPE html>" in out.read_text(encoding="utf-8")


def test_bad_input_is_one_message(table, tmp_path, capsys):
    damaged = Path(shutil.copytree(table, tmp_path / "damaged"))
    (damaged / "response.parquet").unlink()
    bare = tmp_path / "bare"
    bare.mkdir()
    curve = tmp_path / "curve"
    curve.mkdir()
    for name in ("settings.toml", "frequency_response.json"):
        (curve / name).write_text("", encoding="utf-8")
    for arguments, said in (
        ([str(tmp_path / "nothing")], "there is no such folder"),
        ([str(bare)], "this is not a run; there is no scenario.toml here"),
        ([str(damaged)], "there is no response.parquet here"),
        ([str(curve)], "this is a frequency response"),
        ([str(table), "--out", str(tmp_path / "report.pdf")], "`out` must end with .html"),
    ):
        assert main(["report", *arguments]) == 2
        error = capsys.readouterr().err
        assert said in error
        assert error.startswith("wirerope: ")
        assert "Traceback" not in error
    assert not [path for path in bare.iterdir()]


def test_a_failure_leaves_no_half_written_pdf(table, tmp_path, monkeypatch, quick):
    def fail(content, path):
        path.write_bytes(b"%PDF-1.7 half")
        raise ConvergenceError("no page.")

    monkeypatch.setattr("wirerope_mj.views.typesetting.load_typst", lambda: None)
    monkeypatch.setattr("wirerope_mj.views.document.write_pdf", fail)
    with pytest.raises(ConvergenceError):
        write_report(table, out=tmp_path / "page.html", pdf=True)
    (tmp_path / "page.html").unlink()  # whole, and written before
    assert list(tmp_path.iterdir()) == []


def test_without_typst_the_message_says_what_to_install(table, tmp_path, monkeypatch):
    monkeypatch.setitem(sys.modules, "typst", None)
    with pytest.raises(WireRopeError, match=r"pip install 'wirerope-mj\[pdf\]'"):
        write_report(table, out=tmp_path / "page.html", pdf=True)
    assert list(tmp_path.iterdir()) == []


def test_the_pdf_stands_beside_the_page(table, tmp_path, quick):
    pytest.importorskip("typst")
    files = write_report(table, out=tmp_path / "page.html", pdf=True)
    assert [path.name for path in files] == ["page.html", "page.pdf"]
    assert files[1].read_bytes().startswith(b"%PDF-")
    with pytest.raises(RecordError, match="page.html: this exists already"):
        write_report(table, out=tmp_path / "page.html", pdf=True)


def test_long_tables_repeat_their_heading_on_every_page(tmp_path):
    pytest.importorskip("typst")
    rows = tuple((f"m{place}", f"{place}") for place in range(200))
    long = Table(title="Mounts", columns=(Column("mount", align="left"), Column("headed")), rows=rows)
    section = Section("table", "Table", lambda: [long])
    content = Content(title="Long", question=("?",), verdict=Statement(), sections=(section,))
    write_pdf(content, tmp_path / "long.pdf")
    pages = pages_of(tmp_path / "long.pdf")
    assert len(pages) > 2
    assert all("headed" in page for page in pages)
    assert all(f"page {number} of {len(pages)}" in page for number, page in enumerate(pages, start=1))
