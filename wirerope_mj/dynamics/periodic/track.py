"""One copy of a system on its way through whole periods of its base's sine."""

from dataclasses import dataclass

from wirerope_mj.foundation.arrays import Array


@dataclass(frozen=True, kw_only=True)
class Drive:
    """A sine of the base and how it is cut into steps: frequency [Hz], acceleration [m/s^2], periods and steps in all."""

    frequency: float
    acceleration: float
    periods: int
    steps: int

    @property
    def duration(self) -> float:
        """Length [s]."""
        return self.periods / self.frequency


@dataclass(frozen=True, kw_only=True)
class Track:
    """One copy's way: the unknowns at its end (n_x,), and at the start of every step what the engine says.

    sensors are the system's sensor values (n_steps, n_s); qpos, qvel and act the engine's state, (n_steps, n_q|n_v|n_a).
    """

    end: Array
    sensors: Array
    qpos: Array
    qvel: Array
    act: Array
    drive: Drive
