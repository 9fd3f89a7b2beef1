"""Verdicts on what a run is judged on without being told more than its response and the limits of model and isolators."""

from collections.abc import Sequence

from wirerope_mj.assessment.criteria.acceleration import acceleration_verdicts
from wirerope_mj.assessment.criteria.ended import require_over
from wirerope_mj.assessment.criteria.headline import Verdicts
from wirerope_mj.assessment.criteria.loads import (
    contact_verdicts,
    missing_load_verdicts,
    starting_load_verdicts,
    static_load_verdicts,
)
from wirerope_mj.assessment.criteria.rattle import rattle_verdicts
from wirerope_mj.assessment.criteria.travel import bottoming_verdicts, travel_verdicts
from wirerope_mj.assessment.criteria.verdict import Verdict
from wirerope_mj.engine.response import Response
from wirerope_mj.engine.statics import StaticTable
from wirerope_mj.foundation.payload_limits import PayloadLimit


def judge(
    response: Response, limits: Sequence[PayloadLimit] | None = None, *, statics: StaticTable | None = None
) -> tuple[Verdict, ...]:
    """Return the verdicts on accelerations, travels, bottoming, rattle space, static loads and contacts of a run.

    Where the run ends before its peaks are over, only what is exceeded already is judged of them.

    Args:
        response: of the run.
        limits: of the payload; without them the model's own.
        statics: of the system; with it static loads are judged on the first loading and relaxed, last of all, and not those
            at the start of the run.
    """
    begin = require_over(
        response,
        (
            *acceleration_verdicts(response, limits),
            *travel_verdicts(response),
            *bottoming_verdicts(response),
            *rattle_verdicts(response, limits),
        ),
    )
    contacts = require_over(response, contact_verdicts(response))
    if statics is None:
        return Verdicts((*begin, *starting_load_verdicts(response), *contacts))
    return Verdicts((*begin, *contacts, *static_load_verdicts(statics), *missing_load_verdicts(statics)))
