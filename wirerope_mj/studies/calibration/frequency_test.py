"""A measured frequency response: transmissibility at one level of the base, and the same of a system in lanes."""

from collections.abc import Sequence
from dataclasses import dataclass, field
from functools import partial

import numpy as np

from wirerope_mj.engine.simulation import BatchResult, simulate_batch
from wirerope_mj.engine.simulation.stepper import initial_state
from wirerope_mj.engine.simulation.timestep import choose_timestep
from wirerope_mj.engine.system import System
from wirerope_mj.foundation.arguments import positive
from wirerope_mj.foundation.arrays import Array
from wirerope_mj.foundation.errors import RecordError
from wirerope_mj.motions import Sine
from wirerope_mj.studies.calibration.noise import Series

SETTLED, MEASURED = 30, 2
"""Cycles before the amplitude is taken, and in which it is: of a damping ratio of 4 % a two-thousandth is left."""

FEWEST = 5
"""Frequencies that a response must have."""

_STEPS = 16.0
"""Samples of a cycle at which steps end."""

_ACCURACY = 1e-3


@dataclass(frozen=True, kw_only=True, eq=False)
class FrequencyTest:
    """A transmissibility measured with a steady or slowly swept sine, largest absolute acceleration over the base's amplitude.

    Attributes:
        name: in tables and in names of quantities.
        payload: body whose acceleration was measured.
        acceleration: amplitude of the base [m/s^2].
        frequency: [Hz], rising, (n,).
        transmissibility: [-], (n,).
        direction: "x", "y" or "z", of the base and of what was measured.
        initial: state in which the sine begins.
    """

    name: str
    payload: str
    acceleration: float
    frequency: Array = field(repr=False)
    transmissibility: Array = field(repr=False)
    direction: str = "z"
    initial: str = "settled"

    def __post_init__(self) -> None:
        positive("acceleration", self.acceleration, unit="m/s^2")
        f, t = (np.asarray(one, dtype=np.float64) for one in (self.frequency, self.transmissibility))
        if f.size < FEWEST or f.shape != t.shape or not (np.diff(f) > 0.0).all() or f[0] <= 0.0 or (t <= 0.0).any():
            raise RecordError(
                f"{self.name}: a frequency response needs {FEWEST} rising frequencies > 0 Hz at least and as many "
                f"transmissibilities > 0, got {f.size} and {t.size}."
            )


class FrequencyRuns:
    """Transmissibilities of systems at the frequencies of a test; the series is their logarithm over that of frequency."""

    def __init__(self, system: System, test: FrequencyTest) -> None:
        if test.payload not in system.assembly.subjects.body_names:
            raise RecordError(
                f"{test.name}: this model has no body {test.payload!r}, so that the response is another model's. It has: "
                f"{', '.join(system.assembly.subjects.body_names)}."
            )
        self.test = test
        name = f"{test.name}/body/{test.payload}/transmissibility/{test.direction}"
        at = np.log(np.asarray(test.frequency, dtype=np.float64))
        values = np.log(np.asarray(test.transmissibility, dtype=np.float64))
        self.series = [Series(name=name, at=at, values=values, size=np.ones(at.size), across="logarithm of frequency")]
        self._sines = [
            Sine(frequency=float(one), acceleration=test.acceleration, direction=test.direction)
            for one in test.frequency
        ]
        self._steps = [
            choose_timestep(
                system, sine, initial_state(system, sine, test.initial), duration=4.0 / sine.frequency,
                sample_rate=_STEPS * sine.frequency, accuracy=_ACCURACY,
            ).timestep
            for sine in self._sines
        ]  # fmt: skip

    def __call__(self, systems: Sequence[System]) -> list[list[Array] | None]:
        """Return the transmissibilities of systems, (n,) each; None where one failed."""
        found = np.full((len(systems), len(self._sines)), np.nan)
        axis = "xyz".index(self.test.direction)
        for k, (sine, step) in enumerate(zip(self._sines, self._steps, strict=True)):
            run = partial(simulate_batch, motions=sine, timestep=step, sample_rate=_STEPS * sine.frequency)
            begun = run(systems, duration=SETTLED / sine.frequency, initial=self.test.initial)
            good = [i for i, one in enumerate(begun) if isinstance(one, BatchResult)]
            states = [one.final_state for one in begun if isinstance(one, BatchResult)]
            if not good:
                continue
            ended = run([systems[i] for i in good], duration=MEASURED / sine.frequency, initial=states)
            for i, one in zip(good, ended, strict=True):
                if isinstance(one, BatchResult):
                    peak = one.peaks.bodies[self.test.payload].acceleration
                    found[i, k] = max(-peak.minimum[axis], peak.maximum[axis]) / self.test.acceleration
        return [[row] if np.isfinite(row).all() else None for row in found]

    def seen(self, number: int, raw: Array, gain: float, delay: float, offset: float) -> Array:
        """Return the series of raw transmissibilities as a chain with a gain shows them."""
        return np.log(gain * raw)
