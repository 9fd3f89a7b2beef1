"""The deck: loads on it and on its bolts, and what a rigid one leaves out, the peaks of a run on decks that bend."""

import math
from collections.abc import Iterator, Sequence

from wirerope_mj.assessment.criteria.foundation import AreaForce, area_forces, bolt_loads, standing
from wirerope_mj.assessment.criteria.verdict import payload_bodies
from wirerope_mj.content.blocks import Block, Statement
from wirerope_mj.content.judged_run import JudgedRun
from wirerope_mj.content.model import mounts_and_stops
from wirerope_mj.content.numbers import with_unit
from wirerope_mj.engine.flexible import Panel
from wirerope_mj.engine.flexible.panel import NAME
from wirerope_mj.engine.response.peaks import Peaks
from wirerope_mj.engine.simulation.batch import peaks_on_decks
from wirerope_mj.engine.statics.payloads import payloads_of
from wirerope_mj.foundation.errors import WireRopeError
from wirerope_mj.foundation.tables import Cell, Column, Mark, Row, Table

DECKS = (8.0, 12.0, 18.0, 25.0)  # natural frequencies of decks and platforms between frames [Hz]
DAMPING = 0.04
HEAVIER = 2.0  # mass of the panel over that of what it carries: a field of deck between frames, as a survey finds it
LONGEST = 10.0  # simulated time above which four more runs take longer than a page may [s]
MOVES = 1.1  # factor from which a peak is said to move
_FLAT = 1e-9  # acceleration along z below which the base does not move along it [m/s^2]
_BOLTS = 10  # bolts that are shown at once


def decks_blocks(run: JudgedRun) -> Iterator[Block]:
    """Yield how the governing peaks move on decks of four frequencies, or that this was not looked at, and why."""
    if not run.response.scene.mounts:
        return
    if run.system.assembly.subjects.modes or any(body.name == NAME for body in run.response.scene.bodies):
        return  # it bends already
    why = _why_not(run)
    if not why:
        try:
            mass = HEAVIER * sum(payload.mass for payload in payloads_of(run.system))
            found = _on_decks(run, mass)
        except (WireRopeError, ValueError) as error:
            why = str(error).rstrip(".")
        else:
            yield _table(found, mass)
            yield _sentence(found)
            return
    yield Statement(
        id="decks",
        text=f"The deck is rigid here; one that bends was not looked at: {why}. "
        '--deck "10 Hz 800 kg 4 %" puts the model on one.',
        tone="unjudged",
    )


def _why_not(run: JudgedRun) -> str:
    """Return why decks are not looked at where a page is made, "" if they are."""
    response = run.response
    if not run.system.base:
        return "the base is fixed in the world"
    if run.motion.velocity_jumps:
        return "the base's velocity jumps"
    if response.numerics.engine != "kernel":
        return "MuJoCo computed the run, which takes longer"
    if response.time[-1] - response.time[0] > LONGEST:
        return f"the run is longer than {LONGEST:g} s"
    if float(abs(response.base.acceleration[:, 2]).max(initial=0.0)) < _FLAT:
        return "the base does not move along z"
    return ""


# Name and size of the payload's largest acceleration [m/s^2], and of the mounts' largest deflection [m]
Governing = tuple[tuple[str, float], tuple[str, float]]


def _on_decks(run: JudgedRun, mass: float) -> dict[str, Governing | str]:
    """Return what governs on the rigid deck and on each panel, or why there is nothing."""
    panels = [Panel(frequency=frequency, mass=mass, damping=DAMPING) for frequency in DECKS]
    step, duration = run.response.numerics.timestep, float(run.response.time[-1])
    found = peaks_on_decks(
        run.system, run.motion, panels, duration=duration, timestep=step,
        initial=str(run.inputs.get("simulate", {}).get("initial", "settled")), sample_rate=run.sample_rate,
    )  # fmt: skip
    decks: dict[str, Governing | str] = {"rigid": _governing(run, run.response.peaks)}
    for panel, peaks in zip(panels, found, strict=True):
        decks[with_unit(panel.frequency, "Hz")] = peaks if isinstance(peaks, str) else _governing(run, peaks)
    return decks


def _governing(run: JudgedRun, peaks: Peaks) -> Governing:
    accelerations = {name: peaks.bodies[name].acceleration.value for name in payload_bodies(run.response)}
    accelerations |= {name: one.acceleration.value for name, one in peaks.points.items()}
    deflections = {mount.name: peaks.mounts[mount.name].deflection.value for mount in run.response.scene.isolating}
    first, second = (max(values.items(), key=lambda item: item[1]) for values in (accelerations, deflections))
    return first, second


def _factors(deck: Governing, rigid: Governing) -> list[float]:
    return [here / there if there > 0.0 else math.nan for (_, here), (_, there) in zip(deck, rigid, strict=True)]


def _table(found: dict[str, Governing | str], mass: float) -> Table:
    rigid = found["rigid"]
    assert not isinstance(rigid, str)
    rows: list[Row] = []
    for name, deck in found.items():
        if isinstance(deck, str):
            rows.append((name, None, deck, None, None, "", None))
            continue
        cells: list[Cell] = [name]
        for (subject, value), factor in zip(deck, _factors(deck, rigid), strict=True):
            cells += [value, subject, Mark(factor, "near" if factor > MOVES else "")]
        rows.append(cells)
    columns = (
        Column("deck", align="left"), Column("largest\nacceleration", "g", "z.2f"), Column("of", align="left"),
        Column("of that on\na rigid deck", "%", "z.0f"), Column("largest\ndeflection", "mm", "z.1f"),
        Column("of", align="left"), Column("of that on\na rigid deck", "%", "z.0f"),
    )  # fmt: skip
    note = (
        f"A guided panel of {with_unit(mass, 'kg')}, twice what it carries, with {with_unit(DAMPING, '%')} of damping under "
        "all mounts, tuned alone to each frequency along z. Your own deck: --deck with frequency, mass and damping, or the "
        "folder of its modes."
    )
    return Table(id="decks", title="The same on decks that bend", columns=columns, rows=rows, note=note)


def _sentence(found: dict[str, Governing | str]) -> Statement:
    """Say how much the governing peaks move at most."""
    rigid = found["rigid"]
    assert not isinstance(rigid, str)
    factors = {name: max(_factors(deck, rigid)) for name, deck in found.items() if not isinstance(deck, str)}
    worst = max(factors, key=lambda name: factors[name])
    moves = factors[worst] > MOVES
    text = (
        f"On a deck of {worst} a governing peak grows to {100.0 * factors[worst]:.0f} % of that on the rigid one: find out how "
        "stiff the deck is."
        if moves
        else "On none of these decks a governing peak grows by more than a tenth."
    )
    return Statement(id="decks-answer", text=text, tone="unjudged" if moves else "", values={"largest_factor": factors[worst]})


def deck_blocks(run: JudgedRun) -> Iterator[Block]:
    """Yield the forces on the deck, all and on each area that the model names, and those on bolts."""
    if not run.response.scene.mounts:
        return
    areas = area_forces(run.response)
    yield _areas(areas) if len(areas) > 1 else _whole(run, areas[0])
    bolts = _bolts(run)
    if bolts.rows:
        yield bolts


def _whole(run: JudgedRun, whole: AreaForce) -> Statement:
    sizes = [
        f"{with_unit(force, 'kN', digits=3)} {where} at {time:.4f} s"
        for force, where, time in (
            (whole.down, "downwards", whole.down_time), (whole.up, "upwards", whole.up_time),
            (whole.across, "horizontally", whole.across_time),
        )
    ]  # fmt: skip
    count = mounts_and_stops(standing(run.response.scene))
    text = (
        f"Load of {count} together, weight included: {with_unit(whole.at_rest, 'kN', digits=3)} at the beginning; "
        f"at most {', '.join(sizes)}. Contacts of geoms are not among them."
    )
    return Statement(id="deck", text=text)


def _areas(areas: Sequence[AreaForce]) -> Table:
    columns = (
        Column("mounts on", align="left"), Column("mounts\nand stops", form="d"), Column("at rest", "kN", 3),
        Column("down", "kN", 3), Column("at", "s", "z.4f"), Column("up", "kN", 3), Column("at", "s", "z.4f"),
        Column("horizontally", "kN", 3), Column("at", "s", "z.4f"),
    )  # fmt: skip
    rows = [
        (one.name or "the whole deck", one.mounts, one.at_rest, one.down, one.down_time, one.up, one.up_time, one.across,
         one.across_time)
        for one in areas
    ]  # fmt: skip
    return Table(
        id="deck", title="Sums of the mounts' forces on what carries them", columns=columns, rows=rows,
        note="At the samples, weight included, in the world's axes: downwards, upwards where the mounts pull, horizontally. "
        "Contacts of geoms are not among them.",
    )  # fmt: skip


def _bolts(run: JudgedRun) -> Table:
    columns = (
        Column("mount", align="left"), Column("bolts", form="d"), Column("tension of one", "kN", 3), Column("at", "s", "z.4f"),
        Column("shear of one", "kN", 3), Column("at", "s", "z.4f"),
    )  # fmt: skip
    rows = [
        (one.mount, one.bolts, one.tension, one.tension_time, one.shear, one.shear_time) for one in bolt_loads(run.response)
    ]
    return Table(
        id="bolts", title="Largest loads of a bolt on the base side", columns=columns, rows=rows,
        note="A rigid plate, the force across acting at half the isolator's height; without prying and preload.",
        shown=_BOLTS,
    )  # fmt: skip
