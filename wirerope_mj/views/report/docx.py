"""A content as a DOCX document: title block, numbered sections, tables, charts as pictures, appendices, page numbers."""

import tempfile
from functools import singledispatchmethod
from pathlib import Path
from typing import Any
from xml.sax.saxutils import escape

from wirerope_mj.content.appendices import letter_of
from wirerope_mj.content.blocks import Block, Content, SceneView, Section, Statement
from wirerope_mj.content.numbers import ABSENT, MINUS
from wirerope_mj.content.panels import Chart
from wirerope_mj.foundation.errors import WireRopeError
from wirerope_mj.foundation.plain_text import plain_lines
from wirerope_mj.foundation.tables import Column, Table
from wirerope_mj.views.plots.png_chart import save_charts
from wirerope_mj.views.plots.scene_plan import save_scenes

_COLOURS = {"within": "176B2F", "near": "7A5600", "unjudged": "7A5600", "exceeded": "B30000", "quiet": "56616F"}
_SHADES = {"within": "E9F6EC", "exceeded": "FCEBEA", "unjudged": "FDF5E1"}
_BOLD = ("exceeded", "strong")
_WIDTH = 17.4  # of the text [cm]
_PICTURE, _DRAWING = 15.6, 13.0  # widths of charts and scenes [cm]
_FONT, _SMALL = "Liberation Sans", 15  # of the text; of tables in half points
_MANY, _TINY = 10, 13  # columns from which on a table has smaller letters, in half points
_W = 'xmlns:w="http://schemas.openxmlformats.org/wordprocessingml/2006/main"'


def check_docx() -> None:
    """Raise WireRopeError unless DOCX files can be written here; for asking before anything long is computed."""
    try:
        import docx  # noqa: F401
    except ImportError:
        raise WireRopeError("a DOCX needs python-docx: pip install 'wirerope-mj[docx]'.") from None


def write_docx(content: Content, path: Path) -> None:
    """Write a content, of which nothing is folded, as a DOCX document.

    Raises:
        WireRopeError: python-docx is not installed.
    """
    check_docx()
    with tempfile.TemporaryDirectory() as folder:
        writer = _Writer(content, Path(folder))
        writer.document.save(str(path))


class _Writer:
    """A document of python-docx that grows block by block."""

    def __init__(self, content: Content, folder: Path) -> None:
        import docx

        self.document: Any = docx.Document()
        self._folder, self._pictures = folder, 0
        _set_page(self.document, content)
        self._title(content)
        self._contents(content)
        self._answer(content)
        numbered = [one for one in content.sections if one.title and one.blocks and not one.appendix]
        appendices = [one for one in content.sections if one.title and one.blocks and one.appendix]
        for number, section in enumerate(numbered, start=1):
            self._section(f"{number}  {section.title}", section)
        for number, section in enumerate(appendices):
            self._section(f"Appendix {letter_of(number)}  {section.title}", section, new_page=number == 0)

    def _title(self, content: Content) -> None:
        """Set title, answer, facts, and of a document its title block, signatures and revisions."""
        from docx.shared import Cm

        filed = content.document
        if filed is not None and filed.logo is not None:
            self.document.add_picture(str(filed.logo), height=Cm(1.6))
        self._paragraph("Shock and vibration report", tone="quiet")
        self.document.add_heading(plain_lines(content.title), level=0)
        self._verdict(content.verdict)
        facts = [*(filed.facts if filed else ()), *content.facts]
        self._table(Table(title="", columns=[Column(align="left"), Column(align="text")], rows=facts))
        if filed is not None:
            for table in (filed.signatures(), filed.revisions()):
                if table is not None:
                    self.set_block(table)

    def _contents(self, content: Content) -> None:
        """List the sections of a document."""
        if content.document is None:
            return
        self._paragraph("Contents", bold=True, keep=True)
        counts = {False: 0, True: 0}
        for section in content.sections:
            if section.title and section.blocks:
                number = counts[section.appendix]
                counts[section.appendix] += 1
                mark = f"Appendix {letter_of(number)}" if section.appendix else str(number + 1)
                self._paragraph(f"{mark}  {section.title}", close=True)
        self.document.add_page_break()

    def _answer(self, content: Content) -> None:
        self.document.add_heading("Question and answer", level=1)
        for text in content.question:
            self._paragraph(text, bold=True)
        self._verdict(content.verdict)
        for section in content.sections:
            if not section.title:
                for block in section.blocks:
                    self.set_block(block)

    def _section(self, title: str, section: Section, *, new_page: bool = False) -> None:
        heading = self.document.add_heading(plain_lines(title), level=1)
        heading.paragraph_format.page_break_before = new_page
        for block in section.blocks:
            self.set_block(block)

    def _verdict(self, verdict: Statement) -> None:
        paragraph = self._paragraph(verdict.text, tone=verdict.tone, bold=True)
        shade = _SHADES.get(verdict.tone, "F1F3F5")
        paragraph._p.get_or_add_pPr().append(_xml(f'<w:shd {_W} w:val="clear" w:color="auto" w:fill="{shade}"/>'))

    @singledispatchmethod
    def set_block(self, block: Block) -> None:
        """Set a block below the others."""
        raise TypeError(f"no block: {block!r}")

    @set_block.register
    def _(self, block: Statement) -> None:
        if block.text:
            self._paragraph(block.text, tone=block.tone, keep=bool(block.items))
        for item in block.items:
            self._paragraph(item, style="List Bullet", close=True)

    @set_block.register
    def _(self, block: Table) -> None:
        if block.title:
            self._paragraph(block.title, bold=True, keep=True)
        self._table(block)
        self._paragraph(block.note, tone="quiet", small=True)

    @set_block.register
    def _(self, block: Chart) -> None:
        save_charts([block], self._picture())
        self._place(_PICTURE, block.caption, block.alt)

    @set_block.register
    def _(self, block: SceneView) -> None:
        save_scenes([block], self._picture())
        self._place(_DRAWING, block.caption, block.caption)

    def _picture(self) -> Path:
        self._pictures += 1
        return self._folder / f"{self._pictures}.png"

    def _place(self, width: float, caption: str, alt: str) -> None:
        """Set the picture that was drawn last, with its caption below it."""
        from docx.shared import Cm

        shape = self.document.add_picture(str(self._folder / f"{self._pictures}.png"), width=Cm(width))
        shape._inline.docPr.set("descr", plain_lines(alt))
        self.document.paragraphs[-1].paragraph_format.keep_with_next = True
        self._paragraph(caption, tone="quiet", small=True)

    def _paragraph(
        self, text: str, *, tone: str = "", bold: bool = False, keep: bool = False, close: bool = False, small: bool = False,
        style: str | None = None,
    ) -> Any:  # fmt: skip
        from docx.shared import Pt, RGBColor

        paragraph = self.document.add_paragraph(style=style)
        run = paragraph.add_run(plain_lines(text))
        run.bold = bold or tone in _BOLD
        if small:
            run.font.size = Pt(8)
        if tone in _COLOURS:
            run.font.color.rgb = RGBColor.from_string(_COLOURS[tone])
        paragraph.paragraph_format.keep_with_next = keep
        if close:
            paragraph.paragraph_format.space_after = Pt(1)
        return paragraph

    def _table(self, table: Table) -> None:
        """Set a table as wide as its texts, whose header is repeated on every page; cell by cell it would take minutes."""
        heads = [column.title().replace("/\n", "/").replace("\n", " ") for column in table.columns]
        size = _TINY if len(heads) >= _MANY else _SMALL
        aligned = ["right" if column.align == "right" else "left" for column in table.columns]
        rows = [_row([(head, "strong") for head in heads], aligned, size, head=True)] if any(heads) else []
        rows += [_row(row, aligned, size) for row in table.marks(absent=ABSENT, minus=MINUS)]
        line = 'w:val="single" w:sz="4" w:space="0" w:color="CFD6DE"'
        borders = "".join(f"<w:{edge} {line}/>" for edge in ("top", "bottom", "insideH"))
        margins = '<w:left w:w="40" w:type="dxa"/><w:right w:w="80" w:type="dxa"/>'
        text = (
            f'<w:tbl {_W}><w:tblPr><w:tblW w:w="0" w:type="auto"/><w:tblBorders>{borders}</w:tblBorders>'
            f'<w:tblLayout w:type="autofit"/><w:tblCellMar>{margins}</w:tblCellMar></w:tblPr>'
            f"<w:tblGrid>{'<w:gridCol/>' * len(heads)}</w:tblGrid>{''.join(rows)}</w:tbl>"
        )
        self.document._body._body.insert_element_before(_xml(text), "w:sectPr")


def _row(cells: list[tuple[str, str]], aligned: list[str], size: int, *, head: bool = False) -> str:
    keep = "<w:keepNext/>" if head else ""
    texts = [
        f'<w:tc><w:tcPr/><w:p><w:pPr>{keep}<w:spacing w:before="10" w:after="10" w:line="240" w:lineRule="auto"/>'
        f'<w:jc w:val="{side}"/></w:pPr><w:r><w:rPr>{"<w:b/>" if tone in _BOLD else ""}'
        f'<w:color w:val="{_COLOURS.get(tone, "1C2430")}"/><w:sz w:val="{size}"/></w:rPr>'
        f'<w:t xml:space="preserve">{escape(plain_lines(text))}</w:t></w:r></w:p></w:tc>'
        for (text, tone), side in zip(cells, aligned, strict=True)
    ]
    return f"<w:tr><w:trPr><w:cantSplit/>{'<w:tblHeader/>' if head else ''}</w:trPr>{''.join(texts)}</w:tr>"


def _set_page(document: Any, content: Content) -> None:
    """Set paper, letters, what is said of the file, and what stands above and below every page."""
    from docx.enum.text import WD_TAB_ALIGNMENT
    from docx.shared import Cm, Pt

    section, filed = document.sections[0], content.document
    section.page_width, section.page_height = Cm(21.0), Cm(29.7)
    section.left_margin = section.right_margin = Cm((21.0 - _WIDTH) / 2.0)
    section.top_margin, section.bottom_margin = Cm(2.0), Cm(1.8)
    for name, size in (("Normal", 9.5), ("Heading 1", 14), ("Title", 20)):
        style = document.styles[name]
        style.font.name, style.font.size = _FONT, Pt(size)
        for kind in ("ascii", "hAnsi", "cs", "eastAsia"):
            style.element.get_or_add_rPr().get_or_add_rFonts().set(f"{{{_W[9:-1]}}}{kind}", _FONT)
    document.styles["Normal"].paragraph_format.space_after = Pt(4)
    said = document.core_properties
    said.title, said.author = plain_lines(content.title), plain_lines(filed.author) if filed else ""
    said.subject, said.comments = plain_lines(filed.reference) if filed else "", ""
    above = (content.title, filed.classification if filed else "")
    for place, (left, right) in ((section.header, above), (section.footer, (filed.reference if filed else "", None))):
        paragraph = place.paragraphs[0]
        paragraph.paragraph_format.tab_stops.clear_all()
        paragraph.paragraph_format.tab_stops.add_tab_stop(Cm(_WIDTH), WD_TAB_ALIGNMENT.RIGHT)
        paragraph.add_run(f"{plain_lines(left or '')}\t{plain_lines(right or '')}")
        if right is None:
            for text, field in (("page ", "PAGE"), (" of ", "NUMPAGES")):
                paragraph.add_run(text)
                paragraph._p.append(_xml(f'<w:fldSimple {_W} w:instr="{field}"><w:r><w:t>1</w:t></w:r></w:fldSimple>'))
        for run in paragraph.runs:
            run.font.size = Pt(8)


def _xml(text: str) -> Any:
    from docx.oxml import parse_xml

    return parse_xml(text)
