"""Periodic motions of a branch: their loops along the resonance, and what one of them says."""

from collections.abc import Iterator, Sequence

import numpy as np

from wirerope_mj.content.blocks import Block, Statement
from wirerope_mj.content.panels import BASE, Chart, Curve, Panel, with_room
from wirerope_mj.dynamics.frequency_response.summary import along_resonance, busiest_loops
from wirerope_mj.dynamics.periodic import Branch, PeriodicOrbit
from wirerope_mj.foundation.tables import Column, Mark, Row, Table
from wirerope_mj.foundation.units import force_unit, in_unit
from wirerope_mj.mounts.isolator import AXES

_MOST = 4  # panels: from the lowest level to the highest
_MULTIPLIERS = 5
Motion = tuple[Branch, int, PeriodicOrbit]  # A branch, the number of one of its points, and the motion there


def orbit_blocks(branches: Sequence[Branch]) -> Iterator[Block]:
    """Yield loops and phase portraits of the mount that takes most energy along the resonance of some levels, and a table."""
    if not branches or not branches[0].system.mounts:
        return
    rows = np.unique(np.linspace(0, len(branches) - 1, min(len(branches), _MOST)).round().astype(int))
    chosen = [branches[row] for row in rows]
    loops = busiest_loops(chosen[-1].orbit(chosen[-1].peak).response)
    if not loops:
        return
    motions = [[(branch, point, branch.orbit(point)) for point in along_resonance(branch)] for branch in chosen]
    yield _chart(motions, *loops[0])
    yield _chart(motions, *loops[0], portraits=True)
    yield orbit_table([motion for level in motions for motion in level], *loops[0])


def _chart(motions: Sequence[Sequence[Motion]], mount: str, axis: int, *, portraits: bool = False) -> Chart:
    """Return force over deflection of a mount, or the deflection's rate over it, a panel for each level."""
    device = motions[0][0][0].system.mounts[mount].isolator.name
    panels = [_panel(level, mount, axis, portraits=portraits) for level in motions]
    across = 2 if len(panels) == _MOST else len(panels)
    what = "Phase portraits" if portraits else "Loops"
    more = " A dot marks where a period of the base begins." if portraits else ""
    return Chart(
        id="orbit-portraits" if portraits else "orbit-loops", height=260.0,
        rows=[panels[first : first + across] for first in range(0, len(panels), across)],
        caption=f"{what} of {mount} ({device}), {AXES[axis]}, along the resonance of each level: the highest motion bold, "
        f"unstable ones dashed.{more}",
        alt=f"{what} of {mount} along the resonance.",
    )  # fmt: skip


def _panel(level: Sequence[Motion], mount: str, axis: int, *, portraits: bool) -> Panel:
    unit, curves, dots = "m/s" if portraits else _force_unit(level, mount, axis), [], []
    for number, (branch, point, orbit) in enumerate(level):
        loop, highest = orbit.response.mounts[mount], point == branch.peak
        name = f"{orbit.frequency:.4g} Hz" + (" highest" if highest else "") + ("" if orbit.stable else ", unstable")
        upward = orbit.deflection_rate(mount) if portraits else loop.force
        curve = Curve(
            x=in_unit(loop.deflection[:, axis], "mm"), y=in_unit(upward[:, axis], unit), name=name,
            kind=BASE if highest else number, dash="" if orbit.stable else "dashed", weight=1.8 if highest else 1.0,
        )  # fmt: skip
        curves.append(curve)
        begins = orbit.steps // orbit.periods * np.arange(orbit.periods if portraits else 0)
        dots += [(float(curve.x[row]), float(curve.y[row])) for row in begins]
    curves.sort(key=lambda curve: (curve.kind == BASE, not curve.dash))  # dashed ones in front of what they run along
    return Panel(
        curves=curves, ylabel=f"its rate [{unit}]" if portraits else f"force [{unit}]", dots=dots,
        xlabel="deflection [mm], tension positive" if AXES[axis] == "axial" else "deflection [mm]",
        title=f"{abs(float(level[0][0].acceleration[0])):.4g} m/s²",
        xlim=with_room(np.concatenate([curve.x for curve in curves])), unit=unit, xunit="mm",
    )  # fmt: skip


def _force_unit(motions: Sequence[Motion], mount: str, axis: int) -> str:
    largest = max(float(np.abs(orbit.response.mounts[mount].force[:, axis]).max()) for *_, orbit in motions)
    return force_unit(largest)


def orbit_table(motions: Sequence[Motion], mount: str, axis: int) -> Table:
    """Tabulate motions: amplitude, stability, the range of a mount's loop and its work per repetition."""
    unit, rows = _force_unit(motions, mount, axis), []
    for branch, point, orbit in motions:
        row: Row = (
            abs(float(branch.acceleration[point])), orbit.frequency,
            "stable" if orbit.stable else Mark("UNSTABLE", "unjudged"),
            float(branch.amplitude[point]), float(branch.transmissibility[point]),
            *_ranges(orbit, mount, axis),
        )  # fmt: skip
        rows.append(row)
    columns = (
        Column("level", "m/s²", ".4g"), Column("frequency", "Hz", ".5g"), Column("motion", align="left"),
        Column("amplitude", "m/s²", ".4g"), Column("transmissibility", form=".4g"),
        Column("deflection from", "mm", "z.4g"), Column("to", "mm", "z.4g"),
        Column("force from", unit, "z.4g"), Column("to", unit, "z.4g"), Column("work", "J", ".3g"),
    )  # fmt: skip
    title = f"Motions, with the loop of mount {mount}, {AXES[axis]}; work: of one repetition"
    return Table(id="orbits", title=title, columns=columns, rows=rows)


def _ranges(orbit: PeriodicOrbit, mount: str, axis: int) -> tuple[float, float, float, float, float]:
    """Return the range of a mount's deflection [m] and force [N], and the work of a repetition [J]."""
    loop = orbit.response.mounts[mount]
    x, force = loop.deflection[:, axis], loop.force[:, axis]
    work = float(np.sum(0.5 * (force[1:] + force[:-1]) * np.diff(x)))
    return float(x.min()), float(x.max()), float(force.min()), float(force.max()), work


def motion_blocks(motion: Motion, until: int, loop: tuple[str, int] | None) -> Iterator[Block]:
    """Yield what a motion says: its stability and multipliers, what happens up to the point `until`, and a mount's loop."""
    branch, point, orbit = motion
    level, state = abs(float(branch.acceleration[point])), "stable" if orbit.stable else "UNSTABLE"
    yield Statement(id="motion", text=f"{orbit.frequency:.5g} Hz, {level:.4g} m/s²: {state}", tone="strong")
    near = [event.description for event in branch.bifurcations if point <= event.index < max(until, point + 1)]
    yield Statement(id="events", items=tuple(near))
    yield Statement(
        id="amplitude",
        text=f"Amplitude {branch.amplitude[point]:.4g} m/s², transmissibility {branch.transmissibility[point]:.4g}",
        tone="strong",
    )
    yield Table(
        id="multipliers", title="", columns=(Column("Floquet multiplier"), Column("modulus", form=".4f")),
        rows=[
            (f"{value.real:+.4f} {value.imag:+.4f} i", float(abs(value)))
            for value in orbit.floquet_multipliers[:_MULTIPLIERS]
        ],
    )  # fmt: skip
    if loop is not None:
        low, high, least, most, work = _ranges(orbit, *loop)
        yield Statement(
            id="loop",
            text=f"Mount {loop[0]}, {AXES[loop[1]]}: {in_unit(low, 'mm'):.4g} to {in_unit(high, 'mm'):.4g} mm, "
            f"{in_unit(least, 'kN'):.4g} to {in_unit(most, 'kN'):.4g} kN, {work:.3g} J per repetition",
        )
    neutral = f", {orbit.neutral} neutral directions" if orbit.neutral else ""
    text = f"point {point + 1} of {branch.frequency.size}, residual {orbit.residual:.1e}{neutral}"
    yield Statement(id="point", text=text, tone="quiet")
