"""What a flexible part is: its modes, the mass that takes part in each, and what is perhaps not meant."""

from collections.abc import Iterator

import numpy as np

from wirerope_mj.content.blocks import Content, Section, Statement
from wirerope_mj.content.numbers import several, with_unit
from wirerope_mj.engine.flexible import FlexiblePart
from wirerope_mj.foundation.arrays import Array, Booleans
from wirerope_mj.foundation.tables import Cell, Column, Table, left

CAPTURED = 0.9  # of the mass along an axis below which omitted modes matter, as in seismic rules
# Fraction of a point's static compliance that may be missing, and of its largest one that an axis has to count.
_SOFTER, _STIFF = 0.01, 0.01
# Effective mass that decks and machines have [kg]; beyond it units are perhaps other ones.
_LIGHTEST, _HEAVIEST = 1.0, 1e6


def flexible_content(
    name: str, part: FlexiblePart, *, mass: float | Array | None = None, whole: FlexiblePart | None = None
) -> Content:
    """Describe a flexible part.

    With its mass [kg], perhaps along x, y, z, how much of it the modes bring along; with the `whole` part, of which modes were
    left out, how much of its static compliance is left.
    """
    modes = ~part.residual
    frequencies, added = part.frequencies[modes], int((~modes).sum())
    text = f"{several(frequencies.size, 'mode')} from {with_unit(float(frequencies.min()), 'Hz')} to "
    text += with_unit(float(frequencies.max()), "Hz") + (f" and {several(added, 'residual vector')}" if added else "")
    headline = Statement("part", f"{text} at {several(len(part.points), 'point')}.", tone="strong")
    sections = (
        Section("modes", "", lambda: [_table(part, mass, modes)], "summary"),
        Section("checks", "", lambda: _checks(part, mass, whole or part, modes), "summary"),
    )
    return Content(title=f"{name}: flexible part", verdict=headline, sections=sections)


def _table(part: FlexiblePart, mass: float | Array | None, modes: Booleans) -> Table:
    effective = part.participation**2
    names = [f"{number}" if mode else f"{number} residual" for number, mode in enumerate(modes, 1)]
    rows: list[list[Cell]] = [
        [name, float(frequency), float(damping), *map(float, row)]
        for name, frequency, damping, row in zip(names, part.frequencies, part.damping, effective, strict=True)
    ]
    rows.append(["all", None, None, *map(float, effective.sum(axis=0))])
    if mass is not None:
        size = with_unit(float(np.max(mass)), "kg")
        rows.append([f"of {size}", None, None, *(f"{100.0 * c:.1f} %" for c in _ratios(effective.sum(axis=0), mass))])
    columns = (
        *left("mode"), Column("frequency", "Hz", "z.3f"), Column("damping", "%", "z.2f"),
        *(Column(f"mass\n{axis}", "kg", "z.2f") for axis in "xyz"),
    )  # fmt: skip
    note = "The square of the participation: what a motion of the base along the axis shakes in that mode."
    if not modes.all():
        note += " Residual vectors keep the static compliance of modes left out; their frequencies are no resonances."
    return Table("flexible-modes", "Modes and the mass that takes part", columns, rows, note=note)


def _ratios(total: Array, mass: float | Array) -> Array:
    return np.divide(total, mass, out=np.zeros(3), where=np.broadcast_to(np.asarray(mass) > 1e-9 * np.max(mass), 3))


def _checks(part: FlexiblePart, mass: float | Array | None, whole: FlexiblePart, modes: Booleans) -> Iterator[Statement]:

    def warning(name: str, text: str) -> Statement:
        return Statement(f"flexible-{name}", text, tone="unjudged")

    total = (part.participation**2).sum(axis=0)
    largest = float(total.max())
    if not total.any():
        yield warning("free", "No mode takes part in a motion of the base: right for equipment free in space, not for a deck.")
    elif not _LIGHTEST <= largest <= _HEAVIEST:
        yield warning("units", f"The modes bring along {with_unit(largest, 'kg')}: are the units those that --units says?")
    ratios = [_ratios((shown.participation**2).sum(axis=0), mass) for shown in (part, whole)] if mass is not None else []
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
        if full > _STIFF * whole.compliance(name).max()
    ]
    lacks, point, axis = max(missing, default=(0.0, "", ""))
    if lacks > _SOFTER:
        text = f"At {point} along {axis} the modes have {100 * (1 - lacks):.1f} % of the static compliance of all modes read"
        yield warning("compliance", f"{text}, and no point has less: --residual keeps it, or take more modes.")
    if np.unique(np.round(part.frequencies, 9)).size < part.frequencies.size:
        yield warning("twice", "Two modes have one frequency: right where the part is symmetric; else one stands there twice.")
    if max(float(np.abs(shape).max(initial=0.0)) for shape in part.shapes.values()) == 0.0:
        yield warning("still", "No point moves in any mode: mounts there stand as on a rigid part.")
