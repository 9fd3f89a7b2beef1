"""Modes of a system about its sagged position, and how far it is from tipping over."""

from wirerope_mj.modes.find import modes as modes
from wirerope_mj.modes.result import Modes as Modes
from wirerope_mj.modes.result import PayloadShape as PayloadShape
from wirerope_mj.modes.tipping import Stability as Stability
