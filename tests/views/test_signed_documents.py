"""Reports on paper: nothing is folded away, and a document is complete, in PDF and DOCX alike."""

import re
import zipfile
from pathlib import Path

import numpy as np
import pytest
from shown import pages_of

from wirerope_mj.content.blocks import (
    Chart,
    Content,
    Curve,
    Document,
    Panel,
    Revision,
    Section,
    Statement,
    letter_of,
    with_appendices,
)
from wirerope_mj.foundation.errors import WireRopeError
from wirerope_mj.foundation.tables import Column, Table
from wirerope_mj.views.document import write_docx, write_pdf
from wirerope_mj.views.report import report_html

docx = pytest.importorskip("docx")
pypdf = pytest.importorskip("pypdf")

FILED = Document(
    project="F130", number="NV-7", revision="B", date="2026-11-25", author="A. Maker", checker="B. Second",
    approver="C. Third", classification="CONFIDENTIAL <B>", client="Yard & Sons", standard="Specification 3",
    history=(Revision(revision="A", change="First"), Revision(revision="B", change="Sweep added")),
)  # fmt: skip


def table(name, rows, shown=None):
    columns = (Column("mount", align="left"), Column("force", "kN"), Column("note", align="text"))
    cells = [(f"{name}{n}", 1000.0 * n, f"remark {n} of {name}") for n in range(rows)]
    return Table(id=name, title=f"Table {name}", columns=columns, rows=cells, shown=shown, note=f"Note of {name}.")


def content(document=FILED):
    time = np.linspace(0.0, 1.0, 50)
    panel = Panel(curves=[Curve(x=time, y=np.sin(6.0 * time), name="deck", kind=0)], ylabel="force [kN]")
    chart = Chart(rows=[[panel]], id="chart", caption="The force over time.", alt="Force over time.")
    return Content(
        title="Cabinet <4>",
        question=("Does it hold?",),
        verdict=Statement(id="headline", text="PASS: it holds.", tone="within"),
        facts=(("Model", "cabinet.xml"),),
        document=document,
        sections=(
            Section("answer", "", lambda: [Statement(text="In short", items=("first", "second"))]),
            Section("short", "Short", lambda: [table("s", 12, shown=3), chart]),
            Section("last", "Every verdict", lambda: [table("v", 9, shown=2)], appendix=True),
            Section("long", "Long", lambda: [table("l", 80, shown=4)]),
        ),
    )


@pytest.fixture
def written(tmp_path):
    write_docx(with_appendices(content()), tmp_path / "report.docx")
    return docx.Document(str(tmp_path / "report.docx"))


def rows_of(document):
    return [[cell.text for cell in row.cells] for one in document.tables for row in one.rows]


@pytest.mark.quick
def test_long_tables_begin_in_the_text_and_stand_whole_in_an_appendix():
    whole = with_appendices(content())
    short, long, cut, verdicts = (section.blocks[0] for section in whole.sections if section.title)
    assert [section.title for section in whole.sections if section.appendix] == ["Long: Table l", "Every verdict"]
    assert (len(short.rows), len(long.rows), len(cut.rows), len(verdicts.rows)) == (12, 4, 80, 9)
    assert all(one.shown is None for one in (short, long, cut, verdicts))
    assert long.note == "Note of l. 4 of 80 rows; all of them stand in appendix A."


def test_letters_go_on_after_z():
    assert [letter_of(number) for number in (0, 25, 26, 51, 52)] == ["A", "Z", "AA", "AZ", "BA"]


@pytest.mark.quick
def test_a_docx_holds_every_row_and_every_sentence(written):
    rows = rows_of(written)
    for name, count in (("s", 12), ("l", 80), ("v", 9)):
        for n in range(count):
            assert f"{name}{n}" in {row[0] for row in rows}
            assert f"remark {n} of {name}" in {row[-1] for row in rows}
    texts = [paragraph.text for paragraph in written.paragraphs]
    assert {"Does it hold?", "In short", "first", "The force over time.", "Note of s."} <= set(texts)
    assert texts.count("PASS: it holds.") == 1
    assert texts.index("PASS: it holds.") == texts.index("Cabinet <4>") + 1  # the answer is what is read first


def test_a_docx_has_title_block_signatures_history_and_numbered_pages(written):
    rows = rows_of(written)
    assert ["Document", "NV-7"] in rows
    assert ["Client", "Yard & Sons"] in rows
    assert ["Author", "A. Maker", "", ""] in rows
    assert ["Approved", "C. Third", "", ""] in rows
    assert ["B", "", "", "Sweep added"] in rows
    (section,) = written.sections
    assert section.header.paragraphs[0].text == "Cabinet <4>\tCONFIDENTIAL <B>"
    assert section.footer.paragraphs[0].text.startswith("NV-7 revision B\tpage ")
    assert re.findall(r'w:instr="(\w+)"', section.footer.paragraphs[0]._p.xml) == ["PAGE", "NUMPAGES"]
    headings = [one.text for one in written.paragraphs if one.style.name == "Heading 1"]
    assert headings == [
        "Question and answer",
        "1  Short",
        "2  Long",
        "Appendix A  Long: Table l",
        "Appendix B  Every verdict",
    ]


def test_a_chart_in_a_docx_is_a_picture_that_says_what_it_shows(tmp_path):
    write_docx(content(document=None), tmp_path / "report.docx")
    with zipfile.ZipFile(tmp_path / "report.docx") as parts:
        names = [name for name in parts.namelist() if name.startswith("word/media/")]
        assert len(names) == 1
        assert parts.read(names[0]).startswith(b"\x89PNG")
        assert 'descr="Force over time."' in parts.read("word/document.xml").decode()


def test_columns_fit_the_page_whatever_stands_in_them(tmp_path):
    wide = Table(
        title="Wide",
        columns=[Column(f"a long heading {n}", "kN") for n in range(13)] + [Column("note", align="text")],
        rows=[[1234.5] * 13 + ["words " * 60]],
    )
    section = Section("wide", "Wide", lambda: [wide])
    one = Content(title="Wide", question=("?",), verdict=Statement(), sections=(section,))
    write_docx(one, tmp_path / "wide.docx")
    document = docx.Document(str(tmp_path / "wide.docx"))
    widths = [int(width) for width in re.findall(r'<w:gridCol w:w="(\d+)"', document.tables[-1]._tbl.xml)]
    page = document.sections[0]
    assert sum(widths) <= (page.page_width - page.left_margin - page.right_margin) / 635 + 14  # rounding of each column


def test_without_python_docx_the_message_says_what_to_install(monkeypatch):
    monkeypatch.setitem(__import__("sys").modules, "docx", None)
    with pytest.raises(WireRopeError, match=r"pip install 'wirerope-mj\[docx\]'"):
        write_docx(content(), Path("nowhere.docx"))


def test_the_page_of_a_document_answers_first():
    page = report_html(with_appendices(content()))
    assert page.count("PASS: it holds.") == 1
    assert page.index("PASS: it holds.") < page.index("NV-7</dd>")
    assert "CONFIDENTIAL &lt;B&gt;" in page
    assert page.count("<tr>") >= 12 + 4 + 80 + 9


def test_a_pdf_holds_everything_and_says_on_every_page_who_it_is(tmp_path):
    pytest.importorskip("typst")
    write_pdf(with_appendices(content()), tmp_path / "report.pdf")
    pages = pages_of(tmp_path / "report.pdf")
    for number, text in enumerate(pages, start=1):
        assert f"page {number} of {len(pages)}" in text
        assert "NV-7 revision B" in text
        assert "CONFIDENTIAL <B>" in text
    first, whole = pages[0], " ".join(pages)
    assert first.index("PASS: it holds.") < first.index("Document: NV-7") < first.index("Author A. Maker")
    assert all(text in first for text in ("Client: Yard & Sons", "B Sweep added", "1 Short .", "Appendix B Every verdict ."))
    assert whole.count("PASS: it holds.") == 1
    for name, count in (("s", 12), ("l", 80), ("v", 9)):
        assert all(f"remark {n} of {name}" in whole for n in range(count))
    texts = ("Does it hold?", "In short", "The force over time.", "Note of s.", "force [kN]", "deck")
    assert all(text in whole for text in texts)
    marks = [" ".join(entry.title.split()) for entry in pypdf.PdfReader(tmp_path / "report.pdf").outline]
    assert marks == ["Question and answer", "1 Short", "2 Long", "Appendix A Long: Table l", "Appendix B Every verdict"]
