"""The verdicts on a run and its headline, for every output of its folder."""

from collections.abc import Callable
from dataclasses import dataclass
from functools import partial
from typing import TypeVar

from wirerope_mj.assessment.criteria import Verdict, headline, judge
from wirerope_mj.engine.response import Response
from wirerope_mj.engine.statics import StaticTable, static_table
from wirerope_mj.engine.system import System
from wirerope_mj.foundation.absent import Absent
from wirerope_mj.foundation.errors import WireRopeError

Result = TypeVar("Result")


@dataclass(frozen=True, kw_only=True)
class JudgedRun:
    """Verdicts on a run.

    Attributes:
        statics: where the system rests, on the first loading and relaxed.
        verdicts: on everything; static loads on the first loading and relaxed, not those at the start of the run.
    """

    statics: StaticTable | Absent
    verdicts: tuple[Verdict, ...]

    @property
    def headline(self) -> str:
        """The answer in one sentence, as terminal, summary.json, report and recording say it."""
        return headline(self.verdicts)


def judged_run(system: System, response: Response) -> JudgedRun:
    """Return the verdicts on a run of `system`."""
    statics = result_or_absent(partial(static_table, system))
    has_gravity = bool(system.model.opt.gravity.any())  # without a load there is no static load to judge
    known = statics if has_gravity and isinstance(statics, StaticTable) else None
    return JudgedRun(statics=statics, verdicts=judge(response, statics=known))


def result_or_absent(compute: Callable[[], Result]) -> Result | Absent:
    """Return the result, or a sentence that says why there is none: a report shows what can be shown."""
    try:
        return compute()
    except (WireRopeError, ValueError) as error:
        return Absent(reason=str(error))
