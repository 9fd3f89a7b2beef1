"""An isolator file of an estimate: fitted as a vendor's row is, and saying that nothing in it was measured."""

from dataclasses import replace

import numpy as np

from wirerope_mj.mounts.estimate.estimate import LoopEstimate
from wirerope_mj.mounts.estimate.trends import left_out_errors
from wirerope_mj.mounts.estimate.vendor_loops import ENIDINE
from wirerope_mj.mounts.isolator import Isolator, Provenance, Rotation, Spread
from wirerope_mj.mounts.vendor_parts.parts import ModeValues, Series, VendorPart
from wirerope_mj.mounts.vendor_parts.secants import NiLaw
from wirerope_mj.mounts.vendor_parts.sheet_fit import fit_part

# Parameters of the fitted laws that grow with the force; those of their shape (beta with n = 1, b, c) do not.
_FORCES = ("alpha", "k1", "k2", "k3")
_AXIS_VALUE = {"roll": "shear shock", "shear": "shear shock", "axial": "compression shock"}


def estimated_isolator(estimate: LoopEstimate, name: str | None = None) -> Isolator:
    """Return an isolator with the estimated values; its spread is the scatter of the estimates of known parts.

    Raises:
        ConvergenceError: no law has all the values.
    """
    values = estimate.values
    modes = {
        mode: ModeValues(
            static_load=_rounded(values.static_load) if mode == "compression" else None,
            travel=_rounded(values.travel[mode]),
            vibration=_rounded(values.vibration[mode]),
            shock=_rounded(values.shock[mode]),
        )
        for mode in values.travel
    }
    title = name or f"estimated, {estimate.loops} loops of {1e3 * estimate.rope:g} mm rope"
    part = VendorPart(
        name=title,
        series=Series(file="", source=_source(estimate), damping=ENIDINE.damping, damping_range=ENIDINE.damping_range),
        loops=estimate.loops,
        rope=estimate.rope,
        height=estimate.height,
        width=estimate.width,
        bar=estimate.bar,
        modes=modes,
    )
    fitted = fit_part(part, scales=1)
    provenance = Provenance(
        kind="estimated",
        source=_source(estimate),
        fitted_to=f"estimated values, none of them measured: {fitted.provenance.fitted_to}",
        assumed=(*_assumed(estimate), *fitted.provenance.assumed),
    )
    rotation = None
    if estimate.bar_length is not None and isinstance(fitted.axial, NiLaw) and isinstance(fitted.roll, NiLaw):
        # Their elastic part alone, as in a fitted file: what small vibration has beyond it is friction.
        along, across = fitted.axial.k1 / values.vibration["compression"], fitted.roll.k1 / values.vibration["shear"]
        about_roll, about_shear, about_axial = estimate.rotation.tolist()
        rotation = Rotation(
            roll=_rounded(along * about_roll), shear=_rounded(along * about_shear), axial=_rounded(across * about_axial)
        )
    geometry = fitted.geometry
    if geometry is not None and estimate.bar_assumed:
        geometry = replace(geometry, bar=None)
    return replace(
        fitted, provenance=provenance, spread=_spread(fitted, estimate), rotation=rotation, geometry=geometry
    )


def _rounded(value: float) -> float:
    """Return four digits of an estimate: more would look like knowledge."""
    return float(f"{value:.4g}")


def _source(estimate: LoopEstimate) -> str:
    """Return the source of the values."""
    return (
        f"geometry alone (height {1e3 * estimate.height:g} mm, width {1e3 * estimate.width:g} mm, bar "
        f"{1e3 * estimate.bar:.4g} mm, rope {1e3 * estimate.rope:g} mm, {estimate.loops} loops), by what 50 parts of the "
        "Enidine WR catalogue have in common; no data sheet, no measurement"
    )


def _assumed(estimate: LoopEstimate) -> tuple[str, ...]:
    """Return the assumptions, with the errors of such estimates."""
    band = estimate.bands["compression shock"]
    other = f", of VMC's within {1.0 + band.other:.2f}" if band.other is not None else ""
    bar = ("the thickness of the bars, from the trend of the catalogue",) if estimate.bar_assumed else ()
    turning = ("turning: the elastic part of loops spread evenly",) if estimate.bar_length is not None else ()
    return (
        f"every value is estimated: such estimates of the shock stiffness in compression are within a factor of "
        f"{1.0 + band.within:.2f} for 80 % of the catalogue's parts, {1.0 + band.worst:.2f} for all{other}",
        "damping ratio: that of the catalogue's series",
        "[spread]: scatter of these estimates for the catalogue's own parts, as one factor on all forces of an axis; another "
        "vendor's parts scatter more",
        *bar,
        *turning,
    )


def _spread(isolator: Isolator, estimate: LoopEstimate) -> Spread:
    """Return the scatter of all force parameters: each axis scales as its shock stiffness does; what was there stays."""
    errors = left_out_errors(estimate.left_out)
    names, values, rows = [], [], []
    for axis, law in isolator.axes.items():
        for key, value in ({} if law is None else law.to_dict()).items():
            if key in _FORCES and value != 0.0:
                names.append(f"{axis}.{key}")
                values.append(value)
                rows.append(errors[_AXIS_VALUE[axis]])
    covariance = np.outer(values, values) * np.cov(np.stack(rows))
    if isolator.spread is not None:
        known = np.array(isolator.spread.covariance)
        zero = np.zeros((len(names), len(known)))
        covariance = np.block([[covariance, zero], [zero.T, known]])
        names += isolator.spread.parameters
    return Spread(
        parameters=tuple(names), covariance=tuple(tuple(float(f"{v:.9g}") for v in row) for row in covariance)
    )
