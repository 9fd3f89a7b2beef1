"""Options of a frequency response, checked before anything is computed; the default range comes from natural frequencies."""

import math
from dataclasses import dataclass
from typing import Literal

import numpy as np

from wirerope_mj.dynamics.periodic.options import check_steps
from wirerope_mj.engine.simulation.simulate import check_direction
from wirerope_mj.engine.simulation.stability import eigenvalues
from wirerope_mj.engine.system import System
from wirerope_mj.foundation.arguments import integer, one_of, positive
from wirerope_mj.foundation.directions import Direction, checked_direction, direction_text, unit_vector
from wirerope_mj.foundation.errors import ModelError
from wirerope_mj.motions import Sine

Method = Literal["sweep", "continuation", "both"]

BELOW, ABOVE = 4.0, 2.0
"""Default range: from a quarter of the lowest natural frequency, where the superharmonic resonances of order 2 and 3 lie above,
to twice the highest, where every mount isolates."""

STILL = 1e-3
"""Natural frequencies below this fraction of the highest belong to what no mount holds back [-]."""


@dataclass(frozen=True, kw_only=True)
class ResponseOptions:
    """Levels, method and range of a frequency response; `checked` fills in what is left open.

    Attributes:
        accelerations: levels of the base's acceleration [m/s^2].
        method: "continuation", "sweep" or "both".
        payload: body whose acceleration is the amplitude; None: the first payload.
        response_direction: along which it is taken; None: that of the base.
        start, stop: range [Hz]; None: from the system's natural frequencies.
        rate: of the sweeps [octaves/min].
        periods: of the base after which the motions repeat themselves.
        largest_step, smallest_step: of the continuation, relative to the frequency.
        smoothing: fraction of the mounts' largest velocity over which the continuation smooths the laws; None: as they are.
        range_from: origin of the range as text; set by `checked`.
    """

    accelerations: tuple[float, ...]
    method: Method = "continuation"
    direction: Direction = "z"
    payload: str | None = None
    response_direction: Direction | None = None
    start: float | None = None
    stop: float | None = None
    rate: float = 1.0
    periods: int = 1
    largest_step: float = 0.02
    smallest_step: float = 1e-5
    smoothing: float | None = None
    range_from: str = "given"

    def checked(self, system: System) -> "ResponseOptions":
        """Return the same options with nothing left open.

        Raises:
            ValueError: a level, the range, a step, the payload or a direction is not valid.
            ModelError: the base is not driven in this direction, or nothing is mounted on it.
        """
        levels = tuple(positive("acceleration", level) for level in self.accelerations)
        if not levels or len(set(levels)) < len(levels):
            raise ValueError(f"`acceleration` must be one or several different levels, got {list(levels)}.")
        direction = checked_direction(self.direction)
        along = (
            direction
            if self.response_direction is None
            else checked_direction(self.response_direction, "response_direction")
        )
        if self.method != "continuation" and np.count_nonzero(unit_vector(along)) > 1:
            raise ValueError(
                f"`response_direction` must lie along x, y or z for sweeps, whose envelopes are kept along these axes; got "
                f"{direction_text(along)}. Follow the motions only: method continuation."
            )
        check_direction(system, Sine(frequency=1.0, acceleration=1.0, direction=direction))
        start, stop, range_from = _range(system, self.start, self.stop)
        periods = integer("periods", self.periods, least=1)
        if self.method == "sweep" and (self.smoothing is not None or periods != 1):
            raise ValueError(
                "`smoothing` and `periods` belong to the continuation: a sweep has neither. Leave them out."
            )
        largest, smallest = positive("largest_step", self.largest_step), positive("smallest_step", self.smallest_step)
        check_steps(smallest, largest)
        return ResponseOptions(
            accelerations=tuple(sorted(levels)), method=self.method, direction=direction,
            payload=_payload(system, self.payload), response_direction=along, start=start, stop=stop,
            rate=positive("rate", self.rate), periods=periods, largest_step=largest, smallest_step=smallest,
            smoothing=None if self.smoothing is None else positive("smoothing", self.smoothing), range_from=range_from,
        )  # fmt: skip

    @property
    def range(self) -> tuple[float, float]:
        """Start and stop of checked options [Hz]."""
        assert self.start is not None
        assert self.stop is not None
        return self.start, self.stop


def natural_frequencies(system: System) -> list[float]:
    """Return the frequencies of the system on its unloaded mounts, where they are stiffest [Hz], lowest first."""
    values = np.abs(np.imag(eigenvalues(system))) / (2.0 * math.pi)
    frequencies = sorted(values[values > STILL * values.max(initial=0.0)].tolist())
    return frequencies[::2]  # each appears with both signs of its imaginary part


def _range(system: System, start: float | None, stop: float | None) -> tuple[float, float, str]:
    """Return the range and where it comes from."""
    source = "given"
    if start is None or stop is None:
        natural = natural_frequencies(system)
        if not natural:
            raise ModelError(
                "the system has no natural frequency that a range could be taken from; give `start` and `stop`."
            )
        several = f" to {natural[-1]:.3g}" if len(natural) > 1 else ""
        source = f"from the system's natural frequencies of {natural[0]:.3g}{several} Hz on its unloaded mounts"
        start = float(f"{natural[0] / BELOW:.2g}") if start is None else start
        stop = float(f"{natural[-1] * ABOVE:.2g}") if stop is None else stop
    low, high = positive("start", start), positive("stop", stop)
    if low >= high:
        raise ValueError(f"`stop` must be above `start`, got {low:g} to {high:g} Hz; sweeps go up and then down again.")
    return low, high, source


def _payload(system: System, name: str | None) -> str:
    payloads = system.payloads
    if name is None:
        if not payloads:
            raise ModelError("the model has no payload: no mount carries a body.")
        return payloads[0]
    return one_of("payload", name, payloads)
