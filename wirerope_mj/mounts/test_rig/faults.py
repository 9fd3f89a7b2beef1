"""Faults of a rig that a record shows: hum of the mains, drift of the zero, play, a channel that lags, noise; with sizes."""

import math
from dataclasses import dataclass
from pathlib import Path

import numpy as np
import scipy

from wirerope_mj.foundation.arrays import Array
from wirerope_mj.foundation.units import duration_text
from wirerope_mj.mounts.test_rig.lag import lag_in
from wirerope_mj.mounts.test_rig.reading import read_rows
from wirerope_mj.mounts.test_rig.turning import find_turning_points, rms_noise

# forces, over half of their range, at which a stroke's deflection is read; a load cell's zero may be off by a third of it
_LEVELS = np.linspace(0.6, -0.6, 13)
_MIDDLE = slice(2, 10)  # intervals of these among which the flat one is searched; steep ones remain on either side
_FLAT = 0.6  # of the stiffness on either side, up to which an interval is flat; a hysteretic law has less behind than before
_SAME_FORCE = 0.2  # of half of the force range, within which both senses have their flat interval at one force
_SHARPER = 4  # times that the force is smoothed over fewer samples than the deflection: play may be short
_STROKE = 0.3  # of the longest, from which a stroke is checked
_FEWEST = 3  # least number of strokes that show play
_STROKE_SHARE = 0.8


@dataclass(frozen=True, kw_only=True)
class Play:
    """Play: deflection behind a reversal over which the force stays constant [m], and the number of strokes that show it."""

    width: float
    strokes: int


def play_in(time: Array, deflection: Array, force: Array) -> Play | None:
    """Find the play that deflection [m] and force [N] at instants [s], (n,) each, show; None if they show no play."""
    if np.ptp(deflection) == 0.0 or np.ptp(force) == 0.0:
        return None
    trace = find_turning_points(deflection, time)
    smooth = scipy.ndimage.uniform_filter1d(force, max(1, trace.window // _SHARPER))
    smooth -= 0.5 * (smooth.max() + smooth.min())
    half = 0.5 * float(np.ptp(smooth))
    seen: dict[bool, list[tuple[float, float, float]]] = {True: [], False: []}
    strokes_checked = 0
    for first, last in zip(trace.turns[:-1], trace.turns[1:], strict=True):
        path_of_stroke = trace.smooth[first : last + 1]
        if abs(path_of_stroke[-1] - path_of_stroke[0]) < _STROKE * trace.strokes.max():
            continue
        upwards = bool(path_of_stroke[-1] > path_of_stroke[0])
        falling = (-1.0 if upwards else 1.0) * smooth[first : last + 1] / half
        start = falling[: max(1, falling.size // 20)]
        if start.max() < _LEVELS[0] or falling.min() > _LEVELS[-1]:
            continue
        strokes_checked += 1
        begin = int(np.argmax(start))  # from there on the deflections at which the force first falls below each level
        at_levels = np.array([path_of_stroke[begin + int(np.argmax(falling[begin:] < level))] for level in _LEVELS])
        stiffness = -np.diff(_LEVELS) / np.maximum(np.abs(np.diff(at_levels)), 1e-300)
        flat = _MIDDLE.start + int(np.argmin(stiffness[_MIDDLE]))
        beside = min(float(np.median(stiffness[:flat])), float(np.median(stiffness[flat + 1 :])))
        if stiffness[flat] < _FLAT * beside:
            slack = np.maximum(np.abs(np.diff(at_levels)) * (1.0 - stiffness / beside), 0.0)
            level = 0.5 * float(_LEVELS[flat] + _LEVELS[flat + 1]) * (-1.0 if upwards else 1.0)
            seen[upwards].append((float(slack[_MIDDLE].sum()), 0.5 * float(at_levels[flat] + at_levels[flat + 1]), level))
    widths = np.array([width for each in seen.values() for width, _, _ in each])
    if widths.size < max(_FEWEST, _STROKE_SHARE * strokes_checked) or not (seen[True] and seen[False]):
        return None
    apart = np.abs(np.diff([np.median(seen[side], axis=0) for side in (True, False)], axis=0))[0]
    # A spring that hardens is flat at one deflection, and with friction at two forces.
    if apart[1] < np.median(widths) or apart[2] > _SAME_FORCE:
        return None
    return Play(width=float(np.median(widths)), strokes=int(widths.size))


MAINS = (50.0, 60.0)  # Frequencies at which hum is looked for [Hz]
_LINE_BAND, _ASIDE = 0.6, 8.0  # Hz from a mains frequency: where its line is looked for, and where its neighbours are
_STANDS_OUT = 3.0  # times that a line is above the largest of its neighbours: harmonics of the test fall evenly
_LEAST = 1e-3  # of half of the force range, below which hum changes no parameter
_DRIFTS = 0.02  # of half of the force range over the record, from which a drift is named
_LAGS = 0.0009  # of the period: a lag is named from 0.1 %, which is told to a tenth
_HIDDEN = 0.3  # of the period, times noise over half of the force range: a bend that noise hides is taken for as much lag
# Friction that slips early behind a reversal, as a second scale does, looks as if the force turned round before the deflection,
# where noise or samples of a cycle hide the bend: of the period, times the root of that share, and over samples of a cycle.
_EARLY, _COARSE = 0.1, 0.15
_NOISY = 0.03  # of half of the force range, from which noise is named
_SURE = 4.0  # standard errors of a drift or a lag
_STROKE_RATIO = 0.1  # ratio by which strokes may differ and count as alike
_FEWEST_CYCLES = 4  # whole cycles of a run, of which the way to the first still bends; of three the bend counts as error
_SLOWEST = 2.0  # seconds between samples: no logger of a rig is slower, and ms that are called s make a thousandth of its rate


@dataclass(frozen=True, kw_only=True)
class Hum:
    """A line of the mains in a force: frequency [Hz] and amplitude [N]."""

    frequency: float
    amplitude: float


def hum_in(time: Array, force: Array) -> Hum | None:
    """Find the largest line of the mains in a force [N], (n,), at even instants [s] that stands out; None if no line does."""
    if time.size < 3:
        return None
    step = float(time[-1] - time[0]) / (time.size - 1)
    if np.abs(np.diff(time) - step).max() > 1e-2 * step:  # a file's digits round instants
        return None
    values = (force - force.mean()) * np.hanning(force.size)
    frequency, size = np.fft.rfftfreq(force.size, step), np.abs(np.fft.rfft(values)) * 4.0 / force.size
    lines, spacing = [], 1.0 / (step * force.size)
    for mains in MAINS:
        in_line_band = np.abs(frequency - mains) <= _LINE_BAND
        aside = (np.abs(frequency - mains) <= _ASIDE) & (np.abs(frequency - mains) > 2.0 * _LINE_BAND)
        if frequency[-1] < mains + _ASIDE or in_line_band.sum() < 3:
            continue
        line = float(size[in_line_band].max())
        if line > _STANDS_OUT * float(size[aside].max()) and line > _LEAST * 0.5 * float(np.ptp(force)):
            centre = float(frequency[in_line_band][size[in_line_band].argmax()])
            best = scipy.optimize.minimize_scalar(
                lambda at: -_line(time, force, at)[1], bounds=(centre - spacing, centre + spacing), method="bounded"
            )
            lines.append(Hum(frequency=float(best.x), amplitude=-float(best.fun)))
    return max(lines, key=lambda line: line.amplitude, default=None)


def _line(time: Array, force: Array, frequency: float) -> tuple[Array, float]:
    """Fit the oscillation at a frequency in a force without its slow part; return that line, (n,), and its amplitude [N]."""
    angle = 2.0 * np.pi * frequency * (time - time[0])
    window = np.hanning(force.size)
    period = max(1, round(1.0 / (frequency * (time[1] - time[0]))))
    # The running mean over one period of the hum is without it; twice, so that what is straight stays.
    mean = scipy.ndimage.uniform_filter1d(force, period, mode="nearest")
    quiet = force - scipy.ndimage.uniform_filter1d(mean, period, mode="nearest")
    waves = np.stack([np.cos(angle), np.sin(angle)], axis=1)
    parts = np.linalg.lstsq(waves * window[:, np.newaxis], quiet * window, rcond=None)[0]
    return waves @ parts, float(np.hypot(*parts))


def without_hum(time: Array, force: Array, hum: Hum) -> Array:
    """Take a line of the mains out of a force: a notch at its frequency alone, which changes nothing else."""
    return force - _line(time, force, hum.frequency)[0]


@dataclass(frozen=True, kw_only=True)
class Checked:
    """Sentences on the faults of a rig that a record shows, and the least lag that it would have shown, over the period."""

    faults: list[str]
    least_lag: float  # NaN where no lag can be told
    lag: str = ""  # that of the faults which names a lag


def checked_record(time: Array, deflection: Array, force: Array) -> Checked:
    """Look for faults in a record: instants [s], deflection [m], force [N], (n,) each; a clean record has no fault."""
    faults: list[str] = []
    half = 0.5 * float(np.ptp(force))
    step = float(np.median(np.diff(time))) if time.size > 1 else 0.0
    if step > _SLOWEST:
        faults.append(f"its samples are {step:.3g} s apart: is its time in ms where the header says s?")
    hum = hum_in(time, force)
    if hum is not None:
        force = without_hum(time, force, hum)
        share = 100.0 * hum.amplitude / half
        faults.append(
            f"hum of {hum.amplitude:.3g} N at {hum.frequency:.4g} Hz, {share:.2g} % of half of the force range, was taken out "
            "by a notch at that frequency: look for a loop in the ground of the load cell"
        )
    drift, error = _drift(time, deflection, force)
    if abs(drift) > max(_SURE * error, _DRIFTS * half):
        faults.append(
            f"the zero of the force drifts by {drift:.3g} N over the record, {100.0 * abs(drift) / half:.2g} % of half of the "
            "force range; what is linear of it was taken out: let the load cell warm up"
        )
    play = play_in(time, deflection, force)
    if play is not None:
        faults.append(
            f"behind each reversal the force stands at one value over about {1e3 * play.width:.2g} mm and is stiff before and "
            f"behind it, in {play.strokes} strokes: play (backlash) in the device or its fixture. No law that is fitted here "
            "has a dead zone that goes with the reversal, so that none follows these loops: take up the play and test again"
        )
    lag = None if play else lag_in(time, deflection, force)  # with play they do not turn round together
    named, noise = "", rms_noise(force)
    share = noise / max(half, 1e-300)
    least = max(_SURE * lag.error / lag.period, _LAGS, _HIDDEN * share) if lag else math.nan
    early = max(least, _EARLY * math.sqrt(share), _COARSE * step / lag.period) if lag else math.nan
    if lag is not None and not -early <= lag.delay / lag.period <= least:
        which = "force turns round after" if lag.delay > 0.0 else "force turns round before"
        share, doubt = 100.0 * abs(lag.delay) / lag.period, 100.0 * lag.error / lag.period
        size = f"about {duration_text(abs(lag.delay), 2)}, {share:.2g} +- {max(doubt, 0.01):.1g} % of a cycle"
        cause = "the force channel lags" if lag.delay > 0.0 else "the deflection channel lags, or the device is viscous"
        named = (
            f"the {which} the deflection by {size}: {cause}; the loss factor of the loops is wrong by about "
            f"{2.0 * np.pi * abs(lag.delay) / lag.period:.1g}, and so are the parameters that follow from their tips"
        )
        faults.append(named)
    if noise > _NOISY * half:
        faults.append(
            f"noise of the force is {noise:.3g} N rms, {100.0 * noise / half:.2g} % of half of its range: average more cycles"
        )
    return Checked(faults=faults, least_lag=early, lag=named)


def _drift(time: Array, deflection: Array, force: Array) -> tuple[float, float]:
    """Estimate the drift of the force's zero over the whole record, and its standard error [N].

    Cycles are whole, from turning point to turning point between the samples. Their mean force fades, too, where a device
    forgets how it was loaded before, fastest in large cycles: so the largest ones count, others as far as they agree with them,
    and of a run no more than its later half shows.
    """
    if np.ptp(deflection) == 0.0:
        return 0.0, np.inf
    trace = find_turning_points(deflection, time)
    work = np.concatenate([[0.0], np.cumsum(0.5 * (force[1:] + force[:-1]) * np.diff(time))])
    noise, length, strokes = rms_noise(force), float(np.ptp(time)), trace.strokes
    runs: list[tuple[int, int]] = []  # of like strokes, by turning points; the first and the last stroke are in none
    for index in range(1, strokes.size - 1):
        if runs and abs(strokes[index] - strokes[index - 1]) <= _STROKE_RATIO * strokes[index]:
            runs[-1] = (runs[-1][0], index + 1)
        else:
            runs.append((index, index + 1))

    def line_through(times: Array, values: Array) -> tuple[float, float]:
        """Fit a straight line through values; return its slope and the standard deviation of the values about it."""
        since = times - times.mean()
        slope = float(since @ values / (since @ since))
        residual = values - values.mean() - slope * since
        return slope, float(np.sqrt(residual @ residual / max(values.size - 2, 1)))

    slopes = []
    for first, last in runs:
        begins = trace.times[first : last + 1 : 2]
        if begins.size < _FEWEST_CYCLES:
            continue
        means = np.diff(np.interp(begins, time, work)) / np.diff(begins)
        middles = 0.5 * (begins[1:] + begins[:-1])
        count = np.searchsorted(time, begins[-1]) - np.searchsorted(time, begins[0])
        whole, late = (line_through(middles[part:], means[part:]) for part in (1, max(1, means.size // 2)))
        # Samples err by noise, and where they are few by what lies between them, which shows in the means alone.
        each = max(noise / np.sqrt(count / means.size), whole[1])
        error = each / np.linalg.norm(middles[1:] - middles[1:].mean())
        slope = whole[0]
        if means.size < _FEWEST_CYCLES:  # the rest of two cycles: what they bend by may fade on
            error = float(np.hypot(error, slope - (means[1] - means[0]) / (middles[1] - middles[0])))
        if abs(late[0]) < abs(slope) - _SURE * error:
            slope = late[0] if late[0] * slope > 0.0 else 0.0
        slopes.append((float(np.mean(strokes[first:last])), float(slope), float(error)))
    if not slopes:
        return 0.0, np.inf
    _, largest, error = max(slopes)
    agreeing = [(s, e) for _, s, e in slopes if abs(s - largest) <= _SURE * np.hypot(e, error)]
    weights = np.array([max(e, 1e-100) ** -2.0 for _, e in agreeing])
    mean = float(weights @ [s for s, _ in agreeing] / weights.sum())
    return length * mean, length / float(np.sqrt(weights.sum()))


def checked_file(path: Path) -> Checked:
    """Look for faults in every record of a file, each text beginning with its path; records without a time are not checked."""
    records = [rows for rows in read_rows(path) if rows.time]
    checks = [checked_record(np.array(rows.time), np.array(rows.deflection), np.array(rows.force)) for rows in records]
    lags = [check.least_lag for check in checks if not math.isnan(check.least_lag)]
    # a channel that lags does so in every test of a file; what one alone shows is a bend of the device
    unsure = any(not check.lag and not math.isnan(check.least_lag) for check in checks)
    faults = [f"{path}: {text}" for check in checks for text in check.faults if not (unsure and text == check.lag)]
    return Checked(faults=faults, least_lag=max(lags, default=math.nan))
