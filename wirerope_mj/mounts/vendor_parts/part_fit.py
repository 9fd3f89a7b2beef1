"""An isolator fitted from one row of a vendor's table, as those of the catalogue are fitted from data sheets."""

from wirerope_mj.foundation.errors import ModelError
from wirerope_mj.mounts.isolator import Isolator
from wirerope_mj.mounts.vendor_parts.parts import VendorPart
from wirerope_mj.mounts.vendor_parts.secants import DAMPING_AMPLITUDE, VIBRATION_AMPLITUDE
from wirerope_mj.mounts.vendor_parts.sheet import AxisValues, DataSheet, two_stiffnesses
from wirerope_mj.mounts.vendor_parts.sheet_fit import fit_sheet

# Thickness of a bar in diameters of the rope where the table does not state it: the mean of Enidine's from 9.5 mm of rope on,
# 1.54 to 1.80.
BAR = 1.7


def fit_part(part: VendorPart, *, scales: int = 2) -> Isolator:
    """Return the isolator that has the stiffnesses of a part's row in compression and, if stated, in shear and roll.

    Args:
        part: the row.
        scales: of friction, the number of the rule (`wirerope_mj.mounts.vendor_parts.secants`).

    Raises:
        ModelError: the row lacks travel or stiffnesses in compression, or the envelope.
        ConvergenceError: no law has all its values.
    """
    compression = _axis(part, "compression", part.series.damping)
    if compression is None:
        raise ModelError(
            f"{part.name}: the table does not state travel and stiffnesses in compression; nothing to fit."
        )
    measures = {"height": part.height, "width": part.width, "rope": part.rope}
    for name, value in measures.items():
        if value is None:
            raise ModelError(f"{part.name}: the table does not state its {name}; no rope loop to fit.")
    height, width, rope = (float(value) for value in measures.values() if value is not None)
    assumed = () if part.bar is not None else (f"bar of {BAR:g} rope diameters: the table does not state it",)
    return fit_sheet(
        DataSheet(
            name=part.name,
            source=part.series.source,
            height=height,
            width=width,
            rope=rope,
            bar=BAR * rope if part.bar is None else part.bar,
            bar_assumed=part.bar is None,
            compression=compression,
            shear=_axis(part, "shear", None),
            static_load=part.modes["compression"].static_load,
            damping_amplitude=DAMPING_AMPLITUDE if scales == 1 else VIBRATION_AMPLITUDE * compression.travel,
            scales=scales,
            damping_range=part.series.damping_range,
            assumed=assumed,
        )
    )


def _axis(part: VendorPart, mode: str, damping: float | None) -> AxisValues | None:
    """Return the values of one mode; None where they are not stated."""
    values = part.modes[mode]
    if values.travel is None or values.vibration is None or values.shock is None:
        return None
    stated = two_stiffnesses(values.travel, values.vibration, values.shock)
    return AxisValues(travel=values.travel, stated=stated, damping=damping)
