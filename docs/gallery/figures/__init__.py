"""The figures of the thesis' third chapter, each with the numbers that its caption states."""

from figures import five_types, modified, parameters, soft_hardening
from figures.figure import Figure


def all_figures() -> list[Figure]:
    """Return every figure of the gallery in the thesis' order."""
    found = [*five_types.figures(), *parameters.figures(), *soft_hardening.figures(), *modified.figures()]
    return sorted(found, key=lambda figure: figure.place)
