"""The content of a search's report: the front and its designs."""

from wirerope_mj.content.blocks import Content, Section, Statement
from wirerope_mj.content.numbers import number, several
from wirerope_mj.content.search_tables import designs_table, front_table
from wirerope_mj.content.study_tables import varied_table
from wirerope_mj.studies.results.measure import measure_of
from wirerope_mj.studies.results.statements import travel_statements
from wirerope_mj.studies.search.result import SearchResult
from wirerope_mj.views.plots.search import search_pictures
from wirerope_mj.views.report.study import failed_blocks, motion_text, numerics_table, pictures_of

_ROWS = 40  # designs that are read


def search_content(result: SearchResult) -> Content:
    """Return the report of a search that is complete."""
    study, content = result.study, result.inputs
    question = tuple(" ".join(part.split()) for part in study.question.strip().split("\n\n") if part.strip())
    notes = travel_statements(study.base) if "travel" in result.shown else []
    tables = (front_table(result, _ROWS), designs_table(result, _ROWS)) if result.front.num_rows else ()
    return Content(
        title=study.name.replace("_", " ").capitalize(),
        facts=(
            ("Model", content["model"]["file"].rpartition("/")[2]),
            ("Base motion", motion_text(result)),
            ("Designs", f"{result.variants}, {content['search']['optimiser']}"),
            ("By", f"wirerope-mj {content['versions'].get('wirerope-mj', 'unknown')}"),
        ),
        question=question or ("The search asks no question.",),
        verdict=_verdict(result),
        sections=(
            Section(
                id="answer",
                title="",
                build=lambda: (Statement(text=" ".join([result.message, *notes])), *failed_blocks(result)),
            ),
            Section(
                id="objectives-and-limits",
                title="Objectives and limits",
                build=lambda: (_sought(result), varied_table(study)),
            ),
            Section(id="results", title="Results", build=lambda: (*pictures_of(search_pictures(result)), *tables)),
            Section(id="numerics-and-versions", title="Numerics and versions", build=lambda: (numerics_table(result),)),
        ),
    )


def _verdict(result: SearchResult) -> Statement:
    if not result.front.num_rows:
        return Statement(id="headline", text="No design within the limits was found", tone="exceeded")
    return Statement(
        id="headline", text=f"{several(result.front.num_rows, 'design')} on the front, within the limits", tone="within"
    )


def _sought(result: SearchResult) -> Statement:
    items = [f"Least: {measure_of(name).text}." for name in result.minimise]
    for name, largest in result.limits.items():
        measure = measure_of(name)
        items.append(f"Limit: {measure.text} at most {number(measure.factor * largest)} {measure.unit}.")
    return Statement(items=tuple(items))
