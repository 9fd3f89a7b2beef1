"""Everything that a plain run can be judged on."""

from collections.abc import Sequence

from wirerope_mj.assessment.criteria.acceleration import acceleration_verdicts
from wirerope_mj.assessment.criteria.bottoming import bottoming_verdicts
from wirerope_mj.assessment.criteria.contact import contact_verdicts
from wirerope_mj.assessment.criteria.mount_load import starting_load_verdicts
from wirerope_mj.assessment.criteria.rattle import rattle_verdicts
from wirerope_mj.assessment.criteria.travel import travel_verdicts
from wirerope_mj.assessment.criteria.verdict import Verdict
from wirerope_mj.engine.response import Response
from wirerope_mj.foundation.payload_limits import PayloadLimit


def judge(response: Response, limits: Sequence[PayloadLimit] | None = None) -> tuple[Verdict, ...]:
    """Return the verdicts on accelerations, travels, bottoming, rattle space, static loads and contacts of a run.

    Args:
        response: of the run.
        limits: of the payload; without them the model's own.
    """
    return (
        *acceleration_verdicts(response, limits),
        *travel_verdicts(response),
        *bottoming_verdicts(response),
        *rattle_verdicts(response, limits),
        *starting_load_verdicts(response),
        *contact_verdicts(response),
    )
