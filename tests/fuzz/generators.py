"""Inputs as slips of the hand and bad copies make them: numbers, words, nested values, phrases, bytes, tables."""

import datetime
import re
from collections.abc import Callable, Iterable
from dataclasses import dataclass, field
from typing import Any

import numpy as np

NUMBERS = (
    "nan", "inf", "-inf", "1e400", "-1e400", "1e-400", "-0", "0", "1e-308", "5e-324", "1e308", "-1e308", "-1", "9" * 30, "1e30",
    "1e-30", "1e-300", "9007199254740993", "1e9", "-1e9", "1e12", "1e-9", "1e-12", "1_0", "0x10", "1,5", "1e", ".", "+5", "5.",
    ".5", "0005", "1e5e5", "--5", "\u0661\u0662", "\uff11\uff15", "\u00bd", "", "10", "3", "12", "0.7", "20", "1", "2", "50",
    "4", "8", "0.3", "2.5e0", "1e6", "1e-6", "7e15", "12e3",
)  # fmt: skip
"""Numbers as they are written, or meant; in Arabic and in full-width digits, too."""

LARGE = ("1e9", "1e12", "1e6", "7e15", "12e3", "1e30")
"""Those of them that may ask for something large and possible."""

WORDS = (
    "", "x", "y", "z", "xyz", "-z", "+x", "xx", "1,1,0", "0,0,0", "nan,1,1", "1e400,0,1", "1,1", "at", "at 50 ms", "at -1 s",
    "at 1e300 s", "seed", "seed 3", "seed -1", "seed 0.5", "rise 2 ms", "fall", "damping", "damping 5 %", "damping 100 %",
    "blow", "order 2", "for 3 s", "to", "?", "? g", "g", "G", "Hz", "kHz", "hz", "ms", "m/s", "mm", "%", "oct/min", "kg.mm",
    "N.m", "5to50", "\u200b", "\x1b[31m", "\u00fc", "a" * 300, "None", "--", "-", ";", '"', "15 g", "11 ms", "3 Hz", "1 m/s",
    "1e3 s", "55 mm", "true", "a b", "a/b", "../..", "[1, 2]", "&amp;", "mount/", "mount/m1", "m1", "enidine_wr16_400", "#1",
    "<a>",
)  # fmt: skip
"""Words, units and names, most of them where they do not belong."""

VALUES: tuple[Any, ...] = (
    True, False, 0, 1, 2, 3, 7, -1, 0.0, -0.0, 0.5, 1.0, 2.5, -1.0, -5.0, 55.0, 1e3, 1e-12, 1e-300, 1e300, 10**18, 10**400,
    -(10**30), float("nan"), float("inf"), float("-inf"), "", "x", "z", "1.0", "nan", "15 g 11 ms z", "x" * 300, "../../other",
    "/etc/passwd", "\0", "report.html", [], [1.0], [1.0, 2.0], [[1.0]], ["a"], [float("nan")], [0.0, 0.0, 0.0], {}, {"x": 1.0},
)  # fmt: skip
"""Values of any type, as JSON and TOML hold them."""

TOML_VALUES = (*VALUES, datetime.date(2024, 1, 1), datetime.time(12))
PYTHON_VALUES = (*VALUES, None, (1, 2), b"z", 1e-308, 1e308)


def pick(rng: np.random.Generator, values: Any) -> Any:
    """Return one of `values`."""
    return values[int(rng.integers(len(values)))]


def finite(owner: object, names: Iterable[str], *arguments: Any) -> str | None:
    """Return a complaint if an attribute, or what a method returns for the arguments, is not finite."""
    for name in names:
        found = getattr(owner, name)
        if not np.isfinite(found(*arguments) if callable(found) else found).all():
            return f"{name} is not finite"
    return None


# Nested values


def edit(rng: np.random.Generator, holder: Any, key: Any, values: tuple[Any, ...] = TOML_VALUES) -> str:
    """Edit one value of a table or list in place and return what was done; a number is changed by a hundredth most often."""
    value, named = holder[key], isinstance(holder, dict)
    number = isinstance(value, float | int) and not isinstance(value, bool)
    kind = pick(
        rng, ["value", "value", "remove", "rename", "unknown", "swap", *["number"] * 6 * number, *["size"] * 2 * number]
    )
    if kind == "number":
        holder[key] = float(value * 1.01 if value else 1e-2) if isinstance(value, float) else value + 1
        tiny = ", tiny" if 0.0 < abs(value) < 1e-3 else ""  # perhaps rounding next to what it is compared with
        return f"number {value} -> {holder[key]}{tiny}"
    if kind == "size":
        holder[key] = value * pick(rng, (-1, 0, 1e3, 1e-3, 1e6, 1e-6, 1e12, 1e-12, 1e150, 10.0, 0.1))
    elif kind == "remove":
        del holder[key]
    elif kind == "rename" and named:
        holder[pick(rng, (f"{key}x", "", "\u00fcn\u00ef", "a.b", "law", "name", str(key).title()))] = holder.pop(key)
    elif kind == "unknown":
        holder.update({pick(rng, ("strange", "", "k", "note")): pick(rng, values)}) if named else holder.append(1.0)
    elif kind == "swap":
        other = pick(rng, list(holder)) if named else int(rng.integers(len(holder)))
        holder[key], holder[other] = holder[other], holder[key]
    else:
        holder[key] = pick(rng, values)
    after = holder.get(key, "") if named else ""
    return f"{kind} {str(value)[:30]} -> {str(after)[:30]}"


def place(rng: np.random.Generator, content: Any, first: Any = None) -> tuple[Any, Any, str]:
    """Return a table or list in nested values, a key of it, and the way there."""
    key = first if first is not None else pick(rng, list(content))
    where, holder = str(key), content
    while isinstance(holder[key], dict | list) and len(holder[key]) and rng.random() < 0.9:
        holder = holder[key]
        key = pick(rng, list(holder)) if isinstance(holder, dict) else int(rng.integers(len(holder)))
        where += f".{key}"
    return holder, key, where


def edited(rng: np.random.Generator, content: Any, first: Any = None, values: tuple[Any, ...] = TOML_VALUES) -> str:
    """Edit a value anywhere in nested values in place, and return where and what was done."""
    holder, key, where = place(rng, content, first)
    return f"{where}: {edit(rng, holder, key, values)}"


# Bytes


def damaged(rng: np.random.Generator, content: bytes) -> tuple[str, bytes]:
    """Return what happened to a file's bytes on their way, and what is left of them."""
    data, kinds = bytearray(content), []
    for _ in range(pick(rng, (1, 1, 2, 4))):
        if not data:
            break
        at, size = int(rng.integers(len(data))), int(rng.integers(1, 200))
        kind = pick(
            rng, ("cut off", "changed", "changed", "a bit", "lost", "inserted", "NUL", "doubled", "rubbish behind", "empty")
        )
        if kind == "changed":
            for here in rng.integers(len(data), size=pick(rng, (1, 30))):
                data[int(here)] = int(rng.integers(256))
        elif kind == "a bit":
            data[at] ^= 1 << int(rng.integers(8))
        elif kind in ("cut off", "lost"):
            del data[at : None if kind == "cut off" else at + size]
        elif kind in ("inserted", "NUL", "doubled"):
            data[at:at] = {"inserted": rng.bytes(size % 4 + 1), "NUL": bytes(16), "doubled": data[max(at - size, 0) : at]}[kind]
        elif kind == "rubbish":
            data += rng.bytes(100)
        elif rng.random() < 0.3:
            data.clear()
        kinds.append(kind)
    return f"bytes {', '.join(kinds)}", bytes(data)


# Phrases

_NUMBER = re.compile(r"(?<![\w./,])-?\d+(?:\.\d*)?(?:[eE][-+]?\d+)?(?![\w,]*[./]\w)(?!\w*,)")
"""A number that stands alone or before its unit: none of a vector, a name or a file."""


def muddled(rng: np.random.Generator, text: str) -> str:
    """Change one to three words of a phrase, most often a number."""
    words = text.split(" ")
    for _ in range(pick(rng, (1, 1, 1, 1, 2, 2, 3))):
        at, kind = int(rng.integers(len(words))), int(rng.integers(10))
        numbers = [i for i, word in enumerate(words) if any(c.isdigit() for c in word)]
        if kind <= 4 and numbers:
            at = pick(rng, numbers)
            words[at] = _NUMBER.sub(lambda _: pick(rng, NUMBERS), words[at], count=1)
        elif kind == 5:
            words.insert(at, pick(rng, WORDS))
        elif kind == 6 and len(words) > 1:
            del words[at]
        elif kind == 7:
            words[at] = pick(rng, WORDS)
        elif kind == 8:
            words.insert(at, pick(rng, words))
        elif kind == 9:
            words = [words[i] for i in rng.permutation(len(words))]
    return " ".join(words)


def ignored(text: str, answer: Callable[[str], Any]) -> str | None:
    """Return a complaint if a number of a phrase does nothing: another in its place is taken, and `answer(text)` is the same.

    Args:
        text: a phrase that is taken.
        answer: what is made of a phrase, as plain values; raises ValueError where it is refused.
    """
    before, same = answer(text), dict[str, bool]()
    for match in _NUMBER.finditer(text):
        value = float(match[0])
        for other in ("7",) if value == 0.0 else (f"{value * 1.25:.9g}", f"{value + 1:.9g}"):
            try:
                equal = answer(f"{text[: match.start()]}{other}{text[match.end() :]}") == before
            except Exception:  # refused, or else a case of its own
                equal = False
            same[match[0]] = same.get(match[0], True) and equal
    silent = [number for number, unchanged in same.items() if unchanged]
    return f"{silent[0]} does nothing" if silent else None


# Tables of numbers as CSV files

CELLS = (
    *NUMBERS[:-18], "NaN", " ", "high", "1e20", "0x1f", "1.2.3", "12 mm", "=A1", "#REF!", "+", "TRUE", '"', '"1"', "1;5",
    "1\t5", "[g]", "\0", "9" * 400,
)  # fmt: skip
"""Cells that are no measured number, or none that anybody meant."""

UNUSABLE = {"inf", "-inf", "1e308", "-1e308", "1e400", "-1e400", "9" * 400}
"""Those that Python takes for numbers, and that must be refused in a column that is read."""


@dataclass
class Table:
    """A CSV file before it is written: names with units, cells as text, lines before them, and how they are separated."""

    header: list[str]
    rows: list[list[str]]
    sign: str = ","
    before: list[str] = field(default_factory=list)
    end: str = "\n"
    encoding: str = "utf-8"

    @classmethod
    def of(cls, names: list[str], columns: list[np.ndarray]) -> "Table":
        """Return numbers as a table with eight digits."""
        return cls(names, [[f"{value:.8g}" for value in row] for row in np.column_stack(columns)])

    def text(self) -> str:
        """Return the file's text."""
        lines = [*self.before, self.sign.join(self.header), *(self.sign.join(row) for row in self.rows)]
        return self.end.join(lines) + self.end

    def content(self) -> bytes:
        """Return the file's bytes."""
        return self.text().encode(self.encoding, errors="replace")


def spoiled(rng: np.random.Generator, table: Table) -> tuple[str, bool | None]:
    """Change a table as happens on the way from a rig; return how, and whether it is valid still: None where that is open."""
    kind = pick(rng, list(DAMAGE))
    before, row, column = table.text(), int(rng.integers(len(table.rows))), int(rng.integers(len(table.header)))
    valid = DAMAGE[kind](rng, table, row, column)
    return kind, True if valid is None and table.text() == before and table.encoding == "utf-8" else valid


def _commas(table: Table, rows: Iterable[int], columns: Iterable[int]) -> None:
    for row in rows:
        for column in columns:
            table.rows[row][column] = table.rows[row][column].replace(".", ",")


def _decimal_commas(rng: np.random.Generator, t: Table, row: int, column: int) -> bool | None:
    """Of all, a row or a column; behind semicolons nobody can tell more than the reader."""
    before, which = t.text(), pick(rng, ("all", "row", "column"))
    rows = [row] if which == "row" else range(len(t.rows))
    _commas(t, rows, [column] if which == "column" else range(len(t.header)))
    if which == "all" and rng.random() < 0.5:
        t.sign = ";"
        return None
    return t.text() == before


def _cells(rng: np.random.Generator, t: Table, row: int, column: int) -> bool | None:
    """One cell too many or too few, in a row or in all."""
    for cells in t.rows if rng.random() < 0.5 else [t.rows[row]]:
        cells.insert(column, pick(rng, ("", "1", "0.5", "x"))) if rng.random() < 0.5 else cells.pop(column)
    return False


def _separators(rng: np.random.Generator, t: Table, row: int, column: int) -> bool | None:
    """Semicolons or tabs, as the header has them or not."""
    sign = pick(rng, ";\t|")
    if sign != "|" and rng.random() < 0.5:
        t.sign = sign
        return True
    t.rows = [[sign.join(cells)] for cells in t.rows]
    return False


def _units(rng: np.random.Generator, t: Table, row: int, column: int) -> bool | None:
    """None, unknown ones, or those of another quantity."""
    unit = pick(rng, (None, "V", "", " ", "parsec", "]", "[", "kg", "m/s^3", "%"))
    t.header = [name.partition(" [")[0] + (f" [{unit}]" if unit is not None else "") for name in t.header]
    return False


def _header(rng: np.random.Generator, t: Table, row: int, column: int) -> bool | None:
    """Missing, there twice, with one name twice, or with nonsense."""
    kind = int(rng.integers(4))
    if kind == 0:
        t.header = t.rows.pop(0)
    elif kind == 1:
        t.rows.insert(row, list(t.header))
    elif kind == 2:
        t.header[-1] = t.header[-2]
    else:
        t.header[column] = pick(rng, ("", "[", "]", "[]", "x [g", "\ufffd", "time", "x" * 5000, "a]b[c"))
    return False if kind < 2 else None


def _columns(rng: np.random.Generator, t: Table, row: int, column: int) -> bool | None:
    """In another order, or one of them twice."""
    order = rng.permutation(len(t.header)) if rng.random() < 0.5 else [*range(len(t.header)), column]
    t.header, t.rows = [t.header[i] for i in order], [[cells[i] for i in order] for cells in t.rows]
    return None


def _strange(rng: np.random.Generator, t: Table, row: int, column: int) -> bool | None:
    """A cell that is no number, or a column of one value."""
    cell, whole = pick(rng, (*CELLS, "0", "7")), rng.random() < 0.3
    for cells in t.rows if whole else [t.rows[row]]:
        cells[column] = cell
    return False if cell in UNUSABLE and not whole else None


def _rows(rng: np.random.Generator, t: Table, row: int, column: int) -> bool | None:
    """Twice, lost, shuffled, the last first, or hardly any."""
    kind, count = int(rng.integers(5)), int(rng.integers(4))
    if kind == 0:
        t.rows.insert(row, list(t.rows[row]))
    elif kind == 1:
        del t.rows[1 + row // 2 : 1 + row // 2 + int(rng.integers(1, 20))]
    elif kind == 4:
        t.rows = t.rows[:count]
        return False if count < 2 else None
    else:
        t.rows = [t.rows[i] for i in rng.permutation(len(t.rows))] if kind == 2 else t.rows[::-1]
    return None


def _dress(rng: np.random.Generator, t: Table, row: int, column: int) -> bool | None:
    """Comments, empty lines, ends of lines and encodings of other systems."""
    if rng.random() < 0.5:
        t.before, t.end = ["# rig 3, \u00b5-sensor", "", "#"], pick(rng, ("\n", "\r\n", "\n\n", "\r"))
        return True
    t.encoding = pick(rng, ("utf-8-sig", "utf-16", "utf-16-le", "utf-32", "latin-1"))
    return True if t.encoding in ("utf-8-sig", "latin-1") else None


DAMAGE: dict[str, Callable[[np.random.Generator, Table, int, int], bool | None]] = {
    "decimal commas": _decimal_commas, "cells": _cells, "separators": _separators, "units": _units, "header": _header,
    "columns": _columns, "strange": _strange, "rows": _rows, "dress": _dress,
}  # fmt: skip
