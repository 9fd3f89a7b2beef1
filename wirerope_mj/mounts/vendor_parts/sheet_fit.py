"""An isolator from a vendor's data sheet, or from one row of a vendor's table.

The entries of a sheet are described in `sheet`, those of a sheet of curves in `curve_fit`; sheets of the
catalogue lie in `models/isolators/datasheets`, and `wirerope isolators fit` fits one. The shape of the elastic force comes from
the rope loop's geometry, its size and the friction from the vendor's values.
"""

import math
from dataclasses import replace
from pathlib import Path
from typing import Literal

from wirerope_mj.foundation.arrays import Entries
from wirerope_mj.foundation.errors import ConvergenceError, ModelError
from wirerope_mj.foundation.toml_file import read_toml
from wirerope_mj.mounts.isolator import Geometry, Isolator, Limits, Provenance, Rotation, Spread, Travel
from wirerope_mj.mounts.laws import LoopBoucWen, LoopCoupling, Parallel
from wirerope_mj.mounts.rope_loop import AxisCurves, axis_curves, fit_coupling, loop_positions, rotational_stiffness
from wirerope_mj.mounts.vendor_parts.curve_fit import fit_curves
from wirerope_mj.mounts.vendor_parts.law_values import diagonal_secant
from wirerope_mj.mounts.vendor_parts.parts import VendorPart
from wirerope_mj.mounts.vendor_parts.secants import RULES, ElasticShape, FitRule, NiLaw, first_state, fit_damped, fit_secants
from wirerope_mj.mounts.vendor_parts.sheet import AxisValues, ComparedValue, DataSheet, read_datasheet


def fit_datasheet(path: str | Path) -> Isolator:
    """Return the isolator that reproduces the values, or the curves, of a data sheet.

    Raises:
        ModelError: the data sheet breaks a rule, or no rope loop has its measures and travels; the message names the file.
        ConvergenceError: no law has all its values; the message names the file.
    """
    content = read_toml(path, "data sheet")
    if "curve" in content:
        return fit_curves(content, Path(path))
    sheet = read_datasheet(path)
    try:
        return fit_sheet(sheet)
    except ValueError as error:
        raise ModelError(
            f"{path}: no rope loop has these measures and travels: {error} Check `height`, `width`, `rope`, `bar` and "
            "`travel`, and their units."
        ) from error
    except ConvergenceError as error:
        raise ConvergenceError(f"{path}: {error}") from error


def fit_sheet(sheet: DataSheet) -> Isolator:
    """Return the isolator that reproduces the values of a data sheet.

    Raises:
        ValueError: no rope loop has the envelope of the sheet, or the travel is larger than what is between its bars.
        ConvergenceError: no law has all its values.
    """
    compression, shear = sheet.compression, sheet.shear
    rated = {} if shear is None else {"shear": shear.travel, "roll": (sheet.roll or shear).travel}
    try:
        curves = axis_curves(sheet.shape, bar=sheet.bar, compression=compression.travel, roll=rated.get("roll"))
    except ValueError as error:
        room = sheet.height - 2.0 * sheet.bar
        if compression.travel <= room:
            raise
        raise ValueError(
            f"`travel` of {1e3 * compression.travel:.6g} mm in compression must be at most the {1e3 * room:.6g} mm between the "
            f"bars, `height` of {1e3 * sheet.height:.6g} mm less twice `bar` of {1e3 * sheet.bar:.6g} mm."
        ) from error
    rule = RULES[sheet.scales]
    cubic = rule.asymmetry * curves.axial_cubic * compression.hardening
    along = ElasticShape(asymmetry=rule.asymmetry * curves.asymmetry, cubic=cubic)
    axial = _fit(compression, along, sheet.yield_deflection, sheet.damping_amplitude, rule)
    # all states of the axis share the scatter of the asymmetry
    states = len(axial.components)
    names = ("axial.c",) if states == 1 else tuple(f"axial.laws[{number}].c" for number in range(states))
    variance = float(f"{rule.deviation(curves.asymmetry, curves.asymmetry_deviation) ** 2:.6g}")
    across = {} if shear is None else _across(sheet, shear, axial, curves)
    isolator = Isolator(
        name=sheet.name, axial=axial, spread=Spread(parameters=names, covariance=((variance,) * states,) * states),
        limits=Limits(static_load=sheet.static_load, travel=Travel(compression=compression.travel, **rated)),
        geometry=Geometry(
            height=sheet.height, width=sheet.width, **({} if sheet.bar_assumed else {"bar": sheet.bar, "rope": sheet.rope})
        ),
        rotation=_rotation(sheet, axial, across.get("roll"), curves), temperature=sheet.temperature, **across,
    )  # fmt: skip
    units = {"N/mm": "N_per_mm", "N": "N"}
    check_45: dict[str, float] = {}
    for row in diagonal_values(sheet.diagonal, isolator):
        name = row.name.replace(" ", "_")
        if row.vendor is None or row.error is None:
            continue
        check_45[f"{name}_vendor_{units[row.unit]}"] = float(f"{row.vendor:.6g}")
        check_45[f"{name}_fitted_{units[row.unit]}"] = float(f"{row.fitted:.6g}")
        check_45[f"{name}_relative_error"] = round(row.error, 4)
    provenance = Provenance(
        kind="catalogue", source=sheet.source, fitted_to=_fitted_to(sheet), assumed=_assumed(sheet, curves),
        check_45=check_45,
    )  # fmt: skip
    return replace(isolator, provenance=provenance)


def _across(sheet: DataSheet, shear: AxisValues, axial: NiLaw | Parallel, curves: AxisCurves) -> Entries:
    """Fit the laws of shear and roll and the coupling of roll and axial, as arguments of the isolator."""
    curve, rule = ElasticShape(asymmetry=None, cubic=curves.roll_cubic * shear.hardening), RULES[sheet.scales]
    yielding = rule.shear_yield * first_state(axial).normalised.x_y
    law = _fit(shear, curve, yielding, sheet.damping_amplitude, rule)
    roll = law
    if sheet.roll is not None:
        curve = ElasticShape(asymmetry=None, cubic=curves.roll_cubic * sheet.roll.hardening)
        roll = _fit(sheet.roll, curve, yielding, sheet.damping_amplitude, rule)
    if sheet.roll_of_loop:  # what it has beside the axial law, with friction in the proportion of shear's
        spring, beside = first_state(axial).k1 * curves.roll_stiffness / curves.axial_stiffness, first_state(law)
        friction, reach = beside.normalised.z_max * spring / beside.k1, beside.normalised.x_y
        roll = rule.law(friction, reach, spring, ElasticShape(asymmetry=None, cubic=curves.roll_cubic))
    # The geometric mean of both axes' EI: with it the stiffness at 45 degrees is nearest to Enidine's tables.
    sizes = first_state(axial).k1 / curves.axial_stiffness, first_state(roll).k1 / curves.roll_stiffness
    travel, size = sheet.compression.travel, math.sqrt(sizes[0] * sizes[1])
    coupling = fit_coupling(
        sheet.shape, bending_stiffness=size, loops=1, roll=(sheet.roll or shear).travel, compression=travel, tension=travel
    )
    ends = {name: float(f"{getattr(coupling, name):.9g}") for name in ("roll", "compression", "tension")}
    loop = LoopCoupling(**ends, coefficients=tuple(tuple(float(f"{c:.9g}") for c in row) for row in coupling.coefficients))
    return {"shear": law, "roll": roll, "coupling": "loop", "loop": loop}


def _fit(stated: AxisValues, curve: ElasticShape, yielding: float | None, amplitude: float, rule: FitRule) -> NiLaw | Parallel:
    """Fit the law of one axis; a damping target takes precedence over a yield deflection."""
    if stated.damping_target is not None:
        return fit_damped(stated.fitted, curve, damping=stated.damping_target, amplitude=amplitude, rule=rule)
    if yielding is None:
        raise ValueError("`yielding` must be given where no damping ratio is.")
    return fit_secants(stated.fitted, curve, yielding, rule)


def _rotation(sheet: DataSheet, axial: NiLaw | Parallel, roll: NiLaw | Parallel | None, curves: AxisCurves) -> Rotation | None:
    """Return the rotational stiffness of the loops, spread over the bars; None where their length is not stated."""
    if sheet.bar_length is None or sheet.loops is None:
        return None
    stiffness = rotational_stiffness(
        sheet.shape,
        bending_stiffness=first_state(axial).k1 / (sheet.loops * curves.axial_stiffness),
        positions=loop_positions(sheet.loops, sheet.bar_length),
        axial=first_state(axial).k1,
        roll=None if roll is None else first_state(roll).k1,
    )
    about_roll, about_shear, about_axial = (float(f"{value:.6g}") for value in stiffness)
    return Rotation(roll=about_roll, shear=about_shear, axial=about_axial)


def _fitted_to(sheet: DataSheet) -> str:
    """List the values to which the laws were fitted, by axis, as a text."""
    axes = []
    for name, axis in {"axial": sheet.compression, **sheet.across}.items():
        fitted = []
        for value in axis.fitted:
            path, shown = "steady loop" if value.steady else "virgin path", f"{value.shown(value.stiffness):.5g} {value.unit}"
            at = f"at {1e3 * value.deflection:.4g} mm of the {path}"
            of = f"= secant of the {path} of {1e3 * value.deflection:.4g} mm"
            fitted.append(f"{value.name} {shown} {at if value.unit == 'N' else of}")
        if axis.damping_target is not None:
            loop = f"steady loop of {1e3 * sheet.damping_amplitude:.3g} mm"
            fitted.append(f"damping ratio {axis.damping_target:g} of the {loop}")
        axes.append(f"{name}: {', '.join(fitted)}")
    return "; ".join(axes)


def _assumed(sheet: DataSheet, curves: AxisCurves) -> tuple[str, ...]:
    """List the assumptions that no source gives, one text each."""
    if sheet.scales == 1:
        shape = [
            f"axial: c ln b and k3 / k1 from the rope loop, to {100.0 * curves.misfit:.2g} % of its secants; nobody measured "
            f"tension; standard deviation of c in [spread], {curves.asymmetry_deviation:.3g} 1/m, for what the bars hold",
            "n = 1, gamma = 0 and k2 = 0 on every axis, b = e: the shape of the loop",
        ]
    else:
        shape = [
            f"axial: c ln b and k3 / k1 are a third of the rope loop's, whose c is {curves.asymmetry:.3g} 1/m: the shocks of a "
            "rack on CB1400-15 in both senses ask for it; nobody measured tension; the standard deviation of c in [spread] is "
            "half of what both differ by, with a third of what the bars leave open",
            "two scales of friction on every axis, the second with an eighth of the force and a twentieth of the yield "
            "deflection of the first: damping that does not vanish in small cycles",
            "n = 2, gamma = 0 and k2 = 0 on every axis, b = e: the shape of the loop",
        ]
    texts = [*shape, "tension travel is not stated and not judged"]
    for axes, values in sheet.across.items():
        texts.append(f"{axes}: k3 / k1 is {values.hardening:g} times that of the rope loop in roll")
    if sheet.shear is not None:
        texts.append("roll and axial are coupled as in the rope loop, to 2 % of its coupling forces")
    if sheet.bar_length is not None:
        texts.append("turning: the elastic part of loops that are spread evenly over the bars")
    if sheet.roll_of_loop:
        texts.append("roll: what the rope loop has beside the axial stiffness, with friction in the proportion of shear's")
    if sheet.shear is not None and sheet.shear.damping_target is None:
        part = "" if sheet.scales == 1 else "three quarters of "
        texts.append(f"shear and roll: friction yields at {part}the deflection of the axial law")
    if sheet.damping_range is not None:
        texts.append("damping ratio: the vendor states {:g} to {:g} for the whole series".format(*sheet.damping_range))
    return (*texts, *sheet.assumed)


DIAGONAL = "45 degrees"


def diagonal_values(stated: AxisValues | None, isolator: Isolator) -> list[ComparedValue]:
    """Compare the values at 45 degrees between compression and roll, which were not fitted, with the coupled laws."""
    law = isolator.coupled
    if stated is None or not isinstance(law, LoopBoucWen):
        return []
    # A resonance is about a sag under a load that is not along an axis of the mount: nothing here follows that.
    followed = [value for value in stated.stated if value.unit != "Hz"]
    secants = [diagonal_secant(law, value.deflection, steady=value.steady) for value in followed]
    return [value.beside(DIAGONAL, secant) for value, secant in zip(followed, secants, strict=True)]


# Thickness of a bar in diameters of the rope where the table does not state it: the mean of Enidine's from 9.5 mm of rope on,
# 1.54 to 1.80.
BAR = 1.7


def fit_part(part: VendorPart, *, scales: Literal[1, 2] = 2) -> Isolator:
    """Return the isolator that has the stiffnesses of a part's row in compression and, if stated, in shear and roll.

    `scales` of friction is the number of the rule (`wirerope_mj.mounts.vendor_parts.secants`).

    Raises:
        ModelError: the row lacks travel or stiffnesses in compression, or the envelope.
        ConvergenceError: no law has all its values.
    """
    compression = axis_of(part, "compression", part.series.damping)
    if compression is None:
        raise ModelError(f"{part.name}: the table does not state travel and stiffnesses in compression; nothing to fit.")
    measures = {"height": part.height, "width": part.width, "rope": part.rope}
    for name, value in measures.items():
        if value is None:
            raise ModelError(f"{part.name}: the table does not state its {name}; no rope loop to fit.")
    height, width, rope = (float(value) for value in measures.values() if value is not None)
    assumed = () if part.bar is not None else (f"bar of {BAR:g} rope diameters: the table does not state it",)
    return fit_sheet(
        DataSheet(
            name=part.name, source=part.series.source, height=height, width=width, rope=rope,
            bar=BAR * rope if part.bar is None else part.bar, bar_assumed=part.bar is None, compression=compression,
            shear=axis_of(part, "shear"), static_load=part.modes["compression"].static_load,
            scales=scales, damping_range=part.series.damping_range, assumed=assumed,
        )
    )  # fmt: skip


def axis_of(part: VendorPart, mode: str, damping: float | None = None) -> AxisValues | None:
    """Return the values of one loading mode of a part; None unless travel and both stiffnesses are stated."""
    values = part.modes[mode]
    if values.travel is None or values.vibration is None or values.shock is None:
        return None
    return AxisValues(
        travel=values.travel, vibration_stiffness=values.vibration, shock_stiffness=values.shock, damping_target=damping
    )  # fmt: skip
