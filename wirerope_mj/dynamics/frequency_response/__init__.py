"""Frequency responses of a system at several levels: branches of periodic motions, sweeps, and their joint summary."""

from wirerope_mj.dynamics.frequency_response.result import FrequencyResponse, ResponseOptions, frequency_response
