"""An isolator with an identified law, and the provenance of it."""

from collections.abc import Mapping, Sequence
from dataclasses import replace
from pathlib import Path
from typing import Any

from wirerope_mj.mounts.identification.result import Identification, fitted_loops
from wirerope_mj.mounts.isolator import Isolator, Provenance, Validity
from wirerope_mj.mounts.isolator.falling import falling_text
from wirerope_mj.mounts.laws import AsymmetricBoucWen


def identified_isolator(
    result: Identification,
    *,
    name: str,
    axis: str,
    files: Sequence[Path],
    given: Sequence[str],
    known: Isolator | None = None,
    whole: Isolator | None = None,
) -> Isolator:
    """Return an isolator with the law of an identification on an axis.

    Args:
        result: of the identification.
        name: of the isolator.
        axis: "roll", "shear" or "axial", the axis that was tested.
        files: records that were fitted.
        given: what was given to the fit, one text each.
        known: isolator whose law on the axis was known; its limits, geometry and other axes stay.
        whole: isolator to which the axis is added, or whose axis is replaced; all else of it stays, too.
    """
    fits = fitted_loops(result)
    sizes = ", ".join(f"{1e3 * fit.amplitude:.3g} ({100.0 * fit.error:.2g} %)" for fit in fits)
    points = sorted({round(1e3 * fit.operating_point, 1) + 0.0 for fit in fits})
    assumed = [*assumptions(result, given), *(f"the data do not identify: {text}" for text in result.non_identifiable)]
    if falling := result.falling or falling_in_rating(result, axis, whole or known):
        assumed.append(f"{falling}: the law does not hold there")
    if not result.converged:
        assumed.append(f"the fit did not converge ({result.message})")
    provenance = Provenance(
        kind="identified",
        source=f"cyclic tests: {', '.join(path.name for path in files)}",
        fitted_to=(
            f"{axis} force over cycles of amplitude [mm] (error of the force over half its range) {sizes}, "
            f"about {', '.join(f'{point:g}' for point in points)} mm; {result.validity}"
        ),
        assumed=tuple(assumed),
    )
    axes: Mapping[str, Any] = {axis: result.law}
    if whole is not None:
        validity = replace(whole.validity, **{axis: result.measured})
        before = whole.provenance
        provenance = replace(
            provenance,
            source=_both(before.source, provenance.source),
            fitted_to=_both(before.fitted_to, provenance.fitted_to),
            assumed=(*before.assumed, *(f"{axis}: {text}" for text in provenance.assumed)),
        )
        return replace(whole, name=name, provenance=provenance, spread=None, validity=validity, **axes)
    if known is None:
        return Isolator(name=name, provenance=provenance, validity=Validity(**{axis: result.measured}), **axes)
    both = result.measured.joined(known.validity.stated.get(axis))
    validity = replace(known.validity, **{axis: both})
    return replace(known.conditioned, name=name, provenance=provenance, spread=None, validity=validity, **axes)


def falling_in_rating(result: Identification, axis: str, rated: Isolator | None) -> str:
    """Return from which deflections on the tangent stiffness is negative within the rated travel alone, as text.

    "" where it is not, where no isolator says a rating, and where it already is within twice what was tested, as the fit says.
    """
    if rated is None or result.falling:
        return ""
    below, above = (travel or 0.0 for travel in rated.rated_travel(axis))
    return falling_text(result.law, -below, above)


def _both(before: str, now: str) -> str:
    """Return what is said of other axes before what is said of this one."""
    return f"{before}; {now}" if before else now


def assumptions(result: Identification, given: Sequence[str]) -> list[str]:
    """Return the assumptions of a fit, one text each."""
    texts = [f"{text}: given, not fitted" for text in given]
    if isinstance(result.law.components[-1], AsymmetricBoucWen):
        texts.append("b = e: of b and c only the product c ln b acts on the force")
    return [*texts, "the force's zero: the mean of each loop's force was free, so that the law has no force unloaded"]
