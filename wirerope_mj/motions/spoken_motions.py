"""Motions of the base that a phrase says."""

from collections.abc import Callable
from typing import Any

from wirerope_mj.foundation.directions import Direction
from wirerope_mj.motions.decaying import DecayingSine
from wirerope_mj.motions.design_spectrum import DesignSpectrum
from wirerope_mj.motions.harmonic import Sine, Sweep
from wirerope_mj.motions.level_files import psd_points, spectrum_points
from wirerope_mj.motions.motion import BaseMotion
from wirerope_mj.motions.phrases import Phrase
from wirerope_mj.motions.pulses import HalfSine, Sawtooth, Trapezoid, VelocityStep
from wirerope_mj.motions.random_vibration import RandomVibration
from wirerope_mj.motions.spectrum_match import match_spectrum
from wirerope_mj.motions.spoken_kind import START, SpokenMotion, file_first, one

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
