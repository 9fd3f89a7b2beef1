"""Modes of a system about its sagged position, and how far it is from tipping over."""

from wirerope_mj.dynamics.modes.find import modes, natural_frequencies
from wirerope_mj.dynamics.modes.result import Modes, NaturalFrequencies, TippingStability
