"""Rotation of a base that a record holds beside its accelerations, as angular rates or angular accelerations."""

import re
from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING

import numpy as np

from wirerope_mj.foundation.arrays import Array
from wirerope_mj.foundation.directions import ROTATIONS, Direction
from wirerope_mj.foundation.errors import RecordError
from wirerope_mj.foundation.table_header import Header
from wirerope_mj.foundation.units import ANGLE_UNITS, ANGULAR_ACCELERATION_UNITS, ANGULAR_RATE_UNITS, find_unit
from wirerope_mj.motions.envelope import Envelope
from wirerope_mj.motions.piecewise import PiecewiseLinear
from wirerope_mj.motions.records.sampling import without_baseline

if TYPE_CHECKING:
    pass

AXES_OF_SENSORS = ("base", "world")
RATE, ACCELERATION = "rate", "acceleration"
# of columns in a unit of an angular rate or acceleration
_TURN_COLUMN = re.compile(
    r"(?:.*[^a-z])?(roll|pitch|yaw)(?:[^a-z].*)?|.*?([xyz])(?:[ _-]?(?:axis|dir|direction))?", re.IGNORECASE
)
TURN_UNITS = {RATE: ANGULAR_RATE_UNITS, ACCELERATION: ANGULAR_ACCELERATION_UNITS}
_STILL = 0.02  # of the largest rate, within which a record begins and ends at rest: that much is set to zero there
_STEEPEST = np.radians(89.0)  # pitch beyond which roll and yaw are one
# final angle, as a fraction of the range that is left without a steady drift, and [rad], from which a drift is warned of
_DRIFT, _SMALL = 0.25, np.radians(1.0)


@dataclass(frozen=True, eq=False)
class Turning:
    """Roll, pitch and yaw on cubics through angles and rates at the samples: at rest before, at the last rate after."""

    time: Array  # [s], (n,)
    angles: Array  # [rad], (n, 3)
    rates: Array  # [rad/s], (n, 3)

    def derivative(self, t: Array, order: int) -> Array:
        """Return the angles (order 0), their rates (1) or second derivatives (2) at the times [s], (n_t, 3)."""
        left = np.clip(np.searchsorted(self.time, t, side="right") - 1, 0, self.time.size - 2)
        step = (self.time[left + 1] - self.time[left])[:, np.newaxis]
        u = (t - self.time[left])[:, np.newaxis] / step
        a, b = self.angles[left], self.angles[left + 1]
        va, vb = step * self.rates[left], step * self.rates[left + 1]
        cubic, square = 2.0 * (a - b) + va + vb, 3.0 * (b - a) - 2.0 * va - vb
        after, beyond = u > 1.0, u - 1.0
        if order == 0:
            curve, last = a + u * (va + u * (square + u * cubic)), b + vb * beyond
        elif order == 1:
            curve, last = (va + u * (2.0 * square + 3.0 * u * cubic)) / step, vb / step
        else:
            curve, last = (2.0 * square + 6.0 * u * cubic) / step**2, np.zeros_like(vb)
        return np.where(u < 0.0, 0.0, np.where(after, last, curve))


def turned(
    path: Path, time: Array, samples: Array, *, kind: str, axes: str, baseline: str, highpass: float | None, fade: float | None
) -> tuple[Array, Turning]:
    """Compute how a base turns by measured angular channels, and turn its measured accelerations into the world's axes.

    Rates and angular accelerations are straight between the samples. A step h with the rates w0 and w1 at its ends turns by
    exp(int w dt +- h^2/12 w0 x w1), of fourth order (Magnus), + of rates about the base's own axes, - about the world's.

    Args:
        path: of the record, for messages.
        time: sample instants [s], evenly spaced, (n,).
        samples: accelerations [m/s^2], and rates [rad/s] or angular accelerations [rad/s^2], (n, 6).
        kind: "rate" or "acceleration", what the last three are.
        axes: "base", of sensors that turn with it, or "world".
        baseline: as of `load_record`, of the angular channels here.
        highpass: its cutoff [Hz].
        fade: length of a smooth rise at the beginning and a fall at the end [s].

    Returns:
        Accelerations along the world's axes, (n, 3), and the rotation, longer than the record with a high-pass.

    Raises:
        RecordError: the base turns at the beginning or the end, or it pitches by 89 deg or more.
    """
    from scipy.spatial.transform import Rotation

    measured = samples[:, 3:].copy()
    size = time.size
    time, measured = without_baseline(time, measured, baseline, highpass)
    if fade is not None:
        measured *= fade_factor(time, fade)[:, np.newaxis]
    if kind == RATE:
        for row, when in ((0, "begins"), (-1, "ends")):
            fastest = np.abs(measured).max()
            if np.abs(measured[row]).max() > _STILL * fastest:
                raise RecordError(
                    f"{path}: it {when} while the base turns at {np.degrees(np.abs(measured[row]).max()):.3g} deg/s, "
                    f"{100.0 * np.abs(measured[row]).max() / fastest:.2g} % of its fastest: have it rise from rest and fall to "
                    'rest smoothly, fade=1.0 (--fade 1, in seconds), or take off an offset, baseline="rest" (--baseline rest).'
                )
            measured[row] = 0.0
        rates, gains = measured, np.diff(PiecewiseLinear(time, measured).derivative(time, 1), axis=0)
    else:
        integrals = PiecewiseLinear(time, measured)
        rates, gains = integrals.derivative(time, 1), np.diff(integrals.derivative(time, 0), axis=0)
    step, own = float(time[1] - time[0]), axes == "base"
    gains += (1.0 if own else -1.0) * step**2 / 12.0 * np.cross(rates[:-1], rates[1:])
    turns, shift = Rotation.from_rotvec(np.concatenate([np.zeros((1, 3)), gains])), 1
    while shift < len(turns):  # products of all rotations up to each, in log2(n) passes
        before, here = turns[:-shift], turns[shift:]
        turns = Rotation.concatenate([turns[:shift], before * here if own else here * before])
        shift *= 2
    angles = np.unwrap(turns.as_euler("xyz"), axis=0)
    if np.abs(angles[:, 1]).max() > _STEEPEST:
        raise RecordError(f"{path}: the base pitches by {np.degrees(np.abs(angles[:, 1]).max()):.3g} deg, and 89 is the most.")
    p, q, r = (rates if own else turns.inv().apply(rates)).T
    (sine, cosine), (_, pitch, _) = (np.sin(angles[:, 0]), np.cos(angles[:, 0])), angles.T
    about_z = (q * sine + r * cosine) / np.cos(pitch)
    of_angles = np.stack([p + about_z * np.sin(pitch), q * cosine - r * sine, about_z], axis=1)
    accelerations = samples[:, :3]
    if own:
        first = (time.size - size) // 2
        accelerations = turns[first : first + size].apply(accelerations)
    return accelerations, Turning(time, angles, of_angles)


def kind_of(unit: str | None) -> str:
    """Return "rate" or "acceleration" for a unit of an angular rate or acceleration; "" for any other."""
    return next((kind for kind, units in TURN_UNITS.items() if find_unit(unit or "", units)), "")


def turned_by(header: Header, columns: Sequence[int]) -> str:
    """Return "rate" or "acceleration", the kind of angular columns, "" without any; RecordError if of neither or both kinds."""
    kinds = dict.fromkeys(kind_of(header.units[column]) for column in columns)
    if not columns or (len(kinds) == 1 and "" not in kinds):
        return next(iter(kinds), "")
    angles = [header.names[column] for column in columns if find_unit(header.units[column] or "", ANGLE_UNITS)]
    what = f"{', '.join(angles)} are angles" if angles else f"the columns are {header.listed(units=True)}"
    raise RecordError(
        f"{header.location}: what turns the base must be angular rates, all [deg/s] or [rad/s], or angular accelerations, all "
        f"[deg/s^2] or [rad/s^2]; {what}. Export the rates, or choose other columns by channels= (--channels)."
    )


def turn_columns(header: Header, time: int) -> dict[int, Direction]:
    """Find columns in a unit of angular rate or acceleration that are named after an axis: "roll", "pitch" or "yaw" by index.

    Of a file with both the rates are taken. RecordError if two are about one axis.
    """
    for units in TURN_UNITS.values():
        columns: dict[int, Direction] = {}
        for column, (name, unit) in enumerate(zip(header.names, header.units, strict=True)):
            match = _TURN_COLUMN.fullmatch(name)
            if column == time or match is None or not find_unit(unit or "", units):
                continue
            about = match[1].lower() if match[1] else ROTATIONS["xyz".index(match[2].lower())]
            if about in columns.values():
                raise RecordError(
                    f'{header.location}: "{name}" is a second column of {about}. Choose by channels= (--channels).'
                )
            columns[column] = about
        if columns:
            return columns
    return {}


def turning_warnings(turning: Turning) -> Iterator[str]:
    """Yield warnings about roll, pitch and yaw that drift."""
    for name, angle in zip(ROTATIONS, turning.angles.T, strict=True):
        end, left = float(angle[-1]), float(np.ptp(angle - np.linspace(0.0, angle[-1], angle.size)))
        if abs(end) > max(_SMALL, _DRIFT * left):
            yield (
                f"its {name} ends at {np.degrees(end):.3g} deg, beside {np.degrees(left):.3g} deg about a steady turn: a small "
                'offset adds up. Correct it with baseline="mean" or "highpass" (--baseline), unless the base does turn so far.'
            )


def fade_factor(time: Array, length: float) -> Array:
    """Return a factor that rises smoothly from 0 to 1 in a length [s] from the first time and falls so to the last, (n,)."""
    if not 0.0 < 2.0 * length <= time[-1] - time[0]:
        raise ValueError(f"`fade` must be > 0 and at most half the record's {time[-1] - time[0]:.6g} s, got {length!r}.")
    return Envelope(start=float(time[0]), stop=float(time[-1]), rise=length, fall=length).derivatives(time)[0]
