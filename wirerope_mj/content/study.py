"""Content of a study: how often limits are exceeded, the most influential inputs, and the worst variants."""

import math
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import replace
from functools import partial

import numpy as np

from wirerope_mj.assessment.criteria import rested_verdicts
from wirerope_mj.content.base import amplified
from wirerope_mj.content.blocks import Block, Content, Section, Statement
from wirerope_mj.content.credibility import study_credibility_blocks
from wirerope_mj.content.numbers import paragraphs, several, with_unit
from wirerope_mj.content.study_charts import study_charts
from wirerope_mj.content.study_statements import (
    exceedance_text,
    failures,
    limit_statement,
    not_counted,
    numbered,
    percent,
    statements,
)
from wirerope_mj.engine.statics import static_table
from wirerope_mj.foundation.errors import ConvergenceError
from wirerope_mj.foundation.tables import Cell, Column, Mark, Row, Table, left
from wirerope_mj.studies.definition import StudyDefinition
from wirerope_mj.studies.result import StudyResult
from wirerope_mj.studies.results.effects import AZIMUTH, ELEVATION
from wirerope_mj.studies.results.measure import (
    ALL,
    CONFIDENCE,
    input_names,
    known_measures,
    measure_of,
    most_critical,
    values_of,
    worst,
)
from wirerope_mj.studies.results.study_summary import QUANTILES, StudySummary, any_exceeded
from wirerope_mj.studies.results.varied import limits_of, varied_of

_MOST_MESSAGES = 20  # messages of failed variants that are listed
_METHODS = {
    "sobol": "scrambled Sobol sequence", "latin-hypercube": "Latin hypercube", "random": "random samples",
    "grid": "all combinations of the values", "list": "the values as they are listed",
    "sobol-indices": "Saltelli's matrices of a scrambled Sobol sequence",
}  # fmt: skip


def study_content(summary: StudySummary) -> Content:
    """Compose the content of a complete study: exceedances, statistics, influential inputs, worst variants."""
    result, study = summary.result, summary.result.study

    def answer() -> Iterator[Block]:
        limits = [limit_statement(limit, result.independent, sampled=result.is_sampled) for limit in summary.stated]
        yield Statement("answer", items=(*limits, *statements(result)))
        yield from failed_blocks(result, "variant")

    return Content(
        title=study.name.replace("_", " ").capitalize(),
        facts=study_facts(result, "Variants", _METHODS.get(study.sampling, study.sampling)),
        question=study_question(result, "study"),
        verdict=rested_first(_verdict(summary), study),
        sections=(
            Section("answer", "", answer, "headline"),
            Section("varied", "Varied quantities", lambda: (varied_table(study),)),
            Section("results", "Results", lambda: (measures_table(summary), *study_charts(summary)), "summary"),
            Section("inputs", "Inputs that matter", lambda: indices_tables(summary) or [effects_table(summary)], "summary"),
            Section("worst", "Worst variants", lambda: (worst_table(summary),), "summary"),
            Section("credibility", "How far this can be relied on", lambda: study_credibility_blocks(result)),
            Section("numerics", "Numerics and versions", lambda: (numerics_table(result),)),
        ),
    )


def study_facts(result: StudyResult, things: str, how: str) -> tuple[tuple[str, str], ...]:
    names, content = set(input_names(result.columns)), result.inputs
    varies = ["direction"] * bool({AZIMUTH, ELEVATION} & names) + ["level"] * ("motion/level" in names)
    motions = " | ".join(motion.description for motion in result.study.motions)
    if varies:
        motions += f"; its {' and '.join(varies)} {'vary' if len(varies) > 1 else 'varies'}"
    return (
        ("Model", content["model"]["file"].rpartition("/")[2]), ("Base motion", motions),
        (things, f"{result.variants}, {how}"), ("By", f"wirerope-mj {content['versions'].get('wirerope-mj', 'unknown')}"),
    )  # fmt: skip


def study_question(result: StudyResult, kind: str) -> tuple[str, ...]:
    return tuple(paragraphs(result.study.question)) or (f"The {kind} asks no question.",)


def _verdict(summary: StudySummary) -> Statement:
    """State in how many variants a limit is exceeded, and which variants and limits are not judged."""
    if not summary.beyond or not (summary.stated or any(measured.beyond for measured in summary.statistics)):
        return Statement("headline", "Not judged: no limit is stated", tone="unjudged")
    over, ratio = any_exceeded([summary]), summary.ratio_beyond
    rest = uncounted = not_counted(over)
    if not over.judged:
        return Statement("headline", f"Not judged{rest}", tone="unjudged")
    values: dict[str, float | None] = {"beyond": float(over.count), "of": float(over.n), "ratio": ratio}
    limits, table, motions = limits_of(summary.stated), summary.result.independent, summary.result.study.motions
    if critical := most_critical(table, limits):
        name, values["used"] = critical
        worst_variant = worst(table, name, 1)[0]
        rest += f"; worst {100.0 * critical[1]:.3g} % of {measure_of(name, limits).heading}, in variant {worst_variant}"
    scope, missing = payload_scope([summary])
    rest += missing
    if len(motions) == 1 and "motion/level" not in input_names(table):
        accelerations = (values_of(table, name) for name in known_measures(table, ("acceleration", ALL)))
        text = amplified(max(float(np.nanmax(peaks, initial=0.0)) for peaks in accelerations), motions[0])
        rest += f"; {text}" if text else ""
    if over.count:
        of_all = "" if ratio is None else f" ({percent(ratio)}{summary.of_directions})"
        text, tone = f"A limit is exceeded in {over.count} of {over.n} variants{of_all}{rest}", "exceeded"
    elif over.failed:
        kept = f"{over.judged} {'is' if over.judged == 1 else 'are'} within the limits{not_counted(replace(over, failed=0))}"
        text, tone = f"{over.failed} of {over.n + over.failed} variants could not be simulated, {kept}", "unjudged"
    else:
        text = f"Within the limits{scope} in all {over.judged} variants{rest}"
        tone = "unjudged" if uncounted or missing else "within"
    return Statement("headline", text, tone=tone, values=values)


def rested_first(verdict: Statement, study: StudyDefinition) -> Statement:
    """Put before a verdict that stops or contacts of the nominal system carry weight at rest, if they do."""
    try:
        rows = rested_verdicts(static_table(study.base))
    except ConvergenceError:
        return verdict
    if not rows:
        return verdict
    note = max(rows, key=lambda row: row.value).note
    text = f"{note[:1].upper()}{note[1:]}; {verdict.text[:1].lower()}{verdict.text[1:]}"
    return replace(verdict, text=text, tone="exceeded")


def payload_scope(summaries: Sequence[StudySummary]) -> tuple[str, str]:
    """Describe the scope of the limits, " of the mounts", and what is not judged; "" if accelerations are limited."""
    limited: set[str] = set()
    for summary in summaries:
        limits = limits_of(summary.stated)
        names = {measured.measure.name for measured in summary.statistics} | set(limits)
        limited |= {name.partition("/")[0] for name in names if measure_of(name, limits).limit is not None}
    if limited & {"fragility", "acceleration"}:
        return "", ""
    if limited & {"clearance", "displacement"}:
        return " of the mounts and displacements", "; acceleration of the payload not judged: no limit stated"
    return " of the mounts", "; payload not judged: no limit stated"


def failed_blocks(result: StudyResult, noun: str) -> Iterator[Block]:
    """Yield the messages of variants or designs that could not be simulated, each with their numbers."""
    if not result.failed:
        return
    of_message = list(failures(result.failed).items())
    lines = [f"{numbered(numbers, noun).capitalize()}: {message}" for message, numbers in of_message[:_MOST_MESSAGES]]
    if len(of_message) > _MOST_MESSAGES:
        lines.append(f"{len(of_message) - _MOST_MESSAGES} other messages: see the column message of the table.")
    stand = "stands" if len(result.failed) == 1 else "stand"
    text = f"{several(len(result.failed), noun)} could not be simulated and {stand} in no statistic:"
    yield Statement("failed", text, items=tuple(lines), tone="unjudged")


def numerics_table(result: StudyResult) -> Table:
    """Tabulate numerics and versions of a study."""
    content = result.inputs
    simulate, sampling = content["simulate"], content["sampling"]
    rows = [
        ("simulated", f"{simulate['duration']:g} s of each variant, initial state {simulate['initial']}"),
        ("steps", f"at most {with_unit(simulate['timestep'], 'ms', digits=4)}, the same for all variants"),
        ("sampling", f"{sampling['method']}, seed {sampling['seed']}"),
        ("study", content["id"]),
    ]
    rows += [(f"version of {name}", str(version)) for name, version in content["versions"].items()]
    columns = [*left("item"), Column("value", align="text")]
    return Table("settings", "How it was computed", columns, rows)


_WORST, _COLUMNS, _EFFECTS, _FEW = 10, 6, 15, 8  # worst variants, columns of their table, effects, effects shown at once
_LONG_HEADING = 11  # letters above which a heading is broken into two lines


def varied_table(study: StudyDefinition) -> Table:
    """Tabulate the varied quantities, their values in the model, and their distributions."""
    rows = []
    for varied in varied_of(study):
        group, each = varied.distribution.group, varied.distribution.each
        name = f"{varied.name} ({group})" if group else varied.name
        kind = f"{varied.kind} [{varied.unit}]" if varied.unit else varied.kind
        sampling = f"independent per {varied.name.partition('/')[0]}" if each else "common"
        rows.append((name, kind, varied.model, varied.distribution_text, sampling))
    columns = [Column(head, align="text") for head in ("quantity", "is a", "in the model", "values", "sampling")]
    note = "A value replaces what the model says, a shift is added to it, a factor multiplies it. SI: as the law states."
    return Table("varied", f"Quantities that vary in {study.name}", columns, rows, note=note)


def measures_table(summary: StudySummary) -> Table:
    """Tabulate the statistics of each measure."""
    sampled = summary.result.is_sampled
    rows: list[list[Cell]] = []
    for measured in summary.statistics:
        column, beyond = measured.measure.column, measured.beyond
        between = measured.quantiles if sampled else (measured.smallest, measured.median)
        values = [measured.nominal, *between, measured.largest]
        texts = [column.text(value) if math.isfinite(value) else None for value in values]
        judged: list[Cell] = [None, None]
        if beyond is not None:
            mark = Mark(exceedance_text(beyond, measured.ratio), "exceeded" if beyond.count else "within")
            judged = [column.text(measured.measure.limit), mark]
        rows.append([column.title(), *texts, str(measured.variant), *judged])
    heads = [f"{100.0 * q:.0f} %" for q in QUANTILES] if sampled else ["smallest", "median"]
    heads = ["nominal", *heads, "largest", "in\nvariant", "limit"]
    meanings = "; ".join(f"{measure.heading}: {measure.text}" for measure in summary.measures)
    percentiles = " A percentile is given if at least five variants lie beyond it." if sampled else ""
    return Table(
        "measures", "Measures and their percentiles" if sampled else "Measures",
        (*left("measure"), *map(Column, heads), Column("beyond it", align="text")), rows,
        note=f"{meanings[0].upper()}{meanings[1:]}.{percentiles}",
    )  # fmt: skip


def indices_tables(summary: StudySummary) -> list[Table]:
    """Tabulate Sobol indices (fractions of variance) of each measure, if the study was sampled for them."""
    heads = ("alone", "from", "to", "with others", "from", "to")
    columns = [Column("factor", align="text"), *(Column(head, "%", "z.1f") for head in heads)]
    tables = []
    for indices in summary.indices:
        dropped = f"; {indices.dropped} more were dropped, because variants of them failed" if indices.dropped else ""
        few = " So few base rows say nothing: take more." if indices.too_few else ""
        tables.append(Table(
            f"indices-{indices.measure}", f"Variance explained of: {measure_of(indices.measure).text}", columns,
            [(row.name, row.first, *row.first_interval, row.total, *row.total_interval) for row in indices.factors],
            note=f"Sobol's first-order and total indices with bounds of {100.0 * CONFIDENCE:.0f} % confidence (bootstrap) from "
            f"{several(indices.rows, 'base row')}{dropped}. A factor may be several quantities of one group. Indices lie "
            "between 0 and 100 %: one that is estimated below or above them is so by chance. Those with others may add up to "
            f"more than 100 %, because what factors do together counts for each of them.{few}",
        ))  # fmt: skip
    return tables


def effects_table(summary: StudySummary) -> Table | None:
    """Tabulate the effects of the strongest inputs; None with fewer than two inputs."""
    if len(summary.effects) < 2:
        return None
    significant = {True: Mark("yes", "strong"), False: Mark("no", "quiet")}
    return Table(
        "effects", f"Variance explained by each input alone of: {measure_of(summary.by).text}",
        [
            Column("input", align="text"), Column("first-order index", "%", ".1f"), *left("significant"),
            Column("rank correlation", form="+.2f"),
        ],
        [
            (row.name, max(row.index, 0.0), significant[row.certain], row.rank) for row in summary.effects[:_EFFECTS]
        ],
        shown=_FEW,
        note="Estimated from the variants as they are. Significant: an input without any effect would hardly reach such an "
        "index. What is missing to 100 % comes from inputs that act together, and from what so "
        "few variants do not show. If some inputs rise and fall together, what they explain in common is counted for the "
        "strongest alone.",
    )  # fmt: skip


def worst_table(summary: StudySummary) -> Table:
    """Tabulate the variants with the largest values of the main measure."""
    names = [measure.name for measure in summary.measures]
    # accelerations of bodies, of points, or of both together
    measures = [measure for measure in summary.measures if measure.name != "acceleration" or ALL not in names]
    names = list(summary.ranked_inputs[: max(_COLUMNS - len(measures), 2)])
    return Table(
        "worst-variants", f"Worst variants by {measure_of(summary.by).heading}, with the inputs that matter most",
        [
            *left("variant"),
            *(replace(measure.column, heading=two_lines(measure.heading)) for measure in measures),
            *(Column(two_lines(summary.labels[name]), form=4) for name in names),
        ],
        [
            (
                str(row["variant"]), *(row[measure.name] for measure in measures),
                *(row[name] if isinstance(row[name], float) else str(row[name]) or "none" for name in names),
            )
            for row in summary.worst(_WORST)
        ],
        note=f"Not shown: {', '.join(summary.left_out)}." if summary.left_out else "",
    )  # fmt: skip


def two_lines(name: str) -> str:
    """Break a long heading into two lines, and put its unit on a line by itself."""
    name, bracket, unit = name.partition(" [")
    words = name.split(" ")
    if len(name) > _LONG_HEADING and len(words) > 1:
        half = len(words) // 2
        name = " ".join(words[:half]) + "\n" + " ".join(words[half:])
    return f"{name}\n[{unit}" if bracket else name


def job_study_content(name: str, question: str, cases: Mapping[str, StudySummary]) -> Content:
    """Compose the study of a job: exceedances in each load case; variant k is the same system in all cases."""

    def case_blocks(summary: StudySummary) -> list[Block]:
        motion = summary.result.study.motions[0].description
        return [Statement("motion", f"Base motion: {motion}."), measures_table(summary)]

    studies = list(cases.values())
    first, over, (limits, missing) = studies[0].result, any_exceeded(studies), payload_scope(studies)
    rest, values, estimate = not_counted(over), {"beyond": float(over.count), "of": float(over.n)}, ""
    if first.is_sampled and over.judged:
        values |= {"probability": over.ratio, "low": over.low, "high": over.high, "confidence": CONFIDENCE}
        estimate = f" ({percent(over.ratio)}; {percent(over.low)} to {percent(over.high)} at {percent(CONFIDENCE)} confidence)"
    if not over.judged:
        answer = Statement("headline", f"Not judged{rest}", tone="unjudged")
    elif over.count:
        worst_case = max(cases, key=lambda case: any_exceeded([cases[case]]).count)
        text = f"A limit of a load case is exceeded in {over.count} of {over.n} variants{estimate}, most often in {worst_case}"
        answer = Statement("headline", f"{text}{rest}{missing}", tone="exceeded", values=values)
    else:
        text = f"Within the limits{limits} in {several(len(cases), 'load case')} and all {over.judged} variants"
        tone = "unjudged" if rest or missing else "within"
        answer = Statement("headline", f"{text}{estimate}{rest}{missing}", tone=tone, values=values)
    sections = [
        Section(
            "answer", "", lambda: (block for case in studies for block in failed_blocks(case.result, "variant")), "headline"
        ),
        Section("cases", "Load cases", lambda: [_cases_table(cases)], "summary"),
        Section("varied", "Varied quantities", lambda: [varied_table(first.study)]),
    ]
    for number, (title, summary) in enumerate(cases.items(), start=1):
        sections.append(Section(f"case-{number}", title, partial(case_blocks, summary)))
    facts = ("Load cases", str(len(cases))), ("Variants", f"{first.variants} of each")
    verdict = rested_first(answer, first.study)
    return Content(title=name, facts=facts, question=(question,), verdict=verdict, sections=tuple(sections))


def _cases_table(cases: Mapping[str, StudySummary]) -> Table:
    """Tabulate how often limits are exceeded in each case, and the limit exceeded most often; the last row is for any case."""
    rows: list[Row] = []
    for name, summary in (*cases.items(), ("any of them", None)):
        studies = list(cases.values()) if summary is None else [summary]
        beyond, sampled = any_exceeded(studies), studies[0].result.is_sampled
        counts = {} if summary is None else {text: int(mask.sum()) for text, mask in summary.beyond.items()}
        most = max(counts, key=lambda text: counts[text], default="")
        often = f"{most}, {counts[most]}" if counts and counts[most] else ""
        tone = "exceeded" if beyond.count else "within" if beyond.judged == beyond.n else "unjudged"
        bounds = f"{percent(beyond.low)} to {percent(beyond.high)}" if sampled and beyond.n else ""
        rows.append([name, Mark(exceedance_text(beyond, beyond.ratio if sampled else None), tone), bounds, often])
    columns = [
        Column("load case", align="text"), *left("variants beyond a limit"),
        Column(f"probability,\n{percent(CONFIDENCE)} confidence", align="left"), Column("most often beyond", align="text"),
    ]  # fmt: skip
    return Table("cases", "How often a limit is exceeded", columns, rows)
