"""Ranges of the numbers of a motion: far beyond any that equipment undergoes, narrow enough for finite integrals."""

from wirerope_mj.foundation.arguments import finite, nonzero, not_negative, positive

SLOWEST, FASTEST = 1e-6, 1e6  # frequencies [Hz]
SHORTEST, LONGEST = 1e-9, 1e9  # lengths [s]: instants closer than 1e-10 s are one
LATEST = 1e6  # instants [s]: later ones are not told apart to 1e-10 s
# magnitudes of accelerations, velocities, displacements, forces, in SI units, and of factors on them
SMALLEST, LARGEST = 1e-12, 1e12


def frequency(name: str, value: object, *, least: float = SLOWEST) -> float:
    """Check a frequency [Hz]; `least` is 0 where a standstill is allowed."""
    return _within(name, value, least, FASTEST, "Hz")


def sweep_rate(name: str, value: object) -> float:
    """Check the rate of a sweep [octaves/min]."""
    return _within(name, value, SMALLEST, FASTEST, "octaves/min")


def length(name: str, value: object, *, least: float = SHORTEST) -> float:
    """Check the length of a part of a motion [s]; `least` is 0 where the length may be zero."""
    number = finite(name, value)
    if number == 0.0 == least:
        return number
    if number < 0.0 == least:
        raise ValueError(f"`{name}` must be >= 0, got {number!r}.")
    return _within(name, number, SHORTEST, LONGEST, "s")


def start(name: str, value: object) -> float:
    """Check the instant at which a motion begins [s]."""
    return _within(name, value, -LATEST, LATEST, "s")


def level(name: str, value: object) -> float:
    """Check a magnitude of either sign, in SI units."""
    number = nonzero(name, value)
    if not SMALLEST <= abs(number) <= LARGEST:
        raise ValueError(f"`{name}` must be {SMALLEST:g} to {LARGEST:g} in magnitude, got {number!r}.")
    return number


def _within(name: str, value: object, low: float, high: float, unit: str) -> float:
    number = (positive if low > 0.0 else not_negative if low == 0.0 else finite)(name, value)
    if not low <= number <= high:
        raise ValueError(f"`{name}` must be {low:g} to {high:g} {unit}, got {number!r}.")
    return number
