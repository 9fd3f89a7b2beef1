"""`wirerope shock`: a base motion said on the command line, or a measured record, played into a model."""

from dataclasses import replace
from pathlib import Path
from typing import Literal

from wirerope_mj.cli.options import Deck, Flag, Repeated, RepeatedPaths, Texts, dated, with_numerics

QUESTION = "What does this motion of the base do to the payload, and do the mounts stay within their limits?"


def shock(
    model: str,
    *,
    half_sine: Repeated = None,
    sawtooth: Repeated = None,
    trapezoid: Repeated = None,
    velocity_step: Repeated = None,
    double_pulse: Repeated = None,
    struck_deck: Repeated = None,
    struck_plate: Repeated = None,
    sine: Repeated = None,
    sweep: Repeated = None,
    psd: Repeated = None,
    amplitude_table: Repeated = None,
    spectrum: Repeated = None,
    required_spectrum: Repeated = None,
    unbalance: Repeated = None,
    reciprocating: Repeated = None,
    payload_force: Repeated = None,
    moment: Repeated = None,
    hammer: Repeated = None,
    force_table: Repeated = None,
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
    start: float = 0.0,
    duration: float | None = None,
    initial: Literal["settled", "relaxed", "unloaded"] = "settled",
    sample_rate: float = 1000.0,
    accuracy: float | None = None,
    timestep: float | None = None,
    deck: Deck = None,
    limit: Repeated = None,
    combined_travel: bool = True,
    out: Path | None = None,
    force: Flag = False,
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
        struck_plate: "14 MPa 0.9 ms 320 kg/m2 z": a hull plate under an underwater shock wave: pressure, decay, mass per area.
        sine: "0.5 g 12 Hz 10 s z": steady sine.
        sweep: "0.5 g 5 to 50 Hz 2 oct/min z": logarithmic sine sweep.
        psd: "transport.csv 30 s z seed 1": random vibration of a file with "frequency [Hz], psd [g^2/Hz]".
        amplitude_table: "levels.csv 10 s z": steady sines, one frequency after the other, of a file with
            "from [Hz], to [Hz], displacement [mm]" in steps of 1 Hz, or "frequency [Hz], displacement [mm]"; with "dwell 60 s"
            then 60 s at each response prominence of the model, with "dwell 60 s 7 Hz 12 Hz" at these.
        spectrum: "floor.csv 20 s x damping 5 % seed 1": a motion with the response spectrum of a file with
            "frequency [Hz], acceleration [g]".
        required_spectrum: "rrs.csv 30 s x damping 5 % seed 1": the same, its spectrum nowhere below that of the file.
        unbalance: "engine 20 kg.mm 5 to 30 Hz 20 s x": a force on the payload, at its site force/engine: unbalance of a shaft
            about x, running up within 20 s; "25 Hz" for constant speed; "order 2", "for 10 s".
        reciprocating: "engine 8 kg.mm 25 Hz order 2 z": the same of what moves to and fro along z.
        payload_force: "engine 500 N 12 Hz 10 s z": harmonic force.
        moment: "engine 80 N.m 12 Hz 10 s y": harmonic moment.
        hammer: "anvil 9.8 kN.s 1 ms z": a blow, by its impulse and length.
        force_table: "engine start.csv at 1 s": forces and moments of a file with "time [s], fz [N], mx [N.m]" and the like.
        levels: TOML file of motions, as `wirerope levels` writes one to fill in.
        record: CSV, MATLAB (-v7), XLSX or Parquet file with units in its header, such as "time [s], x [g], z [m/s^2]", or
            universal file with datasets 58.
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
        limit: "acceleration/rack = 15 g" or "clearance/rack_top = 30 30 20 mm": a limit of the payload, in place of the
            model's.
        combined_travel: judge mounts on all axes at once, by this program's own rule.
        out: folder of the run; runs/shock-MODEL-MOTION-DATE-TIME by default.
        force: replace a run that is there.
    """
    from wirerope_mj.cli.tables import run_and_print
    from wirerope_mj.engine.flexible import deck_of
    from wirerope_mj.engine.simulation.simulate import duration_of
    from wirerope_mj.engine.system import load_system
    from wirerope_mj.engine.system.on_deck import deck_text
    from wirerope_mj.foundation.payload_limits import limit_from_text
    from wirerope_mj.foundation.resources import model_source
    from wirerope_mj.runs.said_motion import said_motion, with_dwells_found
    from wirerope_mj.runs.scenario import Scenario

    numerics = with_numerics({}, accuracy=accuracy, timestep=timestep)
    spoken = {
        "half-sine": half_sine, "sawtooth": sawtooth, "trapezoid": trapezoid, "velocity-step": velocity_step,
        "double-pulse": double_pulse, "struck-deck": struck_deck, "struck-plate": struck_plate,
        "sine": sine, "sweep": sweep, "psd": psd, "amplitude-table": amplitude_table,
        "spectrum": spectrum, "required-spectrum": required_spectrum,
        "unbalance": unbalance, "reciprocating": reciprocating, "force": payload_force, "moment": moment,
        "hammer": hammer, "force-table": force_table,
    }  # fmt: skip
    phrases = [(kind, phrase) for kind, several in spoken.items() for phrase in several or ()]
    names = [*dict.fromkeys(kind for kind, _ in phrases), *(file.stem for file in levels or ())]
    names += [record.stem] if record is not None else []
    if not (names or channels or direction):
        raise ValueError('say how the base moves, for instance --half-sine "15 g 11 ms z" or --record deck.csv.')
    played = {
        "scale": scale, "baseline": baseline, "start": start, "highpass": highpass, "resample": resample, "gaps": gaps,
        "unit": unit,
    }  # fmt: skip
    system = load_system(model_source(model, asker="wirerope shock"))
    if deck is not None:
        system = load_system(deck_text(system, deck_of(deck)), isolators=system.isolators)
    phrases = with_dwells_found(phrases, system)
    motion = said_motion(
        phrases, levels=levels or (), record=record, channels=channels, direction=direction, played=played, duration=duration,
    )  # fmt: skip
    name = f"shock-{Path(model).stem}-{'-'.join(names)}"
    options: dict[str, object] = {kind: "; ".join(text for one, text in phrases if one == kind) or None for kind in spoken}
    options |= {
        "levels": " ".join(file.name for file in levels or ()) or None, "record": record.name if record else None,
        "direction": direction, "channels": None if channels is None else " ".join(channels), "duration": duration,
    }  # fmt: skip
    made = Scenario(
        question=QUESTION, model=model, motion=motion, simulate={}, name=name, combined_travel=combined_travel,
        options={name: value for name, value in options.items() if value is not None},
        limits=[limit_from_text(text) for text in limit or ()],
    )  # fmt: skip
    made = made if deck is None else made.on_deck(deck_of(deck))
    duration = duration_of(motion, duration, system)
    made = replace(made, simulate={"duration": duration, "initial": initial, "sample_rate": sample_rate} | numerics)
    folder = out or dated(name)
    run_and_print(made, folder, force=force)
    return 0
