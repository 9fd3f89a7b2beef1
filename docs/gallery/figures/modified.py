"""Figures 3.18 to 3.20: the parts of Ni's asymmetric law under the deflection x = 4 sin t [mm]."""

from collections.abc import Mapping

import numpy as np
import numpy.typing as npt
from matplotlib.figure import Figure as Picture

import wirerope_mj as wr
from figures.drawing import COLOURS, GUIDE, canvas, explain, inscribe, note, show_direction
from figures.figure import Figure, written

LAW = wr.AsymmetricBoucWen(
    alpha=2e5, beta=2000.0, gamma=500.0, n=1.0, k1=1.1e5, k2=-1.5e7, k3=1.5e9, b=2.0, c=200.0
)  # fmt: skip
"""Our own isolator: 310 kN/m at first, a few hundred newtons at 4 mm, as wire-rope isolators for some tens of kilograms."""
WITHOUT_F2 = wr.SymmetricBoucWen(alpha=LAW.alpha, beta=LAW.beta, gamma=LAW.gamma, n=LAW.n, k1=LAW.k1, k2=LAW.k2, k3=LAW.k3)
AMPLITUDE = 0.004  # [m]
MM = 1e3
MOVING = (0.486, 0.9)  # shares of `motion` at which arrows stand: on the way down, and on the way up again

PARAMETERS = (
    "The values of the thesis' table 3.4 are not legible in our source, and its unit of x is lost. Ours are those of a small "
    "isolator in SI units: α = 200 kN/m, β = 2000 1/m, γ = 500 1/m, n = 1, k₁ = 110 kN/m, k₂ = −15 MN/m², k₃ = 1.5 GN/m³, "
    "b = 2, c = 200 1/m, and x = 4 sin t is in mm, tension positive."
)

SAME = "As figure 3.18."


def figures() -> list[Figure]:
    """Return figures 3.18, 3.19 and 3.20."""
    numbers = measure()
    return [_parts(numbers), _modulation(numbers), _force(numbers)]


def motion() -> tuple[npt.NDArray[np.float64], npt.NDArray[np.float64]]:
    """Return t [s] and x = 4 sin t [mm, here in m]: one cycle and a quarter from the unloaded state."""
    time = np.linspace(0.0, 2.5 * np.pi, 1501)
    return time, AMPLITUDE * np.sin(time)


def elastic(law: wr.SymmetricBoucWen, x: npt.NDArray[np.float64]) -> npt.NDArray[np.float64]:
    """Return F1 [N]: what is left of the law without F2 when z is taken away."""
    loop = law.trace(x)
    return loop.force - loop.hysteretic_state


def factor(law: wr.AsymmetricBoucWen, x: npt.ArrayLike) -> npt.NDArray[np.float64]:
    """Return F2 = b^(c x) [-]."""
    return law.b ** (law.c * np.asarray(x))


def measure() -> dict[str, float]:
    """Return z, F1 and F2 at the extremes of the motion, and what F2 does to tips, tangents and area of the loop."""
    _, x = motion()
    path = LAW.trace(x)
    top, bottom = int(np.argmax(x)), int(np.argmin(x))
    f1, f2 = elastic(WITHOUT_F2, x), factor(LAW, x)
    whole, plain = (wr.cyclic_test(law, AMPLITUDE)[0] for law in (LAW, WITHOUT_F2))
    return {
        "bound": LAW.z_max,
        "z_share": float(path.hysteretic_state[top] / LAW.z_max),
        "z_largest": float(np.abs(path.hysteretic_state).max()),
        "f1_tension": float(f1[top]),
        "f1_compression": float(f1[bottom]),
        "f2_zero": float(factor(LAW, 0.0)),
        "f2_tension": float(f2[top]),
        "f2_compression": float(f2[bottom]),
        "product_error": float(np.abs(f2 * (path.hysteretic_state + f1) - path.force).max()),
        "tip_tension": float(whole.force.max()),
        "tip_compression": float(whole.force.min()),
        "tip_plain": float(plain.force.max()),
        **{f"tangent_{at:g}": loading_tangent(at / MM) for at in (-4, -2, 2, 4)},
        "area": whole.dissipated_energy,
        "area_plain": plain.dissipated_energy,
    }


def loading_tangent(x: float) -> float:
    """Return dF/dx [N/m] on first loading, from the unloaded state towards x [m] and at it."""
    step = 1e-6 * x
    force = LAW.trace([0.0, x - step, x + step]).force
    return float((force[2] - force[1]) / (2.0 * step))


def _parts(n: Mapping[str, float]) -> Figure:
    return Figure(
        number="3.18",
        title="Hysteretic force z and elastic force F₁ of the modified law",
        section="3.4.1",
        statement="z has a finite ultimate value z_max = (α/(β+γ))^(1/n) (3.19). F₁ is a nonlinear elastic spring, odd in "
        "x: positive in tension, negative in compression.",
        shown=f"z never exceeds z_max = {n['bound']:.0f} N and reaches {100 * n['z_share']:.3f} % of it at 4 mm; F₁ is "
        f"{n['f1_tension']:.1f} N at 4 mm and {written(n['f1_compression'], '.1f')} N at −4 mm.",
        parameters=PARAMETERS,
        numbers=n,
        draw=_draw_parts,
    )


def _draw_parts() -> Picture:
    picture, (over_x, over_t) = canvas(2)
    time, x = motion()
    z, f1 = LAW.trace(x).hysteretic_state, elastic(WITHOUT_F2, x)
    over_x.plot(MM * x, f1, color=COLOURS[1], lw=1.6, label="F₁")
    over_x.plot(MM * x, z, color=COLOURS[0], lw=1.6, label="z")
    show_direction(over_x, MM * x, z, COLOURS[0], at=MOVING)
    over_t.plot(time, f1, color=COLOURS[1], lw=1.6, label="F₁")
    over_t.plot(time, z, color=COLOURS[0], lw=1.6, label="z")
    for panel in (over_x, over_t):
        for side in (-1.0, 1.0):
            label = r"$\pm z_{max}$" if side > 0.0 else None
            panel.axhline(side * LAW.z_max, color=GUIDE, ls=":", lw=1.3, label=label)
    inscribe(over_x, "over deflection", "deflection x [mm], tension positive", "z, F₁ [N]")
    inscribe(over_t, "over time, x = 4 sin t mm", "time t [s]", "z, F₁ [N]")
    explain(over_x)
    over_t.set_ylim(top=1.35 * over_t.get_ylim()[1])
    explain(over_t, place="upper center", columns=3)
    return picture


def _modulation(n: Mapping[str, float]) -> Figure:
    return Figure(
        number="3.19",
        title="Factor F₂ of the modified law",
        section="3.4.1",
        statement="F₂ = b^(cx) is an asymmetric factor without dimension: it multiplies z + F₁ (3.15), (3.17).",
        shown=f"F₂ is {n['f2_zero']:.0f} at x = 0, {n['f2_tension']:.3f} at 4 mm in tension and {n['f2_compression']:.3f} at "
        f"4 mm in compression, one the inverse of the other. Only c ln b = {LAW.asymmetry:.0f} 1/m acts: of the nine "
        "parameters of the law, eight can be identified.",
        parameters=SAME,
        numbers=n,
        draw=_draw_modulation,
    )


def _draw_modulation() -> Picture:
    picture, (over_x, over_t) = canvas(2, height=3.2)
    time, x = motion()
    span = np.linspace(-AMPLITUDE, AMPLITUDE, 201)
    over_x.plot(MM * span, factor(LAW, span), color=COLOURS[2], lw=1.8)
    for place, shift in ((-AMPLITUDE, (0, -11)), (0.0, (8, -9)), (AMPLITUDE, (-6, 9))):
        value = float(factor(LAW, place))
        over_x.plot(MM * place, value, "o", color=COLOURS[2], ms=5)
        beside = {"ha": "right" if shift[0] < 0 else "left", "va": "center", "textcoords": "offset points"}
        note(over_x, f"{value:.3g}", (MM * place, value), xytext=shift, **beside)
    over_t.plot(time, factor(LAW, x), color=COLOURS[2], lw=1.8)
    for panel in (over_x, over_t):
        panel.axhline(1.0, color=GUIDE, ls=":", lw=1.3)
        panel.set_ylim(0.0, 2.0)
    inscribe(over_x, "over deflection", "deflection x [mm], tension positive", "F₂ [-]")
    inscribe(over_t, "over time, x = 4 sin t mm", "time t [s]", "F₂ [-]")
    return picture


def _force(n: Mapping[str, float]) -> Figure:
    ratio = n["tip_tension"] / -n["tip_compression"]
    return Figure(
        number="3.20",
        title="What F₂ does to the loop",
        section="3.4.1",
        statement="Multiplying z + F₁ by F₂ makes the loop asymmetric: the isolator hardens in tension and softens in "
        "compression.",
        shown=f"z + F₁ ends at ±{n['tip_plain']:.1f} N, F = F₂ (z + F₁) at {n['tip_tension']:.1f} N in tension and "
        f"{written(n['tip_compression'], '.1f')} N in compression, {ratio:.2f} times less: that is F₂(4 mm)/F₂(−4 mm). On "
        f"first loading the tangent grows from {n['tangent_2'] / 1e3:.0f} to {n['tangent_4'] / 1e3:.0f} kN/m between 2 and "
        f"4 mm of tension and falls from {n['tangent_-2'] / 1e3:.0f} to {n['tangent_-4'] / 1e3:.0f} kN/m between 2 and 4 mm of "
        f"compression. The area changes from {n['area_plain']:.3f} to {n['area']:.3f} J, since F₂ widens the loop in "
        "tension by more than it narrows it in compression.",
        parameters=SAME,
        numbers=n,
        draw=_draw_force,
    )


def _draw_force() -> Picture:
    picture, (loops, loading) = canvas(2, height=3.9)
    _, x = motion()
    for law, colour, style, label in (
        (WITHOUT_F2, COLOURS[0], "--", "z + F₁"),
        (LAW, COLOURS[1], "-", "F = F₂ (z + F₁)"),
    ):
        path = law.trace(x)
        loops.plot(MM * path.deflection, path.force, style, color=colour, lw=1.6, label=label)
        side = law.trace(np.linspace(-AMPLITUDE, 0.0, 200)[::-1]), law.trace(np.linspace(0.0, AMPLITUDE, 200))
        for part in side:
            slope = np.gradient(part.force, part.deflection)
            loading.plot(MM * part.deflection, slope / 1e3, style, color=colour, lw=1.6)
    show_direction(loops, MM * path.deflection, path.force, COLOURS[1], at=MOVING)
    inscribe(loops, "loops, from the unloaded state", "deflection x [mm], tension positive", "force [N]")
    explain(loops)
    loading.set_ylim(bottom=0.0)
    inscribe(loading, "tangent on first loading", "deflection x [mm], tension positive", "dF/dx [kN/m]")
    return picture
