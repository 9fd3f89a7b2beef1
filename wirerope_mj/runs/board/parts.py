"""Parts that the mounts of a board can be: found in the catalogue, and tried in all places by simulation."""

import math
from collections.abc import Callable, Mapping, Sequence
from concurrent.futures import Future
from dataclasses import replace
from functools import cache, partial
from threading import Event
from typing import Any

from wirerope_mj.content.cyclic_tests import isolator_chart
from wirerope_mj.content.verdicts import used_tone
from wirerope_mj.engine.system import System
from wirerope_mj.foundation.arrays import Entries
from wirerope_mj.foundation.errors import ModelError, WireRopeError
from wirerope_mj.foundation.resources import catalogue_folder
from wirerope_mj.motions import BaseMotion
from wirerope_mj.mounts.isolator import Isolator
from wirerope_mj.mounts.vendor_parts import VendorPart, load_isolator, vendor_parts
from wirerope_mj.runs.board.documents import Texts
from wirerope_mj.runs.board.loaded import Loaded
from wirerope_mj.views.board.columns import column_html, fragment

_SHOWN = 30  # parts that are listed at once
_GROUP = 8  # parts that a process tries at once


@cache
def part_names() -> tuple[str, ...]:
    """Name the parts that a mount can be: those of the catalogue, and those of the vendors' tables."""
    shipped = sorted(path.stem for path in catalogue_folder().glob("*.toml"))
    return (*shipped, *(part.name for part in vendor_parts()))


def _found(text: str) -> dict[str, str]:
    """List the parts of the vendors' tables whose names contain a text, as HTML."""
    rows = [_row(part) for part in vendor_parts() if text.lower() in part.name.lower()][:_SHOWN]
    said = "" if rows else f"No part of the vendors' tables is called {text[:40]!r}."
    return {"found": fragment("parts.html.jinja", rows=rows, said=said, running=False)}


def _loops(name: str) -> dict[str, str]:
    """Draw the force-deflection loops of a part as HTML; ModelError if there is no such part, or it has no isolator."""
    if name not in part_names():
        raise ModelError(f"there is no part {name[:40]!r}.")
    try:
        return {"loops": column_html([isolator_chart(load_isolator(name))])}
    except WireRopeError as error:
        raise ModelError(f"{name} has no isolator: {error}") from None


def _row(part: VendorPart, used: float | None = None) -> Entries:
    """Compose the values of a part that the list of parts shows, with its largest utilisation if it was simulated."""
    along, used = part.modes["compression"], None if used is None or math.isnan(used) else used
    return {
        "name": part.name, "height": part.height, "load": along.static_load, "travel": along.travel, "used": used,
        "tone": used_tone(used),
    }  # fmt: skip


SEARCHES: dict[str, Callable[[str], dict[str, str]]] = {"find": _found, "loops": _loops}
"""Functions that return HTML by the id of the element that shows it, by the request that calls each."""


class Trial:
    """Parts simulated in all places under all load cases by other processes, some at a time, and listed by what they use."""

    def __init__(self) -> None:
        self._parts, self._stopped, self._answers = 0, Event(), list[Future[Any]]()
        self._texts: Texts = {}  # that the parts are tried with

    def begin(self, loaded: Loaded, pattern: str) -> Sequence[Future[Any]]:
        """Try the parts whose names match a pattern, in place of those before; ValueError if there is none."""
        from wirerope_mj.studies.catalogue import catalogue  # with its studies, which a board may not need
        from wirerope_mj.studies.engines.local import futures_of_processes

        parts, cases = [*catalogue(pattern or "*").items()], {case.name: case.scenario.motion for case in loaded.job.cases}
        groups = [dict(parts[k : k + _GROUP]) for k in range(0, len(parts), _GROUP)]
        self.stop()
        self._parts, self._texts, self._stopped = len(parts), loaded.texts, Event()
        self._answers = futures_of_processes(partial(_tried, loaded.job.system, cases), groups, self._stopped)
        return self._answers

    def stop(self) -> Sequence[Future[Any]]:
        """End the processes; no further answer is to come."""
        self._stopped.set()
        return ()

    def html(self, texts: Texts) -> str:
        """List the parts simulated so far as HTML, with their number, and a note if `texts` differ from those simulated."""
        done = [each.result() for each in self._answers if each.done() and not each.cancelled() and not each.exception()]
        said, rows = list(dict.fromkeys(answer for answer in done if isinstance(answer, str))), list[Entries]()
        selections = [answer for answer in done if not isinstance(answer, str)]
        tried = [part for selection in selections for part in selection.tried]
        stopped = self._stopped.is_set()
        running = not stopped and not all(answer.done() for answer in self._answers)
        if len(tried) < self._parts:
            said.insert(0, f"{'Stopped: tried' if stopped else 'Tried'} {len(tried)} of {self._parts} parts.")
        if tried and not (running and all(part.reason for part in tried)):
            from wirerope_mj.content.part_selection import catalogue_selection_content

            selection = replace(selections[0], tried=tuple(sorted(tried, key=selections[0].rank)))
            known = {part.name: part for part in vendor_parts()}
            rows = [_row(known[part.name], part.governing[0]) for part in selection.tried if not part.reason][:_SHOWN]
            said.append(catalogue_selection_content(selection, every=False).verdict.text)
        if self._answers and texts != self._texts:
            said.append("All of this is of the position before: what was edited since is not in it.")
        return fragment("parts.html.jinja", rows=rows, said=" ".join(said), running=running)


def _tried(system: System, cases: Mapping[str, BaseMotion], parts: Mapping[str, Isolator | str]) -> Any:
    """Simulate parts in all places under the load cases and rank them; return the reason instead if that fails."""
    from wirerope_mj.studies.catalogue import select_parts

    try:
        selection = select_parts({"": system}, parts, cases)
    except (WireRopeError, ValueError) as error:
        return str(error)
    return replace(selection, tried=tuple(replace(part, system=None) for part in selection.tried))  # which are large
