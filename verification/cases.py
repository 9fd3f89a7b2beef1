"""All cases, in the order of the page."""

from verification import (
    building,
    closed_forms,
    diagonals,
    governor,
    measured,
    measured_loops,
    mechanisms,
    motions,
    noel_schoukens,
    opensees,
    oscillators,
    racks,
    records,
    rigid_bodies,
    spectra,
    statics,
)
from verification.case import Case

CASES: tuple[Case, ...] = (
    *opensees.CASES,
    *noel_schoukens.CASES,
    *oscillators.CASES,
    *rigid_bodies.CASES,
    *mechanisms.CASES,
    *governor.CASES,
    *spectra.CASES,
    *records.CASES,
    *closed_forms.CASES,
    *statics.CASES,
    *motions.CASES,
    *measured.CASES,
    *diagonals.CASES,
    *racks.CASES,
    *building.CASES,
    *measured_loops.CASES,
)
