"""What of a motion lies outside the cycles that the laws of its mounts were identified from."""

from collections.abc import Mapping

from wirerope_mj.engine.response import Response
from wirerope_mj.foundation.arrays import Array
from wirerope_mj.mounts.isolator import Isolator
from wirerope_mj.mounts.isolator.travel import falling_text

_NAMED = 3  # mounts and axes that a sentence names


def untested(isolators: Mapping[str, Isolator], ends: Mapping[str, tuple[Array, Array]]) -> str:
    """Return which mounts move how far outside their isolators' tested ranges, in part of a sentence; "" where none does.

    `ends` are the lowest and highest deflections along roll, shear and axial [m], (3,) each, by mount.
    """
    found = [
        f"{name} {axis} {text}"
        for name, isolator in isolators.items()
        for axis, text in isolator.validity.outside(*ends[name], small=True).items()
    ]
    more = len(found) - _NAMED
    return ", ".join(found[:_NAMED]) + (f" and {more} more" if more > 0 else "")


def untested_line(isolators: Mapping[str, Isolator], response: Response) -> str:
    """Return a sentence on the mounts whose deflections in a run are outside what was tested; "" where none is."""
    peaks = {name: mount.deflection for name, mount in response.peaks.mounts.items()}
    ends = {name: (peak.minimum, peak.maximum) for name, peak in peaks.items()}
    where = untested(isolators, ends)
    return where and (
        f"Outside the cycles that the isolator was identified from, and so extrapolated: {where}. The error of the fit says "
        "nothing of forces there."
    )


def falling_line(isolators: Mapping[str, Isolator], response: Response) -> str:
    """Return a sentence on the mounts that went where their force falls as the deflection grows; "" where none did."""
    found = []
    for name, mount in response.peaks.mounts.items():
        ends = zip(isolators[name].axes.items(), mount.deflection.minimum, mount.deflection.maximum, strict=True)
        for (axis, law), low, high in ends:
            if law is not None and (text := falling_text(law, min(float(low), 0.0), max(float(high), 0.0))):
                found.append(f"{name} {axis}: {text}")
    more = len(found) - _NAMED
    listed = "; ".join(found[:_NAMED]) + (f"; and {more} more" if more > 0 else "")
    return listed and f"Mounts went where their force falls as the deflection grows, and pushes the load away: {listed}."
