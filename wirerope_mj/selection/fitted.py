"""An isolator fitted from one row of a vendor's table, as those of the catalogue are fitted from data sheets."""

from wirerope_mj.errors import ModelError
from wirerope_mj.identification.shapes import HARDENING_YIELD, NiLaw, Stiffnesses, fit_stiffnesses
from wirerope_mj.isolator import Geometry, Isolator, Limits, Provenance, Travel
from wirerope_mj.selection.parts import Figures, Part

TENSION_RATIO = 1.5
"""F(+D) / |F(-D)| in the axial direction, as the shipped data sheets assume it: nobody measured tension."""


def fit_part(part: Part) -> Isolator:
    """Return the isolator that has the stiffnesses of a part's row in compression and, if stated, in shear and roll.

    Raises:
        ModelError: the row lacks the figures in compression.
        ConvergenceError: no law has all its figures.
    """
    axial = _fit(part.modes["compression"], part.series.damping, TENSION_RATIO)
    shear = _fit(part.modes["shear"], part.series.damping, None)
    if axial is None:
        raise ModelError(
            f"{part.name}: the table does not state travel and stiffnesses in compression; nothing to fit."
        )
    low, high = part.series.damping_range
    return Isolator(
        name=part.name,
        roll=shear,
        shear=shear,
        axial=axial,
        limits=Limits(
            static_load=part.modes["compression"].static_load,
            travel=Travel(
                compression=part.modes["compression"].travel,
                shear=part.modes["shear"].travel,
                roll=part.modes["shear"].travel,
            ),
        ),
        geometry=Geometry(height=part.height, width=part.width),
        provenance=Provenance(
            kind="catalogue",
            source=part.series.source,
            fitted_to=(
                "tangent at the origin = vibration stiffness; virgin secant at the rated travel (axial: in compression) = "
                f"shock stiffness; damping ratio {part.series.damping:g} of the steady loop of half the rated travel"
            ),
            assumed=(
                f"axial: F(+D)/|F(-D)| = {TENSION_RATIO:g} on the virgin paths: nobody measured tension",
                "n = 1, gamma = 0 and k2 = 0 on every axis, b = e: the shape of the loop",
                f"where k3 hardens, z yields at {HARDENING_YIELD:g} of the rated travel",
                f"damping ratio {part.series.damping:g}: the vendor states {low:g} to {high:g} for the whole series",
            ),
        ),
    )


def _fit(figures: Figures, damping: float, ratio: float | None) -> NiLaw | None:
    """Return the law of one mode, None if its figures are not stated."""
    if figures.travel is None or figures.vibration is None or figures.shock is None:
        return None
    stated = Stiffnesses(travel=figures.travel, vibration=figures.vibration, shock=figures.shock, damping=damping)
    return fit_stiffnesses(stated, ratio)
