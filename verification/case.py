"""A case: what is compared with what, from which source, and within which bound."""

from collections.abc import Callable, Mapping
from dataclasses import dataclass

import numpy as np
import numpy.typing as npt

LAST_DIGIT = "the printed digits are met: the error is in half units of the last one"
"""Reason of the bound 1 of what `printed` compares."""


class NotRunError(Exception):
    """A program that a case needs cannot be used here; the text says which and why."""


@dataclass(frozen=True, kw_only=True)
class Comparison:
    """Result of a case beside its reference.

    Attributes:
        reference, ours: the value shown, in `unit`: of a series the reference's largest magnitude, and ours at that instant.
        error: the measure of all values compared that the bound is for.
        values: number of values compared.
        unit: of `reference` and `ours`.
        details: label, reference, ours and relative error of single values, where they are worth a table.
        lines: what is printed as it is.
    """

    reference: float
    ours: float
    error: float
    values: int = 1
    unit: str = "-"
    details: tuple[tuple[str, float, float, float], ...] = ()
    lines: tuple[str, ...] = ()


@dataclass(frozen=True, kw_only=True)
class Case:
    """One external check.

    Attributes:
        name: by which it is called on the command line.
        title: of its row.
        compares: what is compared, and how the error is measured.
        source: of the reference.
        date: of the reference: when it was published or computed; "each run" if another program computes it again.
        bound: largest error allowed.
        reason: of the bound.
        run: makes the comparison.
        needs: importable names of packages that are not among the library's own dependencies.
        kind: "numerics": both solve the same equations. "published": a value that others printed. "plausibility": two
            models of one device, or a statement about such devices: the difference is not an error of the computation.
            "measured": tests of a device, predicted from other tests of it; `run` takes the folder that holds them.
        known: why the case is outside its bound today, where that is known and open; it then fails no run.
    """

    name: str
    title: str
    compares: str
    source: str
    date: str
    bound: float
    reason: str
    run: Callable[..., Comparison]
    needs: tuple[str, ...] = ()
    kind: str = "numerics"
    known: str = ""


def series(reference: npt.ArrayLike, ours: npt.ArrayLike, unit: str) -> Comparison:
    """Return the comparison of two histories of one shape: largest difference over the reference's largest magnitude."""
    expected, found = (np.asarray(values, dtype=np.float64).ravel() for values in (reference, ours))
    if expected.shape != found.shape:
        raise ValueError(f"histories of {expected.size} and {found.size} values cannot be compared.")
    top = int(np.argmax(np.abs(expected)))
    return Comparison(
        reference=float(expected[top]),
        ours=float(found[top]),
        error=float(np.abs(found - expected).max() / abs(expected[top])),
        values=expected.size,
        unit=unit,
    )


def single_values(values: Mapping[str, tuple[float, float]], unit: str) -> Comparison:
    """Return the comparison of named pairs (reference, ours): the largest relative difference, and that pair.

    Args:
        values: pairs by label; the reference is not zero.
        unit: of all of them, or "-" where each label says its own.
    """
    rows = tuple(
        (label, float(expected), float(found), abs(float(found) / float(expected) - 1.0))
        for label, (expected, found) in values.items()
    )
    worst = max(rows, key=lambda row: row[3] if np.isfinite(row[3]) else np.inf)
    return Comparison(
        reference=worst[1],
        ours=worst[2],
        error=worst[3],
        values=len(rows),
        unit=unit,
        details=rows if len(rows) > 1 else (),
    )


def printed(values: Mapping[str, tuple[str, float]]) -> Comparison:
    """Return the comparison with numbers as they were printed: the largest difference in half units of the last digit.

    Args:
        values: printed number and ours by label, which names the unit. An error up to 1 rounds to the same digits.
    """
    rows = []
    for label, (text, found) in values.items():
        decimals = len(text.partition(".")[2])
        rows.append((label, float(text), float(found), abs(float(found) - float(text)) / (0.5 * 10.0**-decimals)))
    worst = max(rows, key=lambda row: row[3] if np.isfinite(row[3]) else np.inf)
    return Comparison(
        reference=worst[1], ours=worst[2], error=worst[3], values=len(rows), unit="see below", details=tuple(rows)
    )
