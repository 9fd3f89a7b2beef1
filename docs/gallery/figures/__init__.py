"""The figures of the thesis' third chapter and those of shock, each with the numbers that its caption states."""

from figures import (
    five_types,
    isolation_limits,
    modified,
    parameters,
    resonance,
    ringing,
    shock_frame,
    soft_hardening,
    superharmonic,
)
from figures.figure import Figure


def all_figures() -> list[Figure]:
    """Return every figure of the gallery in the thesis' order, and then those of shock."""
    thesis = (five_types, parameters, soft_hardening, resonance, ringing, modified, superharmonic)
    rooms = (*thesis, isolation_limits, shock_frame)
    return sorted((figure for room in rooms for figure in room.figures()), key=lambda figure: figure.place)
