"""What a study says: how often limits are exceeded, the inputs that matter, the worst variants."""

import math
from collections.abc import Iterator, Sequence
from dataclasses import replace

import numpy as np

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
from wirerope_mj.foundation.tables import Cell, Column, Mark, Table
from wirerope_mj.studies.definition import StudyDefinition
from wirerope_mj.studies.result import StudyResult
from wirerope_mj.studies.results.effects import AZIMUTH, ELEVATION, SobolIndices
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
from wirerope_mj.studies.results.stated_limits import limits_of
from wirerope_mj.studies.results.study_summary import QUANTILES, Statistics, StudySummary, any_exceeded
from wirerope_mj.studies.results.varied import varied_of

_FAILED = 20  # messages that are read
_METHODS = {
    "sobol": "scrambled Sobol sequence", "latin-hypercube": "Latin hypercube", "random": "random samples",
    "grid": "all combinations of the values", "list": "the values as they are listed",
    "sobol-indices": "Saltelli's matrices of a scrambled Sobol sequence",
}  # fmt: skip


def study_content(summary: StudySummary) -> Content:
    """Compose what a study that is complete says."""
    result = summary.result
    study = result.study
    return Content(
        title=study.name.replace("_", " ").capitalize(),
        facts=study_facts(result, "Variants", _METHODS.get(study.sampling, study.sampling)),
        question=study_question(result, "study"),
        verdict=_verdict(summary),
        sections=(
            Section("answer", "", lambda: _answer(summary), "headline"),
            Section("varied", "Varied quantities", lambda: (varied_table(study),)),
            Section("results", "Results", lambda: (measures_table(summary), *study_charts(summary)), "summary"),
            Section("inputs", "Inputs that matter", lambda: indices_tables(summary) or [effects_table(summary)], "summary"),
            Section("worst", "Worst variants", lambda: (worst_table(summary),), "summary"),
            Section("credibility", "How far this can be relied on", lambda: study_credibility_blocks(result)),
            Section("numerics", "Numerics and versions", lambda: (numerics_table(result),)),
        ),
    )


def study_facts(result: StudyResult, things: str, how: str) -> tuple[tuple[str, str], ...]:
    """Return what stands below the title of a study or a search."""
    content = result.inputs
    return (
        ("Model", content["model"]["file"].rpartition("/")[2]), ("Base motion", _motion_text(result)),
        (things, f"{result.variants}, {how}"), ("By", f"wirerope-mj {content['versions'].get('wirerope-mj', 'unknown')}"),
    )  # fmt: skip


def study_question(result: StudyResult, kind: str) -> tuple[str, ...]:
    """Return what a study or a search asks, a text for each paragraph."""
    return tuple(paragraphs(result.study.question)) or (f"The {kind} asks no question.",)


def _motion_text(result: StudyResult) -> str:
    """Return the base motions of a study, and what of them varies."""
    names = set(input_names(result.table))
    varies = ["direction"] * bool({AZIMUTH, ELEVATION} & names) + ["level"] * ("motion/level" in names)
    motions = " | ".join(motion.description for motion in result.study.motions)
    return f"{motions}; its {' and '.join(varies)} {'vary' if len(varies) > 1 else 'varies'}" if varies else motions


def _verdict(summary: StudySummary) -> Statement:
    if not summary.beyond or not (summary.stated or any(one.beyond for one in summary.statistics)):
        return Statement(id="headline", text="Not judged: no limit is stated", tone="unjudged")
    most, ratio = any_exceeded([summary]), summary.ratio_beyond
    rest = not_counted(most)
    if not most.judged:
        return Statement(id="headline", text=f"Not judged{rest}", tone="unjudged")
    values: dict[str, float | None] = {"beyond": float(most.count), "of": float(most.n), "ratio": ratio}
    limits, table = limits_of(summary.stated), summary.result.independent
    name, used = most_critical(table, limits) or ("", math.nan)
    if name:
        values["used"] = used
        rest += f"; worst {100.0 * used:.3g} % of {measure_of(name, limits).heading}, in variant {worst(table, name, 1)[0]}"
    of, missing = payload_scope([summary])
    rest += missing
    if len(summary.result.study.motions) == 1 and "motion/level" not in input_names(table):
        largest = max(
            float(np.nanmax(values_of(table, one), initial=0.0)) for one in known_measures(table, ("acceleration", ALL))
        )
        said = amplified(largest, summary.result.study.motions[0])
        rest += f"; {said}" if said else ""
    if most.count:
        share = "" if ratio is None else f" ({percent(ratio)}{summary.of_directions})"
        text = f"A limit is exceeded in {most.count} of {most.n} variants{share}{rest}"
        return Statement(id="headline", text=text, tone="exceeded", values=values)
    if most.failed:
        kept = f"{most.judged} {'is' if most.judged == 1 else 'are'} within the limits{not_counted(replace(most, failed=0))}"
        text = f"{most.failed} of {most.n + most.failed} variants could not be simulated, {kept}"
        return Statement(id="headline", text=text, tone="unjudged", values=values)
    tone = "unjudged" if not_counted(most) or missing else "within"
    text = f"Within the limits{of} in all {most.judged} variants{rest}"
    return Statement(id="headline", text=text, tone=tone, values=values)


def payload_scope(summaries: Sequence[StudySummary]) -> tuple[str, str]:
    """Say what limits are of, " of the mounts", and as a clause what is not judged; "" where the payload's acceleration is."""
    limited: set[str] = set()
    for summary in summaries:
        limits = limits_of(summary.stated)
        names = {one.measure.name for one in summary.statistics} | set(limits)
        limited |= {name.partition("/")[0] for name in names if measure_of(name, limits).limit is not None}
    if limited & {"fragility", "acceleration"}:
        return "", ""
    moves = bool(limited & {"clearance", "displacement"})
    clause = f"; {'acceleration of the ' if moves else ''}payload not judged: no limit stated"
    return f" of the mounts{' and displacements' if moves else ''}", clause


def _answer(summary: StudySummary) -> Iterator[Block]:
    result = summary.result
    stated = [limit_statement(one, result.independent, sampled=result.is_sampled) for one in summary.stated]
    yield Statement(id="answer", items=(*stated, *statements(result)))
    yield from failed_blocks(result, "variant")


def failed_blocks(result: StudyResult, noun: str) -> Iterator[Block]:
    """Yield the variants that failed and their messages; nothing if none did."""
    if not result.failed:
        return
    of_message = list(failures(result.failed).items())
    lines = [f"{numbered(numbers, noun).capitalize()}: {message}" for message, numbers in of_message[:_FAILED]]
    if len(of_message) > _FAILED:
        lines.append(f"{len(of_message) - _FAILED} other messages: see the column message of the table.")
    stand = "stands" if len(result.failed) == 1 else "stand"
    text = f"{several(len(result.failed), noun)} could not be simulated and {stand} in no statistic:"
    yield Statement(id="failed", text=text, items=tuple(lines), tone="unjudged")


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
    columns = [Column("item", align="left"), Column("value", align="text")]
    return Table(id="settings", title="How it was computed", columns=columns, rows=rows)


_WORST, _COLUMNS, _EFFECTS, _FEW = 10, 6, 15, 8  # rows and columns that are read, and effects at once
_LONG = 11  # letters of a heading that stands on two lines where lines are short


def varied_table(study: StudyDefinition) -> Table:
    """Tabulate the quantities that vary: kinds and units, what the model says of them, and their distributions."""
    rows = []
    for one in varied_of(study):
        group = one.distribution.group
        rows.append((
            f"{one.name} ({group})" if group else one.name, f"{one.kind} [{one.unit}]" if one.unit else one.kind, one.model,
            one.distribution_text, f"independent per {one.name.partition('/')[0]}" if one.distribution.each else "common",
        ))  # fmt: skip
    heads = ("quantity", "is a", "in the model", "values", "sampling")
    return Table(
        id="varied", title=f"Quantities that vary in {study.name}", columns=[Column(head, align="text") for head in heads],
        rows=rows,
        note="A value replaces what the model says, a shift is added to it, a factor multiplies it. SI: as the law states.",
    )  # fmt: skip


def measures_table(summary: StudySummary) -> Table:
    """Tabulate the statistics of each measure: percentiles of sampled variants, smallest and median of listed ones."""
    sampled = summary.result.is_sampled
    heads = [f"{100.0 * q:.0f} %" for q in QUANTILES] if sampled else ["smallest", "median"]
    meanings = "; ".join(f"{one.heading}: {one.text}" for one in summary.measures)
    percentiles = " A percentile is given if at least five variants lie beyond it." if sampled else ""
    return Table(
        id="measures", title="Measures and their percentiles" if sampled else "Measures",
        columns=[
            Column("measure", align="left"), *map(Column, ("nominal", *heads)),
            *map(Column, ("largest", "in\nvariant", "limit")), Column("beyond it", align="text"),
        ],
        rows=[_measure_row(one, sampled) for one in summary.statistics],
        note=f"{meanings[0].upper()}{meanings[1:]}.{percentiles}",
    )  # fmt: skip


def _measure_row(one: Statistics, sampled: bool) -> list[Cell]:
    column = one.measure.column
    values = [one.nominal, *(one.quantiles if sampled else (one.smallest, one.median)), one.largest]
    texts = [column.text(value) if math.isfinite(value) else None for value in values]
    row: list[Cell] = [column.title(), *texts, str(one.variant)]
    if one.beyond is None:
        return [*row, None, None]
    tone = "exceeded" if one.beyond.count else "within"
    return [*row, column.text(one.measure.limit), Mark(exceedance_text(one.beyond, one.ratio), tone)]


def indices_tables(summary: StudySummary) -> list[Table]:
    """Return Sobol's indices of each measure; none of a study that was not sampled for them."""
    return [_indices_table(indices) for indices in summary.indices]


def _indices_table(indices: SobolIndices) -> Table:
    dropped = f"; {indices.dropped} more were dropped, because variants of them failed" if indices.dropped else ""
    few = " So few base rows say nothing: take more." if indices.too_few else ""
    rows = "1 base row" if indices.rows == 1 else f"{indices.rows} base rows"
    return Table(
        id=f"indices-{indices.measure}",
        title=f"Variance explained of: {measure_of(indices.measure).text}",
        columns=[
            Column("factor", align="text"),
            *(Column(head, "%", "z.1f") for head in ("alone", "from", "to", "with others", "from", "to")),
        ],
        rows=[(one.name, one.first, *one.first_interval, one.total, *one.total_interval) for one in indices.factors],
        note=f"Sobol's first-order and total indices with bounds of {100.0 * CONFIDENCE:.0f} % confidence (bootstrap) from "
        f"{rows}{dropped}. A factor may be several quantities of one group. Indices lie between 0 and 100 %: one that is "
        "estimated below or above them is so by chance. Those with others may add up to more than 100 %, because "
        f"what factors do together counts for each of them.{few}",
    )


def effects_table(summary: StudySummary) -> Table | None:
    """Tabulate the effects of the strongest inputs; None of fewer than two."""
    if len(summary.effects) < 2:
        return None
    significant = {True: Mark("yes", "strong"), False: Mark("no", "quiet")}
    return Table(
        id="effects", title=f"Variance explained by each input alone of: {measure_of(summary.by).text}",
        columns=[
            Column("input", align="text"), Column("first-order index", "%", ".1f"), Column("significant", align="left"),
            Column("rank correlation", form="+.2f"),
        ],
        rows=[
            (one.name, max(one.index, 0.0), significant[one.certain], one.rank) for one in summary.effects[:_EFFECTS]
        ],
        shown=_FEW,
        note="Estimated from the variants as they are. Significant: an input without any effect would hardly reach such an "
        "index. What is missing to 100 % comes from inputs that act together, and from what so "
        "few variants do not show. If some inputs rise and fall together, what they explain in common is counted for the "
        "strongest alone.",
    )  # fmt: skip


def worst_table(summary: StudySummary) -> Table:
    """Tabulate the variants with the largest values of the measure that is looked at most, with their strongest inputs."""
    names = [measure.name for measure in summary.measures]
    # Of accelerations those of bodies, of points or of both.
    measures = [one for one in summary.measures if one.name != "acceleration" or ALL not in names]
    names = list(summary.ranked_inputs[: max(_COLUMNS - len(measures), 2)])
    return Table(
        id="worst-variants", title=f"Worst variants by {measure_of(summary.by).heading}, with the inputs that matter most",
        columns=[
            Column("variant", align="left"),
            *(replace(measure.column, heading=two_lines(measure.heading)) for measure in measures),
            *(Column(two_lines(summary.labels[name]), form=4) for name in names),
        ],
        rows=[
            (
                str(row["variant"]), *(row[measure.name] for measure in measures),
                *(row[name] if isinstance(row[name], float) else str(row[name]) or "none" for name in names),
            )
            for row in summary.worst(_WORST)
        ],
        note=f"Not shown: {', '.join(summary.left_out)}." if summary.left_out else "",
    )  # fmt: skip


def two_lines(name: str) -> str:
    """Break a heading that is long: "mount m16", "axial k1", "[factor]"; "combined", "travel"."""
    name, bracket, unit = name.partition(" [")
    words = name.split(" ")
    if len(name) > _LONG and len(words) > 1:
        half = len(words) // 2
        name = " ".join(words[:half]) + "\n" + " ".join(words[half:])
    return f"{name}\n[{unit}" if bracket else name
