"""Figures 3.8 and 3.9: soft-hardening and hardening overlap, which Ni's laws have and the Bouc-Wen law has not.

Why no Bouc-Wen loop softens first and hardens then, for n > 0 and any beta, gamma: with s = z0^n / alpha for the peak force
z0 of the loop of amplitude A, integrating dx = dz / slope over both branches gives

    A / z0 = 1 / K = (1 / 2 alpha) integral_0^1 [1 / (1 - (gamma + beta) s t^n) + 1 / (1 - (gamma - beta) s t^n)] dt,

which is a convex function of s, and s grows with A. So 1/K has no inner maximum, and the secant stiffness K no minimum.
"""

from collections.abc import Mapping, Sequence
from functools import partial
from typing import Any

import numpy as np
import numpy.typing as npt
from matplotlib.figure import Figure as Picture

import wirerope_mj as wr
from figures import modified
from figures.drawing import BLUES, COLOURS, GUIDE, canvas, explain, inscribe, note, show_direction
from figures.figure import Figure, written
from wirerope_mj.mounts.test_rig import hardening_overlap, softening_to_hardening

SYMMETRIC = wr.SymmetricBoucWen(alpha=2e5, beta=1200.0, gamma=300.0, n=1.0, k1=5e4, k2=0.0, k3=4e9)
"""Our own isolator in shear or roll."""
LOOPS = (0.5e-3, 1.5e-3, 2.5e-3, 4e-3)  # [m]
SECANTS = np.linspace(0.05e-3, 5e-3, 67)  # [m]
OVERLAP = (1e-3, 2e-3, 3e-3, 4e-3)  # [m]
HARDENING_STIFFNESS = 1e5  # [N/m] of figure 3.9; with n = 1 it scales the force and does not touch the overlap
MM = 1e3

# beta and gamma [1/mm] of the five types, and a sixth that hardens first and softens then.
PLAIN = ((0.8, 0.2), (0.2, 0.8), (0.5, 0.5), (0.8, -1.0), (0.5, -0.5), (0.5, -0.2))


def plain(beta: float, gamma: float) -> wr.BoucWen:
    """Return the Bouc-Wen law with beta and gamma in 1/mm, as stiff at first as the symmetric isolator."""
    return wr.BoucWen(alpha=SYMMETRIC.initial_stiffness, beta=1e3 * beta, gamma=1e3 * gamma, n=1.0)


def figures() -> list[Figure]:
    """Return figures 3.8 and 3.9."""
    return [_soft_hardening(), _overlap()]


# ---------------------------------------------------------------------------------------------------------- figure 3.8


def measure_secants() -> dict[str, float]:
    """Return where the secant stiffness of the symmetric law is least, and how many plain laws have such an amplitude."""
    transition = softening_to_hardening(wr.cyclic_test(SYMMETRIC, SECANTS))
    smallest, largest = wr.cyclic_test(SYMMETRIC, [SECANTS[0], SECANTS[-1]])
    plain_ones = [softening_to_hardening(wr.cyclic_test(plain(*pair), SECANTS)).exists for pair in PLAIN]
    return {
        "least_amplitude": transition.amplitude,
        "least_stiffness": transition.stiffness,
        "first_stiffness": smallest.secant_stiffness,
        "last_stiffness": largest.secant_stiffness,
        "plain_found": float(sum(plain_ones)),
    }


def _soft_hardening() -> Figure:
    n = measure_secants()
    return Figure(
        number="3.8",
        title="Soft-hardening",
        section="3.2.1",
        statement="Wire-rope isolators soften at small amplitudes, pass through a nearly linear range and harden at large "
        "ones. The Bouc-Wen law cannot do this: for z > 0 its slope cannot first decrease and then increase. Ni's "
        "modified laws are proposed for it (3.2.3, 3.4).",
        shown=f"The secant stiffness of Ni's symmetric law falls from {n['first_stiffness'] / 1e3:.0f} kN/m at "
        f"{MM * SECANTS[0]:g} mm to {n['least_stiffness'] / 1e3:.1f} kN/m at {MM * n['least_amplitude']:.2f} mm and rises "
        f"to {n['last_stiffness'] / 1e3:.0f} kN/m at {MM * SECANTS[-1]:g} mm. {n['plain_found']:.0f} of the "
        f"{len(PLAIN)} Bouc-Wen laws beside it have such a minimum; the one with γ = −0.2 1/mm hardens first and softens "
        "then. None can have it: 1/K is a convex function of the n-th power of the peak force, so K may have a maximum "
        "but no minimum.",
        parameters="Our own: α = 200 kN/m, β = 1200 1/m, γ = 300 1/m, n = 1, k₁ = 50 kN/m, k₂ = 0, k₃ = 4 GN/m³, those of a "
        "small isolator in shear or roll. The Bouc-Wen laws have n = 1 and begin as stiff as it.",
        numbers=n,
        draw=partial(_draw_soft_hardening, n),
    )


def _draw_soft_hardening(n: Mapping[str, float]) -> Picture:
    picture, (loops, secants) = canvas(2, height=4.2)
    for one, colour in zip(wr.cyclic_test(SYMMETRIC, LOOPS), BLUES, strict=True):
        loops.plot(MM * one.deflection, one.force, color=colour, lw=1.6, label=f"±{MM * one.amplitude:g} mm")
    show_direction(loops, MM * one.deflection, one.force, colour, at=(0.13, 0.65))
    x, tips = _tips(SYMMETRIC)
    loops.plot(MM * x, tips, "--", color=COLOURS[1], lw=1.4, label="tips of all loops")
    inscribe(loops, "Ni's symmetric law", "deflection x [mm]", "force F [N]")
    explain(loops)
    secants.plot(*_relative_secants(SYMMETRIC), color=BLUES[-1], lw=2.4, label="Ni, symmetric; Bouc-Wen:")
    least = n["least_stiffness"] / SYMMETRIC.initial_stiffness
    secants.plot(MM * n["least_amplitude"], least, "o", color=BLUES[-1], ms=6)
    note(secants, "minimum", (MM * n["least_amplitude"], least), xytext=(0, 7), textcoords="offset points", ha="center",
         va="bottom", colour=BLUES[-1])  # fmt: skip
    for place, (beta, gamma) in enumerate(PLAIN):
        colour, style = (COLOURS[place], "-") if place < len(COLOURS) else (GUIDE, "--")
        label = f"{written(beta)}, {written(gamma)}"
        secants.plot(*_relative_secants(plain(beta, gamma)), style, color=colour, lw=1.3, label=label)
    secants.set_ylim(0.0, 2.6)
    secants.set_xlim(left=0.0)
    inscribe(secants, "secant stiffness; Bouc-Wen by its β, γ [1/mm]", "amplitude [mm]", "K / K₀ [-]")
    handles, labels = secants.get_legend_handles_labels()
    picture.legend(handles, labels, loc="outside lower center", ncols=len(labels), fontsize=8.5, handlelength=1.4)
    return picture


def _tips(law: wr.SymmetricBoucWen) -> tuple[npt.NDArray[np.float64], npt.NDArray[np.float64]]:
    """Return the tips of the loops of all amplitudes, compression to tension: deflection [m] and force [N]."""
    force = np.array([one.force.max() for one in wr.cyclic_test(law, SECANTS)])
    return np.concatenate([-SECANTS[::-1], SECANTS]), np.concatenate([-force[::-1], force])


def _relative_secants(law: wr.BoucWen | wr.SymmetricBoucWen) -> tuple[npt.NDArray[np.float64], npt.NDArray[np.float64]]:
    """Return amplitudes [mm] and the secant stiffness over the law's initial stiffness."""
    secants = [one.secant_stiffness for one in wr.cyclic_test(law, SECANTS)]
    return MM * SECANTS, np.array(secants) / law.initial_stiffness


# ---------------------------------------------------------------------------------------------------------- figure 3.9


def overlap_loops() -> tuple[list[wr.Loop], list[wr.Loop]]:
    """Return the loops of Ni's asymmetric law and those of the hardening Bouc-Wen law of figure 3.4, at half the amplitudes."""
    hardening = wr.BoucWen(alpha=HARDENING_STIFFNESS, beta=800.0, gamma=-1000.0, n=1.0)
    # Fine enough for the straight lines between samples to be 1e-4 of the gaps between the paths.
    return (
        wr.cyclic_test(modified.LAW, OVERLAP, points_per_cycle=2000),
        wr.cyclic_test(hardening, np.array(OVERLAP) / 2.0, points_per_cycle=2000),
    )


def loading_gap(smaller: wr.Loop, larger: wr.Loop, x: float) -> float:
    """Return by how much the loading path of the larger loop lies above that of the smaller at x [m], in newtons."""
    one, other = (np.interp(x, *loop.branch(rising=True)) for loop in (larger, smaller))
    return float(one - other)


def measure_overlap() -> dict[str, float]:
    """Return the hardening overlap of both laws, and how the gap between loading paths grows along them."""
    ni, hardening = overlap_loops()
    saturating = wr.cyclic_test(plain(0.8, 0.2), np.array(OVERLAP))
    return {
        "overlap_ni": hardening_overlap(ni),
        "overlap_hardening": hardening_overlap(hardening),
        "overlap_saturating": hardening_overlap(saturating),
        "growth_ni": loading_gap(ni[0], ni[3], 1e-3) / loading_gap(ni[0], ni[3], 0.5e-3),
        "growth_hardening": loading_gap(hardening[1], hardening[3], 1e-3) / loading_gap(hardening[1], hardening[3], 0.5e-3),
    }


def _overlap() -> Figure:
    n = measure_overlap()
    return Figure(
        number="3.9",
        title="Hardening overlap",
        section="3.2.1",
        statement="In tension a wire-rope isolator loads along the same path whatever the amplitude. The Bouc-Wen law that "
        "hardens (figure 3.4) does not: its loop grows thicker with the amplitude.",
        shown="The overlap measure is the gap between the loading paths of smaller loops and that of the largest, over "
        f"the thickness of the largest: 0 if all load along one path. It is {n['overlap_ni']:.3f} for Ni's asymmetric law "
        f"and {n['overlap_hardening']:.3f} for the hardening Bouc-Wen law. Between 0.5 and 1 mm the gap between the paths of "
        f"two loops falls to {100 * n['growth_ni']:.0f} % of itself in Ni's law, whose z forgets its start over the yield "
        f"deflection 1/(β+γ) = {MM / 2500:g} mm; in the Bouc-Wen law with β + γ < 0 it grows to "
        f"{100 * n['growth_hardening']:.0f} %. A Bouc-Wen law that saturates (β = 0.8, γ = 0.2 1/mm) loads along one path "
        f"too ({n['overlap_saturating']:.3f}), but softens on it.",
        parameters="Ni's law with the parameters of figures 3.18 to 3.20, which are our own; Bouc-Wen with β = 0.8 1/mm, "
        "γ = −1 1/mm and n = 1 as in figure 3.4, and α = 100 kN/m, at half the amplitudes.",
        numbers=n,
        draw=partial(_draw_overlap, n),
    )


def _draw_overlap(n: Mapping[str, float]) -> Picture:
    picture, (left, right) = canvas(2, height=4.2)
    ni, hardening = overlap_loops()
    _draw_loading(left, ni)
    inscribe(left, f"Ni, asymmetric: overlap {n['overlap_ni']:.3f}", "deflection x [mm], tension positive", "force F [N]")
    _draw_loading(right, hardening)
    inscribe(right, f"Bouc-Wen, hardening: overlap {n['overlap_hardening']:.3f}", "deflection x [mm]", "force z [N]")
    return picture


def _draw_loading(panel: Any, loops: Sequence[wr.Loop]) -> None:
    """Draw loops thin, and thick where they are loaded in tension."""
    for one, colour in reversed(list(zip(loops, BLUES, strict=True))):
        panel.plot(MM * one.deflection, one.force, color=colour, lw=0.9)
        x, force = one.branch(rising=True)
        tension = x >= 0.0
        panel.plot(MM * x[tension], force[tension], color=colour, lw=2.6, label=f"±{MM * one.amplitude:g} mm")
    largest = loops[-1]
    show_direction(panel, MM * largest.deflection, largest.force, BLUES[-1], at=(0.15, 0.62))
    explain(panel, title="loading in tension thick")
