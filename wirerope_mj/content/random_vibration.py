"""Blocks on random vibration of the base: transmissibility, isolation frequency, and rms by octave band, in and out."""

import math
from collections.abc import Iterator
from dataclasses import replace

import numpy as np

from wirerope_mj.assessment.criteria.sampled import steady_interval
from wirerope_mj.content.blocks import Block, Chart, Curve, Panel, Statement, short
from wirerope_mj.content.judged_run import JudgedRun
from wirerope_mj.content.numbers import fixed, with_unit
from wirerope_mj.content.run_spectra import BASE
from wirerope_mj.content.selection import kind_of
from wirerope_mj.content.spectrum_charts import rms_along, spectrum_panel
from wirerope_mj.engine.simulation.run import aliasing
from wirerope_mj.foundation.arrays import Array
from wirerope_mj.foundation.tables import Cell, Column, Row, Table, left
from wirerope_mj.motions import RandomVibration
from wirerope_mj.motions.spectra.psd import PowerSpectralDensity, isolation_frequency

_MIDDLE = 1000.0  # frequency of the octave band that all others are counted from [Hz]
_LINES = 2  # of the density in a band, at the least


def transmissibility_of(
    base: PowerSpectralDensity, body: PowerSpectralDensity, band: tuple[float, float]
) -> tuple[Array, Array]:
    """Compute the root of the ratio of two densities in a band [Hz] of the base's: frequencies [Hz] and ratios, (n,)."""
    rows = np.flatnonzero((base.frequency >= band[0]) & (base.frequency <= band[1]) & (base.density > 0.0))
    return base.frequency[rows], np.sqrt(body.density[rows] / base.density[rows])


def _band(run: JudgedRun) -> tuple[float, float]:
    """Find the lowest and the highest frequency at which the base vibrates [Hz]."""
    points = [part.psd for part in run.motion.parts if isinstance(part, RandomVibration)]
    return min(psd[0][0] for psd in points), max(psd[-1][0] for psd in points)


def random_blocks(run: JudgedRun) -> Iterator[Block]:
    """Yield transmissibility and octave-band rms of a random vibration; nothing for other motions, or if not stationary."""
    if not steady_interval(run.response.motion)[0]:  # before the spectra, which take time, are computed
        return
    if aliased := aliasing([run.motion], run.sample_rate):
        yield Statement(
            "isolation", f"Random vibration: no transmissibility and no bands are stated; {aliased}", tone="unjudged"
        )
        return
    rows: list[Row] = []
    panels: list[Panel] = []
    best: tuple[float, str] = (-math.inf, "")
    for axis, along in run.spectra.densities.items():
        curves = []
        for name, density in along.items():
            if name == BASE:
                continue
            frequency, ratio = transmissibility_of(along[BASE], density, _band(run))
            top, isolation = int(ratio.argmax()), isolation_frequency(frequency, ratio)
            into, out = rms_along(run, BASE, axis), rms_along(run, name, axis)
            rows.append(
                (name, axis, into, out, out / into if into else math.nan, float(ratio[top]), float(frequency[top]), isolation)
            )
            curves.append(Curve(frequency, ratio, name=short(name), kind=kind_of(run.selection, name)))
            within = "isolates throughout the base's band" if ratio[top] < 1.0 else "does not isolate within the base's band"
            from_on = f"isolates from {with_unit(isolation, 'Hz')} on" if math.isfinite(isolation) else within
            text = f"{name} along {axis} {from_on}, transmissibility {fixed(float(ratio[top]), 1)} at "
            text += f"{with_unit(float(frequency[top]), 'Hz')}, rms {with_unit(into, 'g')} in and {with_unit(out, 'g')} out"
            best = max(best, (out, text))
        drawn = spectrum_panel(curves, "" if panels else "transmissibility", "", title=f"along {axis}")
        panels.append(replace(drawn, limits=[("", 1.0)]))
    if not rows:
        return
    yield Statement("isolation", f"Random vibration: {best[1]}.")
    columns = (
        *left("where", "axis"), Column("rms in", "g"), Column("rms out", "g"), Column("out / in", form="z.2f"),
        Column("largest\ntransmissibility", form="z.2f"), Column("at", "Hz"), Column("isolates\nfrom", "Hz"),
    )  # fmt: skip
    yield Table(
        "transmissibility", "Transmissibility under random vibration", columns, rows,
        note="Transmissibility: root of the ratio of the densities of payload and base along the axis; it isolates from where "
        "the ratio falls below 1 and stays there, up to the highest frequency of the base, interpolated between lines that are "
        f"{with_unit(next(iter(run.spectra.densities.values()))[BASE].resolution, 'Hz')} apart.",
    )  # fmt: skip
    yield _bands(run)
    yield Chart(
        id="random-transmissibility", rows=[panels], height=190.0,
        caption="Transmissibility: root of the ratio of the power spectral densities of payload and base.",
        alt="Transmissibility over frequency.",
    )  # fmt: skip


def _bands(run: JudgedRun) -> Table:
    """Tabulate rms accelerations of base and payload by octave band."""
    rows: list[Row] = []
    names = [name for name in next(iter(run.spectra.densities.values())) if name != BASE]
    for axis, along in run.spectra.densities.items():
        first, last = (round(math.log2(end / _MIDDLE)) for end in _band(run))
        for octave in range(first, last + 1):
            middle = _MIDDLE * 2.0**octave
            low, high = middle / math.sqrt(2.0), middle * math.sqrt(2.0)
            if high - low < _LINES * along[BASE].resolution:
                continue
            into = float(along[BASE].rms_between(low, high))
            outs = [float(along[name].rms_between(low, high)) for name in names]
            cells: list[Cell] = [cell for out in outs for cell in (out, out / into if into else None)]
            rows.append((axis, middle, into, *cells))
    columns = [*left("axis"), Column("octave", "Hz"), Column("base", "g")]
    for name in names:
        columns += [Column(name, "g"), Column("out / in", form="z.2f")]
    return Table(
        "octave-bands", "Rms accelerations by octave band", columns, rows,
        note="Bands by their middle, from it over the root of 2 to it times the root of 2; resolution of the densities "
        f"{with_unit(next(iter(run.spectra.densities.values()))[BASE].resolution, 'Hz')}.",
    )  # fmt: skip
