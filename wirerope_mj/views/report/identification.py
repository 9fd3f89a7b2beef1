"""Tables and text of an identification: on the screen and in its report."""

import math
from collections.abc import Iterable, Sequence
from importlib.metadata import version

from wirerope_mj.foundation.tables import Cell, Column, Mark, Table
from wirerope_mj.mounts.identification.records import millimetres
from wirerope_mj.mounts.identification.result import FittedLoop, Identification, neighbours_correlation
from wirerope_mj.mounts.laws import Law, Stop
from wirerope_mj.views.plots.identification import MOST, fit_chart, measures_chart, residual_chart
from wirerope_mj.views.report.content import Block, Listing, Paragraph, Picture, ReportContent, Section

_UNITS = {
    "alpha": "N/m", "beta": "N^(1-n)/m", "gamma": "N^(1-n)/m", "k": "N/m", "k1": "N/m", "k2": "N/m^2", "k3": "N/m^3",
    "c": "1/m", "d": "N", "u_c": "m", "stiffness": "N/m", "slip_force": "N",
}  # fmt: skip
_STOP_UNITS = {"gap_below": "m", "gap_above": "m", "k": "N/m^exponent", "rounding": "m", "reversal": "m", "c": "N s/m"}
"""Of the parameters of laws in their isolator files, where these are not the coordinates of the search; b and n have none."""

_BENT = 0.5
"""Correlation of neighbouring residuals that white noise of a hundred samples never has."""


def parameter_table(result: Identification) -> Table:
    """Return the table of the parameters with their standard errors."""
    rows = []
    for p in result.parameters.values():
        relative = 100.0 * p.standard_error / abs(p.value) if p.value else math.inf
        error = ["-", "-"] if p.fixed else [f"{p.standard_error:.2g}", f"{relative:.2g}" if relative < 1e4 else "-"]
        if not p.fixed and not math.isfinite(p.standard_error):
            error = ["not identifiable", "-"]
        note = "given" if p.fixed else "at its bound" if p.at_bound else ""
        rows.append([p.name, f"{p.value:.6g}", p.unit, *error, note])
    columns = [
        Column("parameter", align="left"),
        Column("value"),
        Column("unit", align="left"),
        Column("standard error"),
        Column("[%]"),
        Column("note", align="left"),
    ]
    return Table(title="Parameters", columns=columns, rows=rows)


def loop_table(fits: Iterable[FittedLoop]) -> Table:
    """Return the table of the loops: error, measures as measured and fitted, and the zero of the force."""
    columns = [
        Column("amplitude", "mm", ".4g", align="left"),
        Column("about [mm]"),
        Column("error", "%", ".3g"),
        Column("stiffness measured", "kN/m", ".4g"),
        Column("fitted", "kN/m", ".4g"),
        Column("energy measured", "J", ".4g"),
        Column("fitted", "J", ".4g"),
        Column("zero of force", "N", ".4g"),
    ]
    rows: list[list[Cell]] = [
        [
            fit.amplitude,
            millimetres(fit.operating_point),
            fit.error,
            fit.secant_stiffness(fit.measured),
            fit.secant_stiffness(fit.fitted),
            fit.energy(fit.measured),
            fit.energy(fit.fitted),
            fit.zero,
        ]
        for fit in fits
    ]
    return Table(title="Loops; the error is that of the force over half its range", columns=columns, rows=rows)


def stage_table(result: Identification) -> Table:
    """Return the table of the stages of the best fit."""
    columns = [Column("stage", align="left"), Column("evaluations"), Column("error left", "%", ".4g")]
    rows: list[list[Cell]] = [[stage.name, str(stage.evaluations), stage.error] for stage in result.stages]
    return Table(title="Stages of the best fit", columns=columns, rows=rows)


def scale_tables(result: Identification) -> list[Table]:
    """Return the table of the numbers of scales that were tried, if there is one."""
    if not result.scale_rows:
        return []
    least = min(row.criterion for row in result.scale_rows)
    columns = [
        Column("scales", align="left"),
        Column("free parameters"),
        Column("BIC behind", "", ".0f"),
        Column("error left out", "%", ".3g"),
        Column("note", align="left"),
    ]
    rows: list[list[Cell]] = []
    for row in result.scale_rows:
        taken = "taken" if row.count == max(len(result.scales), 1) else ""
        taken = taken or ("" if math.isfinite(row.left_out) else "the criterion does not fall")
        known: list[Cell] = [str(row.free), row.criterion - least, row.left_out] if not row.why_not else ["-", "-", "-"]
        rows.append([str(row.count), *known, row.why_not or taken])
    title = "Number of scales; left out is the error at an amplitude that the fit has not seen, geometric mean of all"
    return [Table(title=title, columns=columns, rows=rows)]


def correlation_table(result: Identification) -> Table:
    """Return the table of correlations of the free parameters."""
    free = result.uncertainty.free
    rows = [
        [name, *[f"{value:+.2f}" for value in row]]
        for name, row in zip(free, result.uncertainty.correlation, strict=True)
    ]
    return Table(title="Correlations", columns=[Column("parameter", align="left"), *map(Column, free)], rows=rows)


def law_lines(result: Identification) -> list[str]:
    """Return the names of the laws and their own parameters with their units, those of an isolator file, one text each."""
    first = [f"{name} scale, " for name in result.scales] or ["", *["and "] * (len(result.law.components) - 1)]
    return [before + _one_law(law, result) for before, law in zip(first, result.law.components, strict=True)]


def _one_law(law: Law, result: Identification) -> str:
    """Return name and parameters of one of the laws on the axis; the last one was searched for."""
    values, fitted, texts = law.to_dict(), law is result.law.components[-1], []
    units = _UNITS | _STOP_UNITS if isinstance(law, Stop) else _UNITS
    for name, value in values.items():
        if name == "law":
            continue
        known = result.parameters.get(name) if fitted else None
        unit = known.unit if known else units.get(name, "-")
        number = f"[{', '.join(f'{one:.6g}' for one in value)}]" if isinstance(value, list) else f"{value:.6g}"
        texts.append(f"{name} = {number} {unit}".removesuffix(" -"))
    return f"{values['law']}: {', '.join(texts)}"


def _meanings(result: Identification) -> list[str]:
    """Return the definitions of the coordinates that an isolator file does not name so."""
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
        return [f"{first} ({result.yields})", ratios, *(known[name] for name in known if name in result.parameters)]
    return [text for name, text in known.items() if name in result.parameters]


def findings(result: Identification, fits: Sequence[FittedLoop]) -> list[str]:
    """Return how the fit ended, what is not identifiable, where the law is valid, and whether its residuals are noise."""
    texts = [f"{'converged' if result.converged else 'NOT CONVERGED'}: {result.message}"]
    texts += [f"yield deflections: {result.yields}"] if result.scales else []
    texts += [f"not identifiable: {text}" for text in result.non_identifiable]
    if not result.non_identifiable:
        texts.append("the data identify every free parameter")
    if unseen := result.not_told_from_zero:
        texts.append(f"not told from zero: {', '.join(unseen)}; a law without them may fit as well")
    texts += [result.validity, *filter(None, [result.prediction])]
    if result.falling:
        texts.append(
            f"{result.falling}: a shock that goes there has no answer; test larger amplitudes, or take another law"
        )
    if (correlation := neighbours_correlation(fits)) > _BENT:
        texts.append(
            f"what is left is no white noise (neighbouring residuals correlate by {correlation:.2f}): standard errors count it "
            "as noise so correlated; where this law does not follow the loops, as residuals in the report show, they say "
            "nothing of what it lacks"
        )
    return texts


def identification_content(
    result: Identification, fits: Sequence[FittedLoop], *, title: str, sources: Sequence[str], given: Sequence[str]
) -> ReportContent:
    """Return the report of a fit.

    Args:
        result: the fit.
        fits: its loops beside the law's.
        title: of the report.
        sources: the files that were read, with their loops.
        given: what was given and not searched for, one text each.
    """
    singular = ", ".join(f"{value:.3g}" for value in result.uncertainty.singular_values)
    drawn = f" {MOST} of {len(fits)} loops are drawn." if len(fits) > MOST else ""
    meanings = _meanings(result)
    error = (
        f"Error over all loops {100.0 * result.residual:.3g} % of half their force range; {result.evaluations} evaluations "
        "from all starts."
    )
    parameters: list[Block] = [*(Paragraph(text=f"Law: {text}") for text in law_lines(result)), parameter_table(result)]
    parameters += scale_tables(result)
    parameters += [Listing(items=tuple(meanings))] if meanings else []
    return ReportContent(
        title=title,
        facts=(("Loops", str(len(fits))), ("By", f"wirerope-mj {version('wirerope-mj')}")),
        question=("Which parameters of the law follow the measured loops, and how well are they known?",),
        verdict=_verdict(result, fits),
        answer=(
            Picture(
                image=fit_chart(fits),
                caption=f"Measured loops and those of the law; the error is that of the force over half its range.{drawn}",
                alt="Loops, measured and fitted.",
            ),
            Listing(items=(*findings(result, fits), error, *given)),
        ),
        sections=(
            Section(title="Parameters", blocks=tuple(parameters)),
            Section(
                title="Loops and residuals",
                blocks=(
                    loop_table(fits),
                    Picture(
                        image=residual_chart(fits),
                        caption="Fitted minus measured force over half its range: samples, and their mean over a ninth of each "
                        "branch. A law that fits leaves noise, whose mean is zero; what bends is what the law cannot do.",
                        alt="Residuals over the deflection.",
                    ),
                    Picture(
                        image=measures_chart(fits),
                        caption="Energy per cycle and secant stiffness over the amplitude.",
                        alt="Measures over the amplitude.",
                    ),
                ),
            ),
            Section(
                title="How well the parameters are known",
                blocks=(
                    stage_table(result),
                    correlation_table(result),
                    Paragraph(
                        text=f"Singular values: {singular}. Of the residual's change with the parameters, over its noise: one "
                        "over each is the standard error of one combination of them, in logarithms or in the size that it can "
                        "have. Small ones are not identifiable."
                    ),
                ),
            ),
            Section(title="Read from", blocks=(Listing(items=tuple(sources)),)),
        ),
    )


def _verdict(result: Identification, fits: Sequence[FittedLoop]) -> Mark:
    """Return whether the fit converged, whether the law follows the loops, and whether the data fix every parameter."""
    if not result.converged:
        return Mark("NOT CONVERGED", "exceeded")
    if neighbours_correlation(fits) > _BENT:
        return Mark("Converged; the law does not follow the loops everywhere", "unjudged")
    if result.non_identifiable:
        return Mark("Converged; not every parameter is identifiable", "unjudged")
    return Mark("Converged; the data identify every free parameter", "within")
