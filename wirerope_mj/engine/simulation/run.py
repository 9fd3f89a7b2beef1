"""Stepping a system through a time grid: the one loop of every simulation; its peaks and contacts, and what to warn of."""

import math
import warnings
from collections.abc import Callable, Iterable
from dataclasses import dataclass, replace
from typing import Literal

import mujoco
import numpy as np

from wirerope_mj.engine.control import installed
from wirerope_mj.engine.control import layout as at
from wirerope_mj.engine.control.install import Kind
from wirerope_mj.engine.response.histories import SENSITIVE
from wirerope_mj.engine.response.peaks import FAINT, BodyPeaks, CombinedTravel, ContactPeak, MountPeaks, Peak, Peaks, PointPeaks
from wirerope_mj.engine.response.response import Response
from wirerope_mj.engine.simulation.grid import TimeGrid
from wirerope_mj.engine.simulation.stages import StageTables, drive_of
from wirerope_mj.engine.simulation.stepper import Stepper
from wirerope_mj.engine.system import System
from wirerope_mj.engine.system.tables import contact_name, payload_first, untouched_contact
from wirerope_mj.foundation.arrays import Array
from wirerope_mj.foundation.errors import AccuracyWarning, SimulationError
from wirerope_mj.foundation.state import State
from wirerope_mj.motions import BaseMotion
from wirerope_mj.mounts.isolator.travel import beyond_law

OTHERS = "further pairs"  # name of all pairs of geoms beyond the memory's last row
ENOUGH_GIVEN = 1e-3  # error of a given step, relative to the peaks, that is not warned of
CHECK_EVERY = 64  # segments between two looks at MuJoCo's warning counters

# where the numbers of a `Peak` stand in the tracker's memory of a channel
_NUMBERS = np.array(
    [
        at.PEAK,
        at.PEAK_TIME,
        *(first + c for first in (at.PEAK_VECTOR, at.LOW, at.LOW_TIME, at.HIGH, at.HIGH_TIME) for c in range(3)),
    ]
)

# fraction of the energy of a shock's acceleration below the highest frequency that it brings: of a half-sine of 11 ms it lies
# at 58 Hz, and thirty modes of a plate, to 120 Hz, are within 0.2 % there
WITHIN = 0.8
SPECTRAL, MOST_SPECTRAL = 64, 2**20  # samples of a shock in its shortest time, and at the most
# kinds of motions whose shortest time is a period
_OF_FREQUENCIES = ("sine", "sweep", "ship-motion", "vibration-lines", "random-vibration", "harmonic-force", "unbalance")


def contacts_of(system: System, user: Array) -> dict[str, ContactPeak]:
    """Return contacts by name: the model's declared pairs, touched or not, other geoms that touched, then mounts' stops.

    A stop, open or not, has its mount's name, with the axis where the mount has several.

    Where more touched than the memory has rows for, the last row is of all further pairs together, and what is not known to
    have touched is left out.
    """
    model, addresses, base = system.model, system.assembly.tables.user, system.assembly.subjects.base
    contacts = dict(system.assembly.contacts)
    rows = addresses.contact_rows(user)
    for row in rows[rows[:, at.TOUCHES] != 0.0]:
        if row[at.GEOMS] == at.SEVERAL:
            contacts[OTHERS] = _touched(ContactPeak(geoms=(OTHERS, ""), bodies=("", "")), row)
        else:
            geom, other_geom = divmod(int(row[at.GEOMS]), at.MOST_GEOMS)
            pair = payload_first(model, base, (geom - 1, other_geom - 1))
            contacts[contact_name(model, pair)] = _touched(untouched_contact(model, pair), row)
    if OTHERS in contacts:
        contacts = {name: contact for name, contact in contacts.items() if contact.touches}
    stop_rows = iter(zip(addresses.stop_rows(user), addresses.closing_rows(user), strict=True))
    for mount in system.mounts.values():
        axes = mount.isolator.stops
        laws = [stop for law in mount.isolator.axes.values() if law is not None for stop in law.stops]
        for number, (axis, law) in enumerate(zip(axes, laws, strict=True)):
            name = mount.name if len(axes) == 1 else f"{mount.name} {axis}"
            name += f" {axes[: number + 1].count(axis)}" if axes.count(axis) > 1 else ""
            (row, closing) = next(stop_rows)
            contacts[name] = contact = ContactPeak(
                geoms=("", ""), bodies=(mount.payload_body, mount.base_body), mount=mount.name, axis=axis,
                gap_below=law.gap_below, gap_above=law.gap_above, rest=law.rest,
            )  # fmt: skip
            if row[at.DEPTH] > FAINT:
                speed, when = float(closing[at.CLOSING]), float(closing[at.CLOSING_TIME])
                contacts[name] = replace(_touched(contact, row), closing_speed=speed, closing_time=when if speed else None)
    return contacts


def _touched(contact: ContactPeak, row: Array) -> ContactPeak:
    """Write a contact's record from its row of the callback's memory."""
    force, depth = float(row[at.FORCE_PEAK]), float(row[at.DEPTH])
    return replace(
        contact, touches=int(row[at.TOUCHES]), from_start=bool(row[at.FROM_START]),
        first_touch=float(row[at.FIRST_TOUCH]), duration=float(row[at.TOUCHED_FOR]), force=force,
        force_time=float(row[at.FORCE_TIME]) if force else None, penetration=depth,
        penetration_time=float(row[at.DEPTH_TIME]) if depth else None, energy=float(row[at.WORK]),
    )  # fmt: skip


@dataclass(frozen=True, kw_only=True)
class RunResult:
    """Result of stepping: state at the grid's end, peaks over every step, largest step [s], and the engine.

    `why` is the reason why MuJoCo computed it and not the kernel, "" if the kernel did.
    """

    final_state: State
    peaks: Peaks
    callback: Kind
    steps: int
    largest_step: float
    engine: Literal["mujoco", "kernel"] = "mujoco"
    why: str = ""


def run(
    system: System, motion: BaseMotion, grid: TimeGrid, initial: State, *, callback: Kind,
    sink: Callable[[int, Array], None] | None = None, progress: Callable[[float], None] | None = None,
) -> RunResult:  # fmt: skip
    """Step `system` through `grid` from `initial` by MuJoCo and pass every sample to `sink`, if it is given.

    The system's model is copied, so that one system serves several threads. `sink` takes the number of the first of some
    samples and the system's sensor values, (n_samples, n_values), which it must copy; `progress` takes the simulated time [s]
    now and then.

    Raises:
        SimulationError: MuJoCo warned that the state is not valid any more.
    """
    stepper = Stepper(system, motion, initial)
    data, values = stepper.data, stepper.data.sensordata[system.assembly.sensor :]
    sample, all_steps, largest = 0, 0, 0.0
    tables = StageTables(motion, drive_of(system), system.assembly.subjects.force_names)
    with installed(stepper.model, data, callback) as kind:
        for block in grid.blocks():
            stepper.enter(block)
            all_steps, largest = all_steps + int(block.steps.sum()), max(largest, block.largest_step)
            for base in tables.segments(block):
                segment = base.number
                if segment % CHECK_EVERY == 0:
                    stepper.check()
                    if progress is not None:
                        progress(float(block.start[segment]))
                stepper.begin(base)
                steps = int(block.steps[segment])
                if sink is not None and block.sampled[segment]:
                    mujoco.mj_step(stepper.model, data)
                    sink(sample, values[np.newaxis])
                    sample, steps = sample + 1, steps - 1
                if steps:
                    mujoco.mj_step(stepper.model, data, nstep=steps)
        final = stepper.finish()
        if sink is not None and sample < grid.sample_times.size:
            sink(sample, values[np.newaxis])
        stepper.check()
    if progress is not None:
        progress(grid.stop)
    return RunResult(
        final_state=final, peaks=peaks_of(system, stepper.user, tables.peak), callback=kind, steps=all_steps,
        largest_step=largest,
    )  # fmt: skip


def peaks_of(system: System, user: Array, base: Peak) -> Peaks:
    """Read the peaks from the tracker's memory in userdata; channels fixed to the base have the peak of the base."""
    assembly = system.assembly
    rows = assembly.tables.user.channel_rows(user)
    every = [Peak.of(row) for row in rows.take(_NUMBERS, axis=1)]
    for number in np.setdiff1d(assembly.tables.base_channels, assembly.tables.tracked).tolist():
        every[number] = base
    channels = iter(every)
    bodies = {name: BodyPeaks(acceleration=next(channels)) for name in assembly.subjects.body_names}
    points = {
        name: PointPeaks(acceleration=next(channels), relative_displacement=next(channels))
        for name in assembly.subjects.point_names
    }
    mounts = {name: MountPeaks(deflection=next(channels), force=next(channels)) for name in system.mounts}
    travels = {
        name: CombinedTravel(
            value=math.sqrt(row[at.FARTHEST]), time=row[at.FARTHEST_TIME],
            judged=math.sqrt(row[at.JUDGED]) if row[at.JUDGED] >= 0.0 else None, judged_time=row[at.JUDGED_TIME],
        )
        for name, row in zip(system.mounts, assembly.tables.user.travel_rows(user).tolist(), strict=True)
    }  # fmt: skip
    return Peaks(bodies=bodies, points=points, mounts=mounts, contacts=contacts_of(system, user), travels=travels)


def aliasing(motions: Iterable[BaseMotion], sample_rate: float) -> str:
    """Describe, as a clause, a base motion that lasts at frequencies too high for the samples; "" if there is none."""
    parts = [part for motion in motions for part in motion.parts if part.kind in _OF_FREQUENCIES]
    fastest = max((1.0 / part.shortest_time for part in parts), default=0.0)
    if fastest <= 0.5 * sample_rate:
        return ""
    return (
        f"the base moves at up to {fastest:.4g} Hz, and {sample_rate:.4g} samples a second tell nothing above "
        f"{0.5 * sample_rate:.4g} Hz: histories and spectra of the samples show what is not there. Peaks are those of "
        f"every step. Give a `sample_rate` of at least {10.0 * fastest:.4g} Hz."
    )


def missing_modes(system: System, motion: BaseMotion) -> tuple[str, ...]:
    """Return a sentence on each flexible deck whose highest mode is below twice the highest frequency of the base motion."""
    model, parts = system.model, dict[str, list[float]]()
    for mode in system.assembly.subjects.modes:
        if mode.owner == system.assembly.subjects.base and not mode.residual:
            frequency = math.sqrt(model.jnt_stiffness[model.dof_jntid[mode.dof]]) / (2.0 * math.pi)
            parts.setdefault(mode.part, []).append(frequency)
    brought = highest_frequency(motion) if parts else 0.0
    return tuple(
        f"the modes of the deck {name!r} end at {max(highest):.4g} Hz, and the base brings up to {brought:.4g} Hz: what lies "
        f"between is missing from peaks and histories, by several per cent. Take modes up to twice that, "
        f"{2.0 * brought:.4g} Hz; residual vectors do not stand for them."
        for name, highest in parts.items() if max(highest) < 2.0 * brought
    )  # fmt: skip


def highest_frequency(motion: BaseMotion) -> float:
    """Compute the highest frequency of a base motion [Hz]: stated of steady vibration, from the spectrum of shocks.

    For a shock, the part `WITHIN` of the energy of its acceleration lies below it. 0 for a jump of the velocity alone.
    """
    highest = 0.0
    for part in motion.parts:
        if part.kind in _OF_FREQUENCIES and not part.loaded_sites:
            highest = max(highest, 1.0 / part.shortest_time)
        if part.kind in _OF_FREQUENCIES or not math.isfinite(part.end):
            continue
        begin = min((instant for instant, _ in part.events), default=0.0)
        shortest = min(part.shortest_time, part.end - begin)
        if not (0.0 < shortest < math.inf):
            continue
        number = min(math.ceil(SPECTRAL * (part.end - begin) / shortest), MOST_SPECTRAL)
        times = begin + (part.end - begin) * np.arange(number) / number
        padded = 8 * number if number < MOST_SPECTRAL else number  # a pulse alone has few lines
        energy = np.cumsum((np.abs(np.fft.rfft(part.acceleration(times), n=padded, axis=0)) ** 2).sum(axis=1))
        if energy[-1] > 0.0:
            line = int(np.searchsorted(energy, WITHIN * energy[-1]))
            highest = max(highest, line * number / (padded * (part.end - begin)))
    return highest


def warn_of_missing_modes(system: System, motions: Iterable[BaseMotion]) -> None:
    for text in dict.fromkeys(text for motion in motions for text in missing_modes(system, motion)):
        warnings.warn(text, AccuracyWarning, stacklevel=3)


def warn_of_aliasing(motions: Iterable[BaseMotion], sample_rate: float) -> None:
    """Warn of a base motion that lasts at frequencies too high for the samples: histories would show aliases."""
    if text := aliasing(motions, sample_rate):
        warnings.warn(text, AccuracyWarning, stacklevel=3)


def require_lawful(system: System, peaks: Peaks) -> None:
    """Raise SimulationError if a mount left the range of deflections in which the law of an axis holds."""
    for name, mount in system.mounts.items():
        if mount.isolator.holds_everywhere:
            continue
        peak = peaks.mounts[name].deflection
        if beyond := beyond_law(mount.isolator.axes, peak.minimum, peak.maximum):
            raise SimulationError(f"mount {name!r} was {beyond}: shake it more gently, or take an isolator with more travel.")


def warn_of_uncertainty(response: Response) -> None:
    """Warn of struck contacts, of an estimated error above the requested one, and of a given step that is too long.

    A stop among the mounts' laws is as certain as they are: that it was struck is a verdict.
    """
    numerics, texts = response.numerics, []
    contacts = {name: contact for name, contact in (response.peaks.contacts or {}).items() if not contact.mount}
    if struck := [name for name in response.peaks.struck if name in contacts]:
        texts.append(
            f"{len(struck)} of {len(contacts)} contact pairs were struck, first {struck[0]} at "
            f"{contacts[struck[0]].first_touch:.4f} s: accelerations are uncertain from there on, because they depend on "
            "stiffness and damping of the stops."
        )
    if numerics.limited_by == SENSITIVE:
        texts.append(
            f"the answer is sensitive to what the system hits: runs with steps of {1e3 * numerics.timestep:.4g} ms and less "
            f"differ by up to {numerics.error_estimate:.1e} of the peaks, and finer ones do not agree better. Take the peaks "
            "with that spread, or give the stops more loss."
        )
    elif not math.isnan(numerics.accuracy) and numerics.error_estimate > numerics.accuracy:
        texts.append(
            f"the estimated error, {numerics.error_estimate:.1e} of the peaks, is above the accuracy asked for, "
            f"{numerics.accuracy:.1e}: the step of {1e3 * numerics.timestep:.4g} ms is limited by {numerics.limited_by}. Ask "
            "for less (a larger `accuracy`), or give a smaller `timestep`."
        )
    for text in texts:
        warnings.warn(text, AccuracyWarning, stacklevel=3)
    if math.isnan(numerics.accuracy) and numerics.limited_by != SENSITIVE:
        warn_of_given_step(numerics.timestep, numerics.error_estimate, stacklevel=4)


def warn_of_given_step(timestep: float, error: float, *, stacklevel: int = 3) -> None:
    """Warn of a given step [s] whose error, relative to the peaks, is large; never for NaN."""
    if error > ENOUGH_GIVEN:
        warnings.warn(
            f"the given step of {1e3 * timestep:.4g} ms is too long for friction that yields within it: half of it differs by "
            f"{error:.1e} of the peaks. Give a smaller `timestep`, or None to have it chosen.",
            AccuracyWarning, stacklevel=stacklevel,
        )  # fmt: skip
