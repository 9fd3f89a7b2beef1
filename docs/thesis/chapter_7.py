"""Chapter 7 and appendix G: periodic motions in time and as phase portraits, their multipliers, and the smooth law."""

from collections.abc import Callable
from functools import cache

import numpy as np
from figures.drawing import COLOURS, canvas, explain, inscribe
from figures.oscillator import branch, harmonics
from matplotlib.figure import Figure as Picture

import wirerope_mj as wr
from docs.thesis.chapter_6 import LEVELS, ORDER_LEVEL, RANGE, G, shaker, sweep

MM = 1e3
AT = (36.2, 18.2, 12.2)
"""Frequencies of the thesis' harmonic, second and third superharmonic resonance [Hz]."""
WIDTHS = (0.1, 0.03, 0.01)
"""Of the smooth law, relative to the largest velocity of the mount."""


@cache
def orbit(frequency: float, smoothing: float | None = None) -> wr.PeriodicOrbit:
    """Return the periodic motion of the shipped rig at 0.5 g."""
    return wr.periodic_orbit(
        shaker(), frequency=frequency, acceleration=ORDER_LEVEL, direction="z", smoothing=smoothing, tolerance=1e-6
    )


def amplitude(found: wr.PeriodicOrbit) -> float:
    """Return the largest acceleration of the mass [m/s^2]."""
    peaks = found.response.peaks.bodies["mass"].acceleration
    return float(max(peaks.maximum[2], -peaks.minimum[2]))


def numbers() -> dict[str, float]:
    """Return amplitudes, shares of the harmonics and multipliers, sweeps over motions, and what smoothing changes."""
    found: dict[str, float] = {}
    for place, frequency in enumerate(AT, 1):
        one = orbit(frequency)
        content = harmonics(one, 3)
        found |= {
            f"a{place}": amplitude(one), f"second{place}": 100.0 * content[1] / content[0],
            f"third{place}": 100.0 * content[2] / content[0],
            f"multiplier{place}": float(np.abs(one.floquet_multipliers).max()),
        }  # fmt: skip
    for place, level in enumerate(LEVELS, 1):
        motions, envelope = branch(shaker(), *RANGE, level * G), sweep(level, True)
        order = np.argsort(motions.frequency)
        shot = np.interp(envelope.frequency, motions.frequency[order], motions.amplitude[order])
        found[f"sweep{place}"] = 100.0 * float(np.median(np.abs(envelope.amplitude / shot - 1.0)))
        found |= {f"points{place}": float(motions.frequency.size), f"unstable{place}": float(np.sum(~motions.stable))}
    for place, width in enumerate(WIDTHS, 1):
        one = orbit(AT[0], width)
        found[f"smooth{place}"] = 100.0 * (amplitude(one) / found["a1"] - 1.0)
        found[f"smooth_multiplier{place}"] = float(np.abs(one.floquet_multipliers).max())
    return found


def pictures() -> dict[str, Callable[[], Picture]]:
    """Return what draws the histories and the phase portraits."""
    return {"chapter_7_motions": _draw}


def _draw() -> Picture:
    picture, panels = canvas(3, rows=2, height=3.0)
    for column, (frequency, colour) in enumerate(zip(AT, COLOURS, strict=False)):
        run = orbit(frequency).response
        history, portrait = panels[column], panels[3 + column]
        history.plot(MM * run.time, run.bodies["mass"].acceleration[:, 2], color=colour, lw=1.6, label="mass")
        history.plot(MM * run.time, run.base.acceleration[:, 2], color="0.5", lw=0.9, label="base")
        deflection = run.mounts["m1"].deflection[:, 2]
        rate = run.bodies["mass"].velocity[:, 2] - run.base.velocity[:, 2]
        portrait.plot(MM * deflection, rate, color=colour, lw=1.6)
        inscribe(history, f"{frequency:g} Hz", "time [ms]", "acceleration [m/s²]")
        inscribe(portrait, "phase portrait", "deflection [mm]", "its rate [m/s]")
        portrait.lines[1].remove()
    explain(panels[0], place="upper right")
    return picture
