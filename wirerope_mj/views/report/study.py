"""The content of a study's report: statistics, the inputs that matter, the worst variants."""

from collections.abc import Sequence

from wirerope_mj.foundation.tables import Column, Mark, Table
from wirerope_mj.studies.result import StudyResult
from wirerope_mj.studies.results.directions import AZIMUTH, ELEVATION
from wirerope_mj.studies.results.measure import input_names
from wirerope_mj.studies.results.stated_limits import limit_statement
from wirerope_mj.studies.results.statements import failures, not_counted, numbered, percent, statements
from wirerope_mj.studies.results.study_summary import StudySummary
from wirerope_mj.studies.results.tables import (
    effects_table,
    indices_tables,
    measures_table,
    varied_table,
    worst_table,
)
from wirerope_mj.views.display import number, several
from wirerope_mj.views.plots.report_image import image_of
from wirerope_mj.views.plots.study_pictures import StudyPicture, study_pictures
from wirerope_mj.views.report.content import Block, Listing, Paragraph, Picture, ReportContent, Section

_WORST, _INPUTS, _EFFECTS, _FAILED = 10, 5, 15, 20  # rows and columns that are read
_METHODS = {
    "sobol": "scrambled Sobol sequence", "latin-hypercube": "Latin hypercube", "random": "random samples",
    "grid": "all combinations of the values", "list": "the values as they are listed",
    "sobol-indices": "Saltelli's matrices of a scrambled Sobol sequence",
}  # fmt: skip


def study_content(summary: StudySummary) -> ReportContent:
    """Return the report of a study that is complete."""
    result = summary.result
    study, content = result.study, result.inputs
    question = tuple(" ".join(part.split()) for part in study.question.strip().split("\n\n") if part.strip())
    return ReportContent(
        title=study.name.replace("_", " ").capitalize(),
        facts=(
            ("Model", content["model"]["file"].rpartition("/")[2]),
            ("Base motion", motion_text(result)),
            ("Variants", f"{result.variants}, {_METHODS.get(study.sampling, study.sampling)}"),
            ("By", f"wirerope-mj {content['versions'].get('wirerope-mj', 'unknown')}"),
        ),
        question=question or ("The study asks no question.",),
        verdict=_verdict(summary),
        answer=(Listing(items=(*_of_stated(summary), *statements(result))), *failed_blocks(result)),
        sections=(
            Section(title="Varied quantities", blocks=(varied_table(study),)),
            Section(title="Results", blocks=(measures_table(summary), *pictures_of(study_pictures(summary)))),
            Section(title="Inputs that matter", blocks=_of_inputs(summary)),
            Section(title="Worst variants", blocks=(worst_table(summary, _WORST, inputs=_INPUTS),)),
            Section(title="Numerics and versions", blocks=(numerics_table(result),)),
        ),
    )


def _of_stated(summary: StudySummary) -> list[str]:
    result = summary.result
    return [limit_statement(one, result.independent, sampled=result.is_sampled) for one in summary.stated]


def _of_inputs(summary: StudySummary) -> tuple[Table, ...]:
    effects = effects_table(summary, _EFFECTS)
    return tuple(indices_tables(summary)) or ((effects,) if effects else ())


def motion_text(result: StudyResult) -> str:
    """Return the base motions of a study, and what of them varies."""
    names = set(input_names(result.table))
    varies = ["direction"] * bool({AZIMUTH, ELEVATION} & names) + ["level"] * ("motion/level" in names)
    motions = " | ".join(motion.description for motion in result.study.motions)
    return f"{motions}; its {' and '.join(varies)} {'vary' if len(varies) > 1 else 'varies'}" if varies else motions


def _verdict(summary: StudySummary) -> Mark:
    judged = summary.judged
    if not judged:
        return Mark(content="Not judged: no limit is stated", tone="unjudged")
    most, ratio = max(judged, key=lambda one: one[0].count)
    failed = not_counted(most)
    if not most.judged:
        return Mark(content=f"Not judged{failed}", tone="unjudged")
    if most.count:
        of = "" if ratio is None else f" ({percent(ratio)}{summary.of_directions})"
        return Mark(content=f"A limit is exceeded in {most.count} of {most.n} variants{of}{failed}", tone="exceeded")
    return Mark(
        content=f"Within the limits in all {most.judged} variants{failed}", tone="unjudged" if failed else "within"
    )


def failed_blocks(result: StudyResult) -> tuple[Block, ...]:
    """Return the variants that failed and their messages; nothing if none did."""
    failed = result.failed
    if not failed:
        return ()
    of_message = list(failures(failed).items())
    lines = [f"{numbered(numbers).capitalize()}: {message}" for message, numbers in of_message[:_FAILED]]
    if len(of_message) > _FAILED:
        lines.append(f"{len(of_message) - _FAILED} other messages: see the column message of the table.")
    stand = "stands" if len(failed) == 1 else "stand"
    text = f"{several(len(failed), 'variant')} could not be simulated and {stand} in no statistic:"
    return (Paragraph(text=text), Listing(items=tuple(lines)))


def pictures_of(pictures: Sequence[StudyPicture]) -> list[Picture]:
    """Return the pictures of a study or a search as those of a page."""
    return [Picture(image=image_of(one.figure), caption=one.caption, alt=one.caption) for one in pictures]


def numerics_table(result: StudyResult) -> Table:
    """Return numerics and versions of a study."""
    content = result.inputs
    simulate, sampling = content["simulate"], content["sampling"]
    rows = [
        ("simulated", f"{simulate['duration']:g} s of each variant, initial state {simulate['initial']}"),
        ("steps", f"at most {number(1e3 * simulate['timestep'], digits=4)} ms, the same for all variants"),
        ("sampling", f"{sampling['method']}, seed {sampling['seed']}"),
        ("study", content["id"]),
    ]
    rows += [(f"version of {name}", str(version)) for name, version in content["versions"].items()]
    return Table(title="Numerics", columns=[Column("item", align="left"), Column("value", align="text")], rows=rows)
