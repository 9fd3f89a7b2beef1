"""Frequencies of large cycles about the deflection at which their mean force carries the weight, not about rest.

A law that is stiffer to one side, or whose hysteretic force held part of the weight at rest, has another mean force in a cycle
than at rest. Under lasting vibration the mount moves to where the mean force is that of rest again, and is stiffer or softer
there.
"""

import math
from dataclasses import dataclass

import numpy as np
import scipy

from wirerope_mj.dynamics.modes.mount import SMALL, closed_cycle, cycle_samples
from wirerope_mj.dynamics.modes.result import Modes
from wirerope_mj.dynamics.single_mass.cycle import is_neutral
from wirerope_mj.engine.system import System
from wirerope_mj.foundation.arrays import Array, Integers
from wirerope_mj.mounts.isolator import travel
from wirerope_mj.mounts.laws import Law, LoopBoucWen

# Least relative difference of the frequencies about rest and about the carrying deflection that is reported.
APART = 0.01


@dataclass(frozen=True, kw_only=True)
class Carried:
    """Frequencies at an amplitude about the deflections at which every mount axis has the mean force of rest."""

    frequencies: Array  # [Hz], (n_modes,); NaN where the mode tips over or no such deflection was found
    shift: Array  # largest distance of such a deflection from rest [m], (n_modes,)
    mounts: tuple[str, ...]  # name of the mount with that distance, (n_modes)
    apart: Integers  # indices of the modes whose frequency is not that about rest


def carried(system: System, modes: Modes) -> Carried:
    """Compute frequencies of modes in cycles about the deflections at which their mean force carries the weight.

    Shapes are unchanged. Each axis is taken alone, with the force that its law has at rest: for one mount of independent axes
    that is exact, else an estimate.
    """
    if modes.amplitude is None:
        raise ValueError("`modes` must be at an amplitude: cycles of small amplitude have the mean force of rest.")
    frequencies, shifts, names = np.empty(modes.frequencies.size), np.empty(modes.frequencies.size), []
    for mode, frequency in enumerate(modes.frequencies):
        shape = modes.shapes[modes.free, mode]
        stiffness, largest, name = 0.0, 0.0, ""
        for mount, load in modes.equilibrium.mounts.items():
            sizes = modes.amplitude * np.abs(modes.mounts[mount][mode])
            isolator, deflections, forces = system.mounts[mount].isolator, load.deflection.copy(), load.force.copy()
            if isinstance(coupled := isolator.coupled, LoopBoucWen):  # the loop's elastic energy is not in the axes' laws
                axes, brackets = list(isolator.coupled_axes), np.array(coupled.brackets or (np.inf, np.inf))
                loop_force = coupled.loop.force(load.deflection[axes] - load.force[axes] / brackets)
                forces[axes] -= loop_force
                deflections[axes] -= loop_force / brackets
            for axis, law in enumerate(isolator.axes.values()):
                if law is None or is_neutral(law) or sizes[axis] < SMALL or not math.isfinite(frequency):
                    continue
                rest, force = float(deflections[axis]), float(forces[axis])
                if law.initial_stiffness == 0.0 and force == 0.0:
                    continue  # an open stop carries no force, and the other mounts determine its deflection
                moved = _carrying_deflection(law, rest, force, float(sizes[axis]), frequency)
                gain = _cycle_stiffness(law, moved, sizes[axis], frequency) - _cycle_stiffness(
                    law, rest, sizes[axis], frequency
                )
                stiffness += modes.mounts[mount][mode, axis] ** 2 * gain
                if abs(moved - rest) > largest:
                    largest, name = abs(moved - rest), mount
        eigenvalue = (2.0 * np.pi * frequency) ** 2 + stiffness / float(shape @ modes.mass @ shape)
        frequencies[mode] = math.sqrt(eigenvalue) / (2.0 * np.pi) if eigenvalue >= 0.0 else math.nan
        shifts[mode] = largest
        names.append(name)
    with np.errstate(invalid="ignore"):
        apart = ~(np.abs(frequencies / modes.frequencies - 1.0) <= APART) & np.isfinite(modes.frequencies)
    return Carried(frequencies=frequencies, shift=shifts, mounts=tuple(names), apart=np.flatnonzero(apart))


def _cycle_stiffness(law: Law, deflection: float, amplitude: float, frequency: float) -> float:
    """Evaluate the stiffness of a closed cycle about a deflection [N/m]; NaN for a deflection of NaN."""
    return closed_cycle(law, deflection, amplitude, frequency=frequency).real if math.isfinite(deflection) else math.nan


def _carrying_deflection(law: Law, rest: float, force: float, amplitude: float, frequency: float) -> float:
    """Find the deflection about which the mean force of a cycle is `force` [m]; NaN if there is none."""

    def excess(deflection: float) -> float:
        return float(cycle_samples(law, deflection, amplitude, frequency)[1].mean()) - force

    at_rest = excess(rest)
    if abs(at_rest) <= 1e-9 * (abs(force) + law.initial_stiffness * amplitude):  # rounding of a sum over a cycle
        return rest
    before, step = rest, -at_rest / law.closed_stiffness
    for _ in range(30):
        beyond = before + step
        at_beyond = excess(beyond)
        if not math.isfinite(at_beyond):
            break
        if at_beyond * at_rest <= 0.0:
            return float(scipy.optimize.brentq(excess, before, beyond, xtol=1e-6 * abs(beyond - rest)))
        before, step = beyond, 1.5 * step
    return math.nan


def deflection_range(modes: Modes, mount: str) -> tuple[Array, Array]:
    """Find the lowest and highest deflections of a mount over all modes, sag included [m], (3,) each."""
    rest, amplitudes = modes.equilibrium.mounts[mount].deflection, (modes.amplitude or 0.0) * abs(modes.mounts[mount])
    largest = amplitudes.max(axis=0, initial=0.0)  # (n_modes, 3) -> (3,)
    return rest - largest, rest + largest


def travel_utilisation(system: System, modes: Modes, mount: str) -> float:
    """Find the largest utilisation of a mount's rated travels in any of the modes, sag included [-]; 0 without a rating."""
    reached = travel.travel_reached(*deflection_range(modes, mount))
    return max(travel.travel_utilisation(reached, system.mounts[mount].isolator.limits.travel.stated).values(), default=0.0)
