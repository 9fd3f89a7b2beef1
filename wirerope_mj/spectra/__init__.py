"""Spectra of accelerations: shock response and power spectral density, without the engine."""

from wirerope_mj.spectra.psd import PowerSpectralDensity as PowerSpectralDensity
from wirerope_mj.spectra.psd import power_spectral_density as power_spectral_density
from wirerope_mj.spectra.srs import ShockResponseSpectrum as ShockResponseSpectrum
from wirerope_mj.spectra.srs import shock_response_spectrum as shock_response_spectrum
