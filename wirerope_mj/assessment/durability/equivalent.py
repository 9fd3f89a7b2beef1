"""Random vibration that does the damage of a history: for tests of equipment on a shaker."""

from dataclasses import dataclass
from pathlib import Path

from wirerope_mj.assessment.durability.cycles import fatigue_damage_spectrum
from wirerope_mj.engine.response import Response
from wirerope_mj.foundation.directions import direction_text, unit_vector
from wirerope_mj.motions.phrases import parse_phrase, site_first
from wirerope_mj.motions.psd_lines import Points, psd_rms
from wirerope_mj.motions.spectra.ramp import octave_grid
from wirerope_mj.motions.spectra.srs import SAMPLES_PER_PERIOD
from wirerope_mj.motions.spectra.vibration import equivalent_psd

EXAMPLE = "rack 3600 s 5 to 80 Hz z"
_BEYOND, _PER_OCTAVE = 2.0**0.5, 6


@dataclass(frozen=True, kw_only=True)
class EquivalentVibration:
    """A density of random vibration with the damage spectrum of a history."""

    # subject, along: whose history it is, and along what
    subject: str
    along: str
    duration: float  # of the vibration [s]
    points: Points  # frequency [Hz] and level [(m/s^2)^2/Hz]
    error: float  # largest relative error of its damage that is left
    # exponent, q: of the damage spectrum
    exponent: float
    q: float

    @property
    def rms(self) -> float:
        """Rms acceleration [m/s^2]."""
        return psd_rms(self.points)


def equivalent_vibration(response: Response, text: str, *, exponent: float) -> EquivalentVibration:
    """Find the random vibration that does the damage of a run, by N = C / A^b, at a body, a point or the base; text: `EXAMPLE`.

    ValueError if the text is not understood, there is no such body or point, or the samples are too few.
    """
    subject, rest = site_first(text, Path())
    known = {name: one.acceleration for name, one in (*response.bodies.items(), *response.points.items())}
    known["base"] = response.base.acceleration
    try:
        if subject not in known:
            raise ValueError(f"the run has no body or point {subject!r}; it has {', '.join(known)}.")
        phrase = parse_phrase(rest, words={"q": ""})
        said = {name: len(values) for name, values in phrase.quantities.items()}
        if said != {"time": 1, "frequency": 2} or len(phrase.directions) != 1:
            raise ValueError("one time, two frequencies and one direction must stand there.")
        low, high = phrase.quantities["frequency"]
        q, duration = phrase.named.get("q", 10.0), phrase.one("time")
        history = known[subject] @ unit_vector(phrase.directions[0])
        # The outermost levels stand for what lies beyond them: they are found, and left out.
        highest = max(high, min(_BEYOND * high, (response.time.size - 1) / SAMPLES_PER_PERIOD / float(response.time[-1])))
        spectrum = fatigue_damage_spectrum(
            response.time, history, exponent=exponent, q=q,
            frequencies=octave_grid(low / _BEYOND, highest, per_octave=_PER_OCTAVE),
        )  # fmt: skip
        found, error = equivalent_psd(spectrum.frequencies, spectrum.damage, exponent=exponent, duration=duration, q=q)
        points = tuple((frequency, level) for frequency, level in found if low <= frequency <= high)
        if len(points) < 2:
            raise ValueError("the frequencies must be a third of an octave apart, at least.")
    except ValueError as error_of:
        raise ValueError(f'equivalent vibration "{text}": {error_of} It is written like "{EXAMPLE}".') from None
    return EquivalentVibration(
        subject=subject, along=direction_text(phrase.directions[0]), duration=duration, points=points, error=error,
        exponent=exponent, q=q,
    )  # fmt: skip
