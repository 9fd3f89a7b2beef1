"""Forces and moments on the payload: their base class, a harmonic force, a blow, and a table."""

import math
from abc import abstractmethod
from collections.abc import Callable, Sequence
from dataclasses import dataclass, field
from functools import cached_property, partial
from pathlib import Path
from typing import ClassVar

import numpy as np

from wirerope_mj.foundation.arguments import as_times, finite
from wirerope_mj.foundation.arrays import Array, ArrayLike, Entries
from wirerope_mj.foundation.directions import Direction, checked_direction, direction_text, unit_vector
from wirerope_mj.foundation.quantities import Phrase
from wirerope_mj.motions import ranges
from wirerope_mj.motions.motion import BaseMotion, Said
from wirerope_mj.motions.phrases import SpokenMotion, file_first, made_of, site_first
from wirerope_mj.motions.psd_lines import ForceRows, force_rows

MOST_ROWS = 20_000  # rows of a table of forces, which is stored with its run as text: two megabytes


class PayloadForce(BaseMotion):
    """Force and moment on the payload, along the axes of a site and turning with it; the base stands still.

    It adds to base motions and other forces with `+`. The model names where it acts: a site `force/NAME` on what the mounts
    carry.
    """

    site: str  #: the site's name, what follows `force/`
    start: float
    duration: float

    @property
    def end(self) -> float:
        """Instant after which the force is over [s]."""
        return self.start + self.duration

    @property
    def loaded_sites(self) -> tuple[str, ...]:
        return (self.site,)

    def load(self, site: str, time: ArrayLike) -> Array:
        """Return force [N] and moment [N m] at a site at the times [s], (n_t, 6); zero elsewhere, and before and after."""
        times = as_times(time)
        wrench = np.zeros((times.size, 6))
        acting = (times >= self.start) & (times <= self.end)
        if site == self.site and acting.any():
            wrench[acting] = self._wrench(times[acting] - self.start)
        return wrench

    @abstractmethod
    def _wrench(self, t: Array) -> Array:
        """Return force and moment at times since the start [s], (n_t, 6)."""

    @cached_property
    def _said(self) -> Said:
        ends = ((self.end, f"{self.kind} ends"),) if math.isfinite(self.end) else ()
        text, shortest_time = self._described()
        return Said(text, ((self.start, f"{self.kind} at {self.site} begins"), *ends), shortest_time=shortest_time)

    @abstractmethod
    def _described(self) -> tuple[str, float]:
        """Return the description of the force and its shortest time scale [s]."""

    @property
    def directions(self) -> Array:
        """No direction, (0, 3): the base stands still."""
        return np.zeros((0, 3))

    def _derivative(self, t: Array, order: int) -> Array:
        return np.zeros((t.size, 3))

    def _check(self) -> None:
        """Check the name of the site and the start; ValueError."""
        if not isinstance(self.site, str) or not self.site:
            raise ValueError(f"`site` must be the name of a site, got {self.site!r}.")
        object.__setattr__(self, "start", ranges.start("start", self.start))


def _harmonic(
    quantity: str, shape: Callable[..., BaseMotion], phrase: Phrase, direction: Direction, _: int, site: str
) -> BaseMotion:
    """Make a harmonic force or moment on the payload from a phrase; `quantity`: "force" or "moment"."""
    values: Entries = {quantity: (phrase.one(quantity) * unit_vector(direction)).tolist(), "duration": phrase.one("time")}
    return shape(site=site, start=phrase.start, frequency=phrase.one("frequency"), **values)


def _site_and_table(text: str, folder: Path) -> tuple[tuple[str, ForceRows], str]:
    """Split a phrase into site, table of forces, and the rest of the phrase."""
    site, rest = site_first(text, folder)
    rows, rest = file_first(force_rows)(rest, folder)
    return (site, rows), rest


@dataclass(frozen=True, kw_only=True)
class HarmonicForce(PayloadForce):
    """Harmonic force and moment, (force, moment) sin(2 pi f t + phase)."""

    kind: ClassVar[str] = "harmonic-force"
    phrases = (
        SpokenMotion(
            name="force", option="payload-force", example="engine 500 N 12 Hz 10 s z", make=partial(_harmonic, "force"),
            summary="harmonic force on the payload: site, amplitude, frequency, length, direction.",
            needs={"force": 1, "frequency": 1, "time": 1}, begins=site_first,
        ),
        SpokenMotion(
            name="moment", example="engine 80 N.m 12 Hz 10 s y", make=partial(_harmonic, "moment"),
            summary="harmonic moment on the payload: site, amplitude, frequency, length, axis.",
            needs={"moment": 1, "frequency": 1, "time": 1}, begins=site_first,
        ),
    )  # fmt: skip

    site: str
    frequency: float  #: frequency f [Hz]
    force: Sequence[float] = (0.0, 0.0, 0.0)  #: amplitude of the force along the site's axes [N], (3,)
    moment: Sequence[float] = (0.0, 0.0, 0.0)  #: amplitude of the moment about the site's axes [N m], (3,)
    phase: float = 0.0  #: phase at the start [rad]
    start: float = 0.0  #: instant at which it begins [s]
    duration: float = math.inf  #: length [s]; endless by default

    def __post_init__(self) -> None:
        self._check()
        self._set(frequency=ranges.frequency("frequency", self.frequency), phase=finite("phase", self.phase))
        if self.duration != math.inf:
            object.__setattr__(self, "duration", ranges.length("duration", self.duration))
        for name, given in (("force", self.force), ("moment", self.moment)):
            try:
                x, y, z = (finite(name, value) for value in given)
            except (TypeError, ValueError):
                raise ValueError(f"`{name}` must be three finite numbers, got {given!r}.") from None
            object.__setattr__(self, name, (x, y, z))
        if not any((*self.force, *self.moment)):
            raise ValueError("`force` or `moment` must not be zero.")

    def _wrench(self, t: Array) -> Array:
        wave = np.sin(2.0 * math.pi * self.frequency * t + self.phase)
        return np.asarray(wave[:, np.newaxis] * np.array([*self.force, *self.moment]))

    def _described(self) -> tuple[str, float]:
        """Describe the force in a line, such as `force (0, 0, 500) N at engine, 12 Hz`."""
        parts = []
        if any(self.force):
            parts.append(f"force ({', '.join(f'{part:.4g}' for part in self.force)}) N")
        if any(self.moment):
            parts.append(f"moment ({', '.join(f'{part:.4g}' for part in self.moment)}) N m")
        return f"{' and '.join(parts)} at {self.site}, {self.frequency:.4g} Hz", 1.0 / self.frequency


@dataclass(frozen=True, kw_only=True)
class Blow(PayloadForce):
    """Blow on the payload, as of a hammer: a half-sine of the impulse J, pi J / (2 D) sin(pi t / D)."""

    kind: ClassVar[str] = "blow"
    phrases = (
        SpokenMotion(
            name="hammer", example="anvil 9.8 kN.s 1 ms z", needs={"impulse": 1, "time": 1}, begins=site_first,
            summary="a blow on the payload: site, impulse, length, direction.",
            make=made_of(impulse="impulse", duration="time"),
        ),
    )  # fmt: skip

    site: str
    impulse: float  #: impulse J [N s]; negative for a blow against the direction
    duration: float  #: length D [s]
    direction: Direction  #: along the site's axes: `"x"`, `"y"`, `"z"` or a 3-vector
    start: float = 0.0  #: instant at which it begins [s]

    def __post_init__(self) -> None:
        self._check()
        self._set(impulse=ranges.level("impulse", self.impulse), duration=ranges.length("duration", self.duration))
        self._set(direction=checked_direction(self.direction))

    def _wrench(self, t: Array) -> Array:
        force = math.pi * self.impulse / (2.0 * self.duration) * np.sin(math.pi * t / self.duration)
        return np.asarray(force[:, np.newaxis] * np.array([*unit_vector(self.direction), 0.0, 0.0, 0.0]))

    def _described(self) -> tuple[str, float]:
        """Describe the blow in a line, such as `blow of 9800 N s in 1 ms at anvil along z`."""
        along = direction_text(self.direction)
        return f"blow of {self.impulse:.4g} N s in {1e3 * self.duration:.4g} ms at {self.site} along {along}", self.duration


@dataclass(frozen=True, kw_only=True)
class ForceTable(PayloadForce):
    """Force and moment given at instants, straight between them; zero before the first and after the last."""

    kind: ClassVar[str] = "force-table"
    phrases = (
        SpokenMotion(
            name="force-table", example="engine start.csv at 1 s", needs={}, begins=_site_and_table, directed=False,
            summary='forces and moments on the payload of a file with "time [s], fz [N], mx [N.m]" and the like.',
            make=lambda shape, phrase, _, __, site_and_rows: shape(
                site=site_and_rows[0], times=site_and_rows[1][0], loads=site_and_rows[1][1], start=phrase.start
            ),
        ),
    )  # fmt: skip

    site: str
    times: Sequence[float] = field(repr=False)  #: instants since the start [s], increasing, (n,)
    loads: Sequence[Sequence[float]] = field(repr=False)  #: force [N] and moment [N m] at them, (n, 6)
    start: float = 0.0  #: instant from which the times count [s]
    duration: float = field(init=False)

    def __post_init__(self) -> None:
        self._check()
        times, loads = np.asarray(self.times, dtype=float), np.asarray(self.loads, dtype=float)
        if times.ndim != 1 or times.size < 2 or loads.shape != (times.size, 6):
            raise ValueError(f"`times` (n,) and `loads` (n, 6) must fit, n >= 2, got {times.shape} and {loads.shape}.")
        if times.size > MOST_ROWS:
            raise ValueError(f"a table of forces may have {MOST_ROWS} rows, got {times.size}; leave out what repeats.")
        if not (np.isfinite(times).all() and np.isfinite(loads).all()):
            raise ValueError("`times` and `loads` must be finite.")
        if times[0] < 0.0 or (np.diff(times) <= 0.0).any():
            raise ValueError("`times` must increase from 0 on.")
        rows = tuple(tuple(row) for row in loads.tolist())
        self._set(times=tuple(times.tolist()), loads=rows, duration=float(times[-1]))

    def _wrench(self, t: Array) -> Array:
        table = np.array(self.loads)
        return np.stack([np.interp(t, self.times, column, left=0.0) for column in table.T], axis=1)

    @property
    def corners(self) -> Array:
        return self.start + np.array(self.times)

    def _described(self) -> tuple[str, float]:
        """Describe the table in a line, such as `force table at engine, 120 rows, up to 4.3 kN`; its time scale is infinite."""
        largest = float(np.abs(np.array(self.loads)[:, :3]).max())
        return f"force table at {self.site}, {len(self.times)} rows, up to {largest / 1e3:.4g} kN", math.inf
