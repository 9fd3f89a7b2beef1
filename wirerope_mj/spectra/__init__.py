"""Spectra of accelerations: shock response and power spectral density, without the engine."""

from wirerope_mj.spectra.srs import ShockResponseSpectrum as ShockResponseSpectrum
from wirerope_mj.spectra.srs import shock_response_spectrum as shock_response_spectrum
