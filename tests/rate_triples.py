"""Random triples of motion, sample rate and duration: what is judged, damaged and held against runs at 10 kHz.

python tests/rate_triples.py 200 --seed 1
"""

import argparse
import warnings
from dataclasses import dataclass, field
from functools import cache

import numpy as np

import wirerope_mj as wr
from wirerope_mj.assessment.criteria import judge
from wirerope_mj.assessment.durability import mount_cycles
from wirerope_mj.assessment.durability.mission import DAMAGE_ERROR, NEGLIGIBLE
from wirerope_mj.engine.simulation.run import aliasing
from wirerope_mj.foundation.units import STANDARD_GRAVITY
from wirerope_mj.motions.spectra.srs import resolved_frequency

FINE, WHOLE = 10_000.0, 1.2  # rate [Hz] and duration [s] of the run that others are compared with
SYSTEMS = ("shock_table", "sdof_shaker", "cabinet", "floating_floor")
EXPONENT = 5.0


@dataclass
class Found:
    """What the runs of some triples hold: how many figures were compared, and those that are off by more than 1 %.

    Attributes:
        rows, damages, lines: verdicts, damages of mounts' axes and lines of spectra that both runs state.
        wrong: texts on those that are off.
        worst: largest error of a line that is held.
    """

    rows: int = 0
    damages: int = 0
    lines: int = 0
    wrong: list[str] = field(default_factory=list)
    worst: float = 0.0


@cache
def system(name):
    """Return a system that ships, loaded once."""
    return wr.load_system(name)


def drawn(seed):
    """Return the name of a system, a motion, a sample rate [Hz] and a duration [s] by a seed."""
    rng = np.random.default_rng(seed)
    name = str(rng.choice(SYSTEMS))
    axis = str(rng.choice(list("xyz"))) if name in SYSTEMS[2:] else "z"
    peak, length, start = float(rng.uniform(1, 15)) * STANDARD_GRAVITY, float(rng.uniform(3e-3, 30e-3)), 0.01
    pulse = {"peak": peak, "duration": length, "direction": axis, "start": start + float(rng.uniform(0.0, 0.05))}
    frequency = float(np.exp(rng.uniform(np.log(3.0), np.log(200.0))))
    motions = (
        wr.HalfSine(**pulse),
        wr.Sawtooth(**pulse),
        wr.Trapezoid(**pulse, rise=0.1 * length),
        wr.RandomVibration(
            psd=[(5.0, 0.5), (2.0 * frequency + 20.0, 0.5)], duration=1.0, direction=axis, seed=seed, rise=0.2, fall=0.2
        ),
        wr.Sine(frequency=frequency, acceleration=0.1 * peak, direction=axis),
        wr.Sweep(start=5.0, stop=60.0, rate=240.0, acceleration=2.0, direction=axis),
    )
    rate = float(np.exp(rng.uniform(np.log(5.0), np.log(FINE))))
    samples = max(2, round(float(rng.uniform(0.3, 1.0)) * WHOLE * rate))  # so that all runs end with the same swing
    return name, motions[int(rng.integers(len(motions)))], rate, samples / rate


def compare(seed, found):
    """Add to `found` what a triple's run states beside what one at 10 kHz does, as long for spectra, longer for verdicts."""
    name, motion, rate, duration = drawn(seed)
    with warnings.catch_warnings(action="ignore"):  # of aliasing, and of what is struck: peaks are those of every step
        step = wr.simulate(system(name), motion, duration=WHOLE, sample_rate=FINE, accuracy=1e-3)
        same = {"timestep": step.timestep, "corners": [duration]}
        run = wr.simulate(system(name), motion, duration=duration, sample_rate=rate, **same)
        fine = wr.simulate(system(name), motion, duration=duration, sample_rate=FINE, **same)
    where = f"seed {seed}, {name}, {motion.description}, {rate:.4g} Hz, {duration:.3g} s"
    for row, true in zip(judge(run), judge(step), strict=True):
        if row.utilisation is None or true.utilisation is None:
            continue
        found.rows += 1
        if row.verdict != true.verdict or abs(row.utilisation - true.utilisation) > 0.01 * max(true.utilisation, 1.0):
            found.wrong.append(f"{where}: {row.criterion} of {row.subject} {row.utilisation:.4g}, {true.utilisation:.4g}")
    cycles = [{(one.mount, one.axis): one for one in mount_cycles(each)} for each in (run, fine)]
    most = max((one.cycles.damage(EXPONENT) for one in cycles[1].values()), default=0.0)
    for key, one in cycles[0].items():
        damage, true = one.cycles.damage(EXPONENT), cycles[1][key].cycles.damage(EXPONENT)
        if one.damage_error(EXPONENT) > DAMAGE_ERROR or true < NEGLIGIBLE * most:
            continue
        found.damages += 1
        if abs(damage / true - 1.0) > 0.01:
            found.wrong.append(f"{where}: damage of {key} {damage:.4g}, {true:.4g}")
    for body in () if aliasing([motion], rate) else run.bodies:  # of those a run says that its samples hold no line
        _lines(
            run.time,
            run.bodies[body].acceleration,
            fine.time,
            fine.bodies[body].acceleration,
            f"{where}: {body}",
            found,
        )


def _lines(time, acceleration, fine_time, fine_acceleration, where, found):
    """Compare the lines of a spectrum that the samples hold."""
    even = int(np.flatnonzero(np.abs(np.diff(time) - (time[1] - time[0])) < 1e-6 * time[1])[-1]) + 2  # to the last whole step
    rate = 1.0 / (time[1] - time[0])
    if even < 7 or rate < 12.0:
        return
    lines = np.geomspace(1.0, 0.1 * rate, 40)
    own = wr.shock_response_spectrum(time[:even], acceleration[:even], lines)
    until = int(np.searchsorted(fine_time, time[even - 1] + 1e-9))
    true = wr.shock_response_spectrum(fine_time[:until], fine_acceleration[:until], lines).maximax
    stated = (lines <= resolved_frequency(time[:even], acceleration[:even], own))[:, np.newaxis] & (
        true > 1e-6 * true.max(initial=1e-12)
    )
    errors = np.abs(own.maximax[stated] / true[stated] - 1.0)
    found.lines += errors.size
    found.worst = max(found.worst, float(errors.max(initial=0.0)))
    if (errors > 0.01).any():
        found.wrong.append(f"{where}: {int((errors > 0.01).sum())} lines off, worst {100.0 * errors.max():.2g} %")


def main():
    """Compare as many triples as are asked for and print what was found."""
    parser = argparse.ArgumentParser(description=__doc__.split("\n")[0])
    parser.add_argument("triples", type=int)
    parser.add_argument("--seed", type=int, default=1, help="of the first")
    asked, found = parser.parse_args(), Found()
    for seed in range(asked.seed, asked.seed + asked.triples):
        before = len(found.wrong)
        try:
            compare(seed, found)
        except wr.SimulationError as error:
            print(f"seed {seed}: {error}")
        for text in found.wrong[before:]:
            print(text, flush=True)
    print(
        f"{asked.triples} triples: {found.rows} verdicts, {found.damages} damages, {found.lines} lines stated by both; "
        f"{len(found.wrong)} texts on what is off by more than 1 %; worst line {100.0 * found.worst:.2f} %"
    )


if __name__ == "__main__":
    main()
