"""What a study says: how often limits are exceeded, the inputs that matter, the worst variants."""

from collections.abc import Iterator

from wirerope_mj.content.blocks import Block, Content, Section, Statement
from wirerope_mj.content.credibility import study_credibility_blocks
from wirerope_mj.content.numbers import several, with_unit
from wirerope_mj.content.study_charts import study_charts
from wirerope_mj.content.study_statements import (
    failures,
    limit_statement,
    not_counted,
    numbered,
    percent,
    statements,
)
from wirerope_mj.content.study_tables import (
    effects_table,
    indices_tables,
    measures_table,
    varied_table,
    worst_table,
)
from wirerope_mj.foundation.tables import Column, Table
from wirerope_mj.studies.result import StudyResult
from wirerope_mj.studies.results.effects import AZIMUTH, ELEVATION
from wirerope_mj.studies.results.measure import input_names
from wirerope_mj.studies.results.study_summary import StudySummary

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
            Section(id="answer", title="", build=lambda: _answer(summary), depth="headline"),
            Section(id="varied", title="Varied quantities", build=lambda: (varied_table(study),)),
            Section(
                id="results", title="Results", build=lambda: (measures_table(summary), *study_charts(summary)),
                depth="summary",
            ),
            Section(id="inputs", title="Inputs that matter", build=lambda: _of_inputs(summary), depth="summary"),
            Section(id="worst", title="Worst variants", build=lambda: (worst_table(summary),), depth="summary"),
            Section(
                id="credibility", title="How far this can be relied on", build=lambda: study_credibility_blocks(result)
            ),
            Section(id="numerics", title="Numerics and versions", build=lambda: (numerics_table(result),)),
        ),
    )  # fmt: skip


def study_facts(result: StudyResult, things: str, how: str) -> tuple[tuple[str, str], ...]:
    """Return what stands below the title of a study or a search."""
    content = result.inputs
    return (
        ("Model", content["model"]["file"].rpartition("/")[2]),
        ("Base motion", _motion_text(result)),
        (things, f"{result.variants}, {how}"),
        ("By", f"wirerope-mj {content['versions'].get('wirerope-mj', 'unknown')}"),
    )


def study_question(result: StudyResult, kind: str) -> tuple[str, ...]:
    """Return what a study or a search asks, a text for each paragraph."""
    paragraphs = result.study.question.strip().split("\n\n")
    asked = tuple(" ".join(part.split()) for part in paragraphs if part.strip())
    return asked or (f"The {kind} asks no question.",)


def _motion_text(result: StudyResult) -> str:
    """Return the base motions of a study, and what of them varies."""
    names = set(input_names(result.table))
    varies = ["direction"] * bool({AZIMUTH, ELEVATION} & names) + ["level"] * ("motion/level" in names)
    motions = " | ".join(motion.description for motion in result.study.motions)
    return f"{motions}; its {' and '.join(varies)} {'vary' if len(varies) > 1 else 'varies'}" if varies else motions


def _verdict(summary: StudySummary) -> Statement:
    judged = summary.judged
    if not judged:
        return Statement(id="headline", text="Not judged: no limit is stated", tone="unjudged")
    most, ratio = max(judged, key=lambda one: one[0].count)
    rest = not_counted(most)
    if not most.judged:
        return Statement(id="headline", text=f"Not judged{rest}", tone="unjudged")
    values = {"beyond": float(most.count), "of": float(most.n), "ratio": ratio}
    if most.count:
        of = "" if ratio is None else f" ({percent(ratio)}{summary.of_directions})"
        text = f"A limit is exceeded in {most.count} of {most.n} variants{of}{rest}"
        return Statement(id="headline", text=text, tone="exceeded", values=values)
    text, tone = f"Within the limits in all {most.judged} variants{rest}", "unjudged" if rest else "within"
    return Statement(id="headline", text=text, tone=tone, values=values)


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


def _of_inputs(summary: StudySummary) -> tuple[Table | None, ...]:
    return tuple(indices_tables(summary)) or (effects_table(summary),)


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
