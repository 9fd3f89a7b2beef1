"""Long records cut into cycles: the steady loop of every amplitude and operating point that a test held."""

from collections.abc import Callable
from dataclasses import dataclass, replace
from pathlib import Path

import numpy as np
import numpy.typing as npt

from wirerope_mj.bench.reading import Samples, read_rows, require_nominal
from wirerope_mj.bench.tips import reach_of, tip_of
from wirerope_mj.bench.turning import Trace, find_turning_points, rms_noise
from wirerope_mj.errors import RecordError
from wirerope_mj.laws import Loop

Array = npt.NDArray[np.float64]
Place = Callable[[int, int], str]

POINTS = 200
"""Samples of a loop: chords then lose 2e-4 of its area, and a fit does not slow down with the rate of the acquisition."""

KEPT = 3
"""Last cycles whose mean is the loop: noise is halved nearly, and what fades from cycle to cycle has faded most."""

_FEWEST = 12  # samples in a cycle: fewer do not show how its branches bend
_ALIKE = 0.05  # share by which strokes of one run may differ: amplitudes that a test tells apart differ by more
_AT_ENDS = 0.02  # the same for the strokes that a record begins and ends with, which may stop short of turning round
_REPEATS = 0.02  # of the amplitude, root mean square: cycles that repeat the deflection less well are not averaged
_AT_TIP = 0.05  # of a bin, within which samples stand at a turning point: a chord to the next loses 1e-4 of a stroke
_NOTHING = 0.01  # of stroke times force range: an area of the size that noise has
_CLIPPED = 0.05  # share of the stroke over which a force that still moves cannot stand at one value, even at 8 bits


def read_cycles(path: str | Path) -> list[Loop]:
    """Return the steady loops of a measured cyclic test of any length, in the order of the file.

    The file is that of `read_cyclic_test`, but its rows, or those with one value of `loop` or `amplitude`, may hold any
    number of cycles, amplitudes and operating points one after the other. See `steady_loops` for what is made of them.

    Raises:
        RecordError: names file and lines, what stands there and what is expected.
    """
    path = Path(path)
    loops = []
    for samples in read_rows(path):

        def place(first: int, last: int, samples: Samples = samples) -> str:
            return f"{path}, lines {samples.lines[first]} to {samples.lines[last]}"

        try:
            time = np.array(samples.time) if samples.time else None
            found = _steady(np.array(samples.deflection), np.array(samples.force), time, place)
        except ValueError as error:
            raise RecordError(str(error)) from None
        for loop in found:
            require_nominal(samples, loop.amplitude, place(0, len(samples.lines) - 1))
        loops += found
    return loops


def steady_loops(deflection: npt.ArrayLike, force: npt.ArrayLike, *, time: npt.ArrayLike | None = None) -> list[Loop]:
    """Return one loop for every run of like cycles in a record.

    Turning points are reversals of the smoothed deflection by more than its noise and by more than 1 % of its range. Strokes
    of one length that follow each other are a run. Of its last three cycles the mean is taken at equal phases, as far
    as they repeat each other. A zero of the force that drifts linearly is taken out, by the mean forces of these cycles;
    of a single one, so that it closes.

    Loops hold 200 samples, fewer if the record has fewer, and end with their first sample; `cycles` counts the run's, and
    `closure` says how far apart the ends of the last cycle stand without the drift.

    Args:
        deflection: record [m], (n_t,).
        force: restoring force [N], (n_t,).
        time: increasing [s], (n_t,); None: the samples are uniform.

    Raises:
        ValueError: there is no full cycle, the deflection does not move, the force is clipped or works the wrong way.
    """
    x, f = np.asarray(deflection, dtype=np.float64), np.asarray(force, dtype=np.float64)
    t = None if time is None else np.asarray(time, dtype=np.float64)
    if x.ndim != 1 or x.shape != f.shape or not (np.isfinite(x).all() and np.isfinite(f).all()):
        raise ValueError(
            f"`deflection` and `force` must be finite series of one length, got shapes {x.shape} and {f.shape}."
        )
    if t is not None and (t.shape != x.shape or not np.isfinite(t).all() or (np.diff(t) <= 0.0).any()):
        raise ValueError("`time` must be finite, as long as `deflection`, and increase from sample to sample.")
    return _steady(x, f, t, lambda first, last: f"samples {first} to {last}")


@dataclass(frozen=True)
class _Cycle:
    """One cycle's samples: phase 0 to 1, `tips` the phases of its turning points that are not samples themselves."""

    samples: npt.NDArray[np.int64]
    phase: Array
    tips: tuple[float, ...]

    def of(self, values: Array) -> Array:
        """Return a series at `POINTS` even phases."""
        return np.interp(np.arange(POINTS) / POINTS, self.phase, values[self.samples])


def _steady(x: Array, f: Array, time: Array | None, place: Place) -> list[Loop]:
    """Return the loops of a record; `place` says in words where samples stand."""
    whole = place(0, x.size - 1) if x.size else "the record"
    if x.size < _FEWEST:
        raise ValueError(f"{whole}: {x.size} samples; one cycle needs at least {_FEWEST}.")
    if np.ptp(x) == 0.0:
        raise ValueError(f"{whole}: the deflection never changes, it stands at {1e3 * x[0]:.6g} mm.")
    trace = find_turning_points(x, np.arange(x.size, dtype=np.float64) if time is None else time)
    if trace.turns.size == 0:
        raise ValueError(
            f"{whole}: the deflection never changes by more than its noise, {1e3 * rms_noise(x):.3g} mm; there is no cycle."
        )
    if trace.strokes.size <= 3 and _ends_meet(trace):
        _require_unclipped(x, f, whole)
        return [_loop([_whole(trace)], x, f, 1, abs(float(f[-1] - f[0])), whole)]
    runs = _runs(trace)
    if not runs:
        strokes = ", ".join(f"{1e3 * s:.4g}" for s in trace.strokes[:6]) + (", ..." if trace.strokes.size > 6 else "")
        raise ValueError(
            f"{whole}: there is no full cycle. The deflection goes to and fro by {strokes} mm; a cycle is two strokes of "
            "one length, or ends where it began."
        )
    return [_loop_of_run(trace, f, first, last, place) for first, last in runs]


def _ends_meet(trace: Trace) -> bool:
    """Return whether a record ends where it began, or one step before."""
    x = trace.deflection
    step = float(np.abs(np.diff(trace.smooth)).max())
    return trace.strokes.size >= 2 and abs(float(x[-1] - x[0])) <= 1.5 * step + 4.0 * trace.noise


def _whole(trace: Trace) -> _Cycle:
    """Return a record that is one cycle; its last sample repeats the first or stands one step before it."""
    x, samples = trace.deflection, trace.time.size
    steps = np.abs(np.diff(x))
    repeated = abs(float(x[-1] - x[0])) <= 0.5 * min(steps[0], steps[-1])
    share = 1.0 if repeated else (samples - 1) / samples
    elapsed, turning = (share * (t - trace.time[0]) / np.ptp(trace.time) for t in (trace.time, trace.times[1:-1]))
    if samples <= POINTS + 1:
        return _Cycle(np.arange(samples), elapsed, ())
    # Turning points where bins have their middle, as those of a run.
    tips = np.round(turning * POINTS) / POINTS
    phase = np.interp(elapsed, [0.0, *turning, 1.0], [0.0, *tips, 1.0])
    return _Cycle(np.arange(samples), phase, (*tips.tolist(), *([0.0] if tips.size == 1 else [])))


def _runs(trace: Trace) -> list[tuple[int, int]]:
    """Return the first and the last turning point of every run of like strokes that holds a cycle."""
    strokes, first, stop = trace.strokes, 0, trace.strokes.size
    slack = 4.0 * trace.smooth_noise
    if stop >= 2 and abs(strokes[0] - strokes[1]) > _AT_ENDS * strokes[1] + slack:
        first = 1
    if stop >= 2 and abs(strokes[-1] - strokes[-2]) > _AT_ENDS * strokes[-2] + slack:
        stop -= 1
    runs = []
    for here in range(first + 1, stop + 1):
        size = strokes[first:here].mean()
        if here == stop or abs(strokes[here] - size) > _ALIKE * size + slack:
            if here - first >= 2:
                runs.append((first, here))
            first = here
    return runs


def _loop_of_run(trace: Trace, force: Array, first: int, last: int, place: Place) -> Loop:
    """Return the mean of the last cycles of a run, without drift."""
    cycles = [_cycle(trace, end) for end in range(last, first + 1, -2)]
    fewest = min(cycle.samples.size for cycle in cycles[:KEPT])
    if fewest < _FEWEST:
        at = cycles[0].samples
        raise ValueError(
            f"{place(int(at[0]), int(at[-1]))}: the cycle has {fewest} samples; it needs at least {_FEWEST}."
        )
    kept, latest = [cycles[0]], cycles[0].of(trace.deflection)
    for cycle in cycles[1:KEPT]:
        apart = np.sqrt(np.mean((cycle.of(trace.deflection) - latest) ** 2))
        if apart > _REPEATS * 0.5 * np.ptp(latest) + 2.0 * trace.noise:
            break
        kept.append(cycle)
    every = np.concatenate([cycle.samples for cycle in kept])
    where = place(int(every.min()), int(every.max()))
    _require_unclipped(trace.deflection[every], force[every], where)
    times = trace.times[[last - 2, last]]
    rise, period = np.diff(np.interp(times, trace.time, trace.smoothed(force)))[0], times[1] - times[0]
    slope = _drift(trace, kept, force) if len(kept) > 1 else rise / period
    gap = abs(float(rise - slope * period))
    return _loop(kept, trace.deflection, force - slope * (trace.time - times[1]), len(cycles), gap, where)


def _drift(trace: Trace, kept: list[_Cycle], force: Array) -> float:
    """Return how fast the zero of the force drifts [N/s]: from the mean force of the first kept cycle to that of the last.

    The means of all samples are surer than forces at the turning points, which would close the loop exactly and their noise
    with it.
    """
    (f_last, t_last), (f_first, t_first) = (
        (cycle.of(force).mean(), cycle.of(trace.time).mean()) for cycle in (kept[0], kept[-1])
    )
    return float((f_last - f_first) / (t_last - t_first))


def _cycle(trace: Trace, end: int) -> _Cycle:
    """Return the cycle that ends at a turning point."""
    bounds = trace.times[end - 2 : end + 1]
    inside = np.flatnonzero((trace.time >= bounds[0]) & (trace.time <= bounds[2]))
    return _Cycle(inside, np.interp(trace.time[inside], bounds, [0.0, 0.5, 1.0]), (0.0, 0.5))


def _loop(cycles: list[_Cycle], x: Array, f: Array, count: int, gap: float, where: str) -> Loop:
    """Return the mean of cycles over bins of phase, whose first and last bin are one, through their turning points."""
    every = np.concatenate([cycle.samples for cycle in cycles])
    phase = np.concatenate([cycle.phase for cycle in cycles])
    bins = min(POINTS, *(round((cycle.phase.size - 1) / np.ptp(cycle.phase)) for cycle in cycles))
    bins -= bins % 2 if cycles[0].tips else 0  # half a cycle after the first turning point is a bin's middle too
    numbers = np.floor(phase * bins + 0.5).astype(int) % bins
    filled = np.bincount(numbers, minlength=bins)
    means = [np.bincount(numbers, values[every], bins) / np.maximum(filled, 1) for values in (x, f)]
    for tip in cycles[0].tips:
        distance, place = (phase - tip + 0.5) % 1.0 - 0.5, round(tip * bins) % bins
        if filled[place] and np.abs(distance[numbers == place]).max() < _AT_TIP / bins:
            continue
        near = np.abs(distance) <= reach_of(bins)
        means[0][place], means[1][place] = tip_of(distance[near], x[every][near], f[every][near])
        filled[place] += 1
    mean_x, mean_f = (mean[filled > 0] for mean in means)
    loop = Loop.from_samples(np.append(mean_x, mean_x[0]), np.append(mean_f, mean_f[0]), cycles=count)
    if np.ptp(mean_f) == 0.0:
        raise ValueError(f"{where}: the force never changes, it stands at {mean_f[0]:.6g} N.")
    if loop.secant_stiffness < 0.0:
        raise ValueError(f"{where}: the force falls where the deflection grows; both are positive in tension.")
    if loop.dissipated_energy <= 0.0:
        if -loop.dissipated_energy < _NOTHING * np.ptp(mean_x) * np.ptp(mean_f):
            raise ValueError(
                f"{where}: the cycle of +-{1e3 * loop.amplitude:.4g} mm encloses no area beside its noise; leave it out, or "
                "measure more cycles of it."
            )
        raise ValueError(
            f"{where}: the cycle gives {-loop.dissipated_energy:.3g} J away, and no isolator does. Is the order of the "
            "samples that of time, and do both channels have the same filter?"
        )
    return replace(loop, closure=gap / float(np.ptp(mean_f)))


def _require_unclipped(x: Array, f: Array, where: str) -> None:
    """Raise ValueError if the force stands at exactly its extreme while the deflection moves on."""
    for word, extreme in (("largest", f.max()), ("smallest", f.min())):
        at = f == extreme
        if 3 < at.sum() < f.size and np.ptp(x[at]) > _CLIPPED * np.ptp(x):
            raise ValueError(
                f"{where}: {at.sum()} samples stand at exactly the {word} force, {extreme:.6g} N, over "
                f"{1e3 * np.ptp(x[at]):.3g} mm of deflection: the load cell or its amplifier was saturated."
            )
