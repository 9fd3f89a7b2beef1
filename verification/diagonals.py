"""Mounts loaded at 45 degrees between compression and roll, beside the vendors' own figures for it.

The isolators here are made from the figures in compression and in shear alone; what couples the two axes is the elastica of the
rope loop that the catalogue's dimensions give.
"""

import math

import numpy as np

import wirerope_mj as wr
from verification.case import Case, Comparison, single_values
from wirerope_mj.foundation.resources import catalogue_folder
from wirerope_mj.mounts.laws import LoopBoucWen
from wirerope_mj.mounts.vendor_parts import vendor_parts
from wirerope_mj.mounts.vendor_parts.sheet_fit import fit_part

SOCITEC = {
    "socitec_cb1390_20": ((2110.0, 0.0096), (5470.0, 0.055)),
    "socitec_cb1390_30": ((1490.0, 0.0117), (3990.0, 0.059)),
}
"""Static and shock force [N] at a deflection [m] along the diagonal."""


def _force(isolator: wr.Isolator, deflection: float) -> float:
    """Return the force along the diagonal [N] on the virgin path to a deflection [m]."""
    if not isinstance(isolator.coupled, LoopBoucWen):
        raise RuntimeError(f"{isolator.name} does not couple roll and axial.")
    line = np.array([1.0, -1.0]) * math.sqrt(0.5)
    return float(isolator.coupled.trace(np.outer([0.0, deflection], line)).force[-1] @ line)


def _enidine() -> Comparison:
    """Return the mean relative error of the shock stiffness over all rows that state it."""
    rows = []
    for part in vendor_parts():
        diagonal = part.modes.get("45")
        stated = part.modes["compression"].shock is not None and part.modes["shear"].shock is not None
        if diagonal is None or diagonal.shock is None or diagonal.travel is None or not stated:
            continue
        isolator = fit_part(part)
        found = _force(isolator, diagonal.travel) / diagonal.travel
        rows.append((f"{part.name} [N/mm]", 1e-3 * diagonal.shock, 1e-3 * found, abs(found / diagonal.shock - 1.0)))
    worst = max(rows, key=lambda row: row[3])
    mean = abs(float(np.mean([ours / stated - 1.0 for _, stated, ours, _ in rows])))
    return Comparison(
        reference=worst[1], ours=worst[2], error=mean, values=len(rows), unit="N/mm",
        details=tuple(rows),
    )  # fmt: skip


def _socitec() -> Comparison:
    """Return the comparison of forces along the diagonal with those of the data sheets."""
    pairs = {}
    for name, points in SOCITEC.items():
        isolator = wr.load_isolator(catalogue_folder() / f"{name}.toml")
        for kind, (force, deflection) in zip(("static", "shock"), points, strict=True):
            label = f"{name}, {kind}, {1e3 * deflection:g} mm [N]"
            pairs[label] = (force, _force(isolator, deflection))
    return single_values(pairs, "N")


CASES = (
    Case(name="diagonal-enidine", title="Shock stiffness at 45 degrees of all Enidine WR rows",
         compares="Secant at the rated travel of isolators fitted to compression and shear; mean of the signed "
         "relative errors, the worst row beside it.",
         source="ITT Enidine WR series catalogue ENI877R4, from a public transcription",
         date="before 2026", bound=0.1, kind="plausibility", run=_enidine,
         reason="what a planar loop of rope, computed from the catalogue's dimensions alone, comes to"),
    Case(name="diagonal-socitec", title="Forces at 45 degrees of the Socitec CB1390",
         compares="Static and shock force of two isolators; largest relative error.",
         source="Socitec CB1390 vendor data sheet, page 2, from a public transcription", date="before 2026", bound=0.25,
         kind="plausibility", run=_socitec,
         reason="half of the 40 to 60 % by which equivalent parts of two vendors differ in stiffness"),
)  # fmt: skip
