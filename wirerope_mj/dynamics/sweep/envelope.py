"""Envelopes of accelerations and deflections over frequency: the result of a sweep, its file and its collector."""

import json
import math
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field
from pathlib import Path
from typing import Self

import numpy as np

from wirerope_mj.engine.system import System
from wirerope_mj.foundation.arrays import Array, Booleans, Entries, Integers
from wirerope_mj.foundation.atomic_files import atomic_file
from wirerope_mj.foundation.directions import Direction, direction_text, unit_vector
from wirerope_mj.foundation.errors import RecordError, SimulationError
from wirerope_mj.foundation.parquet_files import TableWriter, read_content, read_table, write_rows
from wirerope_mj.foundation.state import State
from wirerope_mj.foundation.summary import Summarised, quantity, span
from wirerope_mj.motions import Sweep, motion_from_dict
from wirerope_mj.mounts.isolator import AXES as MOUNT_AXES
from wirerope_mj.mounts.isolator.travel import RATINGS, travel_reached
from wirerope_mj.mounts.laws.law import ROUNDING

RAN_AWAY = 10.0  # deflection over a law's finite travel from which it is an overflow beyond the law's validity


@dataclass(frozen=True, kw_only=True)
class Channels:
    """Indices (channels) of the vectors whose peaks are tracked: accelerations of base and bodies, deflections of mounts."""

    base: int  # channel of the driven base's acceleration
    names: tuple[str, ...]  # names of the bodies that move and are not fixed to the base, payloads first
    bodies: Integers  # channels of these bodies' accelerations, (n_bodies,)
    mounts: Integers  # channels of the mounts' deflections, (n_mounts,)

    @classmethod
    def of(cls, system: System) -> "Channels":
        assembly = system.assembly
        body_names = assembly.subjects.body_names
        fixed = {body_names[channel] for channel in assembly.tables.base_channels if channel < len(body_names)}
        names = (*system.payloads, *(name for name in body_names if name not in fixed and name not in system.payloads))
        n_channels = assembly.tables.channels.size
        bodies = np.array([body_names.index(name) for name in names], dtype=np.int64)
        mounts = np.arange(n_channels - 2 * len(system.mounts), n_channels, 2)  # deflection and force of each mount
        return cls(base=body_names.index(system.base), names=names, bodies=bodies, mounts=mounts)


def require_lawful(system: System, frequency: Array, minimum: Array, maximum: Array) -> None:
    """Raise SimulationError at the first cycle in which a mount went beyond the finite travel of its law.

    The cycles are given by frequencies [Hz], (n,), and extreme deflections [m], (n, n_mounts, 3).
    """
    axes = [mount.isolator.axes.values() for mount in system.mounts.values()]
    ends = [[(math.inf, math.inf) if law is None else law.travel_ends for law in laws] for laws in axes]
    reached = np.stack([-minimum, maximum], axis=-1)
    beyond = reached > np.array(ends).reshape(-1, 3, 2) + ROUNDING
    if not beyond.any():
        return
    row, number, index, side = np.argwhere(beyond)[0]
    name, mount = list(system.mounts.items())[number]
    axis, law = list(mount.isolator.axes.items())[index]
    assert law is not None  # an axis without a law has infinite travel
    far, end = reached[row, number, index, side], law.travel_ends[side]
    went = f"reached {far:.4g} m" if far < RAN_AWAY * end else "ran away"
    raise SimulationError(
        f"at {frequency[row]:.5g} Hz mount {name!r} {went} on its {axis} axis, whose law holds up to {end:.4g} m, where "
        f"{law.travel_rule}. Shake more gently, or use an isolator with more travel."
    )


class TravelWatch:
    """The farthest travel of every mount during a sweep, and its frequency."""

    def __init__(self, system: System) -> None:
        self._rated = {name: mount.isolator.limits.travel.stated for name, mount in system.mounts.items()}
        self._largest = np.full((len(system.mounts), len(RATINGS)), -math.inf)
        self._at = np.zeros(self._largest.shape)

    def add(self, frequency: Array, minimum: Array, maximum: Array) -> None:
        """Update the largest travels by extreme deflections [m], (n, n_mounts, 3), at frequencies [Hz], (n,)."""
        reached = np.stack(list(travel_reached(minimum, maximum).values()), axis=-1)
        row = np.argmax(reached, axis=0)
        largest = np.take_along_axis(reached, row[np.newaxis], axis=0)[0]
        grown = largest > self._largest
        self._largest, self._at = np.where(grown, largest, self._largest), np.where(grown, frequency[row], self._at)

    def warnings(self) -> tuple[str, ...]:
        """Describe every rated travel that was exceeded, with the largest travel and its frequency."""
        return tuple(
            f"mount {name!r} goes {largest:.4g} m in {rating} at {frequency:.5g} Hz, beyond its rated {rated[rating]:.4g} m."
            for (name, rated), row, at in zip(self._rated.items(), self._largest, self._at, strict=True)
            for rating, largest, frequency in zip(RATINGS, row, at, strict=True)
            if largest > rated.get(rating, math.inf)
        )


AXES = ("x", "y", "z")
FILE, SUMMARY = "frequency_sweep.parquet", "frequency_sweep.json"
FORMAT = 1
_KIND = "a table that `FrequencySweep.save` wrote"
_REMEDY = "Copy it again, or compute the sweep again."
_FIRST = ("frequency", "base_amplitude", "cycles", "remaining", "settled")
_PLAIN = ("payload", "response_direction", "excitation", "timestep", "estimated_error", "model_steps")
STREAM_ROWS = 4096  # rows that are kept before a block is written to disk


@dataclass(frozen=True, kw_only=True)
class BodyEnvelope:
    """Largest acceleration of a body's centre of mass over frequency."""

    acceleration: Array  # largest absolute acceleration along x, y and z [m/s^2], (n, 3)
    transmissibility: Array  # that over the base's amplitude in the same cycle, (n, 3)


@dataclass(frozen=True, kw_only=True)
class MountEnvelope:
    """Extreme deflections of a mount over frequency, along roll, shear and axial [m], (n, 3); static sag included."""

    minimum: Array
    maximum: Array


@dataclass(frozen=True, kw_only=True, repr=False)
class FrequencySweep(Summarised):
    """Envelopes over frequency of a system shaken by a sweep, cycle by cycle, or by one steady sine after another."""

    frequency: Array  #: of the excitation [Hz], (n,): in the middle of every cycle of a sweep, or of every steady sine
    base_amplitude: Array  #: largest absolute acceleration of the base along the excitation's direction [m/s^2], (n,)
    payload: str  #: body whose motion `amplitude` and `transmissibility` are
    response_direction: str  #: axis along which they are taken, "x", "y" or "z"
    envelopes: Mapping[str, BodyEnvelope]  #: of every body that moves relative to the base, by name, payloads first
    mounts: Mapping[str, MountEnvelope]  #: of every mount, by name
    cycles: Array  #: cycles of the excitation behind every frequency, (n,); 1 each for a sweep
    #: estimated distance of the amplitudes from their limits in a steady sine, relative to them, (n,); NaN for a sweep, which
    #: does not wait
    remaining: Array
    settled: Booleans  #: whether that distance was within the tolerance, (n,); False for a sweep
    excitation: Entries  #: the excitation as plain values
    timestep: float  #: largest step [s]
    #: error of samples and peaks, estimated before the run relative to the peaks; NaN where the step was given
    estimated_error: float
    #: steps of the simulation, a lead-in included, without the pilots that chose the step
    model_steps: int
    #: state in which the first cycle began, after the lead-in of a sweep; `simulate` computes the whole history from it:
    #: `simulate(system, r.sweep, duration=r.final_state.time, initial=r.initial_state, out=folder)`
    initial_state: State = field(repr=False)
    final_state: State = field(repr=False)  #: state at the end of the last cycle, from which another sweep may continue
    warnings: tuple[str, ...]  #: exceeded rated travels, and frequencies that did not settle, one sentence each

    def _summary(self) -> tuple[str, dict[str, str]]:
        peak = int(np.argmax(self.amplitude))
        return "FrequencySweep", {
            "frequencies": f"{span((self.frequency[0], self.frequency[-1]), 'Hz')}, {self.frequency.size} of them",
            "base": f"along {direction_text(self.direction)}, {quantity(float(self.base_amplitude.max()), 'm/s^2')}",
            f"largest {self.response_direction} of {self.payload}": (
                f"{quantity(self.amplitude[peak], 'm/s^2')} at {self.frequency[peak]:.4g} Hz"
            ),
            "transmissibility there": f"{self.transmissibility[peak]:.4g}",
            "step": f"{1e6 * self.timestep:.4g} us",
            **({"warnings": "; ".join(self.warnings)} if self.warnings else {}),
        }

    @property
    def amplitude(self) -> Array:
        """Largest absolute acceleration of the payload along the response direction [m/s^2], (n,)."""
        return self.envelopes[self.payload].acceleration[:, AXES.index(self.response_direction)]

    @property
    def transmissibility(self) -> Array:
        """Amplitude over the base's amplitude in the same cycle, (n,)."""
        return self.envelopes[self.payload].transmissibility[:, AXES.index(self.response_direction)]

    @property
    def deflection(self) -> Array:
        """Largest absolute deflection of every mount along roll, shear and axial [m], (n_mounts, n, 3)."""
        return np.stack([np.maximum(mount.maximum, -mount.minimum) for mount in self.mounts.values()])

    @property
    def direction(self) -> str | tuple[float, float, float]:
        """Direction of the excitation."""
        direction = self.excitation["direction"]
        return direction if isinstance(direction, str) else tuple(direction)

    @property
    def sweep(self) -> Sweep | None:
        """The sweep; None for steady sines."""
        motion = motion_from_dict(self.excitation) if self.excitation["kind"] == Sweep.kind else None
        return motion if isinstance(motion, Sweep) else None

    def summary(self) -> Entries:
        """Summarise excitation, cost, warnings and the peaks of all bodies and mounts as plain values: [Hz], [m/s^2], [m]."""
        bodies = {}
        for name, envelope in self.envelopes.items():
            peaks = zip(AXES, envelope.acceleration.T, envelope.transmissibility.T, strict=True)
            bodies[name] = {
                axis: {
                    "largest_acceleration_m_s2": float(acceleration.max()),
                    "at_Hz": float(self.frequency[acceleration.argmax()]),
                    "largest_transmissibility": float(transmissibility.max()),
                    "transmissibility_at_Hz": float(self.frequency[transmissibility.argmax()]),
                }
                for axis, acceleration, transmissibility in peaks
            }
        mounts = {
            name: {"lowest_deflection_m": m.minimum.min(axis=0).tolist(), "highest_m": m.maximum.max(axis=0).tolist()}
            for name, m in self.mounts.items()
        }
        return {
            "excitation": self.excitation, "payload": self.payload, "response_direction": self.response_direction,
            "frequencies": int(self.frequency.size),
            "unsettled_frequencies_Hz": [] if self.sweep else self.frequency[~self.settled].tolist(),
            "cycles": int(self.cycles.sum()), "model_steps": self.model_steps, "largest_step_s": self.timestep,
            "warnings": list(self.warnings), "bodies": bodies, "mounts_roll_shear_axial": mounts,
        }  # fmt: skip

    def save(self, folder: str | Path) -> None:
        """Write table and summary into `folder` (made if missing), atomically; existing files are replaced."""
        bodies = [envelope.acceleration for envelope in self.envelopes.values()]
        mounts = [extreme for mount in self.mounts.values() for extreme in (mount.minimum, mount.maximum)]
        rows = np.column_stack([*(getattr(self, name) for name in _FIRST), *bodies, *mounts])
        content = {name: getattr(self, name) for name in _PLAIN} | {
            "format": FORMAT, "bodies": list(self.envelopes), "mounts": list(self.mounts), "warnings": list(self.warnings),
            "initial_state": self.initial_state.to_plain(), "final_state": self.final_state.to_plain(),
        }  # fmt: skip
        write_rows(Path(folder) / FILE, column_names(list(self.envelopes), list(self.mounts)), rows, content)
        self.save_summary(Path(folder))

    def save_summary(self, folder: Path) -> None:
        """Write the summary into `folder`, atomically."""
        with atomic_file(folder / SUMMARY) as temporary:
            temporary.write_text(json.dumps(self.summary(), indent=2) + "\n", encoding="utf-8")

    @classmethod
    def of_rows(cls, rows: Array, content: Entries) -> "FrequencySweep":
        """Make the sweep from a table's rows, (n, n_columns), and metadata."""
        vectors = iter(rows[:, len(_FIRST) :].reshape(rows.shape[0], -1, 3).transpose(1, 0, 2))
        first = dict(zip(_FIRST, rows.T, strict=False))
        base = first["base_amplitude"][:, np.newaxis]
        accelerations = {name: next(vectors) for name in content["bodies"]}
        return cls(
            **first | {"settled": first["settled"] != 0.0},
            envelopes={name: BodyEnvelope(acceleration=a, transmissibility=a / base) for name, a in accelerations.items()},
            mounts={name: MountEnvelope(minimum=next(vectors), maximum=next(vectors)) for name in content["mounts"]},
            **{name: content[name] for name in _PLAIN}, initial_state=State.from_plain(content["initial_state"]),
            final_state=State.from_plain(content["final_state"]), warnings=tuple(content["warnings"]),
        )  # fmt: skip


def load_frequency_sweep(folder: str | Path) -> FrequencySweep:
    """Read the sweep that was saved in `folder`.

    Raises:
        RecordError: the folder holds no sweep, or its file is damaged.
    """
    path = Path(folder) / FILE
    if not path.is_file():
        raise RecordError(f"{folder}: there is no {FILE} here; `FrequencySweep.save` writes one.")
    _, content = read_content(path, kind=_KIND, remedy=_REMEDY, version=FORMAT)
    columns = read_table(path, kind=_KIND, remedy=_REMEDY).columns
    try:
        return FrequencySweep.of_rows(np.column_stack([column.to_numpy() for column in columns]), content)
    except (KeyError, ValueError, TypeError):
        raise RecordError(f"{path}: this is not {_KIND}, or it is damaged. {_REMEDY}") from None


def column_names(bodies: Sequence[str], mounts: Sequence[str]) -> list[str]:
    names = [*_FIRST, *(f"bodies/{body}/acceleration/{c}" for body in bodies for c in AXES)]
    return names + [f"mounts/{m}/{end}/{c}" for m in mounts for end in ("lowest", "highest") for c in MOUNT_AXES]


class Collector:
    """Collector of the extremes at frequency after frequency, in memory or in a file, for the result of a sweep."""

    def __init__(self, system: System, *, direction: Direction, out: str | Path | None) -> None:
        """Prepare for an excitation along `direction`; `out` is the folder of the table, None to keep it in memory."""
        self._steps, self._largest_step = 0, 0.0
        self._channels = Channels.of(system)
        unit = np.abs(unit_vector(direction))
        self._along = int(np.argmax(unit))  # the largest component gives the amplitude of the straight motion
        self._component = float(unit[self._along])
        self._watch = TravelWatch(system)
        self._mounts, self._rows, self._writer = list(system.mounts), list[Array](), None
        if out is None:
            return
        if (Path(out) / FILE).exists():
            raise RecordError(f"{out}: a sweep stands here already; give another `out`, or remove {FILE}.")
        self._writer = TableWriter(Path(out) / FILE, column_names(self._channels.names, self._mounts))

    def __enter__(self) -> Self:
        return self

    def __exit__(self, kind: type[BaseException] | None, *_: object) -> None:
        if kind is not None and self._writer is not None:
            self._writer.discard()  # no half-written file

    def count(self, steps: int, largest_step: float) -> None:
        """Add a number of steps and the largest of them [s]."""
        self._steps, self._largest_step = self._steps + steps, max(self._largest_step, largest_step)

    def add(self, frequency: Array, minimum: Array, maximum: Array, *, cycles: int, remaining: float, settled: bool) -> None:
        """Add extremes of all channels, (n, n_channels, 3), at frequencies [Hz], (n,), and values common to all."""
        channels = self._channels
        self._watch.add(frequency, minimum[:, channels.mounts], maximum[:, channels.mounts])
        largest = np.maximum(maximum, -minimum)
        deflections = np.stack([minimum[:, channels.mounts], maximum[:, channels.mounts]], axis=2)  # (n, n_mounts, 2, 3)
        base = largest[:, channels.base, self._along] / self._component
        common = np.broadcast_to([cycles, remaining, settled], (frequency.size, 3))
        vectors = [largest[:, channels.bodies].reshape(frequency.size, -1), deflections.reshape(frequency.size, -1)]
        self._rows.append(np.column_stack([frequency, base, common, *vectors]))
        if self._writer is not None and sum(block.shape[0] for block in self._rows) >= STREAM_ROWS:
            self._writer.write(np.concatenate(self._rows))
            self._rows.clear()

    def finish(self, question: Entries, *, initial_state: State, final_state: State, warnings: Sequence[str]) -> FrequencySweep:
        """Make the sweep, in memory or from the file, and write its summary beside the file.

        `question` holds payload, response_direction, excitation and the estimated_error of the step; `warnings` precede those
        of travel.
        """
        content = question | {
            "format": FORMAT, "bodies": list(self._channels.names), "mounts": self._mounts,
            "timestep": self._largest_step, "model_steps": self._steps,
            "initial_state": initial_state.to_plain(), "final_state": final_state.to_plain(),
            "warnings": [*warnings, *self._watch.warnings()],
        }  # fmt: skip
        if self._writer is None:
            return FrequencySweep.of_rows(np.concatenate(self._rows), content)
        if self._rows:
            self._writer.write(np.concatenate(self._rows))
        self._writer.close(content)
        sweep = load_frequency_sweep(self._writer.path.parent)
        sweep.save_summary(self._writer.path.parent)
        return sweep
