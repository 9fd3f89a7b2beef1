"""The figures of the thesis' third chapter, each with the numbers that its caption states."""

from figures import five_types, modified, parameters, resonance, ringing, soft_hardening, superharmonic
from figures.figure import Figure


def all_figures() -> list[Figure]:
    """Return every figure of the gallery in the thesis' order."""
    rooms = (five_types, parameters, soft_hardening, resonance, ringing, modified, superharmonic)
    return sorted((figure for room in rooms for figure in room.figures()), key=lambda figure: figure.place)
