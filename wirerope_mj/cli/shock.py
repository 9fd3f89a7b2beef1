"""`wirerope shock`: a base motion said on the command line, or a measured record, played into a model."""

import inspect
from collections.abc import Callable
from dataclasses import replace
from pathlib import Path
from typing import Annotated, Literal

from cyclopts import Parameter

from wirerope_mj.cli.options import All, Deck, Decks, Force, Repeated, RepeatedPaths, Texts, dated, own_option, with_numerics
from wirerope_mj.motions.registry import SPOKEN_MOTIONS

QUESTION = "What does this motion of the base do to the payload, and do the mounts stay within their limits?"


# defaults of the options of a record that are not None
_UNPLAYED = {"scale": 1.0, "baseline": "none", "start": 0.0, "gaps": "refuse"}
# the options that say a motion, by their names, and its kind
MOTIONS = {(form.option or kind).replace("-", "_"): kind for kind, form in SPOKEN_MOTIONS.items()}


def with_motions(function: Callable[..., int]) -> Callable[..., int]:
    """Add an option for every phrase of a motion, behind the argument of a command."""
    forms = [(name, SPOKEN_MOTIONS[kind]) for name, kind in MOTIONS.items()]
    added = [own_option(name, Repeated, None, f'"{form.example}": {form.summary}') for name, form in forms]
    signature = inspect.signature(function)
    first, *others, _ = signature.parameters.values()
    function.__signature__ = signature.replace(parameters=[first, *added, *others])  # type: ignore[attr-defined]
    function.__annotations__ |= {option.name: option.annotation for option in added}
    return function


@with_motions
def shock(
    model: str,
    *,
    levels: RepeatedPaths = None,
    record: Path | None = None,
    scale: float = 1.0,
    direction: str | None = None,
    channels: Texts = None,
    baseline: Literal["none", "rest", "mean", "velocity", "highpass"] = "none",
    highpass: float | None = None,
    resample: float | None = None,
    gaps: Literal["refuse", "fill"] = "refuse",
    unit: str | None = None,
    rotation: Literal["base", "world"] | None = None,
    fade: float | None = None,
    sensors_at: Annotated[str | None, Parameter(allow_leading_hyphen=True)] = None,
    columns: str | None = None,
    interval: float | None = None,
    start: float = 0.0,
    duration: float | None = None,
    initial: Literal["settled", "relaxed", "unloaded"] | None = None,
    sample_rate: float = 1000.0,
    accuracy: float | None = None,
    timestep: float | None = None,
    temperature: Annotated[str | None, Parameter(allow_leading_hyphen=True)] = None,
    deck: Deck = None,
    decks: Decks = False,
    limit: Repeated = None,
    combined_travel: bool = True,
    out: Path | None = None,
    every: All = False,
    force: Force = False,
    **motions: list[str] | None,
) -> int:
    """Move a model's base or force its payload: pulses, sines, random vibration, records, unbalance, several at once.

    A motion is said in a few words, in any order: numbers with units, a direction (x, y, z, several as in xyz, -z or a
    vector such as 1,1,0), and "at 50 ms" where it does not begin at once. What is given several times, listed
    with ";" in one text, or in several options, is added.

    wirerope shock cabinet --half-sine "15 g 11 ms z at 50 ms" --limit "acceleration/rack = 12 g"

    Args:
        model: path of a model, or the name of one that ships with the package, such as shock_table.
        levels: TOML file of motions, as `wirerope levels` writes one to fill in.
        record: CSV, XLSX, MATLAB, TDMS, HDF5 or Parquet file with units in its header, such as "time [s], x [g], z [m/s^2]", or
            universal file with datasets 58.
        scale: of a record: factor on the acceleration.
        direction: in which a record of one channel moves the base: x, y, z, -x, -y, -z or a vector such as 1,1,0.
        channels: of a record: which to use, NAME=DIRECTION, one or several; those named x, y and z by default. A universal
            file calls its channels NODE:DIRECTION, such as 12:z. Columns of angular rates or accelerations turn the base:
            gx=roll, gy=pitch, gz=yaw.
        baseline: correction of a record's baseline: none, rest (the level of the quiet part, gravity for instance), mean,
            velocity (a constant, so that the base ends at rest) or highpass.
        highpass: cutoff of the baseline highpass [Hz].
        resample: rate at which a record is played [Hz], through an anti-alias filter; as sampled by default.
        gaps: what is done about missing samples of a record, absent rows, empty cells and NaN: refuse, or fill with straight
            lines.
        unit: of a record's accelerations, in place of what the file says, or does not say.
        rotation: of a record with columns of angular rates or accelerations, which then turn the base: base, sensors are fixed
            to it and turn with it, or world.
        fade: of a record: length of a smooth rise at its beginning and fall at its end [s].
        sensors_at: "0 0 300 mm", place of the sensors of a record that turns the base, from the base's own origin.
        columns: of a record that is a text of numbers alone, such as "time [s], z [g]".
        interval: of such a record without a time: seconds from row to row.
        start: instant at which a record begins [s].
        duration: simulated time [s]; by default until ten periods of the slowest mode after the motion, with a sweep until
            its end.
        initial: state in which it begins: settled under its weight, relaxed (after long vibration) or unloaded; by
            default settled, and unloaded for a drop.
        sample_rate: of the response [Hz].
        accuracy: error allowed, as a fraction of the peaks; the step is chosen for it: 1e-4 by default.
        timestep: largest step [s], in place of one that is chosen; no error is estimated then.
        temperature: "-20 degC" of the isolators, whose files state factors for it in [temperature].
        limit: "acceleration/rack = 15 g" or "clearance/rack_top = 30 30 20 mm", of the payload, "load/m3 = 5 kN" of a mount,
            "force/s1 = 10 kN", "closing/s1 = 0.5 m/s" or "gap/s1 = 80 %" of its stops, in place of the model's; with
            "stops = none" no stop may be touched.
        combined_travel: judge mounts on all axes at once, by this program's own rule.
        out: folder of the run; runs/shock-MODEL-MOTION-DATE-TIME by default.
    """
    from wirerope_mj.cli.tables import run_and_print
    from wirerope_mj.engine.flexible import deck_of
    from wirerope_mj.engine.simulation.simulate import duration_of
    from wirerope_mj.engine.system import load_system
    from wirerope_mj.engine.system.on_deck import deck_text
    from wirerope_mj.foundation.payload_limits import limit_from_text
    from wirerope_mj.foundation.quantities import values_with_unit
    from wirerope_mj.foundation.resources import model_source
    from wirerope_mj.foundation.units import LENGTH_UNITS
    from wirerope_mj.mounts.isolator import isolators_at
    from wirerope_mj.runs.said_motion import listed_phrases, said_motion, with_dwells_found
    from wirerope_mj.runs.scenario import Scenario

    numerics = with_numerics({}, accuracy=accuracy, timestep=timestep)
    given = {kind: motions.get(name) or () for name, kind in MOTIONS.items()}
    phrases = [(kind, phrase) for kind, texts in given.items() for text in texts for phrase in listed_phrases(text)]
    names = [*dict.fromkeys(kind for kind, _ in phrases), *(file.stem for file in levels or ())]
    names += [record.stem] if record is not None else []
    if not (names or channels or direction):
        raise ValueError('say how the base moves, for instance --half-sine "15 g 11 ms z" or --record deck.csv.')
    played = {
        "scale": scale, "baseline": baseline, "start": start, "highpass": highpass, "resample": resample, "gaps": gaps,
        "unit": unit, "rotation": rotation, "fade": fade, "columns": columns, "interval": interval,
    } | ({} if sensors_at is None else {"sensors_at": values_with_unit(sensors_at, "length", LENGTH_UNITS)})  # fmt: skip
    idle = [name for name, value in played.items() if value != _UNPLAYED.get(name)]
    if record is None and idle:
        raise ValueError(f"`--{idle[0].replace('_', '-')}` belongs to `--record`, which is not given.")
    system = load_system(model_source(model, asker="wirerope shock"))
    devices = None
    if temperature is not None:
        devices = isolators_at(temperature, system.isolators)
        system = load_system(model_source(model, asker="wirerope shock"), isolators=devices)
    if deck is not None:
        system = load_system(deck_text(system, deck_of(deck)), isolators=system.isolators)
    phrases = with_dwells_found(phrases, system)
    motion = said_motion(
        phrases, levels=levels or (), record=record, channels=channels, direction=direction, played=played, duration=duration,
    )  # fmt: skip
    name = f"shock-{Path(model).stem}-{'-'.join(names)}"
    options: dict[str, object] = {
        kind: "; ".join(text for one, text in phrases if one == kind) or None for kind in MOTIONS.values()
    }
    options |= {
        "levels": " ".join(file.name for file in levels or ()) or None, "record": record.name if record else None,
        "direction": direction, "channels": None if channels is None else " ".join(channels), "duration": duration,
        "temperature": temperature,
    }  # fmt: skip
    made = Scenario(
        question=QUESTION, model=model, motion=motion, simulate={}, name=name, combined_travel=combined_travel,
        options={name: value for name, value in options.items() if value is not None},
        limits=[limit_from_text(text) for text in limit or ()], isolators=devices,
    )  # fmt: skip
    made = made if deck is None else made.on_deck(deck_of(deck))
    duration = duration_of(motion, duration, system)
    initially = {"initial": initial} if initial else {}
    made = replace(made, simulate={"duration": duration, "sample_rate": sample_rate} | initially | numerics)
    folder = out or dated(name)
    run_and_print(made, folder, force=force, every=every, decks=decks)
    return 0
