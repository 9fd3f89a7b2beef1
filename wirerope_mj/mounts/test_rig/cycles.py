"""Long records cut into cycles: the steady loop of every amplitude and operating point that a test held."""

from collections.abc import Callable
from dataclasses import replace
from pathlib import Path

import numpy as np

from wirerope_mj.foundation.arrays import Array, ArrayLike
from wirerope_mj.foundation.errors import RecordError
from wirerope_mj.foundation.table_files import LARGEST
from wirerope_mj.mounts.laws import Loop
from wirerope_mj.mounts.test_rig.averaging import PhasedCycle, cycle_to, mean_loop, whole_record
from wirerope_mj.mounts.test_rig.faults import hum_in, without_hum
from wirerope_mj.mounts.test_rig.passive import is_noise, no_cycle_text, require_falling, require_unclipped
from wirerope_mj.mounts.test_rig.reading import (
    Samples,
    read_rows,
    require_like_samples,
    require_likely,
    require_nominal,
    require_slower,
)
from wirerope_mj.mounts.test_rig.turning import RecordedLoop, Trace, find_turning_points

Locate = Callable[[int, int], str]  # Returns the text that says where the samples from one index to another stand
# Last cycles whose mean is the loop: noise is halved nearly, and what fades from cycle to cycle has faded most.
KEPT = 3
_FEWEST = 12  # samples in a cycle: fewer do not show how its branches bend
_STROKE_RATIO = 0.05  # ratio by which strokes of one run may differ: amplitudes that a test tells apart differ by more
_AT_ENDS = 0.02  # the same for the strokes that a record begins and ends with, which may stop short of turning round
_HOLE = 0.25  # of a period: samples that are farther apart do not show one of the strokes
_REPEATS = 0.02  # of the amplitude, root mean square: cycles that repeat the deflection less well are not averaged
_UNLOADED = 0.05  # of its range, within which a record begins at the unloaded device


def load_cycles(path: str | Path, *, stop: bool = False) -> list[Loop]:
    """Read the steady loops of a measured cyclic test of any length, in the order of the file.

    The file is that of `load_cyclic_test`, but its rows, or those with one value of `loop` or `amplitude`, may hold any
    number of cycles, amplitudes and operating points one after the other. `steady_loops` says how they are cut. Hum of
    the mains that stands out of the force is taken out; `wirerope identify` says so.

    Args:
        path: of the file.
        stop: whether the device is a bare bump stop: without force within its gap, and without area if it is elastic.

    Raises:
        RecordError: names file and lines, what stands there and what is expected.
    """
    path = Path(path)
    loops = []
    for samples in read_rows(path):

        def locate(first: int, last: int, samples: Samples = samples) -> str:
            return f"{path}, lines {samples.lines[first]} to {samples.lines[last]}"

        require_like_samples(samples, path)
        try:
            time = np.array(samples.time) if samples.time else None
            force = np.array(samples.force)
            hum = None if time is None else hum_in(time, force)
            if time is not None and hum is not None:
                force = without_hum(time, force, hum)
            steady = _loops_of_record(np.array(samples.deflection), force, time, locate, stop)
            for loop in steady:
                if isinstance(loop, RecordedLoop) and loop.period is not None:
                    require_slower(loop.amplitude, loop.period, locate(0, len(samples.lines) - 1))
                require_nominal(samples, loop.amplitude, locate(0, len(samples.lines) - 1))
                half = 0.5 * float(np.ptp(loop.force))
                require_likely(loop.amplitude, half, locate(0, len(samples.lines) - 1), stop=stop)
        except ValueError as error:
            raise RecordError(str(error)) from None
        loops += steady
    return loops


def steady_loops(deflection: ArrayLike, force: ArrayLike, *, time: ArrayLike | None = None, stop: bool = False) -> list[Loop]:
    """Cut a record into steady loops, one for every run of cycles of one amplitude.

    Turning points are reversals of the smoothed deflection by more than its noise and by more than 1 % of its range. Strokes
    of one length that follow each other are a run. Of its last three cycles the mean is taken at equal phases, as far
    as they repeat each other. A zero of the force that drifts linearly is taken out, by the mean forces of these cycles;
    of a single one, so that it closes.

    Of a record that begins at the unloaded device, as one with a ramp to the operating point does, each loop keeps the turning
    points before it, so that laws can be led the same way and cycles need not be steady; of others, loops count as steady.

    Loops hold 200 samples, fewer if the record has fewer, and end with their first sample; `cycles` counts the run's, and
    `closure` says how far apart the ends of the last cycle stand without the drift.

    Args:
        deflection: record [m], (n_t,).
        force: restoring force [N], (n_t,).
        time: increasing [s], (n_t,); None: the samples are uniform.
        stop: whether the device is a bare bump stop: without force within its gap, and without area if it is elastic.

    Raises:
        ValueError: there is no full cycle, the deflection does not move, the force is clipped or works the wrong way.
    """
    x, f = np.asarray(deflection, dtype=np.float64), np.asarray(force, dtype=np.float64)
    t = None if time is None else np.asarray(time, dtype=np.float64)
    if x.ndim != 1 or x.shape != f.shape or not ((np.abs(x) <= LARGEST).all() and (np.abs(f) <= LARGEST).all()):
        raise ValueError(
            f"`deflection` and `force` must be finite series of one length, without a value beyond {LARGEST:.0e}, got shapes "
            f"{x.shape} and {f.shape}."
        )
    if t is not None and (t.shape != x.shape or not np.isfinite(t).all() or (np.diff(t) <= 0.0).any()):
        raise ValueError("`time` must be finite, as long as `deflection`, and increase from sample to sample.")
    return _loops_of_record(x, f, t, lambda first, last: f"samples {first} to {last}", stop)


def _loops_of_record(x: Array, f: Array, time: Array | None, locate: Locate, stop: bool) -> list[Loop]:
    """Cut a record into steady loops; `locate` words the place of samples for messages."""
    whole = locate(0, x.size - 1) if x.size else "the record"
    if x.size < _FEWEST:
        raise ValueError(f"{whole}: {x.size} samples; one cycle needs at least {_FEWEST}.")
    if np.ptp(x) == 0.0:
        raise ValueError(f"{whole}: the deflection never changes, it stands at {1e3 * x[0]:.6g} mm.")
    trace = find_turning_points(x, np.arange(x.size, dtype=np.float64) if time is None else time)
    if trace.turns.size == 0 or is_noise(x, trace.noise):
        raise ValueError(f"{whole}: {no_cycle_text(x)}")
    step = float(np.abs(np.diff(trace.smooth)).max())
    if 2 <= trace.strokes.size <= 3 and abs(float(x[-1] - x[0])) <= 1.5 * step + 4.0 * trace.noise:  # its ends meet
        require_unclipped(x, f, whole, stop=stop)
        loop = mean_loop([whole_record(trace)], x, f, 1, abs(float(f[-1] - f[0])), whole, stop=stop)
        return [loop if time is None else replace(loop, period=float(np.ptp(time)))]
    # Runs of like strokes that hold a cycle, by their first and last turning points.
    strokes, first, end = trace.strokes, 0, trace.strokes.size
    slack = 4.0 * trace.smooth_noise
    if end >= 2 and abs(strokes[0] - strokes[1]) > _AT_ENDS * strokes[1] + slack:
        first = 1
    if end >= 2 and abs(strokes[-1] - strokes[-2]) > _AT_ENDS * strokes[-2] + slack:
        end -= 1
    runs = []
    for last in range(first + 1, end + 1):
        size = strokes[first:last].mean()
        if last == end or abs(strokes[last] - size) > _STROKE_RATIO * size + slack:
            if last - first >= 2:
                runs.append((first, last))
            first = last
    if not runs:
        listed = ", ".join(f"{1e3 * s:.4g}" for s in strokes[:6]) + (", ..." if strokes.size > 6 else "")
        raise ValueError(
            f"{whole}: there is no full cycle. The deflection goes to and fro by {listed} mm; a cycle is two strokes of "
            "one length, or ends where it began."
        )
    loops = [_loop_of_run(trace, f, first, last, locate, stop) for first, last in runs]
    if time is None:  # the trace counts samples instead
        loops = [replace(loop, period=None) for loop in loops]
    if abs(float(trace.smooth[0])) > _UNLOADED * np.ptp(x):  # how the device came there is not in the record
        return [replace(loop, averaged=0) for loop in loops]
    turning = trace.raw_turning  # those of a run are its loop's, free of noise
    for (first, last), loop in zip(runs, loops, strict=True):
        ends = (loop.deflection.min(), loop.deflection.max())
        for index in range(first, last + 1):
            turning[index] = ends[int(turning[index] > 0.5 * sum(ends))]
    counts = [last + 1 - 2 * loop.averaged for (_, last), loop in zip(runs, loops, strict=True)]
    return [replace(loop, history=np.append(0.0, turning[:n])) for loop, n in zip(loops, counts, strict=True)]


def _loop_of_run(trace: Trace, force: Array, first: int, last: int, locate: Locate, stop: bool) -> RecordedLoop:
    """Average the last cycles of a run, all of one amplitude, to a loop, with the drift of the force's zero taken out."""
    cycles = [cycle_to(trace, end) for end in range(last, first + 1, -2)]
    fewest = min(cycle.samples.size for cycle in cycles[:KEPT])
    if fewest < _FEWEST:
        at = cycles[0].samples
        raise ValueError(f"{locate(int(at[0]), int(at[-1]))}: the cycle has {fewest} samples; it needs at least {_FEWEST}.")
    kept, latest = [cycles[0]], cycles[0].of(trace.deflection)
    for cycle in cycles[1:KEPT]:
        apart = np.sqrt(np.mean((cycle.of(trace.deflection) - latest) ** 2))
        if apart > _REPEATS * 0.5 * np.ptp(latest) + 2.0 * trace.noise:
            break
        kept.append(cycle)
    every = np.concatenate([cycle.samples for cycle in kept])
    location = locate(int(every.min()), int(every.max()))
    require_unclipped(trace.deflection[every], force[every], location, stop=stop)
    times = trace.times[[last - 2, last]]
    rise, period = np.diff(np.interp(times, trace.time, trace.smoothed(force)))[0], times[1] - times[0]
    hole = max(float(np.diff(trace.time[cycle.samples]).max()) for cycle in kept)
    if hole > _HOLE * period:
        raise ValueError(
            f"{location}: {hole:.3g} s of a cycle of {period:.3g} s hold no samples: are rows missing there? Both strokes "
            "must be recorded."
        )
    slope = _drift(trace, kept, force, last) if len(kept) > 1 else rise / period
    gap = abs(float(rise - slope * period))
    without_drift = force - slope * (trace.time - times[1])
    loop = mean_loop(kept, trace.deflection, without_drift, len(cycles), gap, location, stop=stop)
    require_falling(loop, location, stop=stop)
    return replace(loop, averaged=len(kept), period=float(period))


def _drift(trace: Trace, kept: list[PhasedCycle], force: Array, last: int) -> float:
    """Estimate how fast the zero of the force drifts [N/s]: from the mean force of the first kept cycle to that of the last.

    Mean forces of whole cycles, whose ends lie between samples, are surer than forces at turning points, which would close
    the loop exactly and their noise with it.
    """
    since = force - force[0]  # so that a force that stands still has no drift by rounding
    work = np.concatenate([[0.0], np.cumsum(0.5 * (since[1:] + since[:-1]) * np.diff(trace.time))])
    ends = trace.times[last - 2 * len(kept) : last + 1 : 2]
    means, middles = np.diff(np.interp(ends, trace.time, work)) / np.diff(ends), 0.5 * (ends[1:] + ends[:-1])
    return float((means[-1] - means[0]) / (middles[-1] - middles[0]))
