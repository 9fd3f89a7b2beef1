"""What a study of a job says: how often the limits of each load case are exceeded, and those of any."""

from collections.abc import Iterator, Mapping
from functools import partial

from wirerope_mj.content.blocks import Block, Content, Section, Statement
from wirerope_mj.content.numbers import several
from wirerope_mj.content.study import failed_blocks, measures_table, payload_scope, varied_table
from wirerope_mj.content.study_statements import exceedance_text, not_counted, percent
from wirerope_mj.foundation.tables import Column, Mark, Row, Table
from wirerope_mj.studies.results.measure import CONFIDENCE
from wirerope_mj.studies.results.study_summary import StudySummary, any_exceeded


def job_study_content(name: str, question: str, cases: Mapping[str, StudySummary]) -> Content:
    """Compose what a study of a job says, its cases by name; variant k is the same system in every case."""
    first = next(iter(cases.values()))
    return Content(
        title=name,
        facts=(("Load cases", str(len(cases))), ("Variants", f"{first.result.variants} of each")),
        question=(question,),
        verdict=_headline(cases),
        sections=(
            Section(id="answer", title="", build=lambda: _failed(cases), depth="headline"),
            Section(id="cases", title="Load cases", build=lambda: [_cases_table(cases)], depth="summary"),
            Section(id="varied", title="Varied quantities", build=lambda: [varied_table(first.result.study)]),
            *(
                Section(id=f"case-{number}", title=case, build=partial(_case, own))
                for number, (case, own) in enumerate(cases.items(), start=1)
            ),
        ),
    )


def _case(summary: StudySummary) -> list[Block]:
    motion = summary.result.study.motions[0].description
    return [Statement(id="motion", text=f"Base motion: {motion}."), measures_table(summary)]


def _headline(cases: Mapping[str, StudySummary]) -> Statement:
    most = any_exceeded(list(cases.values()))
    (limits, missing), sampled = payload_scope(list(cases.values())), next(iter(cases.values())).result.is_sampled
    rest = not_counted(most)
    if not most.judged:
        return Statement(id="headline", text=f"Not judged{rest}", tone="unjudged")
    values = {"beyond": float(most.count), "of": float(most.n)}
    if sampled:
        values |= {"probability": most.ratio, "low": most.low, "high": most.high, "confidence": CONFIDENCE}
    bounds = f" ({percent(most.ratio)}; {percent(most.low)} to {percent(most.high)} at {percent(CONFIDENCE)} confidence)"
    of = bounds if sampled else ""
    if most.count:
        counts = {name: any_exceeded([own]).count for name, own in cases.items()}
        worst = max(counts, key=lambda name: counts[name])
        text = (
            f"A limit of a load case is exceeded in {most.count} of {most.n} variants{of}, most often in {worst}{rest}{missing}"
        )
        return Statement(id="headline", text=text, tone="exceeded", values=values)
    text = f"Within the limits{limits} in {several(len(cases), 'load case')} and all {most.judged} variants{of}{rest}{missing}"
    return Statement(id="headline", text=text, tone="unjudged" if rest or missing else "within", values=values)


def _cases_table(cases: Mapping[str, StudySummary]) -> Table:
    """Tabulate how often limits are exceeded in each case, and which of them most often; the last row is any case."""
    rows: list[Row] = []
    for name, summary in (*cases.items(), ("any of them", None)):
        own = list(cases.values()) if summary is None else [summary]
        beyond, sampled = any_exceeded(own), own[0].result.is_sampled
        counts = {} if summary is None else {text: int(mask.sum()) for text, mask in summary.beyond.items()}
        most = max(counts, key=lambda text: counts[text], default="")
        often = f"{most}, {counts[most]}" if counts and counts[most] else ""
        tone = "exceeded" if beyond.count else "within" if beyond.judged == beyond.n else "unjudged"
        bounds = f"{percent(beyond.low)} to {percent(beyond.high)}" if sampled and beyond.n else ""
        rows.append([name, Mark(exceedance_text(beyond, beyond.ratio if sampled else None), tone), bounds, often])
    columns = [
        Column("load case", align="text"), Column("variants beyond a limit", align="left"),
        Column(f"probability,\n{percent(CONFIDENCE)} confidence", align="left"), Column("most often beyond", align="text"),
    ]  # fmt: skip
    return Table(id="cases", title="How often a limit is exceeded", columns=columns, rows=rows)


def _failed(cases: Mapping[str, StudySummary]) -> Iterator[Block]:
    for summary in cases.values():
        yield from failed_blocks(summary.result, "variant")
