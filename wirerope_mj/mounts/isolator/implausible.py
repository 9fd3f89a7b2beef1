"""Probable slips in isolators that can be simulated: units, ratios for stiffnesses, signs."""

import math
from collections.abc import Iterator

import numpy as np

from wirerope_mj.foundation.units import STANDARD_GRAVITY
from wirerope_mj.mounts.isolator.device import Isolator
from wirerope_mj.mounts.laws import Law, Normalised

# axial force at the rated compression over the rated static load: 86 isolators of the vendors' tables have 2.9 to 5.3, three
# times less and more is left for other makes; kilograms taken for newtons, pounds, or N/mm for N/m are beyond
_RATED = (1.0, 15.0)
# stiffness across the axis over that along it, in small cycles: those isolators have 0.08 to 0.4, rubber in shear 0.03; another
# unit on one axis is a thousand
_ACROSS = (1 / 300, 30.0)
# rated travel in compression over height: those isolators have 0.29 to 0.66; inches taken for mm are 25 times less
_TRAVEL = 0.1
_CYCLE, _UNDAMPED = 0.05, 2e-3  # of the height: of cycles in which a law has friction; damping ratio of steel without any
_SMALL = 0.02  # of the height: of cycles in which the stiffnesses of the axes are compared
_RATIO = 1.0  # N/m: a slope of a force that is at most this, beside a law that is a thousand times stiffer, is a ratio
_SOFT = 0.05  # stiffness of a bracket over its law's: it would take nearly all of the travel
_LONGEST = 0.2  # m: depth over which a stop closes that is longer than any isolator is high


def isolator_warnings(isolator: Isolator) -> tuple[str, ...]:
    """Return a sentence on each probable slip of an isolator, with the key and the remedy."""
    return tuple(f"isolator {isolator.name}: {text}" for text in _slips(isolator))


def _slips(isolator: Isolator) -> Iterator[str]:
    """Yield a sentence on each probable slip in laws, bracket, rated load, friction and stiffness across the axis."""
    for axis, law in isolator.axes.items():
        for part in law.components if law is not None else ():
            yield from _of_law(axis, part, isolator)
    for axis, stiffness in isolator.bracket.stated.items() if isolator.bracket is not None else ():
        law = isolator.axes[axis]
        if law is not None and stiffness < _SOFT * law.initial_stiffness:
            yield (
                f"[bracket] `{axis}` of {stiffness:.4g} N/m is softer than a twentieth of the law, {law.initial_stiffness:.4g} "
                "N/m: is it in N/mm?"
            )
    yield from _rated_force(isolator)
    yield from _lost_friction(isolator)
    yield from _across(isolator)


def _of_law(axis: str, law: Law, isolator: Isolator) -> Iterator[str]:
    """Yield sentences on slips in a law: a ratio for alpha, friction that never yields, a length in mm, a wrong sign."""
    alpha, rounding = getattr(law, "alpha", None), getattr(law, "rounding", 0.0)
    others = sum(abs(getattr(law, name, 0.0)) for name in ("k", "k1"))
    if alpha is not None and 0.0 < alpha <= _RATIO and others > 1e3 * alpha:
        yield (
            f"[{axis}] {law.name}: `alpha` of {alpha:g} N/m is nothing beside a stiffness of {others:.4g} N/m. It is the slope "
            "of the hysteretic force, in N/m, and not the ratio of stiffnesses that other texts call alpha."
        )
    form, height = law.normal_form, isolator.geometry.height if isolator.geometry else None
    if isinstance(form, Normalised) and height is not None and form.x_y > height:
        yield (
            f"[{axis}] {law.name}: friction yields at {form.x_y:.3g} m, beyond the isolator's height of {height:g} m, so that "
            "it is a spring. `beta` and `gamma` are in N^(1-n)/m: they change with `n`, and with N for kN."
        )
    if rounding > _LONGEST:
        yield f"[{axis}] {law.name}: `rounding` of {rounding:g} m is longer than an isolator is high: is it in mm?"
    if axis == "axial" and (asymmetry := getattr(law, "asymmetry", 0.0)) < 0.0:
        yield (
            f"[axial] {law.name}: `c` ln `b` of {asymmetry:.3g} 1/m is negative: the isolator softens in tension, where its "
            "rope straightens, and hardens in compression. Deflection is positive in tension: turn the sign of `c`, or of the "
            "deflections that it was fitted to."
        )


def _force(law: Law, deflection: float) -> float:
    """Return the force of a law that is pushed slowly to a deflection [N], positive where it resists."""
    path = np.linspace(0.0, deflection, 50)
    force = law.trace(path, time=None if law.rate_independent else np.linspace(0.0, 1e3, 50)).force[-1]
    return math.copysign(1.0, deflection) * float(force)


def _rated_force(isolator: Isolator) -> Iterator[str]:
    """Yield a sentence if the axial force at the rated compression is negative or no likely multiple of the static load."""
    rated, travel, law = isolator.limits.static_load, isolator.limits.travel.compression, isolator.axial
    height = isolator.geometry.height if isolator.geometry else None
    if travel is not None and height and travel < _TRAVEL * height:
        yield (
            f"its travel in compression of {1e3 * travel:.3g} mm is {100.0 * travel / height:.2g} % of its height of "
            f"{1e3 * height:.4g} mm, and 29 to 66 % in the vendors' "
            "tables: is the travel in inches or cm where mm or m is said?"
        )
        return
    if rated is None or travel is None or law is None or law.stops or travel > law.travel_ends[0]:
        return
    ratio = _force(law, -travel) / rated
    if ratio < 0.0:
        yield (
            f"the axial force at the rated compression of {1e3 * travel:.3g} mm presses the isolator on, instead of resisting: "
            "check the signs of the law's stiffnesses."
        )
    elif not _RATED[0] <= ratio <= _RATED[1]:
        units = {"kg": STANDARD_GRAVITY, "lbf": 4.448, "kN": 1e3} if ratio > 1.0 else {}
        guess = [unit for unit, size in units.items() if _RATED[0] <= ratio / size <= _RATED[1]]
        laws = "are the laws' forces and stiffnesses in N and N/m" + (", and not in N/mm" if ratio < 0.1 else "")
        named = f"is `static_load` in {' or '.join(guess)}, or are stiffnesses in another unit" if guess else laws
        yield (
            f"the axial force at the rated compression of {1e3 * travel:.3g} mm is {ratio:.3g} times the `static_load` of "
            f"{rated:.4g} N, and 3 to 5 times in the vendors' tables: {named}{'' if guess else ', `static_load` in N'}, "
            "and is it "
            "that of this part?"
        )


def _lost_friction(isolator: Isolator) -> Iterator[str]:
    """Yield a warning for each axis whose hysteretic force is nothing beside its elastic one."""
    height = isolator.geometry.height if isolator.geometry else None
    for axis, law in isolator.axes.items():
        forms = [part.normal_form for part in law.components] if law is not None else []
        if law is None or height is None or law.stops or not law.rate_independent:
            continue
        if not any(isinstance(form, Normalised) for form in forms):
            continue
        x = _CYCLE * height * np.sin(np.linspace(0.0, 4.0 * np.pi, 801))
        last, force = x[400:], law.trace(x).force[400:]
        damping = float(np.trapezoid(force, last)) / (np.pi * _CYCLE * height * float(np.ptp(force)))
        if 0.0 <= damping < _UNDAMPED:
            yield (
                f"[{axis}] in cycles of {1e3 * _CYCLE * height:.3g} mm the damping ratio is {100.0 * damping:.2g} %, "
                "and that of "
                "wire rope 5 to 20 %: friction is lost. `beta` and `gamma` are in N^(1-n)/m: they change with `n`, and with N "
                "for kN or m for mm."
            )


def _across(isolator: Isolator) -> Iterator[str]:
    """Yield a sentence for roll or shear if its stiffness in small cycles is no likely fraction of the axial one."""
    height, along = isolator.geometry.height if isolator.geometry else None, isolator.axial
    if along is None or height is None or along.stops:
        return
    stiffness = _force(along, -_SMALL * height)
    for axis in ("roll", "shear"):
        law = isolator.axes[axis]
        if law is None or law.stops or stiffness == 0.0 or math.isnan(stiffness):
            continue
        if not _ACROSS[0] <= (ratio := _force(law, _SMALL * height) / stiffness) <= _ACROSS[1]:
            yield (
                f"[{axis}] is {ratio:.3g} times as stiff as [axial] in small cycles, and in the vendors' tables 0.08 to 0.4 "
                "times: is one of the two in N/mm?"
            )
