"""Summary of a frequency response, level by level: resonance peaks, sweeps against branches, orders of a machine's speed."""

import math
from collections.abc import Iterator, Sequence
from dataclasses import asdict, dataclass
from functools import cached_property

import numpy as np
import scipy

from wirerope_mj.dynamics.frequency_response.result import FrequencyResponse, Level
from wirerope_mj.dynamics.periodic import Branch, HarmonicContent, harmonic_content, resonances
from wirerope_mj.dynamics.sweep import FrequencySweep
from wirerope_mj.engine.response import Response
from wirerope_mj.foundation.arguments import positive
from wirerope_mj.foundation.arrays import Array, Booleans, Entries, Integers
from wirerope_mj.foundation.summary import json_values
from wirerope_mj.motions.spectra.psd import isolation_frequency

BETWEEN = 16  # intervals between two neighbouring points: at steps of 2 % in frequency, an eighth of a percent apart
FRACTIONS = (0.35, 0.7)  # fractions of the highest amplitude at which motions are shown on either side of it


@dataclass(frozen=True, kw_only=True)
class BranchCurve:
    """A fine curve of amplitude over frequency, interpolated between the points of a branch in their order."""

    frequency: Array  # [Hz], (n,)
    amplitude: Array  # of the payload [m/s^2], (n,)
    stable: Booleans  # whether the branch's points on either side are stable, (n,)
    point: Array  # position in the branch, an integer at its points, (n,)

    @cached_property
    def runs(self) -> list[slice]:
        """Segments of the curve, as rows, over which the frequency rises or falls throughout."""
        turned = np.flatnonzero(np.diff(np.sign(np.diff(self.frequency))) != 0.0) + 1
        ends = [0, *turned.tolist(), self.frequency.size - 1]
        return [slice(a, b + 1) for a, b in zip(ends[:-1], ends[1:], strict=True) if b > a]

    def amplitudes_at(self, frequency: Array) -> list[tuple[Array, Booleans]]:
        """Interpolate amplitude and stability at frequencies [Hz], (m,), on each of `runs`; NaN beyond its ends."""
        branches = []
        for run in self.runs:
            f, a, s = self.frequency[run], self.amplitude[run], self.stable[run]
            order = slice(None, None, 1 if f[-1] > f[0] else -1)
            f, a, s = f[order], a[order], s[order]
            values = np.interp(frequency, f, a, left=np.nan, right=np.nan)
            branches.append((values, s[np.clip(np.searchsorted(f, frequency), 0, f.size - 1)]))
        return branches


def curve_of(branch: Branch) -> BranchCurve:
    """Interpolate amplitude over frequency between the points of a branch.

    Akima's spline in the length along the branch, of frequency and amplitude in logarithms: it does not ring at the kinks
    that the payload's largest acceleration has where another crest becomes the highest.
    """
    f, a = np.log(branch.frequency), np.log(branch.amplitude)
    steps = relative_steps(f, a)
    kept = np.concatenate([[True], steps > 1e-9])  # a point that was located may coincide with the next
    f, a, point = f[kept], a[kept], np.flatnonzero(kept).astype(np.float64)
    if f.size < 3:
        return BranchCurve(frequency=np.exp(f), amplitude=np.exp(a), stable=branch.stable[kept], point=point)
    along = np.concatenate([[0.0], np.cumsum(relative_steps(f, a))])
    fraction = np.arange(BETWEEN) / BETWEEN
    fine = np.append((along[:-1, None] + np.diff(along)[:, None] * fraction).ravel(), along[-1])
    position = np.interp(fine, along, point)
    stable = branch.stable[np.floor(position).astype(int)] & branch.stable[np.ceil(position).astype(int)]
    frequency, amplitude = (np.exp(scipy.interpolate.Akima1DInterpolator(along, values)(fine)) for values in (f, a))
    return BranchCurve(frequency=frequency, amplitude=amplitude, stable=stable, point=position)


def relative_steps(f: Array, a: Array) -> Array:
    """Compute the distances between successive points (f, a), each coordinate over its range, (n - 1,)."""
    return np.hypot(np.diff(f) / (float(np.ptp(f)) or 1.0), np.diff(a) / (float(np.ptp(a)) or 1.0))


def along_resonance(branch: Branch) -> list[int]:
    """Choose points of a branch over its resonance: at its highest amplitude, and at fractions of it on either side.

    The order is that along the branch, so that behind a fold the motions which no sweep reaches are among them.
    """
    amplitude, top = branch.amplitude, branch.peak
    before, after = [], []
    for fraction in FRACTIONS:
        lower = np.flatnonzero(amplitude <= fraction * amplitude[top])
        before += [int(lower[lower < top][-1])] if (lower < top).any() else []
        after += [int(lower[lower > top][0])] if (lower > top).any() else []
    return sorted({*before, top, *after})


def along_branch(branch: Branch, curve: BranchCurve, count: int) -> Integers:
    """Choose `count` points of a branch in its order, equally far from each other along the curve, the highest among them.

    The length is that in a picture on logarithmic axes whose height is its width: most of it lies in the resonance. A branch
    with fewer points has some of them several times.
    """
    f, a = np.log(curve.frequency), np.log(curve.amplitude)
    along = np.concatenate([[0.0], np.cumsum(relative_steps(f, a))])
    positions = np.interp(np.linspace(0.0, along[-1], count), along, curve.point)
    points = np.round(positions).astype(np.int64)
    points[np.abs(points - branch.peak).argmin()] = branch.peak
    return points


def busiest_loops(response: Response) -> list[tuple[str, int]]:
    """Rank force-deflection loops by work per period, the most first: names of mounts, and axes (0 roll, 1 shear, 2 axial).

    In vibration the work shows which mounts move: the utilisation of the rated travel is mostly that of the sag.
    """
    work = {}
    for name, mount in response.mounts.items():
        for axis in range(3):
            force, steps = mount.force[:, axis], np.diff(mount.deflection[:, axis])
            if force.any():
                work[name, axis] = abs(float(np.sum(0.5 * (force[1:] + force[:-1]) * steps)))
    return sorted(work, key=lambda loop: work[loop], reverse=True)


HARMONICS = 9  # highest harmonic of a motion that is evaluated
# Orders n whose harmonic is searched for near 1/n of the peak's frequency: the whole amplitude may have no peak there.
ORDERS, NEAR = (2, 3), 0.15
SEEN = 0.01  # least ratio of that harmonic to the fundamental that is listed; a step may pass its narrow top
AWAY = 0.05  # relative distance from a fold within which a sweep jumps and is not compared
FASTEST = 1e6  # highest speed of a shaft [1/min], and highest order: ten times those of real machines


@dataclass(frozen=True, kw_only=True)
class ResonancePeak:
    """A peak of the amplitude over frequency."""

    frequency: float  # [Hz]
    amplitude: float  # [m/s^2]
    transmissibility: float  # amplitude over the base's acceleration
    point: int  # nearest point of the branch
    at_edge: bool  # whether it is not a peak but the end of the branch
    # order of the largest harmonic of the payload's acceleration other than the fundamental; below 1 for a subharmonic
    order: float
    harmonic: str  # its name
    share: float  # its amplitude over that of the fundamental


def peaks_of(branch: Branch) -> list[ResonancePeak]:
    """List the peaks of a branch, the highest (or the end of the branch, if that is higher) first, then by frequency."""
    points = [(peak.index, peak.frequency, peak.amplitude, False) for peak in resonances(branch)]
    top = branch.peak
    if top not in [index for index, *_ in points]:
        at_edge = top in (0, branch.frequency.size - 1)
        points.append((top, float(branch.frequency[top]), float(branch.amplitude[top]), at_edge))
    first, listed = max(points, key=lambda point: point[2]), [frequency for _, frequency, *_ in points]
    for order in ORDERS if not first[3] else ():  # superharmonics below the highest peak: where harmonic 2 or 3 is largest
        near = np.flatnonzero(np.abs(branch.frequency * order / first[1] - 1.0) < NEAR)
        near = near[(near > 0) & (near < branch.frequency.size - 1)]
        if any(abs(frequency * order / first[1] - 1.0) < NEAR for frequency in listed) or near.size < 3:
            continue
        contents = [_content(branch, int(point)) for point in near]
        most = int(np.argmax([content.of(order) for content in contents]))
        if 0 < most < near.size - 1 and contents[most].of(order) > SEEN * contents[most].of(1):
            top = int(near[most])
            points.append((top, float(branch.frequency[top]), float(branch.amplitude[top]), False))
    peaks = []
    rest = sorted((point for point in points if point is not first), key=lambda point: point[1])
    for point, frequency, amplitude, at_edge in (first, *rest):
        content = _content(branch, point)
        overtones = [i for i, order in enumerate(content.order) if order not in (0, 1)]
        largest = overtones[int(np.argmax(content.amplitude[overtones]))]
        peaks.append(
            ResonancePeak(
                frequency=frequency, amplitude=amplitude, point=point, at_edge=at_edge,
                transmissibility=amplitude / abs(float(branch.acceleration[point])),
                order=float(content.order[largest]), harmonic=content.names[largest],
                share=float(content.amplitude[largest]) / max(content.of(1), 1e-300),
            )
        )  # fmt: skip
    return peaks


def _content(branch: Branch, point: int) -> HarmonicContent:
    along = branch.response_direction
    return harmonic_content(branch.orbit(point), payload=branch.payload, direction=along, highest=HARMONICS)


@dataclass(frozen=True, kw_only=True)
class SweepJump:
    """A jump of a sweep near a fold."""

    fold: float  # frequency of the fold [Hz]
    frequency: float  # at which the sweep changes most steeply near it [Hz]
    amplitude: float  # of the sweep there [m/s^2]

    @property
    def past_fold(self) -> float:
        """Distance of the jump beyond the fold, relative to the fold's frequency [-]."""
        return self.frequency / self.fold - 1.0


@dataclass(frozen=True, kw_only=True)
class SweepComparison:
    """A sweep's envelope against the stable motions of a branch, away from jumps."""

    largest: float  # largest difference relative to the branch; NaN if nothing can be compared
    at: float  # frequency of the largest difference [Hz]
    median: float  # median of the relative differences
    peak_frequency: float  # frequency of the envelope's peak [Hz]
    peak: float  # peak of the envelope [m/s^2]
    jumps: tuple[SweepJump, ...]  # one for every fold that the sweep passes in the direction in which it jumps


def compare(sweep: FrequencySweep, branch: Branch | None, curve: BranchCurve | None) -> SweepComparison:
    """Compare a sweep with the nearest stable motion of a branch, if there is one, away from folds, where it jumps."""
    f, a = sweep.frequency, sweep.amplitude
    top, jumps, differences = int(np.argmax(a)), [], np.full(f.size, np.inf)
    if branch is not None and curve is not None:
        for amplitude, stable in curve.amplitudes_at(f):
            differences = np.fmin(differences, np.where(stable, np.abs(a / amplitude - 1.0), np.nan))
        for fold in branch.folds:
            differences[np.abs(f / fold.frequency - 1.0) < AWAY] = np.nan
    for jump in branch.jumps if branch is not None else ():
        near = np.flatnonzero(np.abs(f[:-1] / jump.parameter - 1.0) < AWAY)
        if jump.rising == bool(f[-1] > f[0]) and near.size:
            steepest = near[np.argmax(np.abs(np.diff(np.log(a)))[near])]
            jumps.append(SweepJump(fold=jump.parameter, frequency=float(f[steepest]), amplitude=float(a[steepest])))
    known = np.flatnonzero(np.isfinite(differences))
    most, at, median = math.nan, math.nan, math.nan
    if known.size:
        largest = int(known[np.argmax(differences[known])])
        most, at, median = float(differences[largest]), float(f[largest]), float(np.median(differences[known]))
    return SweepComparison(
        largest=most, at=at, median=median, peak_frequency=float(f[top]), peak=float(a[top]), jumps=tuple(jumps)
    )


@dataclass(frozen=True, kw_only=True)
class LevelSummary:
    """Curve, peaks and comparisons at one level of the base's acceleration, each computed at first use."""

    level: Level

    @cached_property
    def curve(self) -> BranchCurve | None:
        return None if self.level.branch is None else curve_of(self.level.branch)

    @cached_property
    def peaks(self) -> list[ResonancePeak]:
        return [] if self.level.branch is None else peaks_of(self.level.branch)

    @cached_property
    def _transmissibilities(self) -> list[tuple[Array, Array]]:
        """Frequency [Hz] and transmissibility along the branch, else along each sweep, (n,); empty for an unfinished branch."""
        if self.level.branch is None or self.curve is None:
            return [(sweep.frequency, sweep.transmissibility) for sweep in self.level.sweeps.values()]
        if not self.level.branch.complete:
            return []
        return [(self.curve.frequency, self.curve.amplitude / self.level.acceleration)]

    @cached_property
    def isolation(self) -> float:
        """Frequency above which the transmissibility stays below 1 [Hz]; NaN if it does not within the range, or always."""
        return max((isolation_frequency(*path) for path in self._transmissibilities), default=math.nan)

    @property
    def isolation_text(self) -> str:
        """Clause on the frequency above which the payload is isolated, or on why there is none."""
        if math.isfinite(self.isolation):
            return f"isolates from {self.isolation:.4g} Hz on"
        if not self._transmissibilities:
            return "isolation is not told, the branch being unfinished"
        if all(float(ratio.max()) < 1.0 for _, ratio in self._transmissibilities):
            return "isolates throughout the range"
        return "transmissibility does not fall below 1 within the range"

    @cached_property
    def comparisons(self) -> dict[str, SweepComparison]:
        return {name: compare(sweep, self.level.branch, self.curve) for name, sweep in self.level.sweeps.items()}


def level_summaries(result: FrequencyResponse) -> list[LevelSummary]:
    return [LevelSummary(level=level) for level in result.levels]


def plain_summary(summary: LevelSummary) -> Entries:
    """Write a level's summary as plain values, SI units, None for values that are not finite."""
    level, branch = summary.level, summary.level.branch
    content: Entries = {"acceleration": level.acceleration, "isolation_frequency": summary.isolation}
    if branch is not None:
        content["continuation"] = {
            "points": int(branch.frequency.size), "complete": branch.complete, "message": branch.message,
            "model_steps": branch.model_steps, "seconds": round(level.branch_seconds, 3),
            "peaks": [asdict(peak) for peak in summary.peaks],
            "bifurcations": [
                {
                    "kind": event.kind, "frequency": event.frequency, "amplitude": event.amplitude,
                    "multiplier": [event.multiplier.real, event.multiplier.imag],
                    "unstable_before": event.before, "unstable_after": event.after,
                }
                for event in branch.bifurcations
            ],
            "jumps": [asdict(jump) for jump in branch.jumps],
            "side_branches": [asdict(side) for side in branch.side_branches],
        }  # fmt: skip
    for direction, sweep in level.sweeps.items():
        content[f"sweep_{direction}"] = asdict(summary.comparisons[direction]) | {
            "jumps": [[jump.fold, jump.frequency] for jump in summary.comparisons[direction].jumps],
            "cycles": int(sweep.frequency.size), "model_steps": sweep.model_steps, "warnings": list(sweep.warnings),
        }  # fmt: skip
    if level.sweeps:
        content["sweep_seconds"] = round(level.sweep_seconds, 3)
    plain: Entries = json_values(content)
    return plain


@dataclass(frozen=True, kw_only=True)
class OrderBand:
    """Frequencies [Hz] of an order between the lowest and the highest speed of a shaft."""

    order: float
    low: float
    high: float

    @property
    def label(self) -> str:
        return f"order {self.order:g}"


def order_bands(orders: Sequence[float], speed_rpm: Sequence[float]) -> tuple[OrderBand, ...]:
    """Compute frequency bands of a shaft's orders at a speed [1/min] or between two; ValueError for more speeds, or <= 0."""
    if len(speed_rpm) not in (1, 2):
        raise ValueError(f"`--speed-rpm` takes one speed or two, the lowest and the highest, got {len(speed_rpm)}.")
    speeds = sorted(_checked_limit("--speed-rpm", speed) / 60.0 for speed in speed_rpm)
    return tuple(
        OrderBand(order=_checked_limit("--orders", order), low=order * speeds[0], high=order * speeds[-1]) for order in orders
    )


def _checked_limit(name: str, value: float) -> float:
    if positive(name, value) > FASTEST:
        raise ValueError(f"`{name}` must be at most {FASTEST:g}, got {value!r}.")
    return float(value)


def order_statements(bands: Sequence[OrderBand], findings: Sequence[LevelSummary]) -> Iterator[str]:
    """Describe for every band the resonance peaks that lie in it."""
    for band in bands:
        inside = [
            f"{peak.frequency:.2f} Hz at {summary.level.acceleration:.4g} m/s²"
            for summary in findings
            for peak in summary.peaks
            if band.low <= peak.frequency <= band.high and not peak.at_edge
        ]
        span = f"{band.low:.4g} Hz" if band.low == band.high else f"{band.low:.4g} to {band.high:.4g} Hz"
        yield f"{band.label.capitalize()}, {span}: " + (f"resonance at {', '.join(inside)}." if inside else "no resonance.")
