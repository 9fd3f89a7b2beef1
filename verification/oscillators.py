"""One mass on a mount: steady motions, and the linear limits of shock and vibration."""

import math

import numpy as np

import wirerope_mj as wr
from verification.case import LAST_DIGIT, Case, Comparison, printed, single_values
from verification.models import oscillator
from wirerope_mj.mounts.laws import Law

TURN = 2.0 * math.pi

# -------------------------------------------------------------------------------------------------- steady motions
# beta, gamma, w; half the range of d, largest z, energy; alpha = n = m = 1, base 0.3 m/s^2
PURE = (
    (0.5, 0.5, 0.5, 0.45896197, 0.40265818, 0.06308156), (0.5, 0.5, 0.8, 1.32292920, 0.83627730, 1.24724792),
    (0.5, 0.5, 1.5, 0.23013706, 0.21640770, 0.00808515), (0.8, 0.2, 0.8, 1.05461054, 0.77129585, 0.95005770),
    (0.8, 0.2, 1.0, 0.89536921, 0.70057849, 0.62483884), (1.0, 0.0, 0.8, 0.93796753, 0.73428704, 0.81472194),
    (0.5, -0.4, 0.8, 0.65363574, 0.72294920, 0.18020300),
)  # fmt: skip
# k1, k2, k3, lambda, w, base; smallest d, largest d, largest z, energy; beta = gamma = 0.5
MODIFIED = (
    (0.1, 0.0, 0.0, 0.0, 0.8, 0.3, -1.17245244, 1.17245244, 0.78900135, 0.91128124),
    (0.1, 0.0, 0.0, 0.0, 1.0, 0.3, -1.08550092, 1.08550092, 0.75686469, 0.74170077),
    (0.5, 0.1, 0.05, 0.2, 0.8, 0.3, -0.35556769, 0.37984929, 0.33197992, 0.03280018),
    (0.5, 0.1, 0.05, 0.2, 1.0, 0.3, -0.81001739, 0.68422320, 0.59366449, 0.25865647),
    (0.5, 0.1, 0.05, 0.2, 0.8, 1.0, -1.50350412, 1.46598311, 0.87666184, 1.67092270),
)


def _pure_orbits() -> Comparison:
    """Return the comparison of seven steady motions of the plain law by harmonic balance."""
    pairs = {}
    for beta, gamma, omega, half, z, energy in PURE:
        law = wr.BoucWen(alpha=1.0, beta=beta, gamma=gamma, n=1.0)
        found = wr.harmonic_balance(law, mass=1.0, frequency=omega / TURN, acceleration=0.3)
        label = f"beta {beta}, gamma {gamma}, w {omega}"
        pairs[f"{label}: amplitude [m]"] = (half, 0.5 * (found.largest_deflection - found.smallest_deflection))
        pairs[f"{label}: z [N]"] = (z, found.largest_hysteretic_state)
        pairs[f"{label}: energy [J]"] = (energy, found.dissipated_energy)
    return single_values(pairs, "see below")


def _modified_orbits() -> Comparison:
    """Return the comparison of five steady motions of Ni's asymmetric law by harmonic balance."""
    pairs = {}
    for k1, k2, k3, rate, omega, level, low, high, z, energy in MODIFIED:
        law = wr.AsymmetricBoucWen(alpha=1.0, beta=0.5, gamma=0.5, n=1.0, k1=k1, k2=k2, k3=k3, b=math.e, c=rate)
        found = wr.harmonic_balance(law, mass=1.0, frequency=omega / TURN, acceleration=level)
        label = f"k1 {k1}, lambda {rate}, w {omega}, base {level}"
        pairs[f"{label}: smallest d [m]"] = (low, found.smallest_deflection)
        pairs[f"{label}: largest d [m]"] = (high, found.largest_deflection)
        pairs[f"{label}: z [N]"] = (z, found.largest_hysteretic_state)
        pairs[f"{label}: energy [J]"] = (energy, found.dissipated_energy)
    return single_values(pairs, "see below")


def _orbit(law: Law, omega: float, accuracy: float = 1e-6) -> wr.PeriodicOrbit:
    """Return the steady motion of a mass of 1 kg under 0.3 m/s^2, by shooting on MuJoCo's state."""
    system = oscillator({"one": law}, mass=1.0)
    return wr.periodic_orbit(system, frequency=omega / TURN, acceleration=0.3, direction="z", accuracy=accuracy)


def _multipliers() -> Comparison:
    """Return the comparison of a shot orbit's Floquet multipliers with those of event-split integration."""
    found = _orbit(wr.BoucWen(alpha=1.0, beta=0.5, gamma=0.5, n=1.0), 0.8)
    first, second = np.abs(found.floquet_multipliers)[:2]
    return single_values({"larger modulus": (0.37284, first), "smaller modulus": (0.07189, second)}, "-")


def _determinant() -> Comparison:
    """Return the comparison of the product of multipliers with exp(-4 beta A), for n = 1 and gamma = 0."""
    found = _orbit(wr.BoucWen(alpha=1.0, beta=1.0, gamma=0.0, n=1.0), 0.5)
    peak = found.response.peaks.mounts["m_one"].deflection
    amplitude = 0.5 * (peak.maximum[2] - peak.minimum[2])
    return single_values({"product": (math.exp(-4.0 * amplitude), float(np.prod(found.floquet_multipliers).real))}, "-")


# --------------------------------------------------------------------------------------------------- linear limits
def _transmissibility() -> Comparison:
    """Return the comparison of the transmissibility of a spring and damper with its closed form, through resonance."""
    pairs = {}
    mass, natural, zeta = 40.0, 9.0, 0.15
    law = wr.KelvinVoigt(k=mass * (TURN * natural) ** 2, c=2.0 * zeta * mass * TURN * natural)
    for ratio in (0.5, 1.0, math.sqrt(2.0), 3.0, 6.0):
        exact = math.sqrt((1.0 + (2.0 * zeta * ratio) ** 2) / ((1.0 - ratio**2) ** 2 + (2.0 * zeta * ratio) ** 2))
        found = wr.harmonic_balance(law, mass=mass, frequency=ratio * natural, acceleration=5.0)
        pairs[f"frequency ratio {ratio:.4g}"] = (exact, found.transmissibility)
    return single_values(pairs, "-")


def _shock_limits() -> Comparison:
    """Return the comparison of acceleration times travel over V^2 after a velocity step with printed values."""
    mass, rate, velocity = 10.0, 20.0 * math.pi, 2.0
    values = {}
    for zeta, text in ((0.0, "1.0000"), (0.05, "0.863"), (0.15, "0.680"), (0.2, "0.621"), (0.404, "0.5206")):
        law: Law = wr.KelvinVoigt(k=mass * rate**2, c=2.0 * zeta * mass * rate)
        step = wr.VelocityStep(velocity=velocity, direction="z")
        found = wr.simulate(
            oscillator({"one": law}, mass=mass), step, duration=0.2, initial="unloaded", timestep=1e-4
        )  # fmt: skip
        travel = found.peaks.mounts["m_one"].deflection.value
        acceleration = found.peaks.bodies["mass"].acceleration.value
        values[f"zeta {zeta:g}"] = (text, acceleration * travel / velocity**2)
    return printed(values)


def _miles() -> Comparison:
    """Return the comparison of an rms acceleration under flat random vibration with Miles' formula."""
    mass, natural, q, level = 25.0, 30.0, 5.0, 4.0
    law = wr.KelvinVoigt(k=mass * (TURN * natural) ** 2, c=mass * TURN * natural / q)
    motion = wr.RandomVibration(psd=[(1.0, level), (250.0, level)], duration=40.0, seed=9, direction="z", rise=2.0, fall=2.0)
    response = wr.simulate(
        oscillator({"one": law}, mass=mass), motion, duration=40.0, timestep=5e-4, initial="unloaded", sample_rate=1000.0
    )  # fmt: skip
    inside = (response.time > 2.5) & (response.time < 38.0)
    rms = float(np.sqrt(np.mean(response.bodies["mass"].acceleration[inside, 2] ** 2)))
    miles = math.sqrt(math.pi / 2.0 * natural * q * level * (1.0 + 1.0 / q**2))
    return single_values({"rms": (miles, rms)}, "m/s^2")


def _psd_rms() -> Comparison:
    """Return the comparison of the rms of two standard test spectra with the values printed beside them."""
    fall = 0.04 * (1000.0 / 2000.0) ** (6.0 / (10.0 * math.log10(2.0)))
    rise = 0.04 * (20.0 / 80.0) ** (3.0 / (10.0 * math.log10(2.0)))
    last = 0.04 * (350.0 / 2000.0) ** (3.0 / (10.0 * math.log10(2.0)))
    integrity = wr.motions.psd_from_g([(20.0, 0.04), (1000.0, 0.04), (2000.0, fall)])
    navmat = wr.motions.psd_from_g([(20.0, rise), (80.0, 0.04), (350.0, 0.04), (2000.0, last)])
    g = wr.STANDARD_GRAVITY
    return printed(
        {
            "MIL-STD-810H 514.8, general minimum integrity [g]": ("7.7", wr.motions.psd_rms(integrity) / g),
            "NAVMAT P-9492 [g]": ("6.06", wr.motions.psd_rms(navmat) / g),
        }
    )


ORBITS = "own table of steady motions, computed without this library by event-split DOP853 integration and Newton's method"
DIFFERENCES = (
    "the variational equation has reversals between steps by a parabola, a thousand times less exact than the motion's 1e-6"
)

CASES = (
    Case(name="orbits-bouc-wen", title="Steady motions of a mass on the plain law, harmonic balance",
         compares="Amplitude, largest z and energy of seven motions; largest relative difference.",
         source=ORBITS, date="2026-11", bound=7e-7, reason="half a unit of the eighth decimal printed, 5e-9 over 0.008",
         run=_pure_orbits),
    Case(name="orbits-asymmetric", title="Steady motions of a mass on Ni's asymmetric law, harmonic balance",
         compares="Extreme deflections, largest z and energy of five motions; largest relative difference.",
         source=ORBITS, date="2026-11", bound=3e-7,
         reason="31 harmonics, whose coefficients fall as k^-5, and half a unit of the eighth decimal", run=_modified_orbits),
    Case(name="floquet-multipliers", title="Floquet multipliers of a steady motion, shooting on MuJoCo's state",
         compares="Moduli of both multipliers that are not neutral; largest relative difference.",
         source=ORBITS, date="2026-11", bound=1e-3, reason=DIFFERENCES, run=_multipliers),
    Case(name="floquet-determinant", title="Product of the multipliers for n = 1 and gamma = 0",
         compares="Product of the multipliers; relative difference.",
         source="closed form: over a cycle of amplitude A the state's volume shrinks by exp(-4 beta A)", date="each run",
         bound=1e-3, reason=DIFFERENCES, run=_determinant),
    Case(name="transmissibility-linear", title="Transmissibility of a spring and damper",
         compares="Five frequency ratios from 0.5 to 6 at a damping ratio of 0.15; largest relative difference.",
         source="closed form of the damped oscillator on a moving base", date="each run", bound=1e-10,
         reason="rounding of 1,024 samples and their transform", run=_transmissibility),
    Case(name="shock-limits-linear", title="Acceleration times travel over V^2 after a velocity step",
         compares="Five damping ratios up to the best one, 0.404; difference in half units of the last digit printed.",
         source="own table, from the extremes of the damped oscillator's free motion", date="2026-11", bound=1.0,
         reason=LAST_DIGIT, run=_shock_limits),
    Case(name="miles", title="Rms acceleration under flat random vibration",
         compares="Rms of 35 s against sqrt(pi/2 f Q W (1 + 1/Q^2)); relative difference.",
         source="J. W. Miles, J. Aeronaut. Sci. 21 (1954), with the damper's own share 1/Q^2", date="each run", bound=0.084,
         reason="three standard errors 1/(2 sqrt(B t)) with the oscillator's bandwidth pi/2 f/Q = 9.4 Hz and 35 s: 8.2 %; and "
         "0.2 % for the formula's noise below 1 Hz and above 250 Hz", run=_miles),
    Case(name="psd-rms", title="Rms of two standard vibration spectra", kind="published",
         compares="Overall level of a spectrum on logarithmic axes; difference in half units of the last digit printed.",
         source="MIL-STD-810H method 514.8 (general minimum integrity, 7.7 g rms) and NAVMAT P-9492 (6.06 g rms), "
         "values as commonly quoted",
         date="2019 and 1979", bound=1.0, reason=LAST_DIGIT, run=_psd_rms),
)  # fmt: skip
