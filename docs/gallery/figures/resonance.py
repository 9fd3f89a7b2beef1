"""Figures 3.12 to 3.16: what each parameter of the Bouc-Wen law does to the resonance of one mass."""

from collections.abc import Mapping
from dataclasses import dataclass
from functools import partial
from typing import Any

import numpy as np
from matplotlib.figure import Figure as Picture

import wirerope_mj as wr
from figures.drawing import COLOURS, GUIDE, canvas, explain, inscribe, note
from figures.figure import Figure, written
from figures.oscillator import branch, oscillator, peak, resonance, swept

UNIT = 1000.0  # [N]: the unit of z and of the stiffness, see READING
LEVEL = 9.81  # [m/s^2]
RANGE = (3.0, 8.0)  # [Hz] of the periodic motions
SWEEP = (1.0, 8.0)  # [Hz]; from rest, like the thesis' sweeps
STEP = 2e-3  # [s] of the sweeps: 62 in a period at the highest frequency

READING = (
    "The unit of the level is lost in our source, and that of z is not stated. We read α = 1 kN/m, z in kN and 9.81 m/s²; N, "
    "mm and 9.81 mm/s² give the same curves. Then 1 kg resonates near √(α/M)/2π = 5.03 Hz, inside the thesis' sweep from 0.1 "
    "to 30 Hz, and all that it says of the parameters comes out. With z in N and x in m it would be 0.16 Hz, and 9.81 N is "
    "about z_max or above it."
)


@dataclass(frozen=True, kw_only=True)
class Case:
    """One set of parameters: alpha [kN/m], beta and gamma [kN^(1-n)/(kN m)], n, and its name in the legend."""

    name: str
    label: str
    beta: float = 0.5
    gamma: float = -0.4
    alpha: float = 1.0
    n: float = 1.0

    @property
    def law(self) -> wr.BoucWen:
        """The law in newtons: z in kilonewtons to the power of n is divided by 1000^n."""
        unit = UNIT ** (1.0 - self.n)
        return wr.BoucWen(alpha=UNIT * self.alpha, beta=self.beta * unit, gamma=self.gamma * unit, n=self.n)

    @property
    def system(self) -> wr.System:
        """1 kg on it."""
        return oscillator(self.law, mass=1.0)

    def branch(self, frequencies: tuple[float, float] = RANGE) -> wr.Branch:
        """Its periodic motions."""
        return branch(self.system, *frequencies, LEVEL)

    def tail(self) -> wr.Branch:
        """Its periodic motions from the end of RANGE to that of WIDE, where little happens."""
        return branch(self.system, RANGE[1], WIDE[1], LEVEL)

    def sweep(self, frequencies: tuple[float, float] = SWEEP) -> wr.FrequencySweep:
        """Its sweep up."""
        return swept(self.system, *frequencies, LEVEL, timestep=STEP)


BETAS = tuple(Case(name=f"beta_{b:g}", label=f"β = {b:g} 1/m", beta=b) for b in (0.5, 0.8, 1.1))
GAMMAS = tuple(Case(name=f"gamma_{g:g}", label=f"γ = {written(g)} 1/m", beta=0.8, gamma=g) for g in (-0.4, 0.0, 0.4))
PAIR = (
    Case(name="half", label="β = 0.5, γ = 0.5 1/m", beta=0.5, gamma=0.5),
    Case(name="most", label="β = 0.8, γ = 0.2 1/m", beta=0.8, gamma=0.2),
)
ALPHAS = tuple(Case(name=f"alpha_{a:g}", label=f"α = {a:g} kN/m", alpha=a) for a in (0.5, 1.0, 2.0))
ALPHA_RANGE, ALPHA_SWEEP = (2.5, 10.0), (1.0, 10.0)
EXPONENTS = tuple(Case(name=f"n_{n:g}", label=f"n = {n:g}", n=n) for n in (0.5, 1.0, 2.0, 10.0))
WIDE = (1.0, 30.0)  # [Hz] of the sweeps of figure 3.16


def figures() -> list[Figure]:
    """Return figures 3.12 to 3.16."""
    return [_beta(), _gamma(), _pair(), _alpha(), _exponent()]


def measure(
    cases: tuple[Case, ...], frequencies: tuple[float, float] = RANGE, sweep: tuple[float, float] = SWEEP
) -> dict[str, float]:
    """Return peaks [Hz, m/s^2] of branches and sweeps of each case, and how many of its motions are unstable."""
    numbers = {}
    for case in cases:
        found, envelope = case.branch(frequencies), case.sweep(sweep)
        numbers[f"{case.name}_frequency"], numbers[f"{case.name}_amplitude"] = resonance(found)
        seen = peak(envelope.frequency, envelope.amplitude)
        numbers[f"{case.name}_swept_frequency"], numbers[f"{case.name}_swept_amplitude"] = seen
        numbers[f"{case.name}_unstable"] = float(np.count_nonzero(~found.stable))
    return numbers


def peaks(numbers: Mapping[str, float], cases: tuple[Case, ...]) -> tuple[str, str]:
    """Return frequencies and amplitudes of the peaks as lists in words."""
    return listed([numbers[f"{c.name}_frequency"] for c in cases], ".2f"), listed(
        [numbers[f"{c.name}_amplitude"] for c in cases], ".0f"
    )


def listed(values: list[float], form: str) -> str:
    """Return numbers as a list in words."""
    texts = [written(value, form) for value in values]
    return ", ".join(texts[:-1]) + " and " + texts[-1]


def _beta() -> Figure:
    n = measure(BETAS)
    frequencies, amplitudes = peaks(n, BETAS)
    lag = n["beta_0.5_swept_frequency"] / n["beta_0.5_frequency"] - 1.0
    low = 1.0 - n["beta_0.5_swept_amplitude"] / n["beta_0.5_amplitude"]
    return Figure(
        number="3.12",
        title="The influence of β on the resonance",
        section="3.3.1",
        statement="One mass on the law (figure 3.11), its ground moved with constant acceleration while the frequency rises by "
        "two octaves per minute. As β grows, the resonance falls, because the damping grows, and shifts slightly to the left.",
        shown=f"As β grows, the peak of the periodic motions falls ({amplitudes} m/s²) and shifts to the left ({frequencies} "
        f"Hz). The sweep runs behind them: for β = 0.5 1/m its peak comes {100 * lag:.1f} % later and is {100 * low:.0f} % "
        "lower. The law has no elastic part: one multiplier of every motion is exactly 1, the offset of the mass is free, and "
        "none of the motions is unstable.",
        parameters="γ = −0.4 1/m, α = n = 1 and M = 1 kg as in the thesis; the values of β are our own. " + READING,
        numbers=n,
        draw=partial(_draw, BETAS, n, "γ = −0.4 1/m"),
    )


def _gamma() -> Figure:
    n = measure(GAMMAS)
    frequencies, amplitudes = peaks(n, GAMMAS)
    return Figure(
        number="3.13",
        title="The influence of γ on the resonance",
        section="3.3.1",
        statement="As γ grows, the resonance shifts to the left and falls too, by the additional damping.",
        shown=f"As γ grows, the peak shifts to the left ({frequencies} Hz) and falls ({amplitudes} m/s²), by far less than "
        "with β: γ adds no area of its own to the loop, it lowers the stiffness.",
        parameters="β = 0.8 1/m, α = n = 1 as in the thesis; the values of γ are our own. Mass, level and units as in figure "
        "3.12.",
        numbers=n,
        draw=partial(_draw, GAMMAS, n, "β = 0.8 1/m"),
    )


def _pair() -> Figure:
    n = measure(PAIR)
    higher = n["half_amplitude"] / n["most_amplitude"] - 1.0
    apart = n["most_frequency"] / n["half_frequency"] - 1.0
    return Figure(
        number="3.14",
        title="The redundant pair of figure 3.6 in resonance",
        section="3.3.1",
        statement="The pair with almost the same loops does not respond in the same way: the amplitude of the resonance "
        "differs, and slightly its frequency.",
        shown=f"With β = γ = 0.5 the peak is {100 * higher:.0f} % higher than with β = 0.8, γ = 0.2 "
        f"({n['half_amplitude']:.0f} against {n['most_amplitude']:.0f} m/s²) and {100 * apart:.1f} % lower in frequency "
        f"({n['half_frequency']:.2f} against {n['most_frequency']:.2f} Hz). The damping does it: the loops' areas are apart by "
        "more than their tips (figure 3.6), and a dynamic test tells the two sets apart where tips do not.",
        parameters="β, γ, α = n = 1 as in the thesis. Mass, level and units as in figure 3.12.",
        numbers=n,
        draw=partial(_draw, PAIR, n, "β + γ = 1 1/m"),
    )


def _alpha() -> Figure:
    n = measure(ALPHAS, ALPHA_RANGE, ALPHA_SWEEP)
    frequencies, amplitudes = peaks(n, ALPHAS)
    estimates = [(3.0 * np.pi * LEVEL * UNIT * case.alpha / (4.0 * case.beta)) ** 0.5 for case in ALPHAS]
    return Figure(
        number="3.15",
        title="The influence of α on the resonance",
        section="3.3.2",
        statement="As α grows, the resonance rises in frequency and in amplitude.",
        shown=f"As α grows, the resonance rises in frequency ({frequencies} Hz) and in amplitude ({amplitudes} m/s²). Both go "
        "with the root of α: at small amplitudes, where the loop's area is 4βαA³/3, the peak is √(3π a₀α/(4βM)), here "
        f"{listed(estimates, '.0f')} m/s².",
        parameters="β = 0.5 1/m, γ = −0.4 1/m and n = 1 as in the thesis; the values of α are our own. Mass, level and units "
        "as in figure 3.12.",
        numbers=n,
        draw=partial(_draw, ALPHAS, n, "n = 1", ALPHA_RANGE, ALPHA_SWEEP),
    )


def _exponent() -> Figure:
    n = measure(EXPONENTS, RANGE, WIDE)
    frequencies, amplitudes = peaks(n, EXPONENTS)
    for case in EXPONENTS:
        envelope = case.sweep(WIDE)
        orbit = wr.periodic_orbit(case.system, frequency=10.0, acceleration=LEVEL, direction="z")
        n[f"{case.name}_steady_10"] = float(orbit.response.peaks.bodies["mass"].acceleration.maximum[2])
        n[f"{case.name}_multiplier_10"] = float(np.abs(orbit.floquet_multipliers).max())
        n[f"{case.name}_swept_10"] = float(envelope.amplitude[np.abs(envelope.frequency - 10.0) < 0.5].max())
    return Figure(
        number="3.16",
        title="The influence of n on the resonance",
        section="3.3.2",
        statement="As n grows, the resonance falls in frequency and rises in amplitude. At n = 10 a further peak stands near "
        "10 Hz.",
        shown=f"As n grows, the resonance falls in frequency ({frequencies} Hz) and rises in amplitude ({amplitudes} m/s²). "
        "The sweeps show what else n does: behind the resonance the mass rings at its own frequency, and at n = 10 nothing "
        f"ends that. At 10 Hz the periodic motion of n = 10 has {n['n_10_steady_10']:.2f} m/s², the sweep "
        f"{n['n_10_swept_10']:.0f} m/s²; with n = 0.5 they are {n['n_0.5_steady_10']:.2f} and {n['n_0.5_swept_10']:.2f} "
        "m/s². A loop of amplitude A loses 4βαⁿAⁿ⁺²/(n+2): below yielding, a large n is a spring without damping. The "
        "periodic motions themselves have no peak near 10 Hz for any n here, and neither has our sweep: what it has is the "
        "level at which the resonance left the mass ringing. Figure 3.17 shows what that looks like at 10 Hz, and what may be "
        "taken for a peak.",
        parameters="α = 1, β = 0.5 and γ = −0.4 as in the thesis, with z in kN, so that n may be varied; its values are our "
        "own. Mass and level as in figure 3.12.",
        numbers=n,
        draw=partial(_draw, EXPONENTS, n, "α = 1 kN/m", RANGE, WIDE),
    )


def _draw(
    cases: tuple[Case, ...],
    numbers: Mapping[str, float],
    title: str,
    frequencies: tuple[float, float] = RANGE,
    sweep: tuple[float, float] = SWEEP,
) -> Picture:
    picture, (whole, near) = canvas(2)
    for panel in (whole, near):
        for line in panel.lines[:2]:
            line.remove()  # neither axis has a zero here
    for case, colour in zip(cases, COLOURS, strict=False):
        found, envelope = case.branch(frequencies), case.sweep(sweep)
        for panel in (whole, near):
            panel.plot(envelope.frequency, envelope.amplitude, color=colour, lw=0.9, alpha=0.55)
            panel.plot(found.frequency, found.amplitude, color=colour, lw=1.8, label=case.label)
        if sweep == WIDE:
            whole.plot(case.tail().frequency, case.tail().amplitude, color=colour, lw=1.8)
        near.plot(numbers[f"{case.name}_frequency"], numbers[f"{case.name}_amplitude"], "o", color=colour, ms=5)
    whole.set_xscale("log")
    whole.set_yscale("log")
    shown = sweep if sweep == WIDE else frequencies
    whole.set_xlim(*shown)
    _label_frequencies(whole, shown)
    tops = [numbers[f"{case.name}_frequency"] for case in cases]
    near.set_xlim(0.88 * min(tops), 1.14 * max(tops))
    near.set_ylim(0.0, 1.2 * max(numbers[f"{case.name}_amplitude"] for case in cases))
    inscribe(whole, title, "frequency [Hz]", "largest acceleration [m/s²]")
    inscribe(near, "near the resonance; dots: peaks", "frequency [Hz]", "largest acceleration [m/s²]")
    explain(whole, place="lower left" if cases is ALPHAS else "upper left")
    note(
        near,
        "thick: periodic\nthin: sweep up",
        (0.97, 0.96),
        xycoords="axes fraction",
        ha="right",
        va="top",
        colour=GUIDE,
    )
    return picture


def _label_frequencies(panel: Any, frequencies: tuple[float, float]) -> None:
    """Write plain numbers at a logarithmic axis of frequencies."""
    ticks = [f for f in (1, 2, 3, 4, 5, 6, 8, 10, 15, 20, 30) if frequencies[0] <= f <= frequencies[1]]
    ticks = [f for f in ticks if frequencies[1] < 20 or f in (1, 2, 3, 5, 10, 20, 30)]
    panel.set_xticks(ticks, [str(f) for f in ticks])
    panel.minorticks_off()
