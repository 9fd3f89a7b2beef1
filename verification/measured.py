"""What laboratories and vendors state of wire-rope isolators in general, beside the isolator files of the catalogue.

Measured loops, transmissibilities or shock responses of a named isolator could not be reached as numbers (README.md of this
folder says what was looked for); what is left are statements about all of them.
"""

import numpy as np

import wirerope_mj as wr
from verification.case import Case, Comparison
from verification.models import steady_loop
from wirerope_mj.foundation.resources import catalogue_folder
from wirerope_mj.mounts.laws import Law

AMPLITUDES = np.arange(1.0, 15.5, 1.0) * 1e-3
"""Amplitudes of the cycles about the unloaded state [m]."""

DAMPING = {"enidine": (0.05, 0.15), "socitec_cb1400": (0.15, 0.20)}
"""Damping ratios that vendors state for a whole series, by the beginning of a file's name: ITT Enidine for WR and CR, VMC for
its CB1400. Socitec states none for the CB1390."""

DAMPING_AMPLITUDE = 1e-3
"""Amplitude at which these are compared [m]; the vendors name none."""


def _axial_laws() -> dict[str, Law]:
    """Return the axial law of every wire-rope isolator of the catalogue, by file name."""
    laws = {}
    for path in sorted(catalogue_folder().glob("*.toml")):
        law = wr.load_isolator(path).axial if path.stem.startswith(tuple(DAMPING)) else None
        if law is not None:
            laws[path.stem] = law
    return laws


def _stiffness() -> Comparison:
    """Return how far the stiffness of each isolator is from a straight line over 1/amplitude, as 1 - R^2."""
    rows = []
    for name, law in _axial_laws().items():
        stiffness = np.array([steady_loop(law, a).secant_stiffness for a in AMPLITUDES])
        fit = np.polyval(np.polyfit(1.0 / AMPLITUDES, stiffness, 1), 1.0 / AMPLITUDES)
        squared = 1.0 - np.sum((stiffness - fit) ** 2) / np.sum((stiffness - stiffness.mean()) ** 2)
        rows.append((f"{name}: R^2", 1.0, float(squared), float(1.0 - squared)))
    worst = max(rows, key=lambda row: row[3])
    return Comparison(
        reference=1.0,
        ours=worst[2],
        error=worst[3],
        values=len(rows) * AMPLITUDES.size,
        unit="R^2",
        details=tuple(rows),
    )


def _damping() -> Comparison:
    """Return how far the damping ratio of each isolator lies outside its vendor's range, relative to the nearer limit."""
    rows = []
    for name, law in _axial_laws().items():
        low, high = next(limits for vendor, limits in DAMPING.items() if name.startswith(vendor))
        ratio = steady_loop(law, DAMPING_AMPLITUDE).damping_ratio
        rows.append((f"{name} ({low:g} to {high:g})", float(np.clip(ratio, low, high)), ratio, 0.0))
    rows = [(label, near, ratio, abs(ratio / near - 1.0)) for label, near, ratio, _ in rows]
    worst = max(rows, key=lambda row: row[3])
    return Comparison(
        reference=worst[1], ours=worst[2], error=worst[3], values=len(rows), unit="damping ratio", details=tuple(rows)
    )


CASES = (
    Case(name="stiffness-over-amplitude", title="Stiffness of the catalogue's isolators over the reciprocal of the amplitude",
         compares="Secant stiffness of steady cycles of 1 to 15 mm about the unloaded state along the axis against a straight "
         "line over 1/amplitude; 1 - R^2 of the worst isolator.",
         source="Loading and unloading tests of a 6 x 19 wire rope of 6 mm under compression, Adv. Mech. Eng. 13 (2021), doi "
         "10.1177/16878140211028058: the stiffness is approximately linear in the reciprocals of length and amplitude",
         date="2021", bound=0.05, kind="plausibility", run=_stiffness,
         reason="approximately linear, as the source says, is read as R^2 above 0.95",
         known="Enidine's four parts: their damping is placed at 2.8 to 4.2 mm, below which the stiffness of two scales of "
         "friction levels off; VMC's two are within"),
    Case(name="damping-at-1-mm", title="Damping of the catalogue's isolators in small cycles",
         compares="Damping ratio of steady cycles of 1 mm along the axis; distance from the range stated over its nearer end.",
         source="ITT Enidine catalogue ENI877R4: 5 to 15 % of critical for WR and CR; VMC Group, technical notes on wire rope "
         "isolators: 15 to 20 %", date="before 2026", bound=0.1, kind="plausibility", run=_damping,
         reason="half a unit of the last digit of 5 %",
         known="VMC's two parts: their 20 % holds at 2.5 mm, the amplitude of the vibration stiffness; Enidine's are within"),
)  # fmt: skip
