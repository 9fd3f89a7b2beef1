"""Options of a branch: the parameter that is followed and its range, the payload, steps and tolerances."""

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from wirerope_mj.dynamics.periodic.branch import Parameter
from wirerope_mj.dynamics.periodic.observe import observed_bodies
from wirerope_mj.engine.simulation.simulate import check_direction
from wirerope_mj.engine.statics import History
from wirerope_mj.engine.system import System
from wirerope_mj.foundation.arguments import one_of, positive
from wirerope_mj.foundation.directions import Direction, checked_direction, direction_text
from wirerope_mj.motions import Sine

STILL = 1e-12
"""Fraction of the base's acceleration below which a payload stands still but for rounding."""


@dataclass(frozen=True, kw_only=True)
class BranchOptions:
    """The arguments of `follow_branch`, all checked; `other` is the parameter that stays fixed."""

    parameter: Parameter
    start: float
    stop: float
    other: float
    direction: Direction
    payload: str
    response_direction: Direction
    periods: int
    history: History
    accuracy: float
    smoothing: float | None
    tolerance: float
    largest_step: float
    smallest_step: float
    most_points: int

    @property
    def sign(self) -> float:
        """1 for a rising parameter, -1 for a falling one."""
        return 1.0 if self.stop > self.start else -1.0

    def fraction(self, value: float) -> float:
        """Return the fraction of the range that is behind a value, between 0 and 1."""
        return float(np.clip(np.log(value / self.start) / np.log(self.stop / self.start), 0.0, 1.0))


def branch_options(
    system: System,
    *,
    acceleration: float | None,
    frequency: float | None,
    direction: str | Sequence[float],
    payload: str,
    response_direction: str | Sequence[float] | None,
    periods: int,
    most_points: int,
    history: History,
    smoothing: float | None,
    **numbers: float,
) -> BranchOptions:
    """Return the options of `follow_branch`; an argument that is out of range is a ValueError."""
    if (acceleration is None) == (frequency is None):
        raise ValueError(
            "give either `acceleration` (to follow the frequency) or `frequency` (to follow the acceleration)."
        )
    values = _range(numbers)
    one_of("payload", payload, observed_bodies(system))
    moved = checked_direction(direction)
    parameter: Parameter = "frequency" if frequency is None else "acceleration"
    other = (
        positive("acceleration", acceleration) if acceleration is not None else positive("frequency", frequency or 0.0)
    )
    check_direction(system, Sine(frequency=1.0, acceleration=1.0, direction=moved))
    return BranchOptions(
        parameter=parameter,
        other=other,
        direction=moved,
        payload=payload,
        response_direction=moved
        if response_direction is None
        else checked_direction(response_direction, "response_direction"),
        periods=periods,
        history=history,
        most_points=most_points,
        smoothing=None if smoothing is None else positive("smoothing", smoothing),
        **values,
    )


def _range(numbers: dict[str, float]) -> dict[str, float]:
    """Return start, stop, steps and tolerances as plain numbers that go together."""
    values = {name: positive(name, value) for name, value in numbers.items()}
    if values["start"] == values["stop"]:
        raise ValueError(
            f"`stop` must differ from `start`, got {values['start']!r} for both; use periodic_orbit instead."
        )
    check_steps(values["smallest_step"], values["largest_step"])
    return values


def check_steps(smallest: float, largest: float) -> None:
    """Raise ValueError unless the steps along a branch go together."""
    if not smallest < largest < 1.0:
        raise ValueError(
            f"`smallest_step` must be below `largest_step`, and that below 1, got {smallest!r} and {largest!r}."
        )


def require_motion(amplitude: float, acceleration: float, payload: str, along: Direction) -> None:
    """Raise ValueError if a payload's amplitude [m/s^2] is zero but for rounding of the base's acceleration [m/s^2]."""
    if amplitude <= STILL * abs(acceleration):
        raise ValueError(
            f"`response_direction`: {payload} does not move along {direction_text(along)} in this motion, so there is no "
            "response. Leave it out to take the response along the base's motion, or move the base along it."
        )
