"""Content of an identification: the law and its parameters, their uncertainty, and measured and fitted loops."""

import math
from collections.abc import Callable, Iterator, Sequence
from importlib.metadata import version

import numpy as np

from wirerope_mj.content.blocks import MEASURED, MODEL, OTHERS, Block, Chart, Content, Curve, Panel, Section, Statement
from wirerope_mj.content.numbers import several
from wirerope_mj.content.selection import COLOURS
from wirerope_mj.foundation.tables import Cell, Column, Mark, Table, left
from wirerope_mj.foundation.units import force_unit, in_unit
from wirerope_mj.mounts.identification.result import FittedLoop, Identification, neighbours_correlation

_CORRELATED = 0.5  # correlation of neighbouring residuals, which white noise of a hundred samples never has
_LARGEST_ERROR = 100.0  # relative standard error above which it is not shown


def identification_content(
    result: Identification, fits: Sequence[FittedLoop], *, title: str, sources: Sequence[str], warnings: Sequence[str],
    given: Sequence[str],
) -> Content:  # fmt: skip
    """Compose the content of an identification: findings, parameters, measured and fitted loops, and warnings.

    `sources` are the files that were read, `warnings` of the records, `given` what was not searched for.
    """
    fitted = f"{several(len(fits), 'loop')} of {several(len(sources), 'file')}"
    values = {"error": result.residual, "neighbours_correlation": neighbours_correlation(fits)}
    if result.converged:
        reasons = [f"the records give {several(len(warnings), 'warning')}"] if warnings else []
        reasons += ["the law does not follow the loops everywhere"] if values["neighbours_correlation"] > _CORRELATED else []
        reasons += ["not every parameter is identifiable"] if result.non_identifiable else []
        reasons += [_insignificant(result.insignificant)] if result.insignificant else []
        text = f"Converged, but {'; '.join(reasons)}." if reasons else "Converged; the data identify every free parameter."
        tone = "unjudged" if reasons else "within"
    else:
        text, tone = f"NOT CONVERGED: {result.message}", "exceeded"
    return Content(
        title=title, facts=(("Loops", str(len(fits))), ("By", f"wirerope-mj {version('wirerope-mj')}")),
        question=("Which parameters of the law follow the measured loops, and how well are they known?",),
        verdict=Statement("headline", text, tone=tone, values=values),
        sections=(
            Section("brief", "", lambda: [Statement("fitted", f"{title}, {fitted}")], "headline"),
            Section(
                "answer", "", lambda: (fit_chart(fits), _findings(result, fits, given), record_warnings(warnings)), "headline"
            ),
            Section("parameters", "Parameters", lambda: _parameter_blocks(result), "summary"),
            Section(
                "loops-and-residuals", "Loops and residuals",
                lambda: (_loop_table(fits), residual_chart(fits), measures_chart(fits)), "summary",
            ),
            Section("search", "Search", lambda: _stages(result), "summary"),
            Section("how-well-the-parameters-are-known", "How well the parameters are known", lambda: _uncertainty(result)),
            Section("read-from", "Read from", lambda: (Statement("sources", items=tuple(sources)),)),
        ),
    )  # fmt: skip


def _insignificant(names: Sequence[str]) -> str:
    verb, them = ("are", "them") if len(names) > 1 else ("is", "it")
    return f"{', '.join(names)} {verb} not significant; consider dropping {them}"


def _findings(result: Identification, fits: Sequence[FittedLoop], given: Sequence[str]) -> Statement:
    """List the fit's message, what is not identifiable or significant, where laws hold, and whether residuals are noise."""
    texts = [f"{'converged' if result.converged else 'NOT CONVERGED'}: {result.message}"]
    texts += [f"yield deflections: {result.yields}"] if result.scales else []
    texts += [f"not identifiable: {text}" for text in result.non_identifiable]
    if not result.non_identifiable:
        texts.append("the data identify every free parameter")
    if result.insignificant:
        texts.append(f"{_insignificant(result.insignificant)}.")
    texts += [result.validity, *filter(None, [result.prediction])]
    if result.falling:
        texts.append(f"{result.falling}: a shock that goes there has no answer; test larger amplitudes, or take another law")
    if (correlation := neighbours_correlation(fits)) > _CORRELATED:
        texts.append(
            f"what is left is no white noise (neighbouring residuals correlate by {correlation:.2f}): standard errors count it "
            "as noise so correlated; where this law does not follow the loops, as residuals in the report show, they say "
            "nothing of what it lacks"
        )
    texts.append(
        f"error over all loops {100.0 * result.residual:.3g} % of half their force range; {result.evaluations} evaluations "
        "from all starts"
    )
    return Statement("findings", items=(*texts, *given))


def record_warnings(warnings: Sequence[str]) -> Statement | None:
    """List the faults of the rig that the records show; None without faults."""
    text = "Warnings about the records:"
    return Statement("warnings", text, items=tuple(warnings), tone="unjudged") if warnings else None


def _parameter_blocks(result: Identification) -> Iterator[Block]:
    """Yield the law as in an isolator file, and parameters with standard errors, scales and meanings."""
    # Laws and their own parameters as in an isolator file, with units; the last law was searched for.
    prefixes = [f"{name} scale, " for name in result.scales] or ["", *["and "] * (len(result.law.components) - 1)]
    laws = []
    for prefix, law in zip(prefixes, result.law.components, strict=True):
        values, texts = law.to_dict(), []
        for name, value in values.items():
            if name != "law":
                fitted = result.parameters.get(name) if law is result.law.components[-1] else None
                unit = fitted.unit if fitted else law.units().get(name, "-")
                number = f"[{', '.join(f'{part:.6g}' for part in value)}]" if isinstance(value, list) else f"{value:.6g}"
                texts.append(f"{name} = {number} {unit}".removesuffix(" -"))
        laws.append(f"{prefix}{values['law']}: {', '.join(texts)}")
    yield Statement("law", items=tuple(laws))
    rows: list[list[Cell]] = []
    for p in result.parameters.values():
        note: Cell = "given" if p.fixed else "at its bound" if p.at_bound else ""
        error: list[Cell] = [None, None]
        if not p.fixed:
            known = math.isfinite(p.standard_error)
            relative = p.standard_error / abs(p.value) if p.value else math.inf
            error = [p.standard_error if known else "not identifiable", relative if relative < _LARGEST_ERROR else None]
        if p.name in result.insignificant:
            note = Mark("not significant", "unjudged")
        rows.append([p.name, p.value, p.unit, *error, note])
    columns = (
        *left("parameter"), Column("value", form=".6g"), *left("unit"), Column("standard error", form=".2g"),
        Column("relative", "%", ".2g"), *left("note"),
    )  # fmt: skip
    yield Table("parameters", "Parameters", columns, rows)
    if result.scale_rows:
        yield _scale_table(result)
    if meanings := _meanings(result):
        yield Statement("meanings", items=meanings, tone="quiet")


def _scale_table(result: Identification) -> Table:
    """Tabulate BIC and prediction error by the number of scales (hysteretic sets in parallel), and which number was taken."""
    least = min(row.criterion for row in result.scale_rows)
    rows: list[list[Cell]] = []
    for row in result.scale_rows:
        note = "taken" if row.count == max(len(result.scales), 1) else ""
        note = note or ("" if math.isfinite(row.left_out) else "the criterion does not fall")
        figures: list[Cell] = [row.free, row.criterion - least, row.left_out] if not row.why_not else [None] * 3
        rows.append([str(row.count), *figures, row.why_not or note])
    return Table(
        "scales",
        "Number of scales; left out is the error at an amplitude that the fit has not seen, geometric mean of all",
        (
            *left("scales"), Column("free parameters", form="d"), Column("BIC behind", form=".0f"),
            Column("error left out", "%", ".3g"), *left("note"),
        ),
        rows,
    )  # fmt: skip


def _loop_table(fits: Sequence[FittedLoop]) -> Table:
    """Tabulate the force error of each loop, its stiffness and energy measured and fitted, and the offset of its force."""
    rows: list[list[Cell]] = []
    for fit in fits:
        measured, fitted = fit.measured, fit.fitted
        about = round(measured.operating_point, 6)  # less is noise, and must not look like an operating point
        stiffnesses = measured.secant_stiffness, fitted.secant_stiffness
        energies = measured.dissipated_energy, fitted.dissipated_energy
        rows.append([measured.amplitude, about, fit.error, *stiffnesses, *energies, fit.zero])
    columns = (
        Column("amplitude", "mm", ".4g", align="left"), Column("about", "mm", "z.6g"), Column("error", "%", ".3g"),
        Column("stiffness measured", "kN/m", ".4g"), Column("fitted", "kN/m", ".4g"),
        Column("energy measured", "J", ".4g"), Column("fitted", "J", ".4g"), Column("zero of force", "N", "z.4g"),
    )  # fmt: skip
    return Table("loops", "Loops; the error is that of the force over half its range", columns, rows)


def _stages(result: Identification) -> Iterator[Table]:
    columns = (*left("stage"), Column("evaluations", form="d"), Column("error left", "%", ".4g"))
    rows = [(stage.name, stage.evaluations, stage.error) for stage in result.stages]
    yield Table("stages", "Stages of the best fit", columns, rows)


def _uncertainty(result: Identification) -> Iterator[Block]:
    known = result.uncertainty
    columns = [*left("parameter"), *(Column(name, form="+z.2f") for name in known.free)]
    rows: list[list[Cell]] = [[name, *row.tolist()] for name, row in zip(known.free, known.correlation, strict=True)]
    yield Table("correlations", "Correlations", columns, rows)
    yield Statement(
        "singular-values",
        f"Singular values: {', '.join(f'{value:.3g}' for value in known.singular_values)}. Of the residual's change with the "
        "parameters, over its noise: one over each is the standard error of one combination of them, in logarithms or in the "
        "size that it can have. Small ones are not identifiable.",
    )


def _meanings(result: Identification) -> tuple[str, ...]:
    """Explain the derived parameters of the law, a line each."""
    known = {
        "z_max": "z_max = (alpha / (beta + gamma))^(1/n), the largest hysteretic force",
        "x_y": "x_y = z_max / alpha, the deflection at which it yields",
        "sigma": "sigma = beta / (beta + gamma): the larger, the wider a loop between the same tips",
        "c_ln_b": "c_ln_b = c ln b: of b and c only this acts",
        "reversal": "reversal: length over which a stop's force turns from pressing to letting go",
        "x1": "x1: deflection at which the first element slips; x2/x1 ..: how much further the next ones do",
    }
    if result.scales:
        known = {"sigma": known["sigma"], "c_ln_b": known["c_ln_b"]}
        scales = " and ".join(f"_{name} those of the {name} scale" for name in result.scales)
        first = f"names that end with {scales}: z_max its largest force, x_y the deflection at which it yields"
        ratios = "x_y_large/small and the like: how many times farther one scale yields than the other"
        return first + f" ({result.yields})", ratios, *(known[name] for name in known if name in result.parameters)
    return tuple(text for name, text in known.items() if name in result.parameters)


DRAWN_LOOPS = 12  # Loops of one chart: more cannot be read
_PANELS_IN_ROW = 3
_MARGIN = 0.05  # fraction of the stroke, left free beside the turning points
_BRANCH_PARTS = 9  # length of a branch over that of the moving average of residuals
_AMPLITUDE_MARGIN = 1.15  # ratio of amplitudes left free on either side
_HALF_DASH = 0.03  # half length of the dash for a single fitted value, over the amplitude


def drawn_loops(fits: Sequence[FittedLoop]) -> list[FittedLoop]:
    """Choose at most `DRAWN_LOOPS` loops, evenly over all."""
    rows = np.unique(np.linspace(0, len(fits) - 1, min(len(fits), DRAWN_LOOPS)).round().astype(int))
    return [fits[row] for row in rows]


def fit_chart(fits: Sequence[FittedLoop]) -> Chart:
    """Draw force over deflection of every loop, measured and fitted."""
    unit = force_unit(max(float(np.abs(fit.measured.force).max()) for fit in fits))

    def curves(fit: FittedLoop) -> list[Curve]:
        x = in_unit(fit.measured.deflection, "mm")
        return [
            Curve(x, in_unit(fit.fitted.force, unit), name="fitted", kind=MODEL),
            Curve(x, in_unit(fit.measured.force, unit), name="measured", kind=MEASURED, marks=True),
        ]

    drawn = f" {DRAWN_LOOPS} of {len(fits)} loops are drawn." if len(fits) > DRAWN_LOOPS else ""
    return Chart(
        rows=_loop_panels(fits, curves, f"force [{unit}]", unit), height=150.0, id="fit",
        caption=f"Loops, measured and fitted; the error is that of the force over half its range.{drawn}",
        alt="Loops, measured and fitted.",
    )  # fmt: skip


def residual_chart(fits: Sequence[FittedLoop]) -> Chart:
    """Draw fitted minus measured force over the deflection, in percent of half the force range."""

    def curves(fit: FittedLoop) -> list[Curve]:
        start = int(np.argmin(fit.measured.deflection[:-1]))
        x = np.roll(in_unit(fit.measured.deflection, "mm")[:-1], -start)
        residual = np.roll(100.0 * fit.residual[:-1], -start)
        top, means = int(np.argmax(x)), []
        for way, branch, kind in (("up", slice(0, top + 1), 0), ("down", slice(top, None), 1)):
            window = np.full(width := max(1, x[branch].size // _BRANCH_PARTS), 1.0 / width)
            at, mean = (np.convolve(values[branch], window, "valid") for values in (x, residual))
            means.append(Curve(at, mean, name=f"mean on the way {way}", kind=kind))
        return [*means, Curve(x, residual, name="samples", kind=OTHERS, marks=True)]

    largest = 110.0 * max(float(np.abs(fit.residual).max()) for fit in drawn_loops(fits)) or 1.0
    return Chart(
        rows=_loop_panels(fits, curves, "fitted - measured [%]", "%", (-largest, largest)), height=150.0, id="residuals",
        caption="Fitted minus measured force over half its range: samples, and their mean over a ninth of each branch. A law "
        "that fits leaves noise, whose mean is zero; what bends is what the law cannot do.",
        alt="Residuals over the deflection.",
    )  # fmt: skip


def measures_chart(fits: Sequence[FittedLoop]) -> Chart:
    """Draw energy per cycle and secant stiffness over the amplitude, measured and fitted."""
    amplitudes = np.array([in_unit(fit.measured.amplitude, "mm") for fit in fits])
    across = (float(amplitudes.min()) / _AMPLITUDE_MARGIN, float(amplitudes.max()) * _AMPLITUDE_MARGIN)
    groups, panels = _groups_by_operating_point(fits), []
    for measure, unit, label in (
        ("dissipated_energy", "J", "energy per cycle [J]"),
        ("secant_stiffness", "kN/m", "stiffness [kN/m]"),
    ):
        curves = []
        for number, group in enumerate(groups):
            x = np.array([in_unit(fit.measured.amplitude, "mm") for fit in group])
            about = f" about {_operating_point_text(group)} mm" if len(groups) > 1 else ""
            kinds: tuple[int | str, ...] = (MEASURED, MODEL) if len(groups) == 1 else 2 * (number % COLOURS,)
            measured, fitted = (
                np.array([in_unit(getattr(loop, measure), unit) for loop in loops])
                for loops in zip(*((fit.measured, fit.fitted) for fit in group), strict=True)
            )
            curves.append(Curve(x, measured, name=f"measured{about}", kind=kinds[0], marks=True))
            if x.size == 1:  # a line of one point is invisible
                x, fitted = x[0] * np.array([1.0 - _HALF_DASH, 1.0 + _HALF_DASH]), np.repeat(fitted, 2)
            curves.append(Curve(x, fitted, name=f"fitted{about}", kind=kinds[1]))
        values = np.concatenate([curve.y for curve in curves])
        # That of a device without loss is noise of either sign.
        log = measure == "dissipated_energy" and bool((values > 0.0).all())
        limits = (float(values.min()) / 1.3, float(values.max()) * 1.3) if log else None
        if measure == "secant_stiffness" and values.min() > 0.0:
            limits = (0.0, 1.1 * float(values.max()))
        panels.append(
            Panel(
                curves, label, xlabel="amplitude [mm]", xlim=across, ylim=limits, log="xy" if log else "x",
                unit=unit, xunit="mm",
            )
        )  # fmt: skip
    return Chart(
        id="measures", rows=[panels], height=180.0, caption="Energy per cycle and secant stiffness over the amplitude.",
        alt="Measures over the amplitude.",
    )  # fmt: skip


def _loop_panels(
    fits: Sequence[FittedLoop], curves_of: Callable[[FittedLoop], list[Curve]], ylabel: str, unit: str,
    ylim: tuple[float, float] | None = None,
) -> list[list[Panel]]:  # fmt: skip
    """Arrange a panel for each drawn loop, three beside each other, with the curves that `curves_of` gives."""
    groups, panels = _groups_by_operating_point(fits), []
    for fit in drawn_loops(fits):
        low, high = float(fit.measured.deflection.min()), float(fit.measured.deflection.max())
        room = _MARGIN * (high - low)
        members = next(group for group in groups if any(fit is member for member in group))
        about = f" about {_operating_point_text(members)}" if len(groups) > 1 else ""
        title = f"±{in_unit(fit.measured.amplitude, 'mm'):.3g}{about} mm: {100.0 * fit.error:.2g} % error"
        panels.append(Panel(
            curves_of(fit), ylabel, xlabel="deflection [mm]", title=title, unit=unit, xunit="mm", ylim=ylim,
            xlim=(in_unit(low - room, "mm"), in_unit(high + room, "mm")),
        ))  # fmt: skip
    rows = np.array_split(np.arange(len(panels)), math.ceil(len(panels) / _PANELS_IN_ROW))
    return [[panels[number] for number in row] for row in rows]


def _groups_by_operating_point(fits: Sequence[FittedLoop]) -> list[list[FittedLoop]]:
    """Group loops by operating point, to within 2 % of the largest amplitude: no rig holds it better."""
    step = 0.02 * max(fit.measured.amplitude for fit in fits)
    groups: list[list[FittedLoop]] = []
    for fit in sorted(fits, key=lambda fit: fit.measured.operating_point):
        if groups and fit.measured.operating_point - groups[-1][0].measured.operating_point <= step:
            groups[-1].append(fit)
        else:
            groups.append([fit])
    return [sorted(group, key=lambda fit: fit.measured.amplitude) for group in groups]


def _operating_point_text(group: Sequence[FittedLoop]) -> str:
    """Write the mean operating point of a group [mm], rounded to 0.1 % of its largest amplitude."""
    least = 1e-3 * max(1e3 * fit.measured.amplitude for fit in group)
    mean = 1e3 * float(np.mean([fit.measured.operating_point for fit in group]))
    return f"{least * round(mean / least):.3g}" if abs(mean) > least else "0"
