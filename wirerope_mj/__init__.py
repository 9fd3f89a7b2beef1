"""Shock and vibration of equipment and floors on wire-rope isolators.

Laws and isolators, MuJoCo models whose mounts have hysteresis, base motions, simulation, and the view of a run in rerun. Its
names stand in `__init__.pyi`; each is imported when it is first used.
"""

from lazy_loader import attach_stub

__getattr__, __dir__, __all__ = attach_stub(__name__, __file__)
