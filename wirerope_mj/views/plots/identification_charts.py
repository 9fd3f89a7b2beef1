"""Charts of a fit for its page: loops, residuals and measures over the amplitude, measured against fitted."""

import math
from collections.abc import Callable, Sequence

import numpy as np

from wirerope_mj.foundation.units import in_unit
from wirerope_mj.mounts.identification.records import millimetres
from wirerope_mj.mounts.identification.result import FittedLoop
from wirerope_mj.views.curves import Curve, Panel
from wirerope_mj.views.plots.svg_chart import Chart

MOST = 12
"""Loops of one chart: more cannot be read."""

_ACROSS = 3
_MEASURED, _FITTED = 0, 1  # numbers of their colours


def drawn_loops(fits: Sequence[FittedLoop]) -> list[FittedLoop]:
    """Return the loops that are drawn, twelve at most, from the smallest to the largest."""
    rows = np.unique(np.linspace(0, len(fits) - 1, min(len(fits), MOST)).round().astype(int))
    return [fits[row] for row in rows]


def fit_chart(fits: Sequence[FittedLoop]) -> Chart:
    """Return force over deflection of every loop, measured and fitted."""
    return _chart(
        fits,
        lambda fit: [
            Curve(x=in_unit(fit.deflection, "mm"), y=in_unit(fit.fitted, "kN"), name="fitted", kind=_FITTED),
            Curve(x=in_unit(fit.deflection, "mm"), y=in_unit(fit.measured, "kN"), name="measured", kind=_MEASURED),
        ],
        "force [kN]",
        "kN",
    )


def residual_chart(fits: Sequence[FittedLoop]) -> Chart:
    """Return fitted minus measured force of every loop over the deflection, in percent of half its range."""
    return _chart(
        fits,
        lambda fit: [
            Curve(x=in_unit(fit.deflection, "mm"), y=100.0 * fit.residual, name="fitted - measured", kind=_FITTED)
        ],
        "residual [%]",
        "%",
    )


def measures_chart(fits: Sequence[FittedLoop]) -> Chart:
    """Return energy per cycle and secant stiffness over the amplitude, one operating point after the other."""
    points = list(dict.fromkeys(millimetres(fit.operating_point) for fit in fits))
    curves: dict[str, list[Curve]] = {"energy": [], "secant_stiffness": []}
    for point in points:
        group = sorted(
            (fit for fit in fits if millimetres(fit.operating_point) == point), key=lambda fit: fit.amplitude
        )
        amplitudes = np.array([in_unit(fit.amplitude, "mm") for fit in group])
        about = f" about {point} mm" if len(points) > 1 else ""
        for measure, unit in (("energy", ""), ("secant_stiffness", "kN/m")):
            for kind, side in ((_FITTED, "fitted"), (_MEASURED, "measured")):
                values = np.array([in_unit(getattr(fit, measure)(getattr(fit, side)), unit) for fit in group])
                curves[measure].append(Curve(x=amplitudes, y=values, name=side + about, kind=kind))
    panels = [
        Panel(
            curves=curves[measure], ylabel=label, xlabel="amplitude [mm]", log="x" if len(fits) > 1 else "", unit=unit,
            xunit="mm",
        )
        for measure, label, unit in (
            ("energy", "energy per cycle [J]", "J"), ("secant_stiffness", "secant stiffness [kN/m]", "kN/m"),
        )
    ]  # fmt: skip
    return Chart(rows=[panels], height=180.0)


def _chart(fits: Sequence[FittedLoop], curves_of: Callable[[FittedLoop], list[Curve]], ylabel: str, unit: str) -> Chart:
    """Return a chart with a panel for every loop that is drawn."""
    panels = [
        Panel(
            curves=curves_of(fit),
            ylabel=ylabel,
            xlabel="deflection [mm]",
            title=_name(fit, fits),
            unit=unit,
            xunit="mm",
        )
        for fit in drawn_loops(fits)
    ]
    rows = [part.tolist() for part in np.array_split(np.arange(len(panels)), math.ceil(len(panels) / _ACROSS))]
    return Chart(rows=[[panels[number] for number in row] for row in rows], height=150.0)


def _name(fit: FittedLoop, fits: Sequence[FittedLoop]) -> str:
    """Return what a loop is called: its amplitude, and its operating point where there are several."""
    several = len({millimetres(one.operating_point) for one in fits}) > 1
    about = f" about {millimetres(fit.operating_point)}" if several else ""
    return f"{in_unit(fit.amplitude, 'mm'):.4g}{about} mm, error {100.0 * fit.error:.2g} %"
