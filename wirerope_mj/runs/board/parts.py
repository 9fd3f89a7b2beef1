"""Parts that the mounts of a board can be: found in the catalogue, and tried in all places by simulation."""

import math
from collections.abc import Callable
from functools import cache

from wirerope_mj.content.cyclic_tests import isolator_chart
from wirerope_mj.foundation.arrays import Entries
from wirerope_mj.foundation.errors import ModelError, WireRopeError
from wirerope_mj.foundation.resources import catalogue_folder
from wirerope_mj.mounts.vendor_parts import VendorPart, load_isolator, vendor_parts
from wirerope_mj.runs.board.loaded import Loaded
from wirerope_mj.views.board.columns import column_html, fragment

_SHOWN = 30  # parts that are listed at once


@cache
def part_names() -> tuple[str, ...]:
    """Name the parts that a mount can be: those of the catalogue, and those of the vendors' tables."""
    shipped = sorted(path.stem for path in catalogue_folder().glob("*.toml"))
    return (*shipped, *(part.name for part in vendor_parts()))


def _found(loaded: Loaded, text: str) -> dict[str, str]:
    """List the parts of the vendors' tables whose names hold a text."""
    rows = [_row(part) for part in vendor_parts() if text.lower() in part.name.lower()][:_SHOWN]
    return {
        "found": fragment(
            "parts.html.jinja", rows=rows, said="" if rows else f"No part of the vendors' tables is called {text[:40]!r}."
        )
    }


def _tried(loaded: Loaded, pattern: str) -> dict[str, str]:
    """Simulate every part whose name matches a pattern in all places under all load cases, and list them by what they use.

    ValueError if no name matches; ModelError if the model has no mounts.
    """
    from wirerope_mj.content.part_selection import catalogue_selection_content  # with its studies, which a board may not need
    from wirerope_mj.studies.catalogue import catalogue, select_parts

    cases = {case.name: case.scenario.motion for case in loaded.job.cases}
    selection = select_parts({"": loaded.job.system}, catalogue(pattern or "*"), cases)
    known = {part.name: part for part in vendor_parts()}
    rows = [_row(known[part.name], part.governing[0]) for part in selection.tried if not part.reason][:_SHOWN]
    said = catalogue_selection_content(selection, every=False).verdict.text
    return {"found": fragment("parts.html.jinja", rows=rows, said=said)}


def _loops(loaded: Loaded, name: str) -> dict[str, str]:
    """Draw the loops of a part; ModelError if it is none, or has no isolator."""
    if name not in part_names():
        raise ModelError(f"there is no part {name[:40]!r}.")
    try:
        return {"loops": column_html([isolator_chart(load_isolator(name))])}
    except WireRopeError as error:
        raise ModelError(f"{name} has no isolator: {error}") from None


def _row(part: VendorPart, used: float | None = None) -> Entries:
    """Compose what the template of parts takes of one, with the use of its most critical limit if it was simulated."""
    along = part.modes["compression"]
    return {
        "name": part.name, "height": part.height, "load": along.static_load, "travel": along.travel,
        "used": None if used is None or math.isnan(used) else used,
        "tone": "" if used is None or math.isnan(used) else "exceeded" if used > 1.0 else "within",
    }  # fmt: skip


# Searches by what asks for them: what gives HTML by the element that shows it, what is said before it, and after it
SEARCHES: dict[str, tuple[Callable[[Loaded, str], dict[str, str]], str, str]] = {
    "find": (_found, "", ""), "loops": (_loops, "", ""),
    "try-parts": (_tried, "Simulating every part in all places ...", "Parts are listed by what they use."),
}  # fmt: skip
