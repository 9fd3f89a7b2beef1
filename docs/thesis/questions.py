"""What the thesis left open, with numbers."""

import math
from collections.abc import Callable
from functools import cache, partial

import numpy as np
import numpy.typing as npt
from figures import shock_frame
from figures.drawing import COLOURS, GUIDE, canvas, explain, inscribe
from figures.oscillator import branch, oscillator, resonance
from matplotlib.figure import Figure as Picture

import wirerope_mj as wr
from docs.thesis import naive
from docs.thesis.rope import MASS, MM, G, record, spring
from wirerope_mj.mounts.test_rig import measured

Array = npt.NDArray[np.float64]
PAIR = ((0.5, 0.5), (0.8, 0.2))
"""beta and gamma of the thesis' figures 3.6 and 3.14, in units of beta + gamma."""
SHAKEN = (0.2, 1.0)
"""Levels of the modified law [g]."""
LEVELS = (0.005, 0.02, 0.1)
"""Levels at which one set and two are held against the spring that they were fitted to [g]."""
RANGE = {0.005: (9.0, 13.5), 0.02: (8.5, 13.0), 0.1: (6.5, 11.5)}  # [Hz]


# -------------------------------------------------------------------------------------------------------- (a) the pair


def plain(beta: float, gamma: float) -> wr.BoucWen:
    """Return the law of figure 3.14: alpha = 1 kN/m, z in kN, n = 1."""
    return wr.BoucWen(alpha=1e3, beta=beta, gamma=gamma, n=1.0)


def modified(beta: float, gamma: float) -> wr.AsymmetricBoucWen:
    """Return the modified law of figure 3.21 with the pair's shares of beta + gamma = 1000 1/m."""
    return wr.AsymmetricBoucWen(
        alpha=1e5, beta=1e3 * beta, gamma=1e3 * gamma, n=1.0, k1=9.35e4, k2=0.0, k3=2e9, b=math.e, c=100.0
    )


def linear_peak(law: wr.BoucWen | wr.AsymmetricBoucWen, mass: float, level: float, gravity: float) -> tuple[float, float]:
    """Return frequency and acceleration of the resonance by the stiffness and the area of the law's cycles alone."""
    low, high = (4.5, 5.5) if gravity == 0.0 else (30.0, 40.0)
    for _ in range(3):
        frequencies = np.linspace(low, high, 41)
        found = wr.equivalent_linear(law, mass=mass, frequencies=frequencies, acceleration=level, gravity=gravity)
        heights = np.nanmax(found.amplitude.reshape(frequencies.size, -1), axis=1)
        top = int(np.argmax(heights))
        low, high = frequencies[max(top - 1, 0)], frequencies[min(top + 1, 40)]
    return float(frequencies[top]), float(heights[top])


def shot_peak(
    law: wr.BoucWen | wr.AsymmetricBoucWen, mass: float, level: float, gravity: float, *, fundamental: bool = False
) -> tuple[float, float]:
    """Return the same of the periodic motions that shooting finds, or of their part at the base's frequency."""
    low, high = (4.5, 5.5) if gravity == 0.0 else (30.0, 40.0)
    return resonance(branch(oscillator(law, mass=mass, gravity=gravity), low, high, level), fundamental=fundamental)


def pairs() -> dict[str, float]:
    """Return peaks of the pair with the plain and with the modified law, and their ratios both ways."""
    cases = {"plain": (plain, 1.0, 9.81, 0.0)}
    cases |= {f"modified_{place}": (modified, 3.5, level * G, G) for place, level in enumerate(SHAKEN, 1)}
    found: dict[str, float] = {}
    for name, (law, mass, level, gravity) in cases.items():
        ways = {"linear": linear_peak, "shot": shot_peak, "fundamental": partial(shot_peak, fundamental=True)}
        for way, peak in ways.items():
            (f_one, a_one), (f_two, a_two) = (peak(law(*one), mass, level, gravity) for one in PAIR)
            found |= {f"{name}_{way}": a_one / a_two, f"{name}_{way}_shift": 100.0 * (f_one / f_two - 1.0)}
        for way, key in (("shot", "apart"), ("fundamental", "fundamental_apart")):
            found[f"{name}_{key}"] = 100.0 * abs(found[f"{name}_linear"] / found[f"{name}_{way}"] - 1.0)
    for name, law, amplitude in (("plain", plain, 0.2), ("modified", modified, 0.6e-3)):
        one, two = (wr.cyclic_test(law(*both), [amplitude])[0] for both in PAIR)
        found[f"{name}_tips"] = 100.0 * (np.ptp(two.force) / np.ptp(one.force) - 1.0)
        found[f"{name}_area"] = 100.0 * (two.dissipated_energy / one.dissipated_energy - 1.0)
    return found


# ------------------------------------------------------------------------------------------------- (b) small amplitudes


@cache
def sets(scales: int) -> wr.Identification:
    """Return the fit of one set or of several to the virtual spring's record."""
    return wr.identify(record(spring()), scales=scales, profiles=False)


@cache
def responses(law: wr.AsymmetricBoucWen | wr.Parallel) -> dict[float, wr.Branch]:
    """Return the periodic motions of 50 kg on a law at the levels."""
    system = oscillator(law, mass=MASS, gravity=G)
    return {level: branch(system, *RANGE[level], level * G) for level in LEVELS}


def small() -> dict[str, float]:
    """Return resonances and transmissibilities of the spring and of both fits, and what the fits leave."""
    found = {f"error_{scales}": 100.0 * sets(scales).residual for scales in (1, 2)}
    found["n_1"] = float(sets(1).law.n)
    for place, component in enumerate(sets(2).law.components, 1):
        found[f"x_y_{place}"] = MM * float(component.normalised.x_y)
    for name, law in {"spring": spring(), "one": sets(1).law, "two": sets(2).law}.items():
        for place, (level, motions) in enumerate(responses(law).items(), 1):
            frequency, amplitude = resonance(motions)
            found |= {f"{name}_f{place}": frequency, f"{name}_t{place}": amplitude / (level * G)}
    found["moves"] = MM * found["spring_t1"] * LEVELS[0] * G / (2.0 * math.pi * found["spring_f1"]) ** 2
    return found


# ------------------------------------------------------------------------------------------------------ (e) parameters


TRUTH = wr.AsymmetricBoucWen.from_normalised(z_max=500.0, x_y=2e-3, sigma=0.7, n=1.2, k1=5e4, k2=0.0, k3=1e8, b=math.e, c=25.0)
TOLD = ("z_max", "x_y", "sigma", "n", "k1", "k3", "c_ln_b")
HELD = (0.4, 0.7, 1.0)
"""Values of sigma at which the tips are fitted."""


def told() -> dict[str, float]:
    """Return standard errors [%] by the three largest loops and by six, and what tips leave open: fits with sigma held."""
    loops = wr.cyclic_test(TRUTH, [0.5e-3, 1e-3, 2e-3, 5e-3, 10e-3, 15e-3])
    seen = measured(loops, seed=5, force_noise=0.005 * float(np.ptp(loops[-1].force)) / 2.0)
    options = {"start": TRUTH, "grid": False, "profiles": False}
    found: dict[str, float] = {}
    for name, chosen in (("three", seen[-3:]), ("six", seen)):
        fit = wr.identify(chosen, fixed={"k2": 0.0}, **options)
        for parameter in TOLD:
            row = fit.parameters[parameter]
            found[f"{name}_{parameter}"] = 100.0 * row.standard_error / abs(row.value)
    for place, sigma in enumerate(HELD, 1):
        fit = wr.identify(seen, data="skeleton", fixed={"k2": 0.0, "sigma": sigma}, **options)
        pairs = [(wr.cyclic_test(fit.law, [loop.amplitude])[0], loop) for loop in loops[2:5]]
        tips = [abs(np.ptp(one.force) / np.ptp(loop.force) - 1.0) for one, loop in pairs]
        areas = [one.dissipated_energy / loop.dissipated_energy - 1.0 for one, loop in pairs]
        found |= {f"tips_{place}": 100.0 * max(tips), f"area_{place}": 100.0 * max(areas, key=abs)}
    return found


def numbers() -> dict[str, float]:
    """Return the numbers of all five answers."""
    frame = {
        f"frame_{shock.replace('-', '_').replace(' ', '_')}": shock_frame.stiff_enough(shock, shock_frame.CASES[1])
        for shock in shock_frame.SHOCKS
    }
    return pairs() | small() | naive.numbers() | frame | {"frame_own": shock_frame.isolator_frequency()} | told()


def pictures() -> dict[str, Callable[[], Picture]]:
    """Return what draws the pair's loops, the small levels and the multipliers."""
    return {"questions_pair": _draw_pair, "questions_small": _draw_small, "questions_flags": partial(naive.draw)}


def _draw_pair() -> Picture:
    picture, (loops, peaks) = canvas(2, height=3.9)
    for (beta, gamma), colour in zip(PAIR, COLOURS, strict=False):
        loop = wr.cyclic_test(modified(beta, gamma), [0.6e-3])[0]
        label = f"β, γ = {1e3 * beta:g}, {1e3 * gamma:g} 1/m"
        loops.plot(MM * loop.deflection, loop.force, color=colour, lw=1.6, label=label)
        found = branch(oscillator(modified(beta, gamma), mass=3.5, gravity=G), 30.0, 40.0, SHAKEN[1] * G)
        peaks.plot(found.frequency, found.amplitude, color=colour, lw=1.6, label="shooting")
        f = np.linspace(30.0, 40.0, 101)
        near = wr.equivalent_linear(modified(beta, gamma), mass=3.5, frequencies=f, acceleration=SHAKEN[1] * G, gravity=G)
        heights = np.nanmax(near.amplitude.reshape(f.size, -1), axis=1)
        peaks.plot(f, heights, ":", color=colour, lw=1.4, label="stiffness and area")
    for line in peaks.lines[:2]:
        line.remove()
    peaks.set_xlim(30.0, 40.0)
    inscribe(loops, "loops of ±0.6 mm", "deflection [mm]", "force [N]")
    inscribe(peaks, f"3.5 kg at {SHAKEN[1]:g} g", "frequency [Hz]", "largest acceleration [m/s²]")
    explain(loops)
    explain(peaks, place="lower left")
    return picture


def _draw_small() -> Picture:
    picture, panels = canvas(3, height=3.4)
    laws = {"the spring": spring(), "one set": sets(1).law, "two sets": sets(2).law}
    for panel, level in zip(panels, LEVELS, strict=True):
        for line in panel.lines[:2]:
            line.remove()
        for (name, law), colour in zip(laws.items(), (GUIDE, COLOURS[1], COLOURS[0]), strict=True):
            motions = responses(law)[level]
            width = 3.0 if name == "the spring" else 1.4
            panel.plot(motions.frequency, motions.transmissibility, color=colour, lw=width, label=name)
        panel.set_xlim(*RANGE[level])
        panel.set_ylim(0.0, None)
        inscribe(panel, f"{level:g} g", "frequency [Hz]", "transmissibility [-]")
    explain(panels[1], place="below", columns=3)
    return picture
