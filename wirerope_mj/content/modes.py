"""Content on modes about the equilibrium: frequencies to quote, damping, shapes, and amplitudes beyond ratings or tests."""

import math
from collections.abc import Iterator, Sequence

from wirerope_mj.assessment.criteria.ddam import Direction, Location, Ship, ddam_design_values
from wirerope_mj.assessment.criteria.travel import untested
from wirerope_mj.content.blocks import Block, Content, Section, Statement
from wirerope_mj.content.judged_run import JudgedRun
from wirerope_mj.content.statics import HISTORIES, stability_blocks
from wirerope_mj.dynamics.modes import Modes
from wirerope_mj.dynamics.modes.carried import carried, deflection_range, travel_utilisation
from wirerope_mj.dynamics.modes.rest import SHARES, strain_energy
from wirerope_mj.engine.system import System
from wirerope_mj.foundation.errors import Absent
from wirerope_mj.foundation.tables import Cell, Column, Row, Table, left
from wirerope_mj.foundation.units import STANDARD_GRAVITY, in_unit
from wirerope_mj.mounts.isolator.parts import BELOW

TIPS = "tips over"  # in place of the frequency of a mode whose stiffness is negative under the weight
_SHIP_AXES: tuple[Direction, ...] = ("fore-and-aft", "athwartship", "vertical")
_LEAST_WEIGHT = 1e-3  # fraction of a mode's weight, up to which it does not move along an axis
_FREQUENCY, _DAMPING = Column("frequency", "Hz", "z.3f"), Column("damping", "%", "z.1f")
_MASS = [Column(f"mass\n{axis}", "%", "z.1f") for axis in "xyz"]
_MODE = *left("mode"), Column("shape", align="text")
_NOTE = (
    "Frequency and damping: of small amplitude, where friction damps nothing and dampers alone do. Tangent: with the mounts' "
    "stiffness in either direction from rest, which the first quarter cycle feels; no value to quote. Mass: fraction that "
    "takes part of the mass that can move along each axis."
)


def modes_content(
    system: System, small: Modes, large: Sequence[Modes] = (), *, ddam: tuple[Ship, Location] | None = None
) -> Content:
    """Compose the content of modes at small and larger amplitudes, and design accelerations by DDAM."""

    def at_small() -> Iterator[Block | None]:
        yield modes_table(small)
        yield energy_table(system, small)
        yield _frequency_advice(at_amplitudes=bool(large))
        yield from _statements("small-amplitude", about_small(system, small))
        yield from _statements("below-tests", below_tests(system))

    def at_large() -> Iterator[Block]:
        if large:
            yield amplitudes_table(small, large)
            yield from _statements("beyond-rating", beyond_rating(system, large), "exceeded")
            yield from _statements("outside-tests", outside_tests(system, large))
            yield from _statements("carried", about_carried(system, small, large), "")

    stability = list(stability_blocks({small.history: small.stability}))
    sections = (
        Section("modes", "", at_small, "summary"),
        Section("amplitudes", "", at_large, "summary"),
        Section("stability", "", lambda: stability, "summary"),
        Section("ddam", "", lambda: [_ddam_table(small, *ddam)] if ddam else [], "summary"),
    )
    return Content(title=f"{system.name}: modes", verdict=stability[0], sections=sections)


def run_modes_blocks(run: JudgedRun) -> Iterator[Block | None]:
    """Yield the small-amplitude modes of a run's system about its equilibria, and their stability."""
    computed = {history: modes for history, modes in run.modes.items() if isinstance(modes, Modes)}
    for history, modes in run.modes.items():
        if isinstance(modes, Absent):
            yield Statement(f"modes-{history}", modes.reason, tone="unjudged")
    for rank, modes in enumerate(computed.values(), start=1):
        yield modes_table(modes, note=_NOTE if rank == len(computed) else "")
        yield energy_table(run.system, modes)
    if computed:
        yield _frequency_advice(at_amplitudes=False)
        yield from _statements("below-tests", below_tests(run.system))
    yield from stability_blocks({history: modes.stability for history, modes in computed.items()})


def modes_table(modes: Modes, *, note: str = _NOTE) -> Table:
    """Tabulate frequency, damping, tangent frequencies and participating mass of every mode."""
    tangents = Column("tangent,\nunloading", "Hz", "z.3f"), Column("tangent,\nloading", "Hz", "z.3f")
    rows: list[Row] = []
    for number, shape in enumerate(modes.descriptions):
        frequencies = [_hertz_cell(values[number]) for values in (modes.unloading, modes.loading)]
        mass = map(float, modes.participation[number])
        damping = float(modes.damping_ratio[number])
        rows.append((str(number + 1), shape, _hertz_cell(modes.frequencies[number]), damping, *frequencies, *mass))
    return Table(
        f"modes-{modes.history}", f"Modes about the equilibrium {HISTORIES[modes.history]}",
        (*_MODE, _FREQUENCY, _DAMPING, *tangents, *_MASS), rows, note=note,
    )  # fmt: skip


def energy_table(system: System, modes: Modes) -> Table | None:
    """Tabulate the fractions of each mode's strain energy in mounts, deck and equipment; None if only mounts are elastic."""
    shares = strain_energy(system, modes)
    if shares is None:
        return None
    rows: list[Row] = [
        (str(number + 1), shape, _hertz_cell(modes.frequencies[number]), *map(float, shares[number]))
        for number, shape in enumerate(modes.descriptions)
    ]
    return Table(
        f"strain-energy-{modes.history}", "Where the strain energy sits",
        (*_MODE, _FREQUENCY, *(Column(name, "%", "z.1f") for name in SHARES)), rows,
        note="Mounts: with what weight and contacts do. Deck: what bends or is sprung between base and mounts. Most of it in "
        "the deck: the mode is the deck's own, and moves with the deck's frequency, hardly with the mounts.",
    )  # fmt: skip


def amplitudes_table(small: Modes, large: Sequence[Modes]) -> Table:
    """Tabulate frequency and damping of every mode at every amplitude."""
    results = [small, *large]
    indices = [small.indices_in(result) for result in results]
    rows: list[Row] = [
        (
            str(mode + 1), shape, "small" if result.amplitude is None else result.amplitude,
            _hertz_cell(result.frequencies[index[mode]]), float(result.damping_ratio[index[mode]]),
        )
        for mode, shape in enumerate(small.descriptions)
        for result, index in zip(results, indices, strict=True)
    ]  # fmt: skip
    return Table(
        "modes-at-amplitudes", "Natural frequency and damping by amplitude",
        (*_MODE, Column("amplitude", "mm", ".4g"), _FREQUENCY, _DAMPING), rows,
        note=f"Amplitude: of the mount that moves most, about the equilibrium {HISTORIES[small.history]}.",
    )  # fmt: skip


def mode_blocks(modes: Modes, mode: int) -> Iterator[Block]:
    """Yield frequency, damping, tangent frequencies, participating mass and mount deflections of a mode."""
    mass = ", ".join(f"{in_unit(part, '%'):z.1f} % {axis}" for part, axis in zip(modes.participation[mode], "xyz", strict=True))
    yield Statement(
        "mode", f"Small-amplitude natural frequency {_hertz_text(modes.frequencies[mode])}", tone="strong",
        items=(
            f"damping {in_unit(float(modes.damping_ratio[mode]), '%'):.1f} %",
            f"tangents at rest: unloading {_hertz_text(modes.unloading[mode])}, loading {_hertz_text(modes.loading[mode])}",
            f"mass that takes part: {mass}",
        ),
    )  # fmt: skip
    columns = [*left("mount"), *(Column(axis, form="+.3f") for axis in ("roll", "shear", "axial"))]
    rows: list[Row] = [(name, *map(float, shape[mode])) for name, shape in modes.mounts.items()]
    yield Table("mode-shape", "Deflections of the mounts, the largest 1", columns, rows)


def _statements(name: str, texts: Iterator[str], tone: str = "unjudged") -> Iterator[Statement]:
    return (Statement(name, text, tone=tone) for text in texts)


def _frequency_advice(*, at_amplitudes: bool) -> Statement:
    where = "listed below" if at_amplitudes else "which `wirerope modes --amplitude-mm` gives"
    return Statement(
        "which-frequency",
        "Quote the small-amplitude natural frequency for small vibration, and for a shock the frequency at the amplitude "
        f"reached, {where}: mounts soften, and harden towards the end of their travel.",
        tone="strong",
    )


def about_small(system: System, small: Modes) -> Iterator[str]:
    """Yield cautions about small-amplitude frequencies: not between those of the tangents, or of laws with exponent n < 1."""
    outside = small.outside_tangents
    if outside.size:
        which = f"{'modes' if outside.size > 1 else 'mode'} {', '.join(str(row + 1) for row in outside)}"
        yield (
            f"In {which} the small-amplitude natural frequency is not between those of the tangents: with gamma > beta, and "
            "with an elastic part that bends, both can lie to one side of it."
        )
    laws = [law for mount in system.mounts.values() for law in mount.isolator.axes.values()]
    if any(law.is_steep for law in laws if law is not None):
        yield (
            "A law with n < 1 is near the limit of small amplitude only at amplitudes that no rig shows: quote the frequency "
            "at an amplitude, which --amplitude-mm gives."
        )


def below_tests(system: System) -> Iterator[str]:
    """Yield a caution about isolators whose small-amplitude cycles lie below the tested amplitudes."""
    least = {
        f"{mount.isolator.name} {axis} ({in_unit(tested.amplitude[0], 'mm'):.3g} mm)": None
        for mount in system.mounts.values()
        for axis, tested in mount.isolator.validity.stated.items()
        if tested.amplitude[0] > 0.0
    }
    if least:
        yield (
            f"Small amplitudes lie below the least that isolators were tested at: {', '.join(least)}. Their frequencies and "
            f"damping are extrapolated and {BELOW}. Quote the frequency at the least tested amplitude (--amplitude-mm), or "
            "test smaller cycles."
        )


def beyond_rating(system: System, large: Sequence[Modes]) -> Iterator[str]:
    """Yield for each amplitude the mounts that it takes beyond their rated travel."""
    for result in large:
        beyond = {name: used for name in system.mounts if (used := travel_utilisation(system, result, name)) > 1.0}
        if beyond:
            worst = max(beyond, key=lambda name: beyond[name])
            yield (
                f"{_amplitude_text(result)} takes mounts beyond their rated travel: {', '.join(beyond)} ({worst} up to "
                f"{in_unit(beyond[worst], '%'):.0f} % of it, sag included). The law is not warranted there."
            )


def outside_tests(system: System, large: Sequence[Modes]) -> Iterator[str]:
    """Yield for each amplitude the mounts that it takes outside the tests of their laws."""
    isolators = {name: mount.isolator for name, mount in system.mounts.items()}
    for result in large:
        if where := untested(isolators, {name: deflection_range(result, name) for name in system.mounts}):
            tested = "outside the cycles that isolators were identified from"
            yield f"{_amplitude_text(result)} is {tested}: {where}. Their laws are extrapolated."


def about_carried(system: System, small: Modes, large: Sequence[Modes]) -> Iterator[str]:
    """Yield for each amplitude the modes whose mean position shifts until cycles carry the weight on average."""
    for result in large:
        lasting = carried(system, result)
        if not lasting.apart.size:
            continue
        rows = {index: row + 1 for row, index in enumerate(small.indices_in(result))}
        text = ", ".join(
            f"mode {rows[int(at)]} at {lasting.frequencies[at]:.3f} instead of {result.frequencies[at]:.3f} Hz "
            f"({lasting.mounts[at]} {in_unit(lasting.shift[at], 'mm'):.2g} mm away)"
            for at in lasting.apart
        )
        yield (
            f"Cycles of {_amplitude_text(result)} about the equilibrium do not carry the weight on average. In lasting "
            f"vibration the mounts move to where they do: {text}."
        )


def _ddam_table(small: Modes, ship: Ship, location: Location) -> Table:
    """Tabulate modal weights and design accelerations by mode and axis."""
    rows: list[Row] = []
    for number, frequency in enumerate(map(float, small.frequencies)):
        weights = STANDARD_GRAVITY * small.moving_mass * small.participation[number]
        cells: list[Cell] = [str(number + 1), _hertz_cell(frequency)]
        for weight, direction in zip(map(float, weights), _SHIP_AXES, strict=True):
            if not (frequency > 0.0 and weight > _LEAST_WEIGHT * weights.sum()):
                cells += [None, None]
                continue
            values = ddam_design_values(weight, frequency, location=location, direction=direction, ship=ship)
            cells += [values.weight, values.acceleration]
        rows.append(cells)
    axes = [column for axis in "xyz" for column in (Column(f"weight {axis}", "kN", ".3f"), Column(f"D {axis}", "g", ".1f"))]
    return Table(
        "ddam", f"DDAM: design accelerations, {ship}, {location}",
        (*left("mode"), _FREQUENCY, *axes), rows,
        note="x fore and aft, y athwartship, z vertical; modal weights at small amplitude. The unclassified interim values of "
        "NRL memorandum 1396, elastic, at least 6 g; a linear method, in which large deflections of mounts have no place.",
    )  # fmt: skip


def _amplitude_text(result: Modes) -> str:
    return f"{in_unit(result.amplitude or 0.0, 'mm'):g} mm"


def _hertz_cell(frequency: float) -> Cell:
    """Find the cell of a frequency [Hz]: "tips over" for NaN, of a mode whose stiffness is negative."""
    return float(frequency) if math.isfinite(frequency) else TIPS


def _hertz_text(frequency: float) -> str:
    return f"{frequency:.3f} Hz" if math.isfinite(frequency) else TIPS
