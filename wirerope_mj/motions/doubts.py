"""Questions about the units of a shock whose length or velocity change, or a sine whose speed, is beyond those of tests."""

import math

_LONGEST_SHOCK = 1.0  # [s] beyond which the unit of a pulse is questioned
# change of velocity [m/s] beyond which the unit of a shock is questioned, that of a fall from 5 m: half-sines of standards end
# at 7.5, and those of sleds, which go beyond, last longer than this [s]; below this one [m/s] no mount feels it
_FASTEST, _OF_SLEDS, _SLOWEST = 10.0, 0.05, 0.01
_SHORTEST, _STILL = 1e-4, 1e-3  # length [s] from which a slow shock is a gentle test, unless it is as slow as this [m/s]
_UNITS = "is its peak in another unit, m/s^2 where g is said or mm/s^2 where m/s^2 is?"


# speed [m/s] and peak [m/s^2] of a steady swing that nothing has which shakes equipment: the largest tables for earthquakes
# reach 2 m/s, ships in waves are faster, with a tenth of the peak
_SWUNG, _HARD = 2.2, 5.0


def doubt_of_swing(frequency: float, acceleration: float) -> str:
    """Return a question about the units of a sine by its frequency [Hz] and peak [m/s^2], if nothing swings so; else ""."""
    speed = acceleration / (2.0 * math.pi * frequency)
    if speed <= _SWUNG or acceleration <= _HARD:
        return ""
    return (
        f"at {frequency:.4g} Hz it swings by {1e3 * speed / (2.0 * math.pi * frequency):.3g} mm at {speed:.3g} m/s, as no "
        "shaker, ship or vehicle does: is its frequency or its amplitude in another unit?"
    )


def doubt_of_length(duration: float, question: str) -> str:
    """Return a question about the unit of a shock that lasts longer than a second; "" for a shorter one."""
    return f"it lasts {duration:.4g} s, and shocks are over sooner: {question}" if duration > _LONGEST_SHOCK else ""


def doubt_of_velocity(change: float, duration: float, question: str = _UNITS) -> str:
    """Return a question about the units of a shock whose velocity change [m/s] is larger or smaller than of any test; or ""."""
    if abs(change) > _FASTEST and duration < _OF_SLEDS:
        return f"it changes the base's velocity by {abs(change):.3g} m/s, more than shock tests do: {question}"
    if abs(change) < _STILL or (abs(change) < _SLOWEST and duration < _SHORTEST):
        return (
            f"it changes the base's velocity by {1e3 * abs(change):.2g} mm/s, which no mount feels: is its length in another "
            "unit, s where ms is said, or its peak?"
        )
    return ""
