"""Reads tables back from where they are shown: the cells of a page, the rows that a terminal printed."""

import html
import io
import re
from contextlib import redirect_stdout

import pytest

from wirerope_mj.cli import main
from wirerope_mj.content.numbers import ABSENT, MINUS


def printed_by(*arguments):
    """Return what a command prints that must end well, on 200 columns."""
    with pytest.MonkeyPatch.context() as patch, redirect_stdout(io.StringIO()) as printed:
        patch.setenv("COLUMNS", "200")
        assert main(list(arguments)) == 0
    return printed.getvalue()


def cells_of(page, name):
    """Return the texts of the cells of a table on a page, row by row, those that are folded away too."""
    (table,) = re.findall(rf'<div class="table[^"]*" data-id="{re.escape(name)}">(.*?)</div>\s*(?=<|$)', page, re.S)[:1]
    rows = [row for row in re.split(r"<tr[^>]*>", table) if "<td" in row and "<th " not in row]
    return [[html.unescape(re.sub("<[^>]*>", "", c)) for c in re.findall(r"<td[^>]*>(.*?)</td>", r, re.S)] for r in rows]


def cells_to_show(table):
    """Return the texts of the cells that a page should hold, row by row."""
    return [[text for text, _ in row] for row in table.marks(absent=ABSENT, minus=MINUS)]


def missing_rows(printed, table):
    """Return the rows of a table that a terminal did not print, of those that it shows."""
    lines = [re.sub("[█▏▎▍▌▋▊▉│]", " ", line).split() for line in printed.splitlines()]
    units = [" %" if column.bar else "" for column in table.columns]
    return [
        row
        for row in table.marks()[: table.shown]
        if " ".join(text + unit for (text, _), unit in zip(row, units, strict=True)).split() not in lines
    ]


def pages_of(path):
    """Return the texts of the pages of a PDF, those of the margins among them, with single spaces."""
    pypdf = pytest.importorskip("pypdf")
    return [" ".join(page.extract_text().split()) for page in pypdf.PdfReader(path).pages]
