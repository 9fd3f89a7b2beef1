"""`wirerope shock`: a measured record played into a model."""

import math
from collections.abc import Sequence
from dataclasses import replace
from datetime import datetime
from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Any, Literal

from cyclopts import Parameter

from wirerope_mj.cli.numerics_options import with_numerics
from wirerope_mj.foundation.errors import RecordError

if TYPE_CHECKING:
    from wirerope_mj.motions.records.record import Record

QUESTION = "What does a measured shock do to the payload?"

RING_DOWN = 10.0
"""Periods of the slowest mode that are simulated after the record: at a damping ratio of a tenth a five-hundredth is left."""

_AXES = ("x", "y", "z")


def shock(
    model: str,
    *,
    record: Path,
    scale: float = 1.0,
    direction: str | None = None,
    channels: Annotated[list[str] | None, Parameter(consume_multiple=True, negative=())] = None,
    baseline: Literal["none", "rest", "mean", "velocity", "highpass"] = "none",
    highpass: float | None = None,
    resample: float | None = None,
    gaps: Literal["refuse", "fill"] = "refuse",
    unit: str | None = None,
    start: float = 0.0,
    duration: float | None = None,
    sample_rate: float = 1000.0,
    accuracy: float | None = None,
    timestep: float | None = None,
    out: Path | None = None,
    force: Annotated[bool, Parameter(negative=())] = False,
) -> int:
    """Play a measured record into a model: a run like those of `wirerope run`, and a picture of the baseline correction.

    Args:
        model: path of a model, or the name of one that ships with the package, such as shock_table.
        record: CSV file with units in its header, such as "time [s], x [g], z [m/s^2]", or universal file with datasets 58.
        scale: factor on the acceleration.
        direction: in which a record of one channel moves the base: x, y, z, -x, -y, -z or a vector such as 1,1,0.
        channels: which channels to use, NAME=DIRECTION, one or several; those named x, y and z by default. A universal file
            calls its channels NODE:DIRECTION, such as 12:z.
        baseline: correction of the baseline: none, rest (the level of the quiet part, gravity for instance), mean, velocity
            (a constant, so that the base ends at rest) or highpass.
        highpass: cutoff of the baseline highpass [Hz].
        resample: rate at which the record is played [Hz], through an anti-alias filter; as sampled by default.
        gaps: what is done about missing samples, absent rows, empty cells and NaN: refuse, or fill with straight lines.
        unit: of the accelerations, in place of what the file says, or does not say.
        start: instant at which the record begins [s].
        duration: simulated time [s]; until ten periods of the slowest mode after the record by default.
        sample_rate: of the response [Hz].
        accuracy: error allowed, as a fraction of the peaks; the step is chosen for it: 1e-4 by default.
        timestep: largest step [s], in place of one that is chosen; no error is estimated then.
        out: folder of the run; runs/shock-MODEL-RECORD-DATE-TIME by default.
        force: replace a run that is there.
    """
    from wirerope_mj.cli.printed_run import run_and_print
    from wirerope_mj.engine.simulation.stability import slowest_period
    from wirerope_mj.engine.system import load_system
    from wirerope_mj.motions import load_record
    from wirerope_mj.runs.scenario import Scenario

    numerics = with_numerics({}, accuracy=accuracy, timestep=timestep)
    motion = load_record(
        record, channels=_channels(record, channels, direction), scale=scale, baseline=baseline, start=start,
        highpass=highpass, resample=resample, gaps=gaps, unit=unit,
    )  # fmt: skip
    _check_that_it_moves(record, motion, duration)
    name = f"shock-{Path(model).stem}-{record.stem}"
    options: dict[str, Any] = {
        "record": record.name,
        "direction": direction,
        "channels": channels,
        "duration": duration,
    }
    made = Scenario(question=QUESTION, model=model, motion=motion, simulate={}, name=name, options=_given(options))
    if duration is None:
        duration = _rounded_up(motion.end + RING_DOWN * slowest_period(load_system(made.model_source())))
    made = replace(made, simulate={"duration": duration, "sample_rate": sample_rate} | numerics)
    folder = out or Path("runs") / f"{name}-{datetime.now():%Y%m%d-%H%M%S}"
    run_and_print(made, folder, force=force)
    return 0


def _check_that_it_moves(path: Path, motion: "Record", duration: float | None) -> None:
    """Raise an error for a record that would leave the base at rest all the time."""
    if not motion.samples.any():
        zero = "all of its samples are zero" if motion.baseline == "none" else "nothing but zeros is left of it"
        raise RecordError(
            f"{path}: {zero}, so that the base would not move. Is it the right file, and the right channel?"
        )
    if motion.end <= 0.0:
        raise ValueError(
            f"`--start` {motion.start:g} lets the record end at {motion.end:g} s, before the simulation begins at 0 s: the "
            "base would not move. Start it at 0 s or later."
        )
    if duration is not None and duration <= motion.start:
        raise ValueError(
            f"`--duration` {duration:g} ends the simulation before the record begins, at {motion.start:g} s (--start)."
        )


def _rounded_up(seconds: float) -> float:
    """Return the next tenth of a second."""
    return math.ceil(10.0 * seconds - 1e-6) / 10.0


def _given(options: dict[str, Any]) -> dict[str, Any]:
    """Return the options that were given, as plain text."""
    plain = {name: " ".join(value) if isinstance(value, list) else value for name, value in options.items()}
    return {name: value for name, value in plain.items() if value is not None}


def _channels(record: Path, channels: Sequence[str] | None, direction: str | None) -> dict[str, Any] | None:
    """Return which channel moves the base in which direction; None leaves it to their names."""
    from wirerope_mj.motions.records.record import record_channels

    if channels is None and direction is None:
        return None
    if channels is not None and direction is None:
        pairs = [item.rpartition("=") for item in channels]
        for item, (name, _, _) in zip(channels, pairs, strict=True):
            if not name:
                raise ValueError(f"`--channels` are NAME=DIRECTION, for instance ch3=z, got {item!r}.")
        return {name: _vector(text, "--channels") for name, _, text in pairs}
    names = tuple(channels) if channels is not None else record_channels(record)
    if len(names) != 1 or "=" in names[0]:
        raise ValueError(
            f"`--direction` turns a record of one channel, and here are {', '.join(names) or 'none'}. Say where each one "
            f"goes, for instance --channels {(names or ('ch1',))[0].partition('=')[0]}=z, or name one: --channels NAME "
            "--direction z."
        )
    assert direction is not None
    return {names[0]: _vector(direction, "--direction")}


def _vector(text: str, option: str) -> str | tuple[float, ...]:
    """Return an axis or a vector."""
    if text in _AXES:
        return text
    if text[:1] in "+-" and text[1:] in _AXES:
        sign = -1.0 if text[0] == "-" else 1.0
        return tuple(sign * (axis == text[1:]) for axis in _AXES)
    try:
        numbers = tuple(float(part) for part in text.split(","))
    except ValueError:
        numbers = ()
    if len(numbers) != 3:
        raise ValueError(f"`{option}` takes x, y, z, -x, -y, -z or a vector such as 1,1,0, got {text!r}.")
    return numbers
