"""What `wirerope frf` says with its default options, beside settled sines of a simulation: shipped models and random floors.

    python tests/frf_settled.py floating_floor --levels 0.5 1 3 --axes x y z
    python tests/frf_settled.py random --floors 10 --seed 1

A simulation steps from rest through sines about the peak, upwards and downwards, and through the whole range; of every fold
that is called one, two motions on either side of a jump are left to themselves and must stay apart.
"""

import argparse
import time
import warnings
from dataclasses import dataclass
from pathlib import Path

import numpy as np
from house import deck, mjcf

import wirerope_mj as wr
from wirerope_mj.dynamics.frequency_response import ResponseOptions, frequency_response
from wirerope_mj.dynamics.frequency_response.summary import curve_of, peaks_of
from wirerope_mj.dynamics.periodic.branch import ALIKE
from wirerope_mj.mounts.vendor_parts.parts import vendor_parts

# Sines about the peak, over its frequency; and sines over the whole range.
ABOUT, OVER = np.arange(-2, 3) * 0.01 + 1.0, 15
BESIDE = 2e-3  # distance from a fold, over its frequency, at which both motions are left to themselves
SETTLED = 300  # cycles of these, and of the sines over the whole range at the most


@dataclass(frozen=True)
class Compared:
    """A branch at one level beside settled sines: peaks [Hz], [m/s^2], and what is said of folds."""

    at: float
    peak: float
    settled_at: float
    settled: float  # largest of the settled sines
    same: float  # amplitude at the branch's own peak over that of the settled sine there, less one
    elsewhere: float  # largest relative difference to the nearest stable motion over the range
    elsewhere_at: float  # frequency of it [Hz]
    at_edge: bool
    called: int  # folds that are called jumps
    confirmed: int
    uncalled: int  # folds whose motions are within 1 %
    side: float  # largest difference of the motions of a side branch, 0 without any
    unstable: int
    points: int
    gaps: int
    ended: str  # why it ended early, empty if it reached the end of the range
    seconds: float  # of processor time for the branch

    @property
    def held(self) -> bool:
        """True if the peak is that of the settled sines within 1 %, in frequency and height, and nothing is said in vain."""
        near = abs(self.same) < ALIKE and abs(self.settled / self.peak - 1.0) < ALIKE
        return near and abs(self.settled_at / self.at - 1.0) < ALIKE and self.confirmed == self.called and not self.ended

    @property
    def text(self) -> str:
        """The row of the table."""
        return (
            f"{self.at:.4f} {self.peak:.5g}{' edge' if self.at_edge else ''} | {self.settled_at:.4f} {self.settled:.5g} | "
            f"{100 * self.same:+.3f} % {100 * self.elsewhere:.2f} % at {self.elsewhere_at:.4g} | {self.called}/"
            f"{self.confirmed}/{self.uncalled} side {100 * self.side:.2g} % unstable {self.unstable}/{self.points} "
            f"gaps {self.gaps}{self.ended} {self.seconds:.0f} s {'' if self.held else 'OFF'}"
        )


def compared(system, axis, level, keep):
    """Follow a branch with the default options, kept in a folder if one is given, and settle beside it."""
    begun = time.process_time()
    result = frequency_response(system, ResponseOptions(accelerations=(level,), direction=axis), keep=keep)
    seconds, (branch,) = time.process_time() - begun, result.branches
    top = peaks_of(branch)[0]
    shake = {"acceleration": level, "direction": axis, "payload": branch.payload}
    low, high = branch.frequency.min(), branch.frequency.max()
    about = np.unique(np.clip(top.frequency * ABOUT, low, high))
    ways = [wr.stepped_sine(system, frequencies=f, **shake) for f in (about, about[::-1])]
    settled, settled_at = max(vertex(way.frequency, way.amplitude) for way in ways)
    there = np.array([way.amplitude[np.argmin(np.abs(way.frequency - top.frequency))] for way in ways])
    wide = wr.stepped_sine(system, frequencies=np.geomspace(low, high, OVER), settled=1e-3, largest_cycles=SETTLED, **shake)
    curve = curve_of(branch)
    nearest = np.nanmin(
        [
            np.where(s & wide.settled, np.abs(wide.amplitude / a - 1.0), np.nan)
            for a, s in curve.amplitudes_at(wide.frequency)
        ], axis=0,
    )  # fmt: skip
    worst = int(np.nanargmax(nearest)) if wide.settled.any() else 0  # beside a slow mode that rings on none settles
    return Compared(
        at=top.frequency, peak=top.amplitude, settled_at=settled_at, settled=settled,
        same=float(min(top.amplitude / there - 1.0, key=abs)), elsewhere=float(nearest[worst]),
        elsewhere_at=float(wide.frequency[worst]), at_edge=top.at_edge,
        called=len(branch.jumps), confirmed=sum(is_jump(system, branch, jump) for jump in branch.jumps),
        uncalled=len(branch.folds) - len(branch.jumps), unstable=int((~branch.stable).sum()), points=branch.stable.size,
        side=max((side.difference for side in branch.side_branches), default=0.0), gaps=len(branch.gaps),
        ended="" if result.complete or branch.beyond_travel else f" ENDED EARLY: {branch.message}", seconds=seconds,
    )  # fmt: skip


def vertex(frequency, amplitude):
    """Return the top of the parabola through the highest of some sines and both beside it, that of the highest at an end."""
    i = int(np.argmax(amplitude))
    if i in (0, frequency.size - 1):
        return float(amplitude[i]), float(frequency[i])
    order = slice(i - 1, i + 2)
    slope, curvature = np.polyfit(frequency[order] / frequency[i] - 1.0, amplitude[order], 2)[1::-1]
    return float(amplitude[i]), float(frequency[i] * (1.0 + np.clip(-0.5 * slope / curvature, -0.01, 0.01)))


def is_jump(system, branch, jump):
    """Say whether two motions beside a fold, left to themselves, stay more than 1 % apart."""
    inside = jump.parameter * (1.0 - BESIDE * (1.0 if jump.rising else -1.0))
    f, seen = branch.frequency, []
    for i in np.flatnonzero((f[:-1] - inside) * (f[1:] - inside) <= 0.0):
        near = i if abs(f[i] / inside - 1.0) < abs(f[i + 1] / inside - 1.0) else i + 1
        settled = wr.stepped_sine(
            system, frequencies=[inside], acceleration=float(branch.acceleration[0]), direction=branch.direction,
            payload=branch.payload, initial=branch.orbit(near).state, largest_cycles=SETTLED,
        )  # fmt: skip
        seen.append(float(settled.amplitude[0]))
    return bool(seen) and max(seen) / min(seen) - 1.0 > ALIKE


def random_floor(seed):
    """Return a floor of 8 to 24 mounts of one part of the catalogue, with three masses that stand off its centre."""
    rng = np.random.default_rng(seed)
    while True:
        part = str(rng.choice([part.name for part in vendor_parts()]))
        try:
            isolator = wr.load_isolator(part)
        except (wr.ModelError, wr.ConvergenceError):
            continue
        if isolator.limits.static_load and all(law is not None for law in isolator.axes.values()):
            break
    across, along = 2 * int(rng.integers(1, 3)), int(rng.integers(4, 7))
    mounts, height = across * along, isolator.geometry.height or 0.1
    length, width = 0.8 * along, 0.9 * across
    mass = mounts * isolator.limits.static_load * float(rng.uniform(0.4, 0.85)) / wr.STANDARD_GRAVITY
    spots = [(x, y) for x in np.linspace(-0.5, 0.5, along) * length for y in np.linspace(-0.5, 0.5, across) * width]
    sites = {f"b{i}": f'pos="{x} {y} {height / 2}"' for i, (x, y) in enumerate(spots)}
    plate = f'<geom type="box" size="{length / 2} {width / 2} .05" mass="{0.5 * mass}"/>'
    for share in rng.dirichlet([3.0, 3.0, 3.0]):
        x, y, z = rng.uniform([-0.3 * length, -0.3 * width, 0.2], [0.3 * length, 0.3 * width, 0.7])
        plate += f'<geom type="box" pos="{x} {y} {z}" size=".3 .3 {z}" mass="{0.5 * share * mass}"/>'
    points = "".join(f'<site name="p{i}" pos="{x} {y} {-0.1}"/>' for i, (x, y) in enumerate(spots))
    world = deck(sites) + f'<body name="floor" pos="0 0 {height / 2 + 0.1}"><freejoint/>{plate}{points}</body>'
    named = [(f"m{i}", f"p{i}", f"b{i}", "a") for i in range(mounts)]
    text = mjcf(world, named, gravity=wr.STANDARD_GRAVITY)
    return f"{seed}: {mounts} x {part}", wr.load_system(text, isolators={"a": isolator})


def main():
    """Print a row for every model, axis and level, and what holds."""
    parser = argparse.ArgumentParser(description=__doc__.split("\n")[0])
    parser.add_argument("models", nargs="+", help="names of shipped models, or random")
    parser.add_argument("--levels", nargs="+", type=float, default=[0.5, 1.0, 3.0])
    parser.add_argument("--axes", nargs="+", default=list("xyz"))
    parser.add_argument("--floors", type=int, default=10)
    parser.add_argument("--seed", type=int, default=1, help="of the first random floor")
    parser.add_argument("--keep", type=Path, help="folder that keeps the points of the branches: what was interrupted goes on")
    asked, found = parser.parse_args(), []
    warnings.simplefilter("ignore")
    print("model, axis, level | frf Hz, m/s2 | settled Hz, m/s2 | at the peak, over the range | folds called/confirmed/other")
    for name in asked.models:
        seeds = range(asked.seed, asked.seed + asked.floors)
        for title, system in [random_floor(seed) for seed in seeds] if name == "random" else [(name, wr.load_system(name))]:
            for axis in asked.axes:
                for level in asked.levels:
                    try:
                        keep = asked.keep / f"{name}-{title.split(':')[0]}-{axis}" if asked.keep else None
                        row = compared(system, axis, level, keep)
                    except (ValueError, wr.ModelError, wr.ConvergenceError, wr.SimulationError) as error:
                        print(f"{title} {axis} {level:g} | {type(error).__name__}: {error}", flush=True)
                        continue
                    found.append(row)
                    print(f"{title} {axis} {level:g} | {row.text}", flush=True)
    print(
        f"{sum(row.held for row in found)} of {len(found)} held; folds {sum(r.called for r in found)} called, "
        f"{sum(r.confirmed for r in found)} confirmed; {sum(bool(r.ended) for r in found)} ended early"
    )


if __name__ == "__main__":
    main()
