"""Chapter 4: quasi-static tests of five springs at three operating points, on the virtual rig."""

from collections.abc import Callable
from functools import cache

import numpy as np
from figures.drawing import BLUES, COLOURS, canvas, explain, inscribe
from matplotlib.figure import Figure as Picture

import wirerope_mj as wr
from docs.thesis.rope import AMPLITUDES, MM, NAMES, five, record, spring
from wirerope_mj.mounts.test_rig import hardening_overlap, softening_to_hardening

POINTS = {"compressed": -5e-3, "centre": 0.0, "stretched": 5e-3}
"""Operating points [m]: ours, the thesis' are lost."""
SHOWN = 2e-3  # [m]
FINE = tuple(float(a) for a in np.geomspace(0.5e-3, 15e-3, 15))


@cache
def secants(name: str) -> tuple[wr.Loop, ...]:
    """Return closed cycles of one of the five, at amplitudes fine enough to find the least stiffness."""
    return tuple(wr.cyclic_test(five()[name], FINE))


def numbers() -> dict[str, float]:
    """Return stiffness, damping, overlap and the turn from softening to hardening of the five, and the operating points."""
    found: dict[str, float] = {}
    for name in NAMES:
        loops = record(five()[name])
        small, large = loops[0], loops[-1]
        turn = softening_to_hardening(secants(name))
        found |= {
            f"{name}_small": small.secant_stiffness / 1e3, f"{name}_large": large.secant_stiffness / 1e3,
            f"{name}_damping": 100.0 * loops[3].damping_ratio, f"{name}_overlap": hardening_overlap(loops),
            f"{name}_turn": MM * turn.amplitude, f"{name}_least": turn.stiffness / 1e3,
        }  # fmt: skip
    found["largest_spread"] = 100.0 * (max(found[f"{n}_large"] for n in NAMES) / min(found[f"{n}_large"] for n in NAMES) - 1)
    for name, point in POINTS.items():
        loop = wr.cyclic_test(spring(), [SHOWN], operating_point=point)[0]
        found |= {f"{name}_k": loop.secant_stiffness / 1e3, f"{name}_zeta": 100.0 * loop.damping_ratio}
        found[f"{name}_area"] = 1e3 * loop.dissipated_energy
    return found


def pictures() -> dict[str, Callable[[], Picture]]:
    """Return what draws the loops and the stiffness over the amplitude."""
    return {"chapter_4_loops": _draw}


def _draw() -> Picture:
    picture, (loops, points, secant) = canvas(3, height=3.6)
    for loop, colour in zip(reversed(record(spring())[2:]), reversed(BLUES), strict=True):
        loops.plot(MM * loop.deflection, loop.force / 1e3, color=colour, lw=1.3)
    for (name, point), colour in zip(POINTS.items(), COLOURS, strict=False):
        loop = wr.cyclic_test(spring(), [SHOWN], operating_point=point)[0]
        points.plot(MM * loop.deflection, loop.force / 1e3, color=colour, lw=1.4, label=name)
    for line in secant.lines[:2]:
        line.remove()
    for name, colour in zip(NAMES, COLOURS, strict=True):
        secant.plot(
            MM * np.array(FINE), [one.secant_stiffness / 1e3 for one in secants(name)], color=colour, lw=1.3, label=name
        )
    secant.set_xscale("log")
    inscribe(loops, f"one spring, ±{MM * AMPLITUDES[2]:g} to {MM * AMPLITUDES[-1]:g} mm", "deflection [mm]", "force [kN]")
    inscribe(points, f"±{MM * SHOWN:g} mm, three operating points", "deflection [mm]", "force [kN]")
    inscribe(secant, "five springs", "amplitude [mm]", "secant stiffness [kN/m]")
    explain(points)
    explain(secant, place="upper right")
    return picture
