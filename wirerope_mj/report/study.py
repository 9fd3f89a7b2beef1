"""The content of a study's report: what is likely, which inputs matter, which variants are worst."""

import math
from collections.abc import Mapping, Sequence
from typing import Any

import numpy as np

from wirerope_mj.plots.report_image import image_of
from wirerope_mj.plots.study_pictures import study_pictures
from wirerope_mj.report.content import Block, Cell, Listing, Mark, Paragraph, Picture, ReportContent, Section, Table
from wirerope_mj.report.display import ABSENT, fixed, number, several
from wirerope_mj.study.findings import (
    chance,
    headlines,
    input_label,
    input_names,
    measure_of,
    percent,
    quantiles,
    random_study,
    row_of,
    sentences,
    values_of,
    worst,
)
from wirerope_mj.study.result import StudyResult
from wirerope_mj.study.sensitivity import Influence

_QUANTILES = (0.5, 0.9, 0.95, 0.99)
_WORST, _INPUTS, _INFLUENCES, _FAILED = 10, 5, 15, 20  # rows and columns that are read
_METHODS = {
    "sobol": "scrambled Sobol sequence", "latin-hypercube": "Latin hypercube", "random": "random draws",
    "grid": "all combinations of the values",
}  # fmt: skip


def study_content(result: StudyResult, by: str, found: Sequence[Influence]) -> ReportContent:
    """Return the report of a study.

    Args:
        result: of the study, complete.
        by: the measure that is looked at most.
        found: what the inputs do to it.
    """
    study, content = result.study, result.inputs
    motions = " | ".join(motion.description for motion in study.motions)
    question = tuple(" ".join(part.split()) for part in study.question.strip().split("\n\n") if part.strip())
    return ReportContent(
        title=study.name.replace("_", " ").capitalize(),
        facts=(
            ("Model", content["model"]["file"].rpartition("/")[2]),
            ("Base motion", motions),
            ("Variants", f"{result.variants}, {_METHODS.get(study.sampling, study.sampling)}"),
            ("By", f"wirerope-mj {content['versions'].get('wirerope-mj', 'unknown')}"),
        ),
        question=question or ("The study asks no question.",),
        verdict=_verdict(result),
        answer=(Listing(items=tuple(sentences(result))), *_failed(result)),
        sections=(
            Section(title="What varied", blocks=(_varied(content["vary"]),)),
            Section(title="What came out", blocks=(_measures(result, by), *_pictures(result, by, found))),
            Section(title="Inputs that matter", blocks=_influences(by, found)),
            Section(title="Worst variants", blocks=(_worst(result, by, found),)),
            Section(title="Numerics and versions", blocks=(_numerics(result),)),
        ),
    )


def _verdict(result: StudyResult) -> Mark:
    table = result.table
    limits = {name: measure_of(name).limit for name in headlines(table)}
    judged = [chance(values_of(table, name), limit) for name, limit in limits.items() if limit is not None]
    if not judged:
        return Mark(text="Not judged: no limit is stated", tone="unjudged")
    most = max(judged, key=lambda one: one.count)
    if most.count:
        share = f" ({percent(most.count / most.n)})" if random_study(result) else ""
        return Mark(text=f"A limit is exceeded in {most.count} of {most.n} variants{share}", tone="exceeded")
    failed = f"; {several(len(result.failed), 'variant')} failed" if result.failed else ""
    return Mark(text=f"Within the limits in all {most.n} variants{failed}", tone="unjudged" if failed else "within")


def _failed(result: StudyResult) -> tuple[Block, ...]:
    failed = result.failed
    if not failed:
        return ()
    lines = [f"Variant {one}: {message}" for one, message in list(failed.items())[:_FAILED]]
    words = f"{several(len(failed), 'variant')} could not be simulated and stand in no figure:"
    return (Paragraph(text=words), Listing(items=tuple(lines)))


def _varied(vary: Sequence[Mapping[str, Any]]) -> Table:
    rows = tuple((one["name"], _words(one), "each its own" if one.get("each") else "one for all") for one in vary)
    return Table(
        caption="Quantities and their distributions", head=("quantity", "values", "of what the name matches"), align="ltl",
        rows=rows, note="SI units and degrees; factors multiply what the model says.",
    )  # fmt: skip


def _words(one: Mapping[str, Any]) -> str:
    of = "factor, " if one.get("relative") else ""
    if one["kind"] == "Normal":
        bounds = f", from {one.get('low', ABSENT)} to {one.get('high', ABSENT)}" if {"low", "high"} & set(one) else ""
        return f"{of}normal, mean {one['mean']:g}, standard deviation {one['deviation']:g}{bounds}"
    if one["kind"] == "Uniform":
        points = f", {one['points']} values" if "points" in one else ""
        return f"{of}uniform, from {one['low']:g} to {one['high']:g}{points}"
    if one["kind"] == "Choice":
        return f"{of}one of {', '.join(str(value) or 'none' for value in one['choices'])}"
    return "scatter of the specimens that the isolator was identified from"


def _measures(result: StudyResult, by: str) -> Table:
    table, drawn = result.table, random_study(result)
    rows: list[tuple[Cell, ...]] = []
    for name in dict.fromkeys([by, *headlines(table)]):
        shown, values = measure_of(name), values_of(table, name)
        figures = [*(quantiles(values, _QUANTILES) if drawn else []), float(np.nanmax(values))]
        cells: list[Cell] = [shown.label, *(number(shown.factor * value) for value in figures)]
        cells.append(str(worst(table, name, 1)[0]))
        beyond = None if shown.limit is None else chance(values, shown.limit)
        if beyond is None or shown.limit is None:
            cells += [ABSENT, ABSENT]
        else:
            text = f"{beyond.count} of {beyond.n}"
            tone = "exceeded" if beyond.count else "within"
            cells += [number(shown.factor * shown.limit), Mark(text=text, tone=tone)]
        rows.append(tuple(cells))
    shares = [f"{100.0 * q:.0f} %" for q in _QUANTILES] if drawn else []
    head = ("measure", *shares, "largest", "in variant", "limit", "beyond it")
    return Table(
        caption="Measures and their percentiles" if drawn else "Measures", head=head,
        align="l" + "r" * (len(head) - 1), rows=tuple(rows),
        note="A percentile is given if at least five variants lie beyond it." if drawn else "",
    )  # fmt: skip


def _pictures(result: StudyResult, by: str, found: Sequence[Influence]) -> list[Block]:
    return [
        Picture(image=image_of(picture.figure), caption=picture.caption, alt=picture.caption)
        for picture in study_pictures(result, by, found)
    ]


def _influences(by: str, found: Sequence[Influence]) -> tuple[Block, ...]:
    if len(found) < 2:
        return ()
    rows = []
    for one in found[:_INFLUENCES]:
        rank = ABSENT if math.isnan(one.rank) else fixed(one.rank, 2)
        certain = Mark(text="certain", tone="strong") if one.certain else Mark(text="may be chance", tone="quiet")
        rows.append((one.name, f"{fixed(max(100.0 * one.share, 0.0), 1)} %", rank, certain))
    table = Table(
        caption=f"What each input explains of the variance of: {measure_of(by).words}",
        head=("input", "share it explains alone", "rank correlation", ""), align="lrrl", rows=tuple(rows),
        note="Shares are first-order Sobol indices, estimated from the variants as they are; what is missing to 100 % is left "
        "to inputs together and to what so few classes do not resolve. Of several inputs that move together, the strongest "
        "is given what they share.",
    )  # fmt: skip
    return (table,)


def _worst(result: StudyResult, by: str, found: Sequence[Influence]) -> Table:
    table = result.table
    measures = list(dict.fromkeys([by, *headlines(table)]))
    inputs = list(dict.fromkeys([*(one.name for one in found), *input_names(table)]))[:_INPUTS]
    rows = []
    for variant in worst(table, by, _WORST):
        row = row_of(table, variant)
        values = [number(measure_of(name).factor * row[name]) for name in measures]
        rows.append((str(variant), *values, *(_input(row[name]) for name in inputs)))
    head = ("variant", *(f"{name} [{measure_of(name).unit}]" for name in measures), *map(input_label, inputs))
    return Table(
        caption=f"Worst by {by}, with the inputs that matter most", head=head, align="r" * len(head), rows=tuple(rows)
    )


def _input(value: Any) -> str:
    return number(value, digits=4) if isinstance(value, float) else str(value) or "none"


def _numerics(result: StudyResult) -> Table:
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
