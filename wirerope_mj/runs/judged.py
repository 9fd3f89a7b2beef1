"""The verdicts on a run and its headline, for every output of its folder."""

import math
from collections.abc import Callable
from dataclasses import dataclass
from functools import partial
from typing import TypeVar

from wirerope_mj.assessment.criteria import Verdict, headline, judge, judge_random
from wirerope_mj.assessment.criteria.sampled import SAMPLED
from wirerope_mj.assessment.criteria.steady import steady_interval
from wirerope_mj.assessment.criteria.tested import falling_line, untested_line
from wirerope_mj.engine.response import Response
from wirerope_mj.engine.statics import StaticTable, model_warnings, static_table
from wirerope_mj.engine.system import System
from wirerope_mj.foundation.errors import Absent, WireRopeError

Result = TypeVar("Result")


@dataclass(frozen=True, kw_only=True)
class JudgedRun:
    """Verdicts on a run.

    Attributes:
        statics: where the system rests, on the first loading and relaxed.
        verdicts: on everything; static loads on the first loading and relaxed, not those at the start of the run.
        random: rms and 3-sigma acceleration of everything on the payload, where the base vibrates at random and does nothing
            else; those of them with a limit are among the verdicts. Absent where the run is too short for them.
        untested: a sentence on the mounts that leave what their laws were identified from; "" where none does.
        model_warnings: what the model says that is perhaps not meant, see `wirerope_mj.engine.statics.model_warnings`.
    """

    statics: StaticTable | Absent
    verdicts: tuple[Verdict, ...]
    random: tuple[Verdict, ...] | Absent = ()
    untested: str = ""
    model_warnings: tuple[str, ...] = ()

    @property
    def headline(self) -> str:
        """The answer in one sentence, as terminal, summary.json, report and recording say it."""
        return headline(self.verdicts)


def judged_run(system: System, response: Response) -> JudgedRun:
    """Return the verdicts on a run of `system`."""
    statics = result_or_absent(partial(static_table, system))
    has_gravity = bool(system.model.opt.gravity.any())  # without a load there is no static load to judge
    known = statics if has_gravity and isinstance(statics, StaticTable) else None
    random = result_or_absent(partial(_random, response))
    rows = () if isinstance(random, Absent) else random
    limited = tuple(row for row in rows if row.limit is not None or row.note.startswith(SAMPLED))
    isolators = {name: mount.isolator for name, mount in system.mounts.items()}
    return JudgedRun(
        statics=statics,
        verdicts=(*judge(response, statics=known), *limited),
        random=random,
        untested=" ".join(filter(None, (untested_line(isolators, response), falling_line(isolators, response)))),
        model_warnings=model_warnings(system),
    )


def _random(response: Response) -> tuple[Verdict, ...]:
    """Return rms and 3-sigma values; the largest of every step is among the other verdicts."""
    alone, first, _ = steady_interval(response.motion)
    if not alone or first == -math.inf:
        return ()
    return tuple(row for row in judge_random(response) if not row.criterion.startswith("largest"))


def result_or_absent(compute: Callable[[], Result]) -> Result | Absent:
    """Return the result, or a sentence that says why there is none: a report shows what can be shown."""
    try:
        return compute()
    except (WireRopeError, ValueError) as error:
        return Absent(reason=str(error))
