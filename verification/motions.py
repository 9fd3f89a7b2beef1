"""Naval double pulses against values computed by hand from their kinematics."""

import numpy as np

import wirerope_mj as wr
from verification.case import LAST_DIGIT, Case, Comparison, printed, single_values

SPECTRUM = {"displacement": 0.05, "velocity": 3.0, "acceleration": 100.0 * wr.STANDARD_GRAVITY}
"""d0 = 50 mm, v0 = 3 m/s, a0 = 100 g."""


def _double_half_sine() -> Comparison:
    """Return the comparison of a double half-sine's times and second peak with the values computed by hand."""
    pulse = wr.DesignSpectrum(**SPECTRUM).double_half_sine(direction="z")
    return printed(
        {
            "first half-sine [ms]": ("6.0066", 1e3 * pulse.first_duration),
            "second half-sine [ms]": ("40.6600", 1e3 * pulse.second_duration),
            "second peak [g]": ("8.8637", -pulse.second_peak / wr.STANDARD_GRAVITY),
        }
    )


def _double_triangle() -> Comparison:
    """Return the comparison of a double triangle's corners and second peak, for both places of the second peak."""
    values: dict[str, tuple[str, float]] = {}
    for r2, corners, peak in (
        (0.4, ("3.0591", "7.6479", "24.1517", "48.9074"), "11.1216"),
        (0.6, ("3.0591", "7.6479", "29.3091", "43.7500"), "12.7104"),
    ):
        pulse = wr.DesignSpectrum(**SPECTRUM).double_triangle(direction="z", r2=r2)
        found = 1e3 * pulse.corners[1:]
        values |= {f"r2 {r2}: corner {i + 2} [ms]": (text, found[i]) for i, text in enumerate(corners)}
        lowest = float(pulse.acceleration(pulse.corners)[:, 2].min())
        values[f"r2 {r2}: second peak [g]"] = (peak, -lowest / wr.STANDARD_GRAVITY)
    return printed(values)


def _ends() -> Comparison:
    """Return the comparison of velocity between the pulses and final displacement with what was asked for."""
    pairs = {}
    for name, pulse in (
        ("half-sine", wr.DesignSpectrum(**SPECTRUM).double_half_sine(direction="z")),
        ("triangle", wr.DesignSpectrum(**SPECTRUM).double_triangle(direction="z")),
    ):
        time = np.linspace(0.0, float(pulse.corners[-1]), 200_001)
        acceleration = pulse.acceleration(time)[:, 2]
        step = time[1]
        velocity = np.concatenate([[0.0], np.cumsum(0.5 * step * (acceleration[1:] + acceleration[:-1]))])
        displacement = 0.5 * step * np.sum(velocity[1:] + velocity[:-1])
        pairs[f"{name}: largest velocity [m/s]"] = (0.75 * 3.0, float(velocity.max()))
        pairs[f"{name}: final displacement [m]"] = (1.05 * 0.05, displacement)
    return single_values(pairs, "see below")


PRACTICE = "naval practice for a three-branch design spectrum (BV 0430, STANAG), kinematics worked by hand to the digits shown"

CASES = (
    Case(name="double-half-sine", title="Double half-sine from a design spectrum of 100 g, 3 m/s, 50 mm",
         compares="Three values; difference in half units of the last digit.", source=PRACTICE, date="2026-11", bound=1.0,
         reason=LAST_DIGIT, run=_double_half_sine),
    Case(name="double-triangle", title="Double triangle from the same spectrum",
         compares="Ten values; difference in half units of the last digit.", source=PRACTICE, date="2026-11", bound=1.0,
         reason=LAST_DIGIT, run=_double_triangle),
    Case(name="double-pulse-integrals", title="Velocity and displacement of both double pulses",
         compares="Sums of the acceleration over 200,000 steps against 0.75 v0 and 1.05 d0; largest relative difference.",
         source="the definition of the pulses", date="each run", bound=1e-7,
         reason="the trapezoid rule with steps of 0.25 microseconds, kinks inside steps", run=_ends),
)  # fmt: skip
