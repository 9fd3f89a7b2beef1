"""A scenario for a model that stands alone: the pulse that shock tests begin with, and its own ring-down."""

from pathlib import Path

from wirerope_mj.engine.simulation.stability import slowest_period
from wirerope_mj.engine.system import load_system
from wirerope_mj.foundation.directions import directions_in
from wirerope_mj.foundation.errors import ModelError
from wirerope_mj.foundation.resources import model_file, shipped_models
from wirerope_mj.foundation.units import STANDARD_GRAVITY
from wirerope_mj.motions import HalfSine
from wirerope_mj.runs.said_motion import RING_DOWN
from wirerope_mj.runs.scenario import Scenario, ScenarioFile, load_scenario, shipped_scenarios

_START = 0.05
"""Instant at which the pulse begins [s]: the curves show the rest before it."""


def scenario_or_model(name_or_path: str | Path) -> ScenarioFile:
    """Return the scenario of that name or path; of a model, the half-sine that strikes its base.

    Raises:
        ModelError: there is neither.
    """
    path = Path(name_or_path)
    if str(name_or_path) in shipped_scenarios() or path.suffix == ".py":
        return load_scenario(name_or_path)
    file = model_file(name_or_path)
    if file is None:
        raise ModelError(
            f"there is no scenario and no model {str(name_or_path)!r}. The package ships the scenarios "
            f"{', '.join(shipped_scenarios())} and the models {', '.join(shipped_models())}; anything else must be the path of "
            "a scenario's .py or a model's .xml file."
        )
    return _shock_of(file.resolve())


def _shock_of(model: Path) -> ScenarioFile:
    def scenario(
        *, level_g: float = 15.0, direction: str = "z", pulse_ms: float = 11.0, duration: float | None = None
    ) -> Scenario:
        """Do payload and mounts keep their limits under a half-sine that strikes the base?

        Args:
            level_g: peak acceleration along each axis [g].
            direction: axes along which the base is struck: x, y, z, xy, xyz, ...
            pulse_ms: length of the half-sine [ms].
            duration: simulated time [s]; until ten periods of the slowest mode after the pulse by default.
        """
        along = directions_in(direction)
        if not along:
            raise ValueError(f"`direction` must name axes, such as xyz or z, got {direction!r}.")
        peak, length = level_g * STANDARD_GRAVITY, 1e-3 * pulse_ms
        pulses = [HalfSine(peak=peak, duration=length, direction=axis, start=_START) for axis in along]
        if duration is None:
            duration = round(_START + length + RING_DOWN * slowest_period(load_system(model)), 1)
        return Scenario(
            question=(scenario.__doc__ or "").split("\n", 1)[0],
            model=model,
            motion=pulses[0] if len(pulses) == 1 else sum(pulses[1:], start=pulses[0]),
            simulate={"duration": duration},
        )

    return ScenarioFile(name=model.stem, path=model, function=scenario)
