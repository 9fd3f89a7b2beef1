"""Figures 3.6, 3.7 and 3.10: what each parameter of the Bouc-Wen law does to the loop."""

from collections.abc import Mapping, Sequence
from functools import partial
from typing import Any

import numpy as np
from matplotlib.figure import Figure as Picture

import wirerope_mj as wr
from figures.drawing import COLOURS, INK, canvas, explain, inscribe, note, show_direction
from figures.figure import Figure, written
from figures.slopes import slope_at_zero, slopes_over_force

PAIR = ((0.8, 0.2), (0.5, 0.5))  # (beta, gamma) [1/m] of figure 3.6
PAIR_AMPLITUDES = np.geomspace(0.05, 4.0, 45)  # [m]; where the tests of a real isolator would lie is not known
BETAS = (0.2, 0.5, 0.8, 1.1)  # [1/m], at gamma = 0.2 1/m
GAMMAS = (-1.0, -0.4, 0.2, 0.8)  # [1/m], at beta = 0.8 1/m
ALPHAS = (0.5, 1.0, 2.0)  # [N/m], at n = 1
EXPONENTS = (0.5, 1.0, 2.0, 10.0)  # at alpha = 1 N/m
STEEPEST = 100.0  # the exponent that stands for "n grows without bound" in the caption of 3.10
AMPLITUDE = 2.0  # [m]

UNIT = "α = 1 N/m and n = 1 as in the thesis"


def figures() -> list[Figure]:
    """Return figures 3.6, 3.7 and 3.10."""
    return [_redundant_pair(), _beta_and_gamma(), _alpha_and_n()]


def loop(*, beta: float, gamma: float, alpha: float = 1.0, n: float = 1.0, amplitude: float = AMPLITUDE) -> wr.Loop:
    """Return the closed loop of one set of parameters."""
    return wr.cyclic_test(wr.BoucWen(alpha=alpha, beta=beta, gamma=gamma, n=n), amplitude)[0]


# ---------------------------------------------------------------------------------------------------------- figure 3.6


def pair_differences() -> tuple[np.ndarray, np.ndarray]:
    """Return by how much the first of the pair exceeds the second in peak force and in loop area, at PAIR_AMPLITUDES."""
    one, other = (wr.cyclic_test(wr.BoucWen(alpha=1.0, beta=b, gamma=g, n=1.0), PAIR_AMPLITUDES) for b, g in PAIR)
    force = [a.force.max() / b.force.max() - 1.0 for a, b in zip(one, other, strict=True)]
    area = [a.dissipated_energy / b.dissipated_energy - 1.0 for a, b in zip(one, other, strict=True)]
    return np.array(force), np.array(area)


def measure_pair() -> dict[str, float]:
    """Return peak forces [N] and areas [J] of the pair at 1 and 2 m, and their relative differences."""
    numbers = {}
    for size in (1, 2):
        one, other = (loop(beta=b, gamma=g, amplitude=size) for b, g in PAIR)
        numbers[f"force_{size}"] = float(one.force.max() / other.force.max()) - 1.0
        numbers[f"area_{size}"] = one.dissipated_energy / other.dissipated_energy - 1.0
        numbers[f"along_{size}"] = float(np.abs(one.force - other.force).max() / one.force.max())
    path = np.linspace(0.0, AMPLITUDE, 401)
    first, second = (wr.BoucWen(alpha=1.0, beta=b, gamma=g, n=1.0).trace(path).force for b, g in PAIR)
    force, area = pair_differences()
    worst = int(np.argmax(force))
    return numbers | {
        "first_loading": float(np.abs(first - second).max()),
        "worst_force": float(force[worst]),
        "worst_amplitude": float(PAIR_AMPLITUDES[worst]),
        "small_area": float(area[0]),
    }


def _redundant_pair() -> Figure:
    n = measure_pair()
    return Figure(
        number="3.6",
        title="Two sets of β and γ with the same sum",
        section="3.2.1",
        statement="β + γ alone shapes the loading branch, so sets with the same sum give almost the same loop; a larger "
        "β shows only in the larger change of slope at the reversal. One of the two is redundant for identification.",
        shown=f"First loading is the same. At 1 m the peak forces differ by {100 * n['force_1']:.1f} %, but the areas by "
        f"{100 * n['area_1']:.0f} %; at 2 m by {100 * n['force_2']:.1f} % and {100 * n['area_2']:.0f} %. The peak forces "
        f"never differ by more than {100 * n['worst_force']:.1f} % (at {n['worst_amplitude']:.2f} m), the areas by up to "
        f"{100 * n['small_area']:.0f} % towards small amplitudes, where they tend to 4βαA³/3. For identification this "
        "means: the skeleton, that is the peak force over the amplitude, gives β + γ and next to nothing of β; β is "
        "identifiable from the loop's area. Along the loop of 1 m the two forces are apart by up to "
        f"{100 * n['along_1']:.0f} % of the peak, most where the force passes through zero: a fit to whole loops sees β "
        "there, and one to their tips gets the damping by chance.",
        parameters=f"{UNIT}; β = 0.8 and γ = 0.2, β = 0.5 and γ = 0.5 [1/m] as in the thesis. The amplitudes are our own.",
        numbers=n,
        draw=_draw_pair,
    )


def _draw_pair() -> Picture:
    picture, (loops, differences) = canvas(2)
    differences.lines[1].remove()  # a logarithmic axis has no zero
    for (b, g), colour, style in zip(PAIR, COLOURS, ("-", "--"), strict=False):
        for size in (1.0, AMPLITUDE):
            one = loop(beta=b, gamma=g, amplitude=size)
            label = f"β = {b:g}, γ = {g:g} [1/m]" if size == AMPLITUDE else None
            loops.plot(one.deflection, one.force, style, color=colour, lw=1.6, label=label)
        show_direction(loops, one.deflection, one.force, colour, at=(0.08, 0.58) if style == "-" else ())
    inscribe(loops, "loops of ±1 m and ±2 m", "deflection x [m]", "hysteretic force z [N]")
    loops.set_ylim(top=1.35)  # room for the legend above the largest loop
    explain(loops)
    force, area = pair_differences()
    differences.plot(PAIR_AMPLITUDES, 100.0 * area, color=COLOURS[3], lw=1.6, label="loop area")
    differences.plot(PAIR_AMPLITUDES, 100.0 * force, color=COLOURS[2], lw=1.6, label="peak force")
    for size in (1.0, AMPLITUDE):
        differences.axvline(size, color="0.6", ls=":", lw=1.2)
    differences.set_xscale("log")
    differences.set_ylim(0.0, 65.0)
    differences.set_xticks([0.05, 0.1, 0.2, 0.5, 1, 2, 4], ["0.05", "0.1", "0.2", "0.5", "1", "2", "4"])
    differences.minorticks_off()
    inscribe(differences, "(0.8, 0.2) above (0.5, 0.5)", "amplitude [m]", "difference [%]")
    explain(differences, place="center left")
    return picture


# ---------------------------------------------------------------------------------------------------------- figure 3.7


def measure_trends() -> dict[str, float]:
    """Return peak force [N], area [J], damping ratio and slope jump [N/m] for every beta and every gamma of figure 3.7."""
    numbers = {}
    for name, cases in (("beta", [(b, 0.2) for b in BETAS]), ("gamma", [(0.8, g) for g in GAMMAS])):
        for place, (b, g) in enumerate(cases):
            one = loop(beta=b, gamma=g)
            numbers[f"{name}_{place}_force"] = float(one.force.max())
            numbers[f"{name}_{place}_area"] = one.dissipated_energy
            numbers[f"{name}_{place}_damping"] = one.damping_ratio
            numbers[f"{name}_{place}_jump"] = one.slope_jumps_at_reversal.after_largest
    return numbers


def _series(numbers: Mapping[str, float], name: str, quantity: str, form: str) -> str:
    """Return the values of one quantity over a parameter's values."""
    return _listed([numbers[f"{name}_{place}_{quantity}"] for place in range(4)], form)


def _listed(values: Sequence[float], form: str) -> str:
    """Return numbers as a list in words."""
    texts = [format(value, form) for value in values]
    return ", ".join(texts[:-1]) + " and " + texts[-1]


def _beta_and_gamma() -> Figure:
    n = measure_trends()
    return Figure(
        number="3.7",
        title="The influence of β (a) and γ (b)",
        section="3.2.1",
        statement="Each of β and γ alone changes the loop in one direction, also where the law passes from hardening to "
        "softening on the way.",
        shown=f"(a) As β grows, the peak force falls ({_series(n, 'beta', 'force', '.3f')} N) and the equivalent damping "
        f"ratio rises ({_series(n, 'beta', 'damping', '.3f')}). The area itself does not rise throughout "
        f"({_series(n, 'beta', 'area', '.2f')} J): the force that bounds it falls. (b) As γ grows, the law passes from "
        f"hardening to softening and the peak force falls ({_series(n, 'gamma', 'force', '.3f')} N). The area falls too "
        f"({_series(n, 'gamma', 'area', '.2f')} J), yet the damping ratio rises "
        f"({_series(n, 'gamma', 'damping', '.3f')}), because the stiffness falls faster.",
        parameters=f"{UNIT}; γ = 0.2 1/m in (a) and β = 0.8 1/m in (b) as in the thesis. The values that vary, and the "
        "amplitude of 2 m, are our own.",
        numbers=n,
        draw=_draw_beta_and_gamma,
    )


def _draw_beta_and_gamma() -> Picture:
    picture, (left, right) = canvas(2)
    _draw_loops(left, [(f"β = {b:g} 1/m", loop(beta=b, gamma=0.2)) for b in BETAS])
    inscribe(left, "(a) γ = 0.2 1/m", "deflection x [m]", "hysteretic force z [N]")
    _draw_loops(right, [(f"γ = {written(g)} 1/m", loop(beta=0.8, gamma=g)) for g in GAMMAS])
    inscribe(right, "(b) β = 0.8 1/m", "deflection x [m]", "hysteretic force z [N]")
    return picture


def _draw_loops(panel: Any, named: Sequence[tuple[str, wr.Loop]]) -> None:
    """Draw loops of different parameters into one panel."""
    for (label, one), colour in zip(named, COLOURS, strict=False):
        panel.plot(one.deflection, one.force, color=colour, lw=1.6, label=label)
    show_direction(panel, one.deflection, one.force, colour, at=(0.06, 0.56))
    explain(panel)


# --------------------------------------------------------------------------------------------------------- figure 3.10


def transition_width(n: float) -> float:
    """Return over how many yield deflections x_y = z_max / alpha first loading falls from 90 % to 10 % of its slope."""
    law = wr.BoucWen(alpha=1.0, beta=0.5, gamma=-0.4, n=n)
    path = np.linspace(0.0, 4.0 * law.z_max, 20001)  # the slowest, n = 0.5, is through after 3 x_y
    slope = np.diff(law.trace(path).force) / np.diff(path)
    begin, end = np.interp([-0.9, -0.1], -slope, (path[1:] + path[:-1]) / 2.0)
    return float((end - begin) / law.z_max)


def measure_alpha_and_n() -> dict[str, float]:
    """Return slopes at zero force [N/m], forces [N] and areas [J] over alpha, and sharpness over n."""
    numbers = {}
    for alpha in ALPHAS:
        one = loop(alpha=alpha, beta=0.5, gamma=-0.4)
        law = wr.BoucWen(alpha=alpha, beta=0.5, gamma=-0.4, n=1.0)
        numbers[f"slope_{alpha:g}"] = slope_at_zero(law, one, rising=True)
        numbers[f"force_{alpha:g}"] = float(one.force.max())
        numbers[f"area_{alpha:g}"] = one.dissipated_energy
    for n in (*EXPONENTS, STEEPEST):
        numbers[f"bound_{n:g}"] = wr.BoucWen(alpha=1.0, beta=0.5, gamma=-0.4, n=n).z_max
        numbers[f"width_{n:g}"] = transition_width(n)
        one = loop(n=n, beta=0.5, gamma=-0.4)
        numbers[f"n_area_{n:g}"] = one.dissipated_energy
        numbers[f"unloading_{n:g}"] = one.tangents_at_reversal.after_largest
    # Elastic up to z_max and plastic beyond: a parallelogram of height 2 z_max and length 2 (A - x_y), here x_y = z_max.
    bound = numbers[f"bound_{STEEPEST:g}"]
    return numbers | {"ideal_area": 4.0 * bound * (AMPLITUDE - bound)}


def _alpha_and_n() -> Figure:
    n = measure_alpha_and_n()
    widths = _listed([n[f"width_{value:g}"] for value in EXPONENTS], ".2f")
    return Figure(
        number="3.10",
        title="The influence of α (a, b) and n (c, d)",
        section="3.2.2",
        statement="α is the slope of the loop at zero force, and sets its height and thickness. n sets how sharply the "
        "linear range passes into yielding: the larger, the more elasto-plastic, and truly so in the limit.",
        shown=f"(b) The slopes at zero force are {n['slope_0.5']:.3f}, {n['slope_1']:.3f} and {n['slope_2']:.3f} N/m. With "
        f"n = 1, α scales the whole loop: peak forces {n['force_0.5']:.3f}, {n['force_1']:.3f} and {n['force_2']:.3f} N, "
        f"areas {n['area_0.5']:.3f}, {n['area_1']:.3f} and {n['area_2']:.3f} J. (d) The slope of first loading falls from "
        f"90 % to 10 % of α within {widths} yield deflections x_y for n = 0.5, 1, 2 and 10. At n = {STEEPEST:g} the area is "
        f"{n[f'n_area_{STEEPEST:g}']:.2f} J, that of the elasto-plastic parallelogram {n['ideal_area']:.2f} J. The bound "
        f"z_max = (α/(β+γ))^(1/n) is {n['bound_1']:.3g}, {n['bound_2']:.3g}, {n['bound_10']:.3g} and "
        f"{n[f'bound_{STEEPEST:g}']:.3g} N for n = 1, 2, 10 and {STEEPEST:g}. The thesis puts its limit at one: that is 1 in "
        "the unit of z, one newton here and one kilonewton in kN, so n must not be varied without looking at the units. "
        "The steep start of unloading at n = 2 and 10 belongs to this β and γ: at the bound its slope is "
        f"2αβ/(β+γ) = 10 α, and it is {n['unloading_10']:.2f} N/m at n = 10.",
        parameters="β = 0.5 and γ = −0.4 as in the thesis, n = 1 in (a, b) and α = 1 N/m in (c, d). The values that vary, "
        "and the amplitude of 2 m, are our own.",
        numbers=n,
        draw=partial(_draw_alpha_and_n, n),
    )


def _draw_alpha_and_n(numbers: Mapping[str, float]) -> Picture:
    picture, (loops, slopes, sharp, loading) = canvas(2, rows=2, height=3.5)
    _draw_loops(loops, [(f"α = {a:g} N/m", loop(alpha=a, beta=0.5, gamma=-0.4)) for a in ALPHAS])
    inscribe(loops, "(a) loops, n = 1", "deflection x [m]", "hysteretic force z [N]")
    for alpha, colour in zip(ALPHAS, COLOURS, strict=False):
        z, slope = slopes_over_force(loop(alpha=alpha, beta=0.5, gamma=-0.4), rising=True)
        slopes.plot(z, slope, color=colour, lw=1.6)
        slopes.plot(0.0, numbers[f"slope_{alpha:g}"], "o", color=colour, ms=5)
    slopes.set_ylim(bottom=0.0)
    note(slopes, "dots: dz/dx = α at z = 0", (0.96, 0.94), xycoords="axes fraction", ha="right", va="top")
    inscribe(slopes, "(b) tangent while x increases, n = 1", "hysteretic force z [N]", "dz/dx [N/m]")
    _draw_loops(sharp, [(f"n = {n:g}", loop(n=n, beta=0.5, gamma=-0.4)) for n in EXPONENTS])
    inscribe(sharp, "(c) loops, α = 1 N/m", "deflection x [m]", "hysteretic force z [N]")
    for n, colour in zip(EXPONENTS, COLOURS, strict=False):
        law = wr.BoucWen(alpha=1.0, beta=0.5, gamma=-0.4, n=n)
        path = np.linspace(0.0, 3.0 * law.z_max, 400)
        loading.plot(path / law.z_max, law.trace(path).force / law.z_max, color=colour, lw=1.6, label=f"n = {n:g}")
    loading.plot([0.0, 1.0, 3.0], [0.0, 1.0, 1.0], ":", color=INK, lw=1.4, label="elasto-plastic")
    inscribe(loading, "(d) first loading, each in its own units", "x / x_y, x_y = z_max/α", "z / z_max")
    explain(loading, place="lower right")
    return picture
