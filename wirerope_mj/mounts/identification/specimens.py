"""Nominally equal isolators: one law for all specimens, and the scatter of its parameters between specimens."""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass

import numpy as np

from wirerope_mj.foundation.arguments import one_of
from wirerope_mj.foundation.arrays import Array
from wirerope_mj.foundation.summary import Brief
from wirerope_mj.mounts.identification.families import family_of
from wirerope_mj.mounts.identification.identify import Identification, identify
from wirerope_mj.mounts.identification.measured import require_loops
from wirerope_mj.mounts.identification.scales import scales_family
from wirerope_mj.mounts.isolator import Spread
from wirerope_mj.mounts.laws import AsymmetricBoucWen, Law, Loop

FEWEST = 2  # Specimens below which there is no scatter to speak of
# Relative step of the differences that carry standard errors over to the law's own parameters: smooth, one-line formulas.
STEP = 1e-6


@dataclass(frozen=True, kw_only=True)
class SpecimenRow:
    """One parameter of the law over the specimens."""

    parameter: str  # its name, as in an isolator file
    nominal: float  # value of the fit to all loops together
    mean: float  # mean of the specimens' values
    deviation: float  # their standard deviation
    # the component of it that the noise of the tests alone makes: root mean square of the fits' standard errors
    fit_error: float
    values: tuple[float, ...]  # one for each specimen


@dataclass(frozen=True, kw_only=True, repr=False)
class SpecimenFits(Brief):
    """Fits to several specimens of one isolator, and the scatter of their parameters."""

    nominal: Identification  # fit to the loops of all specimens
    each: tuple[Identification, ...]  # fit to the loops of each
    rows: tuple[SpecimenRow, ...]  # one for each parameter of the law that differs from specimen to specimen
    covariance: Array  # of these parameters over the specimens (n - 1 in the denominator), in the order of the rows

    @property
    def law(self) -> Law:
        return self.nominal.law

    @property
    def correlation(self) -> Array:
        """Correlation of these parameters over the specimens, (n, n)."""
        deviations = np.array([row.deviation for row in self.rows])
        return self.covariance / np.outer(deviations, deviations)

    def spread(self, axis: str) -> Spread:
        """Write the scatter as an isolator file keeps it, its parameters named "axial.alpha" and so on by the tested axis."""
        one_of("axis", axis, ("roll", "shear", "axial"))
        names = tuple(f"{axis}.{row.parameter}" for row in self.rows)
        return Spread(parameters=names, covariance=tuple(map(tuple, self.covariance.tolist())))

    def __str__(self) -> str:
        """The table: nominal value, mean, scatter, and the fraction of it that is the tests' noise."""
        lines = [f"{'parameter':16s}{'nominal':>13s}{'mean':>13s}{'deviation':>13s}{'of mean':>9s}{'of the fits':>13s}"]
        for row in self.rows:
            relative = abs(row.deviation / row.mean) if row.mean else np.inf
            sizes = f"{row.nominal:13.5g}{row.mean:13.5g}{row.deviation:13.3g}{100 * relative:7.1f} %{row.fit_error:13.2g}"
            lines.append(f"{row.parameter:16s}{sizes}")
        return "\n".join(lines)


def identify_specimens(
    specimens: Sequence[Sequence[Loop]], *, law: type[Law] = AsymmetricBoucWen, scales: int = 1,
    shared: Sequence[str] = (), elements: int = 5, weights: str = "range",
) -> SpecimenFits:  # fmt: skip
    """Find the nominal law of several specimens and the covariance of its parameters over them.

    The covariance is that of the law's own parameters, about their mean; noise of the tests is in it, and is stated beside it.
    Parameters of a Bouc-Wen law hang on its n: with z in newtons, a tenth more of it halves beta. Where the specimens are of
    one make, share it.

    Args:
        specimens: the loops of each specimen.
        law: class of the law.
        scales: of friction, as in `identify`; parameters are then named "laws[0].alpha" and so on.
        shared: coordinates of the search, such as "n" or "sigma", that all specimens have in common: fitted to all loops
            together, then fixed.
        elements: Jenkin elements of a Masing law.
        weights: as in `identify`.

    Raises:
        ValueError: there are fewer than two specimens, one of them cannot be used, all are the same, or `shared` names
            no coordinate.
    """
    if not isinstance(specimens, Sequence) or isinstance(specimens, str):
        raise ValueError(f"`specimens` must be the loops of each specimen, got {specimens!r}.")
    for index, loops in enumerate(specimens):
        if isinstance(loops, Loop):
            raise ValueError("`specimens` must be a sequence of loops for each specimen, got loops: [loops_1, loops_2, ...].")
        require_loops(loops, f"specimens[{index}]")
    if isinstance(shared, str):
        raise ValueError(f"`shared` must be a sequence of names, got the string {shared!r}; put it into brackets.")
    if len(specimens) < FEWEST:
        raise ValueError(f"`specimens` must hold the loops of {FEWEST} at least, got {len(specimens)}.")
    all_loops = [loop for loops in specimens for loop in loops]
    nominal = identify(all_loops, law=law, scales=scales, elements=elements, weights=weights)
    for name in shared:
        if name not in nominal.parameters:
            raise ValueError(f"`shared` names {name!r}; {law.name} is searched for by {', '.join(nominal.parameters)}.")
    fixed = {name: nominal.parameters[name].value for name in shared}
    each = []
    for number, loops in enumerate(specimens, start=1):
        try:
            # Specimens are alike: each begins at what fits all of them.
            fit = identify(
                loops, law=law, scales=scales, start=nominal.law, fixed=fixed, elements=elements, weights=weights,
                method="time", grid=False,
            )  # fmt: skip
        except ValueError as failure:
            raise ValueError(f"specimen {number}: {failure}") from failure
        each.append(fit)
    centre, tables = own_parameters(nominal.law), [own_parameters(fit.law) for fit in each]
    if len({tuple(table.values()) for table in tables}) == 1:
        raise ValueError("`specimens` do not differ: all give the same law to the last digit. Is one given several times?")
    family = scales_family(law, nominal.scales) if nominal.scales else family_of(law, elements)
    errors = []  # of the law's own parameters, those of the search carried over by their slopes
    for fit in each:
        values = family.read(fit.law)
        before = own_parameters(family.make(values))
        slopes: dict[str, list[float]] = {name: [] for name in before}
        for name in fit.uncertainty.free:
            step = STEP * max(abs(values[name]), fit.parameters[name].standard_error, 1e-12)
            after = own_parameters(family.make(values | {name: values[name] + step}))
            for parameter, value in after.items():
                slopes[parameter].append((value - before[parameter]) / step)
        variances = {name: np.array(row) @ fit.uncertainty.covariance @ np.array(row) for name, row in slopes.items()}
        errors.append({name: float(np.sqrt(max(variance, 0.0))) for name, variance in variances.items()})
    names = [name for name in centre if len({table[name] for table in tables}) > 1]
    scatter = np.array([[table[name] for name in names] for table in tables])
    covariance = np.atleast_2d(np.cov(scatter, rowvar=False))
    rows = tuple(
        SpecimenRow(
            parameter=name, nominal=centre[name], mean=float(scatter[:, index].mean()),
            deviation=float(np.sqrt(covariance[index, index])),
            fit_error=float(np.sqrt(np.mean([error[name] ** 2 for error in errors]))),
            values=tuple(scatter[:, index].tolist()),
        )
        for index, name in enumerate(names)
    )  # fmt: skip
    return SpecimenFits(nominal=nominal, each=tuple(each), rows=rows, covariance=covariance)


def joint_spread(axes: Mapping[str, SpecimenFits]) -> Spread:
    """Join the scatter of the same specimens tested along several axes, their correlation included.

    Args:
        axes: specimens by "roll", "shear" or "axial", in the same order on every axis.

    Raises:
        ValueError: there are no axes, or not the same number of specimens on each.
    """
    if len({len(fits.each) for fits in axes.values()}) != 1:
        counts = ", ".join(f"{axis} {len(fits.each)}" for axis, fits in axes.items())
        raise ValueError(f"`axes` must hold the same specimens on every axis, got {counts or 'none'}.")
    names = [name for axis, fits in axes.items() for name in fits.spread(axis).parameters]
    values = np.array([row.values for fits in axes.values() for row in fits.rows])
    covariance = np.atleast_2d(np.cov(values))
    return Spread(parameters=tuple(names), covariance=tuple(map(tuple, covariance.tolist())))


def own_parameters(law: Law) -> dict[str, float]:
    """List a law's own parameters by the names of its file: "stiffness[0]" of a list, "laws[0].alpha" in parallel."""
    values: dict[str, float] = {}
    if len(law.components) > 1:
        each = [own_parameters(part) for part in law.components]
        return {f"laws[{index}].{name}": value for index, part in enumerate(each) for name, value in part.items()}
    for name, value in law.to_dict().items():
        if isinstance(value, list | tuple):
            values |= {f"{name}[{index}]": float(number) for index, number in enumerate(value)}
        elif not isinstance(value, str):
            values[name] = float(value)
    return values
