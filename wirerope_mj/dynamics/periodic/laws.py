"""The laws of a system for the search of periodic motions: smoothed over a velocity, their states scaled by their own slope.

Bouc-Wen's equation is zdot = v f(z, s), s = sgn v, f = alpha - |z|^n (beta sgn(s z) + gamma). For n < 1 the derivative of f is
infinite at z = 0: sampled at steps, or in differences of the stepped map, it scatters for any affordable step. With

    dz = f w        d/dt(f w) = v f f' w + f w'        so that        w' = dv

within a segment of one sign of v, exactly. At a reversal z and dz are continuous, and w is multiplied by f(z, -s) / f(z, s).
Where the state saturates f vanishes and w would grow without bound. Therefore dz = phi w with phi = f + SMALL alpha, and

    w' = (f / phi) dv + v f' (1 - f / phi) w

which is the equation in w where f is large, that in dz where it is not. A law that is smoothed over a velocity has

    w' = d(v f) / dv / phi dv + v (df/dz - f phi' / phi) w,        f = alpha - |z|^n (beta tanh(v / width) sgn z + gamma)

with phi as without smoothing. Two states of one axis have one w each.
"""

from dataclasses import dataclass, replace

import numpy as np

from wirerope_mj.dynamics.periodic.motion import Track, mount_deflections
from wirerope_mj.engine.control import layout as at
from wirerope_mj.engine.system import System
from wirerope_mj.engine.system.varied import with_other_laws
from wirerope_mj.foundation.arrays import AnyArray, Array, Entries, Integers
from wirerope_mj.mounts.isolator import Isolator
from wirerope_mj.mounts.laws.registry import PARALLEL, SMOOTHED
from wirerope_mj.mounts.laws.wrapped import with_width

# Fraction of alpha in phi: far above the rounding of f, 1e-16 alpha, where the state is saturated; at z = 0, where f' is
# infinite, a millionth of it remains in the equation.
SMALL = 1e-6
NEAREST = 1e-12  # fraction of a state's largest value below which its power is not differentiated


def smoothed(system: System, width: float) -> System:
    """Smooth the system's laws over the velocity `width` [m/s]; ValueError if no law can be smoothed."""
    if all(_with_smoothed_axes(mount.isolator, width) == mount.isolator for mount in system.mounts.values()):
        raise ValueError(
            "`smoothing` has nothing to smooth: no axis of this system has a law with one hysteretic state, or several such."
        )
    return with_other_laws(system, lambda isolator: _with_smoothed_axes(isolator, width))


def _with_smoothed_axes(isolator: Isolator, width: float) -> Isolator:
    axes: Entries = {
        axis: with_width(law, width)
        for index, (axis, law) in enumerate(isolator.axes.items())
        if law is not None and index not in isolator.coupled_axes
    }
    return replace(isolator, **axes)


def width_indices(system: System) -> Integers:
    """Find the indices of the smoothing widths of a system's laws in its model's numeric_data."""
    model = system.model
    addresses = model.actuator_dynprm[-1]
    layout, parameters = int(addresses[at.PRM_LAYOUT]), int(addresses[at.PRM_PARAMETERS])
    first = layout + int(model.numeric_data[layout + at.AXES])
    rows = model.numeric_data[first : first + 3 * at.AXIS_COLUMNS * len(system.mounts)].reshape(-1, at.AXIS_COLUMNS)
    return parameters + widths_of(rows[:, [at.LAW, at.FIRST_PARAMETER]], model.numeric_data[parameters:])


def widths_of(laws: AnyArray, parameters: Array) -> Integers:
    """Find the indices of smoothing widths in `parameters` of `laws`, rows (kernel number, first parameter), and parts."""
    widths = []
    for law, first in laws.astype(int).tolist():
        widths += [first] if law == SMOOTHED else []
        parts = int(parameters[first]) if law == PARALLEL else 0
        for part in parameters[first + 1 : first + 1 + 3 * parts].reshape(-1, 3).astype(int).tolist():
            widths += [first + part[1]] if part[0] == SMOOTHED else []
    return np.array(widths, dtype=np.int64)


@dataclass(frozen=True, kw_only=True)
class Slopes:
    """Factors of the linear equation of the scaled unknowns, by pairs of steps, in each of which a rate keeps one sign."""

    scale: Array  # phi / alpha at the three instants of every pair, 1 for unscaled unknowns, (n_pairs, 3, n)
    gain: Array  # factor of the rate's change, (n_pairs, 3, n)
    decay: Array  # factor of w itself [1/s], (n_pairs, 3, n)
    turns: Array  # factor of w at reversals before a pair, (n_pairs + 1, n); the last one is behind the last pair
    waits: Array  # time from the pair's start to the reversal, which lies between steps [s], (n_pairs + 1, n)

    @property
    def begin(self) -> Array:
        return np.asarray(self.scale[0, 0] * self.turns[0])

    @property
    def end(self) -> Array:
        return np.asarray(self.scale[-1, 2] / self.turns[-1])


class ScaledStates:
    """Hysteretic states of uncoupled Bouc-Wen laws, which are scaled by their own slope, and the factors of that."""

    def __init__(self, system: System) -> None:
        rows, parameters, smoothed, offsets = [], [], [], []
        for number, mount in enumerate(system.mounts.values()):
            for axis, law in enumerate(mount.isolator.axes.values()):
                if law is None or axis in mount.isolator.coupled_axes:
                    continue
                state, offset = mount.states[axis].start, law.parameters_before
                for part in law.components:
                    if part.bouc_wen_parameters is not None:
                        rows.append((state, number, axis))
                        parameters.append(part.bouc_wen_parameters)
                        smoothed.append(not part.rate_independent)
                        offsets.append(offset)
                    state, offset = state + part.n_states, offset + part.kernel_parameters().size
        self._system = system
        # Indices among the internal states, and where their deflections are, (n,) each, as all that follow.
        self.states, self.mounts, self.axes = np.array(rows, dtype=np.int64).reshape(-1, 3).T
        self.alpha, self._beta, self._gamma, self._n = np.array(parameters, dtype=np.float64).reshape(-1, 4).T
        self.offsets = np.array(offsets, dtype=np.int64)  # where their parameters begin among those of their axis
        self.smoothed = np.array(smoothed, dtype=bool)  # whether they belong to smoothed laws
        self.steep = self._n < 1.0

    @property
    def serve(self) -> bool:
        """True if the variational equation is preferred: a state is steep (n < 1), or all internal states are scaled.

        It takes account of reversals between steps, which differences of the stepped map do not.
        """
        return bool(self.steep.any()) or 0 < self.states.size == self._system.model.na

    def along(self, track: Track, width: float, first: int) -> Slopes:
        """Evaluate the factors over a period; `first` is the index of the first internal state among the unknowns."""
        x = mount_deflections(self._system, track)[:, self.mounts, self.axes]
        z = track.act[:, self.states]
        pairs, h = len(x) // 2, track.drive.duration / len(x)
        instants = (2 * np.arange(pairs)[:, np.newaxis] + np.arange(3)) % len(x)
        rate = (np.roll(x, -1, axis=0) - np.roll(x, 1, axis=0)) / (2.0 * h)
        sign = np.sign(x[instants[:, 2]] - x[instants[:, 0]])
        for k in range(-1, pairs - 1):  # a pair without motion has the sign of the pair before
            sign[k + 1] = np.where(sign[k + 1] == 0.0, sign[k], sign[k + 1])
        sign = np.where(sign == 0.0, 1.0, sign)
        scale, gain, decay = self._factors(z[instants], rate[instants], sign[:, np.newaxis], width)
        # Pair by pair around the circle: phi before and after each start, and when the rate vanished there.
        start = instants[:, 0]
        before = self._factors(z[start], rate[start], np.roll(sign, 1, axis=0), width)[0]
        turned = sign != np.roll(sign, 1, axis=0)
        bend = (np.roll(x, -1, axis=0) - 2.0 * x + np.roll(x, 1, axis=0))[start] / h**2
        with np.errstate(divide="ignore", invalid="ignore"):
            wait = np.where(turned & ~self.smoothed & (bend != 0.0), -rate[start] / bend, 0.0)
        wait = np.clip(wait, -h, h)
        turn = np.where(turned, before / scale[:, 0], 1.0)
        # A motion that turns round at its start does so there, or at its end a moment before.
        late = turned[0] & (wait[0] <= 0.0)
        turns, waits = np.vstack([turn, np.where(late, turn[0], 1.0)]), np.vstack([wait, np.where(late, wait[0], 0.0)])
        turns[0], waits[0] = np.where(late, 1.0, turn[0]), np.where(late, 0.0, wait[0])
        size = first + track.act.shape[1]

        def of_all(values: Array, unscaled: float) -> Array:
            full = np.full((*values.shape[:-1], size), unscaled)
            full[..., first + self.states] = values
            return full

        return Slopes(
            scale=of_all(scale, 1.0), gain=of_all(gain, 1.0), decay=of_all(decay, 0.0), turns=of_all(turns, 1.0),
            waits=of_all(waits, 0.0),
        )  # fmt: skip

    def _factors(self, z: Array, v: Array, sign: Array, width: float) -> tuple[Array, Array, Array]:
        """Evaluate the factors scale (phi / alpha), gain and decay of states z at rates `v`, where v has the given sign."""
        n, size = self._n, np.abs(z)
        side, power = np.where(z >= 0.0, 1.0, -1.0), size**n
        with np.errstate(divide="ignore"):
            slope = n * np.maximum(size, NEAREST * size.max(initial=1e-300)) ** (n - 1.0)
        f = self.alpha - power * (self._beta * sign * side + self._gamma)
        phi = np.maximum(f, 0.0) + SMALL * self.alpha
        phi_slope = np.where(f > 0.0, -slope * (self._beta * sign + self._gamma * side), 0.0)
        blend = np.where(self.smoothed, np.tanh(v / width) if width else sign, sign)
        smooth = self.alpha - power * (self._beta * blend * side + self._gamma)
        smooth_slope = -slope * (self._beta * blend + self._gamma * side)
        steeper = power * self._beta * side * (1.0 - blend**2) * v / width if width else 0.0
        return phi / self.alpha, (smooth - steeper) / phi, v * (smooth_slope - smooth * phi_slope / phi)
