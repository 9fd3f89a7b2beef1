"""A frequency response: a branch and sweeps at each level."""

from dataclasses import dataclass, field

from wirerope_mj.dynamics.frequency_response.options import ResponseOptions
from wirerope_mj.dynamics.periodic import Branch
from wirerope_mj.dynamics.sweep import FrequencySweep
from wirerope_mj.engine.system import System
from wirerope_mj.foundation.renamed import Renamed


@dataclass(frozen=True, kw_only=True)
class Level:
    """The response to one level of the base's acceleration.

    Attributes:
        acceleration: amplitude of the base's acceleration [m/s^2].
        branch: periodic motions over frequency; None if the method is "sweep".
        up, down: envelopes of a sweep up and of one down from its final state; None if the method is "continuation".
        branch_seconds, sweep_seconds: their computing times.
    """

    acceleration: float
    branch: Branch | None = None
    up: FrequencySweep | None = None
    down: FrequencySweep | None = None
    branch_seconds: float = 0.0
    sweep_seconds: float = 0.0

    @property
    def sweeps(self) -> dict[str, FrequencySweep]:
        """The sweeps by their direction, "up" and "down"."""
        return {direction: sweep for direction, sweep in (("up", self.up), ("down", self.down)) if sweep is not None}

    def transmissibility(self, amplitude: float) -> float:
        """Return an amplitude [m/s^2] over that of the base's acceleration [-]."""
        return amplitude / self.acceleration

    @property
    def complete(self) -> bool:
        """True if the branch, if there is one, reached the end of the range."""
        return self.branch is None or self.branch.complete


@dataclass(frozen=True, kw_only=True)
class FrequencyResponse:
    """The response of a system to sines of its base over a range of frequencies, at one level or several, lowest first."""

    system: System = field(repr=False)
    name: str
    options: ResponseOptions
    levels: tuple[Level, ...]

    question = Renamed("options")

    @property
    def complete(self) -> bool:
        """True if every branch reached the end of the range."""
        return all(level.complete for level in self.levels)

    @property
    def branches(self) -> tuple[Branch, ...]:
        """Branches of all levels that have one."""
        return tuple(level.branch for level in self.levels if level.branch is not None)
