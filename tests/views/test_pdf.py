"""PDF documents: names are letters and never markup, tables stay on the page, and nothing of the system is needed."""

import subprocess
import sys
from dataclasses import replace

import numpy as np
import pytest
from shown import pages_of

from wirerope_mj.content.blocks import Chart, Content, Curve, Document, Panel, Section, Statement
from wirerope_mj.foundation.errors import WireRopeError
from wirerope_mj.foundation.tables import Column, Mark, Table, left
from wirerope_mj.views.document import write_pdf
from wirerope_mj.views.pictures import save_pictures

pytest.importorskip("typst")
pypdf = pytest.importorskip("pypdf")

NAME = r"""#panic $x^2$ *bold* _slanted_ back\slash "quoted" `raw` <x> @y = head // #{1+1} ]#[ ~"""


def chart(name):
    x = np.linspace(0.0, 1.0, 5)
    return Chart(rows=[[Panel(curves=[Curve(x=x, y=x, name=name, kind=0)], ylabel="travel [mm]")]], caption=name, alt=name)


def content(*blocks, document=None):
    section = Section("a", "A", lambda: blocks)
    return Content(title="One", question=("?",), verdict=Statement(text="PASS."), sections=(section,), document=document)


@pytest.mark.quick
@pytest.mark.parametrize("filed", [False, True])
def test_names_are_letters_wherever_they_stand(filed, tmp_path):
    cells = Table(NAME, NAME, left(NAME), [[NAME], [Mark(NAME, "exceeded")]], note=NAME)
    document = Document(number=NAME, author=NAME, classification=NAME, client=NAME) if filed else None
    full = replace(
        content(Statement(NAME, NAME, items=(NAME,), tone="unjudged"), cells, chart(NAME), document=document),
        title=NAME, question=(NAME, NAME), verdict=Statement(text=NAME), facts=((NAME, NAME),),
    )  # fmt: skip
    write_pdf(replace(full, sections=(replace(full.sections[0], title=NAME),)), tmp_path / "a.pdf")
    said = " ".join(pages_of(tmp_path / "a.pdf"))
    # Title, question twice, verdict, fact and name, section, statement, item, table, heading, two rows, note, chart, its curve.
    assert said.replace(" ", "").count(NAME.replace(" ", "")) >= 16
    assert pypdf.PdfReader(tmp_path / "a.pdf").metadata.title == NAME


def test_invisible_characters_are_spelled_out(tmp_path):
    write_pdf(content(Statement(text="a\x1b[31mb\u202ec")), tmp_path / "a.pdf")
    assert r"a\x1b[31mb\u202ec" in pages_of(tmp_path / "a.pdf")[0]


def test_the_same_content_makes_the_same_bytes(tmp_path):
    for name in ("a.pdf", "b.pdf"):
        write_pdf(content(chart("deck"), Table("t", "T", left("mount"), [["m1"]])), tmp_path / name)
        save_pictures([chart("deck")], tmp_path / f"picture_{name}")
    assert (tmp_path / "a.pdf").read_bytes() == (tmp_path / "b.pdf").read_bytes()
    assert pages_of(tmp_path / "picture_a.pdf")[0].startswith("deck 0 0.2 0.4")
    assert (tmp_path / "picture_a.pdf").read_bytes() == (tmp_path / "picture_b.pdf").read_bytes()


@pytest.mark.parametrize("columns", [3, 9, 16])
def test_tables_stay_on_the_page_whatever_stands_in_them(columns, tmp_path):
    long = "mount_" * 12
    heads = [Column(long, align="left"), *(Column(f"a long heading {n}", "kN", "z.1f") for n in range(columns))]
    row = [long, *[-1234567.8] * columns, "words " * 60]
    wide = Table("w", "Wide", [*heads, Column("note", align="text")], [row] * 3)
    write_pdf(content(wide), tmp_path / "a.pdf")
    starts = {}  # of texts on a line, from the left

    def look(text, drawn, *_):
        starts.setdefault((text.split() or [""])[0], []).append(drawn[4])

    pages = pypdf.PdfReader(tmp_path / "a.pdf").pages
    for page in pages:
        page.extract_text(visitor_text=look)
    numbers = starts["\N{MINUS SIGN}1234.6"]
    assert len(numbers) == 3 * columns  # none is broken
    assert max(starts["words"]) < pages[0].mediabox.width - 42.0  # a margin of 15 mm
    assert max(starts["_"]) < min(numbers)  # names end where the next column begins
    assert " ".join(pages_of(tmp_path / "a.pdf")).replace(" ", "").count(long) >= 4  # and are whole


def test_a_template_of_the_company_lays_the_document_out(tmp_path):
    ours = tmp_path / "ours.typ"
    ours.write_text(
        "#let report = json(bytes(sys.inputs.report))\nOur house: #report.title, #report.verdict.text\n"
        "#for section in report.sections [#section.number #section.title: #section.blocks.first().text]",
        encoding="utf-8",
    )
    filed = content(Statement(text="It holds."), document=Document(template=ours))
    write_pdf(filed, tmp_path / "a.pdf")
    assert pages_of(tmp_path / "a.pdf") == ["Our house: One, PASS. 1 A: It holds."]
    ours.write_text("#report.title", encoding="utf-8")
    with pytest.raises(WireRopeError, match=r"ours\.typ:1:1\): Typst cannot set this, unknown variable: report\."):
        write_pdf(filed, tmp_path / "a.pdf")


def test_neither_pango_nor_what_loads_libraries_is_needed(tmp_path):
    """In a process of its own, in which nothing can import what loads Pango."""
    code = (
        "import sys\n"
        "for name in ('cffi', '_cffi_backend', 'weasyprint', 'pydyf', 'gi', 'cairo'): sys.modules[name] = None\n"
        "from pathlib import Path\n"
        "from wirerope_mj.content.blocks import Content, Statement\n"
        "from wirerope_mj.views.document import write_pdf\n"
        "verdict = Statement(text='PASS without it.')\n"
        "write_pdf(Content(title='One', verdict=verdict, sections=()), Path(sys.argv[1]))\n"
        "maps = Path('/proc/self/maps')\n"
        "assert not maps.exists() or 'pango' not in maps.read_text()\n"
    )
    subprocess.run([sys.executable, "-c", code, str(tmp_path / "a.pdf")], check=True, timeout=120)
    assert "PASS without it." in pages_of(tmp_path / "a.pdf")[0]
