"""Cyclic tests of an isolator or a law: measures of its loops, the loops as charts, and the law that fits measured loops."""

import math
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass

import numpy as np

from wirerope_mj.content.blocks import BASE, LIMIT, Block, Chart, Content, Curve, Panel, Section, Statement
from wirerope_mj.content.isolator import law_text
from wirerope_mj.foundation.tables import Cell, Column, Table, left
from wirerope_mj.foundation.units import force_unit, in_unit
from wirerope_mj.mounts.identification.choice import LawComparison
from wirerope_mj.mounts.isolator import Isolator
from wirerope_mj.mounts.isolator.device import amplitudes_of, distinct_axes, largest_amplitude
from wirerope_mj.mounts.laws import Law, Loop
from wirerope_mj.mounts.laws.stop import largest_gap
from wirerope_mj.mounts.test_rig import cyclic_test, hardening_overlap, softening_to_hardening

FREQUENCY = 5.0  # Of the tests of an isolator [Hz]; without effect on a rate-independent law
_FRACTIONS = (0.25, 0.5, 1.0)  # of the rated travel
_UNRATED_TRAVEL = 0.002  # [m], for axes without rated travel: small for every mount
_MOST_NAMES = 8  # in a legend: more would hide the loops
_CLOSURE = 1e-10  # fraction of the force range to which loops of cyclic tests close
_LEAST_DAMPING = 1e-9  # damping ratio below which loops have no measurable width
_COLUMNS = (
    *left("axis"), Column("amplitude", "mm", ".4g"), Column("secant\nstiffness", "kN/m", ".4g"),
    Column("energy\nper cycle", "J", ".4g"), Column("damping\nratio", "%", ".4g"),
    Column("tangent\nafter largest", "kN/m", "z.4g"), Column("tangent\nafter smallest", "kN/m", "z.4g"),
    *left("cycles\nto close"),
)  # fmt: skip


@dataclass(frozen=True, kw_only=True)
class CyclicTests:
    """Cyclic tests of the axes of an isolator."""

    isolator: Isolator
    laws: Mapping[str, Law]  # of its axes, by their titles
    loops: Mapping[str, Sequence[Loop]]  # of each law, by the same titles
    operating_point: float  # deflection about which it was tested [m]
    frequency: float  # of the tests [Hz]


def loops_content(tests: CyclicTests) -> Content:
    """Compose the content of cyclic tests: laws, measures of each loop, findings over all loops, and a chart."""
    about = f", about {in_unit(tests.operating_point, 'mm'):.4g} mm" if tests.operating_point else ""
    rate = "" if all(law.rate_independent for law in tests.laws.values()) else f", at {tests.frequency:g} Hz"
    title = f"{tests.isolator.name}{about}{rate}"
    # In the titles of the panels, a rate-dependent law has the frequency.
    rates = {name: "" if law.rate_independent else f", {tests.frequency:g} Hz" for name, law in tests.laws.items()}
    titled = {f"{name}{rates[name]}": loops for name, loops in tests.loops.items()}
    return Content(
        title=title,
        verdict=Statement("tests", title),
        sections=(
            Section("tests", "", lambda: _test_blocks(tests), "summary"),
            Section("loops", "", lambda: [loops_chart(titled)]),
        ),
    )


def _test_blocks(tests: CyclicTests) -> Iterator[Block]:
    """Yield laws, measures of each loop, and findings over the amplitudes: hardening overlap, end of softening."""
    lines = []
    for title, law in tests.laws.items():
        lines.append(f"{title}: {law_text(law)}")
        if (form := law.normal_form) is not None:
            lines.append(
                f"{title}, normalised: z_max = {form.z_max:.6g} N, x_y = {in_unit(form.x_y, 'mm'):.6g} mm, "
                f"sigma = {form.sigma:.6g}, n = {form.n:.6g}"
            )
    yield Statement("laws", items=tuple(lines))
    rows: list[list[Cell]] = []
    for title, loops in tests.loops.items():
        for loop in loops:  # a rate-dependent force turns round smoothly and has no tangent to state
            tangents = loop.tangents_at_reversal if tests.laws[title].rate_independent else (None, None)
            closed = f"{loop.cycles}" if loop.closure <= _CLOSURE else f"{loop.cycles}, open by {loop.closure:.1g}"
            measures = loop.amplitude, loop.secant_stiffness, loop.dissipated_energy, loop.damping_ratio
            rows.append([title, *measures, *tangents, closed])
    note = "Tangent: stiffness right after the largest and the smallest deflection, where the motion turns round."
    yield Table("loop-measures", "Measures of the loops", _COLUMNS, rows, note=note)
    findings = []
    for title, loops in tests.loops.items():
        amplitudes = {loop.amplitude for loop in loops}
        if len(amplitudes) >= 2 and max(loop.damping_ratio for loop in loops) > _LEAST_DAMPING:
            try:
                overlap = f"{hardening_overlap(loops):.3f} (0: all amplitudes load along one path in tension)"
                findings.append(f"{title}: hardening overlap {overlap}")
            except ValueError as error:
                findings.append(f"{title}: no hardening overlap: {error}")
        if len(amplitudes) >= 3:
            findings.append(f"{title}: {softening_to_hardening(loops).message}")
    yield Statement("loop-findings", items=tuple(findings))


def loops_chart(tests: Mapping[str, Sequence[Loop]]) -> Chart:
    panels = []
    for title, loops in tests.items():
        unit = force_unit(max(float(np.abs(loop.force).max()) for loop in loops))
        ordered = sorted(loops, key=lambda loop: loop.amplitude)
        panels.append(_panel(_curves(ordered, unit), title, unit))
    return _chart(panels, "Force over deflection in cyclic tests.")


def measures_table(device: Isolator) -> Table:
    """Tabulate measures of steady loops at 25, 50 and 100 % of the rated travel, or of 2 mm beyond the gap if unrated."""
    rows: list[list[Cell]] = []
    for axis, law in device.axes.items():
        if law is None:
            continue
        rated = max((travel for travel in device.rated_travel(axis) if travel is not None), default=None)
        for fraction in _FRACTIONS:
            largest = largest_gap(law) + fraction * _UNRATED_TRAVEL if rated is None else fraction * rated
            amplitude = min(largest, fraction * law.finite_travel)
            loop = cyclic_test(law, amplitude, frequency=FREQUENCY)[0]
            utilisation = None if rated is None else amplitude / rated
            rows.append([axis, amplitude, utilisation, loop.secant_stiffness, loop.dissipated_energy, loop.damping_ratio])
    columns = (
        *left("axis"), Column("amplitude", "mm", ".3g"), Column("of rated", "%", ".0f"),
        Column("secant\nstiffness", "kN/m", ".4g"), Column("energy\nper cycle", "J", ".4g"),
        Column("damping\nratio", "%", ".4g"),
    )  # fmt: skip
    return Table("measures", "Steady loops about zero", columns, rows)


def isolator_chart(device: Isolator) -> Chart:
    """Draw for each axis steady loops at 25, 50 and 100 % of the rated travel, first loading, and the ratings.

    Without a rated travel the largest loop is 5 % of the height, beyond the gap of a stop, or the whole of a table. Axes that
    share their law share a panel.
    """
    panels = []
    for title, axis, law in distinct_axes(device):
        loops = cyclic_test(law, amplitudes_of(device, axis, _FRACTIONS), frequency=FREQUENCY)
        curves = [*_rating_curves(device, axis, law), *_curves(loops, "kN")]
        panels.append(_panel(curves, title if law.rate_independent else f"{title}, {FREQUENCY:g} Hz", "kN"))
    return _chart(panels, "Steady loops, the first loading, the rated travel on it and the rated static load.")


def _chart(panels: Sequence[Panel], caption: str) -> Chart:
    return Chart(id="loops", rows=[panels], height=360.0, caption=caption, alt="Loops of force over deflection.")


def _panel(curves: Sequence[Curve], title: str, unit: str) -> Panel:
    return Panel(
        curves, xlabel="deflection [mm], tension positive" if title.startswith("axial") else "deflection [mm]",
        ylabel=f"force [{unit}]", title=title, unit=unit, xunit="mm",
    )  # fmt: skip


def _curves(loops: Sequence[Loop], unit: str) -> list[Curve]:
    """Draw loops in rising opacity, at most `_MOST_NAMES` of them with a name in the legend."""
    named = set(np.linspace(0, len(loops) - 1, min(len(loops), _MOST_NAMES)).round().astype(int))
    shades = np.linspace(0.45, 1.0, len(loops)) if len(loops) > 1 else [1.0]
    curves = []
    for number, (loop, shade) in enumerate(zip(loops, shades, strict=True)):
        ratio, amplitude = loop.damping_ratio, in_unit(loop.amplitude, "mm")
        size = f"±{amplitude:.3g} mm" if amplitude < 1000.0 else f"±{amplitude:.0f} mm"
        name = f"{size}, within the gap" if math.isnan(ratio) else f"{size}, ζ = {in_unit(ratio, '%'):.1f} %"
        x, y = in_unit(loop.deflection, "mm"), in_unit(loop.force, unit)
        curves.append(Curve(x, y, name=name if number in named else "", kind=0, opacity=float(shade)))
    return curves


def _rating_curves(device: Isolator, axis: str, law: Law) -> Iterator[Curve]:
    """Yield marks of rated load and rated travel on the curve of the first loading, and that curve."""
    travel = device.rated_travel(axis)
    compression, load = travel[0], device.limits.static_load
    if axis == "axial" and load is not None and compression is not None:
        path = law.trace(-np.linspace(0.0, compression, 2001))
        if -path.force[-1] >= load:  # the first loading carries it within the rated travel
            depth = float(np.interp(load, -path.force, -path.deflection))
            yield _mark(-depth, -load, f"rated load {in_unit(load, 'kN'):.3g} kN", BASE)
    if not law.rate_independent:
        return
    for sign, limit in zip((-1.0, 1.0), travel, strict=True):
        if limit is not None:
            end = law.trace([0.0, sign * limit])
            yield _mark(float(end.deflection[-1]), float(end.force[-1]), "rated travel", LIMIT)
    for sign in (-1.0, 1.0):
        path = law.trace(sign * np.linspace(0.0, largest_amplitude(device, axis), 200))
        x, y = in_unit(path.deflection, "mm"), in_unit(path.force, "kN")
        yield Curve(x, y, name="first loading", kind=BASE, dash="dashed")


def _mark(deflection: float, force: float, name: str, kind: str) -> Curve:
    x, y = np.array([in_unit(deflection, "mm")]), np.array([in_unit(force, "kN")])
    return Curve(x, y, name=name, kind=kind, marks=True, weight=2.0)


def law_choice_statement(table: LawComparison, files: str) -> Statement:
    """State the recommended law, the range of its tests, and the command that fits it."""
    best, general, chosen = table.best, table.most_general, table.recommended
    items = [f"{best.law} has the best criterion, {general.law} the smallest error on an amplitude left out."]
    if chosen is not general:
        items.append(
            f"{chosen.law} has no error on an amplitude left out, for which there are too few, but errs by at most "
            f"{in_unit(float(chosen.errors.max()), '%'):.2g} % where {general.law} errs by "
            f"{in_unit(float(general.errors.max()), '%'):.2g} %: test one amplitude more to see how it predicts."
        )
    farthest = in_unit(float(table.amplitudes[-1]), "mm")
    items.append(f"Errors are those of cycles up to ±{farthest:.3g} mm; of larger ones they say nothing.")
    items.append(f"wirerope identify {files} --law {chosen.law} --out isolator.toml")
    return Statement("law-choice", f"Recommended: {chosen.law}.", items=tuple(items), tone="strong")
