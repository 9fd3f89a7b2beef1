"""Tables of a search's results, the same on the screen, on a page and in a recording."""

from wirerope_mj.foundation.tables import Column, Table
from wirerope_mj.studies.results.measure import input_names, measure_of
from wirerope_mj.studies.search.result import GENERATION, SearchResult

_EMPTY = 12  # names of mounts that are not fitted and listed


def front_table(result: SearchResult, most: int) -> Table:
    """Return the designs that were given, and those of the front."""
    measures = [measure_of(name) for name in result.shown]
    rows = result.table.slice(0, result.start).to_pylist() + result.front.to_pylist()
    return Table(
        title="The front: designs within the limits that no other one beats",
        columns=[
            Column("design", align="left"),
            *(measure.column for measure in measures),
            Column("generation"),
            Column("", align="left"),
        ],
        rows=[
            (
                str(row["variant"]),
                *(row[measure.name] for measure in measures),
                str(row[GENERATION]),
                result.remark(row["variant"]),
            )
            for row in list({row["variant"]: row for row in rows}.values())[:most]
        ],
        note="Other designs of the search may come close to these, and better ones may exist: an evolution proves nothing.",
    )


def designs_table(result: SearchResult, most: int) -> Table:
    """Return each design of the front: the mounts that are not fitted, and its other inputs."""
    others = [name for name in input_names(result.table) if not name.endswith("/fitted")]
    rows = []
    for row in result.front.to_pylist()[:most]:
        absent = result.absent(row["variant"])
        names = ", ".join(absent[:_EMPTY]) + (f" and {len(absent) - _EMPTY} more" if len(absent) > _EMPTY else "")
        values = (f"{row[name]:.4g}" if isinstance(row[name], float) else str(row[name]) for name in others)
        inputs = ", ".join(f"{name} {value}" for name, value in zip(others, values, strict=True))
        rows.append((str(row["variant"]), names or "none", inputs or "-"))
    return Table(
        title="These designs",
        columns=[
            Column("design", align="left"),
            Column("places without a mount", align="text"),
            Column("other inputs", align="text"),
        ],
        rows=rows,
    )
