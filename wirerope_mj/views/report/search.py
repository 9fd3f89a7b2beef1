"""The content of a search's report: the front and its designs."""

from wirerope_mj.foundation.tables import Mark
from wirerope_mj.studies.results.measure import measure_of
from wirerope_mj.studies.results.statements import travel_statements
from wirerope_mj.studies.results.tables import varied_table
from wirerope_mj.studies.search.result import SearchResult
from wirerope_mj.studies.search.tables import designs_table, front_table
from wirerope_mj.views.display import number, several
from wirerope_mj.views.plots.search import search_pictures
from wirerope_mj.views.report.content import Listing, Paragraph, ReportContent, Section
from wirerope_mj.views.report.study import failed_blocks, motion_text, numerics_table, pictures_of

_ROWS = 40  # designs that are read


def search_content(result: SearchResult) -> ReportContent:
    """Return the report of a search that is complete."""
    study, content = result.study, result.inputs
    question = tuple(" ".join(part.split()) for part in study.question.strip().split("\n\n") if part.strip())
    notes = travel_statements(study.base) if "travel" in result.shown else []
    tables = (front_table(result, _ROWS), designs_table(result, _ROWS)) if result.front.num_rows else ()
    return ReportContent(
        title=study.name.replace("_", " ").capitalize(),
        facts=(
            ("Model", content["model"]["file"].rpartition("/")[2]),
            ("Base motion", motion_text(result)),
            ("Designs", f"{result.variants}, {content['search']['optimiser']}"),
            ("By", f"wirerope-mj {content['versions'].get('wirerope-mj', 'unknown')}"),
        ),
        question=question or ("The search asks no question.",),
        verdict=_verdict(result),
        answer=(Paragraph(text=" ".join([result.message, *notes])), *failed_blocks(result)),
        sections=(
            Section(title="Objectives and limits", blocks=(_sought(result), varied_table(study))),
            Section(title="Results", blocks=(*pictures_of(search_pictures(result)), *tables)),
            Section(title="Numerics and versions", blocks=(numerics_table(result),)),
        ),
    )


def _verdict(result: SearchResult) -> Mark:
    if not result.front.num_rows:
        return Mark(content="No design within the limits was found", tone="exceeded")
    return Mark(content=f"{several(result.front.num_rows, 'design')} on the front, within the limits", tone="within")


def _sought(result: SearchResult) -> Listing:
    items = [f"Least: {measure_of(name).text}." for name in result.minimise]
    for name, largest in result.limits.items():
        measure = measure_of(name)
        items.append(f"Limit: {measure.text} at most {number(measure.factor * largest)} {measure.unit}.")
    return Listing(items=tuple(items))
