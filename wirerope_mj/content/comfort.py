"""Content on human exposure to vibration at points of a run (ISO 2631-1), and on habitability limits of ships (ISO 6954)."""

import math
from collections.abc import Iterator, Mapping, Sequence

import numpy as np

from wirerope_mj.assessment.comfort import (
    RMS_2000,
    WEIGHTINGS,
    Exposure,
    exposure,
    iso_6954_1984,
    iso_6954_2000,
    velocity_lines,
)
from wirerope_mj.assessment.criteria import Verdict
from wirerope_mj.content.blocks import Block, Content, Section, Statement
from wirerope_mj.content.numbers import number
from wirerope_mj.engine.response import Response
from wirerope_mj.foundation.arrays import Array
from wirerope_mj.foundation.tables import Column, Mark, Row, Table, left

# Ranges of the total value in public transport [m/s^2], ISO 2631-1, annex C; they overlap.
_REACTIONS = (
    (0.0, 0.315, "not uncomfortable"), (0.315, 0.63, "a little uncomfortable"), (0.5, 1.0, "fairly uncomfortable"),
    (0.8, 1.6, "uncomfortable"), (1.25, 2.5, "very uncomfortable"), (2.0, np.inf, "extremely uncomfortable"),
)  # fmt: skip
_CREST = 9.0  # peak over rms above which the weighted rms underestimates the effects (ISO 2631-1, 6.2.1)
_HABITABILITY = ("below the lower value", "between the two values", "above the upper value")
_TONES = ("within", "near", "exceeded")


def comfort_content(
    name: str, response: Response, subjects: Sequence[str], *, spaces: Sequence[str] = tuple(RMS_2000), discard: float = 0.0
) -> Content:
    """Compose human exposure at bodies and points of a run, judged for `spaces` of ISO 6954:2000, after `discard` [s].

    ValueError if there is no such body or point, or nothing is left of the run.
    """
    known = {**response.bodies, **response.points}
    missing = [subject for subject in subjects if subject not in known]
    if missing:
        raise ValueError(f"the run has no body or point {missing[0]!r}; it has {', '.join(known)}.")
    histories = {subject: known[subject].acceleration for subject in subjects}
    exposures = {subject: exposure(response.time, values, discard=discard) for subject, values in histories.items()}
    worst = max(exposures, key=lambda subject: exposures[subject].total)
    total = exposures[worst].total
    words = " to ".join(text for low, high, text in _REACTIONS if low <= total < high)
    verdict = Statement(
        "comfort-total",
        f"Total weighted acceleration at {worst}: {number(total)} m/s² rms, {words} (ISO 2631-1, annex C, public transport).",
        values={"total_m_s2": total, "where": worst},
    )

    def build() -> Iterator[Block]:
        yield verdict
        yield _exposure_table(exposures)
        high = [subject for subject, exposed in exposures.items() if bool(np.any(exposed.crest > _CREST))]
        if high:
            text = f"The crest factor exceeds {number(_CREST)} at {', '.join(high)}: the weighted rms says too little there; "
            yield Statement("comfort-crest", text + "use the largest rms over 1 s and the vibration dose.", tone="unjudged")
        yield from _ship_habitability(response.time, histories, spaces, discard)

    return Content(title=f"Comfort: {name}", verdict=verdict, sections=(Section("comfort", "", build, "summary"),))


def _exposure_table(exposures: Mapping[str, Exposure]) -> Table:
    """Tabulate weighted accelerations, crest factor, vibration dose and motion sickness (ISO 2631-1) by subject and axis."""
    rows: list[Row] = []
    for subject, exposed in exposures.items():
        for axis, weighting in enumerate(("Wd", "Wd", "Wk")):
            crest = float(exposed.crest[axis])
            rows.append((
                subject, "xyz"[axis], weighting, float(exposed.rms[axis]),
                None if math.isnan(exposed.running[axis]) else float(exposed.running[axis]), float(exposed.peak[axis]),
                Mark(crest, "near" if crest > _CREST else ""), float(exposed.dose[axis]),
                exposed.sickness if axis == 2 and exposed.duration >= 1.0 / WEIGHTINGS["Wf"].low else None,
            ))  # fmt: skip
    columns = (
        *left("of", "along", "weighting"),
        Column("weighted\nrms", "m/s²"), Column("largest rms\nover 1 s", "m/s²"), Column("weighted\npeak", "m/s²"),
        Column("crest\nfactor", "", "z.1f"), Column("vibration\ndose", "m/s^1.75"), Column("motion\nsickness", "m/s^1.5"),
    )  # fmt: skip
    counted = next(iter(exposures.values())).duration
    return Table(
        "comfort", "What people feel, by ISO 2631-1", columns, rows,
        note=f"Over {number(counted)} s, along the axes of the world. Weightings of ISO 8041; motion sickness by Wf along z.",
    )  # fmt: skip


def _ship_habitability(time: Array, histories: Mapping[str, Array], spaces: Sequence[str], discard: float) -> Iterator[Block]:
    """Judge vibration velocities by both editions of ISO 6954 (ships), or state why the run cannot be judged."""
    rows: list[Row] = []
    try:
        for subject, values in histories.items():
            spectra = [velocity_lines(time, values[:, axis], discard=discard) for axis in range(3)]
            rows.append(_habitability_row("1984", subject, [iso_6954_1984(*lines, subject=subject) for lines in spectra]))
            for space in spaces:
                overall = [
                    iso_6954_2000(time, values[:, axis], subject=subject, space=space, discard=discard)  # type: ignore[arg-type]
                    for axis in range(3)
                ]
                rows.append(_habitability_row(f"2000 {space}", subject, overall))
    except ValueError as error:
        reason = str(error).replace("`time`", "the run")
        text = f"ISO 6954 is not judged: {reason} Simulate for longer, or discard less."
        yield Statement("ship-habitability", text, tone="unjudged")
        return
    columns = (
        *left("ISO 6954", "of", "along"),
        Column("velocity", "mm/s"), Column("lower", "mm/s"), Column("upper", "mm/s"), *left("is"),
    )  # fmt: skip
    note = (
        "1984: peak velocity of the line that uses most of its limit, 1 to 100 Hz. 2000: weighted rms velocity, 1 to 80 Hz; A "
        "passenger cabins, B crew accommodation, C working spaces. Adverse comments are not probable below lower, probable "
        "above upper."
    )
    yield Table("ship-habitability", "Habitability of ships", columns, rows, note=note)


def _habitability_row(edition: str, subject: str, axes: Sequence[Sequence[Verdict]]) -> Row:
    """List the cells of the axis that uses most of the lower limit; `axes` hold the lower and upper verdict of x, y and z."""
    worst = max(range(3), key=lambda axis: axes[axis][0].utilisation or 0.0)
    lower, upper = axes[worst]
    level = (lower.verdict == "exceeded") + (upper.verdict == "exceeded")
    return (edition, subject, "xyz"[worst], lower.value, lower.limit, upper.limit, Mark(_HABITABILITY[level], _TONES[level]))
