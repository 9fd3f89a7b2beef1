"""The content of a search's report: the front, and how its designs look."""

from wirerope_mj.studies.results.findings import input_names, measure_of
from wirerope_mj.studies.results.sentences import travel_sentences
from wirerope_mj.studies.search.result import GENERATION, SearchResult
from wirerope_mj.views.plots.report_image import image_of
from wirerope_mj.views.plots.search import search_pictures
from wirerope_mj.views.report.content import Listing, Mark, Paragraph, Picture, ReportContent, Section, Table
from wirerope_mj.views.report.display import number, several
from wirerope_mj.views.report.study import failed_blocks, measured, motion_words, numerics_table, varied_table

_ROWS = 40
_EMPTY = 12  # names of empty places that are listed


def search_content(result: SearchResult) -> ReportContent:
    """Return the report of a search that is complete."""
    study, content = result.study, result.inputs
    question = tuple(" ".join(part.split()) for part in study.question.strip().split("\n\n") if part.strip())
    pictures = tuple(
        Picture(image=image_of(picture.figure), caption=picture.caption, alt=picture.caption)
        for picture in search_pictures(result)
    )
    notes = travel_sentences(study.base) if "travel" in result.shown else []
    tables = (_front(result), _designs(result)) if result.front.num_rows else ()
    return ReportContent(
        title=study.name.replace("_", " ").capitalize(),
        facts=(
            ("Model", content["model"]["file"].rpartition("/")[2]),
            ("Base motion", motion_words(result)),
            ("Designs", f"{result.variants}, {content['search']['optimiser']}"),
            ("By", f"wirerope-mj {content['versions'].get('wirerope-mj', 'unknown')}"),
        ),
        question=question or ("The search asks no question.",),
        verdict=_verdict(result),
        answer=(Paragraph(text=" ".join([result.message, *notes])), *failed_blocks(result)),
        sections=(
            Section(title="What was sought", blocks=(_sought(result), varied_table(study))),
            Section(title="What was found", blocks=(*pictures, *tables)),
            Section(title="Numerics and versions", blocks=(numerics_table(result),)),
        ),
    )


def _verdict(result: SearchResult) -> Mark:
    if not result.front.num_rows:
        return Mark(content="No design within the limits was found", tone="exceeded")
    return Mark(content=f"{several(result.front.num_rows, 'design')} on the front, within the limits", tone="within")


def _sought(result: SearchResult) -> Listing:
    items = [f"Least: {measure_of(name).words}." for name in result.minimise]
    for name, largest in result.limits.items():
        measure = measure_of(name)
        items.append(f"Limit: {measure.words} at most {number(measure.factor * largest)} {measure.unit}.")
    return Listing(items=tuple(items))


def _front(result: SearchResult) -> Table:
    measures = [measure_of(name) for name in result.shown]
    rows = []
    for row in result.front.to_pylist()[:_ROWS]:
        values = [measured(measure, measure.factor * row[measure.name]) for measure in measures]
        rows.append((str(row["variant"]), *values, str(row[GENERATION]), result.word(row["variant"])))
    return Table(
        caption="The front: designs within the limits that no other one beats", rows=tuple(rows),
        head=("design", *(measure.label for measure in measures), "generation", ""),
        align="l" + "r" * (len(measures) + 1) + "l",
        note="Other designs of the search may come close to these, and better ones may exist: an evolution proves nothing.",
    )  # fmt: skip


def _designs(result: SearchResult) -> Table:
    """Return what each design of the front is: the places without a mount, and its other inputs."""
    others = [name for name in input_names(result.table) if not name.endswith("/fitted")]
    rows = []
    for row in result.front.to_pylist()[:_ROWS]:
        absent = result.absent(row["variant"])
        words = ", ".join(absent[:_EMPTY]) + (f" and {len(absent) - _EMPTY} more" if len(absent) > _EMPTY else "")
        values = ", ".join(
            f"{name} {row[name]:.4g}" if isinstance(row[name], float) else f"{name} {row[name]}" for name in others
        )
        rows.append((str(row["variant"]), words or "none", values or "-"))
    return Table(
        caption="What these designs are", head=("design", "places without a mount", "other inputs"), align="ltt",
        rows=tuple(rows),
    )  # fmt: skip
