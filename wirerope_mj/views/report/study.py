"""The content of a study's report: what is likely, which inputs matter, which variants are worst."""

import math
from typing import Any

from wirerope_mj.studies.result import StudyResult
from wirerope_mj.studies.results.answer import QUANTILES, Answer
from wirerope_mj.studies.results.directions import AZIMUTH, ELEVATION
from wirerope_mj.studies.results.findings import (
    Measure,
    failures,
    input_names,
    measure_of,
    numbered,
    percent,
)
from wirerope_mj.studies.results.sentences import sentences
from wirerope_mj.studies.results.varied import HEAD, varied_of
from wirerope_mj.studies.study import Study
from wirerope_mj.views.plots.report_image import image_of
from wirerope_mj.views.plots.study_pictures import study_pictures
from wirerope_mj.views.report.content import (
    Block,
    Cell,
    Listing,
    Mark,
    Paragraph,
    Picture,
    ReportContent,
    Section,
    Table,
)
from wirerope_mj.views.report.display import ABSENT, fixed, number, several

_WORST, _INPUTS, _INFLUENCES, _FAILED = 10, 5, 15, 20  # rows and columns that are read
_METHODS = {
    "sobol": "scrambled Sobol sequence", "latin-hypercube": "Latin hypercube", "random": "random draws",
    "grid": "all combinations of the values", "list": "the values as they are listed",
    "sobol-indices": "Saltelli's matrices of a scrambled Sobol sequence",
}  # fmt: skip


def study_content(answer: Answer) -> ReportContent:
    """Return the report of a study that is complete."""
    result = answer.result
    study, content = result.study, result.inputs
    question = tuple(" ".join(part.split()) for part in study.question.strip().split("\n\n") if part.strip())
    return ReportContent(
        title=study.name.replace("_", " ").capitalize(),
        facts=(
            ("Model", content["model"]["file"].rpartition("/")[2]),
            ("Base motion", motion_words(result)),
            ("Variants", f"{result.variants}, {_METHODS.get(study.sampling, study.sampling)}"),
            ("By", f"wirerope-mj {content['versions'].get('wirerope-mj', 'unknown')}"),
        ),
        question=question or ("The study asks no question.",),
        verdict=_verdict(answer),
        answer=(Listing(items=tuple(sentences(result))), *failed_blocks(result)),
        sections=(
            Section(title="What varied", blocks=(varied_table(study),)),
            Section(title="What came out", blocks=(_measures(answer), *_pictures(answer))),
            Section(title="Inputs that matter", blocks=_indices(answer) or _influences(answer)),
            Section(title="Worst variants", blocks=(_worst(answer),)),
            Section(title="Numerics and versions", blocks=(numerics_table(result),)),
        ),
    )


def motion_words(result: StudyResult) -> str:
    """Return the base motions of a study, and what of them varies."""
    names = set(input_names(result.table))
    varies = ["direction"] * bool({AZIMUTH, ELEVATION} & names) + ["level"] * ("motion/level" in names)
    motions = " | ".join(motion.description for motion in result.study.motions)
    return f"{motions}; its {' and '.join(varies)} {'vary' if len(varies) > 1 else 'varies'}" if varies else motions


def _verdict(answer: Answer) -> Mark:
    judged = [(figures.beyond, figures.share) for figures in answer.figures if figures.beyond is not None]
    if not judged:
        return Mark(content="Not judged: no limit is stated", tone="unjudged")
    most, share = max(judged, key=lambda one: one[0].count)
    failed = f"; {several(most.failed, 'more variant')} failed" if most.failed else ""
    if most.count:
        of = "" if share is None else f" ({percent(share)}{answer.share_words})"
        return Mark(content=f"A limit is exceeded in {most.count} of {most.n} variants{of}{failed}", tone="exceeded")
    return Mark(content=f"Within the limits in all {most.n} variants{failed}", tone="unjudged" if failed else "within")


def failed_blocks(result: StudyResult) -> tuple[Block, ...]:
    """Return which variants failed, and why; nothing if none did."""
    failed = result.failed
    if not failed:
        return ()
    of_message = list(failures(result).items())
    lines = [f"{_capital(numbered(numbers))}: {message}" for message, numbers in of_message[:_FAILED]]
    if len(of_message) > _FAILED:
        lines.append(f"{len(of_message) - _FAILED} other messages: see the column message of the table.")
    stand = "stands" if len(failed) == 1 else "stand"
    words = f"{several(len(failed), 'variant')} could not be simulated and {stand} in no figure:"
    return (Paragraph(text=words), Listing(items=tuple(lines)))


def varied_table(study: Study) -> Table:
    """Return the quantities that vary with their kinds and units, what the model says of them, and their distributions."""
    return Table(
        caption="Quantities and their distributions", head=HEAD, align="tlttl",
        rows=tuple(one.cells for one in varied_of(study)),
        note="A value replaces what the model says, a shift is added to it, a factor multiplies it. SI: as the law states.",
    )  # fmt: skip


def _measures(answer: Answer) -> Table:
    rows = []
    for one in answer.figures:
        label = one.measure.label
        cells: list[Cell] = [label if "/" in one.measure.name else f"{one.measure.name.replace('_', ' ')}: {label}"]
        shown = [*(one.quantiles if answer.drawn else ()), one.largest]
        cells += [measured(one.measure, value) for value in shown]
        cells.append(str(one.variant))
        if one.beyond is None or one.limit is None:
            cells += [ABSENT, ABSENT]
        else:
            tone = "exceeded" if one.beyond.count else "within"
            cells += [number(one.limit), Mark(content=one.beyond_words, tone=tone)]
        rows.append(tuple(cells))
    shares = [f"{100.0 * q:.0f} %" for q in QUANTILES] if answer.drawn else []
    head = ("measure", *shares, "largest", "in variant", "limit", "beyond it")
    return Table(
        caption="Measures and their percentiles" if answer.drawn else "Measures", head=head,
        align="l" + "r" * (len(head) - 1), rows=tuple(rows),
        note="A percentile is given if at least five variants lie beyond it." if answer.drawn else "",
    )  # fmt: skip


def _pictures(answer: Answer) -> list[Block]:
    return [
        Picture(image=image_of(picture.figure), caption=picture.caption, alt=picture.caption)
        for picture in study_pictures(answer)
    ]


def _indices(answer: Answer) -> tuple[Block, ...]:
    tables = []
    for found in answer.indices:
        rows = []
        for one in found.factors:
            cells = []
            for index, (low, high) in ((one.first, one.first_interval), (one.total, one.total_interval)):
                cells += [f"{fixed(100.0 * index, 1)} %", f"{fixed(100.0 * low, 1)} to {fixed(100.0 * high, 1)} %"]
            rows.append((one.name, *cells))
        dropped = f"; {found.dropped} more were dropped, because variants of them failed" if found.dropped else ""
        tables.append(
            Table(
                caption=f"What explains the variance of: {measure_of(found.measure).words}",
                head=("factor", "alone", "interval", "with others", "interval"),
                align="lrrrr",
                rows=tuple(rows),
                note="Sobol's first-order and total indices with bounds of 95 % confidence (bootstrap) from "
                f"{several(found.rows, 'base row')}{dropped}. A factor may be several quantities of one group. "
                f"Below 0 an index is chance.{' So few base rows say nothing: take more.' if found.too_few else ''}",
            )  # fmt: skip
        )
    return tuple(tables)


def _influences(answer: Answer) -> tuple[Block, ...]:
    found = answer.influences
    if len(found) < 2:
        return ()
    rows = []
    for one in found[:_INFLUENCES]:
        rank = ABSENT if math.isnan(one.rank) else fixed(one.rank, 2)
        certain = Mark(content="certain", tone="strong") if one.certain else Mark(content="may be chance", tone="quiet")
        rows.append((one.name, f"{fixed(max(100.0 * one.share, 0.0), 1)} %", certain, rank))
    table = Table(
        caption=f"What each input explains of the variance of: {measure_of(answer.by).words}",
        head=("input", "share it explains alone", "and this share is", "rank correlation"), align="lrlr", rows=tuple(rows),
        note="Shares are first-order Sobol indices, estimated from the variants as they are; what is missing to 100 % is left "
        "to inputs together and to what so few classes do not resolve. Of several inputs that move together, the strongest "
        "is given what they share.",
    )  # fmt: skip
    return (table,)


def _worst(answer: Answer) -> Table:
    measures = answer.measures
    rows = []
    for one in answer.worst(_WORST, inputs=_INPUTS):
        values = [measured(measure, value) for measure, value in zip(measures, one.values, strict=True)]
        rows.append((str(one.variant), *values, *(_input(value) for value in one.inputs)))
    heads = (f"{measure.name} [{measure.unit}]" for measure in measures)
    head = ("variant", *heads, *(answer.labels[name] for name in answer.inputs(_INPUTS)))
    return Table(
        caption=f"Worst by {answer.by}, with the inputs that matter most", head=head, align="r" * len(head),
        rows=tuple(rows), note=f"Not shown: {', '.join(answer.left_out)}." if answer.left_out else "",
    )  # fmt: skip


def measured(measure: Measure, value: float) -> str:
    """Return a value in the unit in which its measure is shown; a count has no digits behind the point."""
    return str(int(value)) if measure.unit == "-" and value.is_integer() else number(value)


def _capital(words: str) -> str:
    return words[0].upper() + words[1:]


def _input(value: Any) -> str:
    return number(value, digits=4) if isinstance(value, float) else str(value) or "none"


def numerics_table(result: StudyResult) -> Table:
    """Return how a study was computed, and with which versions."""
    content = result.inputs
    simulate, sampling = content["simulate"], content["sampling"]
    rows = [
        ("simulated", f"{simulate['duration']:g} s of each variant, initial state {simulate['initial']}"),
        ("steps", f"at most {number(1e3 * simulate['timestep'], digits=4)} ms, the same for all variants"),
        ("sampling", f"{sampling['method']}, seed {sampling['seed']}"),
        ("study", content["id"]),
    ]
    rows += [(f"version of {name}", str(version)) for name, version in content["versions"].items()]
    return Table(caption="How it was computed", head=("what", "value"), align="lt", rows=tuple(rows))
