"""A content as a DOCX document: title block, numbered sections, tables, charts as pictures, appendices, page numbers."""

import tempfile
from collections.abc import Sequence
from dataclasses import replace
from functools import singledispatchmethod
from pathlib import Path
from typing import Any
from xml.sax.saxutils import escape

from wirerope_mj.content.blocks import Block, Chart, Content, SceneView, Statement
from wirerope_mj.content.numbers import ABSENT, MINUS
from wirerope_mj.foundation.errors import WireRopeError
from wirerope_mj.foundation.plain_text import plain_lines
from wirerope_mj.foundation.tables import Column, Table, left
from wirerope_mj.views.colours import LIGHT
from wirerope_mj.views.pictures import save_pictures

_OF = {name: colour.lstrip("#").upper() for name, colour in LIGHT.named.items()}
_COLOURS = {tone: _OF[tone] for tone in ("within", "unjudged", "exceeded", "quiet")} | {"near": _OF["unjudged"]}
_TEXT = _OF["text"]
_SHADES = {tone: _OF[f"{tone}-box"] for tone in ("within", "unjudged", "exceeded")} | {"near": _OF["unjudged-box"]}
_BOLD = ("exceeded", "strong")
_WIDTH = 17.4  # of the text [cm]
_PICTURE = 16.2  # width of charts and scenes [cm]
_FONT, _SMALL = "Arial", 15  # of the text; size of the letters of tables in half points
_LETTER, _CELL = 5.3, 130.0  # mean width of a letter, of half a point of its size; room about it [1/20 pt]
_LEAST, _LINE = 6, 90  # letters of a column of text at the least, and at the most where there is room
_TWIPS = 567.0  # 1/20 pt to a centimetre
_BLOCK = 0.5  # by which letters of bars are wider than others
BARS = 16  # letters of a bar up to its limit, whole ones, which every font has
_BOTTOM = '<w:vAlign w:val="bottom"/>'
_W = 'xmlns:w="http://schemas.openxmlformats.org/wordprocessingml/2006/main"'


def check_docx() -> None:
    """Raise WireRopeError unless DOCX files can be written here."""
    try:
        import docx  # noqa: F401
    except ModuleNotFoundError:
        raise WireRopeError("a DOCX needs python-docx: pip install 'wirerope-mj[docx]'.") from None


def write_docx(content: Content, path: Path) -> None:
    """Write the content of a report, its folded parts opened, as a DOCX document; WireRopeError without python-docx."""
    check_docx()
    with tempfile.TemporaryDirectory() as folder:
        writer = _Writer(content, Path(folder))
        writer.document.save(str(path))


class _Writer:
    """A document of python-docx that grows block by block."""

    def __init__(self, content: Content, folder: Path) -> None:
        import docx
        from docx.shared import Cm

        self.document: Any = docx.Document()
        self._folder, self._pictures = folder, 0
        _set_page(self.document, content)
        filed = content.document
        if filed is not None and filed.logo is not None:
            self.document.add_picture(str(filed.logo), height=Cm(1.6))
        self._paragraph("Shock and vibration report", tone="quiet")
        self.document.add_heading(plain_lines(content.title), level=0)
        paragraph = self._paragraph(content.verdict.text, tone=content.verdict.tone, bold=True)
        shade = _SHADES.get(content.verdict.tone, _OF["box"])
        paragraph._p.get_or_add_pPr().append(_xml(f'<w:shd {_W} w:val="clear" w:color="auto" w:fill="{shade}"/>'))
        facts = [*(filed.facts if filed else ()), *content.facts]
        self._table(Table("", "", [*left(""), Column(align="text")], facts))
        for table in (filed.signatures(), filed.revisions()) if filed is not None else ():
            if table is not None:
                self.set_block(table)
        titles = [f"{number}  {section.title}" for number, section in content.numbered]
        appendices = [section for _, section in content.numbered if section.appendix]
        self.document.add_heading("Question and answer", level=1)
        for text in content.question:
            self._paragraph(text, bold=True)
        for section in content.sections:
            for block in section.blocks if not section.title else ():
                self.set_block(block)
        if filed is not None:
            self._paragraph("Contents", bold=True, keep=True)
            for title in titles:
                self._paragraph(title, close=True)
        for title, (_, section) in zip(titles, content.numbered, strict=True):
            heading = self.document.add_heading(plain_lines(title), level=1)
            heading.paragraph_format.page_break_before = section in appendices[:1]
            for block in section.blocks:
                self.set_block(block)

    @singledispatchmethod
    def set_block(self, block: Block) -> None:
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
        self._paragraph(block.note, tone="quiet", small=True)  # also without a note: tables must not touch

    @set_block.register
    def _(self, block: Chart) -> None:
        save_pictures([block], self._picture())
        self._place(block.caption, block.alt)

    @set_block.register
    def _(self, block: SceneView) -> None:
        save_pictures([replace(block, caption="")], self._picture())
        self._place(block.caption, block.caption)

    def _picture(self) -> Path:
        self._pictures += 1
        return self._folder / f"{self._pictures}.png"

    def _place(self, caption: str, alt: str) -> None:
        """Add the picture that was drawn last, with its caption and a text alternative."""
        from docx.shared import Cm

        shape = self.document.add_picture(str(self._folder / f"{self._pictures}.png"), width=Cm(_PICTURE))
        shape._inline.docPr.set("descr", plain_lines(alt))
        self.document.paragraphs[-1].paragraph_format.keep_with_next = True
        self._paragraph(caption, tone="quiet", small=True)

    def _paragraph(
        self, text: str, *, tone: str = "", bold: bool = False, keep: bool = False, close: bool = False, small: bool = False,
        style: str | None = None,
    ) -> Any:  # fmt: skip
        """Add a paragraph in the colour of a tone; `keep` puts it on the next one's page, `close` leaves little space below."""
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
        """Set a table as wide as its texts, with a repeated header; cell by cell it would take minutes."""
        heads = [column.line() for column in table.columns]
        body = table.marks(absent=ABSENT, minus=MINUS, bars=BARS)
        size, widths = _widths(table.columns, heads, [[text for text, _ in row] for row in body])
        aligned = ["right" if column.align == "right" else "left" for column in table.columns]
        rows = [_row([(head, "strong") for head in heads], aligned, widths, size, head=True)] if any(heads) else []
        rows += [_row(row, aligned, widths, size) for row in body]
        line = 'w:val="single" w:sz="4" w:space="0" w:color="CFD6DE"'
        borders = "".join(f"<w:{edge} {line}/>" for edge in ("top", "bottom", "insideH"))
        margins = '<w:left w:w="20" w:type="dxa"/><w:right w:w="80" w:type="dxa"/>'
        grid = "".join(f'<w:gridCol w:w="{width}"/>' for width in widths)
        text = (
            f'<w:tbl {_W}><w:tblPr><w:tblW w:w="{sum(widths)}" w:type="dxa"/><w:tblBorders>{borders}</w:tblBorders>'
            f'<w:tblLayout w:type="fixed"/><w:tblCellMar>{margins}</w:tblCellMar></w:tblPr>'
            f"<w:tblGrid>{grid}</w:tblGrid>{''.join(rows)}</w:tbl>"
        )
        self.document._body._body.insert_element_before(_xml(text), "w:sectPr")


def _widths(columns: Sequence[Column], heads: list[str], rows: list[list[str]]) -> tuple[int, list[int]]:
    """Fit columns to the page: size of letters, and widths [1/20 pt]; text breaks into lines before letters get smaller."""
    words = [1.3 * max(map(len, head.split()), default=0) for head in heads]  # which are bold
    longest = [
        max([word, *(len(row[n]) + _BLOCK * sum(map(row[n].count, "█░")) for row in rows)]) for n, word in enumerate(words)
    ]
    breaks = [column.align == "text" or long > _LINE / 3 for column, long in zip(columns, longest, strict=True)]
    letters = [float(min(long, _LINE) if broken else long) for long, broken in zip(longest, breaks, strict=True)]
    for size in range(_SMALL, 9, -1):
        letter = _LETTER * size
        room = (_WIDTH * _TWIPS - _CELL * len(columns)) / letter
        over = sum(letters) - room
        slack = [max(count - _LEAST - word, 0.0) if b else 0.0 for count, word, b in zip(letters, words, breaks, strict=True)]
        if over <= 0.0 or over <= sum(slack):
            part = max(over, 0.0) / (sum(slack) or 1.0)
            return size, [round(letter * (count - part * less) + _CELL) for count, less in zip(letters, slack, strict=True)]
    scale = room / sum(letters)
    return size, [round(letter * scale * count + _CELL) for count in letters]


def _row(cells: list[tuple[str, str]], aligned: list[str], widths: list[int], size: int, *, head: bool = False) -> str:
    """Write a table row of cells (text, tone) as XML."""
    keep = "<w:keepNext/>" if head else ""
    texts = [
        f'<w:tc><w:tcPr><w:tcW w:w="{width}" w:type="dxa"/>{_BOTTOM if head else ""}</w:tcPr><w:p><w:pPr>{keep}'
        f'<w:spacing w:before="10" w:after="10" w:line="240" w:lineRule="auto"/><w:jc w:val="{side}"/></w:pPr>'
        f'<w:r><w:rPr>{"<w:b/>" if tone in _BOLD and "█" not in text else ""}<w:color w:val="{_COLOURS.get(tone, _TEXT)}"/>'
        f'<w:sz w:val="{size}"/></w:rPr><w:t xml:space="preserve">{escape(plain_lines(text))}</w:t></w:r></w:p></w:tc>'
        for (text, tone), side, width in zip(cells, aligned, widths, strict=True)
    ]
    return f"<w:tr><w:trPr><w:cantSplit/>{'<w:tblHeader/>' if head else ''}</w:trPr>{''.join(texts)}</w:tr>"


def _set_page(document: Any, content: Content) -> None:
    """Set size, margins, fonts, properties, header and footer of the document."""
    from docx.enum.text import WD_TAB_ALIGNMENT
    from docx.shared import Cm, Pt

    section, filed = document.sections[0], content.document
    section.page_width, section.page_height = Cm(21.0), Cm(29.7)
    section.left_margin = section.right_margin = Cm((21.0 - _WIDTH) / 2.0)
    section.top_margin, section.bottom_margin = Cm(2.0), Cm(1.8)
    for name, size in (("Normal", 9.5), ("Heading 1", 14), ("Title", 20)):
        style = document.styles[name]
        style.font.name, style.font.size = _FONT, Pt(size)
        fonts = style.element.get_or_add_rPr().get_or_add_rFonts()
        for name_of in list(fonts.attrib):  # those of a theme go before a name
            del fonts.attrib[name_of]
        for kind in ("ascii", "hAnsi", "cs"):  # East Asian letters in the font that the reader's program has for them
            fonts.set(f"{{{_W[9:-1]}}}{kind}", _FONT)
    document.styles["Normal"].paragraph_format.space_after = Pt(4)
    properties = document.core_properties
    properties.title, properties.author = plain_lines(content.title), plain_lines(filed.author) if filed else ""
    properties.subject, properties.comments = plain_lines(filed.reference) if filed else "", ""
    above = (content.title, filed.classification if filed else "")
    for place, (begin, end) in ((section.header, above), (section.footer, (filed.reference if filed else "", None))):
        paragraph = place.paragraphs[0]
        paragraph.style.paragraph_format.tab_stops.clear_all()
        paragraph.paragraph_format.tab_stops.add_tab_stop(Cm(_WIDTH), WD_TAB_ALIGNMENT.RIGHT)
        paragraph.add_run(f"{plain_lines(begin or '')}\t{plain_lines(end or '')}")
        if end is None:
            for text, field in (("page ", "PAGE"), (" of ", "NUMPAGES")):
                paragraph.add_run(text)
                paragraph._p.append(_xml(f'<w:fldSimple {_W} w:instr="{field}"><w:r><w:t>1</w:t></w:r></w:fldSimple>'))
        for run in paragraph.runs:
            run.font.size = Pt(8)


def _xml(text: str) -> Any:
    from docx.oxml import parse_xml

    return parse_xml(text)
