"""The Bouc-Wen benchmark of Noel and Schoukens: its linear parameters, and its motion under a multisine."""

import math

import numpy as np
from scipy.integrate import solve_ivp

import wirerope_mj as wr
from verification.case import LAST_DIGIT, Case, Comparison, printed, series
from verification.models import oscillator

TURN = 2.0 * math.pi

MASS, DAMPER, SPRING, ALPHA, BETA, GAMMA, DELTA = 2.0, 10.0, 5e4, 5e4, 1e3, 0.8, -1.1
"""As published, exponent nu = 1: m y'' + c y' + k y + z = u, z' = alpha y' - beta (gamma |y'| z + delta y' |z|)."""

LINES = (5.3, 11.9, 19.1, 25.7, 31.3, 34.9, 38.3, 47.1, 61.7, 83.9, 107.3, 149.0)
"""Frequencies of the multisine [Hz], in the benchmark's band from 5 to 150 Hz."""

FORCE = 50.0 * math.sqrt(2.0 / len(LINES))
"""Amplitude of each line [N]: together 50 N rms, the level of the benchmark."""


def _benchmark() -> wr.System:
    """Return the benchmark as a mass on two mounts in parallel; force and mass of base excitation are u = -m a."""
    laws = {
        "hysteresis": wr.BoucWen(alpha=ALPHA, beta=BETA * GAMMA, gamma=BETA * DELTA, n=1.0),
        "linear": wr.KelvinVoigt(k=SPRING, c=DAMPER),
    }
    return oscillator(laws, mass=MASS)


def _linear() -> Comparison:
    """Return the comparison of the linear natural frequency and damping with the published ones."""
    found = wr.modes(_benchmark())
    values = {
        "natural frequency [Hz]": ("35.59", found.frequencies[0]),
        "damping ratio [%]": ("1.12", 100.0 * found.damping_ratio[0]),
    }
    return printed(values)


def _event_split(stop: float, times: np.ndarray) -> np.ndarray:
    """Return y at `times` from rest, by DOP853 between reversals and zeros of z, where the right-hand side has no kink."""
    omegas = TURN * np.array(LINES)
    t, state, out = 0.0, np.zeros(3), np.zeros(times.size)
    sign_v = sign_z = 1.0  # all sines begin upwards
    while t < stop:
        slope = BETA * (GAMMA * sign_v * sign_z + DELTA)

        def rates(t: float, y: np.ndarray, slope: float = slope) -> list[float]:
            force = FORCE * np.sin(omegas * t).sum()
            return [y[1], (force - DAMPER * y[1] - SPRING * y[0] - y[2]) / MASS, (ALPHA - slope * abs(y[2])) * y[1]]

        def reversal(t: float, y: np.ndarray) -> float:
            return float(y[1])

        def crossing(t: float, y: np.ndarray) -> float:
            return float(y[2])

        for event, sign in ((reversal, sign_v), (crossing, sign_z)):
            event.terminal, event.direction = True, -sign  # type: ignore[attr-defined]
        run = solve_ivp(
            rates, (t, stop), state, "DOP853", rtol=1e-12, atol=[1e-15, 1e-12, 1e-10], dense_output=True,
            events=[reversal, crossing], first_step=1e-6,
        )  # fmt: skip
        inside = (times >= t) & (times <= run.t[-1])
        if inside.any():
            out[inside] = run.sol(times[inside])[0]
        t, state = float(run.t[-1]), run.y[:, -1].copy()
        if run.t_events[0].size:
            state[1], sign_v = 0.0, -sign_v
        elif run.t_events[1].size:
            state[2], sign_z = 0.0, -sign_z
        else:
            break
    return out


def _multisine() -> Comparison:
    """Return the comparison of the displacement under the multisine, from rest."""
    stop, rate = 1.0, 750.0
    times = np.arange(int(stop * rate) + 1) / rate
    lines = [wr.Sine(frequency=f, acceleration=-FORCE / MASS, direction="z") for f in LINES]
    motion = sum(lines[1:], start=lines[0])
    response = wr.simulate(
        _benchmark(), motion, duration=stop, initial="unloaded", timestep=2e-5, sample_rate=rate
    )  # fmt: skip
    return series(_event_split(stop, times), response.mounts["m_linear"].deflection[:, 2], "m")


NOEL = (
    "J. P. Noel and M. Schoukens, Hysteretic benchmark with a dynamic nonlinearity, Workshop on Nonlinear System "
    "Identification Benchmarks, Brussels 2016 (data set doi 10.4121/12967592); parameters and linear values as others quote "
    "its table 1"
)

CASES = (
    Case(name="noel-schoukens-linear", title="Bouc-Wen benchmark of Noel and Schoukens: linear modal parameters",
         compares="Natural frequency and damping ratio of small cycles; difference in half units of the last digit printed.",
         source=NOEL, date="2016", bound=1.0, reason=LAST_DIGIT, kind="published", run=_linear),
    Case(name="noel-schoukens-multisine", title="Bouc-Wen benchmark of Noel and Schoukens: a multisine from rest",
         compares="Displacement at 751 instants under twelve lines from 5 to 149 Hz with 50 N rms, the benchmark's level; "
         "largest difference over the largest displacement.",
         source=NOEL + "; own integration by DOP853 between events, written here",
         date="each run", bound=1e-5, run=_multisine,
         reason="fixed steps of 20 microseconds are of second order at the kinks of the law; halving them quarters the error"),
)  # fmt: skip
