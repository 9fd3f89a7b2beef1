"""What a functional mock-up unit runs: a system that the importing program takes from instant to instant.

A copy of this file stands in the unit, beside the model and what `unit.toml` says of it; the package is that of the Python in
which the unit is run.
"""

import tomllib
from collections.abc import Callable
from pathlib import Path
from typing import Any

import numpy as np
from pythonfmu3 import Float64, Fmi3Causality, Fmi3Slave, Fmi3Status, Fmi3StepResult, Fmi3Variability, Unit

from wirerope_mj.engine.response.histories import unit_of
from wirerope_mj.engine.simulation.stepwise import Stepwise
from wirerope_mj.engine.system import load_system
from wirerope_mj.foundation.arrays import Array
from wirerope_mj.foundation.errors import WireRopeError

_UNITS = {
    "s": {"s": 1}, "m": {"m": 1}, "m/s": {"m": 1, "s": -1}, "m/s^2": {"m": 1, "s": -2}, "N": {"kg": 1, "m": 1, "s": -2},
    "N m": {"kg": 1, "m": 2, "s": -2},
}  # fmt: skip
_WRENCH = (("force", "N"), ("moment", "N m"))


class WireRopeUnit(Fmi3Slave):
    """A system of wire-rope mounts as a co-simulation unit of FMI 3: base acceleration and loads in, motion and forces out."""

    def __init__(self, **arguments: object) -> None:
        """Read the model and name the variables."""
        super().__init__(**arguments)
        folder = Path(self.resources)
        about = tomllib.loads((folder / "unit.toml").read_text(encoding="utf-8"))
        self.modelName, self.description, self._about = about["identifier"], about["description"], about
        self._system = load_system(folder / "model" / about["model"])
        self._base = np.zeros(3)
        sites = self._system.assembly.subjects.force_names
        self._loads = {site: np.zeros(6) for site in sites}
        self.register_units([Unit(name, **parts) for name, parts in _UNITS.items()])
        self.exit_initialization_mode()
        self._add("time", "s", lambda: self._going.time, causality=Fmi3Causality.independent)
        for number, axis in enumerate("xyz"):
            self._add(f"base.acceleration.{axis}", "m/s^2", *_entry(self._base, number), causality=Fmi3Causality.input)
        for site, wrench in self._loads.items():
            for number, (part, unit) in enumerate((part, unit) for part, unit in _WRENCH for _ in "xyz"):
                name = f"loads.{_quoted(site)}.{part}.{'xyz'[number % 3]}"
                self._add(name, unit, *_entry(wrench, number), causality=Fmi3Causality.input)
        plan = self._going.plan
        for number, name in enumerate(plan.names[plan.first_sensor :][: self._going.values.size]):
            if about["outputs"] == "all" or name.split("/")[-2] in about["outputs"]:
                dotted = ".".join(_quoted(part) for part in name.split("/"))
                self._add(dotted, unit_of(name), self._output(number), causality=Fmi3Causality.output)

    def _add(self, name: str, unit: str, getter: Callable[[], float], setter: object = None, *, causality: object) -> None:
        how = {"causality": causality, "variability": Fmi3Variability.continuous, "getter": getter, "setter": setter}
        self.register_variable(Float64(name, unit=unit or None, **how), nested=False)

    def _output(self, number: int) -> Callable[[], float]:
        return lambda: float(self._going.values[number])

    def exit_initialization_mode(self) -> None:
        """Start at rest."""
        about = self._about
        self._going = Stepwise(self._system, timestep=about["timestep"], initial=about["initial"])
        self._stepped = False

    def do_step(self, current_time: float, step_size: float) -> object:
        """Advance by a step [s] with the inputs held; the first step after initialization says where time begins.

        (pythonfmu3 does not hand on the start time that an importer gives at initialization, and nothing in a system
        depends on it.)
        """
        if not self._stepped:
            self._going.time, self._stepped = float(current_time), True
        if abs(current_time - self._going.time) > 1e-9 * max(1.0, abs(current_time)):
            return self._refused(
                f"The unit stands at {self._going.time:.9g} s and cannot step from {current_time:.9g} s: only a state that it "
                "gave before (fmi3GetFMUState) takes it back, or a reset."
            )
        try:
            self._going.advance(step_size, self._base, self._loads)
        except WireRopeError as error:
            return self._refused(str(error))
        return Fmi3StepResult()

    def _get_fmu_state(self) -> dict[str, object]:
        inputs = [self._base.tolist(), *(wrench.tolist() for wrench in self._loads.values())]
        return {**self._going.to_plain(), "inputs": inputs, "stepped": self._stepped}

    def _set_fmu_state(self, state: dict[str, Any]) -> None:
        """Restore what `_get_fmu_state` saved."""
        self._going.restore(state)
        self._stepped = bool(state["stepped"])
        for values, saved in zip([self._base, *self._loads.values()], state["inputs"], strict=True):
            values[:] = saved

    def _refused(self, why: str) -> object:
        self.log(why, Fmi3Status.error)
        return Fmi3StepResult(status=Fmi3Status.error)


def _entry(values: Array, number: int) -> tuple[Callable[[], float], Callable[[float], None]]:
    """Return the functions that get and set an element of an array."""
    return lambda: float(values[number]), lambda value: values.__setitem__(number, float(value))


def _quoted(name: str) -> str:
    """Return a part of a structured name: in quotes where it is no identifier."""
    return name if name.isidentifier() else "'" + name.replace("\\", "\\\\").replace("'", "\\'") + "'"
