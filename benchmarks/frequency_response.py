"""Cost of a resonance curve: a branch of periodic motions against sweeps that are slow enough to agree with it.

    python benchmarks/frequency_response.py one floor

A curve of about 200 points is followed by `follow_branch`, and a finer one of six times as many, which is not counted, as what
the truth is held to be. Then the same system is swept up and down, at half the rate each time, until both envelopes lie within
0.5 % of the truth everywhere (there are no jumps at these levels), and the model steps of the two sweeps are counted: they
begin on the branch and need no steady lead-in; choosing their step is not counted. Both use the accuracy 1e-4.
"""

import argparse
import time
from typing import NamedTuple

import numpy as np
from scipy.interpolate import PchipInterpolator

import wirerope_mj as wr
from wirerope_mj.foundation.resources import models_folder

AGREEMENT = 5e-3
SLOWEST = 1.0 / 32.0  # octaves per minute


class Case(NamedTuple):
    """A curve: model, payload, range [Hz], level [m/s^2], direction and the step that gives about 200 points."""

    model: str
    payload: str
    start: float
    stop: float
    acceleration: float
    direction: str
    largest_step: float
    first_rate: float


CASES = {
    "one": Case("sdof_shaker", "mass", 15.0, 60.0, 4.903325, "z", 0.008, 1.0),
    "floor": Case("floating_floor", "floor", 4.0, 16.0, 1.0, "z", 0.012, 1.0),
}


def main() -> None:
    """Print a table for every case that is asked for."""
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("cases", nargs="*", default=list(CASES), help=f"of {', '.join(CASES)}")
    for name in parser.parse_args().cases:
        measure(name, CASES[name])


def measure(name: str, case: Case) -> None:
    """Print steps and seconds of the branch and of slower and slower sweeps."""
    system = wr.load_system(models_folder() / f"{case.model}.xml")
    wr.periodic_orbit(system, frequency=case.stop, acceleration=case.acceleration, direction=case.direction)  # compiles
    seconds, branch = timed_branch(system, case, case.largest_step)
    _, fine = timed_branch(system, case, case.largest_step / 6.0)
    curve, own = (PchipInterpolator(np.log(b.frequency), b.amplitude) for b in (fine, branch))
    apart = np.abs(own(np.log(fine.frequency)) / fine.amplitude - 1.0)
    points = branch.frequency.size
    print(f"\n{name}: {case.model}, {case.start:g} to {case.stop:g} Hz, {case.acceleration:g} m/s^2 along {case.direction}")
    print(f"{'':>24}{'model steps':>14}{'seconds':>10}{'worst':>10}{'99 %':>10}{'steps / branch':>16}")
    between = f"{apart.max():10.2%}{np.quantile(apart, 0.99):10.2%}"
    print(f"{f'branch, {points} points':>24}{branch.model_steps:14d}{seconds:10.1f}{between}", flush=True)
    rate = case.first_rate
    while rate >= SLOWEST:
        steps, seconds, differences = swept(system, case, branch, curve, rate)
        worst, most = differences.max(), np.quantile(differences, 0.99)
        ratio = steps / branch.model_steps
        print(f"{f'{rate:g} octaves/min':>24}{steps:14d}{seconds:10.1f}{worst:10.2%}{most:10.2%}{ratio:16.1f}", flush=True)
        if worst <= AGREEMENT:
            break
        rate /= 2.0


def timed_branch(system: wr.System, case: Case, largest_step: float) -> tuple[float, wr.Branch]:
    """Return seconds and the branch of a case."""
    begin = time.perf_counter()
    branch = wr.follow_branch(
        system, start=case.start, stop=case.stop, acceleration=case.acceleration, direction=case.direction,
        payload=case.payload, largest_step=largest_step,
    )  # fmt: skip
    return time.perf_counter() - begin, branch


def swept(
    system: wr.System, case: Case, branch: wr.Branch, curve: PchipInterpolator, rate: float
) -> tuple[int, float, np.ndarray]:
    """Return model steps, seconds, and the relative differences from the curve of a sweep up and one down."""
    steps, seconds, differences = 0, 0.0, []
    ends = [(case.start, case.stop, branch.orbit(0).state), (case.stop, case.start, branch.orbit(-1).state)]
    for start, stop, state in ends:
        sweep = wr.Sweep(start=start, stop=stop, rate=rate, acceleration=case.acceleration, direction=case.direction)
        begin = time.perf_counter()
        found = wr.frequency_sweep(system, sweep, payload=case.payload, initial=state, settled=None)
        seconds += time.perf_counter() - begin
        steps += found.model_steps
        differences.append(np.abs(found.amplitude / curve(np.log(found.frequency)) - 1.0))
    return steps, seconds, np.concatenate(differences)


if __name__ == "__main__":
    main()
