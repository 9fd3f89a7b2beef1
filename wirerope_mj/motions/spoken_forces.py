"""Forces on the payload that a phrase says."""

from collections.abc import Callable
from pathlib import Path
from typing import Any

from wirerope_mj.foundation.directions import Direction, unit_vector
from wirerope_mj.motions.level_files import ForceRows, force_rows
from wirerope_mj.motions.motion import BaseMotion
from wirerope_mj.motions.payload_forces import ForceTable, HarmonicForce
from wirerope_mj.motions.phrases import Phrase
from wirerope_mj.motions.spoken_kind import START, SpokenMotion, file_first, one, site_first
from wirerope_mj.motions.unbalance import Unbalance


def _site_and_table(text: str, folder: Path) -> tuple[tuple[str, ForceRows], str]:
    """Return site and table of forces that a phrase begins with, and what follows."""
    site, rest = site_first(text, folder)
    rows, left = file_first(force_rows)(rest, folder)
    return (site, rows), left


def _unbalance(phrase: Phrase, direction: Direction, _: int, site: str) -> BaseMotion:
    return Unbalance(site=site, axis=direction, **_shaft(phrase))


def _reciprocating(phrase: Phrase, direction: Direction, _: int, site: str) -> BaseMotion:
    return Unbalance(site=site, line=direction, **_shaft(phrase))


def _shaft(phrase: Phrase) -> dict[str, Any]:
    """Return size, speed and order of an unbalance; a time is that of a run-up, between two frequencies."""
    named, frequencies = phrase.named, phrase.quantities.get("frequency", ())
    if len(frequencies) != (2 if "time" in phrase.quantities else 1):
        raise ValueError("one frequency must stand there, or two and the time of the run-up between them.")
    values = {"unbalance": one(phrase, "unbalance"), "frequency": frequencies[0], "order": named.get("order", 1.0)}
    values["start"] = named.get("at", 0.0)
    if len(frequencies) == 2:
        values |= {"final_frequency": frequencies[1], "run_up": one(phrase, "time")}
    return values | ({"duration": named["for"]} if "for" in named else {})


def _harmonic(quantity: str) -> Callable[[Phrase, Direction, int, str], BaseMotion]:
    def make(phrase: Phrase, direction: Direction, _: int, site: str) -> BaseMotion:
        vector = (one(phrase, quantity) * unit_vector(direction)).tolist()
        return HarmonicForce(
            site=site, frequency=one(phrase, "frequency"), duration=one(phrase, "time"), start=phrase.named.get("at", 0.0),
            **{quantity: vector},
        )  # fmt: skip

    return make


def _force_table(phrase: Phrase, _: Direction, __: int, begun: tuple[str, ForceRows]) -> BaseMotion:
    site, (times, loads) = begun
    return ForceTable(site=site, times=times, loads=loads, start=phrase.named.get("at", 0.0))


# forces on the payload, by name
FORCES: dict[str, SpokenMotion] = {
    "unbalance": SpokenMotion(
        example="engine 20 kg.mm 5 to 30 Hz 20 s x",
        summary="unbalance of a shaft: site, size, speed or run-up, axis",
        needs={"unbalance": 1},
        make=_unbalance,
        words=START | {"order": "", "for": "time"},
        begins=site_first,
        may={"time": 1, "frequency": 2},
    ),
    "reciprocating": SpokenMotion(
        example="engine 8 kg.mm 25 Hz order 2 z",
        summary="unbalance of what reciprocates: site, size, speed or run-up, order, line",
        needs={"unbalance": 1},
        make=_reciprocating,
        words=START | {"order": "", "for": "time"},
        begins=site_first,
        may={"time": 1, "frequency": 2},
    ),
    "force": SpokenMotion(
        example="engine 500 N 12 Hz 10 s z",
        summary="harmonic force on the payload: site, amplitude, frequency, length, direction",
        needs={"force": 1, "frequency": 1, "time": 1},
        make=_harmonic("force"),
        begins=site_first,
    ),
    "moment": SpokenMotion(
        example="engine 80 N.m 12 Hz 10 s y",
        summary="harmonic moment on the payload: site, amplitude, frequency, length, axis",
        needs={"moment": 1, "frequency": 1, "time": 1},
        make=_harmonic("moment"),
        begins=site_first,
    ),
    "force-table": SpokenMotion(
        example="engine start.csv at 1 s",
        summary='forces and moments of a table: site, CSV file with "time [s], fz [N], mx [N.m]" and the like',
        needs={},
        make=_force_table,
        begins=_site_and_table,
        directed=False,
    ),
}
