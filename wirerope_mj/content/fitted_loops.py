"""Charts of a fit: loops, residuals and measures over the amplitude, measured against fitted."""

import math
from collections.abc import Callable, Sequence
from dataclasses import replace

import numpy as np

from wirerope_mj.content.panels import OTHERS, Chart, Curve, Panel
from wirerope_mj.content.selection import COLOURS
from wirerope_mj.foundation.arrays import Array
from wirerope_mj.foundation.units import force_unit, in_unit
from wirerope_mj.mounts.identification.result import FittedLoop

MOST = 12  # Loops of one chart: more cannot be read
_ACROSS = 3
_MEASURED, _FITTED = 0, 1  # numbers of their colours
_ROOM = 0.05  # of the stroke, left free on either side: the turning points are what one looks at
_BRANCH = 9  # fraction of a branch over which residuals are averaged
_APART = 1.15  # ratio of amplitudes left free on either side
_SHORT = 0.03  # of the amplitude: half a fitted value that no other continues


def drawn_loops(fits: Sequence[FittedLoop]) -> list[FittedLoop]:
    """Return the loops that are drawn, twelve at most, from the smallest to the largest."""
    rows = np.unique(np.linspace(0, len(fits) - 1, min(len(fits), MOST)).round().astype(int))
    return [fits[row] for row in rows]


def fit_chart(fits: Sequence[FittedLoop]) -> Chart:
    """Return force over deflection of every loop: measured as dots, fitted as a line."""
    unit = force_unit(max(float(np.abs(fit.measured.force).max()) for fit in fits))

    def curves(fit: FittedLoop) -> list[Curve]:
        x = in_unit(fit.measured.deflection, "mm")
        return [
            Curve(x=x, y=in_unit(fit.fitted.force, unit), name="fitted", kind=_FITTED),
            Curve(x=x, y=in_unit(fit.measured.force, unit), name="measured", kind=_MEASURED, marks=True),
        ]

    drawn = f" {MOST} of {len(fits)} loops are drawn." if len(fits) > MOST else ""
    return replace(
        _chart(fits, curves, f"force [{unit}]", unit),
        id="fit",
        caption=f"Loops, measured and fitted; the error is that of the force over half its range.{drawn}",
        alt="Loops, measured and fitted.",
    )


def residual_chart(fits: Sequence[FittedLoop]) -> Chart:
    """Return fitted minus measured force of every loop over the deflection, in percent of half its range, on one scale."""
    largest = 110.0 * max(float(np.abs(fit.residual).max()) for fit in drawn_loops(fits)) or 1.0
    return replace(
        _chart(fits, _residual_curves, "fitted - measured [%]", "%", ylim=(-largest, largest)),
        id="residuals",
        caption="Fitted minus measured force over half its range: samples, and their mean over a ninth of each branch. A law "
        "that fits leaves noise, whose mean is zero; what bends is what the law cannot do.",
        alt="Residuals over the deflection.",
    )


def measures_chart(fits: Sequence[FittedLoop]) -> Chart:
    """Return energy per cycle and secant stiffness over the amplitude: measured as dots, fitted as lines between them."""
    amplitudes = np.array([in_unit(fit.measured.amplitude, "mm") for fit in fits])
    across = (float(amplitudes.min()) / _APART, float(amplitudes.max()) * _APART)
    panels = []
    for measure, unit, label in (
        ("dissipated_energy", "J", "energy per cycle [J]"),
        ("secant_stiffness", "kN/m", "stiffness [kN/m]"),
    ):
        curves = _measure_curves(fits, measure, unit)
        values = np.concatenate([curve.y for curve in curves])
        # That of a device without loss is noise of either sign.
        log = measure == "dissipated_energy" and bool((values > 0.0).all())
        limits = (float(values.min()) / 1.3, float(values.max()) * 1.3) if log else None
        if measure == "secant_stiffness" and values.min() > 0.0:
            limits = (0.0, 1.1 * float(values.max()))
        panels.append(
            Panel(
                curves=curves, ylabel=label, xlabel="amplitude [mm]", xlim=across, ylim=limits, log="xy" if log else "x",
                unit=unit, xunit="mm",
            )
        )  # fmt: skip
    return Chart(
        id="measures", rows=[panels], height=180.0, caption="Energy per cycle and secant stiffness over the amplitude.",
        alt="Measures over the amplitude.",
    )  # fmt: skip


def _residual_curves(fit: FittedLoop) -> list[Curve]:
    """Return the residual's mean on the way up and down, and its samples behind them."""
    start = int(np.argmin(fit.measured.deflection[:-1]))
    x, residual = (np.roll(values[:-1], -start) for values in (in_unit(fit.measured.deflection, "mm"), 100.0 * fit.residual))
    top = int(np.argmax(x))
    curves = [
        Curve(x=at, y=mean, name=f"mean on the way {way}", kind=kind)
        for way, branch, kind in (("up", slice(0, top + 1), _MEASURED), ("down", slice(top, None), _FITTED))
        for at, mean in [_running_mean(x[branch], residual[branch])]
    ]
    return [*curves, Curve(x=x, y=residual, name="samples", kind=OTHERS, marks=True)]


def _running_mean(x: Array, values: Array) -> tuple[Array, Array]:
    """Return the means of positions and values over a ninth of a branch."""
    window = np.full(width := max(1, x.size // _BRANCH), 1.0 / width)
    return np.convolve(x, window, "valid"), np.convolve(values, window, "valid")


def _measure_curves(fits: Sequence[FittedLoop], measure: str, unit: str) -> list[Curve]:
    """Return a measure over the amplitude, the measured one in front of the fitted one of each operating point."""
    groups, curves = _groups(fits), []
    for number, group in enumerate(groups):
        x = np.array([in_unit(fit.measured.amplitude, "mm") for fit in group])
        about = f" about {_millimetres(group)} mm" if len(groups) > 1 else ""
        kinds = (_MEASURED, _FITTED) if len(groups) == 1 else 2 * (number % COLOURS,)
        measured, fitted = (
            np.array([in_unit(getattr(getattr(fit, side), measure), unit) for fit in group]) for side in ("measured", "fitted")
        )
        curves.append(Curve(x=x, y=measured, name=f"measured{about}", kind=kinds[0], marks=True))
        if x.size == 1:  # a line from nowhere to nowhere cannot be seen
            x, fitted = x[0] * np.array([1.0 - _SHORT, 1.0 + _SHORT]), np.repeat(fitted, 2)
        curves.append(Curve(x=x, y=fitted, name=f"fitted{about}", kind=kinds[1]))
    return curves


def _chart(
    fits: Sequence[FittedLoop], curves_of: Callable[[FittedLoop], list[Curve]], ylabel: str, unit: str,
    ylim: tuple[float, float] | None = None,
) -> Chart:  # fmt: skip
    """Return a chart with a panel for every loop that is drawn."""
    panels = []
    for fit in drawn_loops(fits):
        low, high = float(fit.measured.deflection.min()), float(fit.measured.deflection.max())
        room = _ROOM * (high - low)
        panels.append(
            Panel(
                curves=curves_of(fit), ylabel=ylabel, xlabel="deflection [mm]", title=_name(fit, fits), unit=unit,
                xunit="mm", xlim=(in_unit(low - room, "mm"), in_unit(high + room, "mm")), ylim=ylim,
            )
        )  # fmt: skip
    rows = [part.tolist() for part in np.array_split(np.arange(len(panels)), math.ceil(len(panels) / _ACROSS))]
    return Chart(rows=[[panels[number] for number in row] for row in rows], height=150.0)


def _groups(fits: Sequence[FittedLoop]) -> list[list[FittedLoop]]:
    """Return the loops of each operating point, from compression to tension."""
    # Points within 2 % of the largest amplitude are one, as no rig holds them better beside noise.
    step = 0.02 * max(fit.measured.amplitude for fit in fits)
    groups: list[list[FittedLoop]] = []
    for fit in sorted(fits, key=lambda fit: fit.measured.operating_point):
        if groups and fit.measured.operating_point - groups[-1][0].measured.operating_point <= step:
            groups[-1].append(fit)
        else:
            groups.append([fit])
    return [sorted(group, key=lambda fit: fit.measured.amplitude) for group in groups]


def _millimetres(group: Sequence[FittedLoop]) -> str:
    """Return the mean operating point of a group in mm; a thousandth of its largest amplitude is noise."""
    least = 1e-3 * max(1e3 * fit.measured.amplitude for fit in group)
    mean = 1e3 * float(np.mean([fit.measured.operating_point for fit in group]))
    return f"{least * round(mean / least):.3g}" if abs(mean) > least else "0"


def _name(fit: FittedLoop, fits: Sequence[FittedLoop]) -> str:
    """Return what a loop is called: its amplitude, and its operating point where there are several."""
    groups = _groups(fits)
    own = next(group for group in groups if any(fit is other for other in group))
    about = f" about {_millimetres(own)}" if len(groups) > 1 else ""
    return f"±{in_unit(fit.measured.amplitude, 'mm'):.3g}{about} mm: {100.0 * fit.error:.2g} % error"
