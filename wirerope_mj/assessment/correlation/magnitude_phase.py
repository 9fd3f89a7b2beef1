"""Size and timing of a computed history against a measured one, apart: measures of Sprague and Geers, and of Russell."""

import math
from dataclasses import dataclass

import numpy as np

from wirerope_mj.foundation.arrays import Array


@dataclass(frozen=True, kw_only=True)
class MagnitudePhase:
    """Errors of a computed history; all are zero where it is the measured one."""

    magnitude: float  # > 0 where the computed history is larger
    phase: float  # 0 to 1; 0.5 for two sines a quarter of a period apart
    comprehensive: float  # of both together


def sprague_geers(measured: Array, computed: Array) -> MagnitudePhase:
    """Compare two histories, (n,), sampled at the same even instants, by energy and by the angle between them.

    M = sqrt(Icc / Imm) - 1, P = arccos(Imc / sqrt(Imm Icc)) / pi, C = sqrt(M^2 + P^2), with I the integrals of the products:
    Sprague and Geers, A spectral-element method for modelling cavitation in transient fluid-structure interaction, Int. J.
    Numerical Methods in Engineering 60 (2004) 2467. A factor on the computed history changes M alone.
    """
    angle, of_measured, of_computed = _products(measured, computed)
    magnitude = math.sqrt(of_computed / of_measured) - 1.0
    return MagnitudePhase(magnitude=magnitude, phase=angle, comprehensive=math.hypot(magnitude, angle))


def russell(measured: Array, computed: Array) -> MagnitudePhase:
    """Compare two histories, (n,), by a magnitude that is as large for twice as for half, and by the angle between them.

    m = (Icc - Imm) / sqrt(Icc Imm), M = sign(m) log10(1 + |m|), P = arccos(Imc / sqrt(Imm Icc)) / pi,
    RC = sqrt(pi / 4 (M^2 + P^2)): Russell, Error measures for comparing transient data, 68th Shock and Vibration Symposium
    (1997) part I; RC up to 0.15 is called excellent there, up to 0.28 acceptable.
    """
    angle, of_measured, of_computed = _products(measured, computed)
    relative = (of_computed - of_measured) / math.sqrt(of_computed * of_measured) if of_computed else -math.inf
    magnitude = math.copysign(math.log10(1.0 + abs(relative)), relative)
    return MagnitudePhase(
        magnitude=magnitude, phase=angle, comprehensive=math.sqrt(0.25 * math.pi) * math.hypot(magnitude, angle)
    )


def _products(measured: Array, computed: Array) -> tuple[float, float, float]:
    """Return the angle between two histories over pi, and the sums of their squares."""
    of_measured, of_computed = float(measured @ measured), float(computed @ computed)
    if of_measured == 0.0:
        raise ValueError("`measured` must not be zero throughout: nothing can be compared with a dead channel.")
    size = math.sqrt(of_measured) * math.sqrt(of_computed)
    cosine = float(measured @ computed) / size if size else 0.0
    return math.acos(float(np.clip(cosine, -1.0, 1.0))) / math.pi, of_measured, of_computed
