"""Verdicts as text and in tables: what is exceeded, how much is left, what nobody can judge."""

import math
from collections.abc import Sequence

from wirerope_mj.assessment.criteria import EXCEEDED, NOT_JUDGED, STRUCK, WITHIN, Verdict
from wirerope_mj.assessment.criteria import headline as verdicts_headline
from wirerope_mj.foundation.tables import Column, Mark, Table
from wirerope_mj.views.display import listed, with_unit
from wirerope_mj.views.report.content import Block, Listing, Paragraph
from wirerope_mj.views.verdict_table import AMPLE, COLUMNS, TONE, cells, known, margin, ordered

_NAMED = 3  # verdicts that the answer names one by one


def headline(verdicts: Sequence[Verdict]) -> Mark:
    """Return the answer in one sentence, coloured by the worst that it says."""
    present = {row.verdict for row in verdicts}
    tone = next((TONE[verdict] for verdict in (EXCEEDED, STRUCK, WITHIN) if verdict in present), "unjudged")
    return Mark(content=verdicts_headline(verdicts), tone=tone)


def answer(verdicts: Sequence[Verdict]) -> tuple[Block, ...]:
    """Return the worst margins and what is exceeded as text and as a table, and what is not judged with the reasons."""
    judged, over = _judged(verdicts), _exceeded(verdicts)
    sentences = []
    if over:
        texts = [_sentence(row) for row in over[:_NAMED]]
        more = f"; and {len(over) - _NAMED} more, listed below" if len(over) > _NAMED else ""
        sentences.append(f"Exceeded: {'; '.join(texts)}{more}.")
    within = [row for row in judged if row.verdict == WITHIN and (row.margin or 0.0) <= AMPLE]
    if within:
        texts = [_sentence(row) for row in _one_each(within)[:_NAMED]]
        sentences.append(f"{'Elsewhere the' if over else 'The'} smallest margins are: {'; '.join(texts)}.")
    blocks: list[Block] = [Paragraph(text=" ".join(sentences))] if sentences else []
    table = worst_table(verdicts)
    if table is not None:
        blocks.append(table)
    reasons = unjudged(verdicts)
    if reasons:
        blocks += [Paragraph(text="Not judged:", tone="unjudged"), Listing(items=reasons)]
    return tuple(blocks)


def unjudged(verdicts: Sequence[Verdict]) -> tuple[str, ...]:
    """Return a sentence for each criterion that is not judged, with the reason; subjects of the same reason together."""
    groups: dict[tuple[str, str], list[str]] = {}
    for row in verdicts:
        if row.verdict == NOT_JUDGED:
            reason = row.note.rsplit("; ", 1)[-1]  # what stands before it says where the figure was taken
            groups.setdefault((row.criterion, reason), []).append(row.subject)
    return tuple(
        f"{criterion} of {listed(subjects)}: {reason or 'no limit is stated'}."
        for (criterion, reason), subjects in groups.items()
    )


def worst_table(verdicts: Sequence[Verdict]) -> Table | None:
    """Return the worst verdict of every criterion; None without verdicts."""
    # Where nothing is judged the largest value is the worst; an unknown one, NaN, is none.
    by_size = sorted(verdicts, key=lambda row: -math.inf if math.isnan(known(row).value) else row.value, reverse=True)
    rows = _one_each(ordered(by_size))
    if not rows:
        return None
    counts = {row.criterion: sum(other.criterion == row.criterion for other in verdicts) for row in rows}
    return Table(
        title="The worst of every criterion",
        columns=(*COLUMNS, Column("at", "s", "z.4f"), Column("figures", form="d")),
        rows=[(row.criterion, *cells(row), known(row).time, counts[row.criterion]) for row in rows],
        note="Margin: limit over value less one, how much more there could be; negative where the limit is exceeded. "
        "Figures: how many the row is the worst of.",
    )


def _sentence(row: Verdict) -> str:
    value, limit = with_unit(row.value, row.unit), with_unit(row.limit, row.unit)
    return f"{row.criterion} of {row.subject}, {value} of {limit} (margin {margin(row)})"


def _judged(verdicts: Sequence[Verdict]) -> list[Verdict]:
    return [row for row in ordered(verdicts) if row.verdict in (WITHIN, EXCEEDED)]


def _exceeded(verdicts: Sequence[Verdict]) -> list[Verdict]:
    return [row for row in ordered(verdicts) if row.verdict == EXCEEDED]


def _one_each(rows: Sequence[Verdict]) -> list[Verdict]:
    """Return the first of every criterion."""
    first: dict[str, Verdict] = {}
    for row in rows:
        first.setdefault(row.criterion, row)
    return list(first.values())
