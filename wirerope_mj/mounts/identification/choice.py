"""Choice of a law by residuals and amplitudes left out, and of a method by the cost of its searches."""

import math
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, fields, replace
from functools import partial
from itertools import product
from typing import Any, get_args

import numpy as np

from wirerope_mj.foundation.arrays import Array
from wirerope_mj.foundation.summary import Brief
from wirerope_mj.mounts.identification.families import require_law
from wirerope_mj.mounts.identification.identify import amplitude_groups, criterion, group_error, identify
from wirerope_mj.mounts.identification.measured import MeasuredLoop, prepare, require_loops
from wirerope_mj.mounts.identification.result import Identification
from wirerope_mj.mounts.identification.search import Method
from wirerope_mj.mounts.laws import AsymmetricBoucWen, BoucWen, EnhancedDryFriction, Law, Loop, Masing, SymmetricBoucWen, is_law

DECIDED = 10.0  # Difference of the criterion from which on it is very strong evidence (Kass and Raftery 1995)
FAR = 2.0  # Ratio of two laws' largest errors from which on one follows loops that the other does not
# Exponent of a fit's time over its number of parameters; time of a fit without an amplitude over that of the fit to all, at
# which it begins
GROWTH, REFIT = 2.5, 0.15
# The laws that are compared if none are named: from three parameters up.
USUAL: tuple[type[Law], ...] = (EnhancedDryFriction, BoucWen, SymmetricBoucWen, AsymmetricBoucWen, Masing)


@dataclass(frozen=True, kw_only=True)
class LawRow:
    """Fit of one law, its errors, and how far it is behind the best law."""

    law: str  # its name
    free: int = 0  # number of its free parameters
    # Bayesian information criterion, N ln(S / N) + p ln N, of all loops; infinite if the law could not be fitted
    criterion: float = math.inf
    behind: float = math.inf  # criterion minus that of the best law
    # root mean square of force minus measured force over half of the force range, of the fit to all loops at each amplitude,
    # (n_amplitudes,): the `residuals` of an identification
    errors: Array
    # the same, each of the fit to all other amplitudes, (n_amplitudes,); NaN where there is none
    errors_left_out: Array
    converged: bool = False  # whether all searches ended by themselves
    message: str  # how the fit to all loops ended, or why it failed
    fit: Identification | None = None  # the fit to all loops; None if it failed
    why_not_left_out: str = ""  # why a fit without one of the amplitudes failed; empty if all succeeded


@dataclass(frozen=True, kw_only=True, repr=False)
class LawComparison(Brief):
    """Comparison of several laws fitted to the same loops."""

    rows: tuple[LawRow, ...]  # one for each law, best criterion first
    amplitudes: Array  # the different amplitudes [m], smallest first, (n_amplitudes,)
    weights: str  # of the fits, as in `identify`

    @property
    def best(self) -> LawRow:
        """The law with the smallest criterion."""
        return self.rows[0]

    @property
    def most_general(self) -> LawRow:
        """Law whose largest error at an amplitude left out of its fit is smallest; the best law if none has such errors."""
        errors = [math.inf if np.isnan(row.errors_left_out).any() else row.errors_left_out.max() for row in self.rows]
        return self.rows[int(np.argmin(errors))]

    @property
    def recommended(self) -> LawRow:
        """The most general law, or the best law if it fits far better and has too few amplitudes to leave one out.

        Where the best law has errors on amplitudes left out, they count more than its criterion. Where it has none, its rivals'
        errors of the fit to all loops are as much as they can be held against: more than twice its own somewhere, with a
        criterion that is `DECIDED` behind, no rival's errors on amplitudes left out make up for.
        """
        best, general = self.best, self.most_general
        unknown = best.fit is not None and np.isnan(best.errors_left_out).any()
        far = general.behind >= DECIDED and bool(general.errors.max() > FAR * best.errors.max())
        return best if unknown and far else general

    def __str__(self) -> str:
        """The table, errors in percent of half the force range: of the fit to all loops, and on the amplitude left out."""
        heads = "".join(f"{1e3 * a:>9.3g} mm" for a in self.amplitudes)
        lines = [f"{'law':24s}{'free':>5s}{'BIC behind':>12s}  {'':10s}{heads}"]
        for row in self.rows:
            if row.fit is None:
                lines.append(f"{row.law:24s} not fitted: {row.message}")
                continue
            for number, (label, errors) in enumerate((("fitted", row.errors), ("left out", row.errors_left_out))):
                first = f"{row.law:24s}{row.free:5d}{row.behind:12.0f}" if number == 0 else " " * 41
                numbers = (f"{'-':>12s}" if np.isnan(e) else f"{100 * e:>10.1f} %" for e in errors)
                lines.append(f"{first}  {label:10s}" + "".join(numbers))
            if row.why_not_left_out:
                lines.append(f"{'':41s}  -: {row.why_not_left_out}")
        return "\n".join(lines)


def compare_laws(
    loops: Sequence[Loop], *, laws: Sequence[type[Law]] = USUAL, elements: int = 5, weights: str = "range",
    leave_out: bool = True, progress: Callable[[float], None] = lambda fraction: None,
) -> LawComparison:  # fmt: skip
    """Fit several laws to the same loops, and find their errors on amplitudes left out of a fit.

    The criterion is the Bayesian one. It takes samples as independent; where they are not, it exaggerates differences. The
    error on an amplitude left out does not, and counts more.

    The error of a loop is that of an identification: the root mean square of the law's force minus the measured one, both
    without their means, over half of the measured force range. The largest amplitude left out is predicted from smaller ones;
    of cycles beyond all tested ones no error here speaks.

    Args:
        loops: closed cycles of several amplitudes; those of one amplitude are left out together.
        laws: classes of laws.
        elements: Jenkin elements of a Masing law.
        weights: "range": loops count alike; "equal": a newton counts alike, as in the thesis, and small loops hardly count.
        leave_out: whether every amplitude is left out once: as many fits more.
        progress: takes the fraction of the work that is done.

    Raises:
        ValueError: the loops cannot be used, or no law is given.
    """
    require_loops(loops)
    if isinstance(laws, str) or not isinstance(laws, Sequence) or not laws:
        raise ValueError(f"`laws` must name at least one law, as a sequence of classes such as BoucWen, got {laws!r}.")
    for index, kind in enumerate(laws):
        require_law(kind, f"laws[{index}]")
    order = sorted(loops, key=lambda loop: float(np.ptp(loop.deflection)))
    measured = prepare(order, weights=weights)
    groups = amplitude_groups(measured)
    parameters = {kind: 2 * elements + 1 if kind is Masing else len(fields(kind)) for kind in laws}
    whole = sum(size**GROWTH for size in parameters.values()) * (1.0 + REFIT * len(groups) * leave_out)
    done = 0.0

    def fit(part: Sequence[Loop], *, law: type[Law], **how: Any) -> Identification:
        nonlocal done
        try:
            return identify(part, law=law, elements=elements, weights=weights, **how)
        finally:
            done += parameters[law] ** GROWTH * (1.0 if len(part) == len(order) else REFIT)
            progress(min(done / whole, 1.0))

    rows = [_row(partial(fit, law=kind), kind.name, order, measured, groups if leave_out else []) for kind in laws]
    least = min(row.criterion for row in rows)
    rows.sort(key=lambda row: row.criterion)
    rows = [replace(row, behind=math.inf if row.fit is None else row.criterion - least) for row in rows]
    sizes = np.array([np.mean([measured[index].amplitude for index in group]) for group in groups])
    return LawComparison(rows=tuple(rows), amplitudes=sizes, weights=weights)


def _row(
    fit_to: Callable[..., Identification], name: str, loops: Sequence[Loop], measured: Sequence[MeasuredLoop],
    left_out: Sequence[Sequence[int]],
) -> LawRow:  # fmt: skip
    """Fit one law and compute its errors at the amplitudes left out; `behind`, its distance to the best law, is not yet set."""
    groups = amplitude_groups(measured)
    errors = np.full(len(groups), np.nan)
    try:
        fit = fit_to(loops)
    except ValueError as failure:
        return LawRow(law=name, errors=errors, errors_left_out=errors, message=str(failure))
    converged, why_not = fit.converged, ""
    for number, group in enumerate(left_out):
        rest = [loop for index, loop in enumerate(loops) if index not in group]
        fit_rest = partial(fit_to, rest, method="time", profiles=False)
        try:
            if not rest:
                raise ValueError("there is only one amplitude.")
            try:  # from the fit to all, else from the grid
                refit = fit_rest(start=fit.law, grid=False)
            except ValueError:
                refit = fit_rest()
        except ValueError as failure:
            why_not = str(failure)
            continue
        errors[number] = group_error(refit.law, measured, group)
        converged = converged and refit.converged
    free = len(fit.uncertainty.free)
    return LawRow(
        law=name, free=free, criterion=criterion(fit, free),
        errors=np.array([group_error(fit.law, measured, group) for group in groups]), errors_left_out=errors,
        converged=converged, message=fit.message, fit=fit, why_not_left_out=why_not,
    )  # fmt: skip


@dataclass(frozen=True, kw_only=True)
class MethodRow:
    """Fit by one method from one start."""

    method: str  # "three-stage", "time" or "frequency"
    start: str
    iterations: int = 0  # steps of the searches, all stages together
    evaluations: int = 0  # of a residual, Jacobians included
    error: float = math.inf  # root mean square of force minus measured force, each loop's over its half force range [-]
    converged: bool = False  # whether the last search ended by itself
    message: str  # how it ended


@dataclass(frozen=True, kw_only=True)
class MethodComparison:
    """Comparison of several methods on the same loops from the same starts, without the grid."""

    rows: tuple[MethodRow, ...]

    def __str__(self) -> str:
        """The table, errors in percent."""
        lines = [f"{'start':16s}{'method':14s}{'iterations':>11s}{'evaluations':>12s}{'error':>10s}  converged"]
        for row in self.rows:
            counts = f"{row.iterations:11d}{row.evaluations:12d}{100 * row.error:>8.2f} %"
            lines.append(f"{row.start:16s}{row.method:14s}{counts}  {'yes' if row.converged else 'no'}")
        return "\n".join(lines)


def compare_methods(loops: Sequence[Loop], *, starts: Mapping[str, Law], weights: str = "range") -> MethodComparison:
    """Fit by the three methods to the same loops, from each start alone.

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
    if not isinstance(starts, Mapping) or not starts or not all(map(is_law, starts.values())):
        raise ValueError(f"`starts` must hold at least one law by a name, such as {{'guess': law}}, got {starts!r}.")
    rows = []
    for (name, start), method in product(starts.items(), get_args(Method)):
        try:
            fit = identify(loops, law=type(start), start=start, method=method, weights=weights, grid=False, profiles=False)
        except ValueError as failure:
            rows.append(MethodRow(method=method, start=name, message=str(failure)))
        else:
            rows.append(
                MethodRow(
                    method=method, start=name, iterations=sum(stage.iterations for stage in fit.stages),
                    evaluations=fit.evaluations, error=fit.residual, converged=fit.converged, message=fit.message,
                )
            )  # fmt: skip
    return MethodComparison(rows=tuple(rows))
