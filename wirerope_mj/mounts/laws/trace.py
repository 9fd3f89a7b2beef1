"""The loop that a law draws along a path of deflections."""

import numpy as np
import numpy.typing as npt

from wirerope_mj.foundation.arrays import Array
from wirerope_mj.mounts.laws.law import Law
from wirerope_mj.mounts.laws.loop import Loop
from wirerope_mj.mounts.laws.path import follow_path
from wirerope_mj.mounts.laws.timed import follow_time


def trace(
    law: Law,
    deflection: npt.ArrayLike,
    *,
    time: npt.ArrayLike | None = None,
    rate: npt.ArrayLike | None = None,
    initial_states: npt.ArrayLike | None = None,
) -> Loop:
    """Return the loop of a law; arguments and errors as in `Law.trace`."""
    path = np.asarray(deflection, dtype=np.float64)
    law.check_path(path)
    n_states = law.n_states
    states = np.zeros(n_states) if initial_states is None else np.array(initial_states, dtype=np.float64)
    if states.shape != (n_states,) or not np.isfinite(states).all():
        raise ValueError(f"`initial_states` must be {n_states} finite numbers, got {initial_states!r}.")
    if law.rate_independent:
        force, history, work = follow_path(law.kernel, law.kernel_parameters(), path, states, n_states)
    else:
        times = _times(law, path, time)
        rates = _rates(path, times, rate)
        force, history, work = follow_time(law.kernel, law.kernel_parameters(), times, path, rates, states, n_states)
    finite = np.isfinite(force) & np.isfinite(work)
    if not finite.all():
        last = max(int(np.argmin(finite)) - 1, 0)
        end = _last_finite(law, path[last], path[last + 1], history[last])
        raise ValueError(f"the force of {law} leaves the finite numbers at a deflection of {end:.6g} m.")
    forces = [i for i, name in enumerate(law.state_names) if name.startswith("z")]
    z = history[:, forces].sum(axis=1)
    return Loop(deflection=path, force=force, hysteretic_state=z, work=work, internal_states=history)


def _last_finite(law: Law, start: float, stop: float, states: Array) -> float:
    """Return how far a rate-independent law leads from `start` towards `stop` with a finite force [m]."""
    if not law.rate_independent:
        return stop
    low, high = 0.0, 1.0
    for _ in range(60):
        middle = 0.5 * (low + high)
        path = np.array([start, start + middle * (stop - start)])
        force, _, work = follow_path(law.kernel, law.kernel_parameters(), path, states.copy(), law.n_states)
        low, high = (middle, high) if np.isfinite([force[1], work[1]]).all() else (low, middle)
    return start + low * (stop - start)


def _times(law: Law, path: Array, time: npt.ArrayLike | None) -> Array:
    """Return `time` as an array (n_t,) [s], or raise ValueError if it does not fit the path."""
    if time is None:
        raise ValueError(f"`time` must be given: the force of {law.name} depends on the deflection rate.")
    times = np.asarray(time, dtype=np.float64)
    if times.shape != path.shape:
        raise ValueError(f"`time` must have the shape of the deflection, {path.shape}, got {times.shape}.")
    if not np.isfinite(times).all() or (np.diff(times) <= 0.0).any():
        raise ValueError("`time` must be finite and strictly increasing.")
    return times


def _rates(path: Array, times: Array, rate: npt.ArrayLike | None) -> Array:
    """Return `rate` as an array (n_t,) [m/s], by differences that are exact for a parabola if it is not given."""
    if rate is None:
        return np.gradient(path, times, edge_order=2 if path.size > 2 else 1)
    rates = np.asarray(rate, dtype=np.float64)
    if rates.shape != path.shape or not np.isfinite(rates).all():
        raise ValueError(f"`rate` must be finite and of shape {path.shape}, got shape {rates.shape}.")
    return rates
