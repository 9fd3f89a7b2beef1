"""Base motions as commands and files of jobs say them: phrases, files of levels and a record added, and where tables dwell."""

from collections.abc import Sequence
from itertools import groupby
from pathlib import Path

import numpy as np

from wirerope_mj.dynamics.sweep.sweeps import stepped_sine
from wirerope_mj.engine.system import System
from wirerope_mj.foundation.arrays import Array, Entries
from wirerope_mj.foundation.directions import ROTATIONS, direction_in
from wirerope_mj.foundation.errors import RecordError
from wirerope_mj.foundation.faults import Faults, each
from wirerope_mj.foundation.quantities import parse_phrase
from wirerope_mj.motions import BaseMotion, load_record
from wirerope_mj.motions.phrases import file_first
from wirerope_mj.motions.psd_lines import Points, table_lines
from wirerope_mj.motions.records.record import record_channels
from wirerope_mj.motions.registry import SPOKEN_MOTIONS, motion_from_phrase, motion_of_levels

# What is said of how a record is played, beside its channels and their directions, as `load_record` takes it.
PLAYED = (
    "scale", "baseline", "start", "highpass", "resample", "gaps", "unit", "rotation", "fade", "sensors_at", "columns",
    "interval",
)  # fmt: skip


def listed_phrases(text: str) -> list[str]:
    """Split a text into its phrases, which ";" separates."""
    return [phrase.strip() for phrase in text.split(";") if phrase.strip()] or [text]


def said_motion(
    phrases: Sequence[tuple[str, str]], *, levels: Sequence[Path] = (), record: Path | None = None,
    channels: Sequence[str] | None = None, direction: str | None = None, played: Entries | None = None,
    duration: float | None = None, folder: Path | None = None,
) -> BaseMotion:  # fmt: skip
    """Add the motions of phrases, each a kind of `SPOKEN_MOTIONS` and a text, of levels files and of a record.

    `channels` of the record are those to use, NAME=DIRECTION, or one with a `direction`; it is `played` as `load_record`
    takes it, by the names of `PLAYED`, and must begin within the `duration` of the simulation [s], if that is known.
    Relative paths in phrases start at `folder`, else at the current one.

    ValueError if nothing is said, a phrase is not understood, or the record would not move the base; ModelError or
    RecordError if a file cannot be read, or does not hold what it must.
    """
    motions: list[BaseMotion] = []
    with Faults() as faults:
        with faults.apart():
            motions += each(lambda said: motion_from_phrase(*said, folder=folder), phrases)
        with faults.apart():
            motions += each(motion_of_levels, levels)
        motions += _played(record, channels, direction, played or {}, duration)
    return sum(motions[1:], start=motions[0])


def _played(
    record: Path | None, channels: Sequence[str] | None, direction: str | None, played: Entries, duration: float | None
) -> list[BaseMotion]:
    """Return the motion of a measured record in a list, which is empty without one; arguments are those of `said_motion`."""
    if record is not None:
        record_motion = load_record(record, channels=_channels(record, channels, direction, played), **played)
        if not (record_motion.samples.any() or record_motion.rotates):
            zero = "all of its samples are zero" if record_motion.baseline == "none" else "nothing but zeros is left of it"
            text = f"{zero}, so that the base would not move. Is it the right file, and the right channel?"
            raise RecordError(f"{record}: {text}")
        if record_motion.end <= 0.0:
            raise ValueError(
                f"`start` {record_motion.start:g} lets the record end at {record_motion.end:g} s, before the simulation begins "
                "at 0 s: the base would not move. Start it at 0 s or later."
            )
        if duration is not None and duration <= record_motion.start:
            text = (
                f"`duration` {duration:g} ends the simulation before the record begins, at {record_motion.start:g} s (`start`)."
            )
            raise ValueError(text)
        return [record_motion]
    if channels is not None or direction is not None:
        raise ValueError("`direction` and `channels` belong to a `record`; other motions say their direction.")
    return []


def _channels(record: Path, channels: Sequence[str] | None, direction: str | None, played: Entries) -> Entries | None:
    """Return the channel that moves the base in each direction; None if the channels' names decide."""
    if channels is None and direction is None:
        return None
    if channels is not None and direction is None:
        pairs = [item.rpartition("=") for item in channels]
        for item, (name, _, _) in zip(channels, pairs, strict=True):
            if not name:
                raise ValueError(f"`channels` are NAME=DIRECTION, for instance ch3=z, got {item!r}.")
        return {name: text if text.lstrip("+-") in ROTATIONS else direction_in(text, "channels") for name, _, text in pairs}
    stated = {name: played[name] for name in ("columns", "interval") if name in played}
    names = tuple(channels) if channels is not None else record_channels(record, accelerations=True, **stated)
    if len(names) != 1 or "=" in names[0]:
        raise ValueError(
            f"`direction` turns a record of one channel, and here are {', '.join(names) or 'none'}. Say where each one "
            f"goes in `channels`, for instance {(names or ('ch1',))[0].partition('=')[0]}=z, or name one channel with a "
            "`direction`."
        )
    assert direction is not None
    return {names[0]: direction_in(direction, "direction")}


KIND = "amplitude-table"
# Amplitudes are settled and computed to this, and a maximum stands out by ten times as much, so that none is rounding.
SETTLED, _STANDS_OUT = 1e-3, 1e-2
_MOST_CYCLES = 300  # at a line: what static load still leaks away after that moves no maximum


def with_dwells_found(
    phrases: Sequence[tuple[str, str]], system: System, *, folder: Path | None = None
) -> list[tuple[str, str]]:
    """Add to phrases of amplitude tables with "dwell" and no frequency those at which the system's response has a maximum.

    Raises:
        ValueError: such a phrase lacks something, or the base moves along several directions at once.
        RecordError: its file cannot be read.
        SimulationError: the table goes beyond what the system can follow.
    """
    return [(kind, _completed(text, system, folder or Path()) if kind == KIND else text) for kind, text in phrases]


def _completed(text: str, system: System, folder: Path) -> str:
    """Append the frequencies of the dwells to an amplitude table's phrase that asks for dwells and states none."""
    try:
        (quantity, lines), rest = file_first(table_lines)(text, folder)
        phrase = parse_phrase(rest, words=SPOKEN_MOTIONS[KIND].words)
    except ValueError:
        return text  # what is wrong with it is said where the motion is made
    if "dwell" not in phrase.named or "frequency" in phrase.quantities or not system.payloads:
        return text
    motion_from_phrase(KIND, f"{text} {lines[0][0]:.17g} Hz", folder=folder)  # so is what is lacking
    if len(phrase.directions) != 1:
        raise ValueError(f'{KIND} "{text}": frequencies for dwells are found along one direction; shake the axes one by one.')
    frequencies = prominences(system, quantity, lines, phrase.directions[0])
    return f"{text} {' '.join(f'{frequency:.17g} Hz' for frequency in frequencies)}"


def prominences(system: System, quantity: str, lines: Points, direction: str | Sequence[float]) -> list[float]:
    """Find the frequencies [Hz] of a table's lines at which a payload's transmissibility has a local maximum.

    Each line is a steady sine until the response has settled. Transmissibility is the largest absolute acceleration of a
    payload's centre of mass along x, y or z over the base's. Ends of the table count where they stand above their neighbour,
    and so does what is below 1, as MIL-STD-167-1A, appendix A.2.2, lists candidates for its endurance test.
    """
    bodies: list[list[Array]] = []
    state = None
    for level, band in groupby(lines, key=lambda line: line[1]):
        part = stepped_sine(
            system, frequencies=[frequency for frequency, _ in band], direction=direction, payload=system.payloads[0],
            response_direction="z", initial=state, settled=SETTLED, largest_cycles=_MOST_CYCLES, accuracy=SETTLED,
            **{quantity: level},
        )  # fmt: skip
        state = part.final_state
        bodies.append([part.envelopes[name].transmissibility.max(axis=1) for name in system.payloads])
    lines_found = set[int]()
    for parts in zip(*bodies, strict=True):
        curve = np.concatenate([[0.0], *parts, [0.0]])
        beside = np.maximum(curve[:-2], curve[2:])
        lines_found |= set(np.flatnonzero(curve[1:-1] > (1.0 + _STANDS_OUT) * beside).tolist())
    return [lines[number][0] for number in sorted(lines_found)]
