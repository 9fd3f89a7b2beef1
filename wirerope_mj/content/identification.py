"""What an identification says, whoever shows it: the law, how well the data fix it, and its loops."""

import math
from collections.abc import Sequence
from importlib.metadata import version

from wirerope_mj.content.blocks import Block, Content, Section, Statement
from wirerope_mj.content.fitted_loops import fit_chart, measures_chart, residual_chart
from wirerope_mj.content.numbers import several
from wirerope_mj.foundation.tables import Cell, Column, Mark, Table
from wirerope_mj.mounts.identification.result import FittedLoop, Identification, neighbours_correlation
from wirerope_mj.mounts.laws import Law

_BENT = 0.5  # Correlation of neighbouring residuals that white noise of a hundred samples never has
_UNKNOWN = 100.0  # Relative standard error that is not worth showing


def identification_content(
    result: Identification, fits: Sequence[FittedLoop], *, title: str, sources: Sequence[str], warnings: Sequence[str],
    given: Sequence[str],
) -> Content:  # fmt: skip
    """Compose what an identification says: its loops beside the law's, and doubts.

    `sources` are the files that were read, `warnings` what makes the fit doubtful, `given` what was not searched for.
    """
    return Content(
        title=title, facts=(("Loops", str(len(fits))), ("By", f"wirerope-mj {version('wirerope-mj')}")),
        question=("Which parameters of the law follow the measured loops, and how well are they known?",),
        verdict=_headline(result, fits, warnings),
        sections=(
            Section(
                "answer", "", lambda: (fit_chart(fits), _findings(result, fits, given), record_warnings(warnings)), "headline"
            ),
            Section("parameters", "Parameters", lambda: _parameter_blocks(result), "summary"),
            Section(
                "loops-and-residuals", "Loops and residuals",
                lambda: (_loop_table(fits), residual_chart(fits), measures_chart(fits)), "summary",
            ),
            Section("search", "Search", lambda: (_stage_table(result),), "summary"),
            Section(
                "how-well-the-parameters-are-known", "How well the parameters are known",
                lambda: (_correlation_table(result), _singular_values(result)),
            ),
            Section("read-from", "Read from", lambda: (Statement(id="sources", items=tuple(sources)),)),
        ),
    )  # fmt: skip


def _headline(result: Identification, fits: Sequence[FittedLoop], warnings: Sequence[str]) -> Statement:
    """Return the conclusion: the worst of convergence, faults of the rig, residuals, and what the data do not fix."""
    values = {"error": result.residual, "neighbours_correlation": neighbours_correlation(fits)}
    if not result.converged:
        return Statement(id="headline", text=f"NOT CONVERGED: {result.message}", tone="exceeded", values=values)
    doubts = [f"the records give {several(len(warnings), 'warning')}"] if warnings else []
    doubts += ["the law does not follow the loops everywhere"] if values["neighbours_correlation"] > _BENT else []
    doubts += ["not every parameter is identifiable"] if result.non_identifiable else []
    doubts += [_insignificant(result.insignificant)] if result.insignificant else []
    if doubts:
        return Statement(id="headline", text=f"Converged, but {'; '.join(doubts)}.", tone="unjudged", values=values)
    text = "Converged; the data identify every free parameter."
    return Statement(id="headline", text=text, tone="within", values=values)


def _insignificant(names: Sequence[str]) -> str:
    several_names = len(names) > 1
    verb, them = ("are", "them") if several_names else ("is", "it")
    return f"{', '.join(names)} {verb} not significant; consider dropping {them}"


def _findings(result: Identification, fits: Sequence[FittedLoop], given: Sequence[str]) -> Statement:
    """Return how the fit ended, what is not identifiable, where the law is valid, and whether its residuals are noise."""
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
    if (correlation := neighbours_correlation(fits)) > _BENT:
        texts.append(
            f"what is left is no white noise (neighbouring residuals correlate by {correlation:.2f}): standard errors count it "
            "as noise so correlated; where this law does not follow the loops, as residuals in the report show, they say "
            "nothing of what it lacks"
        )
    texts.append(
        f"error over all loops {100.0 * result.residual:.3g} % of half their force range; {result.evaluations} evaluations "
        "from all starts"
    )
    return Statement(id="findings", items=(*texts, *given))


def record_warnings(warnings: Sequence[str]) -> Statement | None:
    """List the faults of the rig that the records show; None without any."""
    text = "Warnings about the records:"
    return Statement(id="warnings", text=text, items=tuple(warnings), tone="unjudged") if warnings else None


def _parameter_blocks(result: Identification) -> tuple[Block | None, ...]:
    meanings = _meanings(result)
    # Laws and their own parameters as in an isolator file, with units.
    first = [f"{name} scale, " for name in result.scales] or ["", *["and "] * (len(result.law.components) - 1)]
    laws = tuple(before + _one_law(law, result) for before, law in zip(first, result.law.components, strict=True))
    return (
        Statement(id="law", items=laws), _parameter_table(result), _scale_table(result),
        Statement(id="meanings", items=meanings, tone="quiet") if meanings else None,
    )  # fmt: skip


def _parameter_table(result: Identification) -> Table:
    """Tabulate the parameters with their standard errors."""
    rows: list[list[Cell]] = []
    for p in result.parameters.values():
        note: Cell = "given" if p.fixed else "at its bound" if p.at_bound else ""
        error: list[Cell] = [None, None]
        if not p.fixed:
            known = math.isfinite(p.standard_error)
            relative = p.standard_error / abs(p.value) if p.value else math.inf
            error = [p.standard_error if known else "not identifiable", relative if relative < _UNKNOWN else None]
        if p.name in result.insignificant:
            note = Mark("not significant", "unjudged")
        rows.append([p.name, p.value, p.unit, *error, note])
    columns = (
        Column("parameter", align="left"), Column("value", form=".6g"), Column("unit", align="left"),
        Column("standard error", form=".2g"), Column("relative", "%", ".2g"), Column("note", align="left"),
    )  # fmt: skip
    return Table(id="parameters", title="Parameters", columns=columns, rows=rows)


def _scale_table(result: Identification) -> Table | None:
    """Tabulate the numbers of scales that were tried; None if only one was."""
    if not result.scale_rows:
        return None
    least = min(row.criterion for row in result.scale_rows)
    rows: list[list[Cell]] = []
    for row in result.scale_rows:
        taken = "taken" if row.count == max(len(result.scales), 1) else ""
        taken = taken or ("" if math.isfinite(row.left_out) else "the criterion does not fall")
        known: list[Cell] = [row.free, row.criterion - least, row.left_out] if not row.why_not else [None] * 3
        rows.append([str(row.count), *known, row.why_not or taken])
    return Table(
        id="scales",
        title="Number of scales; left out is the error at an amplitude that the fit has not seen, geometric mean of all",
        columns=(
            Column("scales", align="left"), Column("free parameters", form="d"), Column("BIC behind", form=".0f"),
            Column("error left out", "%", ".3g"), Column("note", align="left"),
        ),
        rows=rows,
    )  # fmt: skip


def _loop_table(fits: Sequence[FittedLoop]) -> Table:
    """Tabulate the loops: error, measures as measured and fitted, and the zero of the force."""
    rows: list[list[Cell]] = [
        [
            fit.measured.amplitude,
            round(fit.measured.operating_point, 6),  # less is noise, and must not look like an operating point
            fit.error,
            fit.measured.secant_stiffness,
            fit.fitted.secant_stiffness,
            fit.measured.dissipated_energy,
            fit.fitted.dissipated_energy,
            fit.zero,
        ]
        for fit in fits
    ]
    columns = (
        Column("amplitude", "mm", ".4g", align="left"), Column("about", "mm", "z.6g"), Column("error", "%", ".3g"),
        Column("stiffness measured", "kN/m", ".4g"), Column("fitted", "kN/m", ".4g"),
        Column("energy measured", "J", ".4g"), Column("fitted", "J", ".4g"), Column("zero of force", "N", "z.4g"),
    )  # fmt: skip
    title = "Loops; the error is that of the force over half its range"
    return Table(id="loops", title=title, columns=columns, rows=rows)


def _stage_table(result: Identification) -> Table:
    columns = (Column("stage", align="left"), Column("evaluations", form="d"), Column("error left", "%", ".4g"))
    rows = [(stage.name, stage.evaluations, stage.error) for stage in result.stages]
    return Table(id="stages", title="Stages of the best fit", columns=columns, rows=rows)


def _correlation_table(result: Identification) -> Table:
    free = result.uncertainty.free
    columns = [Column("parameter", align="left"), *(Column(name, form="+z.2f") for name in free)]
    rows: list[list[Cell]] = [[name, *row.tolist()] for name, row in zip(free, result.uncertainty.correlation, strict=True)]
    return Table(id="correlations", title="Correlations", columns=columns, rows=rows)


def _singular_values(result: Identification) -> Statement:
    singular = ", ".join(f"{value:.3g}" for value in result.uncertainty.singular_values)
    return Statement(
        id="singular-values",
        text=f"Singular values: {singular}. Of the residual's change with the parameters, over its noise: one over each is the "
        "standard error of one combination of them, in logarithms or in the size that it can have. Small ones are not "
        "identifiable.",
    )


def _one_law(law: Law, result: Identification) -> str:
    """Return name and parameters of one of the laws on the axis; the last one was searched for."""
    values, fitted, texts = law.to_dict(), law is result.law.components[-1], []
    for name, value in values.items():
        if name == "law":
            continue
        known = result.parameters.get(name) if fitted else None
        unit = known.unit if known else law.units.get(name, "-")
        number = f"[{', '.join(f'{one:.6g}' for one in value)}]" if isinstance(value, list) else f"{value:.6g}"
        texts.append(f"{name} = {number} {unit}".removesuffix(" -"))
    return f"{values['law']}: {', '.join(texts)}"


def _meanings(result: Identification) -> tuple[str, ...]:
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
        return first + f" ({result.yields})", ratios, *(known[name] for name in known if name in result.parameters)
    return tuple(text for name, text in known.items() if name in result.parameters)
