"""Edits of rows and cells of a board's tables."""

from collections.abc import Callable, Mapping

from wirerope_mj.engine.from_tables.forms import blank_table
from wirerope_mj.foundation.arrays import Entries
from wirerope_mj.foundation.errors import ModelError
from wirerope_mj.runs.board.table_text import TableText

Tables = Mapping[str, TableText]
Changed = Mapping[str, str | None]  # texts by kind; None where a table is taken away with its last row


def _table(tables: Tables, action: Entries) -> TableText:
    kind = str(action.get("table"))
    if kind not in tables:
        raise ModelError(f"there is no table {kind[:40]!r} here.")
    return tables[kind]


def _cell(tables: Tables, action: Entries) -> tuple[Changed, str]:
    table, row, column = _table(tables, action), str(action.get("row")), str(action.get("column"))
    value = str(action.get("value", "")).strip()
    if row not in table.rows:
        raise ModelError(f"there is no row {row[:40]!r} in the table of {table.kind}.")
    return {table.kind: table.with_cells(row, {column: value}).text}, f"{row}, {column} {value or 'left empty'}"


def _part(tables: Tables, action: Entries) -> tuple[Changed, str]:
    table, part = tables["mounts"], str(action.get("value", "")).strip()
    named = [str(name).partition("/")[2] for name in action.get("names") or [f"mount/{row}" for row in table.rows]]
    rows = [row for row in table.rows if row in named]
    if not part or not rows:
        raise ModelError("select mounts, and name a part.")
    for row in rows:
        table = table.with_cells(row, {"isolator": part})
    return {"mounts": table.text}, f"part of {', '.join(rows) if len(rows) < 4 else f'{len(rows)} mounts'}: {part}"


def _add(tables: Tables, action: Entries) -> tuple[Changed, str]:
    kind = str(action.get("table"))
    if kind not in tables:
        if kind not in ("stops", "points"):
            raise ModelError(f"there is no table {kind[:40]!r} here.")
        return {kind: blank_table(kind)}, f"table of {kind} added"
    table = tables[kind]
    last = list(table.rows)[-1]
    new = table.free_name(last)
    # beside the last one: nothing can stand where something stands
    x = table.rows[last].get("x", "")
    cells = {"x": table.written("x", table.value(last, "x") + 0.2)} if x else {}
    return {kind: table.with_row(new, cells, like=last).text}, f"{new} added"


def _remove_row(tables: Tables, action: Entries) -> tuple[Changed, str]:
    table, row = _table(tables, action), str(action.get("row"))
    if row not in table.rows:
        raise ModelError(f"there is no row {row[:40]!r} in the table of {table.kind}.")
    rest = table.without_row(row)
    if not rest.rows and table.kind in ("mounts", "masses"):
        raise ModelError(f"one row of {table.kind} at least must stay.")
    return {table.kind: rest.text if rest.rows else None}, f"{row} taken away"


TABLE_EDITS: dict[str, Callable[[Tables, Entries], tuple[Changed, str]]] = {
    "cell": _cell, "part": _part, "add": _add, "remove-row": _remove_row,
}  # fmt: skip
