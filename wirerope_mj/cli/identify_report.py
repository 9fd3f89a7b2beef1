"""What a fit says in tables and words: on the screen and in the report's text."""

import math
from collections.abc import Iterable, Sequence
from dataclasses import dataclass

from wirerope_mj.foundation.plain_text import markdown
from wirerope_mj.mounts.identification.fitted import FittedLoop, neighbours_correlation
from wirerope_mj.mounts.identification.result import Identification
from wirerope_mj.mounts.laws import Law, Stop

PICTURES = {
    "loops.png": "Measured loops and those of the law",
    "residuals.png": "What the law leaves over",
    "measures.png": "Energy per cycle and secant stiffness over the amplitude",
}
"""Pictures of a report and their captions."""

_PARAMETERS = "Parameters"
_UNITS = {
    "alpha": "N/m", "beta": "N^(1-n)/m", "gamma": "N^(1-n)/m", "k": "N/m", "k1": "N/m", "k2": "N/m^2", "k3": "N/m^3",
    "c": "1/m", "d": "N", "u_c": "m", "stiffness": "N/m", "slip_force": "N",
}  # fmt: skip
_STOP_UNITS = {"gap_below": "m", "gap_above": "m", "k": "N/m^exponent", "rounding": "m", "reversal": "m", "c": "N s/m"}
"""Of the parameters of laws in their isolator files, where these are not the coordinates of the search; b and n have none."""

_BENT = 0.5
"""Correlation of neighbouring residuals that white noise of a hundred samples never has."""


@dataclass(frozen=True)
class Rows:
    """A table: its columns, the first of names and the others of numbers, and its rows."""

    title: str
    columns: Sequence[str]
    rows: Sequence[Sequence[str]]

    def markdown(self) -> str:
        """Return the table as Markdown."""
        head, *rows = [[markdown(cell) for cell in row] for row in (self.columns, *self.rows)]
        lines = [head, ["---", *["---:"] * (len(self.columns) - 1)], *rows]
        return "\n".join(f"| {' | '.join(line)} |" for line in lines)


def parameter_rows(result: Identification) -> Rows:
    """Return what was searched for, how sure it is, and what to know of it."""
    rows = []
    for p in result.parameters.values():
        share = 100.0 * p.standard_error / abs(p.value) if p.value else math.inf
        error = ["-", "-"] if p.fixed else [f"{p.standard_error:.2g}", f"{share:.2g}" if share < 1e4 else "-"]
        if not p.fixed and not math.isfinite(p.standard_error):
            error = ["not fixed by the data", "-"]
        note = "given" if p.fixed else "at its bound" if p.at_bound else ""
        rows.append([p.name, f"{p.value:.6g}", p.unit, *error, note])
    return Rows(_PARAMETERS, ("parameter", "value", "unit", "standard error", "[%]", "note"), rows)


def loop_rows(fits: Iterable[FittedLoop]) -> Rows:
    """Return the error of every loop, its measures as measured and fitted, and the zero of its force."""
    rows = []
    for fit in fits:
        pairs = [
            (1e-3 * fit.secant_stiffness(fit.measured), 1e-3 * fit.secant_stiffness(fit.fitted)),
            (fit.energy(fit.measured), fit.energy(fit.fitted)),
        ]
        numbers = [f"{value:.4g}" for pair in pairs for value in pair]
        rows.append(
            [f"{1e3 * fit.amplitude:.4g}", millimetres(fit.operating_point), f"{100.0 * fit.error:.3g}", *numbers]
            + [f"{fit.zero:.4g}"]
        )
    columns = (
        "amplitude [mm]", "about [mm]", "error [%]", "stiffness measured [kN/m]", "fitted [kN/m]", "energy measured [J]",
        "fitted [J]", "zero of force [N]",
    )  # fmt: skip
    return Rows("Loops; the error is that of the force over half its range", columns, rows)


def stage_rows(result: Identification) -> Rows:
    """Return what every stage of the fit did."""
    rows = [[stage.name, f"{stage.evaluations}", f"{100.0 * stage.error:.4g}"] for stage in result.stages]
    return Rows("Stages of the best fit", ("stage", "evaluations", "error left [%]"), rows)


def law_words(result: Identification) -> str:
    """Return the law's name and its own parameters with their units, those of an isolator file."""
    return " and ".join(_one_law(law, result) for law in result.law.components)


def _one_law(law: Law, result: Identification) -> str:
    """Return name and parameters of one of the laws on the axis; the last one was searched for."""
    values, found, words = law.to_dict(), law is result.law.components[-1], []
    units = _UNITS | _STOP_UNITS if isinstance(law, Stop) else _UNITS
    for name, value in values.items():
        if name == "law":
            continue
        known = result.parameters.get(name) if found else None
        unit = known.unit if known else units.get(name, "-")
        number = f"[{', '.join(f'{one:.6g}' for one in value)}]" if isinstance(value, list) else f"{value:.6g}"
        words.append(f"{name} = {number} {unit}".removesuffix(" -"))
    return f"{values['law']}: {', '.join(words)}"


def correlation_rows(result: Identification) -> Rows:
    """Return the correlations of the free parameters."""
    free = result.certainty.free
    rows = [
        [name, *[f"{value:+.2f}" for value in row]]
        for name, row in zip(free, result.certainty.correlation, strict=True)
    ]
    return Rows("Correlations", ("", *free), rows)


def meanings(result: Identification) -> list[str]:
    """Return what the coordinates are that an isolator file does not name so."""
    known = {
        "z_max": "z_max = (alpha / (beta + gamma))^(1/n), the largest hysteretic force",
        "x_y": "x_y = z_max / alpha, the deflection at which it yields",
        "sigma": "sigma = beta / (beta + gamma): the larger, the wider a loop between the same tips",
        "c_ln_b": "c_ln_b = c ln b: of b and c only this acts",
        "reversal": "reversal: length over which a stop's force turns from pressing to letting go",
        "x1": "x1: deflection at which the first element slips; x2/x1 ..: how much further the next ones do",
    }
    return [words for name, words in known.items() if name in result.parameters]


def sentences(result: Identification, fits: Sequence[FittedLoop]) -> list[str]:
    """Return how the fit ended, what the data leave open, where the law is valid, and whether noise is all it left."""
    found = [f"{'converged' if result.converged else 'NOT CONVERGED'}: {result.message}"]
    found += [f"open: {words}" for words in result.open_combinations]
    if not result.open_combinations:
        found.append("the data fix every free parameter")
    found.append(result.validity)
    together = neighbours_correlation(fits)
    if together > _BENT:
        found.append(
            f"what is left is no noise (neighbouring residuals correlate by {together:.2f}): this law does not follow the "
            "loops everywhere, and its standard errors are too small; residuals.png shows where"
        )
    return found


def millimetres(deflection: float) -> str:
    """Return a deflection [m] in mm to 1 um: less is noise, and must not look like an operating point."""
    return f"{round(1e3 * deflection, 3) + 0.0:.6g}"


def report_text(
    result: Identification, fits: Sequence[FittedLoop], *, title: str, sources: Sequence[str], given: Sequence[str]
) -> str:
    """Return the report as Markdown.

    Args:
        result: the fit.
        fits: its loops beside the law's.
        title: of the report.
        sources: the files that were read, with what they hold.
        given: what was given and not searched for, one sentence each.
    """
    singular = ", ".join(f"{value:.3g}" for value in result.certainty.singular_values)
    parts = [
        f"# {markdown(title)}",
        *[f"![{caption}]({name})\n\n{caption}." for name, caption in list(PICTURES.items())[:1]],
        f"Law: {markdown(law_words(result))}",
        "\n".join(f"- {markdown(words)}" for words in [*sentences(result, fits), *given]),
        f"Error over all loops {100.0 * result.residual:.3g} % of half their force range; {result.evaluations} evaluations "
        f"from all starts.",
    ]
    for table in (parameter_rows(result), loop_rows(fits), stage_rows(result), correlation_rows(result)):
        parts += [f"## {table.title}", table.markdown()]
        if table.title == _PARAMETERS and meanings(result):
            parts.append("\n".join(f"- {words}" for words in meanings(result)))
    parts += [
        "## Singular values",
        f"{singular}\n\nOf the residual's change with the parameters, over its noise: one over each is the standard error of "
        "one combination of them, in logarithms or in the size that it can have. Small ones are what the data leave open.",
        *[f"![{caption}]({name})\n\n{caption}." for name, caption in list(PICTURES.items())[1:]],
        "## Read from",
        "\n".join(f"- {markdown(source)}" for source in sources),
    ]
    return "\n\n".join(parts) + "\n"
