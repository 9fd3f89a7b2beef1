"""What stiffness, load and travel of a mount would keep the limits of a selection, by single masses of one axis."""

import math
from collections.abc import Mapping
from dataclasses import dataclass

import numpy as np

from wirerope_mj.engine.statics.payloads import payloads_of
from wirerope_mj.engine.system import System
from wirerope_mj.foundation.errors import Absent
from wirerope_mj.foundation.units import in_unit
from wirerope_mj.motions import BaseMotion
from wirerope_mj.motions.spectra import shock_response_spectrum
from wirerope_mj.studies.measures import payload_points

DAMPING = 0.15  # damping ratio of the single masses, as wire rope isolators have in a shock
_FREQUENCIES = np.geomspace(1.0, 100.0, 161)  # natural frequencies that are tried [Hz], 24 to an octave
_SAMPLES = 20.0  # in a period of the highest frequency
_SHORTEST = 20.0  # samples in the shortest time scale of a motion


@dataclass(frozen=True, kw_only=True)
class NeededMount:
    """A linear mount that would keep the limits."""

    mounts: int  # that share the payload
    load: float  # weight on each [N]
    frequencies: tuple[float, float]  # lowest and highest natural frequency that would do [Hz]
    stiffness: tuple[float, float]  # of one mount at these [N/m]
    travel: tuple[float, float]  # deflection from the unloaded geometry at these [m]: the softer mount needs the longer one
    damping: float = DAMPING


def needed_mount(system: System, mounts: int, cases: Mapping[str, BaseMotion]) -> NeededMount | Absent:
    """Find the natural frequencies of a single mass that keeps a system's limits on acceleration and clearance.

    Along each axis of the world and under each load case the mass answers as an oscillator of 15 % damping; its acceleration
    counts against the smallest limit of a body's, its deflection from the unloaded geometry against the smallest clearance of
    a point along the axis. Rotation, and what several axes do together, are left out.
    """
    points, gravity = payload_points(system), np.abs(system.model.opt.gravity)
    accelerations = (value for limit in system.limits if limit.kind == "acceleration" for value in limit.values)
    acceleration = min(filter(None, accelerations), default=math.inf)
    ways = [limit.ways for limit in system.limits if limit.kind == "clearance" and limit.name in points]
    room = [min((way.get(sign + axis, math.inf) for way in ways for sign in "-+"), default=math.inf) for axis in "xyz"]
    mass, pulsation = sum(payload.mass for payload in payloads_of(system)), 2.0 * math.pi * _FREQUENCIES
    peaks, moves = np.zeros((2, _FREQUENCIES.size, 3))
    for motion in cases.values():
        step = min(1.0 / (_SAMPLES * _FREQUENCIES[-1]), motion.shortest_time / _SHORTEST)
        step = max(step, motion.end / 2e6)
        time = step * np.arange(int(motion.end / step) + 3)
        history = motion.acceleration(time)
        for instant, jump in motion.velocity_jumps:  # one sample of that area
            history[min(int(round(instant / step)) + 1, time.size - 2)] += jump / step
        spectrum = shock_response_spectrum(time, history, _FREQUENCIES, q=0.5 / DAMPING)
        peaks = np.maximum(peaks, spectrum.maximax)
        moves = np.maximum(moves, spectrum.relative_displacement)
    moves = moves + gravity / pulsation[:, np.newaxis] ** 2  # from the unloaded geometry
    keeps = np.all(peaks <= acceleration, axis=1), np.all(moves <= room, axis=1)
    rows = np.flatnonzero(keeps[0] & keeps[1])
    if rows.size == 0:
        # the frequency at which the limit that is exceeded most is exceeded least
        used = np.maximum(peaks.max(axis=1) / acceleration, (moves / room).max(axis=1))
        row = int(used.argmin())
        return Absent(
            reason=f"No linear mount would do either: at best, at {_FREQUENCIES[row]:.3g} Hz, a single mass with "
            f"{100.0 * DAMPING:g} % damping reaches {in_unit(float(peaks[row].max()), 'g'):.3g} g and moves "
            f"{in_unit(float(moves[row].max()), 'mm'):.3g} mm from the unloaded geometry."
        )
    stiffness = mass / mounts * pulsation[rows[[0, -1]]] ** 2
    return NeededMount(
        mounts=mounts, load=mass * float(np.linalg.norm(gravity)) / mounts,
        frequencies=(float(_FREQUENCIES[rows[0]]), float(_FREQUENCIES[rows[-1]])),
        stiffness=(float(stiffness[0]), float(stiffness[1])),
        travel=(float(moves[rows[0]].max()), float(moves[rows[-1]].max())),
    )  # fmt: skip
