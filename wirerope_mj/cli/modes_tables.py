"""`wirerope modes`: computing, writing and printing the modes of a model."""

import math
from collections.abc import Iterator, Sequence
from datetime import datetime
from pathlib import Path

from rich.markup import escape

from wirerope_mj.assessment.criteria.ddam import Direction, Location, Ship, ddam_design_values
from wirerope_mj.assessment.criteria.tested import untested
from wirerope_mj.dynamics.modes import Modes, modes
from wirerope_mj.dynamics.modes.carried import carried, reached_in, travel_utilisation
from wirerope_mj.engine.statics import History, model_warnings
from wirerope_mj.engine.system import System, load_system
from wirerope_mj.foundation.arguments import positive
from wirerope_mj.foundation.atomic_files import check_writable
from wirerope_mj.foundation.errors import RecordError
from wirerope_mj.foundation.tables import Cell, Column, Row, Table
from wirerope_mj.foundation.units import STANDARD_GRAVITY
from wirerope_mj.mounts.laws.hysteresis import Hysteresis
from wirerope_mj.runs.folder import check_target
from wirerope_mj.runs.modes import KIND, MARKS, write_modes
from wirerope_mj.views.terminal import console, print_lines, print_table, print_warnings

_SHIP_AXES: tuple[Direction, ...] = ("fore-and-aft", "athwartship", "vertical")

LEAST_WEIGHT = 1e-3
"""Fraction of a mode's weight along which it is said to move."""


def modes_command(
    model: str,
    history: History,
    amplitudes_mm: Sequence[float],
    *,
    ddam: tuple[Ship, Location] | None = None,
    out: Path | None,
    force: bool,
) -> int:
    """Find the modes of a model, write them, print them; return the exit code."""
    for size in amplitudes_mm:
        positive("--amplitude-mm", size)
    system = load_system(model)
    target = out or Path("runs") / f"{system.name}-modes-{datetime.now():%Y%m%d-%H%M%S}"
    alone = target.suffix == ".rrd"
    if alone and target.exists() and not force:
        raise RecordError(f"{target}: there is a file already. Replace it with --force, or choose another one.")
    if alone:
        check_writable(target)
    else:
        check_target(target, force=force, kind=KIND, marks=MARKS)
    print_warnings(model_warnings(system))
    small = modes(system, history=history)
    large = [modes(system, history=history, amplitude=size / 1e3) for size in amplitudes_mm]
    if alone:
        from wirerope_mj.dynamics.modes.animation import animated_modes
        from wirerope_mj.views.recording.modes import record_modes

        record_modes(animated_modes(system, small), target, title=system.name, larger=large)
    else:
        write_modes(system, system.name, [small, *large], target, force=force)
    print_modes(system.name, small, large)
    print_lines(
        [
            *about_small(system, small),
            *below_tests(system),
            *beyond_rating(system, large),
            *outside_tests(system, large),
            *about_rest(system, small, large),
        ]
    )
    if ddam is not None:
        print_ddam(small, *ddam)
    screen, written = console(), f"{target}" if alone else f"{target}/"
    screen.print(f"\n  written to {escape(written)}", soft_wrap=True)
    screen.print(f"  [bold]wirerope show {escape(str(target))}[/] opens the view", soft_wrap=True)
    return 0


def print_modes(name: str, small: Modes, large: Sequence[Modes]) -> None:
    """Print the modes of small cycles and of larger ones, each in the row of its mode."""
    screen = console()
    screen.print()
    print_table(_table(name, small, large))
    screen.print()
    print_lines(
        [
            small.stability.description,
            "Damping in brackets. x, y, z: fraction that takes part of the mass that can move along it.",
        ]
    )


def print_ddam(small: Modes, ship: Ship, location: Location) -> None:
    """Print modal weight and design acceleration of every mode along the directions in which it takes part."""
    rows: list[Row] = []
    for number, frequency in enumerate(small.frequencies):
        weights = STANDARD_GRAVITY * small.moving_mass * small.participation[number]
        cells: list[Cell] = [str(number + 1), float(frequency)]
        for weight, direction in zip(weights, _SHIP_AXES, strict=True):
            there = frequency > 0.0 and weight > LEAST_WEIGHT * weights.sum()
            if not there:
                cells += [None, None]
                continue
            values = ddam_design_values(
                float(weight), float(frequency), location=location, direction=direction, ship=ship
            )
            cells += [values.weight, values.acceleration]
        rows.append(cells)
    columns = [Column("mode", align="left"), Column("small", "Hz", ".2f")]
    for axis in "xyz":
        columns += [Column(f"weight {axis}", "kN", ".3f"), Column(f"D {axis}", "g", ".1f")]
    note = (
        "x fore and aft, y athwartship, z vertical; modal weights of small cycles. The unclassified interim values of NRL "
        "memorandum 1396, elastic, at least 6 g; a linear method, in which large deflections of mounts have no place."
    )
    console().print()
    title = f"DDAM: design accelerations, {ship}, {location}"
    print_table(Table(title=title, columns=columns, rows=rows, note=note))


def about_small(system: System, small: Modes) -> Iterator[str]:
    """Yield the meaning of the frequencies of small amplitude, compared with those of the tangents at rest."""
    outside = small.outside_tangents
    text = "Small cycles: their limit as the amplitude vanishes, in which the hysteretic force has faded"
    if not outside.size:
        yield f"{text}; between the tangents at rest on further loading and on unloading."
    else:
        which = ", ".join(str(row + 1) for row in outside)
        yield (
            f"{text}. In mode {which} it is not between the tangents at rest on further loading and on unloading: with "
            "gamma > beta, and with an elastic part that bends, both can lie to one side of it."
        )
    laws = [law for mount in system.mounts.values() for law in mount.isolator.axes.values()]
    if any(getattr(law, "n", 1.0) < 1.0 for law in laws if isinstance(law, Hysteresis)):
        yield (
            "A law with n < 1 is near that limit only at amplitudes that no rig shows: --amplitude-mm gives the frequencies of "
            "larger cycles."
        )


def beyond_rating(system: System, large: Sequence[Modes]) -> Iterator[str]:
    """Yield for each amplitude a sentence on the mounts that it takes beyond a rated travel in some mode, sag included."""
    for result in large:
        beyond = {name: used for name in system.mounts if (used := travel_utilisation(system, result, name)) > 1.0}
        if beyond:
            worst = max(beyond, key=lambda name: beyond[name])
            yield (
                f"{1e3 * (result.amplitude or 0.0):g} mm takes mounts beyond their rated travel: {', '.join(beyond)} "
                f"({worst} up to {100.0 * beyond[worst]:.0f} % of it, sag included). Nobody vouches for the law there."
            )


def below_tests(system: System) -> Iterator[str]:
    """Yield a sentence on the isolators whose small cycles lie below what was tested."""
    least = {
        f"{mount.isolator.name} {axis} ({1e3 * one.amplitude[0]:.3g} mm)": None
        for mount in system.mounts.values()
        for axis, one in mount.isolator.validity.stated.items()
        if one.amplitude[0] > 0.0
    }
    if least:
        yield (
            "Small cycles lie below the least amplitude that isolators were tested at, and their frequencies are extrapolated: "
            f"{', '.join(least)}."
        )


def outside_tests(system: System, large: Sequence[Modes]) -> Iterator[str]:
    """Yield for each amplitude a sentence on the mounts that it takes outside what their laws were identified from."""
    isolators = {name: mount.isolator for name, mount in system.mounts.items()}
    for result in large:
        ends = {name: reached_in(result, name) for name in system.mounts}
        if where := untested(isolators, ends):
            size = 1e3 * (result.amplitude or 0.0)
            tested = "outside the cycles that isolators were identified from"
            yield f"{size:g} mm is {tested}: {where}. Their laws are extrapolated."


def about_rest(system: System, small: Modes, large: Sequence[Modes]) -> Iterator[str]:
    """Yield for each amplitude a sentence on the modes that lie elsewhere where the cycles' mean force carries the weight."""
    for result in large:
        there = carried(system, result)
        if not there.apart.size:
            continue
        rows = {index: row + 1 for row, index in enumerate(small.indices_in(result))}
        text = ", ".join(
            f"mode {rows[int(at)]} at {there.frequencies[at]:.3f} instead of {result.frequencies[at]:.3f} Hz "
            f"({there.mounts[at]} {1e3 * there.shift[at]:.2g} mm from rest)"
            for at in there.apart
        )
        yield (
            f"{1e3 * (result.amplitude or 0.0):g} mm about the {result.history} position does not carry on average what rests "
            f"on the mounts. In lasting vibration they move to where it does: {text}."
        )


def _table(name: str, small: Modes, large: Sequence[Modes]) -> Table:
    sizes = [f"{1e3 * (modes.amplitude or 0.0):g} mm" for modes in large]
    columns = [
        Column(align="left"),
        *(Column(f"{heading}\n[Hz]") for heading in ("small", "loading", "unloading", *sizes)),
        *(Column(axis, "%", ".1f") for axis in "xyz"),
        Column(align="text"),
    ]
    indices = [small.indices_in(modes) for modes in large]
    rows: list[Row] = []
    for row, description in enumerate(small.descriptions):
        cells = [_hertz(small.frequencies[row], small.damping_ratio[row])]
        cells += [_hertz(values[row]) for values in (small.loading, small.unloading)]
        for larger, index in zip(large, indices, strict=True):
            cells.append(_hertz(larger.frequencies[index[row]], larger.damping_ratio[index[row]]))
        rows.append([str(row + 1), *cells, *small.participation[row], description])
    return Table(title=f"{name}: modes about the {small.history} position", columns=columns, rows=rows)


def _hertz(frequency: float, damping: float | None = None) -> str:
    if not math.isfinite(frequency):
        return "tips"
    none = damping is None or f"{damping:.3f}" == "0.000"
    return f"{frequency:.3f}" if none else f"{frequency:.3f} ({damping:.3f})"
