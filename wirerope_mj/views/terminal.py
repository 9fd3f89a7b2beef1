"""The terminal: statements and tables on a console on which control characters and emoji codes in texts are harmless."""

import re
from collections.abc import Iterable, Sequence
from functools import singledispatch
from textwrap import wrap
from typing import Any

from rich import box
from rich.cells import cell_len
from rich.console import Console
from rich.measure import Measurement
from rich.padding import Padding
from rich.table import Table as RichTable
from rich.text import Text

from wirerope_mj.content.blocks import Block, Content, Statement
from wirerope_mj.foundation.plain_text import plain_lines
from wirerope_mj.foundation.tables import Table, bar_text

WIDTH = 120  # Width of tables where there is no terminal to fit them into [characters]
_EIGHTHS = " ▏▎▍▌▋▊▉"  # of a cell of a bar
_NARROW = 72  # characters below which bars are shortest
_ROOMY = 100  # characters below which columns have no padding
_UNBOUNDED = 10_000  # characters of a line that holds every table
_LONG = 16  # characters of a heading above numbers that stands on several lines
_BEFORE_UNIT = re.compile(r"(?<=\d) (?=[%°a-zA-Zµ])")
_STYLES = {"exceeded": "bold red", "near": "yellow", "quiet": "dim", "strong": "bold", "unjudged": "yellow", "within": "green"}


class _Screen(Console):
    """A console on which control characters, markup and emoji codes in texts are made harmless."""

    def render_str(self, text: str, **options: Any) -> Text:
        return super().render_str(plain_lines(text), **options)

    def on_broken_pipe(self) -> None:
        raise BrokenPipeError


def console() -> Console:
    """Make the console for tables: as wide as the terminal, or as `WIDTH`."""
    screen = _Screen(highlight=False, emoji=False)
    return screen if screen.is_terminal else _Screen(highlight=False, emoji=False, width=WIDTH)


def show(content: Content, *sections: str) -> None:
    """Print a content with its title, or only the sections of the given ids."""
    if not sections:
        console().print(Text(plain_lines(content.title), style="bold"), soft_wrap=True)
    for section in content.sections:
        if not sections or section.id in sections:
            for block in section.blocks:
                print_block(block)


@singledispatch
def print_block(block: Block) -> None:
    """Print a block; charts and scenes are left out."""


@print_block.register
def _(block: Statement) -> None:
    if block.text:
        print_lines([Text(plain_lines(block.text), style=_STYLES.get(block.tone, ""))])
    print_lines(block.items, indent="    " if block.text else "  ")


@print_block.register
def _(block: Table) -> None:
    print()
    print_table(block)


def print_headline(statement: Statement) -> None:
    print()
    print_lines([Text(plain_lines(statement.text), style=f"bold {_STYLES.get(statement.tone, '')}".strip())])


def show_result(content: Content, *brief: str, others: Iterable[str], every: bool) -> None:
    """Print a verdict and the sections `brief`, its grounds; before them, if `every` table is wanted, the sections `others`."""
    for section in others if every else ():
        show(content, section)
    print_headline(content.verdict)
    for section in brief:
        show(content, section)


def print_table(table: Table) -> None:
    """Print a table; columns that do not fit a line follow below, beside the first column again."""
    screen = console()
    if table.title:
        print_lines([Text(plain_lines(table.title), style="bold")], indent="")
    rows = table.marks()[: table.shown]
    left = [*range(1, len(table.columns))]
    while True:
        count, unbounded = len(left), screen.options.update_width(_UNBOUNDED)
        shown = _rich_table(screen, table, rows, [0, *left])
        while count > 1 and Measurement.get(screen, unbounded, shown).minimum > screen.width:  # of what cuts no word
            count -= 1
            shown = _rich_table(screen, table, rows, [0, *left[:count]])
        screen.print(shown)
        left = left[count:]
        if not left:
            break
        print()
    if len(rows) < len(table.rows) and not any(column.bar for column in table.columns):
        print_lines([f"{len(rows)} of {len(table.rows)} rows"])
    if table.note:
        print_lines([table.note])


def _rich_table(screen: Console, table: Table, rows: Sequence[Sequence[tuple[str, str]]], chosen: Sequence[int]) -> RichTable:
    """Build the table of rich from some columns, at their full width where texts must not break; bars have no headings."""
    drawn = any(column.bar for column in table.columns)
    shown = RichTable(box=None if drawn else box.SIMPLE_HEAD, show_edge=False, show_header=not drawn)
    shown.padding = (0, 1, 0, 2 if drawn else 0) if screen.width >= _ROOMY else (0, 1, 0, 0) if drawn else 0
    cells = 20 if screen.width >= _ROOMY else 10 if screen.width >= _NARROW else 5
    columns: list[list[Text]] = []
    for index in chosen:
        column = table.columns[index]
        title, right = column.title("\n"), column.align == "right"
        whole = column.align == "left" or (right and max(map(len, column.heading.split("\n"))) <= _LONG)
        texts = [_text(*row[index]) for row in rows]
        if column.bar:
            longest = max(4, *(len(text.plain) for text in texts)) if texts else 4
            bars = [bar_text(table.value(row, index) or 0.0, cells, " ", _EIGHTHS) for row in range(len(rows))]
            texts = [Text(f"{bar}{text.plain:>{longest}} %", style=text.style) for bar, text in zip(bars, texts, strict=True)]
        lines = [*([] if drawn else title.split("\n")), *(text.plain for text in texts)]
        shown.add_column(
            _text(title), justify="right" if right else "left", no_wrap=whole, overflow="fold",
            min_width=max(map(cell_len, lines)) if whole else None,  # rich would take that of the longest word
        )  # fmt: skip
        columns.append(texts)
    for row_texts in zip(*columns, strict=True):
        shown.add_row(*row_texts)
    return shown


def print_lines(lines: Iterable[str | Text], indent: str = "  ") -> None:
    screen = console()
    for line in lines:
        text = line if isinstance(line, Text) else Text(plain_lines(line))
        if screen.is_terminal:
            screen.print(Padding(in_lines(text, screen.width - len(indent)), (0, 0, 0, len(indent))))
        else:
            screen.print(Text(indent) + text, soft_wrap=True)


def in_lines(text: Text, width: int) -> Text:
    """Break a text into lines of at most `width` characters between its words, never between a number and its unit."""
    if cell_len(text.plain) != len(text.plain):  # wide letters, which rich counts
        return text
    lines = wrap(_BEFORE_UNIT.sub("\N{NO-BREAK SPACE}", text.plain), width, break_on_hyphens=False)
    return Text("\n".join(lines).replace("\N{NO-BREAK SPACE}", " "), style=text.style)


def print_warnings(warnings: Iterable[str]) -> None:
    print_lines([Text(f"warning: {plain_lines(warning)}", style="yellow") for warning in warnings], indent="")


def _text(text: str, tone: str = "") -> Text:
    return Text(plain_lines(text), style=_STYLES.get(tone, ""))
