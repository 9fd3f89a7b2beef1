"""Resonance peaks of a branch, each with its largest harmonic."""

from dataclasses import dataclass

import numpy as np

from wirerope_mj.dynamics.periodic import Branch, harmonic_content, resonances

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
        order: of the largest harmonic of the payload's acceleration other than the fundamental; below 1 for a subharmonic.
        harmonic: its name.
        share: its amplitude over that of the fundamental.
    """

    frequency: float
    amplitude: float
    transmissibility: float
    point: int
    at_edge: bool
    order: float
    harmonic: str
    share: float


def peaks_of(branch: Branch) -> list[ResonancePeak]:
    """Return the peaks of a branch, the highest (or the end of the branch, if that is higher) first, then by frequency."""
    peaks = [(peak.index, peak.frequency, peak.amplitude, False) for peak in resonances(branch)]
    top = branch.peak
    if top not in [index for index, *_ in peaks]:
        at_edge = top in (0, branch.frequency.size - 1)
        peaks.append((top, float(branch.frequency[top]), float(branch.amplitude[top]), at_edge))
    first = max(peaks, key=lambda peak: peak[2])
    others = sorted((peak for peak in peaks if peak is not first), key=lambda peak: peak[1])
    return [_peak(branch, *peak) for peak in (first, *others)]


def _peak(branch: Branch, point: int, frequency: float, amplitude: float, at_edge: bool) -> ResonancePeak:
    content = harmonic_content(
        branch.orbit(point), payload=branch.payload, direction=branch.response_direction, highest=HARMONICS
    )
    others = [i for i, order in enumerate(content.order) if order not in (0, 1)]
    largest = others[int(np.argmax(content.amplitude[others]))]
    return ResonancePeak(
        frequency=frequency,
        amplitude=amplitude,
        transmissibility=amplitude / abs(float(branch.acceleration[point])),
        point=point,
        at_edge=at_edge,
        order=float(content.order[largest]),
        harmonic=content.names[largest],
        share=float(content.amplitude[largest]) / max(content.of(1), 1e-300),
    )
