"""Measures of several loops of one isolator: hardening overlap, and where softening turns into hardening."""

import math
from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
import scipy

from wirerope_mj.foundation.arguments import not_negative
from wirerope_mj.mounts.laws import Loop

_BINS = 20  # intervals of the common span in which a gap is averaged before its size counts, so that noise is no gap
_POINTS = 20  # in each of them
_ROUNDING = 1e-12  # of force range times amplitude: below it an area is rounding


def hardening_overlap(loops: Sequence[Loop]) -> float:
    """Measure how far the loading paths of smaller loops lie from that of the largest [-]: 0 if all share one path.

        gap       = sum over i of  integral |F_i,up - F_L,up| dx
        thickness = sum over i of  integral (F_L,up - F_L,down) dx        overlap = gap / thickness

    i runs over the smaller loops, L is the largest; up and down are the branches of rising and falling deflection; the
    integrals run over the tension side that both loops reach, from their operating point to the largest deflection of
    loop i. The gap is measured against the largest loop's thickness, not its force, because loops on a stiff elastic path
    lie close to each other whatever their hysteresis does. So 0 says that in tension a loop of any amplitude loads along
    one path, and 0.5 that the smaller loops run in the middle of the largest, as thin loops about a common elastic line do.

    Ni, Ko, Wong and Zhan (1999) named it after isolators that harden in tension (thesis, section 3.2.1 and figure 3.9). A
    loop that saturates without hardening loads along one path too: look at `softening_to_hardening` or at the loops for the
    hardening itself. Loops far smaller than the yield deflection never saturate and count towards 0.5; the integrals give
    them the weight of their own deflection. Loops of nearly one amplitude overlap whatever their law: compare values of the
    same ratios of amplitude only. Each gap is averaged over twentieths of the span before its size counts, so that the noise
    of a measurement adds little. ValueError: fewer than two amplitudes, loops that do not share a side in tension, or a
    largest loop without an area.
    """
    amplitudes = {loop.amplitude for loop in loops}
    if len(amplitudes) < 2:
        raise ValueError(f"`loops` must hold at least 2 different amplitudes, got {len(amplitudes)}.")
    *smaller, largest = sorted(loops, key=lambda loop: loop.amplitude)
    gap = thickness = 0.0
    for loop in smaller:
        start = max(loop.operating_point, largest.operating_point)
        stop = float(min(loop.deflection.max(), largest.deflection.max()))
        if stop <= start:
            raise ValueError(
                f"`loops` must have one operating point, got {loop.operating_point:.6g} m and "
                f"{largest.operating_point:.6g} m, which share no deflection in tension."
            )
        x = np.linspace(start, stop, _BINS * _POINTS)
        up = _force_on(largest, x, rising=True)
        bins = (_force_on(loop, x, rising=True) - up).reshape(_BINS, _POINTS).mean(axis=1)
        gap += float(np.abs(bins).mean()) * (stop - start)
        thickness += float((up - _force_on(largest, x, rising=False)).mean()) * (stop - start)
    if thickness <= _ROUNDING * float(np.ptp(largest.force)) * largest.amplitude:
        raise ValueError("`loops`: the largest has no area in tension, so that there is nothing to measure a gap against.")
    return gap / thickness


def _force_on(loop: Loop, deflection: np.ndarray, *, rising: bool) -> np.ndarray:
    """Interpolate the force of a branch at given deflections [N]; samples that noise has put out of order are sorted."""
    x, force = loop.branch(rising=rising)
    order = np.argsort(x)
    return np.interp(deflection, x[order], force[order])


@dataclass(frozen=True, kw_only=True)
class Transition:
    """Amplitude of the least secant stiffness: an isolator softens up to there and hardens beyond."""

    exists: bool  # whether such an amplitude lies between those that were tested
    amplitude: float  # of the least secant stiffness [m]; NaN if there is none
    stiffness: float  # the least secant stiffness [N/m]; NaN if there is none
    message: str  # the transition, or what the tested amplitudes show instead


def softening_to_hardening(loops: Sequence[Loop], *, rise: float = 1e-6) -> Transition:
    """Find the amplitude at which the secant stiffness K(A) has its minimum: softening ends, hardening begins.

    K(A) = [F(x_max) - F(x_min)] / 2A of each loop is joined by a cubic spline over log A, and its least value looked for on
    both sides of the smallest tested K, which K must exceed by the fraction `rise` at some smaller and some larger amplitude:
    for measured loops the scatter of their stiffnesses. Source: the soft-hardening of thesis section 3.2.1 and figure 3.8.
    ValueError: fewer than three different amplitudes, or `rise` is negative.
    """
    not_negative("rise", rise)
    stiffness_at = {loop.amplitude: loop.secant_stiffness for loop in loops}
    amplitude = np.array(sorted(stiffness_at))
    if amplitude.size < 3:
        raise ValueError(f"`loops` must hold at least 3 different amplitudes, got {amplitude.size}.")
    stiffness = np.array([stiffness_at[size] for size in amplitude])
    least = int(np.argmin(stiffness))
    enough = stiffness[least] + rise * abs(stiffness[least])
    falls, rises = bool((stiffness[:least] > enough).any()), bool((stiffness[least + 1 :] > enough).any())
    first, last = f"{1e3 * amplitude[0]:.4g} mm", f"{1e3 * amplitude[-1]:.4g} mm"
    if falls and rises:
        spline = scipy.interpolate.CubicSpline(np.log(amplitude), stiffness)
        low, high = math.log(amplitude[least - 1]), math.log(amplitude[least + 1])
        turns = spline.derivative().roots(extrapolate=False)
        candidates = np.array([low, high, *turns[(turns > low) & (turns < high)]])
        log_amplitude = float(candidates[np.argmin(spline(candidates))])
        size, value = math.exp(log_amplitude), float(spline(log_amplitude))
        message = f"softens up to an amplitude of {1e3 * size:.4g} mm (secant stiffness {value / 1e3:.4g} kN/m), hardens beyond"
        return Transition(exists=True, amplitude=size, stiffness=value, message=message)
    if falls:
        message = f"softens over all amplitudes tested, {first} to {last}: a transition, if there is one, lies above"
    elif rises:
        message = f"hardens over all amplitudes tested, {first} to {last}: a transition, if there is one, lies below"
    else:
        message = f"neither softens nor hardens between {first} and {last}"
    return Transition(exists=False, amplitude=math.nan, stiffness=math.nan, message=message)
