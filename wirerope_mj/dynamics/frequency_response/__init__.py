"""Frequency responses of a system at several levels: branches of periodic motions, sweeps, and what they say together."""

from wirerope_mj.dynamics.frequency_response.result import FrequencyResponse, ResponseOptions, frequency_response
