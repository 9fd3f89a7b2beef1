"""Shock and vibration of equipment and floors on wire-rope isolators.

Laws and isolators, MuJoCo models whose mounts have hysteresis, base motions, simulation, and the view of a run in rerun. Its
names stand in `__init__.pyi`; each is imported when it is first used.
"""

from typing import Any

from lazy_loader import attach_stub

_find, __dir__, __all__ = attach_stub(__name__, __file__)

_RENAMED = {"read_cycles": "load_cycles", "write_cyclic_test": "save_cyclic_test"} | {
    name: f"motions.{name}" for name in ("EN1998_TYPE_1", "banded_lines", "psd_from_g", "psd_level", "psd_rms")
}


def __getattr__(name: str) -> Any:
    if name not in _RENAMED:
        return _find(name)
    from operator import attrgetter
    from sys import modules

    from wirerope_mj.foundation.renamed import warn_renamed

    now = _RENAMED[name]
    warn_renamed(f"{__name__}.{name}", f"{__name__}.{now}", stacklevel=3)
    return attrgetter(now)(modules[__name__])
