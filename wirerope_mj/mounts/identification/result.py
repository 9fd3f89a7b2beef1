"""An identification: the law, its parameters with errors, its range of validity, and its loops beside the measured loops."""

import math
from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from wirerope_mj.foundation.arrays import Array
from wirerope_mj.foundation.summary import Summarised
from wirerope_mj.foundation.units import significant
from wirerope_mj.mounts.identification.families import RESOLVED
from wirerope_mj.mounts.identification.measured import MeasuredLoop
from wirerope_mj.mounts.identification.scales import yield_deflection
from wirerope_mj.mounts.identification.search import Stage, rms
from wirerope_mj.mounts.identification.uncertainty import Parameter, Uncertainty
from wirerope_mj.mounts.isolator import MeasuredRange
from wirerope_mj.mounts.isolator.travel import falling_text
from wirerope_mj.mounts.laws import AsymmetricBoucWen, Law, Loop
from wirerope_mj.mounts.laws.bouc_wen import Normalised

_WINDOW = 0.1  # of a cycle, over which a rate is taken: a sine's is 1.6 % less than at an instant, noise hardly shows


def measured_range(loops: Sequence[MeasuredLoop]) -> MeasuredRange:
    """Find the amplitudes, deflections, frequencies and largest rates of loops."""
    periods = [loop.period for loop in loops if loop.period is not None]
    rates = [rate for loop in loops if (rate := largest_rate(loop)) is not None]
    return MeasuredRange(
        amplitude=(min(loop.amplitude for loop in loops), max(loop.amplitude for loop in loops)),
        deflection=(min(float(loop.deflection.min()) for loop in loops), max(float(loop.deflection.max()) for loop in loops)),
        frequency=(1.0 / max(periods), 1.0 / min(periods)) if periods else None,
        rate=(min(rates), max(rates)) if rates else None,
    )


def largest_rate(loop: MeasuredLoop) -> float | None:
    """Find the largest deflection rate of a loop over a tenth of its cycle [m/s]; None where its time is not known."""
    if loop.period is None or not loop.elapsed.size:
        return None
    phase = np.linspace(0.0, 1.0, 201)[:-1]
    x = np.interp(phase, loop.elapsed, loop.deflection)
    step = round(_WINDOW * phase.size)
    return float(np.abs(np.roll(x, -step) - x).max()) / (_WINDOW * loop.period)


def validity_of(law: Law, loops: Sequence[MeasuredLoop]) -> str:
    """State the range of validity of a law fitted to loops, smallest first: tested cycles, and if small cycles are resolved.

    Half of a Bouc-Wen law's slope at z = 0, alpha, is lost at the deflection x_y (1/2)^(1/n). Where that is within 2 % of the
    least amplitude no sample shows the slope, and alpha and n follow from the bend further on alone.
    """
    measured, least = measured_range(loops), 1e3 * loops[0].amplitude
    pace = f" ({measured.pace})" if measured.pace else ""
    text = (
        f"valid for cycles of {measured.text}, which were tested{pace}, not below {least:.3g} mm; extrapolated beyond, where "
        "the error of the fit says nothing"
    )
    forms = [form for scale in law.components if (form := scale.normal_form) is not None]
    if len(forms) < len(law.components):
        return text
    form = min(forms, key=_half_slope)  # of several scales the one that shows least
    half = 1e3 * _half_slope(form)
    if half > RESOLVED * least:
        return text
    return (
        f"{text}. With n = {form.n:.3g} half of the slope alpha is lost within {half:.2g} mm, less than "
        f"{100.0 * RESOLVED:g} % of the least amplitude, which its samples do not show: the stiffness of smaller cycles is a "
        "guess"
    )


def _half_slope(form: Normalised) -> float:
    """Deflection over which half of the slope at z = 0 is lost [m]."""
    return form.x_y * 0.5 ** (1.0 / form.n)


BEYOND = 2.0  # Times the tested deflections up to which a law is checked: a shock goes there
# Times the misfit of the asymmetric law within which peaks of shocks within the tested travel were for 90 % of 20
# foreign devices, and then for 18 and 20 of 20 others: `python tests/prediction_errors.py 20`, seeds 1 and 101.
OF_DEFLECTION, OF_ACCELERATION = 8.6, 2.0


@dataclass(frozen=True, kw_only=True)
class ScaleRow:
    """Trial of a number of scales of friction."""

    count: int  # of scales
    free: int  # number of free parameters
    criterion: float  # Bayesian information criterion of all loops; infinite if there is no fit
    # error at the amplitude left out over its force's root mean square, geometric mean over the amplitudes [-]
    left_out: float
    why_not: str = ""  # why there is no fit; empty if there is


@dataclass(frozen=True, kw_only=True, repr=False)
class Identification(Summarised):
    """A law found from cyclic tests."""

    law: Law  #: the law
    #: coordinates of the search, by name, in normalised form: value, unit, standard error, whether at a bound
    parameters: dict[str, Parameter]
    residual: float  #: root mean square of force minus measured force, each loop's over its half force range [-]
    residuals: Array  #: the same for each loop, smallest amplitude first, (n_loops,)
    converged: bool  #: whether the search ended by itself
    message: str  #: how it ended
    non_identifiable: tuple[str, ...]  #: a message for each combination of parameters that the data do not identify
    uncertainty: Uncertainty  #: covariance, correlation and singular values
    stages: tuple[Stage, ...]  #: those of the best start
    evaluations: int  #: of the residual in all
    started: str  #: "given" or "grid": the best start
    loops: tuple[MeasuredLoop, ...]  #: as they were fitted, smallest first
    #: names of the scales of friction, in the order of the law's components; empty for one scale
    scales: tuple[str, ...] = ()
    scale_rows: tuple[ScaleRow, ...] = ()  #: numbers of scales that were tried, if the data were to say how many

    def _summary(self) -> tuple[str, dict[str, str]]:
        ended = "converged" if self.converged else "NOT CONVERGED"
        lines = {
            p.name: f"{p.value:.6g} {p.unit}" + (" (given)" if p.fixed else f" +- {p.standard_error:.2g}")
            for p in self.parameters.values()
        }
        error = f"error {100.0 * self.residual:.3g} % of half the force range over {len(self.loops)} loops"
        kind = type(self.law.components[0]).__name__ if self.scales else type(self.law).__name__
        kind = f"{len(self.scales)} scales of {kind}" if self.scales else kind
        return f"Identification of {kind}: {ended}, {error}", lines

    @property
    def measured(self) -> MeasuredRange:
        """The amplitudes, deflections, frequencies and rates of the loops, as an isolator file keeps them."""
        return measured_range(self.loops)

    @property
    def insignificant(self) -> tuple[str, ...]:
        """Names of the free parameters that lie within two of their standard errors of zero, and not at a bound."""
        free = [p for p in self.parameters.values() if not p.fixed and not p.at_bound]
        return tuple(p.name for p in free if abs(p.value) < 2.0 * p.standard_error)

    @property
    def validity(self) -> str:
        """The amplitudes and deflections for which the law is valid, as text."""
        return validity_of(self.law, self.loops)

    @property
    def misfit(self) -> float:
        """Systematic error of the law, rms over half the force range [-]: the part of residuals that neighbours share."""
        fits = fitted_loops(self)
        of_noise = 2.0 / math.sqrt(sum(fit.residual.size for fit in fits))  # correlation that noise alone may show
        return self.residual * math.sqrt(max(neighbours_correlation(fits), of_noise))

    @property
    def prediction(self) -> str:
        """Expected error of shock peaks within the tests, as text; "" for laws whose errors were not measured."""
        if type(self.law) is not AsymmetricBoucWen:
            return ""
        error = self.misfit
        deflection, acceleration = (significant(100.0 * factor * error, 2) for factor in (OF_DEFLECTION, OF_ACCELERATION))
        return (
            f"peaks of a shock within the tested deflections are expected within {deflection} % of deflection and "
            f"{acceleration} % of acceleration, {OF_DEFLECTION:g} and {OF_ACCELERATION:g} times the error of the fit "
            f"beyond noise ({100.0 * error:.2g} %): so it was for 9 of 10 devices that this law does not describe; beyond the "
            "tests nothing is known"
        )

    @property
    def yields(self) -> str:
        """The yield deflection of every scale of friction, as text; empty for one scale."""
        pairs = zip(self.scales, self.law.components, strict=False)
        return ", ".join(f"{name} scale {1e3 * yield_deflection(law):.3g} mm" for name, law in pairs)

    @property
    def falling(self) -> str:
        """Deflections beyond which the tangent stiffness is negative, within twice the tested deflections, as text; else ""."""
        low, high = self.measured.deflection
        return falling_text(self.law, BEYOND * min(low, 0.0), BEYOND * max(high, 0.0))

    def __str__(self) -> str:
        """Summarise law, error, parameters with units and errors, what is not identifiable, and the range of validity."""
        lines = [
            repr(self.law),
            f"error {100.0 * self.residual:.3g} % of half the force range over {len(self.loops)} loops; "
            f"{'converged' if self.converged else 'NOT CONVERGED'}, {self.message}",
            f"{'parameter':18s}{'value':>14s}{'standard error':>16s}  unit",
        ]
        for p in self.parameters.values():
            error = "given" if p.fixed else f"{p.standard_error:.2g}"
            note = "  at its bound" if p.at_bound else ""
            lines.append(f"{p.name:18s}{p.value:14.6g}{error:>16s}  {p.unit}{note}")
        if self.scales:
            lines.append(f"yield deflections: {self.yields}")
        lines += [f"not identifiable: {text}" for text in self.non_identifiable]
        if self.insignificant:
            lines.append(f"not significant: {', '.join(self.insignificant)}")
        return "\n".join([*lines, self.validity, *filter(None, [self.prediction, self.falling])])


@dataclass(frozen=True, kw_only=True)
class FittedLoop:
    """One measured loop, without the zero of the load cell, and the law's loop on its path."""

    measured: Loop
    fitted: Loop
    zero: float  # of the load cell, taken out [N]: the mean of measured minus fitted

    @property
    def residual(self) -> Array:
        return (self.fitted.force - self.measured.force) / (0.5 * float(np.ptp(self.measured.force)))

    @property
    def error(self) -> float:
        return rms(self.residual)


def neighbours_correlation(fits: Sequence[FittedLoop]) -> float:
    """Correlate neighbouring residuals [-]: about 0 for noise, towards 1 where the law cannot follow."""
    products = sum(float(fit.residual[1:] @ fit.residual[:-1]) for fit in fits)
    return products / max(sum(float(fit.residual[1:] @ fit.residual[1:]) for fit in fits), 1e-300)


def fitted_loops(result: Identification) -> list[FittedLoop]:
    """Pair every measured loop of an identification with the law's loop on the same path, smallest first."""
    fits = []
    for loop in result.loops:
        force = loop.model_force(result.law)
        zero = float(np.mean(loop.force - force))
        measured, fitted = (Loop.from_samples(loop.deflection, values) for values in (loop.force - zero, force))
        fits.append(FittedLoop(measured=measured, fitted=fitted, zero=zero))
    return fits
