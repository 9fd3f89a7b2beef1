"""Modes of a system about its sagged position, and how far it is from tipping over."""

from wirerope_mj.dynamics.modes.find import modes as modes
from wirerope_mj.dynamics.modes.result import Modes as Modes
from wirerope_mj.dynamics.modes.result import TippingStability as TippingStability
