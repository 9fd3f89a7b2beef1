"""`wirerope shock`: a base motion said on the command line, or a measured record, played into a model."""

import math
from collections.abc import Sequence
from dataclasses import replace
from datetime import datetime
from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Any, Literal

from cyclopts import Parameter

from wirerope_mj.cli.options import with_numerics
from wirerope_mj.foundation.directions import direction_in
from wirerope_mj.foundation.errors import RecordError

if TYPE_CHECKING:
    from wirerope_mj.motions.records.record import Record

QUESTION = "What does this motion of the base do to the payload, and do the mounts stay within their limits?"

RING_DOWN = 10.0
"""Periods of the slowest mode that are simulated after the motion: at a damping ratio of a tenth a five-hundredth is left."""

Phrases = Annotated[list[str] | None, Parameter(negative=())]


def shock(
    model: str,
    *,
    half_sine: Phrases = None,
    sawtooth: Phrases = None,
    trapezoid: Phrases = None,
    velocity_step: Phrases = None,
    double_pulse: Phrases = None,
    struck_deck: Phrases = None,
    sine: Phrases = None,
    sweep: Phrases = None,
    psd: Phrases = None,
    spectrum: Phrases = None,
    unbalance: Phrases = None,
    reciprocating: Phrases = None,
    payload_force: Phrases = None,
    moment: Phrases = None,
    force_table: Phrases = None,
    levels: Annotated[list[Path] | None, Parameter(negative=())] = None,
    record: Path | None = None,
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
    initial: Literal["settled", "relaxed", "unloaded"] = "settled",
    sample_rate: float = 1000.0,
    accuracy: float | None = None,
    timestep: float | None = None,
    deck: str | None = None,
    limit: Phrases = None,
    combined_travel: bool = True,
    out: Path | None = None,
    force: Annotated[bool, Parameter(negative=())] = False,
) -> int:
    """Move a model's base or force its payload: pulses, sines, random vibration, records, unbalance, several at once.

    A motion is said in a few words, in any order: numbers with units, a direction (x, y, z, several as in xyz, -z or a
    vector such as 1,1,0), and "at 50 ms" where it does not begin at once. What is given several times, or in several
    options, is added.

    wirerope shock cabinet --half-sine "15 g 11 ms z at 50 ms" --limit "acceleration/rack = 12 g"

    Args:
        model: path of a model, or the name of one that ships with the package, such as shock_table.
        half_sine: "15 g 11 ms z": peak, length, direction.
        sawtooth: "20 g 11 ms z": terminal peak, length, direction.
        trapezoid: "10 g 18 ms rise 2 ms z": peak, length, rise and fall, direction.
        velocity_step: "2 m/s z": velocity change at once.
        double_pulse: "50 mm 3 m/s 100 g z": the double half-sine of a design spectrum d0, v0, a0.
        struck_deck: "14 Hz 1.5 m/s damping 5 % blow 4 ms z": a deck of one frequency under a blow.
        sine: "0.5 g 12 Hz 10 s z": steady sine.
        sweep: "0.5 g 5 to 50 Hz 2 oct/min z": logarithmic sine sweep.
        psd: "transport.csv 30 s z seed 1": random vibration of a file with "frequency [Hz], psd [g^2/Hz]".
        spectrum: "floor.csv 20 s x damping 5 % seed 1": a motion with the response spectrum of a file with
            "frequency [Hz], acceleration [g]".
        unbalance: "engine 20 kg.mm 5 to 30 Hz 20 s x": a force on the payload, at its site force/engine: unbalance of a shaft
            about x, running up within 20 s; "25 Hz" for constant speed; "order 2", "for 10 s".
        reciprocating: "engine 8 kg.mm 25 Hz order 2 z": the same of what moves to and fro along z.
        payload_force: "engine 500 N 12 Hz 10 s z": harmonic force.
        moment: "engine 80 N.m 12 Hz 10 s y": harmonic moment.
        force_table: "engine start.csv at 1 s": forces and moments of a file with "time [s], fz [N], mx [N.m]" and the like.
        levels: TOML file of motions, as `wirerope levels` writes one to fill in.
        record: CSV file with units in its header, such as "time [s], x [g], z [m/s^2]", or universal file with datasets 58.
        scale: of a record: factor on the acceleration.
        direction: in which a record of one channel moves the base: x, y, z, -x, -y, -z or a vector such as 1,1,0.
        channels: of a record: which to use, NAME=DIRECTION, one or several; those named x, y and z by default. A universal
            file calls its channels NODE:DIRECTION, such as 12:z.
        baseline: correction of a record's baseline: none, rest (the level of the quiet part, gravity for instance), mean,
            velocity (a constant, so that the base ends at rest) or highpass.
        highpass: cutoff of the baseline highpass [Hz].
        resample: rate at which a record is played [Hz], through an anti-alias filter; as sampled by default.
        gaps: what is done about missing samples of a record, absent rows, empty cells and NaN: refuse, or fill with straight
            lines.
        unit: of a record's accelerations, in place of what the file says, or does not say.
        start: instant at which a record begins [s].
        duration: simulated time [s]; by default until ten periods of the slowest mode after the motion, with a sweep until
            its end.
        initial: state in which it begins: settled under its weight, relaxed (after long vibration) or unloaded.
        sample_rate: of the response [Hz].
        accuracy: error allowed, as a fraction of the peaks; the step is chosen for it: 1e-4 by default.
        timestep: largest step [s], in place of one that is chosen; no error is estimated then.
        deck: "10 Hz 800 kg 4 %": a deck panel of that mass under all mounts, tuned alone to that frequency along z, with that
            damping ratio (2 % if none is said), in place of the rigid deck; or the folder of a flexible part.
        limit: "acceleration/rack = 15 g" or "clearance/rack_top = 30 30 20 mm": a limit of the payload, in place of the
            model's.
        combined_travel: judge mounts on all axes at once, by this program's own rule.
        out: folder of the run; runs/shock-MODEL-MOTION-DATE-TIME by default.
        force: replace a run that is there.
    """
    from wirerope_mj.cli.printed_run import run_and_print
    from wirerope_mj.engine.flexible import deck_of
    from wirerope_mj.engine.simulation.stability import slowest_period
    from wirerope_mj.engine.system import load_system
    from wirerope_mj.foundation.payload_limits import limit_from_text
    from wirerope_mj.motions import Sweep, load_record
    from wirerope_mj.motions.restore import motion_of_levels
    from wirerope_mj.motions.spoken import motion_from_phrase
    from wirerope_mj.runs.scenario import Scenario

    numerics = with_numerics({}, accuracy=accuracy, timestep=timestep)
    spoken = {
        "half-sine": half_sine, "sawtooth": sawtooth, "trapezoid": trapezoid, "velocity-step": velocity_step,
        "double-pulse": double_pulse, "struck-deck": struck_deck, "sine": sine, "sweep": sweep, "psd": psd,
        "spectrum": spectrum, "unbalance": unbalance, "reciprocating": reciprocating, "force": payload_force, "moment": moment,
        "force-table": force_table,
    }  # fmt: skip
    phrases = [(kind, phrase) for kind, several in spoken.items() for phrase in several or ()]
    motions = [motion_from_phrase(kind, phrase) for kind, phrase in phrases]
    names = [*dict.fromkeys(kind for kind, _ in phrases)]
    for file in levels or ():
        motions.append(motion_of_levels(file))
        names.append(file.stem)
    if record is not None:
        played = load_record(
            record, channels=_channels(record, channels, direction), scale=scale, baseline=baseline, start=start,
            highpass=highpass, resample=resample, gaps=gaps, unit=unit,
        )  # fmt: skip
        _check_that_it_moves(record, played, duration)
        motions.append(played)
        names.append(record.stem)
    elif channels is not None or direction is not None:
        raise ValueError("`--direction` and `--channels` belong to a `--record`; other motions say their direction.")
    if not motions:
        raise ValueError('say how the base moves, for instance --half-sine "15 g 11 ms z" or --record deck.csv.')
    motion = sum(motions[1:], start=motions[0])
    name = f"shock-{Path(model).stem}-{'-'.join(names)}"
    options: dict[str, Any] = {
        **{kind: "; ".join(several) if several else None for kind, several in spoken.items()},
        "levels": " ".join(file.name for file in levels) if levels else None,
        "record": record.name if record else None,
        "direction": direction,
        "channels": channels,
        "duration": duration,
    }
    made = Scenario(
        question=QUESTION, model=model, motion=motion, simulate={}, name=name, options=_given(options),
        combined_travel=combined_travel, limits=[limit_from_text(text) for text in limit or ()],
    )  # fmt: skip
    if deck is not None:
        made = made.on_deck(deck_of(deck))
    if duration is None:
        if not math.isfinite(motion.end):
            raise ValueError('this motion has no end: give `--duration`, or say how long it lasts, as in "for 10 s".')
        sweeps = any(
            isinstance(part, Sweep) for part in motion.parts
        )  # goes on at its last frequency, and is best cut there
        duration = motion.end
        if not sweeps:
            duration = _rounded_up(
                motion.end + RING_DOWN * slowest_period(load_system(made.model_source(), isolators=made.isolators))
            )
    if motion.events and duration <= motion.events[0][0]:
        raise ValueError(
            f"`--duration` {duration:g} ends the simulation before anything begins, at {motion.events[0][0]:g} s."
        )
    made = replace(made, simulate={"duration": duration, "initial": initial, "sample_rate": sample_rate} | numerics)
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
        return {name: direction_in(text, "--channels") for name, _, text in pairs}
    names = tuple(channels) if channels is not None else record_channels(record)
    if len(names) != 1 or "=" in names[0]:
        raise ValueError(
            f"`--direction` turns a record of one channel, and here are {', '.join(names) or 'none'}. Say where each one "
            f"goes, for instance --channels {(names or ('ch1',))[0].partition('=')[0]}=z, or name one: --channels NAME "
            "--direction z."
        )
    assert direction is not None
    return {names[0]: direction_in(direction, "--direction")}
