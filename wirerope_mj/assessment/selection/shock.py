"""The one shock of a worksheet: a pulse, a velocity change or a fall, or a text that says it."""

import math
import re

from wirerope_mj.assessment.selection.worksheet import WORKSHEET_GRAVITY, Shock
from wirerope_mj.foundation.arguments import between, positive
from wirerope_mj.motions import HalfSine, Sawtooth, Trapezoid, VelocityStep, ranges

_RISE = 0.1  # Rise and fall of a trapezoid over its length, as the shock standards draw it
_PULSE = re.compile(r"([-+.\deE]+)\s*g[\s,]+([-+.\deE]+)\s*ms[\s,]+([a-z][a-z -]*)", re.IGNORECASE)
_STEP = re.compile(r"([-+.\deE]+)\s*m/s", re.IGNORECASE)
_EXAMPLES = '"15 g 11 ms half-sine", "20 g 11 ms sawtooth", "10 g 18 ms trapezoid" or "2 m/s"'


def shock_of(pulse: Shock | None, velocity: float | None, drop: float | None, rebound: float, gravity: float) -> Shock:
    """Return the one shock that was given; a fall from h with rebound e changes the velocity by (1 + e) sqrt(2 g h)."""
    given = [value for value in (pulse, velocity, drop) if value is not None]
    if len(given) != 1:
        raise ValueError(f"give one shock: `pulse`, `velocity` or `drop`; got {len(given)}.")
    between("rebound", rebound, 0.0, 1.0)
    if rebound and drop is None:
        raise ValueError("`rebound` belongs to `drop`; a `pulse` or a `velocity` is the whole velocity change.")
    if pulse is not None:
        if not isinstance(pulse, Shock):
            raise ValueError(
                "`pulse` must be a half-sine, sawtooth, trapezoid or velocity step: the worksheet counts by velocity changes."
            )
        return pulse
    if drop is not None:
        velocity = (1.0 + rebound) * math.sqrt(2.0 * gravity * ranges.level("drop", positive("drop", drop, unit="m")))
    return VelocityStep(velocity=positive("velocity", velocity, unit="m/s"), direction="z")


def shock_from_text(text: str) -> Shock:
    """Return the shock of a text such as `15 g 11 ms half-sine` or `2 m/s`; its g are those of the worksheet.

    Raises:
        ValueError: the text is no shock, or one of its numbers is not positive.
    """
    step = _STEP.fullmatch(text.strip())
    if step:
        return VelocityStep(velocity=_positive(text, step[1]), direction="z")
    pulse = _PULSE.fullmatch(text.strip())
    shape = re.sub(r"[ -]", "", pulse[3].lower()) if pulse else ""
    if pulse is None or shape not in ("halfsine", "sawtooth", "terminalpeaksawtooth", "trapezoid"):
        raise ValueError(f"`--shock` must be like {_EXAMPLES}; got {text!r}.")
    peak, duration = _positive(text, pulse[1]) * WORKSHEET_GRAVITY, 1e-3 * _positive(text, pulse[2])
    if shape == "halfsine":
        return HalfSine(peak=peak, duration=duration, direction="z")
    if shape == "trapezoid":
        return Trapezoid(peak=peak, duration=duration, rise=_RISE * duration, direction="z")
    return Sawtooth(peak=peak, duration=duration, direction="z")


def _positive(text: str, number: str) -> float:
    try:
        return positive("--shock", float(number))
    except ValueError:
        raise ValueError(
            f"`--shock`: {number!r} must be a finite number > 0 in {text!r}; write for instance {_EXAMPLES}."
        ) from None
