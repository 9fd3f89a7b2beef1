"""An isolator without a data sheet: its values estimated from geometry, their errors, and its isolator file."""

import math
from dataclasses import dataclass, replace

import numpy as np

from wirerope_mj.foundation.arguments import integer, positive
from wirerope_mj.foundation.arrays import Array
from wirerope_mj.mounts.estimate.trends import (
    ENIDINE,
    LARGEST_ROPE,
    QUANTITIES,
    SAME_ROPE,
    SMALLEST_ROPE,
    LeftOut,
    Values,
    all_trends,
    left_out_errors,
    other_vendor_errors,
)
from wirerope_mj.mounts.isolator import Isolator, Provenance, Rotation, Spread
from wirerope_mj.mounts.rope_loop import RopeLoop, loop_positions, loop_shape, rotational_stiffness
from wirerope_mj.mounts.vendor_parts.parts import MODES, ModeValues, Series, VendorPart
from wirerope_mj.mounts.vendor_parts.secants import NiLaw
from wirerope_mj.mounts.vendor_parts.sheet_fit import fit_part

COVERED = 0.8  # Fraction of the known parts within the band that is stated
MOST_LOOPS = 1000  # Loops of an isolator at the most


@dataclass(frozen=True, kw_only=True)
class Band:
    """Errors of the estimates of known parts, as factors - 1: 0.2 is 20 % above, or as much below (1 / 1.2)."""

    within: float  # for 80 % of the vendor's parts, each estimated without itself
    worst: float  # for the worst of them
    other: float | None  # for 80 % of another vendor's parts; None where it states no such value


@dataclass(frozen=True, kw_only=True)
class LoopEstimate:
    """Values of an isolator, estimated from its geometry, and their errors."""

    # geometry [m]
    height: float
    width: float
    rope: float
    bar: float
    loops: int  # their number
    bar_assumed: bool  # whether the bar was not given, and taken from the vendor's parts of this rope
    bar_length: float | None  # over which the loops are spread [m], None if not given
    values: Values  # those that a data sheet would state
    bands: dict[str, Band]  # error of each value, by its name
    left_out: LeftOut  # what the estimate of each known part left out: itself, or all parts with its rope
    # stiffness about x (roll), y (shear) and z (axial) for small vibration, about mid-height [N m/rad], (3,); without
    # `bar_length` only about y, the others NaN. No vendor states any: it has no band of its own.
    rotation: Array


def estimate_loop(
    *, height: float, width: float, rope: float, loops: int, bar: float | None = None, bar_length: float | None = None
) -> LoopEstimate:
    """Estimate the values of an isolator of full rope loops between two bars.

    EI of the rope and the ratios between the values are those that 50 parts of Enidine's table have in common; the loop is
    the elastica of its envelope. Each value comes with the error of such estimates of these parts, each left out in turn.

    Height is unloaded, over both bars, width over the ropes, across the bars, the rope's diameter 1.6 to 22.2 mm, `bar` the
    thickness of one bar, that of the vendor's parts of this rope by default; over `bar_length` the loops are spread evenly,
    for the rotational stiffness; all in [m]. ValueError: an argument is out of range, or leaves no loop.
    """
    lengths = {"height": height, "width": width, "rope": rope, "bar": bar, "bar_length": bar_length}
    for name, value in lengths.items():
        if value is not None:
            positive(name, value)
    if integer("loops", loops, least=1) > MOST_LOOPS:
        raise ValueError(f"`loops` must be at most {MOST_LOOPS}: those that are sold have 2 to 20, got {loops}.")
    if not SMALLEST_ROPE * (1.0 - SAME_ROPE) <= rope <= LARGEST_ROPE * (1.0 + SAME_ROPE):
        raise ValueError(
            f"`rope` must be {1e3 * SMALLEST_ROPE:g} to {1e3 * LARGEST_ROPE:g} mm, the ropes of the parts that were compared, "
            f"got {1e3 * rope:g} mm."
        )
    if bar_length is not None and bar_length < loops * rope:
        raise ValueError(
            f"`bar_length` must be at least what {loops} loops of the rope take side by side, {1e3 * loops * rope:g} mm, got "
            f"{1e3 * bar_length:g} mm."
        )
    trends = all_trends()
    thickness = trends.bar_of(rope) if bar is None else bar
    values = trends.predict(height=height, width=width, rope=rope, bar=thickness, loops=loops)
    known = bool(np.any(np.abs(trends.rope / rope - 1.0) <= SAME_ROPE))
    left_out: LeftOut = "part" if known else "rope size"
    shape = loop_shape(height=height, width=width, bar=thickness, rope=rope)
    stiffness = values["compression vibration"] / (loops * RopeLoop(shape).stiffness()[1, 1])
    rotation = rotational_stiffness(
        shape, bending_stiffness=stiffness, positions=loop_positions(loops, bar_length or 1.0),
        axial=values["compression vibration"], roll=values["shear vibration"],
    )  # fmt: skip
    return LoopEstimate(
        height=height, width=width, rope=rope, bar=thickness, loops=loops, bar_assumed=bar is None,
        bar_length=bar_length, values=values, bands=error_bands(left_out), left_out=left_out,
        rotation=rotation if bar_length is not None else np.array([math.nan, rotation[1], math.nan]),
    )  # fmt: skip


def error_bands(left_out: LeftOut) -> dict[str, Band]:
    """Find the errors of the estimates of known parts, by the name of the value."""
    errors_of_others = other_vendor_errors()

    def covering(errors: Array) -> float:
        return float(np.expm1(np.quantile(np.abs(errors), COVERED)))

    return {
        name: Band(
            within=covering(errors),
            worst=float(np.expm1(np.abs(errors).max())),
            other=covering(errors_of_others[name]) if name in errors_of_others else None,
        )
        for name, errors in left_out_errors(left_out).items()
    }


# Parameters of the fitted laws that grow with the force; those of their shape (beta with n = 1, b, c) do not.
_FORCES = ("alpha", "k1", "k2", "k3")
_AXIS_VALUE = {"roll": "shear shock", "shear": "shear shock", "axial": "compression shock"}


def estimated_isolator(estimate: LoopEstimate, name: str | None = None) -> Isolator:
    """Make an isolator with the estimated values; its spread is the scatter of the estimates of known parts.

    ConvergenceError: no law has all the values.
    """
    values = estimate.values
    modes = {
        mode: ModeValues(
            static_load=_rounded(values["static load"]) if mode == "compression" else None,
            **{quantity: _rounded(values[f"{mode} {quantity}"]) for quantity in QUANTITIES},
        )
        for mode in MODES
    }
    title = name or f"estimated, {estimate.loops} loops of {1e3 * estimate.rope:g} mm rope"
    source = (
        f"geometry alone (height {1e3 * estimate.height:g} mm, width {1e3 * estimate.width:g} mm, bar "
        f"{1e3 * estimate.bar:.4g} mm, rope {1e3 * estimate.rope:g} mm, {estimate.loops} loops), by what 50 parts of the "
        "Enidine WR catalogue have in common; no data sheet, no measurement"
    )
    part = VendorPart(
        name=title,
        series=Series(file="", source=source, damping=ENIDINE.damping, damping_range=ENIDINE.damping_range),
        loops=estimate.loops, rope=estimate.rope, height=estimate.height, width=estimate.width, bar=estimate.bar,
        modes=modes,
    )  # fmt: skip
    fitted = fit_part(part, scales=1)
    band = estimate.bands["compression shock"]
    text_of_others = f", of VMC's within {1.0 + band.other:.2f}" if band.other is not None else ""
    assumed = [
        f"every value is estimated: such estimates of the shock stiffness in compression are within a factor of "
        f"{1.0 + band.within:.2f} for 80 % of the catalogue's parts, {1.0 + band.worst:.2f} for all{text_of_others}",
        "damping ratio: that of the catalogue's series",
        "[spread]: scatter of these estimates for the catalogue's own parts, as one factor on all forces of an axis; another "
        "vendor's parts scatter more",
    ]
    assumed += ["the thickness of the bars, from the trend of the catalogue"] if estimate.bar_assumed else []
    assumed += ["turning: the elastic part of loops spread evenly"] if estimate.bar_length is not None else []
    provenance = Provenance(
        kind="estimated",
        source=source,
        fitted_to=f"estimated values, none of them measured: {fitted.provenance.fitted_to}",
        assumed=(*assumed, *fitted.provenance.assumed),
    )
    rotation = None
    if estimate.bar_length is not None and isinstance(fitted.axial, NiLaw) and isinstance(fitted.roll, NiLaw):
        # Their elastic part alone, as in a fitted file: what small vibration has beyond it is friction.
        along, across = fitted.axial.k1 / values["compression vibration"], fitted.roll.k1 / values["shear vibration"]
        about_roll, about_shear, about_axial = estimate.rotation.tolist()
        rotation = Rotation(
            roll=_rounded(along * about_roll), shear=_rounded(along * about_shear), axial=_rounded(across * about_axial)
        )
    geometry = fitted.geometry
    if geometry is not None and estimate.bar_assumed:
        geometry = replace(geometry, bar=None)
    errors = left_out_errors(estimate.left_out)
    names, forces, rows = [], [], []
    for axis, law in fitted.axes.items():
        for key, value in ({} if law is None else law.to_dict()).items():
            if key in _FORCES and value != 0.0:
                names.append(f"{axis}.{key}")
                forces.append(value)
                rows.append(errors[_AXIS_VALUE[axis]])
    covariance = np.outer(forces, forces) * np.cov(np.stack(rows))
    if fitted.spread is not None:
        known = np.array(fitted.spread.covariance)
        zero = np.zeros((len(names), len(known)))
        covariance = np.block([[covariance, zero], [zero.T, known]])
        names += fitted.spread.parameters
    rounded = tuple(tuple(float(f"{value:.9g}") for value in row) for row in covariance)
    spread = Spread(parameters=tuple(names), covariance=rounded)
    return replace(fitted, provenance=provenance, spread=spread, rotation=rotation, geometry=geometry)


def _rounded(value: float) -> float:
    """Round an estimate to four digits: more would look like knowledge."""
    return float(f"{value:.4g}")
