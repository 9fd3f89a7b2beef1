"""Response of a simulation: time histories of bodies, points and mounts, and their peaks."""

import math
from collections.abc import Iterator, Mapping
from dataclasses import dataclass
from functools import cached_property
from pathlib import Path
from typing import Any, Protocol

import numpy as np

from wirerope_mj.engine.response.peaks import Peaks
from wirerope_mj.engine.response.scene import Scene
from wirerope_mj.foundation.arrays import Array
from wirerope_mj.foundation.state import State
from wirerope_mj.foundation.summary import Summarised, quantity

BLOCK_ROWS = 1 << 16
"""Rows of samples that are handed on at once where a long response must not stand in memory as a whole."""


class SampleColumns(Protocol):
    """Sampled columns, in memory or in a file."""

    @property
    def names(self) -> list[str]:
        """Names of the columns."""
        ...

    def columns(self, first: int, last: int) -> Array:
        """Return columns `first` to `last` (exclusive), (n_t, last - first)."""
        ...

    def blocks(self, first: int, last: int) -> Iterator[Array]:
        """Yield these columns some rows after the other, at most `BLOCK_ROWS` of them at once."""
        ...


@dataclass(frozen=True)
class MemorySamples:
    """Samples in memory: `values` (n_t, n_columns)."""

    names: list[str]
    values: Array

    def columns(self, first: int, last: int) -> Array:
        """Return columns `first` to `last` (exclusive)."""
        return self.values[:, first:last]

    def blocks(self, first: int, last: int) -> Iterator[Array]:
        """Yield these columns some rows after the other."""
        for row in range(0, self.values.shape[0], BLOCK_ROWS):
            yield self.values[row : row + BLOCK_ROWS, first:last]


@dataclass(frozen=True)
class _Columns:
    samples: SampleColumns
    first: int

    def _part(self, offset: int, size: int) -> Array:
        return self.samples.columns(self.first + offset, self.first + offset + size)


def _columns(offset: int, size: int, text: str) -> "cached_property[Array]":
    """Return a property of `size` of a part's columns from `offset` on; `text` is its docstring."""
    values = cached_property(lambda part: part._part(offset, size))
    values.__doc__ = text
    return values


class BodyResponse(_Columns):
    """Motion of a body at its own centre of mass, world frame."""

    position = _columns(0, 3, "Position [m], (n_t, 3).")
    orientation = _columns(3, 4, "Orientation, quaternion w first, (n_t, 4).")
    velocity = _columns(7, 3, "Velocity [m/s], (n_t, 3).")
    angular_velocity = _columns(10, 3, "Angular velocity [rad/s], (n_t, 3).")
    acceleration = _columns(13, 3, "Coordinate acceleration, 0 at rest under gravity [m/s^2], (n_t, 3).")
    angular_acceleration = _columns(16, 3, "Angular acceleration [rad/s^2], (n_t, 3).")


class PointResponse(BodyResponse):
    """Motion of a site, world frame."""

    relative_displacement = _columns(
        19, 3, "Displacement from the modelled geometry relative to the base [m], (n_t, 3)."
    )


@dataclass(frozen=True)
class MountResponse(_Columns):
    """Deflection, force and internal states of a mount in its axes roll, shear, axial."""

    hysteretic: list[list[int]]  # indices of the hysteretic forces of roll, shear, axial among the states
    state_names: tuple[str, ...]

    deflection = _columns(0, 3, "Payload site minus base site, axial positive in tension [m], (n_t, 3).")
    force = _columns(3, 3, "Restoring force, positive in tension [N], (n_t, 3).")

    @cached_property
    def hysteretic_state(self) -> Array:
        """Hysteretic state z [N], (n_t, 3): the sum of an axis' hysteretic forces, zero for an axis without one."""
        states = self._part(6, len(self.state_names))
        return np.stack([states[:, indices].sum(axis=1) for indices in self.hysteretic], axis=1)

    @cached_property
    def internal_states(self) -> dict[str, Array]:
        """Every internal state by name ("axial.z"), (n_t,)."""
        states = self._part(6, len(self.state_names))
        return {name: states[:, i] for i, name in enumerate(self.state_names)}


@dataclass(frozen=True, kw_only=True)
class BaseResponse:
    """Motion of the base, from the closed form that drove it; right-hand limits at jumps.

    displacement [m], velocity [m/s], acceleration [m/s^2], world frame, (n_t, 3) each.
    """

    displacement: Array
    velocity: Array
    acceleration: Array


@dataclass(frozen=True, kw_only=True)
class Numerics:
    """Numerical settings with which a response was computed.

    Attributes:
        timestep: largest step [s].
        accuracy: error asked for, relative to the peaks; NaN where the step was given.
        error_estimate: error of samples and peaks estimated by step halving before the run; NaN where the step was given.
        steps: number of steps.
        callback: "native" or "python".
        versions: of the packages that computed it.
        limited_by: what keeps the step from being longer; "" for older responses, which do not say it.
    """

    timestep: float
    accuracy: float
    error_estimate: float
    steps: int
    callback: str
    versions: dict[str, str]
    limited_by: str = ""


@dataclass(frozen=True, kw_only=True, repr=False)
class Response(Summarised):
    """Response of a system to a base motion.

    Attributes:
        time: sample instants [s], (n_t,).
        base: motion of the base.
        bodies: motion of every moving body by name.
        points: motion of every site `point/NAME` by NAME.
        mounts: every mount by name.
        peaks: peaks over every step, not only over the samples.
        scene: what can be drawn.
        motion: the base motion as plain values, as `BaseMotion.to_dict` wrote it.
        events: instants [s] and descriptions of what the motion does.
        numerics: how it was computed.
        initial_state, final_state: states from which a simulation may start again.
        path: the Parquet file that holds the samples, None if they are in memory.
    """

    time: Array
    base: BaseResponse
    bodies: Mapping[str, BodyResponse]
    points: Mapping[str, PointResponse]
    mounts: Mapping[str, MountResponse]
    peaks: Peaks
    scene: Scene
    motion: dict[str, Any]
    events: tuple[tuple[float, str], ...]
    numerics: Numerics
    initial_state: State
    final_state: State
    samples: SampleColumns
    path: Path | None = None

    def _summary(self) -> tuple[str, dict[str, str]]:
        peaks, last = self.peaks, float(self.time[-1])
        heading = (
            f"Response: {last:.4g} s in {self.time.size} samples, {len(self.bodies)} bodies, {len(self.mounts)} mounts"
        )
        lines = {
            name: f"peak {quantity(body.acceleration.value, 'm/s^2')} at {body.acceleration.time:.4f} s"
            for name, body in peaks.bodies.items()
        }
        if peaks.mounts:
            farthest = max(peaks.mounts, key=lambda name: peaks.mounts[name].deflection.value)
            strongest = max(peaks.mounts, key=lambda name: peaks.mounts[name].force.value)
            lines[f"largest deflection, {farthest}"] = quantity(peaks.mounts[farthest].deflection.value, "m")
            lines[f"largest force, {strongest}"] = quantity(peaks.mounts[strongest].force.value, "N")
        if peaks.struck:
            lines["struck"] = ", ".join(peaks.struck)
        known = math.isfinite(self.estimated_error)
        error = f"estimated error {self.estimated_error:.1e} of the peaks" if known else "given, no error estimated"
        lines["step"] = f"{1e6 * self.timestep:.4g} us, {error}"
        return heading, lines

    @property
    def timestep(self) -> float:
        """Largest step of the simulation [s]."""
        return self.numerics.timestep

    @property
    def estimated_error(self) -> float:
        """Error of samples and peaks relative to the peaks, estimated before the run; NaN where the step was given."""
        return self.numerics.error_estimate

    def save(self, folder: str | Path) -> None:
        """Write `response.parquet` into `folder` (made if missing), whole or not at all; one that is there is replaced."""
        from wirerope_mj.engine.response.storage import save_response

        save_response(self, Path(folder))
