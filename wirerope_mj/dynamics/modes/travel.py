"""Utilisation of the mounts' rated travels in modes at an amplitude."""

from wirerope_mj.dynamics.modes.result import Modes
from wirerope_mj.engine.system import System
from wirerope_mj.foundation.arrays import Array
from wirerope_mj.mounts.isolator import travel


def reached_in(modes: Modes, mount: str) -> tuple[Array, Array]:
    """Return the lowest and highest deflections of a mount over all modes, sag included [m], (3,) each."""
    rest, amplitudes = modes.equilibrium.mounts[mount].deflection, (modes.amplitude or 0.0) * abs(modes.mounts[mount])
    largest = amplitudes.max(axis=0, initial=0.0)  # (n_modes, 3) -> (3,)
    return rest - largest, rest + largest


def travel_utilisation(system: System, modes: Modes, mount: str) -> float:
    """Return the largest utilisation of a rated travel of a mount in any of the modes, sag included [-]; 0 if none is rated."""
    reached = travel.travel_reached(*reached_in(modes, mount))
    return max(
        travel.travel_utilisation(reached, system.mounts[mount].isolator.limits.travel.stated).values(), default=0.0
    )
