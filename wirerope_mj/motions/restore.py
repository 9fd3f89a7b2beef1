"""A base motion from its stored parameters."""

import inspect
from collections.abc import Callable, Mapping
from pathlib import Path
from typing import Any

from wirerope_mj.foundation.errors import ModelError
from wirerope_mj.motions.decaying import DecayingSine
from wirerope_mj.motions.double_half_sine import DoubleHalfSine
from wirerope_mj.motions.double_triangle import DoubleTriangle
from wirerope_mj.motions.harmonic import Sine, Sweep
from wirerope_mj.motions.motion import BaseMotion, SumOfMotions
from wirerope_mj.motions.payload_forces import ForceTable, HarmonicForce
from wirerope_mj.motions.pulses import HalfSine, Sawtooth, Trapezoid, VelocityStep
from wirerope_mj.motions.random_vibration import RandomVibration
from wirerope_mj.motions.records.record import Record, load_record
from wirerope_mj.motions.scaled import Scaled, Turned
from wirerope_mj.motions.table_shock import ShockTableImpact
from wirerope_mj.motions.unbalance import Unbalance
from wirerope_mj.motions.vibration_lines import VibrationLines

_FACTORIES: dict[str, Callable[..., BaseMotion]] = {
    HalfSine.kind: HalfSine,
    Sawtooth.kind: Sawtooth,
    Trapezoid.kind: Trapezoid,
    VelocityStep.kind: VelocityStep,
    Sine.kind: Sine,
    Sweep.kind: Sweep,
    DoubleHalfSine.kind: DoubleHalfSine,
    DoubleTriangle.kind: DoubleTriangle,
    ShockTableImpact.kind: ShockTableImpact,
    DecayingSine.kind: DecayingSine,
    VibrationLines.kind: VibrationLines,
    RandomVibration.kind: RandomVibration,
    Record.kind: load_record,
    Scaled.kind: Scaled,
    Turned.kind: Turned,
    Unbalance.kind: Unbalance,
    HarmonicForce.kind: HarmonicForce,
    ForceTable.kind: ForceTable,
}


def motion_from_dict(stored: Mapping[str, Any], *, folder: str | Path | None = None) -> BaseMotion:
    """Return the motion that `BaseMotion.to_dict` stored; its numbers are the same to the last bit.

    Args:
        stored: the parameters, as `to_dict` wrote them.
        folder: where relative paths of records start; None: the current folder.

    Raises:
        ModelError: the kind of motion is unknown, or a parameter is missing or unknown.
        RecordError: the file of a record is missing or not a record.
        ValueError: A parameter is out of its range.
    """
    parameters = dict(stored)
    kind = parameters.pop("kind", None)
    if kind == SumOfMotions.kind:
        _check_names(kind, parameters, SumOfMotions)
        return SumOfMotions(terms=tuple(motion_from_dict(term, folder=folder) for term in parameters["terms"]))
    if kind not in _FACTORIES:
        raise ModelError(
            f"Unknown kind of motion {kind!r}; known kinds: {', '.join([*_FACTORIES, SumOfMotions.kind])}."
        )
    _check_names(kind, parameters, _FACTORIES[kind])
    if kind == Record.kind and folder is not None:
        parameters["path"] = Path(folder) / parameters["path"]
    if kind in (Scaled.kind, Turned.kind):
        parameters["motion"] = motion_from_dict(parameters["motion"], folder=folder)
    return _FACTORIES[kind](**parameters)


def _check_names(kind: str, parameters: Mapping[str, Any], factory: Callable[..., BaseMotion]) -> None:
    known = inspect.signature(factory).parameters
    unknown = [name for name in parameters if name not in known]
    missing = [name for name, item in known.items() if item.default is item.empty and name not in parameters]
    for names, fault in ((unknown, "unknown"), (missing, "missing")):
        if names:
            raise ModelError(f"Motion {kind!r}: {fault} {', '.join(names)}; its parameters are {', '.join(known)}.")
