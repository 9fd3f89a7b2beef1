"""The verdicts on a run and its headline, for every output of its folder."""

import math
from collections.abc import Callable
from dataclasses import dataclass
from functools import partial
from typing import TypeVar

from wirerope_mj.assessment.criteria import Verdict, judge
from wirerope_mj.assessment.criteria.mount_load import starting_load_verdicts
from wirerope_mj.assessment.criteria.static_load import static_load_verdicts
from wirerope_mj.assessment.verdicts import headline
from wirerope_mj.engine.response import Response
from wirerope_mj.engine.statics import StaticTable, static_table
from wirerope_mj.engine.system import System
from wirerope_mj.foundation.errors import WireRopeError
from wirerope_mj.views.report import Absent

Found = TypeVar("Found")


@dataclass(frozen=True, kw_only=True)
class JudgedRun:
    """What a run is judged on.

    Attributes:
        statics: where the system rests, on the first loading and relaxed.
        verdicts: every judged figure; static loads on the first loading and relaxed, not those at the start of the run.
    """

    statics: StaticTable | Absent
    verdicts: tuple[Verdict, ...]

    @property
    def headline(self) -> str:
        """The answer in one sentence, as terminal, summary.json, report and recording say it."""
        return headline(self.verdicts)


def judged_run(system: System, response: Response) -> JudgedRun:
    """Return the verdicts on a run of `system`."""
    statics = found_or_absent(partial(static_table, system))
    has_gravity = bool(system.model.opt.gravity.any())  # without a load there is no static load to judge
    return JudgedRun(statics=statics, verdicts=run_verdicts(response, statics if has_gravity else None))


def found_or_absent(compute: Callable[[], Found]) -> Found | Absent:
    """Return what is computed, or a sentence that says why there is none: a report shows what can be shown."""
    try:
        return compute()
    except (WireRopeError, ValueError) as error:
        return Absent(reason=str(error))


def run_verdicts(response: Response, statics: StaticTable | Absent | None) -> tuple[Verdict, ...]:
    """Return the verdicts on a run; static loads on the first loading and relaxed, where these are known, not at its start."""
    found = judge(response)
    if not isinstance(statics, StaticTable):
        return found
    missing = [
        Verdict(
            criterion=f"static load in compression, {history}",
            subject="every mount",
            value=math.nan,
            limit=None,
            unit="N",
            note=reason.rstrip("."),
        )
        for history, reason in statics.missing.items()
    ]
    start = {verdict.criterion for verdict in starting_load_verdicts(response)}
    return (*(verdict for verdict in found if verdict.criterion not in start), *static_load_verdicts(statics), *missing)
