"""Base motions, and forces on the payload, from phrases: what each kind needs and what makes it."""

import re
import warnings
from collections.abc import Callable
from difflib import get_close_matches
from pathlib import Path
from typing import Any

from wirerope_mj.foundation.arrays import Entries
from wirerope_mj.foundation.directions import Direction, directions_in, unit_vector
from wirerope_mj.foundation.errors import ConvergenceError, ModelWarning
from wirerope_mj.foundation.plain_text import short
from wirerope_mj.foundation.units import STANDARD_GRAVITY
from wirerope_mj.motions.double_pulses import DoubleHalfSine
from wirerope_mj.motions.harmonic import Sine, Sweep
from wirerope_mj.motions.motion import BaseMotion
from wirerope_mj.motions.payload_forces import Blow, ForceTable, HarmonicForce
from wirerope_mj.motions.phrases import START, UNITS, Phrase, SpokenMotion, file_first, parse_phrase, site_first
from wirerope_mj.motions.psd_lines import ForceRows, Points, force_rows, psd_points, spectrum_points, table_lines
from wirerope_mj.motions.pulses import HalfSine, Pulse, Sawtooth, Trapezoid, VelocityStep
from wirerope_mj.motions.random_vibration import RandomVibration
from wirerope_mj.motions.shock_machines import DecayingSine
from wirerope_mj.motions.spectrum_match import SpectrumMatch, match_spectrum
from wirerope_mj.motions.target_spectra import DesignSpectrum
from wirerope_mj.motions.unbalance import Unbalance
from wirerope_mj.motions.underwater import StruckPlate
from wirerope_mj.motions.vibration_lines import VibrationLines

LARGEST_SEED = 2**53 - 1  # of a phrase: numbers are read as floats, and of larger ones neighbours would be one
MOST_DWELLS = 100  # frequencies of an amplitude table's dwells
Make = Callable[[Phrase, Direction, int, Any], BaseMotion]
_PULSE = {"acceleration": 1, "time": 1}
_RISE = 0.1  # rise and fall of a trapezoid over its length unless it says them, as the shock standards draw it
_LONGEST_SHOCK = 1.0  # [s] beyond which the unit of a pulse is questioned
_LOUDEST = 50.0 * STANDARD_GRAVITY  # rms beyond which the unit of a density is questioned [m/s^2]
_LASTING = START | {"seed": "", "rise": "time", "fall": "time"}
_SHAFT: Entries = {
    "needs": {"unbalance": 1}, "words": START | {"order": "", "for": "time"}, "begins": site_first,
    "may": {"time": 1, "frequency": 2},
}  # fmt: skip


def _made(shape: Callable[..., BaseMotion], *, started: bool = True, **taken: str) -> Make:
    """Make a motion whose arguments are quantities or words of its phrase; of a force on the payload its site, too."""

    def make(phrase: Phrase, direction: Direction, _: int, site: str | None) -> BaseMotion:
        begins = ({"start": phrase.start} if started else {}) | ({} if site is None else {"site": site})
        values = {name: phrase.named[said] if said in phrase.named else phrase.one(said) for name, said in taken.items()}
        return shape(direction=direction, **values, **begins)

    return make


def _trapezoid(phrase: Phrase, direction: Direction, _: int, __: object) -> BaseMotion:
    duration, peak = phrase.one("time"), phrase.one("acceleration")
    rise = phrase.named.get("rise", _RISE * duration)
    return Trapezoid(peak=peak, duration=duration, rise=rise, direction=direction, start=phrase.start)


def _double_pulse(phrase: Phrase, direction: Direction, _: int, __: object) -> BaseMotion:
    spectrum = DesignSpectrum(**{name: phrase.one(name) for name in ("displacement", "velocity", "acceleration")})
    return spectrum.double_half_sine(direction=direction, start=phrase.start)


def _sweep(phrase: Phrase, direction: Direction, _: int, __: object) -> BaseMotion:
    (start, stop), rate = phrase.quantities["frequency"], phrase.one("sweep rate")
    return Sweep(start=start, stop=stop, rate=rate, acceleration=phrase.one("acceleration"), direction=direction)


def _lasting(phrase: Phrase, direction: Direction, number: int) -> Entries:
    """Read length, seed and ramps of a vibration; along several directions each has a seed of its own."""
    seed = phrase.named.get("seed", 1.0)
    if seed != int(seed) or not 0 <= seed <= LARGEST_SEED:
        raise ValueError(f"a seed is an integer from 0 to {LARGEST_SEED}, got {seed:.17g}.")
    ramps = {"rise": phrase.named.get("rise"), "fall": phrase.named.get("fall"), "start": phrase.start}
    return {"duration": phrase.one("time"), "seed": int(seed) + number, "direction": direction, **ramps}


def _dwells(phrase: Phrase, direction: Direction, _: int, table: tuple[str, Points]) -> BaseMotion:
    """Pass the lines of an amplitude table one after the other, each from rest to rest, and then dwell at some of them."""
    amplitudes, chosen = dict(table[1]), phrase.quantities.get("frequency", ())
    if ("dwell" in phrase.named) != bool(chosen):
        raise ValueError(
            '"dwell" and its frequencies belong together, as in "dwell 60 s 7 Hz 12 Hz"; `wirerope shock` and a job find them.'
        )
    for frequency in chosen:
        if frequency not in amplitudes:
            known = ", ".join(f"{one:g}" for one in amplitudes)
            raise ValueError(f"a dwell must be at a frequency of the table, {known} Hz, got {frequency:g} Hz.")
    lasting = [(line, phrase.one("time")) for line in table[1]]
    lasting += [((frequency, amplitudes[frequency]), phrase.named["dwell"]) for frequency in chosen]
    dwells, start = [], phrase.start
    for line, length in lasting:
        amplitude: Entries = {table[0]: [line]}
        dwells.append(VibrationLines(direction=direction, duration=length, start=start, **amplitude))
        start += length
    return sum(dwells[1:], start=dwells[0])


def _matched(phrase: Phrase, direction: Direction, number: int, points: Points) -> SpectrumMatch:
    return match_spectrum(points, damping=phrase.named["damping"], **_lasting(phrase, direction, number))


def _shaft(kind: str) -> Make:
    """Make the force of an unbalance, its direction the `kind`: axis or line; a time is that of a run-up."""

    def make(phrase: Phrase, direction: Direction, _: int, site: str) -> BaseMotion:
        named, frequencies = phrase.named, phrase.quantities.get("frequency", ())
        if len(frequencies) != (2 if "time" in phrase.quantities else 1):
            raise ValueError("one frequency must stand there, or two and the time of the run-up between them.")
        values: Entries = {"unbalance": phrase.one("unbalance"), "frequency": frequencies[0], kind: direction}
        values |= {"order": named.get("order", 1.0), "start": phrase.start}
        if len(frequencies) == 2:
            values |= {"final_frequency": frequencies[1], "run_up": phrase.one("time")}
        return Unbalance(site=site, **values | ({"duration": named["for"]} if "for" in named else {}))

    return make


def _harmonic(quantity: str) -> Make:
    def make(phrase: Phrase, direction: Direction, _: int, site: str) -> BaseMotion:
        amplitude: Entries = {quantity: (phrase.one(quantity) * unit_vector(direction)).tolist()}
        length = phrase.one("time")
        amplitude |= {"frequency": phrase.one("frequency"), "duration": length}
        return HarmonicForce(site=site, start=phrase.start, **amplitude)

    return make


def _site_and_table(text: str, folder: Path) -> tuple[tuple[str, ForceRows], str]:
    """Take site and table of forces off the beginning of a phrase."""
    site, rest = site_first(text, folder)
    rows, left = file_first(force_rows)(rest, folder)
    return (site, rows), left


# kinds of motion that a phrase says, by name: of the base, then forces on the payload
SPOKEN_MOTIONS: dict[str, SpokenMotion] = {
    "half-sine": SpokenMotion(
        example="15 g 11 ms z", summary="half-sine: peak, length, direction", needs=_PULSE,
        make=_made(HalfSine, peak="acceleration", duration="time"),
    ),
    "sawtooth": SpokenMotion(
        example="20 g 11 ms z", summary="terminal-peak sawtooth: peak, length, direction", needs=_PULSE,
        make=_made(Sawtooth, peak="acceleration", duration="time"),
    ),
    "trapezoid": SpokenMotion(
        example="10 g 18 ms rise 2 ms z", summary="trapezoid: peak, length, rise, direction", needs=_PULSE,
        words=START | {"rise": "time"}, make=_trapezoid,
    ),
    "velocity-step": SpokenMotion(
        example="2 m/s z", summary="velocity at once", needs={"velocity": 1},
        make=_made(VelocityStep, velocity="velocity"),
    ),
    "double-pulse": SpokenMotion(
        example="50 mm 3 m/s 100 g z", summary="double half-sine of a design spectrum d0, v0, a0",
        needs={"displacement": 1, "velocity": 1, "acceleration": 1}, make=_double_pulse,
    ),
    "struck-deck": SpokenMotion(
        example="14 Hz 1.5 m/s damping 5 % blow 4 ms z",
        summary="deck of one frequency under a blow: frequency, velocity, damping, length of the blow, direction",
        needs={"frequency": 1, "velocity": 1}, words=START | {"damping": "ratio", "blow": "time"},
        needed_words=("damping", "blow"),
        make=_made(DecayingSine, frequency="frequency", damping="damping", velocity="velocity", impact_duration="blow"),
    ),
    "struck-plate": SpokenMotion(
        example="14 MPa 0.9 ms 320 kg/m2 z",
        summary="hull plate under an underwater shock wave: peak pressure, decay, mass per area, direction",
        needs={"pressure": 1, "time": 1, "areal mass": 1},
        make=_made(StruckPlate, pressure="pressure", decay="time", areal_mass="areal mass"),
    ),
    "sine": SpokenMotion(
        example="0.5 g 12 Hz 10 s z", summary="steady sine: amplitude, frequency, length, direction",
        needs={"acceleration": 1, "frequency": 1, "time": 1}, words={},
        make=_made(Sine, started=False, frequency="frequency", acceleration="acceleration", duration="time"),
    ),
    "sweep": SpokenMotion(
        example="0.5 g 5 to 50 Hz 2 oct/min z",
        summary="logarithmic sine sweep: amplitude, frequencies, rate, direction",
        needs={"acceleration": 1, "frequency": 2, "sweep rate": 1}, words={}, make=_sweep,
    ),
    "psd": SpokenMotion(
        example="transport.csv 30 s z seed 1",
        summary='random vibration: CSV file with "frequency [Hz], psd [g^2/Hz]", length, direction',
        needs={"time": 1}, words=_LASTING, begins=file_first(psd_points),
        make=lambda phrase, direction, n, points: RandomVibration(psd=points, **_lasting(phrase, direction, n)),
    ),
    "amplitude-table": SpokenMotion(
        example="levels.csv 10 s z",
        summary='sines one after the other: CSV file with "from [Hz], to [Hz], displacement [mm]", time of each, direction',
        needs={"time": 1}, begins=file_first(table_lines), make=_dwells, words=START | {"dwell": "time"},
        may={"frequency": MOST_DWELLS},
    ),
    "spectrum": SpokenMotion(
        example="floor.csv 20 s x damping 5 % seed 1",
        summary='earthquake-like: CSV file of a response spectrum, "frequency [Hz], acceleration [g]", length, direction',
        needs={"time": 1}, words=_LASTING | {"damping": "ratio"}, needed_words=("damping",),
        begins=file_first(spectrum_points), make=lambda *said: _matched(*said).motion,
    ),
    "required-spectrum": SpokenMotion(
        example="rrs.csv 30 s x damping 5 % seed 1",
        summary="the same, its spectrum nowhere below the file's, as IEEE 344 and GR-63 ask: a file of a required spectrum",
        needs={"time": 1}, words=_LASTING | {"damping": "ratio"}, needed_words=("damping",),
        begins=file_first(spectrum_points), make=lambda *said: _matched(*said).enveloping,
    ),
    "unbalance": SpokenMotion(
        example="engine 20 kg.mm 5 to 30 Hz 20 s x",
        summary="unbalance of a shaft: site, size, speed or run-up, axis", **_SHAFT, make=_shaft("axis"),
    ),
    "reciprocating": SpokenMotion(
        example="engine 8 kg.mm 25 Hz order 2 z",
        summary="unbalance of what reciprocates: site, size, speed or run-up, order, line", **_SHAFT, make=_shaft("line"),
    ),
    "force": SpokenMotion(
        example="engine 500 N 12 Hz 10 s z",
        summary="harmonic force on the payload: site, amplitude, frequency, length, direction",
        needs={"force": 1, "frequency": 1, "time": 1}, begins=site_first, make=_harmonic("force"),
    ),
    "moment": SpokenMotion(
        example="engine 80 N.m 12 Hz 10 s y",
        summary="harmonic moment on the payload: site, amplitude, frequency, length, axis",
        needs={"moment": 1, "frequency": 1, "time": 1}, begins=site_first, make=_harmonic("moment"),
    ),
    "hammer": SpokenMotion(
        example="anvil 9.8 kN.s 1 ms z", summary="blow on the payload: site, impulse, length, direction",
        needs={"impulse": 1, "time": 1}, begins=site_first, make=_made(Blow, impulse="impulse", duration="time"),
    ),
    "force-table": SpokenMotion(
        example="engine start.csv at 1 s",
        summary='forces and moments of a table: site, CSV file with "time [s], fz [N], mx [N.m]" and the like',
        needs={}, begins=_site_and_table, directed=False,
        make=lambda phrase, _, __, begun: ForceTable(
            site=begun[0], times=begun[1][0], loads=begun[1][1], start=phrase.start
        ),
    ),
}  # fmt: skip


def motion_from_phrase(kind: str, text: str, *, folder: Path | None = None) -> BaseMotion:
    """Make the base motion that a phrase says; along several axes, as in "xyz", the sum of one along each.

    `kind` is one of `SPOKEN_MOTIONS`; the relative path of a file starts in `folder`, the current one by default.

    Raises:
        ValueError: the phrase is not understood, or says too little or too much; ends with an example.
        RecordError: a file that it names cannot be read.

    Warns:
        ModelWarning: a shock pulse lasts more than a second, or the rms of a random vibration is beyond 50 g.
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
    if doubt := _doubt(made[0], phrase):
        warnings.warn(f'{kind} "{short(text)}": {doubt}', ModelWarning, stacklevel=2)
    return sum(made[1:], start=made[0])


def _doubt(motion: BaseMotion, phrase: Phrase) -> str:
    """Ask whether a unit is another, where a shock is very long or a vibration very strong; "" else."""
    if isinstance(motion, (Pulse, DoubleHalfSine)) and motion.duration > _LONGEST_SHOCK:
        length = f"{motion.duration:.4g}"
        meant = f"was {length} ms meant?" if "time" in phrase.quantities else "is one of its units another?"
        return f"it lasts {length} s, and shocks are over sooner: {meant}"
    if isinstance(motion, RandomVibration) and motion.rms > _LOUDEST:
        return f"its rms is {motion.rms / STANDARD_GRAVITY:.4g} g: is the unit of its density another?"
    return ""


# Kinds as people write them, with spaces, hyphens or neither; the first that a sentence holds counts.
_WRITTEN = {
    r"double[- ]?half[- ]?sine": "double-pulse", r"(?:terminal[- ]peak[- ])?saw[- ]?tooth": "sawtooth",
    **{kind.replace("-", "[- ]?"): kind for kind in sorted(SPOKEN_MOTIONS, key=len, reverse=True)},
}  # fmt: skip
_BARE_STEP = re.compile(r"\s*[-+.\deE]+ ?m/s\b[^a-z]*[-xyz]*\s*")  # a velocity alone, with a direction or without


def motion_from_words(text: str) -> BaseMotion:
    """Make the base motion of a sentence that names its kind anywhere: "half-sine 15 g 11 ms z", "2 m/s".

    Where no direction stands, and the kind needs one, it is z.

    Raises:
        ValueError: no kind of motion is named, or what else is said is not understood.
        RecordError: a file that it names cannot be read.
    """
    named = "velocity-step " * bool(_BARE_STEP.fullmatch(text)) + text
    for written, kind in _WRITTEN.items():
        if match := re.search(rf"(?<![\w-]){written}(?![\w-])", named, re.IGNORECASE):
            rest = f"{named[: match.start()]} {named[match.end() :]}".replace(", ", " ")
            rest = " ".join(part.removesuffix(",") for part in rest.split())
            along = "" if any(map(directions_in, rest.split())) or not SPOKEN_MOTIONS[kind].directed else " z"
            return motion_from_phrase(kind, rest + along)
    near = [one for word in text.split() for one in get_close_matches(word.lower(), SPOKEN_MOTIONS, n=1)]
    meant = f" Did you mean {near[0]}?" if near else ""
    raise ValueError(
        f'"{short(text)}" names no kind of motion: {", ".join(SPOKEN_MOTIONS)}.{meant} It is written like '
        '"half-sine 15 g 11 ms z".'
    )


def _check(spoken: SpokenMotion, phrase: Phrase) -> None:
    """Raise ValueError unless a phrase says as much as its kind needs, and no more."""
    for quantity in dict.fromkeys((*spoken.needs, *phrase.quantities)):
        there, needed = len(phrase.quantities.get(quantity, ())), spoken.needs.get(quantity, 0)
        if there <= spoken.may.get(quantity, -1):
            continue
        are = "is none" if there == 0 else "is one" if there == 1 else f"are {there}"
        if there < needed:
            article = "an" if quantity[0] in "au" else "a"
            counted = f"{article} {quantity}" if needed == 1 else f"{needed} values of {quantity}"
            raise ValueError(f"{counted} must stand there ({', '.join(UNITS[quantity])}), and there {are}.")
        if there > needed:
            raise ValueError(f"there {are} of {quantity}, and {needed or 'none'} is expected.")
    for word in spoken.needed_words:
        if word not in phrase.named:
            raise ValueError(f'"{word}" and its value must stand there.')
    if spoken.directed and not phrase.directions:
        raise ValueError("a direction must stand there: x, y, z, several as in xyz, -z or a vector such as 1,1,0.")
    if phrase.directions and not spoken.directed:
        raise ValueError("a direction stands there, and none is expected: the columns of its table say it.")
