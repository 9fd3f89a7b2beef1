"""Laws and loops against closed forms."""

import math
from collections.abc import Callable

import numpy as np
from scipy.optimize import brentq
from scipy.special import gamma as gamma_function
from scipy.special import hyp2f1

import wirerope_mj as wr
from verification.case import Case, Comparison, series, single_values
from verification.models import path_through, steady_loop

# beta, gamma, n, amplitude, z at the turning point, energy of a cycle; alpha = 1
STEADY = (
    (0.8, 0.2, 1, 1, 0.7488105660, 0.8309464386), (0.5, 0.5, 1, 1, 0.7215354572, 0.5932447550),
    (0.8, 0.2, 1, 2, 0.9608865002, 3.8868885201), (0.5, 0.5, 1, 2, 0.9525215090, 3.2826167390),
    (1.0, 0.0, 1, 1, 0.7615941560, 0.9536233762), (1.0, 0.0, 1, 2, 0.9640275801, 4.1438896797),
    (0.8, 0.2, 2, 1, 0.8481664027, 0.6727513048), (0.5, 0.5, 2, 1, 0.8256588617, 0.4630878365),
    (0.5, -0.4, 1, 1, 1.1431451805, 0.6222631732), (0.5, -0.5, 1, 2, 2.6934413590, 4.4808609183),
    (0.8, -1.0, 2, 2, 7.9446241187, 10.4247588475),
)  # fmt: skip


def _steady(energy: bool) -> Comparison:
    """Return the comparison of eleven steady Bouc-Wen loops with their table."""
    pairs = {}
    for beta, gamma, n, amplitude, z, work in STEADY:
        loop = steady_loop(wr.BoucWen(alpha=1.0, beta=beta, gamma=gamma, n=float(n)), float(amplitude))
        label = f"beta {beta}, gamma {gamma}, n {n}, A {amplitude}"
        pairs[label] = (work, loop.dissipated_energy) if energy else (z, loop.hysteretic_state[0])
    return single_values(pairs, "J" if energy else "N")


def _turning_point() -> Comparison:
    """Return the comparison of z at the turning points of a sharp loop with the hypergeometric equation that it solves."""
    alpha, beta, gamma, n = 1.2e5, 3.0, -1.2, 1.7

    def distance(z: float, slope: float) -> float:
        return z / alpha * float(hyp2f1(1.0, 1.0 / n, 1.0 + 1.0 / n, slope * z**n / alpha))

    law, bound = wr.BoucWen(alpha=alpha, beta=beta, gamma=gamma, n=n), (alpha / (beta + gamma)) ** (1.0 / n)
    pairs = {}
    for amplitude in (5e-4, 1e-3, 3e-3, 1e-2):
        exact = brentq(
            lambda z, a=amplitude: distance(z, gamma - beta) + distance(z, gamma + beta) - 2.0 * a,
            1e-6 * bound, bound * (1.0 - 1e-15), xtol=1e-13 * bound, rtol=1e-14,
        )  # fmt: skip
        pairs[f"A {1e3 * amplitude:g} mm"] = (exact, steady_loop(law, amplitude, cycles=400).hysteretic_state[0])
    return single_values(pairs, "N")


def _virgin() -> Comparison:
    """Return the comparison of a virgin path for n = 2 with z_max tanh(x sqrt(alpha (beta + gamma)))."""
    law = wr.BoucWen(alpha=1.0e5, beta=0.3, gamma=0.1, n=2.0, k=2e4)
    x = np.linspace(0.0, 0.02, 201)
    exact = 2e4 * x + math.sqrt(1e5 / 0.4) * np.tanh(math.sqrt(1e5 * 0.4) * x)
    return series(exact, law.trace(x).force, "N")


def _masing() -> Comparison:
    """Return the comparison of loop areas of Jenkin elements in parallel with sum 4 h (A - h/c)."""
    stiffness, slip = [6e4, 4e4, 3e4], [60.0, 100.0, 200.0]
    law = wr.Masing(stiffness=stiffness, slip_force=slip, k=2e4)
    pairs = {}
    for amplitude in (1.5e-3, 4e-3, 9e-3):
        exact = sum(4.0 * h * max(amplitude - h / c, 0.0) for c, h in zip(stiffness, slip, strict=True))
        pairs[f"A {1e3 * amplitude:g} mm"] = (exact, steady_loop(law, amplitude).dissipated_energy)
    return single_values(pairs, "J")


def _dry_friction() -> Comparison:
    """Return the comparison of loop areas of enhanced dry friction with 4 d (A - u tanh(A/u))."""
    d, u = 300.0, 3e-3
    law = wr.EnhancedDryFriction(k=5e4, d=d, u_c=u)
    pairs = {
        f"A {1e3 * a:g} mm": (4.0 * d * (a - u * math.tanh(a / u)), steady_loop(law, a).dissipated_energy)
        for a in (3e-4, 3e-3, 3e-2)
    }
    return single_values(pairs, "J")


def _small_amplitude() -> Comparison:
    """Return the comparison of the energy of small cycles with 4 beta alpha^n A^(n+2) / (n+2)."""
    pairs = {}
    for n in (0.5, 1.0, 2.0):
        amplitude = 1e-4
        law = wr.BoucWen(alpha=1.0, beta=0.8, gamma=0.2, n=n)
        exact = 4.0 * 0.8 * amplitude ** (n + 2.0) / (n + 2.0)
        pairs[f"n {n:g}"] = (exact, steady_loop(law, amplitude).dissipated_energy)
    return single_values(pairs, "J")


def _power_damper() -> Comparison:
    """Return the comparison of the energy of an n-th power damper in a sine with gamma_n c w^n A^(n+1)."""
    amplitude, omega, c = 4e-3, 2.0 * math.pi * 8.0, 900.0
    time = np.linspace(0.0, 2.0 * math.pi / omega, 8001)
    x, v = amplitude * np.sin(omega * time), amplitude * omega * np.cos(omega * time)
    pairs = {}
    for n in (1.0, 1.5, 2.0, 3.0):
        law = wr.TinkerCutchins(k1=8e4, k2=0.0, k3=2e7, c=c, n=n, f0=0.0, f1=0.0, f2=0.0, smoothing=1e-3)
        factor = 2.0 * math.sqrt(math.pi) * gamma_function((n + 2.0) / 2.0) / gamma_function((n + 3.0) / 2.0)
        exact = factor * c * omega**n * amplitude ** (n + 1.0)
        pairs[f"n {n:g}"] = (exact, law.trace(x, time=time, rate=v).dissipated_energy)
    return single_values(pairs, "J")


VAIANA_ROSATI = {"kb": 3e4, "f0": 150.0, "alpha": 300.0, "b1": 20.0, "b2": 60.0, "g1": 15.0, "g2": 300.0, "g3": 1e-3}
RETURN = {"f0_minus": 100.0, "alpha_minus": 450.0}


def _vaiana_rosati() -> Comparison:
    """Return the comparison of Vaiana and Rosati's law on a random path with their analytical formulation."""
    turns = (0.01 * np.random.default_rng(5).uniform(-1.0, 1.0, 30)).tolist()
    path = path_through(turns, 40)
    p = VAIANA_ROSATI

    def curve(u: float, sign: float) -> float:
        elastic = p["b1"] * math.expm1(p["b2"] * u) - 2.0 * p["g1"]
        elastic += 4.0 * p["g1"] / (1.0 + math.exp(-p["g2"] * (u - p["g3"])))
        return elastic + p["kb"] * u + sign * (p["f0"] if sign > 0.0 else RETURN["f0_minus"])

    law = wr.VaianaRosati(**p, **RETURN)
    middle = 0.5 * (curve(0.0, 1.0) + curve(0.0, -1.0))  # the law here stands unloaded midway between its limit curves
    force = np.zeros(path.size)
    for i in range(1, path.size):
        sign = math.copysign(1.0, path[i] - path[i - 1])
        rate = p["alpha"] if sign > 0.0 else RETURN["alpha_minus"]
        decay = math.exp(-rate * abs(path[i] - path[i - 1]))
        force[i] = curve(path[i], sign) - middle - (curve(path[i - 1], sign) - middle - force[i - 1]) * decay
    return series(force, law.trace(path).force, "N")


def _case(name: str, title: str, compares: str, source: str, bound: float, reason: str, run: Callable[[], Comparison]) -> Case:
    """Return a case of this file, whose reference is computed in it."""
    return Case(name=name, title=title, compares=compares, source=source, date="each run", bound=bound, reason=reason, run=run)


TABLE = "own table of steady Bouc-Wen loops, computed without this library by event-split DOP853 integration and by quadrature"
RELATIVE = "largest relative difference."
ROUNDING = "both are closed forms or series to rounding"

CASES = (
    Case(name="bouc-wen-turning-points", title="Steady Bouc-Wen loops: z at the turning point", source=TABLE, date="2026-11",
         compares=f"Eleven loops of all kinds, softening to hardening; {RELATIVE}", bound=1e-10,
         reason="half a unit of the tenth digit printed, 5e-11 over 0.72", run=lambda: _steady(False)),
    Case(name="bouc-wen-loop-energy", title="Steady Bouc-Wen loops: energy of a cycle", source=TABLE, date="2026-11",
         compares=f"The same eleven loops; {RELATIVE}", bound=2e-10,
         reason="half a unit of the tenth digit printed, 5e-11 over 0.46", run=lambda: _steady(True)),
    _case("bouc-wen-hypergeometric", "Turning points of a sharp loop, n = 1.7",
          f"z at four amplitudes; {RELATIVE}",
          "A. Charalampakis and V. Koumousis, J. Sound Vib. 309 (2008): the path in z is Gauss' hypergeometric function; "
          "roots by SciPy", 1e-8, "what the library states for exponents without a closed form", _turning_point),
    _case("bouc-wen-virgin", "Virgin path for n = 2", "Force at 201 deflections; largest difference over the largest force.",
          "closed form z = z_max tanh(x sqrt(alpha (beta + gamma)))", 1e-12, ROUNDING, _virgin),
    _case("masing-loop-area", "Loop area of three Jenkin elements", f"Three amplitudes; {RELATIVE}",
          "closed form: sum of 4 h (A - h/c) over the elements that slip", 1e-12, ROUNDING, _masing),
    _case("dry-friction-loop-area", "Loop area of enhanced dry friction", f"Three amplitudes; {RELATIVE}",
          "closed form 4 d [A - u tanh(A/u)] of the steady loop", 1e-11,
          "at A = u/10 the area is a difference of numbers 300 times as large", _dry_friction),
    _case("bouc-wen-small-amplitude", "Energy of small cycles", f"Exponents 0.5, 1 and 2 at A = 1e-4; {RELATIVE}",
          "leading term of the energy, 4 beta alpha^n A^(n+2)/(n+2)", 1e-2,
          "the next term is of relative order (beta + gamma) A^n: 1e-2 for n = 0.5", _small_amplitude),
    _case("power-damper-energy", "Energy of an n-th power damper over a sine", f"Exponents 1, 1.5, 2 and 3; {RELATIVE}",
          "closed form gamma_n c w^n A^(n+1), gamma_n = 2 sqrt(pi) G((n+2)/2)/G((n+3)/2), the damper of Tinker and Cutchins "
          "(J. Sound Vib. 157, 1992)", 1e-9,
          "a sum over 8,000 steps of one period, which converges faster than any power of their number", _power_damper),
    _case("vaiana-rosati-analytical", "Vaiana and Rosati's law on a random path of thirty turning points",
          "Force at 1,201 deflections; largest difference over the largest force.",
          "N. Vaiana, Vaiana-Rosati model, analytical formulation (slides, 2023)", 1e-10, ROUNDING, _vaiana_rosati),
)  # fmt: skip
