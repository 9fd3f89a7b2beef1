"""Verdicts in sentences and tables: exceeded limits, utilisations, and values that are not judged with the reasons."""

import math
from collections import Counter
from collections.abc import Iterable, Iterator, Sequence
from dataclasses import replace

from wirerope_mj.assessment.criteria import CLEAR, COMBINED, EXCEEDED, NOT_JUDGED, STRUCK, TOUCHING, WITHIN, Verdict
from wirerope_mj.assessment.criteria import headline as verdicts_headline
from wirerope_mj.assessment.criteria.judge import PASS
from wirerope_mj.assessment.criteria.summary import rule_lines, verdict_lines
from wirerope_mj.assessment.criteria.verdict import (
    ACCELERATION,
    TRAVEL,
    Criterion,
    criterion_text,
    most_amplified,
    most_used,
    value_and_limit,
)
from wirerope_mj.content.blocks import Block, Statement
from wirerope_mj.content.judged_run import JudgedRun, RunResult
from wirerope_mj.content.numbers import listed, shown, shown_unit
from wirerope_mj.foundation.tables import Cell, Column, Mark, Table, left

TONE = {WITHIN: "within", EXCEEDED: "exceeded", NOT_JUDGED: "unjudged"} | {STRUCK: "exceeded", TOUCHING: "", CLEAR: ""}
NEAR = 0.9  # utilisation above which it is marked as a warning
_ORDER = (EXCEEDED, STRUCK, WITHIN, TOUCHING, CLEAR, NOT_JUDGED)
_COLUMNS = (
    *left("criterion", "verdict", "where"), Column("value"), Column("limit"),
    *left("unit"), Column("used", "%", "z.0f"), Column("at", "s", "z.4f"),
)  # fmt: skip
_LONG_NOTE = 20  # letters above which a note is not repeated in the next row
_BARS = 5  # criteria that are drawn as bars; the others are folded away
_WORST = 10  # verdicts that are shown besides the exceeded ones; the others are folded away


def headline(verdicts: Sequence[Verdict]) -> Statement:
    """State the answer in one sentence, in the tone of the worst verdict."""
    worst, present = most_used(verdicts), {row.verdict for row in verdicts}
    text = verdicts_headline(verdicts)
    # A stop that was struck is a warning: what fails alone has the colour of failure.
    tones = ((EXCEEDED, "exceeded"), (STRUCK, "near"), (WITHIN, "within"))
    tone = next((tone for verdict, tone in tones if verdict in present), "unjudged")
    # A pass of only some limits is not green, nor is one close to a limit.
    if tone == "within" and worst is not None:
        tone = used_tone(worst.utilisation) if text.startswith(f"{PASS}:") else "unjudged"
    values: dict[str, float | str | None] = {"answer": text.partition(":")[0]}
    if worst is not None:
        values |= {"most_critical": worst.subject, "criterion": str(worst.criterion), "utilisation": worst.utilisation}
    if (amplified := most_amplified(verdicts)) is not None:
        values |= {"amplified": amplified[0], "amplification": amplified[1].ratio}
    return Statement("headline", text, tone=tone, values=values)


def answer_blocks(run: RunResult) -> Iterator[Statement | None]:
    """Yield the verdicts in sentences, and the mounts that exceed the tests of their laws."""
    lines = [*verdict_lines(run.response, run.verdicts), *rule_lines(run.verdicts)]
    yield Statement("verdicts", items=tuple(lines))
    yield untested(run)


def untested(run: RunResult) -> Statement | None:
    return Statement("untested", run.untested, tone="unjudged") if run.untested else None


def criteria_blocks(verdicts: Sequence[Verdict]) -> Iterator[Block | None]:
    """Yield the worst of every criterion as bars, the most critical first, and what is not judged in one sentence."""
    worst = {row.criterion: row for row in reversed(ordered(verdicts)) if row.utilisation is not None}
    yield verdict_bars("criterion", ((criterion_text(criterion), row.subject, row) for criterion, row in worst.items()))
    yield open_statement(verdicts)


def verdict_bars(heading: str, named: Iterable[tuple[str, str, Verdict]]) -> Table | None:
    """Tabulate judged verdicts as bars, the most critical first, each behind its two names in `named`; None without any."""
    rows = sorted(named, key=lambda entry: -(entry[-1].utilisation or 0.0))
    if not rows:
        return None

    def value_text(row: Verdict) -> str:
        if row.criterion == COMBINED:
            return "in-house rule"
        value, limit, unit = value_and_limit(row)
        return f"{value} of {limit} {unit}" if unit else ""

    over = sum(row.verdict == EXCEEDED for *_, row in rows)
    bars = [(name, where, row.utilisation, value_text(row)) for name, where, row in rows]
    return bars_table(heading, bars, most=max(over, _BARS))


def bars_table(heading: str, rows: Iterable[tuple[str, str, float | None, str]], most: int = _BARS) -> Table:
    """Tabulate utilisations as bars; a row is two names, utilisation and text; rows beyond `most` are folded away."""
    return Table(
        "criteria", "",
        [Column(heading, align="text"), *left("where"), Column("used", "%", "z.0f", bar=True), *left("value and limit")],
        [(name, where, Mark(used, used_tone(used)), text) for name, where, used, text in rows],
        shown=most,
    )  # fmt: skip


def open_statement(verdicts: Iterable[Verdict]) -> Statement | None:
    """State for each quantity how many of its values are not judged; None if all are judged."""
    rows = dict.fromkeys((row.criterion, row.subject) for row in verdicts if row.verdict == NOT_JUDGED and not row.contact)
    counts = Counter(str(row) if row.kind == TRAVEL else criterion_text(Criterion(row.kind)) for row, _ in rows)
    subjects = {str(row) if row.kind == TRAVEL else criterion_text(Criterion(row.kind)): subject for row, subject in rows}
    text = ", ".join(f"{name} ({subjects[name] if count == 1 else count})" for name, count in counts.most_common())
    return Statement("open", f"Not judged: {text}.", tone="unjudged") if rows else None


def grounds_blocks(run: JudgedRun) -> Iterator[Block | None]:
    yield worst_table(run.verdicts)
    reasons = unjudged(run.verdicts)
    yield Statement("not-judged", "Not judged:", items=reasons, tone="unjudged") if reasons else None


def unjudged(verdicts: Sequence[Verdict]) -> tuple[str, ...]:
    """Write lines on the values that are not judged, by criterion and reason."""
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
    """Tabulate the worst verdict of every criterion; None without verdicts."""
    # Without a utilisation the largest value is the worst.
    by_size = sorted(verdicts, key=lambda row: -math.inf if math.isnan(_rated(row).value) else row.value, reverse=True)
    first: dict[str, Verdict] = {}
    for row in ordered(by_size):
        first.setdefault(row.criterion, row)
    if not first:
        return None
    return Table(
        "worst-of-criteria", "The worst of every criterion", (*_COLUMNS, Column("values", form="d")),
        [(*_cells(row), sum(other.criterion == row.criterion for other in verdicts)) for row in first.values()],
        note="Used: value over limit, above 100 % where it is exceeded. Values: how many the row is the worst of.",
    )  # fmt: skip


def full_table(verdicts: Sequence[Verdict]) -> Table | None:
    """Tabulate every verdict, exceeded ones first, those not judged last; None without verdicts.

    A long note that equals the note of the row above is not written again.
    """
    if not verdicts:
        return None
    rows = ordered(verdicts)
    notes = [row.note for row in rows]
    shortened = [
        "as above" if len(note) > _LONG_NOTE and note == before else note
        for before, note in zip(["", *notes], notes, strict=False)
    ]
    return Table(
        "all-verdicts",
        "Every value against its limit: the largest utilisation first, what is not judged last",
        (*_COLUMNS, Column("note", align="text")),
        [(*_cells(row), note) for row, note in zip(rows, shortened, strict=True)],
        shown=sum(row.verdict in (EXCEEDED, STRUCK) for row in rows) + _WORST,
    )


def ordered(verdicts: Sequence[Verdict]) -> list[Verdict]:
    """Sort verdicts from exceeded to not judged, and by falling utilisation."""
    return sorted(verdicts, key=lambda row: (_ORDER.index(row.verdict), -(row.utilisation or 0.0)))


def acceleration_limits(verdicts: Sequence[Verdict]) -> dict[str, Verdict]:
    """Find for each body or point its acceleration verdict of largest utilisation, by name."""
    judged = [row for row in verdicts if row.criterion.kind == ACCELERATION and row.utilisation is not None]
    return {row.subject: row for row in sorted(judged, key=lambda row: row.utilisation or 0.0)}


def used_mark(utilisation: float | None) -> Mark:
    """Mark a utilisation with its tone; one well within its limit has none."""
    tone = used_tone(utilisation)
    return Mark(utilisation, "" if tone == "within" else tone)


def used_tone(utilisation: float | None) -> str:
    """Find the tone (meaning of its colour) of a utilisation, the same in sentences, bars and drawings."""
    if utilisation is None:
        return "quiet"
    return "exceeded" if utilisation > 1.0 else "near" if utilisation > NEAR else "within"


def _rated(row: Verdict) -> Verdict:
    """Replace the value of a combined travel without ratings by NaN."""
    unrated = row.criterion == COMBINED and row.limit is None and (row.value == 0.0 or math.isnan(row.value))
    return replace(row, value=math.nan, time=None) if unrated else row


def _cells(row: Verdict) -> tuple[Cell, ...]:
    return (
        str(row.criterion), Mark(content=row.verdict, tone=TONE[row.verdict]), row.subject,
        shown(_rated(row).value, row.unit), shown(row.limit, row.unit), shown_unit(row.unit), used_mark(row.utilisation),
        _rated(row).time,
    )  # fmt: skip
