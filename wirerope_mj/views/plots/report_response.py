"""Charts of payload and mounts in a report: accelerations, deflections, use of limits and loops."""

from collections.abc import Sequence
from typing import Any

import numpy as np

from wirerope_mj.engine.response import Response
from wirerope_mj.foundation.arrays import Array
from wirerope_mj.foundation.units import in_unit
from wirerope_mj.mounts.isolator import AXES
from wirerope_mj.mounts.isolator.travel import SIDES
from wirerope_mj.views.contact_histories import Touching
from wirerope_mj.views.curves import BASE, OTHERS, Curve, Panel
from wirerope_mj.views.plots.report_image import crest, short
from wirerope_mj.views.plots.svg_chart import Chart
from wirerope_mj.views.selection import NAMED, Selection

MOST = 3
"""Lines of bodies or mounts in one panel: more cannot be told apart."""

_LONG = 10_000  # samples from which loops are drawn around the largest deflection only
_AROUND = 300  # samples before and after it
_ROUNDING = 1e-9  # of the largest force, below which an axis carries none
_NOTHING = 1e-6  # g or mm: an axis on which nothing is larger has no panel


def used_chart(response: Response, selection: Selection) -> Chart:
    """Return what mounts, bodies and points use of their limits over time; the largest are named."""
    curves = []
    for number, one in enumerate(selection.used):
        named = number < NAMED
        left = len(selection.used) - NAMED
        name = short(one.subject) if named else f"{left} other{'s' if left > 1 else ''}"
        kind = kind_of(selection, one.subject) if named else OTHERS
        curves.append(Curve(x=response.time, y=in_unit(one.course, "%"), name=name, kind=kind))
    top = 108.0 * max(1.0, selection.used[0].largest)
    panel = Panel(
        curves=curves, ylabel="used of the limit [%]", xlabel="time [s]", limits=[("limit", 100.0)],
        xlim=selection.window, ylim=(0.0, top), unit="%",
    )  # fmt: skip
    return Chart(rows=[[panel]], height=190.0)


def accelerations_chart(
    response: Response, names: Sequence[str], base: tuple[Array, Array], selection: Selection
) -> Chart:
    """Return the accelerations of the base and of some bodies or points over time, a panel for each axis with any.

    Args:
        response: of the system.
        names: bodies or points, at most `MOST` of them.
        base: instants [s] and acceleration (n_t, 3) of the base [m/s^2].
        selection: of the run, with its colours.
    """
    panels: list[_Lines] = []
    for axis in range(3):
        curves = [
            Curve(
                x=response.time,
                y=in_unit(acceleration_along(response, name, axis), "g"),
                name=short(name),
                kind=kind_of(selection, name, number),
            )
            for number, name in enumerate(names[:MOST])
        ]
        curves.append(Curve(x=base[0], y=in_unit(base[1][:, axis], "g"), name="base", kind=BASE))
        panels.append((curves, f"along {'xyz'[axis]} [g]", ()))
    return _histories(panels, selection.window, "g")


def deflections_chart(response: Response, names: Sequence[str], selection: Selection) -> Chart:
    """Return the deflections of some mounts over time, a panel for each axis with any, with the ratings of the first."""
    travel = next(mount.travel for mount in response.scene.mounts if mount.name == names[0])
    panels: list[_Lines] = []
    for axis in AXES:
        curves = [
            Curve(
                x=response.time,
                y=in_unit(response.column(f"mounts/{name}/deflection/{axis}"), "mm"),
                name=short(name),
                kind=kind_of(selection, name, number),
            )
            for number, name in enumerate(names[:MOST])
        ]
        limits = [(f"rated travel of {short(names[0])}", level) for level in _ratings(travel, axis)]
        panels.append((curves, f"{axis} [mm]", limits))
    return _histories(panels, selection.window, "mm")


def contacts_chart(struck: Sequence[Touching], time: Array, window: tuple[float, float]) -> Chart:
    """Return forces of some contacts over time, at most `MOST`, and below them the gaps that are known."""
    few = struck[:MOST]
    forces = [
        Curve(x=time, y=in_unit(one.force, "kN"), name=short(one.name), kind=kind) for kind, one in enumerate(few)
    ]
    gaps = [
        Curve(x=time, y=in_unit(one.gap, "mm"), name=short(one.name), kind=kind)
        for kind, one in enumerate(few)
        if one.gap is not None
    ]
    panels = [Panel(curves=forces, ylabel="force [kN]", xlabel="" if gaps else "time [s]", xlim=window, unit="kN")]
    if gaps:
        panels.append(Panel(curves=gaps, ylabel="gap [mm]", xlabel="time [s]", xlim=window, unit="mm"))
    return Chart(rows=[[panel] for panel in panels], height=110.0 if gaps else 190.0)


def mount_loops_chart(response: Response, name: str, selection: Selection) -> Chart:
    """Return force over deflection of a mount, a panel for each axis that carries a force; see `loop_rows`."""
    rows = loop_rows(response, name)
    deflection, force = (
        np.stack([factor * response.column(f"mounts/{name}/{part}/{axis}")[rows] for axis in AXES], axis=1)
        for part, factor in (("deflection", 1e3), ("force", 1e-3))
    )
    largest = np.abs(force).max(axis=0)
    axes = np.flatnonzero(largest > _ROUNDING * largest.max()).tolist() or [AXES.index("axial")]
    row = []
    for axis in axes:
        x, y = deflection[:, axis], force[:, axis]
        room = 0.05 * float(np.ptp(x)) or 1.0
        row.append(
            Panel(
                curves=[Curve(x=x, y=y, name=short(name), kind=kind_of(selection, name, 0))],
                ylabel="force [kN]" if axis == axes[0] else "",
                xlabel="deflection [mm]",
                title=AXES[axis],
                dots=[(float(x[0]), float(y[0]))],
                xlim=(float(x.min()) - room, float(x.max()) + room),
                unit="kN",
                xunit="mm",
            )
        )
    return Chart(rows=[row], height=190.0)


def sweep_chart(response: Response, names: Sequence[str], frequency: Any, directions: Sequence[int]) -> Chart:
    """Return accelerations over the frequency of a sweep, as far from zero as they reach.

    Args:
        response: of a swept base.
        names: bodies or points.
        frequency: of the base at every sample [Hz], (n_t,).
        directions: axes along which the base moves, 0 = x; their norm is drawn.
    """
    curves = []
    for number, name in enumerate((*names[:MOST], "base")):
        size = np.zeros(response.time.size)
        for axis in directions:
            size += acceleration_along(response, name, axis) ** 2
        x, y = crest(frequency, in_unit(np.sqrt(size), "g"))
        curves.append(Curve(x=x, y=y, name=short(name), kind=BASE if name == "base" else number))
    panel = Panel(
        curves=curves, ylabel="acceleration [g]", xlabel="frequency of the base [Hz]", log="x", unit="g", xunit="Hz"
    )
    return Chart(rows=[[panel]], height=210.0)


def kind_of(selection: Selection, name: str, other: int | str = OTHERS) -> int | str:
    """Return the number of the colour that a mount, a body or a point has in every output."""
    return selection.numbers.get(name, other)


def loop_rows(response: Response, name: str) -> slice:
    """Return which samples of a mount make its loops: all, or of a long response those around its largest deflection."""
    if response.time.size <= _LONG:
        return slice(None)
    middle = int(np.searchsorted(response.time, response.peaks.mounts[name].deflection.time))
    return slice(max(middle - _AROUND, 0), middle + _AROUND)


def acceleration_along(response: Response, name: str, axis: int) -> Array:
    """Return the sampled acceleration of a body, a point or the "base" along an axis, 0 = x [m/s^2], (n_t,)."""
    room = "base" if name == "base" else f"bodies/{name}" if name in response.bodies else f"points/{name}"
    return response.column(f"{room}/acceleration/{'xyz'[axis]}")


_Lines = tuple[list[Curve], str, Sequence[tuple[str, float]]]


def _histories(lines: list[_Lines], window: tuple[float, float], unit: str) -> Chart:
    """Return a panel below the other for each list of curves that are not all zero, at least one, over a time window."""
    kept = [one for one in lines if any(np.abs(curve.y).max() > _NOTHING for curve in one[0])] or lines[2:]
    rows = [
        [
            Panel(
                curves=curves, ylabel=label, xlabel="time [s]" if label == kept[-1][1] else "", limits=limits,
                xlim=window, unit=unit,
            )
        ]
        for curves, label, limits in kept
    ]  # fmt: skip
    return Chart(rows=rows, height=190.0 if len(kept) == 1 else 110.0)


def _ratings(travel: dict[str, float], axis: str) -> list[float]:
    """Return the rated travels of an axis below and above zero [mm], as far as there are any."""
    return [
        sign * in_unit(travel[rating], "mm")
        for rating, sign in zip(SIDES[axis], (-1.0, 1.0), strict=True)
        if rating in travel
    ]
