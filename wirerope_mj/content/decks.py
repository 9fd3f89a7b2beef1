"""Blocks on the deck: its loads and bolts, peaks on flexible decks against the rigid deck; content of a flexible part."""

import math
from collections.abc import Iterator, Mapping

import numpy as np

from wirerope_mj.assessment.criteria.loads import StopLoad, area_forces, bolt_loads, mounts_on_base, stop_loads
from wirerope_mj.assessment.criteria.verdict import payload_bodies
from wirerope_mj.content.blocks import Block, Content, Section, Statement
from wirerope_mj.content.judged_run import JudgedRun
from wirerope_mj.content.model import mounts_and_stops
from wirerope_mj.content.numbers import several, with_unit
from wirerope_mj.engine.flexible import FlexiblePart, Panel
from wirerope_mj.engine.flexible.panel import NAME
from wirerope_mj.engine.response.peaks import Peaks
from wirerope_mj.engine.simulation.batch import peaks_on_decks
from wirerope_mj.engine.statics.payloads import payloads_of
from wirerope_mj.foundation.arrays import Array, Booleans
from wirerope_mj.foundation.errors import WireRopeError
from wirerope_mj.foundation.tables import Cell, Column, Mark, Row, Table, left

DECKS = (8.0, 12.0, 18.0, 25.0)  # natural frequencies of decks and platforms between frames [Hz]
DAMPING = 0.04
HEAVIER = 2.0  # mass of the panel over that of its payload, as of a field of deck between frames
LONGEST = 10.0  # simulated time above which four more runs take too long for a page [s]
MOVES = 1.1  # ratio to the peak on the rigid deck above which a peak is reported to grow
_STILL = 1e-9  # acceleration along z below which the base does not move along it [m/s^2]
_SHOWN_BOLTS = 10  # bolts that are shown at once


def decks_blocks(run: JudgedRun) -> Iterator[Block]:
    """Yield the governing peaks on decks of four frequencies if the run asks for them, or why they were not computed."""
    if not run.response.scene.mounts:
        return
    if deck_bends(run):
        return
    obstacle = _obstacle(run)
    if not (obstacle or run.decks):
        yield Statement(
            "decks",
            f"The deck is rigid here: `wirerope report RUN --decks` adds the peaks on decks of {DECKS[0]:g} to {DECKS[-1]:g} "
            'Hz, --deck "10 Hz 800 kg 4 %" puts the model on one.',
            tone="quiet",
        )
        return
    if not obstacle:
        try:
            mass = HEAVIER * sum(payload.mass for payload in payloads_of(run.system))
            panels = [Panel(frequency=frequency, mass=mass, damping=DAMPING) for frequency in DECKS]
            step, duration = run.response.numerics.timestep, float(run.response.time[-1])
            peaks_of = peaks_on_decks(
                run.system, run.motion, panels, duration=duration, timestep=step,
                initial=str(run.inputs.get("simulate", {}).get("initial", "settled")), sample_rate=run.sample_rate,
            )  # fmt: skip
            decks: dict[str, Governing | str] = {"rigid": _governing(run, run.response.peaks)}
            for panel, peaks in zip(panels, peaks_of, strict=True):
                decks[with_unit(panel.frequency, "Hz")] = peaks if isinstance(peaks, str) else _governing(run, peaks)
        except (WireRopeError, ValueError) as error:
            obstacle = str(error).rstrip(".")
        else:
            yield from _deck_comparison(decks, mass)
            return
    text = f"The deck is rigid here; one that bends was not looked at: {obstacle}. "
    yield Statement("decks", f'{text}--deck "10 Hz 800 kg 4 %" puts the model on one.', tone="unjudged")


def deck_bends(run: JudgedRun) -> bool:
    """Tell whether anything in a run's model bends: a flexible part, or a deck panel."""
    return bool(run.system.assembly.subjects.modes) or any(body.name == NAME for body in run.response.scene.bodies)


def _obstacle(run: JudgedRun) -> str:
    """Describe why a run cannot be repeated on decks; "" if it can."""
    response = run.response
    if not run.system.base:
        return "the base is fixed in the world"
    if run.motion.velocity_jumps:
        return "the base's velocity jumps"
    if response.numerics.engine != "kernel":
        return "MuJoCo computed the run, which takes longer"
    if response.time[-1] - response.time[0] > LONGEST:
        return f"the run is longer than {LONGEST:g} s"
    if float(abs(response.base.acceleration[:, 2]).max(initial=0.0)) < _STILL:
        return "the base does not move along z"
    return ""


# Name and size of the largest acceleration of the payload [m/s^2] and deflection of a mount [m]
Governing = tuple[tuple[str, float], tuple[str, float]]


def _governing(run: JudgedRun, peaks: Peaks) -> Governing:
    """Find name and size of the payload's largest acceleration [m/s^2] and of the largest deflection of a mount [m]."""
    accelerations = {name: peaks.bodies[name].acceleration.value for name in payload_bodies(run.response)}
    accelerations |= {name: point.acceleration.value for name, point in peaks.points.items()}
    deflections = {mount.name: peaks.mounts[mount.name].deflection.value for mount in run.response.scene.isolating}
    first, second = (max(values.items(), key=lambda item: item[1]) for values in (accelerations, deflections))
    return first, second


def _deck_comparison(decks: dict[str, Governing | str], mass: float) -> Iterator[Block]:
    """Tabulate governing peaks on each deck against those on the rigid deck, and state the largest growth."""
    rigid = decks["rigid"]
    assert not isinstance(rigid, str)
    rows: list[Row] = []
    largest: dict[str, float] = {}
    for name, deck in decks.items():
        if isinstance(deck, str):
            rows.append((name, None, deck, None, None, "", None))
            continue
        cells: list[Cell] = [name]
        for (subject, value), (_, on_rigid) in zip(deck, rigid, strict=True):
            factor = value / on_rigid if on_rigid > 0.0 else math.nan
            largest[name] = max(largest.get(name, factor), factor)
            cells += [value, subject, Mark(factor, "near" if factor > MOVES else "")]
        rows.append(cells)
    columns = (
        *left("deck"), Column("largest\nacceleration", "g", "z.2f"), *left("of"),
        Column("of that on\na rigid deck", "%", "z.0f"), Column("largest\ndeflection", "mm", "z.1f"), *left("of"),
        Column("of that on\na rigid deck", "%", "z.0f"),
    )  # fmt: skip
    note = (
        f"A guided panel of {with_unit(mass, 'kg')}, twice what it carries, with {with_unit(DAMPING, '%')} of damping under "
        "all mounts, tuned alone to each frequency along z. Your own deck: --deck with frequency, mass and damping, or the "
        "folder of its modes."
    )
    yield Table("decks", "The same on decks that bend", columns, rows, note=note)
    worst = max(largest, key=largest.__getitem__)
    text, moves = "On none of these decks a governing peak grows by more than a tenth.", largest[worst] > MOVES
    if moves:
        text = f"On a deck of {worst} a governing peak grows to {100.0 * largest[worst]:.0f} % of that on the rigid one: find "
        text += "out how stiff the deck is."
    tone = "unjudged" if moves else ""
    yield Statement("decks-answer", text, tone=tone, values={"largest_factor": largest[worst]})


def stop_loads_table(runs: Mapping[str, JudgedRun]) -> Table | None:
    """Tabulate the largest force of every stop on what it stands on, over the load cases; None if no stop was touched."""
    largest: dict[str, tuple[str, StopLoad]] = {}
    for case, run in runs.items():
        for load in stop_loads(run.response):
            if load.name not in largest or load.force > largest[load.name][1].force:
                largest[load.name] = case, load
    cases = [*left("in")] if len(runs) > 1 else []
    rows: list[list[Cell]] = [
        [load.name, load.base, load.force, *map(float, load.vector), load.time, *([case] if cases else [])]
        for case, load in sorted(largest.values(), key=lambda pair: -pair[1].force)
    ]
    columns = (
        *left("stop", "on"), Column("largest\nforce", "kN", 3), *(Column(axis, "kN", "z.3f") for axis in "xyz"),
        Column("at", "s", "z.4f"), *cases,
    )  # fmt: skip
    return Table(
        "stop-loads", "Largest forces of the stops on what they stand on, for their anchors", columns, rows,
        note="At every step; x, y, z: components at that instant in the world's axes, z < 0 presses down. Dead weight and "
        "what the mounts beside it bear are not in it.",
        shown=_SHOWN_BOLTS,
    ) if rows else None  # fmt: skip


def deck_blocks(run: JudgedRun) -> Iterator[Block | None]:
    """Yield the forces on the deck, on each named area, and on bolts."""
    if not run.response.scene.mounts:
        return
    areas = area_forces(run.response, run.motion.up)
    if len(areas) > 1:
        at = Column("at", "s", "z.4f")
        columns = (
            *left("mounts on"), Column("mounts\nand stops", form="d"), Column("at rest", "kN", 3), Column("down", "kN", 3), at,
            Column("up", "kN", 3), at, Column("horizontally", "kN", 3), at,
        )  # fmt: skip
        rows = [
            (
                area.name or "the whole deck", area.mounts, area.at_rest, area.down, area.down_time, area.up, area.up_time,
                area.across, area.across_time,
            )
            for area in areas
        ]  # fmt: skip
        yield Table(
            "deck", "Sums of the mounts' forces on what carries them", columns, rows,
            note="At the samples, weight included: downwards along gravity, upwards where the mounts pull, horizontally. "
            "Contacts of geoms are not among them.",
        )  # fmt: skip
    else:
        whole = areas[0]
        sizes = ", ".join(
            f"{with_unit(force, 'kN', digits=3)} {where} at {time:.4f} s"
            for force, where, time in (
                (whole.down, "downwards", whole.down_time), (whole.up, "upwards", whole.up_time),
                (whole.across, "horizontally", whole.across_time),
            )
        )  # fmt: skip
        count = mounts_and_stops(mounts_on_base(run.response.scene))
        yield Statement(
            "deck",
            f"Load of {count} together, weight included: {with_unit(whole.at_rest, 'kN', digits=3)} at the beginning; "
            f"at most {sizes}. Contacts of geoms are not among them.",
        )
    yield stop_loads_table({"": run})
    bolts = [
        (load.mount, load.bolts, load.tension, load.tension_time, load.shear, load.shear_time)
        for load in bolt_loads(run.response)
    ]
    if bolts:
        columns = (
            *left("mount"), Column("bolts", form="d"), Column("tension of one", "kN", 3), Column("at", "s", "z.4f"),
            Column("shear of one", "kN", 3), Column("at", "s", "z.4f"),
        )  # fmt: skip
        yield Table(
            "bolts", "Largest loads of a bolt on the base side", columns, bolts,
            note="A rigid plate, the force across acting at half the isolator's height; without prying and preload.",
            shown=_SHOWN_BOLTS,
        )  # fmt: skip


CAPTURED = 0.9  # fraction of the mass along an axis below which omitted modes matter, as in seismic rules
# Fraction of a point's static compliance that may be missing, and of its largest one that an axis has to count.
_MISSING_COMPLIANCE, _COUNTED_COMPLIANCE = 0.01, 0.01
# Effective mass that decks and machines have [kg]; beyond it units are perhaps other ones.
_LIGHTEST, _HEAVIEST = 1.0, 1e6


def flexible_content(
    name: str, part: FlexiblePart, *, mass: float | Array | None = None, whole: FlexiblePart | None = None
) -> Content:
    """Compose the content of a flexible part: its modes, and checks of them.

    With its mass [kg], perhaps along x, y, z, the fraction that the modes capture; with the `whole` part, of which modes were
    left out, the fraction of its static compliance that remains.
    """
    modes = ~part.residual
    frequencies, added = part.frequencies[modes], int((~modes).sum())
    text = f"{several(frequencies.size, 'mode')} from {with_unit(float(frequencies.min()), 'Hz')} to "
    text += with_unit(float(frequencies.max()), "Hz") + (f" and {several(added, 'residual vector')}" if added else "")
    headline = Statement("part", f"{text} at {several(len(part.points), 'point')}.", tone="strong")
    sections = (
        Section("modes", "", lambda: [_modes_table(part, mass, modes)], "summary"),
        Section("checks", "", lambda: _checks(part, mass, whole or part, modes), "summary"),
    )
    return Content(title=f"{name}: flexible part", verdict=headline, sections=sections)


def _modes_table(part: FlexiblePart, mass: float | Array | None, modes: Booleans) -> Table:
    """Tabulate the modes of a flexible part with their effective masses along x, y and z, and the sum of these."""
    effective = part.participation**2
    names = [f"{number}" if mode else f"{number} residual" for number, mode in enumerate(modes, 1)]
    rows: list[list[Cell]] = [
        [name, float(frequency), float(damping), *map(float, row)]
        for name, frequency, damping, row in zip(names, part.frequencies, part.damping, effective, strict=True)
    ]
    rows.append(["all", None, None, *map(float, effective.sum(axis=0))])
    if mass is not None:
        size = with_unit(float(np.max(mass)), "kg")
        rows.append([f"of {size}", None, None, *(f"{100.0 * ratio:.1f} %" for ratio in _captured(effective.sum(axis=0), mass))])
    columns = (
        *left("mode"), Column("frequency", "Hz", "z.3f"), Column("damping", "%", "z.2f"),
        *(Column(f"mass\n{axis}", "kg", "z.2f") for axis in "xyz"),
    )  # fmt: skip
    note = "The square of the participation: what a motion of the base along the axis shakes in that mode."
    if not modes.all():
        note += " Residual vectors keep the static compliance of modes left out; their frequencies are no resonances."
    return Table("flexible-modes", "Modes and the mass that takes part", columns, rows, note=note)


def _captured(total: Array, mass: float | Array) -> Array:
    """Divide effective masses (3,) by the mass along each axis; 0 along axes without mass."""
    return np.divide(total, mass, out=np.zeros(3), where=np.broadcast_to(np.asarray(mass) > 1e-9 * np.max(mass), 3))


def _checks(part: FlexiblePart, mass: float | Array | None, whole: FlexiblePart, modes: Booleans) -> Iterator[Statement]:
    """Yield warnings about units, captured mass, static compliance, equal frequencies and shapes without motion."""

    def warning(name: str, text: str) -> Statement:
        return Statement(f"flexible-{name}", text, tone="unjudged")

    total = (part.participation**2).sum(axis=0)
    largest = float(total.max())
    if not total.any():
        yield warning("free", "No mode takes part in a motion of the base: right for equipment free in space, not for a deck.")
    elif not _LIGHTEST <= largest <= _HEAVIEST:
        yield warning("units", f"The modes bring along {with_unit(largest, 'kg')}: are the units those that --units says?")
    ratios = [_captured((shown.participation**2).sum(axis=0), mass) for shown in (part, whole)] if mass is not None else []
    for axis, ratio, of_whole in zip("xyz", *ratios, strict=True) if ratios else ():
        text = f"Along {axis} the modes bring along {100 * ratio:.1f} % of the mass,"
        if ratio > 1.0 + 1e-6:
            yield warning("mass", f"{text} more than there is.")
        elif 0.01 < ratio < CAPTURED and not modes.all() and of_whole >= CAPTURED:
            text = f"{text} and residual vectors carry the rest of what was read, {100 * (of_whole - ratio):.1f} %, statically."
            yield Statement("flexible-captured", text)
        elif 0.01 < ratio < CAPTURED:
            yield warning("captured", f"{text} less than {100 * CAPTURED:.0f} %: take more modes, or residual vectors.")
    missing = [
        (1.0 - float(kept / full), name, axis)
        for name in part.points
        for axis, kept, full in zip("xyz", part.compliance(name), whole.compliance(name), strict=True)
        if full > _COUNTED_COMPLIANCE * whole.compliance(name).max()
    ]
    deficit, point, axis = max(missing, default=(0.0, "", ""))
    if deficit > _MISSING_COMPLIANCE:
        text = f"At {point} along {axis} the modes have {100 * (1 - deficit):.1f} % of the static compliance of all modes read"
        yield warning("compliance", f"{text}, and no point has less: --residual keeps it, or take more modes.")
    if np.unique(np.round(part.frequencies, 9)).size < part.frequencies.size:
        yield warning("twice", "Two modes have one frequency: right where the part is symmetric; else one stands there twice.")
    if max(float(np.abs(shape).max(initial=0.0)) for shape in part.shapes.values()) == 0.0:
        yield warning("still", "No point moves in any mode: mounts there stand as on a rigid part.")
