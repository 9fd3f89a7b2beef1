"""Base motions, and forces on the payload, from phrases: what each kind needs and what makes it."""

from collections.abc import Callable
from pathlib import Path
from typing import Any

from wirerope_mj.foundation.directions import Direction, unit_vector
from wirerope_mj.foundation.errors import ConvergenceError
from wirerope_mj.foundation.plain_text import short
from wirerope_mj.motions.harmonic import Sine, Sweep
from wirerope_mj.motions.motion import BaseMotion
from wirerope_mj.motions.payload_forces import ForceTable, HarmonicForce
from wirerope_mj.motions.phrases import START, UNITS, Phrase, SpokenMotion, file_first, one, parse_phrase, site_first
from wirerope_mj.motions.psd_lines import ForceRows, force_rows, psd_points, spectrum_points
from wirerope_mj.motions.pulses import HalfSine, Sawtooth, Trapezoid, VelocityStep
from wirerope_mj.motions.random_vibration import RandomVibration
from wirerope_mj.motions.shock_machines import DecayingSine
from wirerope_mj.motions.spectrum_match import match_spectrum
from wirerope_mj.motions.target_spectra import DesignSpectrum
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


# seed of a phrase at the most: numbers are read as floats, and of larger ones neighbours would be one
LARGEST_SEED = 2**53 - 1
_LASTING = START | {"seed": "", "rise": "time", "fall": "time"}


def _pulse(shape: Callable[..., BaseMotion]) -> Callable[[Phrase, Direction, int, Any], BaseMotion]:
    """Return what makes a pulse of one shape; `rise` is handed on where the phrase says it."""

    def make(phrase: Phrase, direction: Direction, _: int, __: Any) -> BaseMotion:
        more = {"rise": phrase.named["rise"]} if "rise" in phrase.named else {}
        peak, duration = one(phrase, "acceleration"), one(phrase, "time")
        return shape(peak=peak, duration=duration, direction=direction, start=phrase.named.get("at", 0.0), **more)

    return make


def _velocity_step(phrase: Phrase, direction: Direction, _: int, __: Any) -> BaseMotion:
    return VelocityStep(velocity=one(phrase, "velocity"), direction=direction, start=phrase.named.get("at", 0.0))


def _double_pulse(phrase: Phrase, direction: Direction, _: int, __: Any) -> BaseMotion:
    spectrum = DesignSpectrum(**{name: one(phrase, name) for name in ("displacement", "velocity", "acceleration")})
    return spectrum.double_half_sine(direction=direction, start=phrase.named.get("at", 0.0))


def _struck_deck(phrase: Phrase, direction: Direction, _: int, __: Any) -> BaseMotion:
    named = phrase.named
    return DecayingSine(
        frequency=one(phrase, "frequency"), damping=named["damping"], velocity=one(phrase, "velocity"),
        direction=direction, impact_duration=named["blow"], start=named.get("at", 0.0),
    )  # fmt: skip


def _sine(phrase: Phrase, direction: Direction, _: int, __: Any) -> BaseMotion:
    return Sine(
        frequency=one(phrase, "frequency"), acceleration=one(phrase, "acceleration"), direction=direction,
        duration=one(phrase, "time"),
    )  # fmt: skip


def _sweep(phrase: Phrase, direction: Direction, _: int, __: Any) -> BaseMotion:
    start, stop = phrase.quantities["frequency"]
    return Sweep(
        start=start, stop=stop, rate=one(phrase, "sweep rate"), acceleration=one(phrase, "acceleration"),
        direction=direction,
    )  # fmt: skip


def _random(phrase: Phrase, direction: Direction, number: int, points: Any) -> BaseMotion:
    named = phrase.named
    return RandomVibration(
        psd=points, duration=one(phrase, "time"), seed=_seed(phrase) + number, direction=direction,
        rise=named.get("rise"), fall=named.get("fall"), start=named.get("at", 0.0),
    )  # fmt: skip


def _match(phrase: Phrase, direction: Direction, number: int, points: Any) -> BaseMotion:
    named = phrase.named
    return match_spectrum(
        points, duration=one(phrase, "time"), seed=_seed(phrase) + number, direction=direction,
        damping=named["damping"], rise=named.get("rise"), fall=named.get("fall"), start=named.get("at", 0.0),
    ).motion  # fmt: skip


def _seed(phrase: Phrase) -> int:
    seed = phrase.named.get("seed", 1.0)
    if seed != int(seed) or not 0 <= seed <= LARGEST_SEED:
        raise ValueError(f"a seed is an integer from 0 to {LARGEST_SEED}, got {seed:.17g}.")
    return int(seed)


_PULSE_NEEDS = {"acceleration": 1, "time": 1}

# motions of the base, by name
BASE_MOTIONS: dict[str, SpokenMotion] = {
    "half-sine": SpokenMotion(
        example="15 g 11 ms z", summary="half-sine: peak, length, direction", needs=_PULSE_NEEDS, make=_pulse(HalfSine)
    ),
    "sawtooth": SpokenMotion(
        example="20 g 11 ms z",
        summary="terminal-peak sawtooth: peak, length, direction",
        needs=_PULSE_NEEDS,
        make=_pulse(Sawtooth),
    ),
    "trapezoid": SpokenMotion(
        example="10 g 18 ms rise 2 ms z",
        summary="trapezoid: peak, length, rise, direction",
        needs=_PULSE_NEEDS,
        make=_pulse(Trapezoid),
        words=START | {"rise": "time"},
        needed_words=("rise",),
    ),
    "velocity-step": SpokenMotion(
        example="2 m/s z", summary="velocity at once", needs={"velocity": 1}, make=_velocity_step
    ),
    "double-pulse": SpokenMotion(
        example="50 mm 3 m/s 100 g z",
        summary="double half-sine of a design spectrum d0, v0, a0",
        needs={"displacement": 1, "velocity": 1, "acceleration": 1},
        make=_double_pulse,
    ),
    "struck-deck": SpokenMotion(
        example="14 Hz 1.5 m/s damping 5 % blow 4 ms z",
        summary="deck of one frequency under a blow: frequency, velocity, damping, length of the blow, direction",
        needs={"frequency": 1, "velocity": 1},
        make=_struck_deck,
        words=START | {"damping": "ratio", "blow": "time"},
        needed_words=("damping", "blow"),
    ),
    "sine": SpokenMotion(
        example="0.5 g 12 Hz 10 s z",
        summary="steady sine: amplitude, frequency, length, direction",
        needs={"acceleration": 1, "frequency": 1, "time": 1},
        make=_sine,
        words={},
    ),
    "sweep": SpokenMotion(
        example="0.5 g 5 to 50 Hz 2 oct/min z",
        summary="logarithmic sine sweep: amplitude, frequencies, rate, direction",
        needs={"acceleration": 1, "frequency": 2, "sweep rate": 1},
        make=_sweep,
        words={},
    ),
    "psd": SpokenMotion(
        example="transport.csv 30 s z seed 1",
        summary='random vibration: CSV file with "frequency [Hz], psd [g^2/Hz]", length, direction',
        needs={"time": 1},
        make=_random,
        words=_LASTING,
        begins=file_first(psd_points),
    ),
    "spectrum": SpokenMotion(
        example="floor.csv 20 s x damping 5 % seed 1",
        summary='earthquake-like: CSV file of a response spectrum, "frequency [Hz], acceleration [g]", length, direction',
        needs={"time": 1},
        make=_match,
        words=_LASTING | {"damping": "ratio"},
        needed_words=("damping",),
        begins=file_first(spectrum_points),
    ),
}


SPOKEN_MOTIONS: dict[str, SpokenMotion] = BASE_MOTIONS | FORCES  # kinds of motion that a phrase says, by name


def motion_from_phrase(kind: str, text: str, *, folder: Path | None = None) -> BaseMotion:
    """Return the base motion that a phrase says; along several axes, as in "xyz", the sum of one along each.

    Args:
        kind: one of `SPOKEN_MOTIONS`.
        text: the phrase, such as "15 g 11 ms z at 50 ms".
        folder: where the relative path of a file starts; None: the current folder.

    Raises:
        ValueError: the phrase is not understood, or says too little or too much; ends with an example.
        RecordError: a file that it names cannot be read.
    """
    spoken = SPOKEN_MOTIONS[kind]
    try:
        begun, rest = (None, text) if spoken.begins is None else spoken.begins(text, folder or Path())
        phrase = parse_phrase(rest, words=spoken.words)
        _check(spoken, phrase)
        directions = phrase.directions if spoken.directed else ("z",)
        made = [spoken.make(phrase, direction, n, begun) for n, direction in enumerate(directions)]
    except ValueError as error:
        raise ValueError(f'{kind} "{short(text)}": {error} It is written like "{spoken.example}".') from None
    except ConvergenceError as error:
        raise ConvergenceError(f'{kind} "{short(text)}": {error}') from None
    return sum(made[1:], start=made[0])


def _check(spoken: SpokenMotion, phrase: Phrase) -> None:
    """Raise ValueError unless a phrase says as much as its kind needs, and no more."""
    for quantity in dict.fromkeys((*spoken.needs, *phrase.quantities)):
        there, needed = len(phrase.quantities.get(quantity, ())), spoken.needs.get(quantity, 0)
        if there <= spoken.may.get(quantity, -1):
            continue
        if there < needed:
            units = ", ".join(UNITS[quantity])
            raise ValueError(f"{_counted(needed, quantity)} must stand there ({units}), and there {_are(there)}.")
        if there > needed:
            raise ValueError(f"there {_are(there)} of {quantity}, and {needed or 'none'} is expected.")
    for word in spoken.needed_words:
        if word not in phrase.named:
            raise ValueError(f'"{word}" and its value must stand there.')
    if spoken.directed and not phrase.directions:
        raise ValueError("a direction must stand there: x, y, z, several as in xyz, -z or a vector such as 1,1,0.")
    if phrase.directions and not spoken.directed:
        raise ValueError("a direction stands there, and none is expected: the columns of its table say it.")


def _counted(number: int, quantity: str) -> str:
    return f"{'an' if quantity[0] in 'au' else 'a'} {quantity}" if number == 1 else f"{number} values of {quantity}"


def _are(number: int) -> str:
    return "is none" if number == 0 else "is one" if number == 1 else f"are {number}"
