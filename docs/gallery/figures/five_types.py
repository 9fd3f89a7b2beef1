"""Figures 3.1 to 3.5: the five types of loop that the signs of beta + gamma and beta - gamma tell apart."""

from collections.abc import Mapping
from dataclasses import dataclass
from functools import partial
from typing import Any

import numpy as np
from matplotlib.figure import Figure as Picture

import wirerope_mj as wr
from figures.drawing import BLUES, COLOURS, GUIDE, canvas, explain, inscribe, note, show_direction
from figures.figure import Figure, written
from figures.slopes import slope_at_zero, slopes_over_force

AMPLITUDES = (0.5, 1.0, 1.5, 2.0)  # [m]
POINTS = 2000  # in a cycle: neighbouring samples at a reversal are then 5e-6 of the amplitude apart


@dataclass(frozen=True, kw_only=True)
class LoopType:
    """One of the five types: its figure, its example and what it does."""

    number: str
    beta: float
    gamma: float
    condition: str
    behaviour: str
    reads: str
    origin: str = "are our own example of this type"

    @property
    def law(self) -> wr.BoucWen:
        """The example with alpha = n = 1."""
        return wr.BoucWen(alpha=1.0, beta=self.beta, gamma=self.gamma, n=1.0)


TYPES = (
    LoopType(
        number="3.1",
        beta=0.8,
        gamma=0.2,
        condition="β + γ > 0 and β − γ > 0",
        behaviour="softening, unloading steeper than α",
        reads="Loading softens: just before the reversal at {amplitude:g} m the tangent has fallen to {loading:.3f} N/m. "
        "Unloading begins at {unloading:.3f} N/m, above α = 1 N/m.",
        origin="as in its figure 3.6",
    ),
    LoopType(
        number="3.2",
        beta=0.2,
        gamma=0.8,
        condition="β + γ > 0 and β − γ < 0",
        behaviour="softening, unloading flatter than α",
        reads="Loading softens to {loading:.3f} N/m, and unloading begins at {unloading:.3f} N/m, below α = 1 N/m: the "
        "loop is slender, and steepest where the force passes through zero. "
        "The signs alone would admit β < 0 here; such a loop would generate energy, and the library refuses it.",
    ),
    LoopType(
        number="3.3",
        beta=0.5,
        gamma=0.5,
        condition="β + γ > 0 and β − γ = 0",
        behaviour="softening, unloading at the slope α",
        reads="Loading softens to {loading:.3f} N/m. Unloading runs straight to zero force at {unloading:.3f} N/m, which is α.",
        origin="as in its figure 3.6",
    ),
    LoopType(
        number="3.4",
        beta=0.8,
        gamma=-1.0,
        condition="β + γ < 0 and β − γ > 0",
        behaviour="hardening, the force has no bound",
        reads="Loading hardens to {loading:.3f} N/m, and unloading begins at {unloading:.3f} N/m. The force has no "
        "bound, and the loop grows thicker with the amplitude.",
    ),
    LoopType(
        number="3.5",
        beta=0.5,
        gamma=-0.5,
        condition="β + γ = 0 and β − γ > 0",
        behaviour="quasi-linear loading",
        reads="Loading from zero force is straight: its tangent is still {loading:.3f} N/m at {amplitude:g} m, which is "
        "α. Unloading begins at {unloading:.3f} N/m.",
    ),
)

FIRST = (
    "The slope of the loop at zero force is α, and it jumps by 2β|z|ⁿ wherever the motion turns round (table 3.2). The "
    "signs of β + γ and β − γ leave five types of loop with a physical meaning. The first: {condition}, {behaviour}."
)
FURTHER = "Another of the five types of loop: {condition}, {behaviour}."


def figures() -> list[Figure]:
    """Return figures 3.1 to 3.5."""
    return [_figure(kind) for kind in TYPES]


def measure(kind: LoopType) -> dict[str, float]:
    """Return slopes [N/m] of the largest loop, and peak force [N] and area [J] of the loops of 1 and 2 m."""
    loops = wr.cyclic_test(kind.law, AMPLITUDES, points_per_cycle=POINTS)
    largest = loops[-1]
    unloading = largest.tangents_at_reversal.after_largest
    jump = largest.slope_jumps_at_reversal.after_largest
    return {
        "amplitude": largest.amplitude,
        "slope_at_zero_rising": slope_at_zero(kind.law, largest, rising=True),
        "slope_at_zero_falling": slope_at_zero(kind.law, largest, rising=False),
        "loading": unloading - jump,
        "unloading": unloading,
        "jump": jump,
        "peak_1": float(loops[1].force.max()),
        "area_1": loops[1].dissipated_energy,
        "damping_1": loops[1].damping_ratio,
        "peak_2": float(largest.force.max()),
        "area_2": largest.dissipated_energy,
        "damping_2": largest.damping_ratio,
    }


def _figure(kind: LoopType) -> Figure:
    numbers = measure(kind)
    sums = (
        f" The jump of {numbers['jump']:.3f} N/m at the reversal is 2β|z| with z = {numbers['peak_2']:.4f} N; at zero "
        f"force both branches have the slope {numbers['slope_at_zero_rising']:.3f} N/m. Peak force and area: "
        f"{numbers['peak_1']:.4f} N and {numbers['area_1']:.4f} J at 1 m, {numbers['peak_2']:.4f} N and "
        f"{numbers['area_2']:.4f} J at 2 m."
    )
    return Figure(
        number=kind.number,
        title=f"Loop for {kind.condition}",
        section="3.2.1",
        statement=(FIRST if kind is TYPES[0] else FURTHER).format(condition=kind.condition, behaviour=kind.behaviour),
        shown=kind.reads.format(**numbers) + sums,
        parameters=f"Bouc-Wen with α = 1 N/m and n = 1 as in the thesis; β = {written(kind.beta)} and "
        f"γ = {written(kind.gamma)} [1/m] {kind.origin}.",
        numbers=numbers,
        draw=partial(_draw, kind, numbers),
    )


def _draw(kind: LoopType, numbers: Mapping[str, float]) -> Picture:
    picture, (loops, slopes) = canvas(2)
    picture.suptitle(f"β = {written(kind.beta)}, γ = {written(kind.gamma)}: {kind.behaviour}", fontsize=11)
    for loop, colour in zip(wr.cyclic_test(kind.law, AMPLITUDES), BLUES, strict=True):
        loops.plot(loop.deflection, loop.force, color=colour, lw=1.6, label=f"±{loop.amplitude:g} m")
    show_direction(loops, loop.deflection, loop.force, colour, at=(0.08, 0.58))
    inscribe(loops, "loops", "deflection x [m]", "hysteretic force z [N]")
    explain(loops)
    _draw_slopes(slopes, kind, numbers)
    return picture


def _draw_slopes(panel: Any, kind: LoopType, numbers: Mapping[str, float]) -> None:
    """Draw the tangent over z for both branches of the largest loop."""
    largest = wr.cyclic_test(kind.law, numbers["amplitude"], points_per_cycle=POINTS)[0]
    peak, top = numbers["peak_2"], 0.0
    for rising, colour, name in ((True, COLOURS[0], "x increases"), (False, COLOURS[1], "x decreases")):
        z, slope = slopes_over_force(largest, rising=rising)
        panel.plot(z, slope, color=colour, lw=1.6, label=name)
        sign = 1.0 if rising else -1.0
        heads = np.searchsorted(sign * z, [-0.5 * peak, 0.6 * peak]) / z.size
        show_direction(panel, z, slope, colour, at=heads.tolist())
        top = max(top, float(slope.max()))
    panel.axhline(kind.law.alpha, color=GUIDE, ls=":", lw=1.2, label="α")
    for side in (-1.0, 1.0):
        panel.plot([side * peak] * 2, [numbers["loading"], numbers["unloading"]], "--", color=GUIDE, lw=1.2)
    middle = (numbers["loading"] + numbers["unloading"]) / 2.0
    jump = f"2β|z| = {numbers['jump']:.2f}"
    note(panel, jump, (peak, middle), xytext=(4, 0), textcoords="offset points", va="center", rotation=90)
    inscribe(panel, f"tangent over force, ±{numbers['amplitude']:g} m", "hysteretic force z [N]", "dz/dx [N/m]")
    panel.set_xlim(-1.25 * peak, 1.25 * peak)
    panel.set_ylim(0.0, 1.22 * top)
    explain(panel, columns=3, place="upper center")
