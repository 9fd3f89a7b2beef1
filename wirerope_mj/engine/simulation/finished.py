"""Checks of a finished run: whether its mounts stayed where their laws hold, and how certain its numbers are."""

import warnings

from wirerope_mj.engine.response.histories import SENSITIVE
from wirerope_mj.engine.response.peaks import Peaks
from wirerope_mj.engine.response.response import Response
from wirerope_mj.engine.system import System
from wirerope_mj.foundation.errors import AccuracyWarning, SimulationError
from wirerope_mj.motions import BaseMotion
from wirerope_mj.mounts.isolator.travel import beyond_law


def warn_of_aliasing(motion: BaseMotion, sample_rate: float) -> None:
    """Warn where the motion is steadily faster than samples can tell: histories show what is not there."""
    fastest = max((1.0 / part.shortest_time for part in motion.parts if part.kind in _OF_FREQUENCIES), default=0.0)
    if fastest > 0.5 * sample_rate:
        warnings.warn(
            f"the base moves at up to {fastest:.4g} Hz, and {sample_rate:.4g} samples a second tell nothing above "
            f"{0.5 * sample_rate:.4g} Hz: histories and spectra of the samples show what is not there. Peaks are those of "
            f"every step. Give a `sample_rate` of at least {10.0 * fastest:.4g} Hz.",
            AccuracyWarning,
            stacklevel=3,
        )


# kinds of motions whose shortest time is a period
_OF_FREQUENCIES = ("sine", "sweep", "vibration-lines", "random-vibration", "harmonic-force", "unbalance")


def require_lawful(system: System, peaks: Peaks) -> None:
    """Raise SimulationError if a mount went to where the law of an axis does not hold."""
    for name, mount in system.mounts.items():
        if mount.isolator.holds_everywhere:
            continue
        peak = peaks.mounts[name].deflection
        if beyond := beyond_law(mount.isolator.axes, peak.minimum, peak.maximum):
            raise SimulationError(
                f"mount {name!r} was {beyond}: shake it more gently, or take an isolator with more travel."
            )


def warn_of_uncertainty(response: Response) -> None:
    """Warn where contacts were struck, and where the estimated error is above the accuracy that was asked for.

    A stop among the mounts' laws is as certain as they are: that it was struck is a verdict, and no doubt about numbers.
    """
    numerics = response.numerics
    contacts = {name: one for name, one in (response.peaks.contacts or {}).items() if not one.mount}
    struck = [name for name in response.peaks.struck if name in contacts]
    if struck:
        warnings.warn(
            f"{len(struck)} of {len(contacts)} contact pairs were struck, first {struck[0]} at "
            f"{contacts[struck[0]].first_touch:.4f} s: accelerations are uncertain from there on, because they depend on "
            "stiffness and damping of the stops.",
            AccuracyWarning,
            stacklevel=3,
        )
    if numerics.limited_by == SENSITIVE:
        warnings.warn(
            f"the answer is sensitive to what the system hits: runs with steps of {1e3 * numerics.timestep:.4g} ms and less "
            f"differ by up to {numerics.error_estimate:.1e} of the peaks, and finer ones do not agree better. Take the peaks "
            "with that spread, or give the stops more loss.",
            AccuracyWarning,
            stacklevel=3,
        )
    elif numerics.error_estimate > numerics.accuracy:
        warnings.warn(
            f"the estimated error, {numerics.error_estimate:.1e} of the peaks, is above the accuracy asked for, "
            f"{numerics.accuracy:.1e}: the step of {1e3 * numerics.timestep:.4g} ms is limited by {numerics.limited_by}. "
            "Ask for less (a larger `accuracy`), or give a smaller `timestep`.",
            AccuracyWarning,
            stacklevel=3,
        )
