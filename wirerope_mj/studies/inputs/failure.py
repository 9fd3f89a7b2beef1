"""An isolator that has failed: laws with as many states and hardly any force, of the same kinds where that is possible."""

from dataclasses import fields, replace

from wirerope_mj.mounts.isolator import Isolator
from wirerope_mj.mounts.laws import (
    EnhancedDryFriction,
    EquivalentViscous,
    KelvinVoigt,
    Law,
    Masing,
    OnBracket,
    Parallel,
    TinkerCutchins,
    VaianaRosati,
    Zener,
)
from wirerope_mj.mounts.laws.hysteresis import Hysteresis

# Stiffness [N/m], damping [N s/m] and slip force [N] of what has failed: it carries nothing, and keeps its states' places.
FAINT = 1e-12


def acts(isolator: Isolator) -> bool:
    """Return whether an isolator makes forces: it is there, and has not failed."""
    return any(law is not None and law != _faint(law) for law in isolator.axes.values())


def without_force(isolator: Isolator) -> Isolator:
    """Return the isolator after its failure; its equations keep their structure where its laws keep their kinds."""
    acting = isolator.conditioned
    laws = {axis: _faint(law) for axis, law in acting.axes.items() if law is not None}
    loop = None if acting.loop is None else acting.loop.scaled(0.0)
    return replace(isolator, loop=loop, rotation=None, stiffening=None, bracket=None, **laws)  # type: ignore[arg-type]


def _faint(law: Law) -> Law:
    if isinstance(law, Masing):
        faint = (FAINT,) * len(law.stiffness)
        return replace(law, stiffness=faint, slip_force=faint, k=0.0, k2=0.0, k3=0.0)
    if isinstance(law, Parallel):
        return Parallel(laws=tuple(_faint(part) for part in law.laws))
    if isinstance(law, OnBracket):
        return _faint(law.law)
    # A bound of 1 N is never reached, and any two laws that have it can be coupled.
    if isinstance(law, EnhancedDryFriction):
        return replace(law, k=0.0, d=1.0, u_c=1.0 / FAINT)
    if isinstance(law, Hysteresis):
        own = {field.name for field in fields(law)}
        return replace(law, **{name: value for name, value in _FAINT_HYSTERESIS.items() if name in own})
    if isinstance(law, EquivalentViscous | TinkerCutchins | VaianaRosati):
        return replace(law, **dict.fromkeys(law.force_powers, FAINT))  # type: ignore[arg-type]
    if law.n_states > 1:
        return law.scaled(FAINT / law.initial_stiffness)
    return _FAINT_WITH_STATE if law.n_states == 1 else _FAINT_WITHOUT_STATE


_FAINT_HYSTERESIS = {"alpha": FAINT, "beta": FAINT, "n": 1.0} | dict.fromkeys(("gamma", "k", "k1", "k2", "k3", "c"), 0.0)
_FAINT_WITH_STATE, _FAINT_WITHOUT_STATE = Zener(k0=0.0, k1=FAINT, c=FAINT), KelvinVoigt(k=0.0, c=FAINT)
