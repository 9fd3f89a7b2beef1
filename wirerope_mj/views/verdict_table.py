"""Verdicts as a table, in the report and in the recording."""

import math
from collections.abc import Sequence
from dataclasses import replace

from wirerope_mj.assessment.criteria import CLEAR, COMBINED, EXCEEDED, NOT_JUDGED, STRUCK, TOUCHING, WITHIN, Verdict
from wirerope_mj.foundation.tables import Cell, Column, Mark, Table
from wirerope_mj.views.display import ABSENT, fixed, shown, shown_unit

TONE = {WITHIN: "within", EXCEEDED: "exceeded", NOT_JUDGED: "unjudged"} | {STRUCK: "exceeded", TOUCHING: "", CLEAR: ""}
COLUMNS = (
    *(Column(heading, align="left") for heading in ("criterion", "verdict", "where")), Column("value"), Column("limit"),
    Column("unit", align="left"), Column("margin"),
)  # fmt: skip
_ORDER = (EXCEEDED, STRUCK, WITHIN, TOUCHING, CLEAR, NOT_JUDGED)
AMPLE = 10.0  # margin from which only its size is said: nobody needs 1234 %


_LONG = 20  # letters of a note that takes more than a line


def full_table(verdicts: Sequence[Verdict]) -> Table | None:
    """Return every verdict, exceeded ones first, then by margin, those not judged last; None without verdicts.

    A long note that is that of the row above is not written again.
    """
    if not verdicts:
        return None
    rows = ordered(verdicts)
    notes = [row.note for row in rows]
    said = [
        "as above" if len(note) > _LONG and note == before else note
        for before, note in zip(["", *notes], notes, strict=False)
    ]
    return Table(
        title="Every figure against its limit: the smallest margin first, what is not judged last",
        columns=(*COLUMNS, Column("at", "s", "z.4f"), Column("note", align="text")),
        rows=[(row.criterion, *cells(row), known(row).time, note) for row, note in zip(rows, said, strict=True)],
    )


def ordered(verdicts: Sequence[Verdict]) -> list[Verdict]:
    """Return the verdicts: what is exceeded or struck first, then the smallest margin, those not judged last."""
    return sorted(verdicts, key=lambda row: (_ORDER.index(row.verdict), -(row.utilisation or 0.0)))


def margin(row: Verdict) -> str:
    """Return the margin in per cent."""
    if row.margin is None:
        return ABSENT
    if row.margin > AMPLE:
        return f"> {fixed(100.0 * AMPLE, 0)} %"
    return f"{fixed(100.0 * row.margin, 1 if abs(row.margin) < 0.1 else 0)} %"


def known(row: Verdict) -> Verdict:
    """Return the verdict; without value and instant if it is a sum of shares of which none is rated, which says nothing."""
    nothing = row.criterion == COMBINED and row.limit is None and (row.value == 0.0 or math.isnan(row.value))
    return replace(row, value=math.nan, time=None) if nothing else row


def cells(row: Verdict) -> tuple[Cell, ...]:
    """Return verdict, subject, value, limit, unit and margin."""
    return (
        Mark(content=row.verdict, tone=TONE[row.verdict]),
        row.subject,
        shown(known(row).value, row.unit),
        shown(row.limit, row.unit),
        shown_unit(row.unit),
        margin(row),
    )
