"""Tests on a rig: the frequency response of a payload on a shaker, and the loops of a mount's isolator."""

from collections.abc import Sequence
from dataclasses import dataclass, field
from pathlib import Path

import numpy as np

from wirerope_mj.engine.system import System
from wirerope_mj.foundation.arguments import positive
from wirerope_mj.foundation.arrays import Array, Entries
from wirerope_mj.foundation.errors import RecordError, WireRopeError
from wirerope_mj.foundation.table_files import number_in, read_header, rows_below
from wirerope_mj.foundation.units import ACCELERATION_UNITS
from wirerope_mj.motions import Sine
from wirerope_mj.motions.records.measured import parse_channel
from wirerope_mj.mounts.identification.measured import prepare
from wirerope_mj.mounts.laws import Loop
from wirerope_mj.studies.calibration.measured_test import work_of
from wirerope_mj.studies.calibration.noise import Series
from wirerope_mj.studies.engines.together import histories
from wirerope_mj.studies.vary.quantity import InputColumn
from wirerope_mj.studies.vary.variants import Maker

# Cycles to settle, and cycles over which the amplitude is measured, with a Hann window against residual free vibration
SETTLED, MEASURED = 20, 12
FEWEST = 5  # frequencies that a response must have
_STEPS = 16.0  # samples of a cycle at which steps end
_KIND, _EXAMPLE = "frequency response", '"frequency [Hz], level [g], transmissibility"'
_COLUMNS = ("frequency", "level", "transmissibility")


@dataclass(frozen=True, kw_only=True, eq=False)
class FrequencyTest:
    """A transmissibility measured with a steady or slowly swept sine.

    It is the amplitude of the absolute acceleration at the base's frequency, as a tracking filter shows it, over the base's.
    """

    name: str  #: in tables and in names of quantities
    payload: str  #: body whose acceleration was measured
    acceleration: float  #: amplitude of the base [m/s^2]
    frequency: Array = field(repr=False)  #: [Hz], rising, (n,)
    transmissibility: Array = field(repr=False)  #: [-], (n,)
    direction: str = "z"  #: "x", "y" or "z", of the base and of what was measured
    initial: str = "settled"  #: state in which the sine begins

    def __post_init__(self) -> None:
        positive("acceleration", self.acceleration, unit="m/s^2")
        f, t = (np.asarray(values, dtype=np.float64) for values in (self.frequency, self.transmissibility))
        if f.size < FEWEST or f.shape != t.shape or not (np.diff(f) > 0.0).all() or f[0] <= 0.0 or (t <= 0.0).any():
            raise RecordError(
                f"{self.name}: a frequency response needs {FEWEST} rising frequencies > 0 Hz at least and as many "
                f"transmissibilities > 0, got {f.size} and {t.size}."
            )


class FrequencyRuns:
    """Transmissibilities of systems at the frequencies of a test; the series is their logarithm over that of frequency."""

    def __init__(self, system: System, test: FrequencyTest, columns: tuple[InputColumn, ...]) -> None:
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
        self.works = [
            work_of(
                system, columns, Sine(frequency=float(frequency), acceleration=test.acceleration, direction=test.direction),
                duration=(SETTLED + MEASURED) / float(frequency), sample_rate=_STEPS * float(frequency), initial=test.initial,
            )
            for frequency in test.frequency
        ]  # fmt: skip

    def __call__(self, rows: Sequence[Entries]) -> list[list[Array] | None]:
        """Return the transmissibilities, (n,), for the inputs of each row; None for a row of which a run failed."""
        found = np.full((len(rows), len(self.works)), np.nan)
        column = f"bodies/{self.test.payload}/acceleration/{self.test.direction}"
        for k, (work, frequency) in enumerate(zip(self.works, self.test.frequency, strict=True)):
            time, done = histories(work, rows, [column])
            last = time >= SETTLED / frequency
            window, turning = np.hanning(np.count_nonzero(last)), np.exp(-2j * np.pi * frequency * time[last])
            for i, response in enumerate(done):
                if response is not None:  # its amplitude as a tracking filter shows it
                    amplitude = 2.0 * abs(np.sum(window * response[last, 0] * turning)) / window.sum()
                    found[i, k] = amplitude / self.test.acceleration
        return [[row] if np.isfinite(row).all() else None for row in found]

    def recorded(self, number: int, raw: Array, gain: float, delay: float, offset: float) -> Array:
        """Return the logarithm of transmissibilities that are measured with a gain [-]; delay and offset do not matter."""
        return np.log(gain * raw)


def read_frequency_tests(path: Path, phrase: str) -> list[FrequencyTest]:
    """Read a test for each level of a file with the columns frequency [Hz], level (with its unit) and transmissibility.

    The phrase says what was measured: "body/rack z".

    Raises:
        RecordError: the file has other columns, or too few rows of a level.
        ValueError: the phrase names no body with an axis.
    """
    channel = parse_channel("transmissibility", phrase)
    kind, _, payload = channel.subject.partition("/")
    if kind != "body":
        raise ValueError(f"a frequency response is of a body, such as 'body/rack z', got {phrase!r}.")
    header = read_header(path, kind=_KIND, example=_EXAMPLE)
    if missing := [name for name in _COLUMNS if name not in header.names]:
        raise RecordError(
            f"{header.location}: a frequency response has the columns {_EXAMPLE}; {missing[0]!r} is missing among "
            f"{header.listed()}."
        )
    places = [header.names.index(name) for name in _COLUMNS]
    factors = (header.factor(places[0], {"Hz": 1.0}), header.factor(places[1], ACCELERATION_UNITS), 1.0)
    rows = np.array(
        [
            [number_in(location, name, cells[k]) * factor for name, k, factor in zip(_COLUMNS, places, factors, strict=True)]
            for _, location, cells in rows_below(header)
        ]
    ).reshape(-1, 3)
    tests = []
    for level in np.unique(rows[:, 1]).tolist():
        of_level = rows[rows[:, 1] == level]
        of_level = of_level[np.argsort(of_level[:, 0])]
        tests.append(
            FrequencyTest(
                name=f"{path.stem} {level:.3g} m s-2", payload=payload, acceleration=level, frequency=of_level[:, 0],
                transmissibility=of_level[:, 2], direction=channel.axis,
            )
        )  # fmt: skip
    if not tests:
        raise RecordError(f"{path}: there are no rows below the header.")
    return tests


SAMPLES = 120  # samples of a loop that are compared at most


@dataclass(frozen=True, kw_only=True, eq=False)
class LoopTest:
    """Cyclic tests of the isolator of one mount along one axis."""

    name: str  #: in tables and in names of quantities
    mount: str  #: whose isolator was tested
    axis: str  #: "roll", "shear" or "axial"
    loops: Sequence[Loop] = field(repr=False)  #: closed cycles


class LoopRuns:
    """Forces of the laws of systems along measured loops, each without its mean: a load cell's zero drifts."""

    def __init__(self, system: System, test: LoopTest, columns: tuple[InputColumn, ...]) -> None:
        if test.mount not in system.mounts:
            raise RecordError(f"{test.name}: there is no mount {test.mount!r}. There is: {', '.join(system.mounts)}.")
        if system.mounts[test.mount].isolator.axes.get(test.axis) is None:
            raise RecordError(f"{test.name}: mount {test.mount!r} has no law on axis {test.axis!r}.")
        self.test, self._written = test, system.mounts[test.mount].written
        self._maker = Maker(system, (), columns)
        self._loops = [loop.thinned(SAMPLES) for loop in prepare(test.loops)]
        self.series = []
        for number, loop in enumerate(self._loops):
            values = loop.force - loop.force.mean()
            along = np.linspace(0.0, 1.0, loop.force.size)
            name = f"{test.name}/mount/{test.mount}/loop {number + 1}/{test.axis}"
            size = np.full(values.size, 0.5 * float(np.ptp(values)))
            self.series.append(Series(name=name, at=along, values=values, size=size, unit="N", across="loop"))

    def __call__(self, rows: Sequence[Entries]) -> list[list[Array] | None]:
        """Return the forces of each row's laws along every loop [N]; None where a law is invalid or a force not finite."""
        found: list[list[Array] | None] = []
        for row in rows:
            try:
                isolator = self._maker.changes(row).isolators.get(self.test.mount, self._written)
            except (ValueError, WireRopeError):
                found.append(None)
                continue
            law = isolator.conditioned.axes[self.test.axis]
            assert law is not None  # a variant has the laws of its system
            forces = [loop.model_force(law) for loop in self._loops]
            finite = all(np.isfinite(force).all() for force in forces)
            found.append([force - force.mean() for force in forces] if finite else None)
        self._maker.forget()
        return found

    def recorded(self, number: int, raw: Array, gain: float, delay: float, offset: float) -> Array:
        """Return the forces of a loop that are measured with a gain [-]; delay and offset do not matter."""
        return gain * raw
