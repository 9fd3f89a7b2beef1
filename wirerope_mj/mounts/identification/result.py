"""What an identification found: the law, its parameters with errors, and what the data leave open."""

from dataclasses import dataclass

from wirerope_mj.foundation.arrays import Array
from wirerope_mj.foundation.summary import Summarised
from wirerope_mj.mounts.identification.measured import MeasuredLoop
from wirerope_mj.mounts.identification.stages import Stage
from wirerope_mj.mounts.identification.uncertainty import Certainty, Parameter
from wirerope_mj.mounts.identification.validity import validity_of
from wirerope_mj.mounts.laws import Law


@dataclass(frozen=True, kw_only=True, repr=False)
class Identification(Summarised):
    """A law found from cyclic tests.

    Attributes:
        law: the law.
        parameters: what was searched for, by name, in normalised form: value, unit, standard error, whether at a bound.
        residual: root mean square of force minus measured force, each loop's over its half force range [-].
        residuals: the same for each loop, smallest amplitude first, (n_loops,).
        converged: whether the search ended by itself.
        message: how it ended.
        open_combinations: what the data leave open, in words; empty if they fix everything.
        certainty: covariance, correlation and singular values.
        stages: what every stage of the winning start did.
        evaluations: how often the residual was computed in all.
        started: "given" or "grid": which start won.
        loops: what was fitted, smallest first.
    """

    law: Law
    parameters: dict[str, Parameter]
    residual: float
    residuals: Array
    converged: bool
    message: str
    open_combinations: tuple[str, ...]
    certainty: Certainty
    stages: tuple[Stage, ...]
    evaluations: int
    started: str
    loops: tuple[MeasuredLoop, ...]

    def _summary(self) -> tuple[str, dict[str, str]]:
        ended = "converged" if self.converged else "NOT CONVERGED"
        lines = {
            p.name: f"{p.value:.6g} {p.unit}" + (" (given)" if p.fixed else f" +- {p.standard_error:.2g}")
            for p in self.parameters.values()
        }
        error = f"error {100.0 * self.residual:.3g} % of half the force range over {len(self.loops)} loops"
        return f"Identification of {type(self.law).__name__}: {ended}, {error}", lines

    @property
    def validity(self) -> str:
        """The amplitudes and deflections for which the law stands, in words."""
        return validity_of(self.law, self.loops)

    def __str__(self) -> str:
        """The law, how well it fits, its parameters with units and errors, what is open, and its range of validity."""
        lines = [
            repr(self.law),
            f"error {100.0 * self.residual:.3g} % of half the force range over {len(self.loops)} loops; "
            f"{'converged' if self.converged else 'NOT CONVERGED'}, {self.message}",
            f"{'parameter':12s}{'value':>14s}{'standard error':>16s}  unit",
        ]
        for p in self.parameters.values():
            error = "given" if p.fixed else f"{p.standard_error:.2g}"
            note = "  at its bound" if p.at_bound else ""
            lines.append(f"{p.name:12s}{p.value:14.6g}{error:>16s}  {p.unit}{note}")
        return "\n".join([*lines, *(f"open: {words}" for words in self.open_combinations), self.validity])
