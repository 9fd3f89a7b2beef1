"""Further terms of laws that tests may leave open, hardening and asymmetry, as unknowns beside the calibrated law."""

import math
import re
from collections.abc import Mapping
from dataclasses import dataclass, replace

import numpy as np

from wirerope_mj.engine.system import Changes, System, load_system
from wirerope_mj.engine.system.varied import with_changes
from wirerope_mj.foundation.arrays import Array
from wirerope_mj.mounts.isolator import AXES, Isolator
from wirerope_mj.mounts.laws import AsymmetricBoucWen, Law, Parallel, SymmetricBoucWen
from wirerope_mj.studies.vary.distributions import Distribution, Normal

HARDENING = 0.3  # Standard deviation, before the tests, of each term's force at the tested travel over the law's there
LOOKED_AT = 0.2  # Travel over the largest that was tested from which on the law of an axis is opened
FAINT = 1e-6  # Slope and bound of the hysteresis that the added terms have, over the law's: they are elastic
_PARAMETER = re.compile(rf"mount/(.*)/({'|'.join(AXES)})/(?!laws\[)([^/]*)")


@dataclass(frozen=True, kw_only=True)
class OpenLaws:
    """System whose laws have additional terms of unknown size, and the priors of all unknowns."""

    system: System
    vary: Mapping[str, Distribution]  # what varied of the system, by its new names, and the terms
    added: tuple[str, ...]  # names of the terms among them


def open_laws(system: System, vary: Mapping[str, Distribution], travel: Mapping[tuple[str, str], float]) -> OpenLaws:
    """Add terms of unknown size, hardening and asymmetry, to the laws along the axes that tests moved.

    F becomes F + K x (e^(q x) - 1) + k2 x |x| + k3 x^3, where K is the law's secant stiffness at the tested travel d; before
    the tests q d (axial only), k2 d / K and k3 d^2 / K are normal with mean 0 and standard deviation `HARDENING`. Mounts with
    one isolator share them. On coupled axes the laws' own k2 and k3, where they have such, are unknowns instead.

    Args:
        system: as it was calibrated.
        vary: what of it varies.
        travel: largest deflection in the tests by mount and axis [m].
    """
    largest, files = max(travel.values()), dict(system.isolators)
    terms: dict[str, Distribution] = {}
    alone: set[str] = set()  # axes whose laws have become the first of several
    changed: dict[str, Isolator] = {}
    for name, isolator in system.isolators.items():
        mounts = [mount for mount, item in system.mounts.items() if item.isolator_name == name]
        added: dict[str, tuple[Law, Law]] = {}
        for axis, law in isolator.axes.items():
            reached = max((travel.get((mount, axis), 0.0) for mount in mounts), default=0.0)
            if law is None or isolator.is_stop or reached < LOOKED_AT * largest:
                continue
            bracket = isolator.bracket is not None and axis in isolator.bracket.stated
            if bracket and not all(part.smoothable for part in law.components):
                continue  # it holds a linear law alone, and none beside the terms
            stiffness, place = secant_stiffness(law, reached), f"mount/{','.join(mounts)}/{axis}"
            sizes = {"k2": stiffness / reached, "k3": stiffness / reached**2}
            if AXES.index(axis) in isolator.coupled_axes:  # stands beside no other law; some have such terms of their own
                stated = {key: getattr(law, key, None) for key in sizes if f"{place}/{key}" not in vary}
                terms |= {
                    f"{place}/{key}": Normal(value, HARDENING * sizes[key])
                    for key, value in stated.items()
                    if value is not None
                }
                continue
            faint = {"alpha": FAINT * stiffness, "beta": 1.0 / reached, "gamma": 0.0, "n": 1.0, "k2": 0.0, "k3": 0.0}
            odd = SymmetricBoucWen(k1=-stiffness, **faint)
            added[axis] = odd, AsymmetricBoucWen(k1=stiffness, b=math.e, c=0.0, **faint)  # which are 0 in all
            if not law.factors:
                alone.add(axis)
            for key, size in (sizes | ({"c": 1.0 / reached} if axis == "axial" else {})).items():
                number = len(law.components) + (key == "c")
                terms[f"{place}/laws[{number}].{key}"] = Normal(0.0, HARDENING * size)
        files[name] = _with_terms(isolator, added)
        changed |= {
            mount: _with_terms(system.mounts[mount].written, added)
            for mount in mounts
            if added and system.mounts[mount].written != isolator
        }
    moves = [*(replace(change, isolators={}) for change in system.changes), Changes(isolators=changed)]
    loaded = load_system(system.path or system.mjcf, isolators=files)
    loaded = with_changes(loaded, [change for change in moves if change != Changes()])
    renamed = {_renamed(name, alone): distribution for name, distribution in vary.items() if not name.startswith("channel/")}
    chain = {name: distribution for name, distribution in vary.items() if name.startswith("channel/")}
    return OpenLaws(system=loaded, vary=renamed | terms | chain, added=tuple(terms))


def secant_stiffness(law: Law, reached: float) -> float:
    """Return the stiffness of a law between a deflection and its mirror image on first loading [N/m]."""
    _, force = _loaded(law, reached)
    return float((force[49] - force[-1]) / (2.0 * reached))


def rises(law: Law, reached: float) -> bool:
    """Return whether the force of a law rises with deflection up to a deflection [m] on both sides."""
    path, force = _loaded(law, reached)
    return bool((np.diff(force) * np.diff(path) >= 0.0).all())  # NaN does not


def _loaded(law: Law, reached: float) -> tuple[Array, Array]:
    """Return a slow path to a deflection (row 49) and on to its mirror image [m], and the force along it [N], (n,) each."""
    path = reached * np.concatenate([np.linspace(0.0, 1.0, 50), np.linspace(1.0, -1.0, 100)[1:]])
    return path, law.trace(path, time=np.linspace(0.0, 1.0, path.size)).force


def _with_terms(isolator: Isolator, added: Mapping[str, tuple[Law, Law]]) -> Isolator:
    """Return an isolator with terms in parallel to the laws of some axes, and with its spread's parameters renamed to match."""
    spread = isolator.spread
    if spread is not None:
        names = spread.parameters
        for axis in added:
            if (law := isolator.axes[axis]) is not None and not law.factors:
                names = tuple(re.sub(rf"^{axis}\.", f"{axis}.laws[0].", name) for name in names)
        spread = replace(spread, parameters=names)
    laws = {
        axis: Parallel(laws=(*law.components, *added[axis])) for axis, law in isolator.axes.items() if law and axis in added
    }
    return replace(isolator, spread=spread, **laws)  # type: ignore[arg-type]


def _renamed(name: str, alone: set[str]) -> str:
    """Rename a quantity of laws that stood alone on the axes `alone` and have become laws[0] of a Parallel."""

    def first(match: re.Match[str]) -> str:
        pattern, axis, parameter = match.groups()
        return f"mount/{pattern}/{axis}/laws[0].{parameter}" if axis in alone else match[0]

    return " & ".join(_PARAMETER.sub(first, part) for part in name.split(" & "))
