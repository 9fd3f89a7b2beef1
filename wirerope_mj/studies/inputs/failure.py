"""An isolator that has failed: laws with as many states and hardly any force."""

from dataclasses import replace

from wirerope_mj.mounts.isolator import Isolator
from wirerope_mj.mounts.laws import BoucWenBaberNoori, KelvinVoigt, Law, Masing, Parallel, Zener

# Stiffness [N/m], damping [N s/m] and slip force [N] of what has failed: it carries nothing, and keeps its states' places.
FAINT = 1e-6


def acts(isolator: Isolator) -> bool:
    """Return whether an isolator makes forces: it is there, and has not failed."""
    return any(law is not None and law != _faint(law) for law in isolator.axes.values())


def without_force(isolator: Isolator) -> Isolator:
    """Return the isolator after its failure: laws with as many states and hardly any force."""
    laws = {axis: _faint(law) for axis, law in isolator.conditioned.axes.items() if law is not None}
    return replace(isolator, coupling=None, loop=None, rotation=None, stiffening=None, bracket=None, **laws)  # type: ignore[arg-type]


def _faint(law: Law) -> Law:
    if isinstance(law, Masing):
        faint = (FAINT,) * len(law.stiffness)
        return replace(law, stiffness=faint, slip_force=faint, k=0.0, k2=0.0, k3=0.0)
    if isinstance(law, BoucWenBaberNoori):
        return replace(law, alpha=FAINT, k=0.0)
    if isinstance(law, Parallel):
        return Parallel(laws=tuple(_faint(part) for part in law.laws))
    if law.n_states > 1:
        return law.scaled(FAINT / law.initial_stiffness)
    return _FAINT_WITH_STATE if law.n_states == 1 else _FAINT_WITHOUT_STATE


_FAINT_WITH_STATE, _FAINT_WITHOUT_STATE = Zener(k0=0.0, k1=FAINT, c=FAINT), KelvinVoigt(k=0.0, c=FAINT)
