"""Uncertainty of the scatter of a few specimens: what as many others of the same make might have shown."""

import math
from collections.abc import Sequence
from dataclasses import replace

import numpy as np
import scipy

from wirerope_mj.foundation.arguments import integer
from wirerope_mj.mounts.isolator import Isolator, Spread
from wirerope_mj.studies.vary.distributions import Specimens
from wirerope_mj.studies.vary.quantity import Quantity
from wirerope_mj.studies.vary.sampling import RANK, sampled

_UNTESTED = ("catalogue", "estimated")  # kinds of isolators whose scatter is no specimens'


def rank(spread: Spread) -> int:
    """Return in how many independent directions the parameters scatter; of n specimens that is n - 1 at most."""
    covariance = np.array(spread.covariance)
    sizes = np.sqrt(np.diag(covariance))
    kept = sizes > 0.0
    values = np.linalg.eigvalsh(covariance[np.ix_(kept, kept)] / np.outer(sizes[kept], sizes[kept]))
    return int((values > RANK * values.max(initial=0.0)).sum())


def known_specimens(spread: Spread) -> int | None:
    """Return of how many specimens the covariance is; None if of full rank, so of any number above that, or calibrated."""
    directions = rank(spread)
    return directions + 1 if directions < len(spread.parameters) and not spread.calibrated else None


def deviation_bounds(specimens: int, *, confidence: float = 0.95) -> tuple[float, float]:
    """Return by which factors the true standard deviation may differ from that of some specimens, lower and upper bound.

    (n - 1) s^2 / sigma^2 of n normal specimens is chi-squared with n - 1 degrees of freedom.
    """
    specimens = integer("specimens", specimens, least=2)
    tail = (1.0 - confidence) / 2.0
    low, high = scipy.stats.chi2.ppf([tail, 1.0 - tail], specimens - 1)
    return math.sqrt((specimens - 1) / high), math.sqrt((specimens - 1) / low)


def specimen_messages(quantities: Sequence[Quantity]) -> list[str]:
    """Return for every isolator whose specimens vary how well their scatter is known at all."""
    isolators = {
        one.name: one for quantity in quantities if isinstance(quantity.distribution, Specimens) for one in quantity.isolators
    }
    return [text for one in isolators.values() if one.spread is not None and (text := _message(one, one.spread))]


def _message(isolator: Isolator, spread: Spread) -> str:
    name, kind = isolator.name, isolator.provenance.kind
    if spread.calibrated:
        return f"Specimens of {name}: drawn from what its calibration leaves open; specimens of one make scatter besides."
    if kind in _UNTESTED:
        return f"Specimens of {name} ({kind}): none were tested; they are drawn from the scatter that its file assumes."
    specimens = known_specimens(spread)
    if specimens is None or specimens < 2:
        return ""
    low, high = deviation_bounds(specimens)
    return (
        f"Specimens of {name}: {len(spread.parameters)} parameters scatter along {specimens - 1} directions, so they come from "
        f"{specimens} specimens: the true standard deviations are {low:.2g} to {high:.2g} times those (95 % confidence), and "
        "percentiles are no better known; `redrawn` shows what as many others might have given."
    )


def redrawn(isolator: Isolator, *, seed: int, specimens: int | None = None) -> Isolator:
    """Return the isolator that as many other specimens of the same make might have given.

    They are sampled from the isolator's own spread; their mean and covariance replace parameters and spread. Studies with
    several seeds show how far a result hangs on the specimens that happened to be tested (a parametric bootstrap).

    Args:
        isolator: with a [spread].
        seed: of the sample.
        specimens: how many were tested, >= 2; None if fewer than there are parameters, which the covariance then shows.

    Raises:
        ValueError: the isolator has no spread, or an argument is out of range, or a parameter leaves its law's range.
    """
    if isolator.spread is None:
        raise ValueError(f"isolator {isolator.name!r} has no [spread].")
    if specimens is None:
        specimens = known_specimens(isolator.spread)
        if specimens is None:
            raise ValueError(f"`specimens` must be given: the [spread] of {isolator.name!r} does not say how many there were.")
    specimens = integer("specimens", specimens, least=2)
    normals = np.random.default_rng(seed).standard_normal((specimens, len(isolator.spread.parameters)))
    values = sampled(isolator, normals)
    laws: dict[str, dict[str, float]] = {}
    for name, value in zip(isolator.spread.parameters, values.mean(axis=0), strict=True):
        axis, _, key = name.partition(".")
        laws.setdefault(axis, {})[key] = float(value)
    covariance = np.atleast_2d(np.cov(values, rowvar=False))
    return replace(
        isolator,
        spread=replace(isolator.spread, covariance=tuple(tuple(float(one) for one in row) for row in covariance)),
        **{axis: replace(law, **law.completed(laws[axis])) for axis, law in isolator.axes.items() if law and axis in laws},  # type: ignore[arg-type]
    )
