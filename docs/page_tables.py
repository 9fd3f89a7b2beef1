"""Write the numbers of a page's tables anew from the page's own script.

python docs/page_tables.py docs/cabinet.md

The script of the page ends with `tables`: for every table of the page, in order, its rows of numbers. A number is printed
with as many decimals as the cell has now, and with a sign if it has one; cells with words stay.
"""

import re
import sys
from collections.abc import Sequence
from pathlib import Path
from typing import Any

Tables = Sequence[Sequence[Sequence[float]]]

_NUMBER = re.compile(r"[+-]?\d+(\.\d+)?")
_RULE = re.compile(r"\|[-:|]+\|")


def computed(text: str) -> dict[str, Any]:
    """Return the names that the Python blocks of a page leave behind."""
    names: dict[str, Any] = {}
    exec("\n".join(re.findall(r"```python\n(.*?)```", text, flags=re.DOTALL)), names)
    return names


def rewritten(text: str, tables: Tables) -> str:
    """Return the page with the numbers of `tables` in the cells of its tables.

    Raises:
        ValueError: the page has other tables, rows or numbers than `tables`.
    """
    lines, rest = text.split("\n"), [list(table) for table in tables]
    at = -1
    for number, (line, after) in enumerate(zip(lines, [*lines[1:], ""], strict=True)):
        if _RULE.fullmatch(line):
            at += 1
        elif line.startswith("|") and not _RULE.fullmatch(after):
            if at >= len(rest) or not rest[at]:
                raise ValueError(f"no computed row is left for line {number + 1}: {line}")
            lines[number] = _row(line, rest[at].pop(0))
    if at + 1 != len(rest) or any(rest):
        raise ValueError(f"the page has {at + 1} tables, {len(rest)} were computed; rows left over: {rest}.")
    return "\n".join(lines)


def _row(line: str, values: Sequence[float]) -> str:
    """Return a table's line with its numbers replaced."""
    cells, left = line.split("|"), list(values)
    for place, cell in enumerate(cells):
        word = cell.strip()
        if _NUMBER.fullmatch(word):
            if not left:
                raise ValueError(f"fewer numbers were computed than stand in: {line}")
            sign = "+" if word[0] in "+-" else ""
            decimals = len(word.partition(".")[2])
            cells[place] = f" {round(left.pop(0), decimals) + 0.0:{sign}.{decimals}f} "  # + 0.0: no minus before zero
    if left:
        raise ValueError(f"{len(left)} more numbers were computed than stand in: {line}")
    return "|".join(cells)


if __name__ == "__main__":
    page = Path(sys.argv[1])
    before = page.read_text(encoding="utf-8")
    page.write_text(rewritten(before, computed(before)["tables"]), encoding="utf-8")
