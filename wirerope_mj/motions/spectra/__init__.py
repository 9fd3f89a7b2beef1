"""Spectra of accelerations: shock response and power spectral density, without the engine."""

from wirerope_mj.motions.spectra.psd import (
    PowerSpectralDensity,
    VibrationSpectrum,
    equivalent_psd,
    power_spectral_density,
    vibration_response_spectrum,
)
from wirerope_mj.motions.spectra.srs import ShockResponseSpectrum, shock_response_spectrum
