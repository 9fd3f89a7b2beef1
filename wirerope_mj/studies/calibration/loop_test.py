"""Loops of a mount's isolator, measured in a rig, beside tests of the system."""

from collections.abc import Sequence
from dataclasses import dataclass, field

import numpy as np

from wirerope_mj.engine.system import System
from wirerope_mj.foundation.arrays import Array, Entries
from wirerope_mj.foundation.errors import RecordError, WireRopeError
from wirerope_mj.mounts.identification.measured import prepare
from wirerope_mj.mounts.laws import Loop
from wirerope_mj.studies.calibration.noise import Series
from wirerope_mj.studies.inputs.column import InputColumn
from wirerope_mj.studies.inputs.variants import Maker

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
        self._loops = [one.thinned(SAMPLES) for one in prepare(test.loops)]
        self.series = []
        for number, loop in enumerate(self._loops):
            values = loop.force - loop.force.mean()
            along = np.linspace(0.0, 1.0, loop.force.size)
            name = f"{test.name}/mount/{test.mount}/loop {number + 1}/{test.axis}"
            size = np.full(values.size, 0.5 * float(np.ptp(values)))
            self.series.append(Series(name=name, at=along, values=values, size=size, unit="N", across="loop"))

    def __call__(self, rows: Sequence[Entries]) -> list[list[Array] | None]:
        """Return the forces of the laws of each row along every loop [N]; None where one is not finite or cannot be."""
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
            found.append([one - one.mean() for one in forces] if all(np.isfinite(one).all() for one in forces) else None)
        self._maker.forget()
        return found

    def seen(self, number: int, raw: Array, gain: float, delay: float, offset: float) -> Array:
        """Return the series of a raw force as a load cell with a gain shows it."""
        return gain * raw
