"""The thesis' three stages against its comparators: one stage in the time domain, one in the frequency domain."""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import get_args

from wirerope_mj.mounts.identification.identify import identify
from wirerope_mj.mounts.identification.measured import require_loops
from wirerope_mj.mounts.identification.search import Method
from wirerope_mj.mounts.laws import Law, Loop


@dataclass(frozen=True, kw_only=True)
class MethodRow:
    """Fit by one method from one start.

    Attributes:
        method: "three-stage", "time" or "frequency".
        iterations: steps of the searches, all stages together.
        evaluations: of a residual, Jacobians included.
        error: root mean square of force minus measured force, each loop's over its half force range [-].
        converged: whether the last search ended by itself.
        message: how it ended.
    """

    method: str
    start: str
    iterations: int
    evaluations: int
    error: float
    converged: bool
    message: str


@dataclass(frozen=True, kw_only=True)
class MethodComparison:
    """Several methods on the same loops from the same starts, none of them helped by the grid."""

    rows: tuple[MethodRow, ...]

    def __str__(self) -> str:
        """The table, errors in percent."""
        lines = [f"{'start':16s}{'method':14s}{'iterations':>11s}{'evaluations':>12s}{'error':>10s}  converged"]
        for row in self.rows:
            lines.append(
                f"{row.start:16s}{row.method:14s}{row.iterations:11d}{row.evaluations:12d}{100 * row.error:>8.2f} %"
                f"  {'yes' if row.converged else 'no'}"
            )
        return "\n".join(lines)


def compare_methods(loops: Sequence[Loop], *, starts: Mapping[str, Law], weights: str = "range") -> MethodComparison:
    """Return the fits by the three methods to the same loops, from each start alone.

    A search that converged may still stand in a valley of its own: the error says which. A start from which a parameter moves
    nothing is a row with an infinite error and the reason.

    Args:
        loops: closed cycles of several amplitudes.
        starts: laws to begin at, by their names in the table; their classes say which laws are fitted.
        weights: as in `identify`.

    Raises:
        ValueError: the loops cannot be used, or there is no law to start at.
    """
    require_loops(loops)
    if not isinstance(starts, Mapping) or not starts or not all(isinstance(law, Law) for law in starts.values()):
        raise ValueError(f"`starts` must hold at least one law by a name, such as {{'guess': law}}, got {starts!r}.")
    return MethodComparison(
        rows=tuple(
            _row(loops, name, start, method, weights) for name, start in starts.items() for method in get_args(Method)
        )
    )


def _row(loops: Sequence[Loop], name: str, start: Law, method: Method, weights: str) -> MethodRow:
    try:
        fit = identify(loops, law=type(start), start=start, method=method, weights=weights, grid=False, profiles=False)
    except ValueError as failure:
        return MethodRow(
            method=method, start=name, iterations=0, evaluations=0, error=float("inf"), converged=False,
            message=str(failure),
        )  # fmt: skip
    return MethodRow(
        method=method, start=name, iterations=sum(stage.iterations for stage in fit.stages),
        evaluations=fit.evaluations, error=fit.residual, converged=fit.converged, message=fit.message,
    )  # fmt: skip
