"""`wirerope shock`: a base motion said on the command line, or a measured record, played into a model."""

import inspect
from collections.abc import Callable
from dataclasses import replace
from pathlib import Path
from typing import Annotated, Any, Literal

from cyclopts import Parameter

from wirerope_mj.cli.options import All, Deck, Decks, Force, Repeated, RepeatedPaths, Texts, dated, own_option, with_numerics
from wirerope_mj.foundation.arrays import Entries
from wirerope_mj.motions.registry import SPOKEN_MOTIONS

QUESTION = "What does this motion of the base do to the payload, and do the mounts stay within their limits?"


# the options that say a motion, by their names, and its kind
MOTIONS = {(form.option or kind).replace("-", "_"): kind for kind, form in SPOKEN_MOTIONS.items()}
_BASELINES = Literal["none", "rest", "mean", "velocity", "highpass"]
_HYPHEN = {"allow_leading_hyphen": True}
_RECORD = (
    own_option("record", Path | None, None, (
        'CSV, XLSX, MATLAB, TDMS, HDF5 or Parquet file with units in its header, such as "time [s], x [g], z [m/s^2]", or '
        "universal file with datasets 58."
    )),
    own_option("scale", float, 1.0, "of a record: factor on the acceleration."),
    own_option("direction", str | None, None, (
        "in which a record of one channel moves the base: x, y, z, -x, -y, -z or a vector such as 1,1,0."
    )),
    own_option("channels", Texts, None, (
        "of a record: which to use, NAME=DIRECTION, one or several; those named x, y and z by default. A universal file calls "
        "its channels NODE:DIRECTION, such as 12:z. Columns of angular rates or accelerations turn the base: gx=roll, "
        "gy=pitch, gz=yaw."
    )),
    own_option("baseline", _BASELINES, "none", (
        "correction of a record's baseline: none, rest (the level of the quiet part, gravity for instance), mean, velocity (a "
        "constant, so that the base ends at rest) or highpass."
    )),
    own_option("highpass", float | None, None, "cutoff of the baseline highpass [Hz]."),
    own_option("resample", float | None, None, (
        "rate at which a record is played [Hz], through an anti-alias filter; as sampled by default."
    )),
    own_option("gaps", Literal["refuse", "fill"], "refuse", (
        "what is done about missing samples of a record, absent rows, empty cells and NaN: refuse, or fill with straight lines."
    )),
    own_option("unit", str | None, None, "of a record's accelerations, in place of what the file says, or does not say."),
    own_option("rotation", Literal["base", "world"] | None, None, (
        "of a record with columns of angular rates or accelerations, which then turn the base: base, sensors are fixed to it "
        "and turn with it, or world."
    )),
    own_option("fade", float | None, None, "of a record: length of a smooth rise at its beginning and fall at its end [s]."),
    own_option("sensors_at", str | None, None, (
        '"0 0 300 mm", place of the sensors of a record that turns the base, from the base\'s own origin.'
    ), **_HYPHEN),
    own_option("columns", str | None, None, 'of a record that is a text of numbers alone, such as "time [s], z [g]".'),
    own_option("interval", float | None, None, "of such a record without a time: seconds from row to row."),
    own_option("start", float, 0.0, "instant at which a record begins [s]."),
)  # fmt: skip


def with_motions(function: Callable[..., int]) -> Callable[..., int]:
    """Add one option per kind of motion, and those of a record, behind a command's argument, in place of its **motions."""
    forms = [(name, SPOKEN_MOTIONS[kind]) for name, kind in MOTIONS.items()]
    added = [own_option(name, Repeated, None, f'"{form.example}": {form.summary}') for name, form in forms]
    signature = inspect.signature(function)
    first, *others, _ = signature.parameters.values()
    function.__signature__ = signature.replace(parameters=[first, *added, *_RECORD, *others])  # type: ignore[attr-defined]
    function.__annotations__ |= {option.name: option.annotation for option in (*added, *_RECORD)}
    return function


def said_in_options(given: Entries) -> tuple[list[tuple[str, str]], dict[str, Any]]:
    """Split the given options of those that `with_motions` adds into phrases of motions and settings of a record.

    Returns:
        Kind and text of each phrase, and `record`, `channels`, `direction` and `played` as `said_motion` takes them.

    Raises:
        ValueError: an option of a record is given without one.
    """
    from wirerope_mj.foundation.quantities import values_with_unit
    from wirerope_mj.foundation.units import LENGTH_UNITS
    from wirerope_mj.runs.said_motion import PLAYED, listed_phrases

    texts = {kind: given.get(name) or () for name, kind in MOTIONS.items()}
    phrases = [(kind, phrase) for kind, listed in texts.items() for text in listed for phrase in listed_phrases(text)]
    played = {name: given[name] for name in PLAYED if given.get(name) is not None}
    if "sensors_at" in played:
        played["sensors_at"] = values_with_unit(played["sensors_at"], "length", LENGTH_UNITS)
    recorded = {name: given.get(name) for name in ("record", "channels", "direction")}
    if recorded["record"] is None and (idle := [*played, *(name for name, value in recorded.items() if value is not None)]):
        raise ValueError(f"`--{idle[0].replace('_', '-')}` belongs to `--record`, which is not given.")
    return phrases, recorded | {"played": played}


@with_motions
def shock(
    model: str,
    *,
    levels: RepeatedPaths = None,
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
    **motions: Any,
) -> int:
    """Move a model's base or force its payload: pulses, sines, random vibration, records, unbalance, several at once.

    A motion is said in a few words, in any order: numbers with units, a direction (x, y, z, several as in xyz, -z or a
    vector such as 1,1,0), and "at 50 ms" where it does not begin at once. What is given several times, listed
    with ";" in one text, or in several options, is added.

    wirerope shock cabinet --half-sine "15 g 11 ms z at 50 ms" --limit "acceleration/rack = 12 g"

    Args:
        model: path of a model, or the name of one that ships with the package, such as shock_table.
        levels: TOML file of motions, as `wirerope levels` writes one to fill in.
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
    from wirerope_mj.foundation.resources import model_source
    from wirerope_mj.mounts.isolator import isolators_at
    from wirerope_mj.runs.said_motion import said_motion, with_dwells_found
    from wirerope_mj.runs.scenario import Scenario

    numerics = with_numerics({}, accuracy=accuracy, timestep=timestep)
    phrases, recorded = said_in_options(motions)
    record, channels = recorded["record"], recorded["channels"]
    names = [*dict.fromkeys(kind for kind, _ in phrases), *(file.stem for file in levels or ())]
    names += [record.stem] if record is not None else []
    if not names:
        raise ValueError('say how the base moves, for instance --half-sine "15 g 11 ms z" or --record deck.csv.')
    system = load_system(model_source(model, asker="wirerope shock"))
    devices = None
    if temperature is not None:
        devices = isolators_at(temperature, system.isolators)
        system = load_system(model_source(model, asker="wirerope shock"), isolators=devices)
    if deck is not None:
        system = load_system(deck_text(system, deck_of(deck)), isolators=system.isolators)
    phrases = with_dwells_found(phrases, system)
    motion = said_motion(phrases, levels=levels or (), duration=duration, **recorded)
    name = f"shock-{Path(model).stem}-{'-'.join(names)}"
    options: dict[str, object] = {
        kind: "; ".join(text for one, text in phrases if one == kind) or None for kind in MOTIONS.values()
    }
    options |= {
        "levels": " ".join(file.name for file in levels or ()) or None, "record": record.name if record else None,
        "direction": recorded["direction"], "channels": None if channels is None else " ".join(channels), "duration": duration,
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
