"""Parts that the mounts of a board can be: found in the catalogue, and tried in all places by simulation."""

import math
from functools import cache

from wirerope_mj.content.blocks import Chart
from wirerope_mj.content.cyclic_tests import isolator_chart
from wirerope_mj.foundation.errors import ModelError, WireRopeError
from wirerope_mj.foundation.resources import catalogue_folder
from wirerope_mj.mounts.vendor_parts import VendorPart, load_isolator, vendor_parts
from wirerope_mj.runs.board.loaded import Loaded
from wirerope_mj.views.board.columns import PartRow, parts_html

_SHOWN = 30  # parts that are listed at once


@cache
def part_names() -> tuple[str, ...]:
    """Name the parts that a mount can be: those of the catalogue, and those of the vendors' tables."""
    shipped = sorted(path.stem for path in catalogue_folder().glob("*.toml"))
    return (*shipped, *(part.name for part in vendor_parts()))


def found_html(text: str) -> str:
    """List the parts of the vendors' tables whose names hold a text."""
    rows = [_row(part) for part in vendor_parts() if text.lower() in part.name.lower()]
    return parts_html(rows[:_SHOWN], said="" if rows else f"No part of the vendors' tables is called {text[:40]!r}.")


def tried_html(loaded: Loaded, pattern: str) -> str:
    """Simulate every part whose name matches a pattern in all places under all load cases, and list them by what they use.

    ValueError if no name matches; ModelError if the model has no mounts.
    """
    from wirerope_mj.content.part_selection import catalogue_selection_content  # with its studies, which a board may not need
    from wirerope_mj.studies.catalogue import catalogue, select_parts

    cases = {case.name: case.scenario.motion for case in loaded.job.cases}
    selection = select_parts({"": loaded.job.system}, catalogue(pattern or "*"), cases)
    known = {part.name: part for part in vendor_parts()}
    rows = [_row(known[part.name], part.governing[0]) for part in selection.tried if not part.reason]
    return parts_html(rows[:_SHOWN], said=catalogue_selection_content(selection, every=False).verdict.text)


def loops_of(name: str) -> Chart:
    """Draw the loops of a part; ModelError if it is none, or has no isolator."""
    if name not in part_names():
        raise ModelError(f"there is no part {name[:40]!r}.")
    try:
        return isolator_chart(load_isolator(name))
    except WireRopeError as error:
        raise ModelError(f"{name} has no isolator: {error}") from None


def _row(part: VendorPart, used: float = math.nan) -> PartRow:
    along = part.modes["compression"]
    return PartRow(part.name, part.height, along.static_load, along.travel, None if math.isnan(used) else used)
