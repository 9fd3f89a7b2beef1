"""Base motions from phrases: what each kind needs, and the motion that it makes."""

from collections.abc import Callable, Mapping
from dataclasses import dataclass, field
from pathlib import Path

from wirerope_mj.foundation.directions import Direction
from wirerope_mj.foundation.plain_text import short
from wirerope_mj.motions.decaying import DecayingSine
from wirerope_mj.motions.design_spectrum import DesignSpectrum
from wirerope_mj.motions.harmonic import Sine, Sweep
from wirerope_mj.motions.level_files import psd_points, spectrum_points
from wirerope_mj.motions.motion import BaseMotion
from wirerope_mj.motions.phrases import UNITS, Phrase, parse_phrase
from wirerope_mj.motions.psd_lines import Points
from wirerope_mj.motions.pulses import HalfSine, Sawtooth, Trapezoid, VelocityStep
from wirerope_mj.motions.random_vibration import RandomVibration
from wirerope_mj.motions.spectrum_match import match_spectrum

_START = {"at": "time"}
_LASTING = _START | {"seed": "", "rise": "time", "fall": "time"}


@dataclass(frozen=True, kw_only=True)
class SpokenMotion:
    """A kind of motion as a phrase says it.

    Attributes:
        example: a phrase of this kind.
        summary: what it is, for a list of options.
        needs: how many values of each quantity there must be.
        make: makes the motion along one direction from the phrase; of a kind with a file, from its points, too.
        words: quantity of what may follow each word.
        needed_words: words that must be there.
        reads: reads the points of the file that the phrase begins with; None for a kind without a file.
    """

    example: str
    summary: str
    needs: Mapping[str, int]
    make: Callable[[Phrase, Direction, int, Points], BaseMotion]
    words: Mapping[str, str] = field(default_factory=lambda: _START)
    needed_words: tuple[str, ...] = ()
    reads: Callable[[Path], Points] | None = None


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
        points: Points = ()
        rest = text
        if spoken.reads is not None:
            path, rest = _file_and_rest(text, folder or Path())
            points = spoken.reads(path)
        phrase = parse_phrase(rest, words=spoken.words)
        _check(spoken, phrase)
        made = [spoken.make(phrase, direction, n, points) for n, direction in enumerate(phrase.directions)]
    except ValueError as error:
        raise ValueError(f'{kind} "{short(text)}": {error} It is written like "{spoken.example}".') from None
    return sum(made[1:], start=made[0])


def _file_and_rest(text: str, folder: Path) -> tuple[Path, str]:
    """Return the file that a phrase begins with, whose name may hold spaces, and what follows."""
    words = text.split(" ")
    for count in range(len(words), 0, -1):
        path = folder / " ".join(words[:count])
        if path.is_file():
            return path, " ".join(words[count:])
    raise ValueError(f'there is no file "{short(words[0])}".')


def _check(spoken: SpokenMotion, phrase: Phrase) -> None:
    """Raise ValueError unless a phrase says as much as its kind needs, and no more."""
    for quantity in {*spoken.needs, *phrase.quantities}:
        there, needed = len(phrase.quantities.get(quantity, ())), spoken.needs.get(quantity, 0)
        if there < needed:
            units = ", ".join(UNITS[quantity])
            raise ValueError(f"{_counted(needed, quantity)} must stand there ({units}), and there {_are(there)}.")
        if there > needed:
            raise ValueError(f"there {_are(there)} of {quantity}, and {needed or 'none'} is expected.")
    for word in spoken.needed_words:
        if word not in phrase.named:
            raise ValueError(f'"{word}" and its value must stand there.')
    if not phrase.directions:
        raise ValueError("a direction must stand there: x, y, z, several as in xyz, -z or a vector such as 1,1,0.")


def _counted(number: int, quantity: str) -> str:
    return (
        {"acceleration": "an acceleration"}.get(quantity, f"a {quantity}")
        if number == 1
        else f"{number} values of {quantity}"
    )


def _are(number: int) -> str:
    return "is none" if number == 0 else "is one" if number == 1 else f"are {number}"


def _one(phrase: Phrase, quantity: str) -> float:
    return phrase.quantities[quantity][0]


def _pulse(shape: Callable[..., BaseMotion]) -> Callable[[Phrase, Direction, int, Points], BaseMotion]:
    """Return what makes a pulse of one shape; `rise` is handed on where the phrase says it."""

    def make(phrase: Phrase, direction: Direction, _: int, __: Points) -> BaseMotion:
        more = {"rise": phrase.named["rise"]} if "rise" in phrase.named else {}
        peak, duration = _one(phrase, "acceleration"), _one(phrase, "time")
        return shape(peak=peak, duration=duration, direction=direction, start=phrase.named.get("at", 0.0), **more)

    return make


def _velocity_step(phrase: Phrase, direction: Direction, _: int, __: Points) -> BaseMotion:
    return VelocityStep(velocity=_one(phrase, "velocity"), direction=direction, start=phrase.named.get("at", 0.0))


def _double_pulse(phrase: Phrase, direction: Direction, _: int, __: Points) -> BaseMotion:
    spectrum = DesignSpectrum(**{name: _one(phrase, name) for name in ("displacement", "velocity", "acceleration")})
    return spectrum.double_half_sine(direction=direction, start=phrase.named.get("at", 0.0))


def _struck_deck(phrase: Phrase, direction: Direction, _: int, __: Points) -> BaseMotion:
    named = phrase.named
    return DecayingSine(
        frequency=_one(phrase, "frequency"), damping=named["damping"], velocity=_one(phrase, "velocity"),
        direction=direction, impact_duration=named["blow"], start=named.get("at", 0.0),
    )  # fmt: skip


def _sine(phrase: Phrase, direction: Direction, _: int, __: Points) -> BaseMotion:
    return Sine(
        frequency=_one(phrase, "frequency"), acceleration=_one(phrase, "acceleration"), direction=direction,
        duration=_one(phrase, "time"),
    )  # fmt: skip


def _sweep(phrase: Phrase, direction: Direction, _: int, __: Points) -> BaseMotion:
    start, stop = phrase.quantities["frequency"]
    return Sweep(
        start=start, stop=stop, rate=_one(phrase, "sweep rate"), acceleration=_one(phrase, "acceleration"),
        direction=direction,
    )  # fmt: skip


def _random(phrase: Phrase, direction: Direction, number: int, points: Points) -> BaseMotion:
    named = phrase.named
    return RandomVibration(
        psd=points, duration=_one(phrase, "time"), seed=_seed(phrase) + number, direction=direction,
        rise=named.get("rise"), fall=named.get("fall"), start=named.get("at", 0.0),
    )  # fmt: skip


def _match(phrase: Phrase, direction: Direction, number: int, points: Points) -> BaseMotion:
    named = phrase.named
    return match_spectrum(
        points, duration=_one(phrase, "time"), seed=_seed(phrase) + number, direction=direction,
        damping=named["damping"], rise=named.get("rise"), fall=named.get("fall"), start=named.get("at", 0.0),
    ).motion  # fmt: skip


def _seed(phrase: Phrase) -> int:
    seed = phrase.named.get("seed", 1.0)
    if seed != int(seed) or seed < 0:
        raise ValueError(f"a seed is an integer >= 0, got {seed:g}.")
    return int(seed)


_PULSE_NEEDS = {"acceleration": 1, "time": 1}

SPOKEN_MOTIONS: dict[str, SpokenMotion] = {
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
        words=_START | {"rise": "time"},
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
        words=_START | {"damping": "ratio", "blow": "time"},
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
        reads=psd_points,
    ),
    "spectrum": SpokenMotion(
        example="floor.csv 20 s x damping 5 % seed 1",
        summary='earthquake-like: CSV file of a response spectrum, "frequency [Hz], acceleration [g]", length, direction',
        needs={"time": 1},
        make=_match,
        words=_LASTING | {"damping": "ratio"},
        needed_words=("damping",),
        reads=spectrum_points,
    ),
}
"""Kinds of motion that a phrase says, by name."""
