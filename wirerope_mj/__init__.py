"""Shock and vibration of equipment and floors on wire-rope isolators.

Laws and isolators, MuJoCo models whose mounts have hysteresis, base motions, simulation, and the view of a run in rerun. Its
names stand in `__init__.pyi`; each is imported when it is first used.
"""

import os
import sys
from importlib import import_module

from lazy_loader import attach_stub


def _import_elsewhere() -> None:
    """Import packages that take settings from a file of the current folder, where there is one, from a folder without it.

    A folder is data: such settings of Numba lead to code; those of Matplotlib start programs, or keep a run from being written.
    """
    for package, settings in (("numba", ".numba_config.yaml"), ("matplotlib", "matplotlibrc")):
        if package not in sys.modules and os.path.lexists(settings):
            here = os.getcwd()
            os.chdir(os.path.dirname(__file__))
            try:
                import_module(package)
            finally:
                os.chdir(here)


_import_elsewhere()

_find, _, __all__ = attach_stub(__name__, __file__)

_RENAMED = {"read_cycles": "load_cycles", "write_cyclic_test": "save_cyclic_test"} | {
    name: f"motions.{name}" for name in ("EN1998_TYPE_1", "banded_lines", "psd_from_g", "psd_level", "psd_rms")
}


def __dir__() -> list[str]:
    return [*__all__, "__version__"]


def __getattr__(name: str) -> object:
    if name == "__version__":
        from wirerope_mj.foundation.resources import version_of

        return version_of("wirerope-mj")
    if name not in _RENAMED:
        return _find(name)
    import warnings
    from operator import attrgetter
    from sys import modules

    now = f"{__name__}.{_RENAMED[name]}"
    warnings.warn(f"{__name__}.{name} is called {now} since version 0.2, and leaves with 0.3.", DeprecationWarning, 2)
    return attrgetter(_RENAMED[name])(modules[__name__])
