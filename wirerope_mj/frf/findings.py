"""What a branch shows: resonances and what they are made of."""

import math
from dataclasses import dataclass

import numpy as np
from scipy.signal import find_peaks

from wirerope_mj.excitation.checks import unit_vector
from wirerope_mj.frf.curve import Curve
from wirerope_mj.periodic import Branch

PROMINENCE = 0.02
"""Share by which a peak must stand out from its surroundings: less is the noise of the branch's points."""

HARMONICS = 9
"""Highest harmonic that is looked for in a motion."""


@dataclass(frozen=True, kw_only=True)
class ResonancePeak:
    """A peak of the amplitude over frequency.

    Attributes:
        frequency: [Hz].
        amplitude: [m/s^2].
        transmissibility: amplitude over the base's acceleration.
        point: nearest point of the branch.
        at_edge: whether it is no peak but the end of the branch.
        harmonic: number of the largest harmonic of the payload's acceleration above the first.
        share: of that harmonic, relative to the first.
    """

    frequency: float
    amplitude: float
    transmissibility: float
    point: int
    at_edge: bool
    harmonic: int
    share: float


def peaks_of(branch: Branch, curve: Curve) -> list[ResonancePeak]:
    """Return the peaks of a branch, the highest (or the end of the branch, if that is higher) first, then by frequency."""
    level = np.log(curve.amplitude)
    found, _ = find_peaks(level, prominence=math.log1p(PROMINENCE))
    top = int(np.argmax(level))
    others = sorted((int(i) for i in found if i != top), key=lambda i: curve.frequency[i])
    return [_peak(branch, curve, place) for place in (top, *others)]


def _peak(branch: Branch, curve: Curve, place: int) -> ResonancePeak:
    point = round(float(curve.point[place]))
    harmonic, share = largest_harmonic(branch, point)
    amplitude = float(curve.amplitude[place])
    return ResonancePeak(
        frequency=float(curve.frequency[place]),
        amplitude=amplitude,
        transmissibility=amplitude / abs(float(branch.acceleration[point])),
        point=point,
        at_edge=place in (0, curve.amplitude.size - 1),
        harmonic=harmonic,
        share=share,
    )


def largest_harmonic(branch: Branch, point: int) -> tuple[int, float]:
    """Return number and share of the largest harmonic above the first in the payload's acceleration."""
    response = branch.orbit(point).response
    series = response.bodies[branch.payload].acceleration[:-1] @ unit_vector(branch.response_direction)
    content = np.abs(np.fft.rfft(series))[branch.periods :: branch.periods][:HARMONICS]
    if content.size < 2 or content[0] == 0.0:
        return 1, 0.0
    number = int(np.argmax(content[1:])) + 1
    return number + 1, float(content[number] / content[0])
