"""Shock response spectra against pyyeti and against closed forms."""

import math
import warnings

import numpy as np
from scipy.optimize import minimize_scalar

import wirerope_mj as wr
from verification.case import Case, Comparison, series, single_values

RATE = 20_000.0
FREQUENCIES = np.geomspace(2.0, 500.0, 49)
"""Up to a fortieth of the sampling rate."""

PYYETI = "T. Widrick, pyyeti, function srs.srs (ramp-invariant filters of D. O. Smallwood, 1981)"
PYYETI_REASON = (
    "pyyeti takes the largest sample, this library the peak between samples: at most 1 - cos(pi/40) = 3.1e-3 "
    "of the highest oscillator's response"
)


def _half_sine() -> tuple[np.ndarray, np.ndarray]:
    """Return time and a half-sine of 30 g and 11 ms, followed by a second at rest."""
    time = np.arange(0.0, 1.0, 1.0 / RATE)
    return time, np.where(time < 0.011, 30.0 * wr.STANDARD_GRAVITY * np.sin(np.pi * time / 0.011), 0.0)


def _burst() -> tuple[np.ndarray, np.ndarray]:
    """Return time and a decaying random acceleration below 1 kHz, followed by a second at rest."""
    time = np.arange(0.0, 1.5, 1.0 / RATE)
    rng = np.random.default_rng(7)
    lines = np.arange(10.0, 1000.0, 10.0)
    noise = np.sin(2.0 * np.pi * np.outer(time, lines) + rng.uniform(0.0, 2.0 * np.pi, lines.size)).sum(axis=1)
    return time, np.where(time < 0.5, noise * np.sin(2.0 * np.pi * time) ** 2, 0.0)


def _with_pyyeti(time: np.ndarray, values: np.ndarray, q: float, kind: str) -> Comparison:
    """Return the comparison of spectra, relative at every frequency."""
    from pyyeti import srs

    with warnings.catch_warnings():
        warnings.simplefilter("ignore")  # of the other package's own dependencies
        expected = srs.srs(values, RATE, FREQUENCIES, q, stype=kind, rolloff=None, parallel="no")
    ours = wr.shock_response_spectrum(time, values, FREQUENCIES, q=q)
    found = ours.maximax if kind == "absacce" else ours.relative_displacement
    worst = int(np.argmax(np.abs(found / expected - 1.0)))
    return Comparison(
        reference=float(expected[worst]),
        ours=float(found[worst]),
        error=float(abs(found[worst] / expected[worst] - 1.0)),
        values=FREQUENCIES.size,
        unit="m/s^2" if kind == "absacce" else "m",
    )


def _residual() -> Comparison:
    """Return the comparison of the undamped residual spectrum of a half-sine with its closed form."""
    time, values = _half_sine()
    products = np.array([0.05, 0.1, 0.2, 0.4, 0.81, 1.2, 2.3])
    found = wr.shock_response_spectrum(time, values, products / 0.011, q=math.inf)
    ratio = 0.5 / products  # (pi / D) / w
    exact = np.abs(2.0 * ratio / (ratio**2 - 1.0) * np.cos(np.pi * products)) * 30.0 * wr.STANDARD_GRAVITY
    return series(exact, found.residual, "m/s^2")


def _largest(peak_at: float, pulse: str, q: float) -> float:
    """Return the largest amplification over frequency, near frequency times duration `peak_at`."""
    duration, parts = 0.011, 8000
    time = np.arange(6 * parts + 1) * duration / parts
    inside = time <= duration
    shape = np.sin(np.pi * time / duration) if pulse == "half-sine" else time / duration
    values = np.where(inside, shape, 0.0)

    def negative(product: float) -> float:
        return -float(wr.shock_response_spectrum(time, values, [product / duration], q=q).maximax[0])

    found = minimize_scalar(negative, bounds=(0.5 * peak_at, 1.5 * peak_at), method="bounded")
    return -float(found.fun)


def _amplification() -> Comparison:
    """Return the comparison of the largest amplifications of the classical pulses with closed forms and printed values."""

    def half_sine(product: float) -> float:
        # Largest response while the pulse lasts, for products of frequency and duration from 0.5 to 1.5.
        return -2.0 * product / (2.0 * product - 1.0) * math.sin(2.0 * math.pi / (2.0 * product + 1.0))

    def sawtooth(product: float) -> float:
        # Amplitude after the drop: the response at the end is 1 - sin(a)/a, its rate over w is (1 - cos(a))/a.
        angle = 2.0 * math.pi * product
        return -math.hypot(1.0 - math.sin(angle) / angle, (1.0 - math.cos(angle)) / angle)

    exact = [-float(minimize_scalar(f, bounds=(0.55, 1.2), method="bounded").fun) for f in (half_sine, sawtooth)]
    rows = (
        ("half-sine, undamped", exact[0], 0.81, "half-sine", math.inf),
        ("terminal-peak sawtooth, undamped", exact[1], 0.645, "sawtooth", math.inf),
        ("half-sine, Q = 10", 1.652, 0.82, "half-sine", 10.0),
        ("terminal-peak sawtooth, Q = 10", 1.189, 0.645, "sawtooth", 10.0),
    )
    return single_values({label: (value, _largest(at, pulse, q)) for label, value, at, pulse, q in rows}, "-")


HALF_SINE = "closed form: residual of an undamped oscillator after a half-sine, 2 (pi/D)/w / ((pi/(D w))^2 - 1) cos(w D/2)"

CASES = (
    Case(name="srs-pyyeti-half-sine", title="Shock response spectrum of a half-sine, Q = 10, against pyyeti",
         compares="Largest absolute acceleration at 49 frequencies from 2 to 500 Hz; largest relative difference.",
         source=PYYETI, date="each run", bound=3.1e-3, reason=PYYETI_REASON, needs=("pyyeti",),
         run=lambda: _with_pyyeti(*_half_sine(), 10.0, "absacce")),
    Case(name="srs-pyyeti-burst", title="Shock response spectrum of a random burst, Q = 25, against pyyeti",
         compares="Largest absolute acceleration at 49 frequencies from 2 to 500 Hz; largest relative difference.",
         source=PYYETI, date="each run", bound=3.1e-3, reason=PYYETI_REASON, needs=("pyyeti",),
         run=lambda: _with_pyyeti(*_burst(), 25.0, "absacce")),
    Case(name="srs-pyyeti-displacement", title="Relative displacement of a random burst, Q = 10, against pyyeti",
         compares="Largest displacement from the base at 49 frequencies from 2 to 500 Hz; largest relative difference.",
         source=PYYETI, date="each run", bound=3.1e-3, reason=PYYETI_REASON, needs=("pyyeti",),
         run=lambda: _with_pyyeti(*_burst(), 10.0, "reldisp")),
    Case(name="srs-half-sine-residual", title="Undamped residual spectrum of a half-sine",
         compares="Residual response at seven products of frequency and duration; largest difference over the largest.",
         source=HALF_SINE, date="each run", bound=2e-5, run=_residual,
         reason="straight lines between 220 samples lack (pi/220)^2/12 = 1.7e-5 of a half-sine"),
    Case(name="srs-amplification", title="Largest amplification of the classical pulses",
         compares="Maximum of the spectrum over frequency, over the pulse's peak; largest relative difference.",
         source="closed forms of undamped oscillators; Q = 10: own table to four digits, computed without this library",
         date="2026-11", bound=4.2e-4, reason="half a unit of the last digit of the table, 0.0005 of 1.189",
         run=_amplification),
)  # fmt: skip
