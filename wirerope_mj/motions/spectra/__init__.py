"""Spectra of accelerations: shock response and power spectral density, without the engine."""

from wirerope_mj.motions.spectra.psd import PowerSpectralDensity as PowerSpectralDensity
from wirerope_mj.motions.spectra.psd import power_spectral_density as power_spectral_density
from wirerope_mj.motions.spectra.srs import ShockResponseSpectrum as ShockResponseSpectrum
from wirerope_mj.motions.spectra.srs import shock_response_spectrum as shock_response_spectrum
from wirerope_mj.motions.spectra.vibration import VibrationSpectrum as VibrationSpectrum
from wirerope_mj.motions.spectra.vibration import equivalent_psd as equivalent_psd
from wirerope_mj.motions.spectra.vibration import vibration_response_spectrum as vibration_response_spectrum
