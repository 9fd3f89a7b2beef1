"""Criteria by which a response is judged: each gives a value, its limit, the margin and a verdict; and all of them together."""

from wirerope_mj.assessment.criteria.judge import headline, judge
from wirerope_mj.assessment.criteria.loads import (
    closing_text,
    contact_verdicts,
    rested_verdicts,
    starting_load_verdicts,
    static_load_verdicts,
)
from wirerope_mj.assessment.criteria.payload import acceleration_verdicts, rattle_verdicts, spectrum_verdict
from wirerope_mj.assessment.criteria.random import judge_random, random_verdicts, stationary_verdicts
from wirerope_mj.assessment.criteria.summary import BodyPeak, MountPeak, body_peaks, mount_peaks, summary, verdict_lines
from wirerope_mj.assessment.criteria.travel import bottoming_verdicts, rest_travel_verdicts, travel_verdicts
from wirerope_mj.assessment.criteria.verdict import (
    CLEAR,
    COMBINED,
    EXCEEDED,
    NOT_JUDGED,
    STOP,
    STRUCK,
    TOUCHING,
    WITHIN,
    Criterion,
    Verdict,
)
