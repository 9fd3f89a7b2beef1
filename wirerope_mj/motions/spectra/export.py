"""Shock response spectra as a table for other programs."""

from collections.abc import Sequence

import numpy as np

from wirerope_mj.foundation.exports import Exported
from wirerope_mj.motions.spectra.srs import ShockResponseSpectrum

_QUANTITIES = (
    ("acceleration/positive", "m/s^2", lambda s: s.acceleration.positive),
    ("acceleration/negative", "m/s^2", lambda s: s.acceleration.negative),
    ("acceleration/maximax", "m/s^2", lambda s: s.acceleration.maximax),
    ("relative_displacement/maximax", "m", lambda s: s.displacement.maximax),
    ("pseudo_velocity/maximax", "m/s", lambda s: 2.0 * np.pi * s.frequencies[:, None] * s.displacement.maximax),
)


def exported_spectra(spectrum: ShockResponseSpectrum, axes: Sequence[str] = "xyz") -> Exported:
    """Return spectra of several accelerations side by side as a table: frequency, then each quantity along each axis.

    Args:
        spectrum: of accelerations (n, k).
        axes: names of the k accelerations.
    """
    names, units, columns = ["frequency"], ["Hz"], [spectrum.frequencies]
    for place, axis in enumerate(axes):
        for name, unit, values in _QUANTITIES:
            names.append(f"{axis}/{name}")
            units.append(unit)
            columns.append(values(spectrum)[:, place])
    about = {"spectrum": "shock response, ISO 18431-4", "q": f"{spectrum.q:g}"}
    return Exported(names=names, units=units, column=columns.__getitem__, blocks=lambda: iter([columns]), about=about)
