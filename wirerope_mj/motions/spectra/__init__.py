"""Spectra of accelerations: shock response and power spectral density, without the engine."""

from wirerope_mj.motions.spectra.psd import PowerSpectralDensity, power_spectral_density
from wirerope_mj.motions.spectra.srs import ShockResponseSpectrum, shock_response_spectrum
from wirerope_mj.motions.spectra.vibration import VibrationSpectrum, equivalent_psd, vibration_response_spectrum
