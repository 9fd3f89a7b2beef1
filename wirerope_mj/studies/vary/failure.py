"""An isolator that has failed: laws with as many states and hardly any force, of the same kinds where that is possible."""

from dataclasses import replace

from wirerope_mj.mounts.isolator import Isolator


def acts(isolator: Isolator) -> bool:
    """Return whether an isolator makes forces: it is there, and has not failed."""
    return any(law is not None and law != law.faint() for law in isolator.axes.values())


def without_force(isolator: Isolator) -> Isolator:
    """Return the isolator after its failure; its equations keep their structure where its laws keep their kinds."""
    acting = isolator.conditioned
    laws = {axis: law.faint() for axis, law in acting.axes.items() if law is not None}
    loop = None if acting.loop is None else acting.loop.scaled(0.0)
    return replace(isolator, loop=loop, rotation=None, stiffening=None, bracket=None, **laws)  # type: ignore[arg-type]
