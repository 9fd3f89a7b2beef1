"""Natural frequencies of joints with springs that vary: of a deck panel, a subassembly, a mode of a flexible part."""

import math
import re
from typing import Any

import numpy as np
import numpy.typing as npt

from wirerope_mj.engine.system import System
from wirerope_mj.engine.system.varied import sprung_joints
from wirerope_mj.studies.inputs.column import Draft, Entry, InputColumn, ValueOrFactor, matching


class Tuning(ValueOrFactor):
    """Natural frequency [Hz] that a joint's spring gives what stands on it alone; its damping ratio stays."""

    form = "joint/NAME/frequency"
    pattern = re.compile(r"joint/(.*)/frequency")
    model_unit = "Hz"

    @classmethod
    def resolve(cls, entry: Entry) -> tuple[InputColumn, ...]:
        """Return the columns of the matching joints."""
        return cls.split(entry, matching(entry, list(sprung_joints(entry.system.model)), "joint with a spring"))

    def nominal_of(self, system: System, target: str) -> float:
        """Return what the model says of one target."""
        return sprung_joints(system.model)[target]

    def apply(self, draft: Draft, value: Any) -> None:
        """Put a value into a variant."""
        if not (math.isfinite(value) and value > 0.0):
            unit = "" if self.relative else " Hz"
            raise ValueError(f"{self.name} must be finite and > 0{unit}, got {value:g}{unit}.")
        for joint in self.targets:
            draft.tunings[joint] = value if self.relative else value / self.nominal_of(draft.system, joint)

    def certainly_valid(self, draft: Draft, values: npt.NDArray[Any]) -> bool:
        """Return whether all values are valid; False says nothing."""
        return bool(np.isfinite(values).all() and values.min() > 0.0)
