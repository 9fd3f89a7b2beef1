"""All cases, in the order of the page."""

from verification import closed_forms, opensees, records, spectra
from verification.case import Case

CASES: tuple[Case, ...] = (
    *opensees.CASES,
    *spectra.CASES,
    *records.CASES,
    *closed_forms.CASES,
)
