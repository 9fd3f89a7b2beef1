"""The registry of laws: every law's class and kernel, and from a law's number to its force and to its closed form.

A kernel is a law's force, one source for one system and for several side by side. All of them have the same signature

    force = kernel(p, i, x, v, z, j, zdot, k)

with the parameters in `p[i:]`, deflection `x` [m], deflection rate `v` [m/s] and internal states in `z[j:]`; it writes the
states' rates to `zdot[k:]` and returns the force [N]. With JIT disabled the kernels are plain Python. In lanes (see
`wirerope_mj.foundation.lanes`) no branch may depend on a number that lanes can differ in, and integers among the parameters,
in which they cannot, are read by `count`.

A law joins by its line in `REGISTERED`. One with a closed form is named in the three functions at the end, too; without one
it is integrated.
"""

import math
from collections.abc import Callable
from enum import IntEnum, unique
from typing import Any

import numpy as np

from wirerope_mj.foundation.c_functions import called
from wirerope_mj.foundation.jit import inlined, njit
from wirerope_mj.foundation.lanes import count, some, where
from wirerope_mj.mounts.laws.bouc_wen import BOUC_WEN, BoucWen, Ozdemir, bouc_wen, bouc_wen_rate
from wirerope_mj.mounts.laws.exact import advance_bouc_wen, carry_bouc_wen
from wirerope_mj.mounts.laws.friction import MASING, EnhancedDryFriction, Masing, hold_slip, masing, masing_increment
from wirerope_mj.mounts.laws.law import Law
from wirerope_mj.mounts.laws.ni import (
    ASYMMETRIC_BOUC_WEN,
    SYMMETRIC_BOUC_WEN,
    AsymmetricBoucWen,
    SymmetricBoucWen,
    asymmetric_bouc_wen,
    symmetric_bouc_wen,
)
from wirerope_mj.mounts.laws.parallel import PARALLEL, Parallel
from wirerope_mj.mounts.laws.plane_kernels import BIAXIAL, LOOP, ON_BRACKETS
from wirerope_mj.mounts.laws.softening import BoucWenBaberNoori, ScraggedBoucWen, baber_noori, scragged_bouc_wen
from wirerope_mj.mounts.laws.stop import STOP, Stop
from wirerope_mj.mounts.laws.stop_kernels import LOSS, advance_stop, loss_state_after, stop
from wirerope_mj.mounts.laws.table_kernels import advance_table, tabulated
from wirerope_mj.mounts.laws.tabulated import TABULATED, Tabulated
from wirerope_mj.mounts.laws.vaiana_rosati import VAIANA_ROSATI, VaianaRosati, approach, approach_work, vaiana_rosati
from wirerope_mj.mounts.laws.viscous import (
    KELVIN_VOIGT,
    EquivalentViscous,
    KelvinVoigt,
    TinkerCutchins,
    Zener,
    kelvin_voigt,
    tinker_cutchins,
    zener,
)
from wirerope_mj.mounts.laws.wrapped import HEAD, ON_BRACKET, SMOOTHED, OnBracket, Smoothed

# The laws of isolator files, each with its kernel.
REGISTERED: tuple[tuple[type[Law], Callable[..., Any]], ...] = (
    (BoucWen, bouc_wen),
    (Ozdemir, bouc_wen),
    (AsymmetricBoucWen, asymmetric_bouc_wen),
    (SymmetricBoucWen, symmetric_bouc_wen),
    (BoucWenBaberNoori, baber_noori),
    (ScraggedBoucWen, scragged_bouc_wen),
    (VaianaRosati, vaiana_rosati),
    (EnhancedDryFriction, bouc_wen),
    (Masing, masing),
    (TinkerCutchins, tinker_cutchins),
    (EquivalentViscous, tinker_cutchins),
    (KelvinVoigt, kelvin_voigt),
    (Zener, zener),
    (Stop, stop),
    (Tabulated, tabulated),
)
# The laws by the name that an isolator file calls them.
LAWS: dict[str, type[Law]] = {law.name: law for law, _ in REGISTERED}
OWN = 17  # the function of a law that a program brings along, by its address: see `OwnLaw`
_OTHERS = {law.name.upper().replace("-", "_"): law.kernel for law in (Parallel, Smoothed, OnBracket)} | {
    "OWN": OWN, "BIAXIAL": BIAXIAL, "LOOP": LOOP, "ON_BRACKETS": ON_BRACKETS,
}  # fmt: skip
# Every kernel by its number, which is its law's `kernel`: ValueError names two that have one.
Kernel = unique(IntEnum("Kernel", {kernel.__name__.upper(): law.kernel for law, kernel in REGISTERED} | _OTHERS))  # type: ignore[type-var]
# Kernels whose force depends on the deflection rate; a stop's may, too.
RATE_DEPENDENT = (*sorted({law.kernel for law, _ in REGISTERED if law.rate_independent is False}), SMOOTHED)
# Kernels whose parameters begin with alpha, beta, gamma, n and whose only state follows Bouc-Wen's equation.
BOUC_WEN_LAWS = (BOUC_WEN, SYMMETRIC_BOUC_WEN, ASYMMETRIC_BOUC_WEN)


@njit
def unknown(law, p, i, x, v, z, j, zdot, k):
    """Return NaN, the force of a law without a kernel."""
    return np.nan


def dispatcher_of(kernels):
    """Make the function that calls the kernel of the law number in its first argument, from kernels by number."""
    rows, choice = list(kernels.items()), unknown
    while rows:  # six to a function: each function that Numba compiles costs what some lines do
        rows, choice = rows[:-6], _choice((rows[-6:] * 6)[:6], choice)
    return choice


def _choice(kernels, otherwise):
    """Make the function that calls one of six kernels, each given with its law's number, or `otherwise`."""
    (n0, f0), (n1, f1), (n2, f2), (n3, f3), (n4, f4), (n5, f5) = kernels

    @njit
    def choose(law, p, i, x, v, z, j, zdot, k):
        if law == n0:
            return f0(p, i, x, v, z, j, zdot, k)
        if law == n1:
            return f1(p, i, x, v, z, j, zdot, k)
        if law == n2:
            return f2(p, i, x, v, z, j, zdot, k)
        if law == n3:
            return f3(p, i, x, v, z, j, zdot, k)
        if law == n4:
            return f4(p, i, x, v, z, j, zdot, k)
        if law == n5:
            return f5(p, i, x, v, z, j, zdot, k)
        return otherwise(law, p, i, x, v, z, j, zdot, k)

    return choose


# The laws with one state whose rate is a slope for v > 0 and another for v < 0, times v.
smoothable = dispatcher_of({law.kernel: kernel for law, kernel in REGISTERED if law.smoothable})


@njit
def smoothed(p, i, x, v, z, j, zdot, k):
    """Return the force of a law whose two slopes blend over a velocity: zdot = v [s+ (1 + t) + s- (1 - t)] / 2, t = tanh(v/e).

    p = e, number of the law, its parameters; s+ and s- are its slopes dz/dx for v > 0 and v < 0.
    """
    law, blend = count(p, i + 1), math.tanh(v / p[i])
    force = smoothable(law, p, i + 2, x, -1.0, z, j, zdot, k)
    if law in BOUC_WEN_LAWS:  # z may pass the bound that either slope has: that of the blend counts
        zdot[k] = bouc_wen_rate(p[i + 2], p[i + 3] * abs(blend), p[i + 4], p[i + 5], v, z[j])
        return force
    down, half = -zdot[k], 0.5 * blend
    smoothable(law, p, i + 2, x, 1.0, z, j, zdot, k)
    zdot[k] = v * (zdot[k] * (0.5 + half) + down * (0.5 - half))
    return force


@njit
def behind_bracket(p, i, x, v, z, j, zdot, k):
    """Return the sum of the forces of the laws on a bracket [N]; `z` and `zdot` may be one array."""
    force = 0.0
    for part in range(count(p, i + HEAD)):
        row = i + HEAD + 1 + 3 * part
        state, first = count(p, row + 2), i + HEAD + count(p, row + 1)
        force += smoothable(count(p, row), p, first, x, v, z, j + state, zdot, k + state)
    return force


# Step of the difference that yields a bracketed law's tangent [m]: it costs 1e-16 of the force and 1e-8 of a curvature's part.
_NUDGE = 1e-8
_ROUNDED = 1e-15  # of deflections: the residual that rounding leaves
_SECANTS = 30  # five are usual


@njit
def on_bracket(p, i, x, v, z, j, zdot, k):
    """Return the force of a law in series with a spring [N], see `OnBracket`; p = K, number of states, laws in parallel.

    The law's deflection d + f(d) / K = x by secants, each lane until it is found.
    """
    stiffness, s = p[i], where(v < 0.0, -1.0, 1.0)
    before = x
    force = behind_bracket(p, i, x, s, z, j, zdot, k)
    last = force / stiffness
    d = x - last
    for _ in range(_SECANTS):
        force = behind_bracket(p, i, d, s, z, j, zdot, k)
        left = d - x + force / stiffness
        open_ = (abs(left) > _ROUNDED * (abs(x) + abs(d))) & (d != before)
        if not some(open_):
            break
        slope = where(open_, (left - last) / where(open_, d - before, 1.0), 1.0)
        before, last, d = where(open_, d, before), where(open_, left, last), where(open_, d - left / slope, d)
    for state in range(count(p, i + 1)):
        zdot[k + state] = z[j + state] + _NUDGE * zdot[k + state]
    tangent = s * (behind_bracket(p, i, d + s * _NUDGE, s, zdot, k, zdot, k) - force) / _NUDGE
    behind_bracket(p, i, d, s, z, j, zdot, k)
    ratio = abs(v) * stiffness / (stiffness + tangent)
    for state in range(count(p, i + 1)):
        zdot[k + state] = ratio * zdot[k + state]
    return force


@inlined
def common(law, p, i, x, v, z, j, zdot, k):
    """Return the force [N] of one of the laws that most mounts have, and write the rates of its states."""
    if law == ASYMMETRIC_BOUC_WEN:
        return asymmetric_bouc_wen(p, i, x, v, z, j, zdot, k)
    if law == SYMMETRIC_BOUC_WEN:
        return symmetric_bouc_wen(p, i, x, v, z, j, zdot, k)
    if law == BOUC_WEN:
        return bouc_wen(p, i, x, v, z, j, zdot, k)
    return kelvin_voigt(p, i, x, v, z, j, zdot, k)


# The laws that few mounts have: inlined, they would slow down the others.
evaluate_rarer = dispatcher_of(
    {law.kernel: kernel for law, kernel in REGISTERED if law.kernel > KELVIN_VOIGT}
    | {SMOOTHED: smoothed, ON_BRACKET: on_bracket, OWN: called}
)


@njit
def evaluate_single(law, p, i, x, v, z, j, zdot, k):
    """Return the force [N] of a law that is not several in parallel, and write the rates of its states."""
    if law <= KELVIN_VOIGT:
        return common(law, p, i, x, v, z, j, zdot, k)
    return evaluate_rarer(law, p, i, x, v, z, j, zdot, k)


@njit
def parallel(p, i, x, v, z, j, zdot, k):
    """Return the sum of the forces of several laws [N].

    p = their number, for each of them its own number and where its parameters and its states begin, the parameters.
    """
    force = 0.0
    for part in range(count(p, i)):
        row = i + 1 + 3 * part
        state = count(p, row + 2)
        force += evaluate_single(count(p, row), p, i + count(p, row + 1), x, v, z, j + state, zdot, k + state)
    return force


@inlined
def evaluate(law, p, i, x, v, z, j, zdot, k):
    """Return the force [N] of the law with this number and write the rates of its states."""
    if law <= KELVIN_VOIGT:
        return common(law, p, i, x, v, z, j, zdot, k)
    if law == PARALLEL:
        return parallel(p, i, x, v, z, j, zdot, k)
    return evaluate_rarer(law, p, i, x, v, z, j, zdot, k)


@njit
def component(p, i, part, n_states):
    """Return law number, first parameter, first state and number of states of one of several laws in parallel."""
    row = i + 1 + 3 * part
    after = int(p[row + 5]) if part + 1 < int(p[i]) else n_states
    return int(p[row]), i + int(p[row + 1]), int(p[row + 2]), after - int(p[row + 2])


@njit
def hold_slips(law, p, i, z, j):
    """Clip the states of each of Masing's laws among several in parallel, or the only one, to the slip forces."""
    if law == MASING:
        hold_slip(p, i, z, j)
    elif law == PARALLEL:
        for part in range(count(p, i)):
            row = i + 1 + 3 * part
            if count(p, row) == MASING:
                hold_slip(p, i + count(p, row + 1), z, j + count(p, row + 2))


@njit
def has_closed_form(law, p, i):
    """True if the law of this number has a closed form with these parameters."""
    if law in BOUC_WEN_LAWS:
        return p[i + 3] == 1.0 or p[i + 3] == 2.0
    return law in (MASING, VAIANA_ROSATI, STOP, TABULATED)


@njit
def advance_exactly(law, p, i, x0, x1, z, j, trial, unused):
    """Carry the states in `z[j:]` in place from deflection x0 to x1 and return the work done on the law [J].

    `trial` and `unused` are scratch arrays of at least one entry. The law must have a closed form.
    """
    if law == MASING:
        return masing_increment(p, i, x0, x1, z, j)
    if law == VAIANA_ROSATI:
        work = approach_work(p, i, x0, x1, z[j])
        z[j] = approach(p, i, x0, x1, z[j])
        return work
    if law == STOP:
        return advance_stop(p, i, x0, x1, z, j)
    if law == TABULATED:
        return advance_table(p, i, x0, x1, z, j)
    return advance_bouc_wen(law, p, i, x0, x1, z, j, trial, unused)


@njit
def carry_exactly(law, p, i, x0, x1, z, j):
    """Advance the states in `z[j:]` in place from deflection x0 to x1 by a closed form, without summing the work."""
    if law == MASING:
        masing_increment(p, i, x0, x1, z, j)
    elif law == VAIANA_ROSATI:
        z[j] = approach(p, i, x0, x1, z[j])
    elif law == STOP:
        if p[i + LOSS] > 0.0:
            z[j] = loss_state_after(p, i, z[j], 1.0 if x1 > x0 else -1.0, abs(x1 - x0))
    else:  # a tabulated law's state is Bouc-Wen's too
        carry_bouc_wen(p, i, x0, x1, z, j)
