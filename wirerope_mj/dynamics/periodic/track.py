"""The track of one copy of a system through complete periods of its base's sine."""

from dataclasses import dataclass

from wirerope_mj.foundation.arrays import Array


@dataclass(frozen=True, kw_only=True)
class Drive:
    """A sine of the base and its steps: frequency [Hz], acceleration [m/s^2], periods and steps in all."""

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
    """One copy's unknowns at its end, (n_x,), and values of the engine at the start of every step.

    sensors are the system's sensor values (n_steps, n_s); qpos, qvel and act the engine's state, (n_steps, n_q|n_v|n_a).
    """

    end: Array
    sensors: Array
    qpos: Array
    qvel: Array
    act: Array
    drive: Drive
