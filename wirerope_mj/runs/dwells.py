"""Amplitude tables that dwell at what is found: the response prominences of a model, by one steady sine after another."""

from collections.abc import Sequence
from itertools import groupby
from pathlib import Path

import numpy as np

from wirerope_mj.dynamics.sweep.sweeps import stepped_sine
from wirerope_mj.engine.system import System
from wirerope_mj.foundation.arrays import Array
from wirerope_mj.motions.phrases import file_first, parse_phrase
from wirerope_mj.motions.psd_lines import Points, table_lines
from wirerope_mj.motions.spoken import SPOKEN_MOTIONS, motion_from_phrase

KIND = "amplitude-table"
# Amplitudes are settled and computed to this, and a maximum stands out by ten times as much, so that none is rounding.
SETTLED, STANDS_OUT = 1e-3, 1e-2
MOST_CYCLES = 300  # at a line: what static load still leaks away after that moves no maximum


def with_dwells_found(
    phrases: Sequence[tuple[str, str]], system: System, *, folder: Path | None = None
) -> list[tuple[str, str]]:
    """Complete amplitude tables that `dwell` without a frequency by those of the system's response prominences.

    Raises:
        ValueError: such a phrase lacks something, or the base moves along several directions at once.
        RecordError: its file cannot be read.
        SimulationError: the table goes beyond what the system can follow.
    """
    return [(kind, _completed(text, system, folder or Path()) if kind == KIND else text) for kind, text in phrases]


def _completed(text: str, system: System, folder: Path) -> str:
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
    found = prominences(system, quantity, lines, phrase.directions[0])
    return f"{text} {' '.join(f'{frequency:.17g} Hz' for frequency in found)}"


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
            response_direction="z", initial=state, settled=SETTLED, largest_cycles=MOST_CYCLES, accuracy=SETTLED,
            **{quantity: level},
        )  # fmt: skip
        state = part.final_state
        bodies.append([part.envelopes[name].transmissibility.max(axis=1) for name in system.payloads])
    found = set[int]()
    for parts in zip(*bodies, strict=True):
        curve = np.concatenate([[0.0], *parts, [0.0]])
        beside = np.maximum(curve[:-2], curve[2:])
        found |= set(np.flatnonzero(curve[1:-1] > (1.0 + STANDS_OUT) * beside).tolist())
    return [lines[number][0] for number in sorted(found)]
