"""Whether the mounts of a run stayed where their laws hold."""

from wirerope_mj.engine.response.peaks import Peaks
from wirerope_mj.engine.system import System
from wirerope_mj.foundation.errors import SimulationError
from wirerope_mj.mounts.isolator.travel import beyond_law


def require_lawful(system: System, peaks: Peaks) -> None:
    """Raise SimulationError if a mount went to where the law of an axis does not hold."""
    for name, mount in system.mounts.items():
        peak = peaks.mounts[name].deflection
        if where := beyond_law(mount.isolator.axes, peak.minimum, peak.maximum):
            raise SimulationError(
                f"mount {name!r} was {where}: shake it more gently, or take an isolator with more travel."
            )
